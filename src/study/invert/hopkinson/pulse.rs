//! What a record holds before the pulse, and the incident pulse.

use std::ops::Range;

use super::test_set::{Record, Records, Setup};
use crate::error::{InputError, Result};
use crate::root::bisect;
use crate::study::invert::noise::at;
use crate::study::invert::zero::{QUIET, Zeroed, mean};

/// The incident pulse at its gauge.
pub(super) struct Pulse {
    pub(super) sign: f64,
    /// s.
    pub(super) arrival: f64,
    /// s.
    pub(super) lasts: f64,
}

/// Part of the largest strain at which a pulse arrives and ends.
const ARRIVES: f64 = 0.05;
const ENDS: f64 = 0.1;

/// Part of the largest strain that only a pulse has: offsets and noise are smaller.
const RISEN: f64 = 0.25;

/// Part of the time to the reflected pulse in which the incident one is looked at: positions and speeds are not exact.
const ALONE: f64 = 0.98;

/// Part of that time by which the reflected pulse may miss its computed arrival.
const MISSED: f64 = 1.0 - ALONE;

/// Part of that time over whose mean the incident pulse has ended.
const LAST: f64 = 0.02;

/// Fewest samples whose mean is a zero offset, and the part of the largest strain up to which fewer do.
const FEWEST: usize = 10;
const SMALL: f64 = 0.01;

/// A pulse is seen in a single record where it is this many times the noise.
const CLEAR: f64 = 8.0;

/// Part of that time to which the arrival of the reflected pulse is found.
const PRECISE: f64 = 1e-5;

/// The records without their zero offsets, incident and transmitted, and the incident pulse.
pub(super) fn separate(setup: &Setup, records: &Records) -> Result<([Zeroed; 2], Pulse)> {
    let (time, strain) = &records.incident;
    let first = arrival(strain).ok_or_else(|| {
        InputError::new("the gauge of the incident bar records no pulse")
            .help("check the order and the units of the columns")
    })?;
    in_order(records, time[first])?;
    let incident = Zeroed::until(time, strain, time[first]);
    starts_before(&incident, strain)?;
    let passed = setup.incident.delay() + setup.transmitted.delay();
    let due = |arrival: f64| Zeroed::until(&records.transmitted.0, &records.transmitted.1, arrival + passed);
    let pulse = incident_pulse(setup, [&incident.record, &due(time[first]).record], first)?;
    let transmitted = due(pulse.arrival);
    Ok(([incident, transmitted], pulse))
}

/// Refuses what is no zero offset of the incident gauge: a level of the pulse.
fn starts_before(zeroed: &Zeroed, strain: &[f64]) -> Result<()> {
    let largest = strain.iter().fold(0.0_f64, |top, e| top.max(e.abs()));
    let most = if zeroed.samples < FEWEST { SMALL } else { RISEN };
    if zeroed.offset.abs() <= most * largest {
        return Ok(());
    }
    let message = format!(
        "the record of the incident bar starts at a strain of {:.2e}, and its largest is {largest:.2e}: it starts inside \
         the pulse, or the zero of the gauge is far off",
        zeroed.offset
    );
    Err(InputError::new(message)
        .allowed(format!("a start at up to {:.0} % of the largest strain", 100.0 * most))
        .help("record from before the pulse on (pre-trigger), or subtract the zero offset")
        .into())
}

/// The first row of the pulse: where the strain, on its way to what only a pulse has, leaves that of the start.
fn arrival(strain: &[f64]) -> Option<usize> {
    let mut quiet = (strain.len() / 100).clamp(1, 50).min(strain.len());
    let mut first = None;
    // The second time the offset is that of the whole quiet part.
    for _ in 0..2 {
        let offset = mean(&strain[..quiet]);
        let largest = strain.iter().fold(0.0_f64, |top, e| top.max((e - offset).abs()));
        let at_least = |part: f64| move |e: &f64| largest > 0.0 && (e - offset).abs() >= part * largest;
        let risen = strain.iter().position(at_least(RISEN))?;
        let before = strain[..risen].iter().rposition(|e| !at_least(ARRIVES)(e));
        let row = before.map_or(0, |row| row + 1);
        quiet = ((QUIET * row as f64) as usize).max(1);
        first = Some(row);
    }
    first
}

/// Refuses a transmitted pulse that passes its gauge before the incident one does.
fn in_order(records: &Records, incident: f64) -> Result<()> {
    let (time, strain) = &records.transmitted;
    let Some(row) = arrival(strain).filter(|_| is_clear(strain)) else { return Ok(()) };
    if time[row] >= incident {
        return Ok(());
    }
    let message = format!(
        "the pulse of the transmission bar passes its gauge {:.1} us before the incident pulse passes the gauge of the \
         incident bar",
        1e6 * (incident - time[row])
    );
    let help = "the two columns, or the names of the gauges, are exchanged: the incident bar comes first";
    Err(InputError::new(message).allowed("after it").help(help).into())
}

/// Whether a record holds more than noise: white noise of deviation s has differences between neighbours with a median of 0.954 s.
fn is_clear(strain: &[f64]) -> bool {
    let mut steps: Vec<f64> = strain.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    steps.sort_by(f64::total_cmp);
    let noise = steps.get(steps.len() / 2).map_or(0.0, |step| step / 0.954);
    let start = strain.first().copied().unwrap_or(0.0);
    strain.iter().fold(0.0_f64, |top, e| top.max((e - start).abs())) > CLEAR * noise
}

/// The incident pulse, which must have ended when the reflected one arrives.
fn incident_pulse(setup: &Setup, records: [&Record; 2], first: usize) -> Result<Pulse> {
    let (time, strain) = records[0];
    let way = 2.0 * setup.incident.delay();
    let until = |part: f64| time.partition_point(|&t| t < time[first] + part * way);
    let alone = first..until(ALONE).max(first + 1);
    let signed = strain[alone.clone()].iter().fold(0.0_f64, |top, &e| if e.abs() > top.abs() { e } else { top });
    let last = alone.clone().rev().find(|&row| strain[row].abs() > ENDS * signed.abs()).unwrap_or(first);
    let end = mean(&strain[until(ALONE - LAST).min(alone.end - 1)..alone.end]);
    if end.abs() > ENDS * signed.abs() && alone.end < time.len() {
        let level = end / signed;
        // A pulse of the other sign is the reflected one.
        let pulse = Alone { rows: first.saturating_sub(1)..alone.end, sign: signed.signum() };
        let late = (level < 0.0).then(|| late(setup, records, &pulse)).flatten().filter(|&late| late < -MISSED * way);
        let error = late.map_or_else(|| overlap(setup.incident.distance, way, level), |late| early(setup, late));
        return Err(error.into());
    }
    let arrival = time[first] - foot((time, strain), first, RISEN * signed.abs());
    Ok(Pulse { sign: signed.signum(), arrival, lasts: time[last] - arrival })
}

/// Time before a row in which the front has come up from zero, by the line from there to where it exceeds `risen`: without it, the specimen
/// was deformed at the start.
fn foot((time, strain): (&[f64], &[f64]), first: usize, risen: f64) -> f64 {
    let Some(later) = strain[first..].iter().position(|e| e.abs() >= risen).filter(|rows| *rows > 0) else {
        return 0.0;
    };
    let [start, end] = [first, first + later].map(|row| (time[row], strain[row].abs()));
    let slope = (end.1 - start.1) / (end.0 - start.0);
    (start.1 / slope).min(end.0 - start.0)
}

/// Time at which values first reach a level, straight between samples.
fn reaches(time: &[f64], values: impl Fn(usize) -> f64, level: f64) -> Option<f64> {
    let row = (0..time.len()).find(|&row| values(row) >= level)?;
    let Some(before) = row.checked_sub(1) else { return Some(time[row]) };
    let part = (level - values(before)) / (values(row) - values(before));
    Some(time[before] + part * (time[row] - time[before]))
}

/// What to do about a reflected pulse that arrives at another time than computed, with the distance that fits its arrival, m.
fn fitting(distance: f64) -> String {
    format!(
        "a distance of {distance:.4} m fits its arrival: check the distance of the gauge on the incident bar, and the modulus \
         and the density of the bars"
    )
}

/// Rows of the incident gauge's record that hold the incident pulse, and its sign.
struct Alone {
    rows: Range<usize>,
    sign: f64,
}

/// How much later than computed the reflected pulse arrives, s, by the time at which it reaches a part of its height. Both faces carry about
/// one force, so that the transmitted pulse tells the reflected one's shape: a stiff specimen reflects little before it yields.
fn late(setup: &Setup, [incident, transmitted]: [&Record; 2], pulse: &Alone) -> Option<f64> {
    let (one, two) = (&setup.incident, &setup.transmitted);
    let ratio = two.modulus * two.area / (one.modulus * one.area);
    let [time, strain] = [&incident.0[pulse.rows.start..], &incident.1[pulse.rows.start..]];
    let alone = &time[..pulse.rows.len()];
    let passed = one.delay() + two.delay();
    let largest = |of: &dyn Fn(usize) -> f64| (0..alone.len()).map(of).fold(0.0, f64::max);
    let least = ENDS * largest(&|row| pulse.sign * strain[row]);
    let way = 2.0 * one.delay();
    // The transmitted pulse, too, is read at a distance that may be wrong. Read later it is larger, and the reflected one starts later.
    let found = |late: f64| {
        let through = |row: usize| ratio * at(&transmitted.0, &transmitted.1, time[row] + passed + 0.5 * late);
        let reflected = |row: usize| pulse.sign * (strain[row] - through(row));
        let level = least.max(RISEN * largest(&reflected));
        let computed = reaches(alone, reflected, level)? + way;
        Some(reaches(time, |row| -pulse.sign * strain[row], level)? - computed)
    };
    found(0.0)?;
    Some(bisect([-way, way], PRECISE * way, |late| found(late).is_some_and(|found| found > late)))
}

/// A warning where the reflected pulse misses its computed arrival within a window from the arrival of the incident one on.
pub(super) fn misplaced(setup: &Setup, zeroed: &[Zeroed; 2], pulse: &Pulse, window: f64) -> Option<String> {
    let [incident, transmitted] = zeroed.each_ref().map(|zeroed| &zeroed.record);
    let row = |after: f64| incident.0.partition_point(|&t| t < pulse.arrival + after);
    let alone = Alone { rows: row(0.0).saturating_sub(1)..row(window), sign: pulse.sign };
    let bar = &setup.incident;
    let late = late(setup, [incident, transmitted], &alone)?;
    let message = || {
        let than = if late > 0.0 { "after" } else { "before" };
        format!(
            "the reflected pulse arrives {:.1} us {than} its time as computed from the distance of {:.4} m: stresses and \
             strains are wrong; {}",
            1e6 * late.abs(),
            bar.distance,
            fitting(bar.distance + 0.5 * late * bar.c0())
        )
    };
    (late.abs() > MISSED * 2.0 * bar.delay()).then(message)
}

/// A reflected pulse that arrives before the incident one has been seen alone.
fn early(setup: &Setup, late: f64) -> InputError {
    let bar = &setup.incident;
    let message = format!(
        "the reflected pulse arrives {:.1} us after the incident one, before its computed time of {:.1} us",
        1e6 * (2.0 * bar.delay() + late),
        2e6 * bar.delay()
    );
    let help = fitting(bar.distance + 0.5 * late * bar.c0());
    InputError::new(message).key("incident.distance").allowed("the distance from the gauge to the specimen").help(help)
}

fn overlap(distance: f64, way: f64, level: f64) -> InputError {
    let message = format!(
        "the incident pulse is longer than {:.1} us (then it is still at {:.0} % of its largest strain): the reflected pulse \
         arrives at the gauge before it has passed, and the two cannot be separated",
        1e6 * ALONE * way,
        100.0 * level
    );
    let help = format!(
        "move the gauge farther from the specimen than half the length of the pulse, or use a striker shorter than the \
         {distance:.4} m between them"
    );
    InputError::new(message)
        .allowed(format!("a pulse shorter than {:.1} us, twice the way from the gauge to the specimen", 1e6 * way))
        .help(help)
}

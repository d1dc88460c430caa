//! Zero offsets of the records and the incident pulse.

use std::ops::Range;

use super::test_set::{ElasticBar, Record, Records, Setup};
use crate::error::{InputError, Result};
use crate::root::bisect;
use crate::study::invert::noise::at;
use crate::study::invert::zero::{QUIET, Zeroed, mean};

/// Incident pulse at its gauge.
pub(super) struct Pulse {
    pub(super) sign: f64,
    /// Arrival time, s.
    pub(super) arrival: f64,
    /// Longest time before the arrival at which the pulse can have begun, s: its foot can rise slowly.
    pub(super) foot: f64,
    /// Duration, s.
    pub(super) lasts: f64,
}

/// Fractions of the largest strain at which a pulse arrives and ends.
const ARRIVES: f64 = 0.05;
const ENDS: f64 = 0.1;

/// Fraction of the largest strain that only a pulse reaches: zero offsets and noise are smaller.
const RISEN: f64 = 0.25;

/// Fraction of the time to the reflected pulse during which the incident pulse is evaluated, because distances and speeds are not exact.
const ALONE: f64 = 0.98;

/// Fraction of the time to the reflected pulse by which its arrival may differ from the computed one.
const MISSED: f64 = 1.0 - ALONE;

/// Fraction of the time to the reflected pulse over which the strain is averaged to decide whether the incident pulse has ended.
const LAST: f64 = 0.02;

/// Fewest samples for which the mean counts as a zero offset up to `RISEN` of the largest strain. With fewer samples it may be at most `SMALL` of the
/// largest strain.
const FEWEST: usize = 10;
const SMALL: f64 = 0.01;

/// Time before the arrival at which a pulse that rises as a parabola starts, relative to the time that the line through `ARRIVES` and `RISEN` of the
/// largest strain takes from zero to `ARRIVES`: the square root of `RISEN` over `ARRIVES`.
const PARABOLIC: f64 = 2.236_068;

/// Ratio to the noise above which a single record shows a pulse.
const CLEAR: f64 = 8.0;

/// Precision of the arrival time of the reflected pulse, relative to the time to it.
const PRECISE: f64 = 1e-5;

/// Returns the incident and transmitted records without their zero offsets, and the incident pulse.
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

/// Refuses a zero offset of the incident gauge that is so large that the record must start inside the pulse.
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

/// Returns the first row of the pulse: where the strain leaves its initial level before it reaches a value that only a pulse has.
fn arrival(strain: &[f64]) -> Option<usize> {
    let mut quiet = (strain.len() / 100).clamp(1, 50).min(strain.len());
    let mut first = None;
    // The second iteration takes the offset from the complete part before the pulse.
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

/// Refuses a transmitted pulse that passes its gauge before the incident pulse passes the incident gauge.
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

/// Returns whether a record contains more than noise. White noise with standard deviation s has differences between neighbours with a median of 0.954
/// s.
fn is_clear(strain: &[f64]) -> bool {
    let mut steps: Vec<f64> = strain.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    steps.sort_by(f64::total_cmp);
    let noise = steps.get(steps.len() / 2).map_or(0.0, |step| step / 0.954);
    let start = strain.first().copied().unwrap_or(0.0);
    strain.iter().fold(0.0_f64, |top, e| top.max((e - start).abs())) > CLEAR * noise
}

/// Returns the incident pulse, which must have ended when the reflected pulse arrives.
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
        // A pulse of the opposite sign is the reflected pulse.
        let pulse = Alone { rows: first.saturating_sub(1)..alone.end, sign: signed.signum() };
        let late = (level < 0.0).then(|| late(setup, records, &pulse)).flatten().filter(|&late| late < -MISSED * way);
        let error = late.map_or_else(|| overlap(setup.incident.distance, way, level), |late| early(setup, late));
        return Err(error.into());
    }
    let rise = foot((time, strain), first, RISEN * signed.abs());
    let arrival = time[first] - rise;
    Ok(Pulse { sign: signed.signum(), arrival, foot: PARABOLIC * rise, lasts: time[last] - arrival })
}

/// Returns the time that the front took to rise from zero to row `first`, s, from the line through that row and the first row with a strain above
/// `risen`. Times count from there, but the specimen is deformed before by [`Pulse::foot`].
fn foot((time, strain): (&[f64], &[f64]), first: usize, risen: f64) -> f64 {
    let Some(later) = strain[first..].iter().position(|e| e.abs() >= risen).filter(|rows| *rows > 0) else {
        return 0.0;
    };
    let [start, end] = [first, first + later].map(|row| (time[row], strain[row].abs()));
    let slope = (end.1 - start.1) / (end.0 - start.0);
    (start.1 / slope).min(end.0 - start.0)
}

/// Returns the time at which values first reach a level, interpolated linearly between samples.
fn reaches(time: &[f64], values: impl Fn(usize) -> f64, level: f64) -> Option<f64> {
    let row = (0..time.len()).find(|&row| values(row) >= level)?;
    let Some(before) = row.checked_sub(1) else { return Some(time[row]) };
    let part = (level - values(before)) / (values(row) - values(before));
    Some(time[before] + part * (time[row] - time[before]))
}

/// Returns a help text for a reflected pulse whose arrival differs from the computed one. `distance` is the distance that fits its arrival, m.
fn fitting(distance: f64) -> String {
    format!(
        "a distance of {distance:.4} m fits its arrival: check the distance of the gauge on the incident bar, and the modulus \
         and the density of the bars"
    )
}

/// Rows of the incident gauge's record that contain the incident pulse, and its sign.
struct Alone {
    rows: Range<usize>,
    sign: f64,
}

/// Returns the delay of the reflected pulse with respect to its computed arrival, s, determined from the time at which it reaches a fraction of its
/// height. Both faces have approximately the same force, so the transmitted pulse determines the shape of the reflected one: a stiff specimen
/// reflects little before it yields.
fn late(setup: &Setup, [incident, transmitted]: [&Record; 2], pulse: &Alone) -> Option<f64> {
    let (one, two) = (&setup.incident, &setup.transmitted);
    let ratio = two.modulus * two.area / (one.modulus * one.area);
    let [time, strain] = [&incident.0[pulse.rows.start..], &incident.1[pulse.rows.start..]];
    let alone = &time[..pulse.rows.len()];
    let passed = one.delay() + two.delay();
    let largest = |of: &dyn Fn(usize) -> f64| (0..alone.len()).map(of).fold(0.0, f64::max);
    let least = ENDS * largest(&|row| pulse.sign * strain[row]);
    let way = 2.0 * one.delay();
    // The time of the transmitted pulse depends on the same distance, which may be wrong. At a later time it is larger, and the reflected pulse
    // starts later.
    let found = |late: f64| {
        let through = |row: usize| ratio * at(&transmitted.0, &transmitted.1, time[row] + passed + 0.5 * late);
        let reflected = |row: usize| pulse.sign * (strain[row] - through(row));
        let level = least.max(RISEN * largest(&reflected));
        let computed = reaches(alone, reflected, level)? + way;
        Some(reaches(time, |row| -pulse.sign * strain[row], level)? - computed)
    };
    found(0.0)?;
    // With the transmitted pulse taken much too early, the computed reflected pulse is so large that a weak one never reaches the level.
    let later = |late: f64| found(late).map_or(late < 0.0, |found| found > late);
    Some(bisect([-way, way], PRECISE * way, later))
}

/// Largest differences from the computed arrivals that are searched for, relative to the time to them.
const SEARCHED: f64 = 0.25;

/// Numbers of steps of the successive searches on each side; each one covers the steps next to the best one of the search before.
const STEPS: [i32; 3] = [16, 8, 8];

/// Number of times at which the forces of the faces are compared, and the part of the window before the arrival that is included.
const TIMES: usize = 120;
const BEFORE: f64 = 0.2;

/// Ratio of the sums of squared differences of the forces up to which another distance explains them much better. Noise and waves in the specimen leave
/// differences with any distance.
const EXPLAINED: f64 = 0.25;

/// Returns the delay of the transmitted pulse with respect to its computed arrival, s, for which the forces of the two faces agree best, whatever the
/// distance of the gauge on the incident bar. `None` if they agree nearly as well without it.
fn transmitted_late(setup: &Setup, [incident, transmitted]: [&Record; 2], pulse: &Pulse, window: f64) -> Option<f64> {
    let (one, two) = (&setup.incident, &setup.transmitted);
    let ratio = two.modulus * two.area / (one.modulus * one.area);
    let (way, passed) = (2.0 * one.delay(), one.delay() + two.delay());
    let times = (0..TIMES).map(|k| pulse.arrival + window * ((1.0 + BEFORE) * k as f64 / TIMES as f64 - BEFORE));
    let first: Vec<(f64, f64)> = times.map(|t| (t, at(&incident.0, &incident.1, t))).collect();
    // A delay of the reflected pulse means another distance on the incident bar, which delays the transmitted one by half as much.
    let differ = |[reflected, late]: [f64; 2]| -> f64 {
        let square = |&(t, first): &(f64, f64)| {
            let front = first + at(&incident.0, &incident.1, t + way + reflected);
            (front - ratio * at(&transmitted.0, &transmitted.1, t + passed + 0.5 * reflected + late)).powi(2)
        };
        first.iter().map(square).sum()
    };
    let (_, with_distance) = least(differ, [SEARCHED * way, 0.0]);
    let ([_, late], with_both) = least(differ, [SEARCHED * way, SEARCHED * passed]);
    (with_both < EXPLAINED * with_distance).then_some(late)
}

/// Returns the pair of numbers up to `ranges` for which a function is least, and its value there, by a search on grids that become finer.
fn least(function: impl Fn([f64; 2]) -> f64, mut ranges: [f64; 2]) -> ([f64; 2], f64) {
    let mut best = ([0.0; 2], function([0.0; 2]));
    for steps in STEPS {
        let middle = best.0;
        let part = |k: i32| f64::from(k) / f64::from(steps);
        let second = if ranges[1] > 0.0 { -steps..=steps } else { 0..=0 };
        for (i, k) in (-steps..=steps).flat_map(|i| second.clone().map(move |k| (i, k))) {
            let pair = [middle[0] + part(i) * ranges[0], middle[1] + part(k) * ranges[1]];
            let value = function(pair);
            if value < best.1 {
                best = (pair, value);
            }
        }
        ranges = ranges.map(|range| range / f64::from(steps));
    }
    best
}

/// Elastic wave speed of a specimen whose modulus and density are unknown, m/s: that of a soft polymer (1 GPa, 1000 kg/m^3).
const SOFT: f64 = 1000.0;

/// Largest delay of the transmitted pulse due to its way through the specimen, relative to the transit time of the elastic wave: noise and the slower
/// plastic waves add to it.
const TRANSITS: f64 = 1.4;

/// Returns warnings if the arrival of the reflected or of the transmitted pulse differs from the computed one. `window` is the time from the arrival of
/// the incident pulse on, s; `speed` is the elastic wave speed of the specimen, m/s, if known.
pub(super) fn misplaced(
    setup: &Setup,
    zeroed: &[Zeroed; 2],
    pulse: &Pulse,
    window: f64,
    speed: Option<f64>,
) -> Vec<String> {
    let records = zeroed.each_ref().map(|zeroed| &zeroed.record);
    let row = |after: f64| records[0].0.partition_point(|&t| t < pulse.arrival + after);
    let alone = Alone { rows: row(0.0).saturating_sub(1)..row(window), sign: pulse.sign };
    let reflected = late(setup, records, &alone);
    let transmitted = transmitted_late(setup, records, pulse, window);
    let of_reflected = reflected.and_then(|late| reflected_misplaced(&setup.incident, late));
    let transit = setup.length / speed.unwrap_or(SOFT);
    of_reflected.into_iter().chain(transmitted.and_then(|late| transmitted_misplaced(setup, late, transit))).collect()
}

/// Returns a warning if the delay `late` (s) of the transmitted pulse is too large. The computed time does not include the way through the specimen,
/// so that the pulse can be late by its transit time `transit` (s).
fn transmitted_misplaced(setup: &Setup, late: f64, transit: f64) -> Option<String> {
    let [one, two] = [&setup.incident, &setup.transmitted];
    let message = || {
        let (than, unless) = if late > 0.0 {
            ("after", "unless the wave takes that time through the specimen, ")
        } else {
            ("before", "")
        };
        format!(
            "the transmitted pulse arrives {:.1} us {than} its time as computed from the distances of {:.4} m and {:.4} m: \
             {unless}stresses and strains are wrong; a distance of {:.4} m fits its arrival: check the distance of the gauge on the \
             transmission bar, and the clocks of the records",
            1e6 * late.abs(),
            one.distance,
            two.distance,
            two.distance + late * two.c0()
        )
    };
    let missed = MISSED * (one.delay() + two.delay());
    (late > missed.max(TRANSITS * transit) || late < -missed).then(message)
}

/// Returns a warning if the delay `late` (s) of the reflected pulse is too large.
fn reflected_misplaced(bar: &ElasticBar, late: f64) -> Option<String> {
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

/// Returns the error for a reflected pulse that arrives before the incident pulse could be evaluated alone.
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

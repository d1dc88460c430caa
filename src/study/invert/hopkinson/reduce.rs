//! Reduction of a test: pulses, history of the specimen, equilibrium and curve.

use std::ops::Range;

use serde::Serialize;

use super::pulse::{Pulse, misplaced, separate};
use super::test_set::{ElasticBar, Records, Setup};
use crate::error::{InputError, Result};
use crate::input::{Allowed, Checked, member, optional, positive};
use crate::material::Sense;
use crate::study::invert::bands::{HALF_95, OF_UNIFORM};
use crate::study::invert::noise::at;
use crate::study::invert::zero::Zeroed;
use crate::units::Dimension;

/// Settings of the reduction.
#[derive(Debug, Clone)]
pub struct Options {
    /// Length of the reduction from the arrival of the incident pulse on, s, > 0; if `None`, the length of the pulse.
    pub window: Option<f64>,
    /// Time from the passage of the transmitted pulse at its gauge to its return from the far end of the transmission bar, s, if known.
    pub limit: Option<f64>,
    /// Largest difference of the forces on the two faces, relative to their mean, that counts as equilibrium, > 0.
    pub equilibrium: f64,
    /// Poisson's ratio of the bars, 0 to 0.5, for the estimate of the dispersion.
    pub poisson: f64,
    /// Elastic wave speed of the specimen, m/s, > 0, if known: the transmitted pulse may be late by the time that it takes through the specimen.
    pub speed: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Self { window: None, limit: None, equilibrium: Self::EQUILIBRIUM, poisson: Self::POISSON, speed: None }
    }
}

impl Options {
    /// Default value of [`Options::equilibrium`].
    pub const EQUILIBRIUM: f64 = 0.1;
    /// Default Poisson's ratio of the bars: that of steel.
    pub const POISSON: f64 = 0.29;

    fn check(&self) -> Checked {
        optional("window", self.window, Dimension::Time, Allowed::Positive)?;
        optional("limit", self.limit, Dimension::Time, Allowed::NotNegative)?;
        optional("speed", self.speed, Dimension::Velocity, Allowed::Positive)?;
        positive([("equilibrium", self.equilibrium, Dimension::None)])?;
        member("poisson", self.poisson, Dimension::None, Allowed::Within(0.0, 0.5))
    }
}

/// State of the specimen at one time; magnitudes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Moment {
    /// Time since the incident pulse reached the specimen, s.
    pub time_s: f64,
    /// Engineering strain by three-wave analysis.
    pub strain: f64,
    /// Strain rate by three-wave analysis, 1/s.
    #[serde(rename = "rate_1_s")]
    pub rate: f64,
    /// Engineering stress by three-wave analysis, the mean of both faces, Pa.
    #[serde(rename = "stress_Pa")]
    pub stress: f64,
    /// Engineering strain by one-wave analysis.
    pub strain_one_wave: f64,
    /// Strain rate by one-wave analysis, 1/s.
    #[serde(rename = "rate_one_wave_1_s")]
    pub rate_one_wave: f64,
    /// Engineering stress by one-wave analysis, that at the face of the transmission bar, Pa.
    #[serde(rename = "stress_one_wave_Pa")]
    pub stress_one_wave: f64,
    /// Engineering stress at the face of the incident bar, Pa.
    #[serde(rename = "stress_incident_face_Pa")]
    pub stress_incident_face: f64,
    /// Incident strain at the specimen.
    pub incident: f64,
    /// Reflected strain at the specimen.
    pub reflected: f64,
    /// Transmitted strain at the specimen.
    pub transmitted: f64,
}

/// Knot of the specimen's curve: the mean of the history over a range of strain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Knot {
    /// Engineering strain.
    pub strain: f64,
    /// Engineering stress, Pa.
    #[serde(rename = "stress_Pa")]
    pub stress: f64,
    /// Half width of the 95 % interval of the stress, Pa, due to noise, rounding, errors of the zero offsets, half the root mean square difference of the
    /// faces, and the bend of the curve within the range.
    #[serde(rename = "stress_half_width_Pa")]
    pub half_width: f64,
    /// Mean strain rate, 1/s.
    #[serde(rename = "rate_1_s")]
    pub rate: f64,
}

/// Result of the reduction of a test.
#[derive(Debug, Clone, Serialize)]
pub struct Reduced {
    /// Bars and specimen.
    pub setup: Setup,
    /// Sense of the loading.
    pub sense: Sense,
    /// Time at which the incident pulse reaches its gauge, s.
    pub arrival_s: f64,
    /// Length of the reduction, s.
    pub window_s: f64,
    /// Zero offsets of the gauges on the incident and on the transmission bar: mean strain before the pulse, which has been removed.
    pub zero_offsets: [f64; 2],
    /// Noise of the two records: standard deviation of the strain about the zero offset.
    pub noise: [f64; 2],
    /// End of the loading, s; the specimen unloads afterwards.
    pub loading_until_s: f64,
    /// Time from which the faces are in equilibrium, s; `None` if they never are.
    pub equilibrium_from_s: Option<f64>,
    /// Time until which the faces are in equilibrium, s; `None` if that is the end of the loading.
    pub equilibrium_until_s: Option<f64>,
    /// Strain at the start of the equilibrium.
    pub equilibrium_from_strain: Option<f64>,
    /// Largest difference of the faces during the equilibrium, relative to their mean.
    pub imbalance: Option<f64>,
    /// Mean strain rate over time during the equilibrium, 1/s.
    #[serde(rename = "mean_rate_1_s")]
    pub mean_rate: Option<f64>,
    /// First and last time of that mean and of the curve, s.
    pub mean_rate_between_s: Option<[f64; 2]>,
    /// Time by which dispersion between the gauges spreads a sharp front, s.
    pub dispersion_s: f64,
    /// Curve during the equilibrium.
    pub curve: Vec<Knot>,
    /// Limitations of the result.
    pub warnings: Vec<String>,
    /// History of the specimen.
    #[serde(skip)]
    pub moments: Vec<Moment>,
}

/// Most and fewest steps of the history.
const MOST_MOMENTS: usize = 4000;
const FEWEST_MOMENTS: usize = 400;

/// Number of steps of the integration over the foot of the incident pulse.
const FOOT_STEPS: usize = 50;

/// Number of ranges of strain in the curve.
const KNOTS: usize = 40;

/// A range is halved if the curve bends within it by more than `FINE` times the largest stress, but not below `FEWEST_ROWS` rows.
const FINE: f64 = 1e-3;
const FEWEST_ROWS: usize = 2;

/// Number of standard errors of the noise above which a bend, or a transmitted pulse, is significant.
const BEYOND_NOISE: f64 = 3.0;

/// For a parabola: distance of its mean from its value in the middle, relative to the distance of the mean of its middle third from the line through
/// the means of the outer thirds.
const OF_A_PARABOLA: f64 = 0.75;

/// Fraction of the largest strain rate below which the specimen counts as unloading.
const SLOW: f64 = 0.1;

/// The forces of the faces are compared as moving averages over this fraction of the window, which suppresses noise more than waves.
const SMOOTHED: f64 = 0.02;

/// Shortest equilibrium, relative to the loading, for which a curve is computed.
const SHORTEST: f64 = 0.1;

/// Fraction of the incident pulse by which another pulse may have the wrong sign, due to noise and drift of the gauges.
const WRONG_SENSE: f64 = 0.02;

/// Reduces a test.
///
/// # Errors
/// Numbers out of range, columns of different lengths, rows that are not finite; records without a pulse, that start inside the pulse or are shorter
/// than the window; pulses that overlap, are in the wrong order or have the wrong sign.
pub fn reduce(setup: &Setup, records: &Records, options: &Options) -> Result<Reduced> {
    setup.check()?;
    options.check()?;
    records.check()?;
    let (zeroed, pulse) = separate(setup, records)?;
    let mut warnings = wide(setup);
    let window = window(setup, records, options, &pulse, &mut warnings)?;
    let moments = moments(setup, &zeroed, &pulse, window);
    transmits(&zeroed[1], &moments, pulse.arrival + setup.incident.delay() + setup.transmitted.delay())?;
    senses(&moments)?;
    warnings.extend(misplaced(setup, &zeroed, &pulse, window, options.speed));
    let half = (0.5 * SMOOTHED * moments.len() as f64) as usize;
    let loading = loading(&moments, half);
    let mut reduced = Reduced {
        setup: setup.clone(),
        sense: Sense::of(pulse.sign),
        arrival_s: pulse.arrival,
        window_s: window,
        zero_offsets: [zeroed[0].offset, zeroed[1].offset],
        noise: [zeroed[0].noise, zeroed[1].noise],
        loading_until_s: moments[loading.saturating_sub(1)].time_s,
        equilibrium_from_s: None,
        equilibrium_until_s: None,
        equilibrium_from_strain: None,
        imbalance: None,
        mean_rate: None,
        mean_rate_between_s: None,
        dispersion_s: dispersion(setup, options.poisson),
        curve: Vec::new(),
        warnings,
        moments,
    };
    // The moving averages at the edge of the window extend beyond the loading.
    equilibrium(&mut reduced, options.equilibrium, half, loading.saturating_sub(half));
    add_offset_errors(&mut reduced, [zeroed[0].offset_error, zeroed[1].offset_error]);
    // Neighbouring samples are rounded alike, so that a mean over them has the error of one.
    let rounding = HALF_95 * stress_noise(setup, zeroed.each_ref().map(|zeroed| OF_UNIFORM * zeroed.rounding));
    for knot in &mut reduced.curve {
        knot.half_width = knot.half_width.hypot(rounding);
    }
    Ok(reduced)
}

/// Returns a warning if the specimen is wider than the bars.
fn wide(setup: &Setup) -> Vec<String> {
    let bar = setup.incident.area.min(setup.transmitted.area);
    let message = || {
        format!(
            "the specimen is wider than the bars: its section is {:.2} times theirs, and its rim is not loaded",
            setup.area / bar
        )
    };
    // Equal diameters may differ by rounding.
    (setup.area > bar * (1.0 + 1e-6)).then(message).into_iter().collect()
}

/// Refuses a gauge of the transmission bar whose mean strain during the passage of the pulse, from `start` on, does not exceed its noise.
fn transmits(gauge: &Zeroed, moments: &[Moment], start: f64) -> Result<()> {
    let mean = moments.iter().map(|m| m.transmitted).sum::<f64>() / moments.len() as f64;
    let lasts = moments.last().map_or(0.0, |m| m.time_s);
    let within = |t: &&f64| (start..=start + lasts).contains(*t);
    let passing = gauge.record.0.iter().filter(within).count().max(1);
    let error = gauge.offset_error.hypot(gauge.offset_error * (gauge.samples as f64 / passing as f64).sqrt());
    if mean.abs() > BEYOND_NOISE * error {
        return Ok(());
    }
    let part = if error > 0.0 { " beyond its noise" } else { "" };
    let message = format!("the gauge of the transmission bar records no pulse{part}");
    Err(InputError::new(message).help("check the gauge, and the order and the units of the columns").into())
}

/// Refuses pulses whose sign is impossible for a specimen between the bars: the transmitted pulse has the sign of the incident pulse, the reflected
/// one the opposite sign.
fn senses(moments: &[Moment]) -> Result<()> {
    let sum = |of: fn(&Moment) -> f64| moments.iter().map(of).sum::<f64>();
    let incident = sum(|m| m.incident);
    let wrong = |pulse: &str, has: &str, allowed: &str, part: f64| {
        let message = format!("the {pulse} pulse has {has} the incident pulse: its mean is {part:+.2} times as large");
        let help =
            "a gauge has the wrong sign (multiply its column by -1), columns are exchanged, or a distance is wrong";
        InputError::new(message).allowed(allowed).help(help)
    };
    let (reflected, transmitted) = (sum(|m| m.reflected) / incident, sum(|m| m.transmitted) / incident);
    if transmitted < -WRONG_SENSE {
        return Err(wrong("transmitted", "the opposite sign of", "the same sign", transmitted).into());
    }
    if reflected > WRONG_SENSE {
        return Err(wrong("reflected", "the same sign as", "the opposite sign", reflected).into());
    }
    Ok(())
}

/// Returns the time during which the incident and the reflected pulse are separate and no other wave has arrived, s.
fn window(
    setup: &Setup,
    records: &Records,
    options: &Options,
    pulse: &Pulse,
    warnings: &mut Vec<String>,
) -> Result<f64> {
    let separate = 2.0 * setup.incident.delay();
    let end = |record: &(Vec<f64>, Vec<f64>), delay: f64| record.0.last().map_or(0.0, |t| t - pulse.arrival - delay);
    let recorded = end(&records.incident, separate)
        .min(end(&records.transmitted, setup.incident.delay() + setup.transmitted.delay()));
    let limit = separate.min(options.limit.unwrap_or(f64::INFINITY)).min(recorded);
    if limit <= 0.0 {
        let message = "the records end before the reflected and transmitted pulses arrive";
        return Err(InputError::new(message).help("check the units of the time and the gauge distances").into());
    }
    let wanted = options.window.unwrap_or(pulse.lasts);
    if wanted > limit {
        warnings.push(format!(
            "the reduction ends after {:.1} us, when another wave arrives or the records end",
            1e6 * limit
        ));
    }
    Ok(wanted.min(limit))
}

fn moments(setup: &Setup, zeroed: &[Zeroed; 2], pulse: &Pulse, window: f64) -> Vec<Moment> {
    let [incident_gauge, transmitted_gauge] = zeroed.each_ref().map(|zeroed| &zeroed.record);
    let within = |t: &&f64| (pulse.arrival..pulse.arrival + window).contains(*t);
    let samples = incident_gauge.0.iter().filter(within).count();
    let steps = samples.clamp(FEWEST_MOMENTS, MOST_MOMENTS);
    let (one, two) = (&setup.incident, &setup.transmitted);
    let section = setup.area.recip();
    let of_transmitted = transmitted_in_one_wave(one, two);
    let passed = one.delay() + two.delay();
    let pulses = |t: f64| {
        [
            pulse.sign * at(&incident_gauge.0, &incident_gauge.1, t),
            pulse.sign * at(&incident_gauge.0, &incident_gauge.1, t + 2.0 * one.delay()),
            pulse.sign * at(&transmitted_gauge.0, &transmitted_gauge.1, t + passed),
        ]
    };
    let rates = |[incident, reflected, transmitted]: [f64; 3]| {
        [
            (one.c0() * (incident - reflected) - two.c0() * transmitted) / setup.length,
            (of_transmitted * transmitted - 2.0 * one.c0() * reflected) / setup.length,
        ]
    };
    // The foot of the pulse deforms the specimen before the arrival.
    let during_foot = |k: usize| rates(pulses(pulse.arrival - pulse.foot * (k as f64 + 0.5) / FOOT_STEPS as f64));
    let mut strains = (0..FOOT_STEPS)
        .map(during_foot)
        .fold([0.0; 2], |sum, rates| [0, 1].map(|k| sum[k] + rates[k] * pulse.foot / FOOT_STEPS as f64));
    let mut before: Option<[f64; 2]> = None;
    let moment = |k: usize| {
        let time = window * k as f64 / steps as f64;
        let [incident, reflected, transmitted] = pulses(pulse.arrival + time);
        let rates = rates([incident, reflected, transmitted]);
        for (k, strain) in strains.iter_mut().enumerate() {
            *strain += 0.5
                * (rates[k] + before.map_or(rates[k], |b| b[k]))
                * if before.is_some() { window / steps as f64 } else { 0.0 };
        }
        before = Some(rates);
        let front = one.modulus * one.area * (incident + reflected) * section;
        let back = two.modulus * two.area * transmitted * section;
        Moment {
            time_s: time,
            strain: strains[0],
            rate: rates[0],
            stress: 0.5 * (front + back),
            strain_one_wave: strains[1],
            rate_one_wave: rates[1],
            stress_one_wave: back,
            stress_incident_face: front,
            incident,
            reflected,
            transmitted,
        }
    };
    (0..=steps).map(moment).collect()
}

/// Returns the approach velocity of the faces per transmitted strain by one-wave analysis, m/s. From `F1 = F2`, the incident strain is
/// `i = t E2 A2/(E1 A1) - r`. Exactly 0 for equal bars.
fn transmitted_in_one_wave(one: &ElasticBar, two: &ElasticBar) -> f64 {
    one.c0() * (two.modulus * two.area / (one.modulus * one.area)) - two.c0()
}

/// Returns the rise time of an initially sharp front after propagation between the gauges, s. Lateral inertia (Love) spreads it over the length
/// `(3 (nu r)^2 X/2)^(1/3)`, where r is the polar radius of gyration.
fn dispersion(setup: &Setup, poisson: f64) -> f64 {
    let bar = &setup.incident;
    let gyration = bar.area / (2.0 * std::f64::consts::PI);
    let way = setup.incident.distance + setup.transmitted.distance;
    (1.5 * poisson * poisson * gyration * way).cbrt() / bar.c0()
}

/// Returns moving averages over up to `half` neighbours on each side.
fn smoothed(values: &[f64], half: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    for value in values {
        sums.push(sums[sums.len() - 1] + value);
    }
    let mean = |i: usize| {
        let (low, high) = (i.saturating_sub(half), (i + half + 1).min(values.len()));
        (sums[high] - sums[low]) / (high - low) as f64
    };
    (0..values.len()).map(mean).collect()
}

/// Returns the longest range of values that do not exceed the tolerance. The edges of a pulse, which spreads during propagation, are outside this
/// range.
fn longest(imbalance: &[f64], tolerance: f64) -> Range<usize> {
    let (mut longest, mut start) = (0..0, 0);
    for (k, &value) in imbalance.iter().enumerate() {
        if value.is_nan() || value > tolerance {
            start = k + 1;
        } else if k + 1 - start >= longest.len() {
            longest = start..k + 1;
        }
    }
    longest
}

/// Returns the number of steps until the specimen unloads.
fn loading(moments: &[Moment], half: usize) -> usize {
    let rate = smoothed(&moments.iter().map(|m| m.rate).collect::<Vec<_>>(), half);
    let fastest = rate.iter().fold(0.0_f64, |top, r| top.max(*r));
    rate.iter().rposition(|&r| r > SLOW * fastest).map_or(0, |last| last + 1)
}

/// Determines the time of equilibrium and the curve in it, from the first `end` steps, up to the end of the loading.
fn equilibrium(reduced: &mut Reduced, tolerance: f64, half: usize, end: usize) {
    let moments = &reduced.moments;
    let smooth = |of: fn(&Moment) -> f64| smoothed(&moments.iter().map(of).collect::<Vec<_>>(), half);
    let (front, back) = (smooth(|m| m.stress_incident_face), smooth(|m| m.stress_one_wave));
    let imbalance: Vec<f64> = front.iter().zip(&back).map(|(f, b)| 2.0 * (f - b).abs() / (f + b).abs()).collect();
    let agree = longest(&imbalance[..end], tolerance);
    if (agree.len() as f64) < SHORTEST * end as f64 || agree.is_empty() {
        reduced.warnings.push(format!(
            "the forces of the two faces agree to {:.0} % for less than a tenth of the loading: no curve; a larger \
             limit of their difference (equilibrium) gives one",
            100.0 * tolerance
        ));
        return;
    }
    let whole = agree.end == end;
    let (from, end) = (agree.start, agree.end);
    let settled = &moments[agree];
    reduced.equilibrium_from_s = Some(moments[from].time_s);
    reduced.equilibrium_until_s = (!whole).then(|| moments[end - 1].time_s);
    reduced.equilibrium_from_strain = Some(moments[from].strain);
    reduced.imbalance = Some(imbalance[from..end].iter().fold(0.0, |top, r| top.max(*r)));
    reduced.mean_rate = Some(settled.iter().map(|m| m.rate).sum::<f64>() / settled.len() as f64);
    reduced.mean_rate_between_s = Some([moments[from].time_s, moments[end - 1].time_s]);
    reduced.curve = knots(settled, &front[from..end], &back[from..end], stress_noise(&reduced.setup, reduced.noise));
}

/// Returns the standard deviation of the mean stress of the faces, Pa, due to the noise of the gauges. The incident gauge records two pulses.
fn stress_noise(setup: &Setup, [incident, transmitted]: [f64; 2]) -> f64 {
    let force = |bar: &ElasticBar| bar.modulus * bar.area / setup.area;
    0.5 * (std::f64::consts::SQRT_2 * force(&setup.incident) * incident).hypot(force(&setup.transmitted) * transmitted)
}

/// Returns the knots: means over equal ranges of strain, and over parts of them if the curve bends.
fn knots(settled: &[Moment], front: &[f64], back: &[f64], noise: f64) -> Vec<Knot> {
    let (first, last) = settled.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), m| (a.min(m.strain), b.max(m.strain)));
    let rows = Rows { settled, faces: front.iter().zip(back).map(|(f, b)| 0.5 * (f - b)).collect(), noise };
    let faces = rows.faces_of(0..settled.len());
    let largest = settled.iter().fold(0.0_f64, |top, m| top.max(m.stress));
    let range = |m: &Moment| (((m.strain - first) / (last - first) * KNOTS as f64) as usize).min(KNOTS - 1);
    let mut members = vec![Vec::new(); KNOTS];
    for (i, m) in settled.iter().enumerate().filter(|(_, m)| m.strain > 0.0 && m.stress > 0.0) {
        members[range(m)].push(i);
    }
    members.iter().flat_map(|members| rows.knots(members, faces, FINE * largest)).collect()
}

/// Rows of the history from which the curve is computed.
struct Rows<'a> {
    settled: &'a [Moment],
    /// Half the difference of the stresses at the faces, Pa.
    faces: Vec<f64>,
    /// Standard deviation of a stress due to the noise of the gauges, Pa.
    noise: f64,
}

impl Rows<'_> {
    /// Returns the knot of a range of rows, or those of its halves if the curve bends in it by more than `limit` (Pa).
    fn knots(&self, members: &[usize], faces: f64, limit: f64) -> Vec<Knot> {
        let bend = self.bend(members).unwrap_or(0.0);
        // The stresses of the faces cross repeatedly while waves propagate through the specimen. A bend as small as their difference may be such a
        // wave.
        if bend > limit.max(faces).max(self.faces_of(members.iter().copied())) && members.len() >= 2 * FEWEST_ROWS {
            let (before, after) = members.split_at(members.len() / 2);
            return [before, after].into_iter().flat_map(|half| self.knots(half, faces, limit)).collect();
        }
        let count = members.len() as f64;
        let stress = self.mean(members, |m| m.stress);
        // The scatter within a range includes the slope of the curve, which makes the interval slightly wider.
        let scatter = self.mean(members, |m| (m.stress - stress).powi(2)).sqrt().max(self.noise) / count.sqrt();
        let knot = Knot {
            strain: self.mean(members, |m| m.strain),
            stress,
            half_width: (HALF_95 * scatter).hypot(faces) + bend,
            rate: self.mean(members, |m| m.rate),
        };
        (members.len() > 1).then_some(knot).into_iter().collect()
    }

    /// Returns the distance of the mean stress from the curve due to its bend, Pa, from the mean of the middle third of the rows and the line through
    /// the means of the outer thirds. `None` if there are too few rows, or if the bend is within the noise.
    fn bend(&self, members: &[usize]) -> Option<f64> {
        let third = members.len() / 3;
        if third == 0 {
            return None;
        }
        let middle = third..members.len() - third;
        let [a, b, c] = [&members[..third], &members[middle.clone()], &members[middle.end..]]
            .map(|part| (self.mean(part, |m| m.strain), self.mean(part, |m| m.stress)));
        let line = a.1 + (c.1 - a.1) * (b.0 - a.0) / (c.0 - a.0);
        let error = self.noise * (1.5 / third as f64).sqrt();
        (a.0 < b.0 && b.0 < c.0 && (b.1 - line).abs() > BEYOND_NOISE * error)
            .then(|| OF_A_PARABOLA * (b.1 - line).abs())
    }

    /// Returns half the root mean square difference of the faces, Pa.
    fn faces_of(&self, members: impl ExactSizeIterator<Item = usize>) -> f64 {
        let count = members.len() as f64;
        (members.map(|i| self.faces[i].powi(2)).sum::<f64>() / count).sqrt()
    }

    fn mean(&self, members: &[usize], of: impl Fn(&Moment) -> f64) -> f64 {
        members.iter().map(|&i| of(&self.settled[i])).sum::<f64>() / members.len() as f64
    }
}

/// Adds the standard errors of the zero offsets (incident, transmitted) to the intervals of the curve. An error of the incident gauge changes the
/// force on its face twice and does not change the strain. An error of the transmission gauge changes the force on its face and, increasing with
/// time, the strain.
fn add_offset_errors(reduced: &mut Reduced, errors: [f64; 2]) {
    let (one, two) = (&reduced.setup.incident, &reduced.setup.transmitted);
    let force = [one, two].map(|bar| bar.modulus * bar.area / reduced.setup.area);
    let knots = reduced.curve.clone();
    for (k, knot) in reduced.curve.iter_mut().enumerate() {
        let (a, b) = (&knots[k.saturating_sub(1)], &knots[(k + 1).min(knots.len() - 1)]);
        let slope = if b.strain > a.strain { (b.stress - a.stress) / (b.strain - a.strain) } else { 0.0 };
        let time = reduced.moments.iter().find(|m| m.strain >= knot.strain).map_or(0.0, |m| m.time_s);
        let strain = two.c0() * time / reduced.setup.length;
        let [first, second] = [force[0] * errors[0], (0.5 * force[1] + slope * strain) * errors[1]];
        knot.half_width = knot.half_width.hypot(HALF_95 * first.hypot(second));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangular_pulses_reduce_to_what_they_were_made_of() {
        let bar = ElasticBar { modulus: 200e9, density: 8000.0, area: 2e-4, distance: 1.0 };
        let setup = Setup { incident: bar, transmitted: bar, length: 0.01, area: 1e-4 };
        // Incident 1e-3 for 100 us; the specimen reflects half of it and transmits half.
        let delay = bar.delay();
        let on = |t: f64| if (0.0..100e-6).contains(&t) { -1e-3 } else { 0.0 };
        let time: Vec<f64> = (0..8000).map(|k| f64::from(k) * 1e-7 - 5e-5).collect();
        let incident = time.iter().map(|&t| on(t) - 0.5 * on(t - 2.0 * delay)).collect();
        let transmitted = time.iter().map(|&t| 0.5 * on(t - 2.0 * delay)).collect();
        let records = Records { incident: (time.clone(), incident), transmitted: (time, transmitted) };
        let options = Options { equilibrium: 0.05, ..Options::default() };
        let reduced = reduce(&setup, &records, &options).expect("a test");
        assert_eq!(reduced.sense, Sense::Compression);
        assert!((reduced.window_s - 100e-6).abs() < 3e-7, "{}", reduced.window_s);
        let middle = reduced.moments[reduced.moments.len() / 2];
        // Rate 2 c 5e-4/L = 500 1/s, stress E (A/A_s) 5e-4 = 200 MPa, by one wave and by three.
        for rate in [middle.rate, middle.rate_one_wave] {
            assert!((rate / 500.0 - 1.0).abs() < 1e-9, "{rate}");
        }
        for stress in [middle.stress, middle.stress_one_wave, middle.stress_incident_face] {
            assert!((stress / 200e6 - 1.0).abs() < 1e-9, "{stress:e}");
        }
        assert!((middle.strain / (500.0 * middle.time_s) - 1.0).abs() < 0.01);
        assert!(reduced.equilibrium_from_s.is_some_and(|t| t < 5e-6) && reduced.curve.len() > 30);
    }
}

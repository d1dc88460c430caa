//! Lateral inertia (Love): waves of wave number k travel at the phase velocity `c0/sqrt(1 + (nu r k)^2)`, where r is
//! the polar radius of gyration of the section. Over a distance X a pulse sigma(x) becomes `sigma + (l^3/3) sigma'''`
//! if it is smooth over the length `l = (3 (nu r)^2 X/2)^(1/3)`; sharper edges spread to a width of about l. In both
//! cases the change equals the sum of `l |third difference|/3` over places l apart. This sum is computed here, from the
//! stresses that the ends and joints impose and X = c0 times the duration of the run.

use super::finding::Finding;
use super::{AuditRow, Case};
use crate::bar::{EndCondition, Joint, Segment};
use crate::units::{Dimension, System, format};

/// Largest number of times at which a pulse is read.
const SAMPLES: usize = 4096;

/// Pulse that enters the bar, and the segment through which it travels.
struct Pulse<'a> {
    segment: &'a Segment,
    /// Stress against time, on a scale that all pulses share.
    stress: Box<dyn Fn(f64) -> f64 + 'a>,
}

impl Pulse<'_> {
    /// Returns the time between 10 % and 90 % of the largest stress, s.
    fn rise_time(&self, until: f64) -> f64 {
        let at = |i: usize| (self.stress)(i as f64 * until / SAMPLES as f64).abs();
        let largest = (0..=SAMPLES).map(at).fold(0.0, f64::max);
        let reaches = |part: f64| (0..=SAMPLES).find(|&i| at(i) >= part * largest).unwrap_or(0);
        (reaches(0.9) - reaches(0.1)) as f64 * until / SAMPLES as f64
    }
}

/// Sizes of the pulses and of their changes by lateral inertia.
#[derive(Debug, Default, Clone, Copy)]
struct Sizes {
    /// L1 norm of the change, Pa m.
    change: f64,
    /// L1 norm of the stress, Pa m.
    stress: f64,
    /// Radius of the section (m) and rise time (s) of the pulse with the largest change, and this change (Pa m).
    worst: (f64, f64, f64),
}

/// Returns the row with the estimate for a run.
pub(super) fn row(case: &Case<'_>) -> AuditRow {
    finding(case).row("lateral-inertia", case.tolerance)
}

fn finding(case: &Case<'_>) -> Finding {
    if !case.bar.area_given {
        return Finding::unknown("the scene gives no cross-section");
    }
    if case.ends.iter().any(|end| matches!(end, EndCondition::Ball { .. })) {
        return Finding::unknown("the pulse of a ball is not known in advance");
    }
    if case.bar.segments.iter().any(|segment| segment.initial.stress != 0.0 || segment.profile.is_some()) {
        return Finding::unknown("the waves from an initial state are not known in advance");
    }
    let pulses = pulses(case);
    if pulses.is_empty() {
        return Finding::nothing("the bar is not loaded");
    }
    if let Some(unknown) = pulses.iter().find(|p| p.segment.material.poisson.is_none()) {
        return Finding::lacks(&unknown.segment.material.name, "`poisson`");
    }
    let sizes = pulses.iter().fold(Sizes::default(), |all, pulse| all.and(pulse, case));
    if sizes.stress <= 0.0 {
        return Finding::nothing("the bar is not loaded");
    }
    let (radius, rise, _) = sizes.worst;
    let basis = std::format!(
        "bar radius {}, rise time {}",
        format(radius, Dimension::Length, System::Si),
        format(rise, Dimension::Time, System::Si),
    );
    let estimate = (sizes.change / sizes.stress).min(1.0);
    let finding = Finding::of(estimate, "lateral inertia", &basis, "lateral-inertia = true");
    match excluded(case) {
        Some(what) => finding.not_with(what),
        None => finding,
    }
}

/// Returns the feature of the scene that no method simulates together with lateral inertia; `None` if there is none.
fn excluded(case: &Case<'_>) -> Option<&'static str> {
    let any = |has: fn(&Segment) -> bool| case.bar.segments.iter().any(has);
    let parts = [
        (any(|segment| matches!(segment.joint, Joint::Contact { .. })), "contact joints"),
        (any(|segment| segment.taper.is_some()), "tapers"),
        (!case.off.rupture, "`rupture`"),
    ];
    parts.into_iter().find_map(|(has, what)| has.then_some(what))
}

impl Sizes {
    fn and(self, pulse: &Pulse<'_>, case: &Case<'_>) -> Self {
        let material = &pulse.segment.material;
        let (c0, nu) = (material.c0(), material.poisson.unwrap_or(0.0));
        // The section is assumed to be round: its polar radius of gyration is radius/sqrt(2).
        let radius = (pulse.segment.area / std::f64::consts::PI).sqrt();
        let a = nu * radius / std::f64::consts::SQRT_2;
        let width = (1.5 * a * a * c0 * case.until).cbrt();
        if width <= 0.0 {
            return self;
        }
        let step = (width / c0).max(case.until / SAMPLES as f64);
        let count = (case.until / step).ceil() as usize + 1;
        // Zeros before and after the pulse, and readings inside the steps, include edges at the very start completely.
        // The largest value in each step is used, so that no pulse is too short to be found.
        let inside = (SAMPLES / count).max(1);
        let at = |i: usize, k: usize| (pulse.stress)(((i - 3) as f64 + (k as f64 + 0.5) / inside as f64) * step);
        let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        let read = |i: usize| if i < 3 { 0.0 } else { (0..inside).map(|k| at(i, k)).fold(0.0, larger) };
        let values: Vec<f64> = (0..count + 3).map(read).collect();
        let third = |w: &[f64]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs();
        let change = width / 3.0 * values.windows(4).map(third).sum::<f64>();
        Self {
            change: self.change + change,
            stress: self.stress + c0 * step * largest_window(&values, (case.bar.transit_time() / step).ceil() as usize),
            worst: if change > self.worst.2 { (radius, pulse.rise_time(case.until), change) } else { self.worst },
        }
    }
}

/// Returns the largest sum of magnitudes over `length` consecutive values.
fn largest_window(values: &[f64], length: usize) -> f64 {
    let (mut sum, mut largest) = (0.0_f64, 0.0_f64);
    for (i, value) in values.iter().enumerate() {
        sum += value.abs();
        if i >= length {
            sum -= values[i - length].abs();
        }
        largest = largest.max(sum);
    }
    largest
}

fn pulses<'a>(case: &Case<'a>) -> Vec<Pulse<'a>> {
    let segments = &case.bar.segments;
    let mut all: Vec<Pulse<'a>> = Vec::new();
    for (k, segment) in [(0, &segments[0]), (1, &segments[segments.len() - 1])] {
        if let Some(stress) = imposed(case.ends[k], segment, if k == 0 { 1.0 } else { -1.0 }) {
            all.push(Pulse { segment, stress });
        }
    }
    for pair in segments.windows(2) {
        let closing = pair[0].velocity - pair[1].velocity;
        if closing > 0.0 || (closing < 0.0 && pair[0].joint == Joint::Bonded) {
            let z = [0, 1].map(|k| pair[k].material.impedance() * pair[k].area);
            let force = closing.abs() * z[0] * z[1] / (z[0] + z[1]);
            let step = |segment: &'a Segment| Pulse { segment, stress: Box::new(move |_| force / segment.area) };
            all.extend([step(&pair[0]), step(&pair[1])]);
        }
    }
    all
}

/// Returns the elastic stress that an end imposes as a function of time, Pa; `None` if it imposes nothing.
fn imposed<'a>(end: &'a EndCondition, at: &Segment, inward: f64) -> Option<Box<dyn Fn(f64) -> f64 + 'a>> {
    let (impedance, rest) = (at.material.impedance(), at.velocity);
    let constant = |stress: f64, from: f64| -> Option<Box<dyn Fn(f64) -> f64 + 'a>> {
        (stress != 0.0).then(|| Box::new(move |t: f64| if t < from { 0.0 } else { stress }) as Box<_>)
    };
    match end {
        EndCondition::Velocity { history, release } => {
            let until = release.unwrap_or(f64::INFINITY);
            let read = move |t: f64| if t < until { impedance * (history.at(t) - rest) } else { 0.0 };
            Some(Box::new(read))
        }
        EndCondition::Stress { history } => Some(Box::new(move |t| history.at(t))),
        EndCondition::Fixed => constant(impedance * rest, 0.0),
        EndCondition::Wall { gap } if rest * inward < 0.0 => constant(impedance * rest, gap / rest.abs()),
        EndCondition::Striker { mass, velocity } if (velocity - rest) * inward > 0.0 => {
            let (stress, slowing) = (impedance * (velocity - rest), impedance * at.area / mass);
            Some(Box::new(move |t| stress * (-slowing * t).exp()))
        }
        EndCondition::Spring { stiffness } if rest != 0.0 => {
            let rise = stiffness / (impedance * at.area);
            Some(Box::new(move |t: f64| impedance * rest * -(-rise * t).exp_m1()))
        }
        EndCondition::Dashpot { coefficient } => {
            constant(impedance * rest * coefficient / (impedance * at.area + coefficient), 0.0)
        }
        _ => None,
    }
}

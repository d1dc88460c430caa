//! What a run left out: effects that were off, and how large they would have been.

use super::AuditRow;
use crate::bar::Launch;
use crate::material::{Material, Sense};
use crate::units::{Dimension, System, format};

/// Share of its largest strain by which a yielded place must go back before it counts as unloaded: the ripples of the
/// scheme stay below it but for a few cells next to a struck end.
const UNLOADED_BY: f64 = 0.02;

/// Share of the yielded places that must have unloaded before unloading is called neglected.
const UNLOADING_THRESHOLD: f64 = 0.02;

/// Rise in temperature from which heating is called neglected, K: it then softens common metals by more than 1 %.
const HEATING_THRESHOLD: f64 = 20.0;

/// Watches whether yielded points unload in a run without unloading.
#[derive(Debug)]
pub struct UnloadingWatch {
    /// Elastic limit strain of every place that is watched.
    limit: Vec<f64>,
    largest: Vec<f64>,
    now: Vec<f64>,
    /// Places that went back, and the first of them: (time, index).
    unloaded: Vec<bool>,
    first: Option<(f64, usize)>,
    worst: f64,
}

impl UnloadingWatch {
    /// A watch over places, evenly spaced or nearly so; `limit` is the elastic limit strain at each.
    pub fn new(limit: Vec<f64>) -> Self {
        let places = limit.len();
        let zeros = vec![0.0; places];
        Self { limit, largest: zeros.clone(), now: zeros, unloaded: vec![false; places], first: None, worst: 0.0 }
    }

    /// Looks at the bar at `time`; `read` fills in the strain at every place.
    pub fn look(&mut self, time: f64, read: impl FnOnce(&mut [f64])) {
        read(&mut self.now);
        for place in 0..self.now.len() {
            let size = self.now[place].abs();
            self.largest[place] = self.largest[place].max(size);
            let drop = 1.0 - size / self.largest[place];
            if self.largest[place] > self.limit[place] && drop > UNLOADED_BY {
                self.worst = self.worst.max(drop);
                self.unloaded[place] = true;
                self.first.get_or_insert((time, place));
            }
        }
    }

    /// The finding, where there is one; `unit` names the places: "cells" or "samples".
    pub fn row(&self, x: &[f64], unit: &str) -> Option<AuditRow> {
        let (time, place) = self.first?;
        let count = self.unloaded.iter().filter(|&&u| u).count();
        let yielded = self.largest.iter().zip(&self.limit).filter(|(l, y)| l > y).count();
        let share = count as f64 / yielded.max(1) as f64;
        if share < UNLOADING_THRESHOLD {
            return None;
        }
        let message = std::format!(
            "unloading: {count} of {yielded} yielded {unit} went back by up to {:.0} % of their strain after yielding, first seen at \
             t = {}, x = {}; the curve was followed back, which returns plastic work. Switch on with \
             [effects] unloading = \"isotropic\"",
            100.0 * self.worst,
            format(time, Dimension::Time, System::Si),
            format(x[place], Dimension::Length, System::Si),
        );
        Some(AuditRow { effect: "unloading".into(), estimate: share, threshold: UNLOADING_THRESHOLD, message })
    }
}

/// An impact above the critical velocity, seen before the first step.
pub fn above_critical(launch: &Launch, material: &Material, critical_velocity: f64) -> Option<AuditRow> {
    launch.fan.above_critical.then(|| {
        let message = std::format!(
            "rupture: the bar is driven from the {} beyond what {} can carry away ({} at {}); strain gathers there, \
             the bar breaks at that place at t = 0, and goes on under the ultimate stress",
            launch.origin,
            material.name,
            format(critical_velocity, Dimension::Velocity, System::Si),
            format(launch.fan.stress, Dimension::Stress, System::Si),
        );
        AuditRow { effect: "rupture".into(), estimate: launch.fan.strain, threshold: launch.fan.strain, message }
    })
}

/// A place whose strain went past the end of its material's data.
pub fn past_data(strain: f64, time: f64, x: f64, material: &Material) -> AuditRow {
    let end = material.branch(Sense::of(strain)).last_strain();
    let message = std::format!(
        "rupture: the strain passed the end of the data of {} ({end:.4}) at t = {}, x = {}; the bar went on under the \
         largest stress of the curve",
        material.name,
        format(time, Dimension::Time, System::Si),
        format(x, Dimension::Length, System::Si),
    );
    AuditRow { effect: "rupture".into(), estimate: strain.abs(), threshold: end, message }
}

/// An end that was driven beyond what the curve can carry away, at some time after the start.
pub fn broken_end(end: &str, time: f64, material: &Material) -> AuditRow {
    let strain = material.tension.ultimate().map_or(f64::NAN, |u| u.strain);
    let message = std::format!(
        "rupture: from t = {} the {end} end is driven beyond what {} can carry away; strain gathers there, the bar breaks at \
         that place, and goes on under the ultimate stress",
        format(time, Dimension::Time, System::Si),
        material.name,
    );
    AuditRow { effect: "rupture".into(), estimate: strain, threshold: strain, message }
}

/// A place inside the bar at which the curve can carry no more while its two sides go on apart or together.
pub fn broken_inside(time: f64, x: f64, material: &Material) -> AuditRow {
    let strain = material.tension.ultimate().map_or(f64::NAN, |u| u.strain);
    let message = std::format!(
        "rupture: from t = {} on, strain gathers at x = {}, where waves met and {} can carry no more; the bar breaks at that \
         place, and goes on under the ultimate stress",
        format(time, Dimension::Time, System::Si),
        format(x, Dimension::Length, System::Si),
        material.name,
    );
    AuditRow { effect: "rupture".into(), estimate: strain, threshold: strain, message }
}

/// Why a run stops whose strain is past the end of data that are said to be all there is, and what to do.
pub fn end_of_data(strain: f64, material: &Material) -> (String, &'static str) {
    let reason = std::format!(
        "strain {:.4} is past the end of the data of {} ({:.4})",
        strain.abs(),
        material.name,
        material.branch(Sense::of(strain)).last_strain()
    );
    (reason, "give the material more data, or say what happens there with beyond = \"rupture\" or \"extend\"")
}

/// Flow by Malvern's law that is quicker than a time step: the net, not the material, then says how wide fronts are.
pub fn unresolved_flow(k: f64, dt: f64) -> Option<AuditRow> {
    let k_dt = k * dt;
    (k_dt > 1.0).then(|| AuditRow {
        effect: "rate".into(),
        estimate: k_dt,
        threshold: 1.0,
        message: std::format!(
            "rate: the overstress relaxes within a time step (k dt = {k_dt:.3}), so plastic fronts are as wide as the cells make \
             them, not the material; give more `cells`, or leave `rate` out for fronts without width"
        ),
    })
}

/// Adiabatic heating of the most strained place of a material, where it states its specific heat; `plastic_strain` is the
/// accumulated one there.
pub fn heating(material: &Material, plastic_strain: f64) -> Option<AuditRow> {
    if material.heating.is_some() {
        return None;
    }
    let specific_heat = material.constants.heat.specific_heat?;
    let fraction = material.constants.heat.fraction.unwrap_or(0.9);
    let rise = fraction * plastic_work(material, plastic_strain) / (material.density * specific_heat);
    (rise > HEATING_THRESHOLD).then(|| AuditRow {
        effect: "heat".into(),
        estimate: rise,
        threshold: HEATING_THRESHOLD,
        message: std::format!(
            "heat: plastic work would warm {} by up to {rise:.0} K if none flowed away; the curve was taken as cold",
            material.name
        ),
    })
}

/// Work per volume of plastic straining up to `plastic_strain` along the curve, J/m^3, by the trapezoidal rule.
fn plastic_work(material: &Material, plastic_strain: f64) -> f64 {
    let curve = &material.tension;
    let knots: Vec<(f64, f64)> =
        curve.strain().iter().zip(curve.stress()).map(|(e, s)| (e - s / material.modulus, *s)).collect();
    let mut work = 0.0;
    for pair in knots.windows(2) {
        let ((p0, s0), (p1, s1)) = (pair[0], pair[1]);
        if p1 <= p0 || p0 >= plastic_strain {
            continue;
        }
        let end = p1.min(plastic_strain);
        let s_end = s0 + (s1 - s0) * (end - p0) / (p1 - p0);
        work += 0.5 * (s0 + s_end) * (end - p0);
    }
    work
}

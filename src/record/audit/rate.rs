//! Neglected rate dependence, estimated from the plastic strain rates of the run.
//!
//! The rate is the plastic strain that a place gains between two samples, over the time between them: 1/64 of the run.
//! A fan that takes longer to pass has this rate. A front that is a discontinuity has no rate of its own (on a grid it
//! has that of the grid); the rate is then a mean over the time in which a wave travels 1/64 of its total distance. The
//! estimate needs no more detail: by Malvern's law the overstress of a passing front, integrated over time, is
//! `E d eps_p/k` however short the front is; by the other laws it grows with the logarithm or a small power of the
//! rate. Between samples the overstress of a place relaxes as the law predicts at constant strain. Under a lasting load
//! the strain is not constant: waves from the loaded end keep the place flowing, so that the overstress is at least
//! that of the mean rate since the place yielded.
//!
//! Without rate dependence, the bar ahead of the plastic waves is at its elastic limit and does not flow. With rate
//! dependence the elastic precursor carries a larger stress there: the overstress of its own strain rate, which
//! relaxes. It never exceeds the elastic stress of the largest plastic strain in the bar.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::finding::Finding;
use super::places::Places;
use super::spread::Spread;
use super::{AuditRow, Reading};
use crate::law::rate::{Driven, Overstress};
use crate::material::{Material, Rate, Sense};

/// Fraction of its largest stress down to which a place counts as loaded, and fraction of the elastic limit from which
/// it counts as having reached it.
const LOADED: f64 = 0.9;
const AT_LIMIT: f64 = 0.99;

/// Smallest gain of plastic strain that counts as flow, relative to the plastic strain of the place: smaller gains are
/// numerical oscillations and rounding.
const FLOWED: f64 = 1e-3;

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct RateRise {
    /// Media of each segment; `None` if the material states no rate dependence.
    #[serde(skip)]
    pub(super) media: Vec<Option<Medium>>,
    places: Vec<Place>,
    /// Largest plastic strain in the bar so far times Young's modulus, Pa.
    elastic: f64,
    spread: Spread,
    /// Largest change of all samples, Pa m.
    change: f64,
    /// Highest plastic strain rate: rate (1/s), relative rise of the flow stress, time (s), place.
    quickest: Option<(f64, f64, f64, usize)>,
}

/// Constants of a rate-dependent material.
#[derive(Debug, Clone, Copy)]
pub(super) struct Medium {
    law: Overstress,
    modulus: f64,
    /// Elastic limits in tension and compression, Pa.
    limits: [f64; 2],
}

impl Medium {
    fn of(material: &Arc<Material>) -> Option<Self> {
        let (law, modulus) = (Overstress::of(Rate::Material, material)?, material.modulus);
        let limit = |sense| material.branch(sense).elastic_limit(modulus).1;
        Some(Self { law, modulus, limits: [Sense::Tension, Sense::Compression].map(limit) })
    }
}

/// State of a place at a sample.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// Time of the sample, s.
    time: f64,
    /// Time since the previous sample, s.
    lapse: f64,
    stress: f64,
    plastic: f64,
}

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Place {
    /// Time of the sample before the place yielded, s.
    yielded: Option<f64>,
    plastic: f64,
    /// Overstress, Pa.
    overstress: f64,
    /// Largest quasi-static stress so far, Pa.
    flow: f64,
}

impl Place {
    /// Advances the overstress of the place by one sample; returns the plastic strain rate, 1/s.
    fn sample(&mut self, medium: &Medium, step: Step) -> f64 {
        let Medium { law, modulus, limits } = *medium;
        let Step { time, lapse, stress, plastic } = step;
        let limit = limits[usize::from(stress < 0.0)];
        if self.yielded.is_none() && plastic <= 0.0 && stress.abs() < AT_LIMIT * limit {
            return 0.0;
        }
        self.flow = self.flow.max(stress.abs());
        let gained = plastic - self.plastic;
        let rate = if gained > FLOWED * plastic { gained / lapse } else { 0.0 };
        self.plastic = self.plastic.max(plastic);
        if self.overstress > 0.0 {
            let relaxing = Driven { excess: self.overstress, rise: 0.0, time: lapse };
            self.overstress -= law.flow(relaxing, 1.0, self.flow);
        }
        let passing = if self.yielded.is_none() { limit / (modulus * lapse) } else { 0.0 };
        let since = *self.yielded.get_or_insert(time - lapse);
        let lasting = if stress.abs() >= LOADED * self.flow { self.plastic / (time - since) } else { 0.0 };
        let strain_rate = rate.max(passing).max(lasting);
        if strain_rate > 0.0 {
            self.overstress = self.overstress.max(law.overstress(modulus * strain_rate, self.flow));
        }
        rate
    }
}

impl RateRise {
    pub fn new(materials: &[Arc<Material>], places: usize, spread: Spread) -> Self {
        let media = materials.iter().map(Medium::of).collect();
        Self { media, places: vec![Place::default(); places], elastic: 0.0, spread, change: 0.0, quickest: None }
    }

    pub fn sample(&mut self, now: &Reading, places: &Places) {
        if now.lapse <= 0.0 {
            return;
        }
        let moduli = places.segment.iter().map(|&segment| self.media[segment].map_or(0.0, |medium| medium.modulus));
        self.elastic =
            moduli.zip(&now.plastic).fold(self.elastic, |most, (modulus, plastic)| most.max(modulus * plastic));
        let mut changes = vec![0.0; self.places.len()];
        for (k, place) in self.places.iter_mut().enumerate() {
            let Some(medium) = &self.media[places.segment[k]] else { continue };
            let step = Step { time: now.time, lapse: now.lapse, stress: now.stress[k], plastic: now.plastic[k] };
            let rate = place.sample(medium, step);
            place.overstress = place.overstress.min(self.elastic);
            if rate > self.quickest.map_or(0.0, |q| q.0) {
                self.quickest = Some((rate, place.overstress / place.flow, now.time, k));
            }
            changes[k] = place.overstress;
        }
        let spread = self.spread.sample(now, &changes);
        self.change = self.change.max(places.integral(&changes)).max(spread);
    }

    pub fn finding(&self, materials: &[Arc<Material>], places: &Places, share: impl Fn(f64) -> f64) -> Finding {
        if self.media.iter().all(Option::is_none) {
            return Finding::lacks(&materials[0].name, "constants in [rate]");
        }
        let Some((rate, rise, time, place)) = self.quickest else {
            return Finding::nothing("no material with [rate] constants deformed plastically");
        };
        let basis = std::format!(
            "plastic strain rate of {} up to {rate:.2e} 1/s, which raises its flow stress by {:.1} %, at {}",
            materials[places.segment[place]].name,
            100.0 * rise,
            places.moment(time, place),
        );
        Finding::of(share(self.change), "rate dependence", &basis, "rate = \"material\"")
    }
}

/// Returns the row for Malvern's law with a relaxation time below the time step, when the grid and not the material
/// determines the width of fronts; `None` if the relaxation is resolved.
pub fn unresolved_flow(k: f64, dt: f64) -> Option<AuditRow> {
    let k_dt = k * dt;
    (k_dt > 1.0).then(|| AuditRow {
        effect: "rate".into(),
        estimate: k_dt,
        threshold: 1.0,
        finding: std::format!(
            "the overstress relaxes within one time step (k dt = {k_dt:.3}), so the width of plastic fronts is set by the grid, not \
             by the material; use more `cells`, or remove `rate` for sharp fronts"
        ),
        ..AuditRow::default()
    })
}

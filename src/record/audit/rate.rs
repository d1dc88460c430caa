//! Neglected rate dependence, estimated from the plastic strain rates of the run.
//!
//! The rate is the plastic strain that a place gains between two looks, over the time between them: 1/64 of the run. A
//! fan that takes longer to pass has this rate; a front that is a jump has none of its own (on a grid it has the grid's),
//! and then this is the mean over a time in which a wave crosses a sixty-fourth of its way. What the estimate needs is not
//! more: by Malvern's law the overstress of a passing front, added up over time, is `E d eps_p/k` however short it is; by
//! the others it grows with the logarithm or a small power of the rate. Between looks the overstress of a place relaxes as
//! the law has it at constant strain. Under a load that lasts strain is not constant: waves from the loaded end keep the place flowing, so that
//! the overstress is at least that of the mean rate since the place yielded.
//!
//! Ahead of the plastic waves a bar that flows at once is at its elastic limit and does not flow. With a rate the wave in front
//! carries more there: the overstress of its own strain rate, which relaxes. It is never more than the stress of the largest plastic strain in the bar,
//! were that elastic.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::finding::Finding;
use super::places::Places;
use super::spread::Spread;
use super::{AuditRow, Reading};
use crate::law::rate::{Driven, Overstress};
use crate::material::{Material, Rate, Sense};

/// Part of its largest stress down to which a place counts as loaded, and part of its elastic limit from which it counts as having come to it.
const LOADED: f64 = 0.9;
const AT_LIMIT: f64 = 0.99;

/// Plastic strain that counts as flow, as a part of what the place has gained: less is ripples and rounding.
const FLOWED: f64 = 1e-3;

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct RateRise {
    /// By segment; none where the material states no rate.
    #[serde(skip)]
    pub(super) media: Vec<Option<Medium>>,
    places: Vec<Place>,
    /// Largest plastic strain in the bar so far, times Young's modulus, Pa.
    elastic: f64,
    spread: Spread,
    /// Largest of all looks, Pa m.
    change: f64,
    /// Highest rate: 1/s, rise of the flow stress, time, place.
    quickest: Option<(f64, f64, f64, usize)>,
}

/// A material whose flow takes time.
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

/// What a place does from one look to the next.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// s.
    time: f64,
    /// s.
    lapse: f64,
    stress: f64,
    plastic: f64,
}

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Place {
    /// When it yielded, s, at the look before.
    yielded: Option<f64>,
    plastic: f64,
    /// Pa.
    overstress: f64,
    /// Largest static stress so far, Pa.
    flow: f64,
}

impl Place {
    /// Goes on by one look; returns the plastic strain rate, 1/s.
    fn look(&mut self, medium: &Medium, step: Step) -> f64 {
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

    pub fn look(&mut self, now: &Reading, places: &Places) {
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
            let rate = place.look(medium, step);
            place.overstress = place.overstress.min(self.elastic);
            if rate > self.quickest.map_or(0.0, |q| q.0) {
                self.quickest = Some((rate, place.overstress / place.flow, now.time, k));
            }
            changes[k] = place.overstress;
        }
        let spread = self.spread.look(now, &changes);
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

/// Flow by Malvern's law with a relaxation time below the time step: the net, not the material, then determines the width of fronts.
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

//! Neglected rate dependence, estimated from the plastic strain rates of the run.
//!
//! The rate is the plastic strain that a place gains between two looks, over the time between them: 1/64 of the run. A
//! fan that takes longer to pass has this rate; a front that is a jump has none of its own (on a grid it has the grid's),
//! and then this is the mean over a time in which a wave crosses a sixty-fourth of its way. What the estimate needs is not
//! more: by Malvern's law the overstress of a passing front, added up over time, is `E d eps_p/k` however short it is; by
//! the others it grows with the logarithm or a small power of the rate. Between looks the overstress of a place relaxes as
//! the law has it at constant strain, and it is never more than the stress of the same strain without any flow.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::finding::Finding;
use super::places::Places;
use super::{AuditRow, Reading};
use crate::law::rate::{Driven, Overstress};
use crate::material::{Material, Rate};

/// Plastic strain that counts as flow, as a part of what the place has gained: less is ripples and rounding.
const FLOWED: f64 = 1e-3;

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct RateRise {
    /// By segment; none where the material states no rate.
    #[serde(skip)]
    pub(super) media: Vec<Option<(Overstress, f64)>>,
    places: Vec<Place>,
    /// Largest of all looks, Pa m.
    change: f64,
    /// Highest rate: 1/s, rise of the flow stress, time, place.
    quickest: Option<(f64, f64, f64, usize)>,
}

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Place {
    plastic: f64,
    /// Pa.
    overstress: f64,
    /// Largest static stress so far, Pa.
    flow: f64,
}

impl Place {
    /// Goes on by one look; returns the plastic strain rate, 1/s.
    fn look(&mut self, (law, modulus): (Overstress, f64), lapse: f64, stress: f64, plastic: f64) -> f64 {
        self.flow = self.flow.max(stress.abs());
        let gained = plastic - self.plastic;
        let rate = if gained > FLOWED * plastic { gained / lapse } else { 0.0 };
        self.plastic = self.plastic.max(plastic);
        if self.overstress > 0.0 {
            let relaxing = Driven { excess: self.overstress, rise: 0.0, time: lapse };
            self.overstress -= law.flow(relaxing, 1.0, self.flow);
        }
        if rate > 0.0 {
            self.overstress = self.overstress.max(law.overstress(modulus * rate, self.flow));
        }
        self.overstress = self.overstress.min(modulus * self.plastic);
        rate
    }
}

impl RateRise {
    pub fn new(materials: &[Arc<Material>], places: usize) -> Self {
        let media = materials.iter().map(|m| Overstress::of(Rate::Material, m).map(|law| (law, m.modulus))).collect();
        Self { media, places: vec![Place::default(); places], change: 0.0, quickest: None }
    }

    pub fn look(&mut self, now: &Reading, places: &Places) {
        let mut change = 0.0;
        for (k, place) in self.places.iter_mut().enumerate() {
            let Some(medium) = self.media[places.segment[k]] else { continue };
            if now.plastic[k] <= 0.0 || now.lapse <= 0.0 {
                continue;
            }
            let rate = place.look(medium, now.lapse, now.stress[k], now.plastic[k]);
            if self.quickest.is_none_or(|q| rate > q.0) {
                self.quickest = Some((rate, place.overstress / place.flow, now.time, k));
            }
            change += places.weight[k] * place.overstress;
        }
        self.change = self.change.max(change);
    }

    pub fn finding(&self, materials: &[Arc<Material>], places: &Places, share: impl Fn(f64) -> f64) -> Finding {
        if self.media.iter().all(Option::is_none) {
            return Finding::lacks(&materials[0].name, "constants in [rate]");
        }
        let Some((rate, rise, time, place)) = self.quickest.filter(|q| q.0 > 0.0) else {
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

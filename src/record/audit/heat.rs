//! Adiabatic heating by plastic work, and the resulting softening `((T - Tref)/(Tm - Tref))^m` of the flow stress
//! (Johnson and Cook). To first order the stress of each place decreases by this fraction; unloading spreads the change
//! over the bar.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Reading;
use super::finding::Finding;
use super::places::Places;
use super::spread::Spread;
use crate::material::{DEFAULT_FRACTION, Material, Sense, WorkTable};

/// Ratio by which the plastic strain of a place must have grown before its softening is computed again.
const UPDATE_RATIO: f64 = 1.02;

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Heat {
    /// Media of each segment in tension and compression; `None` if the material does not state all constants of the softening.
    #[serde(skip)]
    pub(super) media: Vec<Option<[Medium; 2]>>,
    /// Softening of each place, preceded by the plastic strain at which it was computed.
    softening: Vec<(f64, f64)>,
    spread: Spread,
    /// Largest change of all samples, Pa m.
    change: f64,
    /// Largest temperature rise: rise (K), softening, time (s), place.
    hottest: Option<(f64, f64, f64, usize)>,
}

/// Thermal constants of a material in one sense.
#[derive(Debug)]
pub(super) struct Medium {
    work: WorkTable,
    /// Temperature rise per plastic work, K per J/m^3.
    rise_per_work: f64,
    /// Melting temperature above the reference temperature, K.
    range: f64,
    exponent: f64,
}

impl Medium {
    fn of(material: &Material, sense: Sense) -> Option<Self> {
        let heat = &material.constants.heat;
        let range = heat.melting_temperature? - heat.reference_temperature?;
        let capacity = material.density * heat.specific_heat?;
        let rise_per_work = heat.fraction.unwrap_or(DEFAULT_FRACTION) / capacity;
        let work = WorkTable::new(material.branch(sense), material.modulus);
        Some(Self { work, rise_per_work, range, exponent: heat.exponent? })
    }

    /// Returns the temperature rise (K) and the fraction of the flow stress that is lost, for a place that gained a
    /// plastic strain after starting with another one.
    fn at(&self, start: f64, gained: f64) -> (f64, f64) {
        let work = self.work.at(start + gained) - self.work.at(start);
        let rise = (self.rise_per_work * work).min(self.range);
        (rise, (rise / self.range).powf(self.exponent))
    }
}

impl Heat {
    pub fn new(materials: &[Arc<Material>], places: usize, spread: Spread) -> Self {
        let both = |m: &Arc<Material>| Some([Medium::of(m, Sense::Tension)?, Medium::of(m, Sense::Compression)?]);
        let media = materials.iter().map(both).collect();
        Self { media, softening: vec![(0.0, 0.0); places], spread, change: 0.0, hottest: None }
    }

    pub fn sample(&mut self, now: &Reading, places: &Places) {
        let mut changes = vec![0.0; self.softening.len()];
        for (k, softening) in self.softening.iter_mut().enumerate() {
            let (Some(senses), plastic) = (&self.media[places.segment[k]], now.plastic[k]) else { continue };
            if plastic > UPDATE_RATIO * softening.0 {
                let (rise, lost) = senses[usize::from(now.strain[k] < 0.0)].at(places.at_start[k], plastic);
                *softening = (plastic, lost);
                if self.hottest.is_none_or(|h| rise > h.0) {
                    self.hottest = Some((rise, lost, now.time, k));
                }
            }
            changes[k] = softening.1 * now.stress[k].abs();
        }
        let spread = self.spread.sample(now, &changes);
        self.change = self.change.max(places.integral(&changes)).max(spread);
    }

    pub fn finding(&self, materials: &[Arc<Material>], places: &Places, share: impl Fn(f64) -> f64) -> Finding {
        if self.media.iter().all(Option::is_none) {
            let missing = materials[0].constants.heat.missing();
            let missing: Vec<String> = missing.iter().map(|key| std::format!("`{key}`")).collect();
            return Finding::lacks(&materials[0].name, &std::format!("{} in [heat]", missing.join(", ")));
        }
        let Some((rise, lost, time, place)) = self.hottest else {
            return Finding::nothing("no material with [heat] constants deformed plastically");
        };
        let basis = std::format!(
            "temperature rise of {} up to {rise:.1} K, which lowers its flow stress by {:.2} %, at {}",
            materials[places.segment[place]].name,
            100.0 * lost,
            places.moment(time, place),
        );
        Finding::of(share(self.change), "adiabatic heating", &basis, "heat = {}")
    }
}

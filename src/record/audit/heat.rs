//! Adiabatic heating by plastic work, and the softening `((T - Tref)/(Tm - Tref))^m` of the flow stress that it brings
//! (Johnson and Cook). Each place loses that share of its stress, to first order.

use std::sync::Arc;

use super::places::Places;
use super::{ELASTIC, Reading};
use crate::law::Table;
use crate::material::{HeatConstants, Material, Sense};
use crate::units::{Dimension, System, format};

/// Fraction of the plastic work that heats where the material does not say (Taylor and Quinney 1934).
const FRACTION: f64 = 0.9;

/// A place's softening is worked out again when its plastic strain has grown by this share.
const WORTH_IT: f64 = 1.02;

#[derive(Debug)]
pub(super) struct Heat {
    /// By segment, in tension and compression; none where the material does not state all that the softening needs.
    media: Vec<Option<[Medium; 2]>>,
    /// Plastic strain at which each place's softening was worked out, and the softening.
    softening: Vec<(f64, f64)>,
    /// Largest of all looks, Pa m.
    change: f64,
    /// Largest rise: K, softening, time, place.
    hottest: Option<(f64, f64, f64, usize)>,
}

/// A material that warms.
#[derive(Debug)]
struct Medium {
    /// Plastic strain, stress, and plastic work up to there, J/m^3.
    knots: Vec<[f64; 3]>,
    /// K per J/m^3.
    rise_per_work: f64,
    /// Melting above reference temperature, K.
    range: f64,
    exponent: f64,
}

impl Medium {
    fn of(material: &Material, sense: Sense) -> Option<Self> {
        let heat = &material.constants.heat;
        let range = heat.melting_temperature? - heat.reference_temperature?;
        let capacity = material.density * heat.specific_heat?;
        let mut knots: Vec<[f64; 3]> = vec![[0.0; 3]];
        let table = Table::new(material.branch(sense), material.modulus);
        let limit = table.yield_stress();
        knots[0][1] = limit;
        let curve = material.branch(sense).running_maximum();
        for (e, s) in curve.strain().iter().zip(curve.stress()).filter(|(_, s)| **s >= limit) {
            let [p0, s0, w0] = knots[knots.len() - 1];
            let p = e - s / material.modulus;
            if p > p0 {
                knots.push([p, *s, w0 + 0.5 * (s0 + s) * (p - p0)]);
            }
        }
        let rise_per_work = heat.fraction.unwrap_or(FRACTION) / capacity;
        Some(Self { knots, rise_per_work, range, exponent: heat.exponent? })
    }

    /// Plastic work up to a plastic strain, J/m^3; past the last knot at the stress there.
    fn work(&self, plastic: f64) -> f64 {
        let k = self.knots.partition_point(|knot| knot[0] <= plastic).max(1) - 1;
        let [p0, s0, w0] = self.knots[k];
        let slope = self.knots.get(k + 1).map_or(0.0, |next| (next[1] - s0) / (next[0] - p0));
        let flow = plastic - p0;
        w0 + flow * (s0 + 0.5 * slope * flow)
    }

    /// K, and the share of the flow stress that is lost.
    fn at(&self, plastic: f64) -> (f64, f64) {
        let rise = (self.rise_per_work * self.work(plastic)).min(self.range);
        (rise, (rise / self.range).powf(self.exponent))
    }
}

impl Heat {
    pub fn new(materials: &[Arc<Material>], places: usize) -> Self {
        let both = |m: &Arc<Material>| Some([Medium::of(m, Sense::Tension)?, Medium::of(m, Sense::Compression)?]);
        let media = materials.iter().map(both).collect();
        Self { media, softening: vec![(0.0, 0.0); places], change: 0.0, hottest: None }
    }

    pub fn look(&mut self, now: &Reading, places: &Places) {
        let mut change = 0.0;
        for (k, softening) in self.softening.iter_mut().enumerate() {
            let (Some(senses), plastic) = (&self.media[places.segment[k]], now.plastic[k]) else { continue };
            if plastic > WORTH_IT * softening.0 {
                let (rise, lost) = senses[usize::from(now.strain[k] < 0.0)].at(plastic);
                *softening = (plastic, lost);
                if self.hottest.is_none_or(|h| rise > h.0) {
                    self.hottest = Some((rise, lost, now.time, k));
                }
            }
            change += places.weight[k] * softening.1 * now.stress[k].abs();
        }
        self.change = self.change.max(change);
    }

    pub fn finding(
        &self,
        looked: bool,
        materials: &[Arc<Material>],
        places: &Places,
        share: impl Fn(f64) -> f64,
    ) -> (f64, String) {
        if !looked {
            return (0.0, ELASTIC.to_owned());
        }
        if self.media.iter().all(Option::is_none) {
            let message = std::format!(
                "no estimate: {} states no {} in [heat]",
                materials[0].name,
                missing(&materials[0].constants.heat)
            );
            return (f64::NAN, message);
        }
        let Some((rise, lost, time, place)) = self.hottest else {
            return (0.0, "what yielded states no [heat] constants, or did not flow".to_owned());
        };
        let message = std::format!(
            "plastic work would warm {} by up to {rise:.1} K if none flowed away (t = {}, x = {}) and take {:.2} % of its flow \
             stress; the curve was taken as cold. Switch on with [effects] heat = {{}}",
            materials[places.segment[place]].name,
            format(time, Dimension::Time, System::Si),
            format(places.x[place], Dimension::Length, System::Si),
            100.0 * lost,
        );
        (share(self.change), message)
    }
}

fn missing(heat: &HeatConstants) -> String {
    let needed = [
        ("specific-heat", heat.specific_heat),
        ("reference-temperature", heat.reference_temperature),
        ("melting-temperature", heat.melting_temperature),
        ("m", heat.exponent),
    ];
    let missing: Vec<&str> = needed.iter().filter(|(_, value)| value.is_none()).map(|(key, _)| *key).collect();
    missing.join(", ")
}

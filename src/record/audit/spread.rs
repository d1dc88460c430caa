//! Spreading of a stress change by unloading. While a load lasts, a stress that an effect changes by d sigma in the
//! flowing part of the bar changes the impulse that passes there by `A int d sigma dt`. The unloading wave travels at
//! c0 and carries this difference out of the flowing part. Over the bar it amounts to
//! `int |d sigma| dx = c0 int d sigma dt`, in a wave that is no higher than d sigma and no longer than the bar.

use serde::{Deserialize, Serialize};

use super::Reading;
use super::places::Places;
use crate::bar::Bar;

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Spread {
    places: Vec<Place>,
    /// Length of the bar, m.
    length: f64,
}

#[derive(Debug, Default, Clone, Copy, Serialize, Deserialize)]
struct Place {
    /// Elastic wave speed, m/s.
    speed: f64,
    /// Largest magnitude of the stress so far, Pa.
    peak: f64,
    /// Largest change of the stress so far, Pa.
    change: f64,
    /// Change of the impulse per area, Pa s.
    impulse: f64,
}

impl Spread {
    pub fn new(bar: &Bar, places: &Places) -> Self {
        let speed = |&segment: &usize| bar.segments[segment].material.c0();
        let place = |segment| Place { speed: speed(segment), ..Place::default() };
        Self { places: places.segment.iter().map(place).collect(), length: bar.length() }
    }

    /// Adds the change of the stress of every place (Pa). Returns the largest L1 change that unloading has spread over the bar, Pa m.
    pub fn sample(&mut self, now: &Reading, changes: &[f64]) -> f64 {
        let mut largest = 0.0_f64;
        for (k, place) in self.places.iter_mut().enumerate() {
            let stress = now.stress[k].abs();
            place.peak = place.peak.max(stress);
            if place.peak <= 0.0 {
                continue;
            }
            let held = stress / place.peak;
            place.change = place.change.max(changes[k]);
            place.impulse += held * changes[k] * now.lapse;
            let spread = (place.speed * place.impulse).min(place.change * self.length);
            largest = largest.max((1.0 - held) * spread);
        }
        largest
    }
}

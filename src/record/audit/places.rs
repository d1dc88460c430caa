//! Sampling places of the audit.

use crate::bar::Bar;
use crate::units::{Dimension, System, format};

/// Number of places over the whole bar, and the smallest number in a segment (smaller if there are many segments).
const PLACES: usize = 128;
const FEWEST: usize = 8;

/// Places on the bar, evenly spaced in each segment.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// Positions, m, increasing.
    pub x: Vec<f64>,
    /// Index of the segment of each place.
    pub segment: Vec<usize>,
    /// Length of bar represented by each place, m.
    pub weight: Vec<f64>,
    /// Accumulated plastic strain of each place at t = 0.
    pub at_start: Vec<f64>,
}

impl Places {
    pub fn new(bar: &Bar) -> Self {
        let mut places = Self::default();
        let (length, mut x0) = (bar.length(), 0.0);
        let fewest = (PLACES / bar.segments.len()).clamp(1, FEWEST);
        for (k, segment) in bar.segments.iter().enumerate() {
            let count = ((PLACES as f64 * segment.length / length).round() as usize).max(fewest);
            let part = segment.length / count as f64;
            places.x.extend((0..count).map(|i| x0 + (i as f64 + 0.5) * part));
            places.segment.extend(std::iter::repeat_n(k, count));
            places.weight.extend(std::iter::repeat_n(part, count));
            let at_start = |i: usize| segment.initial_between(i as f64 * part, (i + 1) as f64 * part).accumulated;
            places.at_start.extend((0..count).map(at_start));
            x0 += segment.length;
        }
        places
    }

    /// Returns the integral over the bar of a quantity given at every place, in its unit times m.
    pub fn integral(&self, values: &[f64]) -> f64 {
        values.iter().zip(&self.weight).map(|(value, weight)| weight * value).sum()
    }

    /// Formats a time (s) and a place for messages.
    pub fn moment(&self, time: f64, place: usize) -> String {
        moment(time, self.x[place])
    }
}

/// Formats a time (s) and a position (m) for messages.
pub(super) fn moment(time: f64, x: f64) -> String {
    let [time, x] = [(time, Dimension::Time), (x, Dimension::Length)].map(|(value, of)| format(value, of, System::Si));
    std::format!("t = {time}, x = {x}")
}

//! Largest readings at points of a beam; those of free motion between two samples are found by bisection of the closed-form motion.

use super::shape::{Place, Readings};
use crate::impact::oscillator::Oscillator;

/// Excess over the largest known reading that is not searched for, relative to the largest reading of all points.
const NEGLIGIBLE: f64 = 1e-8;

/// Relative difference up to which two peaks count as equal. A free beam that is struck at midspan returns to the same deflection with the opposite
/// sign after half a period, and the largest readings are computed to within this accuracy.
const EQUAL: f64 = 1e-6;

/// Largest number of intervals into which a run is divided.
const MOST_PARTS: f64 = 4_194_304.0;

/// The largest reading of one sign.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Peak {
    /// Value with its sign.
    pub value: f64,
    /// Time at which it is first reached, s.
    pub time: f64,
    /// Reading at that time, with its sign; equal to `value` up to rounding.
    then: f64,
}

impl Peak {
    /// Updates the peak with a reading of its sign.
    fn note(&mut self, value: f64, time: f64) {
        let (size, then) = (value.abs(), self.then.abs());
        if size > then * (1.0 + EQUAL) || time < self.time && size > then * (1.0 - EQUAL) {
            (self.then, self.time) = (value, time);
        }
        if size > self.value.abs() {
            self.value = value;
        }
    }
}

/// The largest readings of both signs, the positive one first.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Peaks([Peak; 2]);

impl Peaks {
    pub fn note(&mut self, value: f64, time: f64) {
        if value != 0.0 {
            self.0[usize::from(value < 0.0)].note(value, time);
        }
    }

    /// Returns the largest magnitude.
    fn size(&self) -> f64 {
        self.0[0].value.max(-self.0[1].value)
    }

    /// Returns the peak of largest magnitude; the earlier one if both are equal.
    pub fn largest(&self) -> Peak {
        let [up, down] = self.0;
        let (high, low) = (up.value, -down.value);
        let is_up = high > low * (1.0 + EQUAL) || low <= high * (1.0 + EQUAL) && up.time <= down.time;
        if is_up { up } else { down }
    }
}

/// The readings of largest magnitude so far.
pub(super) struct Extremes {
    /// Each point with its factors and with the magnitudes of its factors.
    places: Vec<[Place; 2]>,
    pub peaks: Vec<[Peaks; 3]>,
    /// Readings below these are not searched for.
    least: Vec<Readings>,
    /// The modes and the readings at the previous sample.
    before: (Vec<Oscillator>, Vec<Readings>),
    /// Shortest interval of free motion that is divided, s.
    shortest: f64,
}

impl Extremes {
    /// Creates an empty record for points, each with the smallest readings that are of interest. `finest` is the finest time step and `end` the end
    /// of the run, s.
    pub fn new(places: &[(Place, Readings)], [finest, end]: [f64; 2]) -> Self {
        let shortest = (finest / 64.0).max(end / MOST_PARTS);
        let least = places.iter().map(|(_, least)| *least).collect();
        let places: Vec<[Place; 2]> = places.iter().map(|(place, _)| [place.clone(), place.magnitude()]).collect();
        let peaks = vec![[Peaks::default(); 3]; places.len()];
        Self { peaks, least, places, before: (Vec::new(), Vec::new()), shortest }
    }

    /// Records the readings at a time, s. `flown` is the duration of the free motion since the previous sample, s; 0 if the bodies were in contact.
    pub fn look(&mut self, modes: &[Oscillator], force: f64, [time, flown]: [f64; 2]) {
        if self.places.is_empty() {
            return;
        }
        let now = self.keep(modes, force, time);
        let (mut then, readings) = std::mem::take(&mut self.before);
        if flown > 0.0 {
            let swings: Vec<Oscillator> = then.iter().map(Oscillator::swing).collect();
            let most: Vec<Readings> = self.places.iter().map(|[_, magnitude]| magnitude.read(&swings, 0.0)).collect();
            self.search(&then, [&readings, &now, &most], [time - flown, flown]);
        }
        then.clear();
        then.extend_from_slice(modes);
        self.before = (then, now);
    }

    fn keep(&mut self, modes: &[Oscillator], force: f64, time: f64) -> Vec<Readings> {
        let now: Vec<Readings> = self.places.iter().map(|[place, _]| place.read(modes, force)).collect();
        for (peaks, value) in self.peaks.iter_mut().flatten().zip(now.iter().flatten()) {
            peaks.note(*value, time);
        }
        now
    }

    /// Bisects an interval of free motion until it cannot contain a reading larger than the known ones. `modes` is the state at its start, `from`
    /// and `to` are the readings at its ends, and `most` are the readings with all modes at their amplitudes.
    fn search(&mut self, modes: &[Oscillator], [from, to, most]: [&[Readings]; 3], [start, time]: [f64; 2]) {
        if time <= self.shortest || !self.may_exceed(modes, [from, to, most], time) {
            return;
        }
        let half = 0.5 * time;
        let middle: Vec<Oscillator> = modes.iter().map(|mode| mode.after(half)).collect();
        let readings = self.keep(&middle, 0.0, start + half);
        self.search(modes, [from, &readings, most], [start, half]);
        self.search(&middle, [&readings, to, most], [start + half, half]);
    }

    /// Whether a reading within the interval may exceed the known ones. It differs from the line between the ends of the interval by at most an
    /// eighth of the largest second derivative times the square of the interval, and is no larger than with all modes at their amplitudes.
    fn may_exceed(&self, modes: &[Oscillator], [from, to, most]: [&[Readings]; 3], time: f64) -> bool {
        let scale = |i: usize| self.peaks.iter().fold(0.0, |most: f64, peaks| most.max(peaks[i].size()));
        let scale: Readings = std::array::from_fn(scale);
        let known = |k: usize, i: usize| (self.peaks[k][i].size() + NEGLIGIBLE * scale[i]).max(self.least[k][i]);
        let may = |k: usize| (0..3).any(|i| most[k][i] > known(k, i));
        let places: Vec<usize> = (0..self.places.len()).filter(|&k| may(k)).collect();
        if places.is_empty() {
            return false;
        }
        let bends: Vec<Oscillator> = modes.iter().map(Oscillator::bend).collect();
        places.into_iter().any(|k| {
            let bend = self.places[k][1].read(&bends, 0.0);
            let reach = |i: usize| from[k][i].abs().max(to[k][i].abs()) + 0.125 * bend[i] * time * time;
            (0..3).any(|i| reach(i).min(most[k][i]) > known(k, i))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equal to rounding, in any order of search.
    #[test]
    fn the_first_of_equal_peaks_counts() {
        let rounded = 2.0 * (1.0 + 1e-9);
        for readings in [[(2.0, 1.0), (-rounded, 3.0), (rounded, 5.0)], [(-rounded, 3.0), (rounded, 5.0), (2.0, 1.0)]] {
            let mut peaks = Peaks::default();
            for (value, time) in readings {
                peaks.note(value, time);
            }
            let first = peaks.largest();
            assert_eq!((first.value, first.time), (rounded, 1.0));
            // A later one that is larger by more.
            peaks.note(-2.0 * (1.0 + 1e-5), 7.0);
            assert_eq!((peaks.largest().value, peaks.largest().time), (-2.0 * (1.0 + 1e-5), 7.0));
        }
    }
}

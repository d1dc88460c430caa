//! The largest readings at places of a beam; those of free motion between two looks are found in closed form.

use super::shape::{Place, Readings};
use crate::impact::oscillator::Oscillator;

/// What is not worth a search, over the largest reading of all places.
const NEGLIGIBLE: f64 = 1e-8;

/// Parts into which a run is divided, at most.
const MOST_PARTS: f64 = 4_194_304.0;

/// The readings of largest magnitude so far.
pub(super) struct Extremes {
    /// Each with its factors, and with their magnitudes.
    places: Vec<[Place; 2]>,
    pub values: Vec<Readings>,
    /// Smaller readings are not searched for.
    least: Vec<Readings>,
    /// The modes and the readings at the last look.
    before: (Vec<Oscillator>, Vec<Readings>),
    /// Free motion is not divided further, s.
    shortest: f64,
}

impl Extremes {
    /// Each place with the readings from which on they are of interest.
    pub fn new(places: &[(Place, Readings)], [finest, end]: [f64; 2]) -> Self {
        let shortest = (finest / 64.0).max(end / MOST_PARTS);
        let least = places.iter().map(|(_, least)| *least).collect();
        let places: Vec<[Place; 2]> = places.iter().map(|(place, _)| [place.clone(), place.magnitude()]).collect();
        Self { values: vec![[0.0; 3]; places.len()], least, places, before: (Vec::new(), Vec::new()), shortest }
    }

    /// After free motion over a time, s; 0: the bodies were in contact.
    pub fn look(&mut self, modes: &[Oscillator], force: f64, flown: f64) {
        if self.places.is_empty() {
            return;
        }
        let now = self.keep(modes, force);
        let (mut then, readings) = std::mem::take(&mut self.before);
        if flown > 0.0 {
            let swings: Vec<Oscillator> = then.iter().map(Oscillator::swing).collect();
            let most: Vec<Readings> = self.places.iter().map(|[_, magnitude]| magnitude.read(&swings, 0.0)).collect();
            self.search(&then, [&readings, &now, &most], flown);
        }
        then.clear();
        then.extend_from_slice(modes);
        self.before = (then, now);
    }

    fn keep(&mut self, modes: &[Oscillator], force: f64) -> Vec<Readings> {
        let now: Vec<Readings> = self.places.iter().map(|[place, _]| place.read(modes, force)).collect();
        for (most, value) in self.values.iter_mut().flatten().zip(now.iter().flatten()) {
            *most = if value.abs() > most.abs() { *value } else { *most };
        }
        now
    }

    /// Halves a time of free motion from these modes, with the readings at its ends and those of all modes at their amplitudes, until it cannot
    /// hold more than is known.
    fn search(&mut self, modes: &[Oscillator], [from, to, most]: [&[Readings]; 3], time: f64) {
        if time <= self.shortest || !self.may_exceed(modes, [from, to, most], time) {
            return;
        }
        let middle: Vec<Oscillator> = modes.iter().map(|mode| mode.after(0.5 * time)).collect();
        let readings = self.keep(&middle, 0.0);
        self.search(modes, [from, &readings, most], 0.5 * time);
        self.search(&middle, [&readings, to, most], 0.5 * time);
    }

    /// A reading may be larger within a time than so far: it is off the line between its ends by up to an eighth of its largest bend times
    /// the square of the time, and no larger than with all modes at their amplitudes.
    fn may_exceed(&self, modes: &[Oscillator], [from, to, most]: [&[Readings]; 3], time: f64) -> bool {
        let scale = |i: usize| self.values.iter().fold(0.0, |most: f64, value| most.max(value[i].abs()));
        let scale: Readings = std::array::from_fn(scale);
        let known = |k: usize, i: usize| (self.values[k][i].abs() + NEGLIGIBLE * scale[i]).max(self.least[k][i]);
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

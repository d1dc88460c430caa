//! How a load that lessens unloads the bar behind the fan that it has started.
//!
//! The end sends an elastic wave F(t) after the slowest front, which travels with the speed c. The front, weakened along its chord, throws a part of
//! it back: with r = (c0 - c)/(c0 + c), what comes to the end at the time t left it at r t, and is r F(r t). At the distance x the bar has lost the
//! velocity F(t - x/c0) + r F(r (t + x/c0)) and the stress rho c0 (F(t - x/c0) - r F(r (t + x/c0))). In a bar that is unloaded along its curve c takes
//! the place of c0, and r is 0.

use serde::{Deserialize, Serialize};

/// The waves behind a fan.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Unloading {
    /// Of the waves that unload the bar, m/s.
    wave_speed: f64,
    /// r.
    thrown_back: f64,
    /// When the slowest front leaves the end, s after the start of its fan.
    start: f64,
    /// Times after that (s), and F then, m/s; first 0 at 0.
    sent: Vec<[f64; 2]>,
}

impl Unloading {
    /// Of a bar that nothing has unloaded yet, in which waves of unloading and the slowest front have these speeds (m/s); the front leaves the end `start`
    /// (s) after the start of the fan. Waves that are no faster than it never reach it.
    pub fn new([wave_speed, front]: [f64; 2], start: f64) -> Self {
        let thrown_back = (wave_speed - front) / (wave_speed + front);
        Self { wave_speed, thrown_back, start, sent: vec![[0.0; 2]] }
    }

    /// The stress that an end loses at `time` (s) which has lost a velocity, over rho c0: factor and summand, m/s.
    pub fn stress_for_velocity(&self, time: f64) -> [f64; 2] {
        let [known, part] = self.coming_back(time);
        let factor = (1.0 - part) / (1.0 + part);
        [factor, -known * (1.0 + factor)]
    }

    /// The end has lost this velocity (m/s) at `time`, s.
    pub fn note_velocity(&mut self, time: f64, lost: f64) {
        let [known, part] = self.coming_back(time);
        self.sent.push([time - self.start, (lost - known) / (1.0 + part)]);
    }

    /// The end has lost this stress over rho c0 (m/s) at `time`, s.
    pub fn note_stress(&mut self, time: f64, lost: f64) {
        let [known, part] = self.coming_back(time);
        self.sent.push([time - self.start, (lost + known) / (1.0 - part)]);
    }

    /// What the bar has lost at this distance (m) at `time` (s): velocity, and stress over rho c0, m/s.
    pub fn lost(&self, distance: f64, time: f64) -> [f64; 2] {
        let (time, travels) = (time - self.start, distance / self.wave_speed);
        let after = self.at(time - travels);
        let back = self.thrown_back * self.at(self.thrown_back * (time + travels));
        [after + back, after - back]
    }

    /// The wave that comes back to the end at a time, from what is known of F before (m/s), and as part of F at that time.
    fn coming_back(&self, time: f64) -> [f64; 2] {
        let (time, [last, sent]) = (time - self.start, self.sent[self.sent.len() - 1]);
        let left = self.thrown_back * time;
        let part = ((left - last) / (time - last)).max(0.0);
        let known = if part > 0.0 { (1.0 - part) * sent } else { self.at(left) };
        [self.thrown_back * known, self.thrown_back * part]
    }

    /// F at a time, s after the slowest front has left.
    fn at(&self, time: f64) -> f64 {
        let next = self.sent.partition_point(|sent| sent[0] <= time);
        match (next.checked_sub(1).map(|k| self.sent[k]), self.sent.get(next)) {
            (None, _) => 0.0,
            (Some([_, last]), None) => last,
            (Some([t0, f0]), Some([t1, f1])) => f0 + (f1 - f0) * ((time - t0) / (t1 - t0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const C0: f64 = 5000.0;
    const FRONT: f64 = 800.0;
    const DT: f64 = 1e-7;

    fn unloaded(lost: impl Fn(f64) -> f64) -> Unloading {
        let mut unloading = Unloading::new([C0, FRONT], 0.0);
        for step in 0..400 {
            let time = (f64::from(step) + 0.5) * DT;
            let [factor, summand] = unloading.stress_for_velocity(time);
            unloading.note_velocity(time, lost(time));
            let [velocity, stress] = unloading.lost(0.0, time);
            assert!((velocity - lost(time)).abs() < 1e-12);
            assert!((stress - factor * lost(time) - summand).abs() < 1e-12);
        }
        unloading
    }

    /// The front is weakened along its chord: the stress that it loses is rho c times the velocity that it loses.
    #[test]
    fn the_front_is_weakened_along_its_chord() {
        for lost in [
            |t: f64| 2e5 * t,
            |t: f64| 5e9 * t * t,
            |t: f64| 8.0 * (1.0 - (-t / 3e-5).exp()),
            |t: f64| 1e5 * (t - 1e-5).max(0.0),
        ] {
            let unloading = unloaded(lost);
            for time in [5e-6, 1.7e-5, 3e-5] {
                let [velocity, stress] = unloading.lost(FRONT * time, time);
                assert!((C0 * stress - FRONT * velocity).abs() < 2e-3 * C0 * lost(4e-5), "{time}: {velocity} {stress}");
            }
        }
    }

    #[test]
    fn a_stress_that_lessens_is_that_of_the_velocity() {
        let by_velocity = unloaded(|t| 5e9 * t * t + 1e4 * t);
        let mut by_stress = Unloading::new([C0, FRONT], 0.0);
        for step in 0..400 {
            let time = (f64::from(step) + 0.5) * DT;
            by_stress.note_stress(time, by_velocity.lost(0.0, time)[1]);
        }
        let [a, b] = [&by_velocity, &by_stress].map(|unloading| unloading.lost(0.01, 3.3e-5));
        assert!((0..2).all(|k| (a[k] - b[k]).abs() < 1e-9 * a[0]), "{a:?} {b:?}");
    }
}

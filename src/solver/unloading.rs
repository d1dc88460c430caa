//! Unloading of the bar behind a fan whose load decays.
//!
//! The end sends an elastic wave F(t) after the slowest front, which travels at the speed c. The wave weakens the front along its chord and is partly
//! reflected. With r = (c0 - c)/(c0 + c), the reflection that reaches the end at time t left the end at r t and has the amplitude r F(r t). Once F
//! has cancelled the front, the next one reflects in the same way: the reflected wave G grows with the coefficient r of that front and returns from
//! its position. At the distance x the bar has lost the velocity F(t - x/c0) + G(t + x/c0) and the stress rho c0 (F(t - x/c0) - G(t + x/c0)). In a
//! bar that unloads along its curve, the speed of the slowest front replaces c0, and G is 0.

use serde::{Deserialize, Serialize};

/// A front that unloading waves weaken.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Front {
    /// Speed relative to that of the unloading waves.
    speed: f64,
    /// Time at which the front leaves the end, s after the start of the fan.
    delay: f64,
    /// Magnitude of F that cancels this front and all slower ones, m/s.
    cancelled_by: f64,
}

impl Front {
    /// Reflection coefficient r: fraction of F that the front reflects.
    fn reflection_coefficient(&self) -> f64 {
        (1.0 - self.speed) / (1.0 + self.speed)
    }

    /// Time (s) at which a wave that left the end at `time` (s) returns to it.
    fn return_time(&self, time: f64) -> f64 {
        (time - self.delay) / self.reflection_coefficient() + self.delay
    }

    /// Time (s) at which a wave that returns to the end at `time` (s) left it.
    fn departure_time(&self, time: f64) -> f64 {
        (time - self.delay) * self.reflection_coefficient() + self.delay
    }
}

/// Unloading waves behind a fan.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Unloading {
    /// Speed of the unloading waves, m/s.
    wave_speed: f64,
    /// Fronts that can be weakened, slowest first.
    fronts: Vec<Front>,
    /// Times after the start of the fan (s) and F at these times (m/s), from 0 when the slowest front leaves.
    sent: Vec<[f64; 2]>,
    /// Times at which the reflections arrive at the end (s) and G at these times (m/s).
    back: Vec<[f64; 2]>,
}

impl Unloading {
    /// Creates the state of a bar that nothing has unloaded yet. `wave_speed` is the speed of unloading waves, m/s. `fronts`, slowest first, have
    /// their speed (m/s), departure time (s after the start of the fan) and velocity jump (m/s). Fronts as fast as the unloading waves are never
    /// reached by them.
    pub fn new(wave_speed: f64, fronts: impl IntoIterator<Item = [f64; 3]>) -> Self {
        let (mut weakened, mut cancelled_by): (Vec<Front>, f64) = (Vec::new(), 0.0);
        let mut start = None;
        for [speed, delay, velocity] in fronts {
            start.get_or_insert(delay);
            let speed = speed / wave_speed;
            if speed >= 1.0 {
                break;
            }
            cancelled_by += 0.5 * (1.0 + speed) * velocity.abs();
            weakened.push(Front { speed, delay, cancelled_by });
        }
        let start = [start.unwrap_or(0.0), 0.0];
        Self { wave_speed, fronts: weakened, sent: vec![start], back: vec![start] }
    }

    /// Returns factor and summand (m/s) of the stress over rho c0 that an end loses at `time` (s), as a linear function of the velocity it has lost.
    pub fn stress_for_velocity(&self, time: f64) -> [f64; 2] {
        let [known, part] = self.coming_back(time);
        let factor = (1.0 - part) / (1.0 + part);
        [factor, -known * (1.0 + factor)]
    }

    /// Records the velocity (m/s) that the end has lost at `time`, s.
    pub fn record_velocity(&mut self, time: f64, lost: f64) {
        let [known, part] = self.coming_back(time);
        self.send(time, (lost - known) / (1.0 + part));
    }

    /// Records the stress over rho c0 (m/s) that the end has lost at `time`, s.
    pub fn record_stress(&mut self, time: f64, lost: f64) {
        let [known, part] = self.coming_back(time);
        self.send(time, (lost + known) / (1.0 - part));
    }

    /// Returns the velocity (m/s) and the stress over rho c0 (m/s) that the bar has lost at this distance (m) and `time` (s).
    pub fn lost(&self, distance: f64, time: f64) -> [f64; 2] {
        let travels = distance / self.wave_speed;
        let [after, back] = [at(&self.sent, time - travels), at(&self.back, time + travels)];
        [after + back, after - back]
    }

    /// Returns the wave that arrives back at the end at `time` (s) in two parts: the part known from earlier F (m/s), and the fraction of F at that
    /// time.
    fn coming_back(&self, time: f64) -> [f64; 2] {
        let ([last, sent], [arrives, back]) = (self.sent[self.sent.len() - 1], self.back[self.back.len() - 1]);
        match self.weakened_by(sent) {
            // The wave that returns then leaves the end only within this step.
            Some(front) if time > last && time > arrives => {
                let part =
                    front.reflection_coefficient() * (front.departure_time(time) - last).max(0.0) / (time - last);
                [back - part * sent, part]
            }
            _ => [at(&self.back, time), 0.0],
        }
    }

    /// Returns the slowest front that F has not cancelled yet.
    fn weakened_by(&self, sent: f64) -> Option<&Front> {
        self.fronts.get(self.fronts.partition_point(|front| front.cancelled_by <= sent.abs()))
    }

    /// Adds F as the end sends it at `time`, s.
    fn send(&mut self, time: f64, wave: f64) {
        let [last, before] = self.sent[self.sent.len() - 1];
        let used_up = self.fronts.partition_point(|front| front.cancelled_by <= before.abs())
            ..self.fronts.partition_point(|front| front.cancelled_by < wave.abs());
        for k in used_up {
            let front = self.fronts[k];
            let part = (front.cancelled_by - before.abs()) / (wave.abs() - before.abs());
            let (time, wave) = (last + part * (time - last), before + part * (wave - before));
            self.meet(time, wave, front);
            // The next front is farther away, so that its reflection arrives later.
            if let Some(&next) = self.fronts.get(k + 1) {
                self.meet(time, wave, next);
            }
        }
        match self.weakened_by(before.abs().max(wave.abs())).copied() {
            Some(front) => self.meet(time, wave, front),
            None => self.sent.push([time, wave]),
        }
    }

    /// Adds F, sent at `time` (s), and its reflection from a front.
    fn meet(&mut self, time: f64, wave: f64, front: Front) {
        let ([_, before], [arrives, back]) = (self.sent[self.sent.len() - 1], self.back[self.back.len() - 1]);
        self.sent.push([time, wave]);
        self.back.push([front.return_time(time).max(arrives), back + front.reflection_coefficient() * (wave - before)]);
    }
}

/// Interpolates linearly between rows of time and value: 0 before the first row, constant after the last.
fn at(rows: &[[f64; 2]], time: f64) -> f64 {
    let next = rows.partition_point(|row| row[0] <= time);
    match (next.checked_sub(1).map(|k| rows[k]), rows.get(next)) {
        (None, _) => 0.0,
        (Some([_, last]), None) => last,
        (Some([t0, f0]), Some([t1, f1])) => f0 + (f1 - f0) * ((time - t0) / (t1 - t0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const C0: f64 = 5000.0;
    const FRONT: f64 = 800.0;
    const DT: f64 = 1e-7;

    fn unloaded(lost: impl Fn(f64) -> f64) -> Unloading {
        let mut unloading = Unloading::new(C0, [[FRONT, 0.0, 100.0]]);
        for step in 0..400 {
            let time = (f64::from(step) + 0.5) * DT;
            let [factor, summand] = unloading.stress_for_velocity(time);
            unloading.record_velocity(time, lost(time));
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

    /// Fronts are cancelled one after another, each by the part of the waves that the slower fronts have left.
    #[test]
    fn fronts_are_used_up_one_after_another() {
        let [slow, fast] = [[600.0, 3e-6, 2.0], [1200.0, 1e-6, 1e9]];
        let mut unloading = Unloading::new(C0, [slow, fast]);
        let lost = |time: f64| 1e5 * (time - 3e-6).max(0.0);
        for step in 0..800 {
            let time = 3e-6 + (f64::from(step) + 0.5) * DT;
            unloading.record_velocity(time, lost(time));
        }
        let at = |[speed, delay, _]: [f64; 3], time: f64| unloading.lost(speed * (time - delay), time);
        // The slow front has lost its whole velocity jump when the waves that cancel it arrive.
        let gone = (0..8000).map(|k| f64::from(k) * 1e-8).find(|&time| at(slow, time)[0] >= 2.0).expect("a time");
        let [velocity, stress] = at(slow, gone);
        assert!((C0 * stress / (600.0 * velocity) - 1.0).abs() < 1e-2, "{velocity} {stress}");
        // The loss at the fast front is that of the slow one, along the slow front's chord, plus more along its own.
        for time in [5e-5, 7e-5] {
            let [velocity, stress] = at(fast, time);
            let own = C0 * stress - 600.0 * 2.0;
            assert!(velocity > 2.0 && (own / (1200.0 * (velocity - 2.0)) - 1.0).abs() < 1e-2, "{velocity} {stress}");
        }
    }

    #[test]
    fn a_stress_that_lessens_is_that_of_the_velocity() {
        let by_velocity = unloaded(|t| 5e9 * t * t + 1e4 * t);
        let mut by_stress = Unloading::new(C0, [[FRONT, 0.0, 100.0]]);
        for step in 0..400 {
            let time = (f64::from(step) + 0.5) * DT;
            by_stress.record_stress(time, by_velocity.lost(0.0, time)[1]);
        }
        let [a, b] = [&by_velocity, &by_stress].map(|unloading| unloading.lost(0.01, 3.3e-5));
        assert!((0..2).all(|k| (a[k] - b[k]).abs() < 1e-9 * a[0]), "{a:?} {b:?}");
    }
}

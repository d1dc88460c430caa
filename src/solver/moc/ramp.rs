//! Prescribed end histories: ramps are replaced by steps, each computed when it is due.

use crate::bar::ends::{Face, Relation};
use crate::bar::{EndCondition, History};

/// Shortest step of a ramp relative to the elastic transit time: the staircase shifts the stress of a wave by less than this fraction of the bar's
/// length.
pub(super) const SHORTEST: f64 = 1e-6;

/// A history whose ramps are replaced by steps of equal height, each in the middle of its part of the ramp, so that the integral over the ramp is
/// unchanged. Between ramps, and at jumps, it is the history itself.
#[derive(Debug, Clone)]
pub(super) struct Staircase {
    history: History,
    /// Largest height of a step, > 0.
    increment: f64,
    /// Shortest step, s; a ramp has at least one step.
    shortest: f64,
}

/// A velocity or stress that an end imposes.
#[derive(Debug, Clone)]
pub(super) struct Imposed {
    staircase: Staircase,
    /// Relation for a value of 1.
    unit: Relation,
    /// Time from which on the end is free, s.
    release: f64,
}

impl Imposed {
    /// Creates the imposed value of an end whose ramps become steps of `stress` (Pa; velocities by the elastic impedance), none shorter than
    /// [`SHORTEST`] of the elastic transit time `transit` (s). `None` if the end imposes no history.
    pub fn new(condition: &EndCondition, face: &Face, stress: f64, transit: f64) -> Option<Self> {
        let (history, unit, release) = match condition {
            EndCondition::Velocity { history, release } => (history, Relation::velocity(face.inward), *release),
            EndCondition::Stress { history } => (history, Relation::force(-face.area), None),
            _ => return None,
        };
        let velocity = stress * face.area / face.impedance;
        let increment = if unit.of_force == 0.0 { velocity } else { stress };
        let staircase = Staircase::new(history, increment, SHORTEST * transit);
        Some(Self { staircase, unit, release: release.unwrap_or(f64::INFINITY) })
    }

    /// Returns whether the history has a ramp.
    pub fn needs_steps(&self) -> bool {
        self.staircase.history.has_ramp()
    }

    /// Returns the relation that applies from t (s) on.
    pub fn relation(&self, t: f64) -> Relation {
        Relation { value: self.unit.value * self.staircase.at(t), ..self.unit }
    }

    /// Returns whether the end is free from t (s) on.
    pub fn is_over(&self, t: f64) -> bool {
        self.release <= t
    }

    /// Returns the time of the next change after t (s), s.
    pub fn next_after(&self, t: f64) -> f64 {
        self.staircase.next_after(t).min(self.release)
    }
}

/// Interval of the history between two rows, and number of steps into which it is divided.
struct Ramp {
    start: f64,
    duration: f64,
    from: f64,
    to: f64,
    steps: f64,
}

impl Ramp {
    /// Time of step `k` (0, 1, ...), s.
    fn time(&self, k: f64) -> f64 {
        self.start + self.duration * ((k + 0.5) / self.steps)
    }

    /// Number of steps up to and including t.
    fn done(&self, t: f64) -> f64 {
        let mut done = ((t - self.start) / self.duration * self.steps + 0.5).floor().clamp(0.0, self.steps);
        while done < self.steps && self.time(done) <= t {
            done += 1.0;
        }
        while done > 0.0 && self.time(done - 1.0) > t {
            done -= 1.0;
        }
        done
    }
}

impl Staircase {
    /// Creates a staircase. `increment` is in units of the history, `shortest` in s, both > 0.
    pub fn new(history: &History, increment: f64, shortest: f64) -> Self {
        Self { history: history.clone(), increment, shortest }
    }

    /// Returns the interval before row `next` (> 0).
    fn ramp(&self, next: usize) -> Ramp {
        let (t, v) = (self.history.time(), self.history.value());
        let (start, duration, rise) = (t[next - 1], t[next] - t[next - 1], (v[next] - v[next - 1]).abs());
        let steps = (rise / self.increment).ceil().min((duration / self.shortest).floor()).max(1.0);
        Ramp { start, duration, from: v[next - 1], to: v[next], steps: if rise == 0.0 { 0.0 } else { steps } }
    }

    fn next_row(&self, t: f64) -> usize {
        self.history.time().partition_point(|&row| row <= t)
    }

    /// Returns the value just after t (s).
    pub fn at(&self, t: f64) -> f64 {
        let next = self.next_row(t);
        if next == 0 || next == self.history.time().len() {
            return self.history.at(t);
        }
        let ramp = self.ramp(next);
        let done = if ramp.steps > 0.0 { ramp.done(t) } else { 0.0 };
        if done == ramp.steps { ramp.to } else { ramp.from + (ramp.to - ramp.from) * (done / ramp.steps) }
    }

    /// Returns the time of the first step or row after t, s; infinite after the last one.
    pub fn next_after(&self, t: f64) -> f64 {
        let next = self.next_row(t);
        let Some(&row) = self.history.time().get(next) else { return f64::INFINITY };
        if next == 0 {
            return row;
        }
        let ramp = self.ramp(next);
        if ramp.steps == 0.0 {
            return row;
        }
        let done = ramp.done(t);
        if done < ramp.steps { ramp.time(done) } else { row }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(staircase: &Staircase) -> Vec<(f64, f64)> {
        let mut t = -1.0;
        std::iter::from_fn(|| {
            t = staircase.next_after(t);
            (t < f64::INFINITY).then(|| (t, staircase.at(t)))
        })
        .collect()
    }

    #[test]
    fn ramps_are_steps_in_the_middle_of_their_parts_and_jumps_stay() {
        let history = History::new(&[(0.0, 0.0), (4.0, 2.0), (5.0, 2.0), (5.0, 1.0), (6.0, 1.0)]).expect("right");
        let staircase = Staircase::new(&history, 1.0, 1e-6);
        let wanted = [(0.0, 0.0), (1.0, 1.0), (3.0, 2.0), (4.0, 2.0), (5.0, 1.0), (6.0, 1.0)];
        assert_eq!(steps(&staircase), wanted);
        // No step is shorter than allowed; the last stands in for the ramp.
        assert_eq!(steps(&Staircase::new(&history, 1e-9, 3.0))[1], (2.0, 2.0));
    }

    #[test]
    fn a_staircase_of_any_height_has_the_history_s_integral() {
        let history = History::new(&[(0.0, -1.0), (1e-3, 2.0), (1.001e-3, 0.5)]).expect("right");
        for increment in [1.0, 0.1, 1e-3, 3e-5] {
            let staircase = Staircase::new(&history, increment, 1e-12);
            let rows = steps(&staircase);
            let integral: f64 = rows.windows(2).map(|pair| pair[0].1 * (pair[1].0 - pair[0].0)).sum();
            let wanted = 1.001e-3 * history.mean(0.0, 1.001e-3);
            assert!((integral - wanted).abs() < 1e-12 * wanted, "{increment}: {integral} {wanted}");
        }
    }
}

//! Step lengths of a body (a striker, a ball, a spring) at an end.
//!
//! Between arrivals of waves, a body on an elastic bar relaxes like exp(-t/T) ([`Relaxation`]). The mean over a step of length x T that follows a
//! bilinear bar has an error of about x^3/12 times the force that is still to relax, F. For a given number of steps the sum of these errors is
//! smallest if x is proportional to F^(-1/3).

use serde::{Deserialize, Serialize};

use super::ramp::SHORTEST;
use crate::bar::ends::Relaxation;

/// First step after a jump, in units of T: the error of the force right after the jump is half of this.
const FIRST: f64 = 1e-7;

/// Least length of a first step relative to the shortest step: below it, times are dominated by rounding.
const SHORTEST_FIRST: f64 = 1e-3;

/// Largest relative step at a force equal to the level: a longer one would not represent an exponential.
const COARSEST: f64 = 0.25;

/// Number of step heights of force change above which a wave is a jump.
const JUMP: f64 = 8.0;

/// Fraction of a step height of force change below which a wave does not end a step.
const PASSING: f64 = 0.1;

/// Parameters of the step lengths.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct StepControl {
    /// Length of a step, in units of T, at a force of `level` (N).
    part: f64,
    level: f64,
    /// Limits of the step length, s.
    shortest: f64,
    longest: f64,
    /// Upper limit of the next step, s; `None` right after a jump.
    grown: Option<f64>,
}

impl StepControl {
    /// Creates the control for steps of the fraction `part` (> 0) of `level` (N). `transit` is the elastic transit time of the bar (s): steps are no
    /// shorter than a millionth of it and no longer than it.
    pub fn new(part: f64, level: f64, transit: f64) -> Self {
        let (shortest, longest) = (SHORTEST * transit, transit);
        Self { part: part.min(COARSEST), level, shortest, longest, grown: None }
    }

    /// Makes the next step a first step after a jump.
    pub fn restart(&mut self) {
        self.grown = None;
    }

    /// Returns whether a change of the force by `change` is a jump, at a force of `force` (N).
    pub fn is_jump(&self, change: f64, force: f64) -> bool {
        change > JUMP * self.part * self.level.max(force.abs())
    }

    /// Returns the strength (N) below which waves do not end a step: the end follows them, and the next step takes them into account.
    pub fn passing(&self) -> f64 {
        PASSING * self.part * self.level
    }

    /// Largest change of the force over one step of a body with a nonlinear contact, N.
    pub fn largest_change(&self) -> f64 {
        self.part * self.level
    }

    /// Shortest step, s. Changes that take less time are not resolved.
    pub fn shortest(&self) -> f64 {
        self.shortest
    }

    /// Length of a step that resolves a relaxation, s.
    pub fn resolving(&self, relaxation: &Relaxation) -> f64 {
        // Where x would be 1, the error of any longer step is at most the force that is still to relax, over the time T: as much as that of all other
        // steps.
        if relaxation.force <= self.part.powi(3) * self.level {
            return self.longest;
        }
        let part = self.part * (self.level / relaxation.force).cbrt();
        (part * relaxation.time).clamp(self.shortest, self.longest)
    }

    /// Returns the length of the next step, s. Steps after a jump double.
    pub fn next(&mut self, relaxation: &Relaxation) -> f64 {
        let first = || (FIRST * relaxation.time).max(SHORTEST_FIRST * self.shortest);
        let length = self.resolving(relaxation).min(self.grown.unwrap_or_else(first));
        self.grown = Some(2.0 * length);
        length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_double_after_a_jump_up_to_their_length() {
        let mut control = StepControl::new(1e-3, 8.0, 10.0);
        let relaxation = Relaxation { time: 2.0, force: 1.0 };
        let steps: Vec<f64> = (0..20).map(|_| control.next(&relaxation)).collect();
        assert_eq!(steps[0], 2e-7);
        assert_eq!(steps[5], 64e-7);
        // An eighth of the level: twice the step.
        assert!((steps[19] / 4e-3 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_relaxation_that_is_over_at_once_is_not_followed() {
        let mut control = StepControl::new(1e-3, 1.0, 1.0);
        let quick = Relaxation { time: 1e-15, force: 1.0 };
        let (mut time, mut steps) = (0.0, 0);
        while time < SHORTEST {
            time += control.next(&quick);
            steps += 1;
        }
        assert!(steps < 20, "{steps}");
        // What is left is rounding: one step to the next arrival.
        let over: Vec<f64> = (0..30).map(|_| control.next(&Relaxation { time: 1e-15, force: 1e-15 })).collect();
        assert_eq!(over[29], 1.0);
    }
}

//! Step lengths of a body (a striker, a ball, a spring) at an end.
//!
//! While nothing arrives, a body on an elastically answering bar relaxes like exp(-t/T) ([`Relaxation`]). The mean of a step
//! of x T that follows a bilinear bar is off by about x^3/12 of the force that still has to relax, F. For a given number of steps
//! the sum of these errors is smallest where x goes with F^(-1/3).

use serde::{Deserialize, Serialize};

use super::ramp::SHORTEST;
use crate::bar::ends::Relaxation;

/// First step after a jump, in units of T: the force right after the jump is off by half of this.
const FIRST: f64 = 1e-7;

/// A first step is no shorter than this part of the shortest step: below, times are rounding.
const SHORTEST_FIRST: f64 = 1e-3;

/// Most that a step may be where the force is of the level: farther, it would be no picture of an exponential.
const COARSEST: f64 = 0.25;

/// A wave that changes the force by more than this many steps' worth is a jump.
const JUMP: f64 = 8.0;

/// A wave that changes the force by less than this part of a step's worth does not break a step.
const PASSING: f64 = 0.1;

/// What the lengths of steps depend on.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct StepControl {
    /// Length of a step at force `level` (N), in units of T.
    part: f64,
    level: f64,
    /// s.
    shortest: f64,
    longest: f64,
    /// Most that the next step may take, s; none right after a jump.
    grown: Option<f64>,
}

impl StepControl {
    /// Steps of `part` (> 0) of `level` (N). No step is followed that is over in a millionth of `transit`, the bar's elastic transit
    /// time (s), and none is longer than that time.
    pub fn new(part: f64, level: f64, transit: f64) -> Self {
        let (shortest, longest) = (SHORTEST * transit, transit);
        Self { part: part.min(COARSEST), level, shortest, longest, grown: None }
    }

    /// The next step starts after a jump.
    pub fn restart(&mut self) {
        self.grown = None;
    }

    /// Whether a change of the force by `change` is a jump, at a force of `force` (N).
    pub fn is_jump(&self, change: f64, force: f64) -> bool {
        change > JUMP * self.part * self.level.max(force.abs())
    }

    /// Waves weaker than this (N) do not break a step: the end goes along with them, and the next step deals with them.
    pub fn passing(&self) -> f64 {
        PASSING * self.part * self.level
    }

    /// Largest change of the force over one step of a body whose contact is not linear, N.
    pub fn largest_change(&self) -> f64 {
        self.part * self.level
    }

    /// No change is followed that is over sooner, s.
    pub fn shortest(&self) -> f64 {
        self.shortest
    }

    /// Length of a step that resolves a relaxation, s.
    pub fn resolving(&self, relaxation: &Relaxation) -> f64 {
        // Where x would be 1 any longer step is off by no more than what is left to relax, for the time T: as much as all others.
        if relaxation.force <= self.part.powi(3) * self.level {
            return self.longest;
        }
        let part = self.part * (self.level / relaxation.force).cbrt();
        (part * relaxation.time).clamp(self.shortest, self.longest)
    }

    /// Length of the next step, s. Steps after a jump double.
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

//! State of an end of a bar, as histories show it.

use serde::{Deserialize, Serialize};

/// Stress and velocity of an end.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct EndState {
    /// Stress, Pa, tension positive.
    pub stress: f64,
    /// Velocity, m/s, positive in +x.
    pub velocity: f64,
}

impl EndState {
    /// State that is not known.
    pub const UNKNOWN: Self = Self { stress: f64::NAN, velocity: f64::NAN };

    /// Returns the mean of this state and another one.
    #[must_use]
    pub fn mean(self, other: Self) -> Self {
        Self { stress: 0.5 * (self.stress + other.stress), velocity: 0.5 * (self.velocity + other.velocity) }
    }
}

/// State of an end of a bar on a grid after a step, or just after t = 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EndSample {
    /// State at the present time; [`EndState::UNKNOWN`] if the solver knows only means over steps.
    pub now: EndState,
    /// Mean over the latest step, of second order if the waves are elastic; otherwise, and at t = 0, [`EndState::UNKNOWN`].
    pub latest: EndState,
}

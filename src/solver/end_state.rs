//! Readings of an end of a bar.

use serde::{Deserialize, Serialize};

/// Stress and velocity of an end.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct EndState {
    /// Pa, tension positive.
    pub stress: f64,
    /// m/s, positive in +x.
    pub velocity: f64,
}

impl EndState {
    /// Not known.
    pub const UNKNOWN: Self = Self { stress: f64::NAN, velocity: f64::NAN };

    /// Half-way to another state.
    #[must_use]
    pub fn mean(self, other: Self) -> Self {
        Self { stress: 0.5 * (self.stress + other.stress), velocity: 0.5 * (self.velocity + other.velocity) }
    }
}

/// An end of a bar on a grid after a step, or just after t = 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EndSample {
    /// At the present time; [`EndState::UNKNOWN`] where the solver knows means over steps alone.
    pub now: EndState,
    /// Mean over the latest step, of second order where waves are elastic; else, and at t = 0, [`EndState::UNKNOWN`].
    pub latest: EndState,
}

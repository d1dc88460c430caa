//! Ends and joints that are suddenly loaded beyond yield.
//!
//! What starts there is a fan of fronts, and the state behind it holds until another wave comes. A scheme on a grid does not know that state
//! while its first cells are partly ahead of the fan: their mean stress is another, and overshoots, by the same part with any number of
//! cells. Leapfrog with a striker gave 65 MPa after the first step for 161 MPa, and 169 MPa later; the Godunov scheme at a shock 2.8 and 7.5 MPa for
//! 5 MPa; faces that meet carried the elastic impact of half a cell, more than twice the force. So histories and peaks of that time show the state that
//! is known. Nothing changes in the bar: momentum and energy are booked as the scheme has them.

use serde::{Deserialize, Serialize};

/// The state of an end or a joint that is suddenly loaded beyond yield, as long as it is known exactly and a scheme on a grid does not know it
/// yet. Histories and peaks show it; it changes nothing in the bar.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SuddenLoad {
    /// Just after t = 0, Pa.
    pub stress: f64,
    /// Just after t = 0, m/s.
    pub velocity: f64,
    /// Change of stress with the velocity of an end that a body drives, as it unloads, Pa s/m.
    pub(super) by_body: Option<f64>,
    /// From when the faces meet, s, and for so long, s.
    pub(super) from: f64,
    pub(super) lasts: f64,
}

impl SuddenLoad {
    /// Stress (Pa) and velocity (m/s) of an end at `time` (s), for which the scheme has these: the known ones up to half of the time, from
    /// there on more and more the scheme's. None before and after.
    pub fn end(&self, time: f64, [stress, velocity]: [f64; 2]) -> Option<[f64; 2]> {
        let weight = self.weight(time)?;
        let blend = |known: f64, scheme: f64| weight * known + (1.0 - weight) * scheme;
        Some(match self.by_body {
            Some(impedance) => [blend(self.stress + impedance * (velocity - self.velocity), stress), velocity],
            None => [blend(self.stress, stress), blend(self.velocity, velocity)],
        })
    }

    /// The stress at `time` (s) of a joint, for which the scheme has this one.
    pub fn joint(&self, time: f64, stress: f64) -> f64 {
        self.weight(time).map_or(stress, |weight| weight * self.stress + (1.0 - weight) * stress)
    }

    fn weight(&self, time: f64) -> Option<f64> {
        let elapsed = (time - self.from) / self.lasts;
        (0.0..1.0).contains(&elapsed).then(|| (2.0 * (1.0 - elapsed)).min(1.0))
    }
}

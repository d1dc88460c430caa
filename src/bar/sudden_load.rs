//! The exact state of an end or a joint that is suddenly loaded beyond yield.
//!
//! Such a load starts a fan of fronts, and the state behind the fan is constant until another wave arrives. On a grid, the first cells contain
//! the fan at first. Their mean stress differs from that behind it and, in a scheme that starts from rest, overshoots, by the same fraction at
//! any resolution: for 161 MPa behind the fan of a striker, leapfrog gave 65 MPa after the first step and then 169 MPa; for 5 MPa behind a
//! shock, the Godunov scheme gave 2.8 and then 7.5 MPa; the force between colliding faces was the elastic impact of half a cell, more than twice the exact one. Histories and
//! peaks therefore show the exact state at first. The solution in the bar, and its momentum and energy, are those of the scheme.

use serde::{Deserialize, Serialize};

/// A sudden load: the state behind its fan, and the time for which histories and peaks show it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SuddenLoad {
    /// Behind the fan, Pa.
    pub stress: f64,
    /// Behind the fan, m/s.
    pub velocity: f64,
    /// Of an end that a body drives: change of stress with velocity in unloading, Pa s/m.
    pub(super) by_body: Option<f64>,
    /// Start, s: later than 0 if a gap closes first.
    pub(super) from: f64,
    /// Duration, s.
    pub(super) lasts: f64,
}

impl SuddenLoad {
    /// Stress (Pa) and velocity (m/s) of an end at `time` (s), given those of the scheme; none outside the time of the load.
    pub fn end(&self, time: f64, [stress, velocity]: [f64; 2]) -> Option<[f64; 2]> {
        self.weight(time)?;
        Some(match self.by_body {
            Some(impedance) => {
                [self.blend(time, self.stress + impedance * (velocity - self.velocity), stress), velocity]
            }
            None => [self.blend(time, self.stress, stress), self.blend(time, self.velocity, velocity)],
        })
    }

    /// A quantity at `time` (s): the known value in the first half of the load, then a mean with that of the scheme, which goes over to
    /// the scheme's at its end.
    pub fn blend(&self, time: f64, known: f64, scheme: f64) -> f64 {
        self.weight(time).map_or(scheme, |weight| weight * known + (1.0 - weight) * scheme)
    }

    fn weight(&self, time: f64) -> Option<f64> {
        let elapsed = (time - self.from) / self.lasts;
        (0.0..1.0).contains(&elapsed).then(|| (2.0 * (1.0 - elapsed)).min(1.0))
    }
}

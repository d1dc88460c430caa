//! The self-similar answer for a long bar whose end is suddenly given a velocity or a stress: one straight front
//! for each edge of the upper concave hull of the curve.
//!
//! Everything here is in magnitudes (strain, stress, velocity jump all >= 0); the caller puts the signs.

use serde::Serialize;

use crate::material::{Curve, UltimateReason};

/// One edge of the hull: one front, carrying the material from the state ahead to the state behind.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Edge {
    /// Strain before the front arrives.
    pub strain_ahead: f64,
    /// Strain after it has passed.
    pub strain_behind: f64,
    /// Stress before, Pa.
    pub stress_ahead: f64,
    /// Stress after, Pa.
    pub stress_behind: f64,
    /// sqrt(d sigma / (rho d eps)), m/s; 0 for a flat edge.
    pub speed: f64,
}

impl Edge {
    /// Velocity jump across the front, m/s: speed * d eps.
    pub fn velocity_jump(&self) -> f64 {
        self.speed * (self.strain_behind - self.strain_ahead)
    }
}

/// The fronts that a suddenly imposed velocity or stress sends out, fastest first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fan {
    /// Fronts, fastest first; none where nothing is imposed.
    pub edges: Vec<Edge>,
    /// Strain behind the last front.
    pub strain: f64,
    /// Stress behind the last front, Pa.
    pub stress: f64,
    /// Velocity change behind the last front, m/s.
    pub velocity: f64,
    /// The imposed value is more than the curve can carry away: strain gathers at the struck end, which breaks
    /// there. `stress` is then the ultimate stress.
    pub above_critical: bool,
    /// The imposed value runs past the last knot of a curve that still rises there (not critical, but unknown).
    pub beyond_data: bool,
}

/// Critical impact velocity of one curve, and what it rests on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Critical {
    /// m/s.
    pub velocity: f64,
    /// Strain of the ultimate point.
    pub strain: f64,
    /// Stress of the ultimate point, Pa.
    pub stress: f64,
    /// What makes it the ultimate point.
    pub reason: UltimateReason,
}

/// Upper concave hull of the table from 0 to `strain` (> 0; past the last knot only with `Beyond::Extend`),
/// fastest front first. Neighbouring table segments of equal slope are one front.
pub fn hull(curve: &Curve, density: f64, strain: f64) -> Vec<Edge> {
    let _ = (curve, density, strain);
    todo!()
}

/// Velocity change that loads the bar to `strain`, m/s: the sum of c d eps over the hull.
pub fn impact_velocity(curve: &Curve, density: f64, strain: f64) -> f64 {
    hull(curve, density, strain).iter().map(Edge::velocity_jump).sum()
}

/// The fan behind which the velocity has changed by `velocity` (m/s, >= 0), exact for the table.
pub fn fan_at_velocity(curve: &Curve, density: f64, velocity: f64) -> Fan {
    let _ = (curve, density, velocity);
    todo!()
}

/// The fan behind which the stress is `stress` (Pa, >= 0). A stress above the ultimate stress is `above_critical`.
pub fn fan_at_stress(curve: &Curve, density: f64, stress: f64) -> Fan {
    let _ = (curve, density, stress);
    todo!()
}

/// The critical impact velocity, where the data hold one.
pub fn critical(curve: &Curve, density: f64) -> Option<Critical> {
    let _ = (curve, density);
    todo!()
}

impl Fan {
    /// State at distance x from the struck end at time t, with xi = x/t (m/s, >= 0): (strain, stress, velocity
    /// change). On a front: the state behind it.
    pub fn state(&self, xi: f64) -> (f64, f64, f64) {
        let _ = xi;
        todo!()
    }
}

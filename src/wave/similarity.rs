//! Self-similar solution for a long bar with a suddenly imposed end velocity or stress: one front for each edge of the upper concave hull
//! of the curve.
//!
//! All quantities are magnitudes (strain, stress, velocity jump >= 0); the caller adds the signs. Densities must be those of a checked
//! material, see [`Material::check`](crate::material::Material::check). With a density of 0, speeds and velocities are infinite; NaN
//! inputs give NaN results.

use serde::Serialize;

use super::hull::{Hull, Knot, Line};
use crate::material::{Beyond, Curve, UltimateReason};

/// Distance of a curve below its concave hull, relative to its stress, up to which the dissipation is negligible. It corresponds to the scatter of
/// test records.
pub const SCATTER: f64 = 0.02;

/// One edge of the hull: a front that changes the material from the state ahead to the state behind.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Edge {
    /// Strain before the front arrives.
    pub strain_ahead: f64,
    /// Strain after it has passed.
    pub strain_behind: f64,
    /// Stress before the front arrives, Pa.
    #[serde(rename = "stress_ahead_Pa")]
    pub stress_ahead: f64,
    /// Stress after it has passed, Pa.
    #[serde(rename = "stress_behind_Pa")]
    pub stress_behind: f64,
    /// Speed of the front, sqrt(d sigma / (rho d eps)), m/s; 0 for a flat edge.
    #[serde(rename = "speed_m_s")]
    pub speed: f64,
}

/// Relative difference from the elastic wave speed up to which the speed of a front counts as equal.
const SAME_SPEED: f64 = 1e-9;

/// Returns true if a front of this `speed` is an elastic wave, with the elastic wave speed `c0`, m/s.
pub fn is_elastic(speed: f64, c0: f64) -> bool {
    speed >= c0 * (1.0 - SAME_SPEED)
}

impl Edge {
    fn between(ahead: Knot, behind: Knot, density: f64) -> Self {
        Self {
            strain_ahead: ahead.strain,
            strain_behind: behind.strain,
            stress_ahead: ahead.stress,
            stress_behind: behind.stress,
            speed: (ahead.slope_to(behind) / density).sqrt(),
        }
    }

    /// Returns true if the front travels with the elastic wave speed `c0`, m/s, up to rounding.
    pub fn is_elastic(&self, c0: f64) -> bool {
        is_elastic(self.speed, c0)
    }

    /// Returns true if the curve lies below the chord from the state ahead to the state behind by more than [`SCATTER`].
    pub fn is_shock(&self, curve: &Curve) -> bool {
        let slope = (self.stress_behind - self.stress_ahead) / (self.strain_behind - self.strain_ahead);
        let chord = |strain: f64| self.stress_ahead + slope * (strain - self.strain_ahead);
        let inside = |strain: f64| self.strain_ahead < strain && strain < self.strain_behind;
        let mut knots = curve.strain().iter().zip(curve.stress()).filter(|&(&strain, _)| inside(strain));
        knots.any(|(&strain, &stress)| chord(strain) > (1.0 + SCATTER) * stress)
    }

    /// Returns the velocity jump across the front, speed * d eps, m/s.
    pub fn velocity_jump(&self) -> f64 {
        self.speed * (self.strain_behind - self.strain_ahead)
    }
}

/// The fan of fronts emitted by a suddenly imposed velocity or stress.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fan {
    /// Fronts, fastest first; empty if nothing is imposed.
    pub edges: Vec<Edge>,
    /// Strain behind the last front.
    pub strain: f64,
    /// Stress behind the last front, Pa.
    pub stress: f64,
    /// Velocity change behind the last front, m/s.
    pub velocity: f64,
    /// Whether the imposed value exceeds what waves can carry away. Strain then accumulates at the loaded end, which fractures
    /// there. `stress` is then the ultimate stress.
    pub above_critical: bool,
    /// Whether the imposed value lies beyond the last knot of a curve that still rises there (not critical, but unknown).
    pub beyond_data: bool,
}

/// Critical impact velocity of a curve, and its criterion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Critical {
    /// Critical impact velocity, m/s.
    pub velocity: f64,
    /// Strain of the ultimate point.
    pub strain: f64,
    /// Stress of the ultimate point, Pa.
    pub stress: f64,
    /// Criterion of the ultimate point.
    pub reason: UltimateReason,
}

/// Returns the upper concave hull of the table from 0 to `strain` (> 0; beyond the last knot only with `Beyond::Extend`),
/// fastest front first. Neighbouring table segments of equal slope form one front. If the stress at `strain` is
/// below an earlier maximum, the hull ends with a flat edge (speed 0) at that maximum.
pub fn hull(curve: &Curve, density: f64, strain: f64) -> Vec<Edge> {
    edges(&hull_to(curve, density, strain))
}

/// Returns the velocity change that loads the bar to `strain`, m/s: the sum of c d eps over the hull.
pub fn impact_velocity(curve: &Curve, density: f64, strain: f64) -> f64 {
    hull_to(curve, density, strain).velocity()
}

fn hull_to(curve: &Curve, density: f64, strain: f64) -> Hull {
    let loading = curve.running_maximum();
    let mut hull = Hull::new(density);
    for (&e, &s) in loading.strain().iter().zip(loading.stress()).skip(1).take_while(|(e, _)| **e < strain) {
        hull.push(Knot { strain: e, stress: s });
    }
    hull.push(Knot { strain, stress: loading.stress_at(strain) });
    hull
}

/// Returns the velocity change that loads the bar to each knot of the curve's running maximum, as (strain, m/s) starting with (0, 0).
/// Computed in one pass.
pub fn impact_velocities(curve: &Curve, density: f64) -> Vec<(f64, f64)> {
    let loading = curve.running_maximum();
    let mut hull = Hull::new(density);
    let mut rows = vec![(0.0, 0.0)];
    for (&strain, &stress) in loading.strain().iter().zip(loading.stress()).skip(1) {
        hull.push(Knot { strain, stress });
        rows.push((strain, hull.velocity()));
    }
    rows
}

/// Returns the fan behind which the velocity has changed by `velocity` (m/s, >= 0), exact for the table.
pub fn fan_at_velocity(curve: &Curve, density: f64, velocity: f64) -> Fan {
    imposed(curve, density, velocity, |hull, line| hull.reach_velocity(line, velocity))
}

/// Returns the fan behind which the stress is `stress` (Pa, >= 0). For a stress above the ultimate stress, `above_critical` is set.
pub fn fan_at_stress(curve: &Curve, density: f64, stress: f64) -> Fan {
    imposed(curve, density, stress, |_, line| Hull::reach_stress(line, stress))
}

/// Returns the critical impact velocity. `None` if the curve has no ultimate point.
pub fn critical(curve: &Curve, density: f64) -> Option<Critical> {
    let ultimate = curve.ultimate()?;
    Some(Critical {
        velocity: impact_velocity(curve, density, ultimate.strain),
        strain: ultimate.strain,
        stress: ultimate.stress,
        reason: ultimate.reason,
    })
}

/// Builds the hull knot by knot until `reach` finds the imposed value on the next piece of the curve.
fn imposed(curve: &Curve, density: f64, value: f64, reach: impl Fn(&Hull, Line) -> Option<Knot>) -> Fan {
    let mut hull = Hull::new(density);
    if value.is_nan() {
        return Fan { strain: value, stress: value, velocity: value, ..fan(&hull) };
    }
    if value <= 0.0 {
        return fan(&hull);
    }
    let loading = curve.running_maximum();
    let knots = loading.strain().iter().zip(loading.stress()).map(|(&strain, &stress)| Knot { strain, stress });
    let ultimate = curve.ultimate();
    let reached_ultimate = |knot: Knot| ultimate.is_some_and(|u| knot.strain >= u.strain);
    for (slope, to) in loading.slopes().zip(knots.skip(1)) {
        if reached_ultimate(hull.last()) {
            break;
        }
        let line = Line { from: hull.last(), slope, to: Some(to) };
        if let Some(end) = reach(&hull, line) {
            hull.push(end);
            return fan(&hull);
        }
        hull.push(to);
    }
    if ultimate.is_some() {
        return Fan { above_critical: true, ..fan(&hull) };
    }
    if loading.beyond() == Beyond::Extend {
        let line = Line { from: hull.last(), slope: loading.last_slope(), to: None };
        if let Some(end) = reach(&hull, line) {
            hull.push(end);
            return fan(&hull);
        }
    }
    Fan { beyond_data: true, ..fan(&hull) }
}

fn edges(hull: &Hull) -> Vec<Edge> {
    hull.knots().windows(2).map(|pair| Edge::between(pair[0], pair[1], hull.density())).collect()
}

fn fan(hull: &Hull) -> Fan {
    let last = hull.last();
    Fan {
        edges: edges(hull),
        strain: last.strain,
        stress: last.stress,
        velocity: hull.velocity(),
        above_critical: false,
        beyond_data: false,
    }
}

impl Fan {
    /// Returns the state at distance x from the loaded end at time t, with xi = x/t (m/s, >= 0), as (strain, stress, velocity
    /// change). On a front, returns the state behind it.
    pub fn state(&self, xi: f64) -> (f64, f64, f64) {
        let mut state = (0.0, 0.0, 0.0);
        for edge in self.edges.iter().take_while(|edge| edge.speed >= xi) {
            state = (edge.strain_behind, edge.stress_behind, state.2 + edge.velocity_jump());
        }
        state
    }
}

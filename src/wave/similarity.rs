//! The self-similar solution of a long bar with a sudden end velocity or stress: one front for each edge of the upper concave hull
//! of the curve.
//!
//! Everything here is in magnitudes (strain, stress, velocity jump all >= 0); the caller puts the signs. Densities are those of a checked
//! material, see [`Material::check`](crate::material::Material::check): with a density of 0, speeds and velocities are infinite, and what is
//! not a number gives what is not a number.

use serde::Serialize;

use super::hull::{Hull, Knot, Line};
use crate::material::{Beyond, Curve, UltimateReason};

/// Part of its stress by which a curve may lie below its concave hull, where that takes no energy that matters: that of the scatter of test
/// records.
pub const SCATTER: f64 = 0.02;

/// One edge of the hull: one front, carrying the material from the state ahead to the state behind.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Edge {
    /// Strain before the front arrives.
    pub strain_ahead: f64,
    /// Strain after it has passed.
    pub strain_behind: f64,
    /// Stress before, Pa.
    #[serde(rename = "stress_ahead_Pa")]
    pub stress_ahead: f64,
    /// Stress after, Pa.
    #[serde(rename = "stress_behind_Pa")]
    pub stress_behind: f64,
    /// sqrt(d sigma / (rho d eps)), m/s; 0 for a flat edge.
    #[serde(rename = "speed_m_s")]
    pub speed: f64,
}

/// Part by which the speed of a front may differ from that of elastic waves and be the same.
const SAME_SPEED: f64 = 1e-9;

/// A front of this `speed` is an elastic wave where those have the speed `c0`, m/s.
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

    /// It travels with the elastic wave speed `c0`, m/s, but for rounding.
    pub fn is_elastic(&self, c0: f64) -> bool {
        is_elastic(self.speed, c0)
    }

    /// The curve lies below the chord from the state ahead to the state behind, by more than [`SCATTER`].
    pub fn is_shock(&self, curve: &Curve) -> bool {
        let slope = (self.stress_behind - self.stress_ahead) / (self.strain_behind - self.strain_ahead);
        let chord = |strain: f64| self.stress_ahead + slope * (strain - self.strain_ahead);
        let inside = |strain: f64| self.strain_ahead < strain && strain < self.strain_behind;
        let mut knots = curve.strain().iter().zip(curve.stress()).filter(|&(&strain, _)| inside(strain));
        knots.any(|(&strain, &stress)| chord(strain) > (1.0 + SCATTER) * stress)
    }

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

/// Critical impact velocity of one curve, and its criterion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Critical {
    /// m/s.
    pub velocity: f64,
    /// Strain of the ultimate point.
    pub strain: f64,
    /// Stress of the ultimate point, Pa.
    pub stress: f64,
    /// Criterion of the ultimate point.
    pub reason: UltimateReason,
}

/// Upper concave hull of the table from 0 to `strain` (> 0; past the last knot only with `Beyond::Extend`),
/// fastest front first. Neighbouring table segments of equal slope are one front. Where the stress at `strain` is
/// below an earlier maximum the hull ends with a flat edge (speed 0) at that maximum.
pub fn hull(curve: &Curve, density: f64, strain: f64) -> Vec<Edge> {
    edges(&hull_to(curve, density, strain))
}

/// Velocity change that loads the bar to `strain`, m/s: the sum of c d eps over the hull.
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

/// Velocity change that loads the bar to each knot of the curve's running maximum: (strain, m/s) from (0, 0), in
/// one pass.
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

/// The fan behind which the velocity has changed by `velocity` (m/s, >= 0), exact for the table.
pub fn fan_at_velocity(curve: &Curve, density: f64, velocity: f64) -> Fan {
    imposed(curve, density, velocity, |hull, line| hull.reach_velocity(line, velocity))
}

/// The fan behind which the stress is `stress` (Pa, >= 0). A stress above the ultimate stress is `above_critical`.
pub fn fan_at_stress(curve: &Curve, density: f64, stress: f64) -> Fan {
    imposed(curve, density, stress, |_, line| Hull::reach_stress(line, stress))
}

/// The critical impact velocity, where the data hold one.
pub fn critical(curve: &Curve, density: f64) -> Option<Critical> {
    let ultimate = curve.ultimate()?;
    Some(Critical {
        velocity: impact_velocity(curve, density, ultimate.strain),
        strain: ultimate.strain,
        stress: ultimate.stress,
        reason: ultimate.reason,
    })
}

/// Grows the hull knot by knot until `reach` finds the imposed value on the next piece of the curve.
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
    /// State at distance x from the struck end at time t, with xi = x/t (m/s, >= 0): (strain, stress, velocity
    /// change). On a front: the state behind it.
    pub fn state(&self, xi: f64) -> (f64, f64, f64) {
        let mut state = (0.0, 0.0, 0.0);
        for edge in self.edges.iter().take_while(|edge| edge.speed >= xi) {
            state = (edge.strain_behind, edge.stress_behind, state.2 + edge.velocity_jump());
        }
        state
    }
}

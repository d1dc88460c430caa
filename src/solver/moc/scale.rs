//! The stress scale of tolerances and steps.

use crate::bar::ends::Face;
use crate::bar::{EndCondition, History};
use crate::wave::riemann::{Medium, Point, Side, Workspace, solve};

/// Largest stress (Pa) and range of velocities (m/s, in +x) that an end imposes.
pub(super) type Load = (f64, [f64; 2]);

/// Returns the stress scale, see [`super::FrontTracking::stress_scale`], of a bar in these states, given by segment, under these loads.
pub(super) fn stress_scale(points: &[(usize, Point)], media: &[Medium], loads: [Option<Load>; 2]) -> f64 {
    let loads = || loads.into_iter().flatten();
    let velocities = || points.iter().map(|(_, point)| point.velocity).chain(loads().flat_map(|load| load.1));
    let range = velocities().fold(f64::MIN, f64::max) - velocities().fold(f64::MAX, f64::min);
    let mut work = Workspace::default();
    let largest = points.iter().map(|(k, point)| {
        let unstressed = Point { stress: 0.0, velocity: 0.0, ..*point };
        struck(&media[*k], &unstressed, range, &mut work).max(point.stress.abs())
    });
    largest.fold(loads().map(|load| load.0).fold(0.0, f64::max), f64::max)
}

/// Magnitude of the stress (Pa) that an end velocity of `velocity` (m/s) causes in a material at rest.
fn struck(medium: &Medium, at_rest: &Point, velocity: f64, work: &mut Workspace) -> f64 {
    let driver = Side::Straight { force: 0.0, velocity: -velocity, compliance: 0.0 };
    (solve(driver, Side::Bar(medium, at_rest), work).force / medium.area).abs()
}

/// Returns for each segment the largest stress of all segments over its own, >= 1, if all are struck at the velocity of a free end behind an elastic
/// wave of `stress_scale` (Pa) in the segment of the largest impedance.
pub(super) fn change_weights(media: &[Medium], stress_scale: f64) -> Vec<f64> {
    let velocity = 2.0 * stress_scale / media.iter().map(Medium::impedance).fold(0.0, f64::max);
    let mut work = Workspace::default();
    let mut stress = |medium| struck(medium, &Point::default(), velocity, &mut work).min(stress_scale);
    let stresses: Vec<f64> = media.iter().map(&mut stress).collect();
    let largest = stresses.iter().copied().fold(0.0, f64::max);
    stresses.iter().map(|&stress| if stress > 0.0 { largest / stress } else { 1.0 }).collect()
}

/// Returns the load that an end imposes.
pub(super) fn load(condition: &EndCondition, face: &Face) -> Load {
    let rest = face.inward * face.velocity;
    // A body that moves away from the end imposes nothing.
    let closing = |velocity: f64| (face.inward * velocity - face.velocity).max(0.0);
    let struck = |velocity: f64| [rest + face.inward * closing(velocity); 2];
    let range = |h: &History| h.value().iter().fold([0.0, 0.0], |[low, high]: [f64; 2], &v| [low.min(v), high.max(v)]);
    match condition {
        EndCondition::Velocity { history, .. } => (0.0, range(history)),
        EndCondition::Stress { history } => (history.extreme().abs(), [rest; 2]),
        EndCondition::Fixed => (0.0, [0.0; 2]),
        EndCondition::Wall { .. } => (0.0, struck(0.0)),
        EndCondition::Striker { velocity, .. } => (0.0, struck(*velocity)),
        EndCondition::Spring { .. } | EndCondition::Dashpot { .. } => (0.0, [0.0, rest]),
        EndCondition::Free | EndCondition::Absorbing => (0.0, [rest; 2]),
        EndCondition::Ball { mass, velocity, contact } => {
            (contact.most_force(*mass, closing(*velocity), face.impedance) / face.area, [rest; 2])
        }
    }
}

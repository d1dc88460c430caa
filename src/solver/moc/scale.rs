//! The stress scale of tolerances and steps.

use crate::bar::ends::Face;
use crate::bar::{EndCondition, History};
use crate::wave::riemann::{Medium, Point, Side, Workspace, solve};

/// Largest stress (Pa) and the range of velocities (m/s, in +x) that an end imposes.
pub(super) type Load = (f64, [f64; 2]);

/// See [`super::FrontTracking::stress_scale`]: of a bar in these states, by segment, under these loads.
pub(super) fn stress_scale(points: &[(usize, Point)], media: &[Medium], loads: [Option<Load>; 2]) -> f64 {
    let loads = || loads.into_iter().flatten();
    let velocities = || points.iter().map(|(_, point)| point.velocity).chain(loads().flat_map(|load| load.1));
    let range = velocities().fold(f64::MIN, f64::max) - velocities().fold(f64::MAX, f64::min);
    let mut work = Workspace::default();
    let struck = points.iter().map(|(k, point)| {
        let medium = &media[*k];
        let driver = Side::Straight { force: 0.0, velocity: -range, compliance: 0.0 };
        let unstressed = Point { stress: 0.0, velocity: 0.0, ..*point };
        let stress = solve(driver, Side::Bar(medium, &unstressed), &mut work).force / medium.area;
        stress.abs().max(point.stress.abs())
    });
    struck.fold(loads().map(|load| load.0).fold(0.0, f64::max), f64::max)
}

/// What an end imposes.
pub(super) fn load(condition: &EndCondition, face: &Face) -> Load {
    let rest = face.inward * face.velocity;
    // What moves away from the end imposes nothing on it.
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
            let closing = closing(*velocity);
            let force = contact.force(contact.largest_approach(*mass, closing));
            (force.min(face.impedance * closing) / face.area, [rest; 2])
        }
    }
}

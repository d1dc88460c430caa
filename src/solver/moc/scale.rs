//! The stress scale of tolerances and steps.

use crate::bar::ends::Face;
use crate::bar::{EndCondition, History};
use crate::wave::riemann::{Medium, Point, Side, Workspace, solve};

/// See [`super::FrontTracking::stress_scale`].
pub(super) fn stress_scale(starts: &[(usize, Point)], media: &[Medium], ends: [(&EndCondition, &Face); 2]) -> f64 {
    let imposed = ends.map(|(condition, face)| imposed(condition, face));
    let velocities = || starts.iter().map(|(_, start)| start.velocity).chain(imposed.iter().flat_map(|i| i.1));
    let range = velocities().fold(f64::MIN, f64::max) - velocities().fold(f64::MAX, f64::min);
    let mut work = Workspace::default();
    let struck = starts.iter().map(|(k, start)| {
        let medium = &media[*k];
        let driver = Side::Straight { force: 0.0, velocity: -range, compliance: 0.0 };
        let unstressed = Point { stress: 0.0, velocity: 0.0, ..*start };
        let stress = solve(driver, Side::Bar(medium, &unstressed), &mut work).force / medium.area;
        stress.abs().max(start.stress.abs())
    });
    struck.fold(imposed[0].0.max(imposed[1].0), f64::max)
}

/// Largest stress (Pa) and the range of velocities (m/s, in +x) that an end imposes.
fn imposed(condition: &EndCondition, face: &Face) -> (f64, [f64; 2]) {
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

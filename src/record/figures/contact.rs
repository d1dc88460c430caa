//! Results at ends and joints: forces, contact, and rebound velocities.
//!
//! A body is a part of the bar between joints that can open. Its velocity after contact is its momentum over its mass
//! at the end of the run. This equals its velocity since its last contact if no force acts on it any more: both its
//! faces are free by then, and no force is distributed along it.

use super::records::{Records, SegmentEnd};
use super::tally::Load;
use crate::bar::{EndCondition, Joint, Segment};
use crate::record::ContactReading;

/// Fraction of the momentum transferred through the bar up to which an impulse is attributed to rounding.
const ROUNDING: f64 = 1e-12;

/// Duration and end of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ContactTime {
    /// Total time under force, s.
    pub duration: f64,
    /// Time of release, s; `None` while the contact lasts, and if there was no contact.
    pub released: Option<f64>,
}

/// Results at an end or a joint.
#[derive(Debug)]
pub(super) struct Site {
    pub load: Load,
    /// Cross-section, m^2; `None` if the scene gives none, and in torsion.
    pub area: Option<f64>,
    /// Ratio of torque to surface stress, m^3; `None` in axial bars.
    pub torque_per_stress: Option<f64>,
    /// Radius of the surface, m; `None` in axial bars.
    pub radius: Option<f64>,
    /// Impulse on the part to the right of the joint, or on the bar at an end, N s, positive in +x (in torsion referred
    /// to the surface); `None` if it is not known.
    pub impulse: Option<f64>,
    /// Contact; `None` if the faces cannot separate.
    pub contact: Option<ContactTime>,
    pub restitution: Option<f64>,
    /// Velocity of the striker after its last contact, m/s.
    pub striker_after: Option<f64>,
    /// Velocities after contact of the bodies on the left and on the right, m/s.
    pub bodies_after: [Option<f64>; 2],
}

/// Mean velocities before the first and after the last contact, m/s.
#[derive(Debug, Clone, Copy)]
struct Motion {
    before: f64,
    after: f64,
}

const AT_REST: Motion = Motion { before: 0.0, after: 0.0 };

/// Face of a body: an end (0 left, 1 right), or a joint that can open.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Face {
    End(usize),
    Joint(usize),
}

/// Part of the bar between joints that can open, with its faces.
struct Body {
    faces: [Face; 2],
    before: f64,
    at_end: f64,
}

/// Computes the results at both ends, and at the joints from left to right.
pub(super) fn sites(records: &Records<'_>) -> ([Site; 2], Vec<Site>) {
    let bodies = bodies(records);
    let ends = [0, 1].map(|side| end(records, &bodies, side));
    let joints = (0..records.bar.segments.len() - 1).map(|k| joint(records, &bodies, k)).collect();
    (ends, joints)
}

fn end(records: &Records<'_>, bodies: &[Body], side: usize) -> Site {
    let segment = if side == 0 { 0 } else { records.bar.segments.len() - 1 };
    let area = records.bar.segments[segment].end_areas()[side];
    let body = if side == 0 { bodies.first() } else { bodies.last() };
    let face = Face::End(side);
    let inside = body.filter(|_| contact(records, face).is_some()).and_then(|body| motion(records, body));
    let outside = outside(records, side);
    let held = body.and_then(|body| records.held_beyond(body, face));
    let mut pair = [outside, inside.or(held).filter(|_| body.is_some_and(|body| touches_only(records, body, face)))];
    let mut after = [None, inside.map(|motion| motion.after)];
    if side == 1 {
        pair.reverse();
        after.reverse();
    }
    Site {
        load: records.tally.ends[side],
        area: records.area(area),
        torque_per_stress: records.torque_per_stress(segment),
        radius: records.radius(),
        impulse: Some(records.account.impulse[side] + 0.0),
        contact: contact(records, face),
        restitution: restitution(pair),
        striker_after: records.strikers[side].and(outside).map(|motion| records.levers[side] * motion.after),
        bodies_after: after,
    }
}

fn joint(records: &Records<'_>, bodies: &[Body], k: usize) -> Site {
    let face = Face::Joint(k);
    let beside = |side: usize| bodies.iter().find(|body| body.faces[1 - side] == face);
    let motions = [0, 1].map(|side| {
        let body = beside(side)?;
        let alone = touches_only(records, body, face);
        let free = motion(records, body);
        Some((free, free.or_else(|| records.held_beyond(body, face)).filter(|_| alone)))
    });
    let mut load = records.tally.joints[k];
    let mut area = records.joint_areas[k];
    if let Some(ContactReading { pressed, .. }) = records.pressed(k) {
        // Force between the faces themselves, N.
        load.peak.largest.value = 0.0 - pressed.peak;
        load.peak.largest.at = pressed.time_of_peak;
        area = 1.0;
    } else {
        // A front that fractures the joint leaves no joint stress behind it.
        let broken = records.breaks[k];
        load.peak.largest.add(broken.at, broken.value / area);
        if let Some(ContactReading { pressed, .. }) = records.faces(k) {
            // The times of the contact count from the fracture on.
            load.peak.largest.add(broken.at + pressed.time_of_peak, -pressed.peak / area);
        }
    }
    Site {
        load,
        area: records.area(area),
        torque_per_stress: records.torque_per_stress(k),
        radius: records.radius(),
        impulse: impulse_across(records, k),
        contact: contact(records, face),
        restitution: restitution(motions.map(|motion| motion.and_then(|(_, paired)| paired))),
        striker_after: None,
        bodies_after: motions.map(|motion| motion.and_then(|(free, _)| free).map(|motion| motion.after)),
    }
}

/// Returns the impulse across the joint behind segment `k` on the part to its right, from the momentum balance of the
/// part to its left; `None` if distributed forces act.
fn impulse_across(records: &Records<'_>, k: usize) -> Option<f64> {
    let gained = |(end, segment): (&SegmentEnd, &Segment)| end.momentum - end.mass * segment.velocity;
    let gained: f64 = records.segments.iter().zip(&records.bar.segments).take(k + 1).map(gained).sum();
    let across = records.account.impulse[0] - gained;
    // The remainder of contributions that cancel is rounding.
    let held: f64 = records.segments.iter().map(|end| end.momentum.abs()).sum();
    let rounding = ROUNDING * records.account.momentum_scale.max(held);
    records.is_pushed_at_faces_only().then_some(if across.abs() > rounding { across } else { 0.0 })
}

/// Returns the relative velocity of separation over that of approach of the bodies on the left and on the right.
fn restitution([left, right]: [Option<Motion>; 2]) -> Option<f64> {
    let (left, right) = (left?, right?);
    let approach = left.before - right.before;
    (approach > 0.0).then(|| (right.after - left.after) / approach)
}

/// Returns the motion of the wall, striker or ball at an end; `None` if it is not known or the contact lasts.
fn outside(records: &Records<'_>, side: usize) -> Option<Motion> {
    contact(records, Face::End(side))?.released?;
    match *records.ends[side] {
        EndCondition::Wall { .. } => Some(AT_REST),
        EndCondition::Striker { velocity, .. } | EndCondition::Ball { velocity, .. } => {
            Some(Motion { before: velocity, after: records.strikers[side]? })
        }
        _ => None,
    }
}

/// Returns the contact of a face; `None` if the face cannot separate.
fn contact(records: &Records<'_>, face: Face) -> Option<ContactTime> {
    let of = |load: &Load| ContactTime {
        duration: load.duration,
        released: (load.is_released && load.duration > 0.0).then_some(load.loaded_until),
    };
    match face {
        Face::End(side) => {
            let parts = matches!(
                records.ends[side],
                EndCondition::Wall { .. }
                    | EndCondition::Striker { .. }
                    | EndCondition::Ball { .. }
                    | EndCondition::Velocity { release: Some(_), .. }
            );
            parts.then(|| of(&records.tally.ends[side]))
        }
        Face::Joint(k) if records.bar.segments[k].joint == Joint::Bonded => None,
        Face::Joint(k) => Some(match records.pressed(k) {
            None => of(&records.tally.joints[k]),
            Some(ContactReading { presses, pressed, .. }) => ContactTime {
                duration: pressed.duration,
                released: (!presses && pressed.duration > 0.0).then_some(pressed.pressed_until),
            },
        }),
    }
}

/// Returns true if no other face of the body has carried a force; a fixed or absorbing far end is allowed.
fn touches_only(records: &Records<'_>, body: &Body, face: Face) -> bool {
    let other = if body.faces[0] == face { body.faces[1] } else { body.faces[0] };
    records.held_beyond(body, face).is_some()
        || contact(records, other).map_or_else(|| is_free(records, other), |contact| contact.duration == 0.0)
}

/// Returns true if the face is a free end.
fn is_free(records: &Records<'_>, face: Face) -> bool {
    matches!(face, Face::End(side) if matches!(records.ends[side], EndCondition::Free))
}

/// Returns the motion of a body that has been in contact and that nothing touches at the end of the run; `None` for other bodies.
fn motion(records: &Records<'_>, body: &Body) -> Option<Motion> {
    let contacts = body.faces.map(|face| contact(records, face));
    let free = |k: usize| match contacts[k] {
        Some(contact) => contact.released.is_some() || contact.duration == 0.0,
        None => is_free(records, body.faces[k]),
    };
    let touched = contacts.iter().flatten().any(|contact| contact.duration > 0.0);
    let alone = records.is_pushed_at_faces_only() && !records.is_twisted() && !records.broken;
    (touched && alone && free(0) && free(1)).then_some(Motion { before: body.before, after: body.at_end })
}

fn bodies(records: &Records<'_>) -> Vec<Body> {
    let segments = &records.bar.segments;
    let last = segments.len() - 1;
    let opens = |k: usize| segments[k].joint != Joint::Bonded;
    let mut bodies = Vec::new();
    let (mut start, mut sums) = (Face::End(0), [0.0; 3]);
    for (k, segment) in segments.iter().enumerate() {
        let SegmentEnd { mass, momentum, .. } = records.segments[k];
        let parts = [mass, mass * segment.velocity, momentum];
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
        if k == last || opens(k) {
            let face = if k == last { Face::End(1) } else { Face::Joint(k) };
            bodies.push(Body { faces: [start, face], before: sums[1] / sums[0], at_end: sums[2] / sums[0] });
            (start, sums) = (face, [0.0; 3]);
        }
    }
    bodies
}

impl Records<'_> {
    fn area(&self, area: f64) -> Option<f64> {
        (self.bar.area_given && !self.is_twisted()).then_some(area)
    }

    fn torque_per_stress(&self, segment: usize) -> Option<f64> {
        self.twisted.as_ref().map(|twisted| twisted.torque_per_stress[segment])
    }

    /// Returns the radius of the surface of a bar in torsion, m.
    pub(super) fn radius(&self) -> Option<f64> {
        self.twisted.as_ref().map(|twisted| twisted.radius)
    }

    /// Returns true if the stresses are those of the surface of a bar in torsion.
    pub(super) fn is_twisted(&self) -> bool {
        self.twisted.is_some()
    }

    /// Returns true if no distributed forces act along the bar, up to rounding.
    fn is_pushed_at_faces_only(&self) -> bool {
        self.account.impulse_along.abs() <= 1e-9 * self.account.momentum_scale
    }

    /// Returns the contact of a joint that can open in the scene, if the solver records the force on its faces.
    fn pressed(&self, k: usize) -> Option<ContactReading> {
        self.faces(k).filter(|_| self.bar.segments[k].joint != Joint::Bonded)
    }

    /// Returns the contact of a joint that can open or has fractured, if the solver records the force on its faces.
    fn faces(&self, k: usize) -> Option<ContactReading> {
        self.contacts.iter().copied().find(|contact| contact.joint == k)
    }

    /// Returns the motion that a far end imposes on a body: rest if the end is fixed; if it is absorbing, the initial
    /// velocity of the bar there, which the body keeps.
    fn held_beyond(&self, body: &Body, face: Face) -> Option<Motion> {
        let other = if body.faces[0] == face { body.faces[1] } else { body.faces[0] };
        let Face::End(side) = other else { return None };
        match self.ends[side] {
            EndCondition::Fixed => Some(AT_REST),
            EndCondition::Absorbing => {
                let start = self.bar.end_velocities()[side];
                Some(Motion { before: start, after: start })
            }
            _ => None,
        }
    }
}

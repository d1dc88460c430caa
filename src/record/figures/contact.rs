//! Results at ends and joints: forces, contact, and rebound velocities.
//!
//! A body is a part of the bar between joints that can open. Its velocity after contact is its momentum over its mass at the end of the run.
//! This is the velocity since its last contact if no force acts on it any more: both its faces are free by then, and nothing acts along it.

use super::records::{Records, SegmentEnd};
use super::tally::Load;
use crate::bar::{EndCondition, Joint, Segment};
use crate::record::ContactReading;

/// Of all momentum that has gone through the bar.
const ROUNDING: f64 = 1e-12;

/// Time in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ContactTime {
    /// s.
    pub duration: f64,
    /// s; none while the contact lasts, and where there was none.
    pub released: Option<f64>,
}

/// An end or a joint.
#[derive(Debug)]
pub(super) struct Site {
    pub load: Load,
    /// m^2; none where the scene gives none, and in torsion.
    pub area: Option<f64>,
    /// Torque over stress at the surface, m^3; none in axial bars.
    pub torque_per_stress: Option<f64>,
    /// Radius of the surface, m; none in axial bars.
    pub radius: Option<f64>,
    /// N s in +x (in torsion that of the surface), on what is right of the joint, or on the bar; none where it is not known.
    pub impulse: Option<f64>,
    /// None where nothing can part.
    pub contact: Option<ContactTime>,
    pub restitution: Option<f64>,
    /// m/s.
    pub striker_after: Option<f64>,
    /// Of the bodies on the left and on the right, m/s.
    pub bodies_after: [Option<f64>; 2],
}

/// Mean velocities before the first and after the last contact, m/s.
#[derive(Debug, Clone, Copy)]
struct Motion {
    before: f64,
    after: f64,
}

const AT_REST: Motion = Motion { before: 0.0, after: 0.0 };

/// A face of a body: an end (0, 1), or a joint that can open.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Face {
    End(usize),
    Joint(usize),
}

/// A part of the bar between joints that can open, with its faces.
struct Body {
    faces: [Face; 2],
    before: f64,
    at_end: f64,
}

/// Both ends, and the joints from left to right.
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
        // The force between the faces themselves, N.
        load.peak.largest.value = 0.0 - pressed.peak;
        load.peak.largest.at = pressed.time_of_peak;
        area = 1.0;
    } else {
        // A front that breaks the joint leaves no stress of the joint behind.
        let broken = records.breaks[k];
        load.peak.largest.add(broken.at, broken.value / area);
        if let Some(ContactReading { pressed, .. }) = records.faces(k) {
            // Its times count from the break on.
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

/// Impulse across the joint behind segment k on what is right of it, by the balance of momentum of what is left of it.
fn impulse_across(records: &Records<'_>, k: usize) -> Option<f64> {
    let gained = |(end, segment): (&SegmentEnd, &Segment)| end.momentum - end.mass * segment.velocity;
    let gained: f64 = records.segments.iter().zip(&records.bar.segments).take(k + 1).map(gained).sum();
    let across = records.account.impulse[0] - gained;
    // What is left of parts that cancel is rounding.
    let held: f64 = records.segments.iter().map(|end| end.momentum.abs()).sum();
    let rounding = ROUNDING * records.account.momentum_scale.max(held);
    records.is_pushed_at_faces_only().then_some(if across.abs() > rounding { across } else { 0.0 })
}

/// Relative velocity of separation over that of approach of the bodies on the left and on the right.
fn restitution([left, right]: [Option<Motion>; 2]) -> Option<f64> {
    let (left, right) = (left?, right?);
    let approach = left.before - right.before;
    (approach > 0.0).then(|| (right.after - left.after) / approach)
}

/// The wall, striker or ball at an end; none where its motion is not known or its contact lasts.
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

/// Time in contact at a face; none where nothing can part.
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

/// No other face of a body has carried force, but for a support.
fn touches_only(records: &Records<'_>, body: &Body, face: Face) -> bool {
    let other = if body.faces[0] == face { body.faces[1] } else { body.faces[0] };
    records.held_beyond(body, face).is_some()
        || contact(records, other).map_or_else(|| is_free(records, other), |contact| contact.duration == 0.0)
}

/// Nothing is there.
fn is_free(records: &Records<'_>, face: Face) -> bool {
    matches!(face, Face::End(side) if matches!(records.ends[side], EndCondition::Free))
}

/// The motion of a body which nothing touches at the end of the run.
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

    /// Of the surface of a bar in torsion, m.
    pub(super) fn radius(&self) -> Option<f64> {
        self.twisted.as_ref().map(|twisted| twisted.radius)
    }

    /// Stresses are those of the surface.
    pub(super) fn is_twisted(&self) -> bool {
        self.twisted.is_some()
    }

    /// Nothing acts along the bar, but for rounding.
    fn is_pushed_at_faces_only(&self) -> bool {
        self.account.impulse_along.abs() <= 1e-9 * self.account.momentum_scale
    }

    /// A joint that the scene lets open, where the solver keeps what its faces carried.
    fn pressed(&self, k: usize) -> Option<ContactReading> {
        self.faces(k).filter(|_| self.bar.segments[k].joint != Joint::Bonded)
    }

    /// A joint that can open or has broken, where the solver keeps what its faces carried.
    fn faces(&self, k: usize) -> Option<ContactReading> {
        self.contacts.iter().copied().find(|contact| contact.joint == k)
    }

    /// A body with a fixed far face counts as a body at rest, one with an absorbing far face keeps the velocity with which it starts there.
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

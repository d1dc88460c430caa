//! Reading of a front-tracking bar: its pieces, its fronts, and the state at a position.

use super::FrontTracking;
use super::end::{EndRecord, StrikerState};
use super::joint_clock::JointChange;
use super::list::Kind;
use crate::material::Heating;
use crate::wave::riemann::{Medium, Point};

/// A constant piece of the solution.
#[derive(Debug, Clone, Copy)]
pub struct Piece<'a> {
    /// Left edge now, m.
    pub from: f64,
    /// Right edge now, m.
    pub to: f64,
    /// Index of its segment.
    pub segment: usize,
    /// Its state.
    pub point: &'a Point,
}

/// A running front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Front {
    /// Place now, m.
    pub x: f64,
    /// m/s, positive in +x.
    pub speed: f64,
    /// Index of the segment in which it runs.
    pub segment: usize,
    /// State ahead of it.
    pub ahead: Point,
    /// State behind it.
    pub behind: Point,
}

/// The bar at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Pa.
    pub stress: f64,
    /// Engineering strain.
    pub strain: f64,
    /// m/s.
    pub velocity: f64,
    /// Signed plastic strain.
    pub plastic_strain: f64,
}

impl FrontTracking {
    /// Time, s.
    pub fn time(&self) -> f64 {
        self.now
    }

    /// Events so far: interactions, and steps of the ends.
    pub fn events(&self) -> u64 {
        self.events
    }

    /// The stress to which tolerances are relative, Pa: the largest imposed or initial one, or the one at which the largest
    /// difference of the velocities imposed and initial meets the unstressed bar.
    /// Merging is relative to less once an end has broken off with what it was still to impose.
    pub fn stress_scale(&self) -> f64 {
        self.stress_scale
    }

    /// Number of segments.
    pub fn segments(&self) -> usize {
        self.media.len()
    }

    /// Material and section of a segment.
    pub fn medium(&self, segment: usize) -> &Medium {
        &self.media[segment]
    }

    /// What heats a segment, if anything does.
    pub fn heating(&self, segment: usize) -> Option<&Heating> {
        self.materials[segment].heating.as_deref()
    }

    /// Temperature of a state, K, from its plastic work; not a number without the effect of heat.
    pub fn temperature(&self, segment: usize, point: &Point) -> f64 {
        self.heating(segment).map_or(f64::NAN, |heating| heating.temperature_after(point.work))
    }

    /// What happened at the left and the right end.
    pub fn ends(&self) -> [&EndRecord; 2] {
        [&self.ends[0].record, &self.ends[1].record]
    }

    /// The striker or ball at an end (0 left, 1 right), if there is one, now.
    pub fn striker(&self, which: usize) -> Option<StrikerState> {
        self.ends[which].striker(self.now)
    }

    /// When the striker or ball at an end (0 left, 1 right) touched the bar and parted from it, in order; empty without one.
    ///
    /// A contact that dies away ends where the force, followed through the middles of the last steps, is zero; in the end's
    /// record the stress is zero from the next arrival of a wave on.
    pub fn striker_changes(&self, which: usize) -> &[JointChange] {
        self.ends[which].striker_changes()
    }

    /// Energy of the bodies at the left and the right end now, J: of motion for a striker, stored for a spring, both for a ball, 0
    /// else. It is what the body had at the start less the work done on the bar.
    pub fn body_energy(&self) -> [f64; 2] {
        self.ends.each_ref().map(|end| end.body_energy(self.now))
    }

    /// The constant pieces from left to right, empty ones left out.
    pub fn pieces(&self) -> impl Iterator<Item = Piece<'_>> {
        let right = self.list.iter().skip(1);
        self.list.iter().zip(right).filter_map(|(a, b)| {
            let (from, to) = (a.at(self.now), b.at(self.now));
            (to > from).then_some(Piece { from, to, segment: a.segment as usize, point: &a.right })
        })
    }

    /// Mass of a piece, kg.
    pub fn mass_of(&self, piece: &Piece<'_>) -> f64 {
        let medium = self.medium(piece.segment);
        medium.density * medium.area * (piece.to - piece.from)
    }

    /// The running fronts from left to right.
    pub fn fronts(&self) -> impl Iterator<Item = Front> + '_ {
        self.list.iter().filter(|n| n.kind == Kind::Front).map(|n| {
            let (left, right) = (self.list.get(n.prev).right, n.right);
            let (ahead, behind) = if n.speed > 0.0 { (right, left) } else { (left, right) };
            Front { x: n.at(self.now), speed: n.speed, segment: n.segment as usize, ahead, behind }
        })
    }

    /// The bar at x in 0..=length, now. On a front: the state behind it; on a contact or joint: the right one.
    pub fn state_at(&self, x: f64) -> Sample {
        let mut found = self.list.get(0);
        for node in self.list.iter().skip(1).filter(|n| n.kind != Kind::End) {
            let place = node.at(self.now);
            if place > x || (place == x && node.speed > 0.0) {
                break;
            }
            found = node;
        }
        let (medium, point) = (self.medium(found.segment as usize), &found.right);
        Sample {
            stress: point.stress,
            strain: medium.strain(point),
            velocity: point.velocity,
            plastic_strain: medium.plastic_strain(point),
        }
    }
}

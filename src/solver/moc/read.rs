//! Readings of a front-tracking bar: its pieces, its fronts, and the state at a position.

use super::FrontTracking;
use super::end::{EndRecord, StrikerState};
use super::joint_clock::JointChange;
use super::list::Kind;
use crate::material::Heating;
use crate::wave::riemann::{Medium, Point};

/// A constant piece of the solution.
#[derive(Debug, Clone, Copy)]
pub struct Piece<'a> {
    /// Present left edge, m.
    pub from: f64,
    /// Present right edge, m.
    pub to: f64,
    /// Index of its segment.
    pub segment: usize,
    /// Its state.
    pub point: &'a Point,
}

/// An active front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Front {
    /// Present position, m.
    pub x: f64,
    /// Speed, m/s, positive in +x.
    pub speed: f64,
    /// Index of the segment in which it runs.
    pub segment: usize,
    /// State ahead of it.
    pub ahead: Point,
    /// State behind it.
    pub behind: Point,
}

/// State of the bar at a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Stress, Pa, tension positive.
    pub stress: f64,
    /// Engineering strain.
    pub strain: f64,
    /// Velocity, m/s, positive in +x.
    pub velocity: f64,
    /// Signed plastic strain.
    pub plastic_strain: f64,
}

impl FrontTracking {
    /// Present time, s.
    pub fn time(&self) -> f64 {
        self.now
    }

    /// Number of events so far: interactions, and steps of the ends.
    pub fn events(&self) -> u64 {
        self.events
    }

    /// Stress to which tolerances are relative, Pa: the largest imposed or initial stress or, if larger, the stress that the largest difference
    /// between imposed and initial velocities causes in the unstressed bar. Merging uses a smaller value after an end has broken off together with
    /// the rest of its load.
    pub fn stress_scale(&self) -> f64 {
        self.stress_scale
    }

    /// Number of segments.
    pub fn segments(&self) -> usize {
        self.media.len()
    }

    /// Returns material and section of a segment.
    pub fn medium(&self, segment: usize) -> &Medium {
        &self.media[segment]
    }

    /// Returns the heating data of a segment; `None` without the effect of heat.
    pub fn heating(&self, segment: usize) -> Option<&Heating> {
        self.materials[segment].heating.as_deref()
    }

    /// Temperature of a state, K, from its plastic work; NaN without the effect of heat.
    pub fn temperature(&self, segment: usize, point: &Point) -> f64 {
        self.heating(segment).map_or(f64::NAN, |heating| heating.temperature_after(point.work))
    }

    /// Returns the records of the left and the right end.
    pub fn ends(&self) -> [&EndRecord; 2] {
        [&self.ends[0].record, &self.ends[1].record]
    }

    /// Returns the present state of the striker or ball at an end (0 left, 1 right); `None` without one.
    pub fn striker(&self, which: usize) -> Option<StrikerState> {
        self.ends[which].striker(self.now)
    }

    /// Returns the times at which the striker or ball at an end (0 left, 1 right) touched the bar and separated from it, in order; empty without one.
    ///
    /// A decaying contact ends where the force, interpolated between the middles of the last steps, is zero; in the end's record, the stress is zero
    /// from the next arrival of a wave on.
    pub fn striker_changes(&self, which: usize) -> &[JointChange] {
        self.ends[which].striker_changes()
    }

    /// Present energy of the bodies at the left and the right end, J: kinetic for a striker, stored for a spring, both for a ball, otherwise 0. It
    /// equals the energy of the body at the start minus the work done on the bar.
    pub fn body_energy(&self) -> [f64; 2] {
        self.ends.each_ref().map(|end| end.body_energy(self.now))
    }

    /// Iterates over the constant pieces from left to right, without empty ones.
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

    /// Iterates over the active fronts from left to right.
    pub fn fronts(&self) -> impl Iterator<Item = Front> + '_ {
        self.list.iter().filter(|n| n.kind == Kind::Front).map(|n| {
            let (left, right) = (self.list.get(n.prev).right, n.right);
            let (ahead, behind) = if n.speed > 0.0 { (right, left) } else { (left, right) };
            Front { x: n.at(self.now), speed: n.speed, segment: n.segment as usize, ahead, behind }
        })
    }

    /// Returns the present state of the bar at x in 0..=length. On a front, the state behind it; at a contact or joint, the state to its right.
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

//! Joints that carry no tension, on the staggered grid: the node at the joint is split in two faces, each with half a
//! cell's mass.
//!
//! A step takes the faces on as free ones. Where the right one would end up to the left of the left one, a push between
//! them takes both to one place at the end of the step; they never pull each other, and press and part as an end and a wall do, see
//! [`super::device`]. Momentum is exchanged exactly. Faces that meet lose the energy of their relative motion, which is of the first
//! order in the cell size, and get it back where a wave parts them.

use serde::{Deserialize, Serialize};

use super::device::Impulses;
use crate::bar::{Bar, Joint};

/// One face: half a cell's mass at the end of a segment.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Face {
    /// Velocity half a step before and after the current time, m/s.
    pub before: f64,
    pub after: f64,
    /// kg.
    pub mass: f64,
    /// Of its cell, m^2.
    pub area: f64,
}

impl Face {
    fn advance(&mut self, impulse: f64) {
        self.before = self.after;
        self.after += impulse / self.mass;
    }
}

/// A joint that can open.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Contact {
    /// The edge between blocks in whose place it stands, and the segment to its left.
    pub edge: usize,
    pub segment: usize,
    /// The cell to its right.
    pub cell: usize,
    pub left: Face,
    pub right: Face,
    start: f64,
    /// Distance of the faces at the current time and a step ahead of it, m: as far as the velocities take them.
    gap_now: f64,
    gap: f64,
    /// Force between the faces, N, tensile only in the step in which they break.
    force: f64,
    /// Their pressure on each other over the steps ahead.
    impulses: Impulses,
    /// Lost by faces that met, J.
    pub lost: f64,
}

/// A joint that can open, as it is at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// Behind segment `joint`, counted from 0; inside it where the bar broke there.
    pub joint: usize,
    /// The cell to its right.
    pub cell: usize,
    /// Force between the faces, N, <= 0.
    pub force: f64,
    /// Distance of the faces, m, >= 0.
    pub gap: f64,
}

impl Contact {
    /// At the joint behind `segment`, in place of `edge`, with `cell` to its right; `masses` (kg) are half of those of the cells
    /// beside it, `areas` (m^2) their sections.
    pub fn new(bar: &Bar, [segment, edge, cell]: [usize; 3], masses: [f64; 2], areas: [f64; 2]) -> Option<Self> {
        let Joint::Contact { gap } = bar.segments[segment].joint else { return None };
        let face = |k: usize| {
            let velocity = bar.segments[segment + k].velocity;
            Face { before: velocity, after: velocity, mass: masses[k], area: areas[k] }
        };
        Some(Self {
            edge,
            segment,
            cell,
            left: face(0),
            right: face(1),
            start: gap,
            gap_now: gap,
            gap,
            force: 0.0,
            impulses: Impulses::default(),
            lost: 0.0,
        })
    }

    /// Where the bar breaks: in place of `edge`, with `cell` and its segment's left neighbour beside it. Both faces, with
    /// these masses (kg) and areas (m^2), have the velocity of the node that was there half a step before the current time.
    pub fn broken([edge, segment, cell]: [usize; 3], velocity: f64, masses: [f64; 2], areas: [f64; 2]) -> Self {
        let face = |k: usize| Face { before: velocity, after: velocity, mass: masses[k], area: areas[k] };
        Self {
            edge,
            segment,
            cell,
            left: face(0),
            right: face(1),
            start: 0.0,
            gap_now: 0.0,
            gap: 0.0,
            force: 0.0,
            impulses: Impulses::default(),
            lost: 0.0,
        }
    }

    /// The faces have met half of the initial stresses beside them, `half` (Pa): see [`super::device::Device::start_under`].
    pub(super) fn start_under(&mut self, half: [f64; 2], dt: f64) {
        self.left.before += dt * self.left.area * half[0] / self.left.mass;
        self.right.before -= dt * self.right.area * half[1] / self.right.mass;
    }

    /// The step in which the bar breaks: the tension holds for its first half. Each face then leaves with the velocity of the
    /// wave that frees it; without that half every second node would run ahead, and the pieces would ring from cell to cell,
    /// ever louder.
    pub fn part(&mut self, sigma: [f64; 2], dt: f64) {
        let [left, right] = [-self.left.area * sigma[0], self.right.area * sigma[1]];
        self.force = (0.25 * (right - left)).max(0.0);
        self.left.advance(dt * (left + self.force));
        self.right.advance(dt * (right - self.force));
        self.gap = (dt * (self.right.after - self.left.after)).max(0.0);
    }

    /// Takes the faces from half a step before the current time to half a step after it; `sigma` are the stresses in
    /// the cells to their left and right.
    pub fn advance(&mut self, sigma: [f64; 2], dt: f64) {
        let [left, right] = [-self.left.area * sigma[0], self.right.area * sigma[1]];
        let apart = (self.right.after + dt * right / self.right.mass) - (self.left.after + dt * left / self.left.mass);
        let softness = dt * (1.0 / self.left.mass + 1.0 / self.right.mass);
        let needed = (self.gap / dt + apart) / softness;
        let [slow_left, slow_right] = [&self.left, &self.right].map(|face| 1.0 / face.mass);
        let cells = (left * slow_left - right * slow_right) / (slow_left + slow_right);
        let passed_on = self.impulses.passed_on(cells, true);
        let ahead = (-2.0 * needed - passed_on).max(0.0);
        self.impulses.push(ahead, cells, true);
        let force = if ahead > 0.0 { needed } else { -0.5 * passed_on };
        let opening = self.right.after - self.left.after;
        self.lost += 0.5 * dt * (self.force + force) * opening;
        self.force = force;
        self.left.advance(dt * (left + force));
        self.right.advance(dt * (right - force));
        self.gap_now = self.gap;
        self.gap = if ahead > 0.0 { 0.0 } else { (self.gap + dt * (self.right.after - self.left.after)).max(0.0) };
    }

    /// Velocity of the left (0) or right (1) face at the current time, m/s.
    pub fn velocity(&self, side: usize) -> f64 {
        let face = [&self.left, &self.right][side];
        0.5 * (face.before + face.after)
    }

    /// Displacement of the right face against the left one at the current time, m.
    pub fn jump(&self) -> f64 {
        self.gap_now - self.start
    }

    /// As it is at the current time.
    pub fn state(&self) -> ContactState {
        ContactState { joint: self.segment, cell: self.cell, force: self.force, gap: self.gap_now }
    }
}

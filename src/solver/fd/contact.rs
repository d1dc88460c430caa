//! Joints that can open, see [`crate::bar::joint`], on the staggered grid: the node at the joint is split in two [`HalfNode`]s.
//!
//! The force over a step acts on both in halves, as at an end. Faces that meet lose the energy of their relative motion, and get it back
//! where a wave parts them.

use serde::{Deserialize, Serialize};

use super::grid_filter;
use super::half_node::{HalfNode, Impulses};
use crate::bar::SuddenLoad;
use crate::bar::ends::Response;
use crate::bar::joint::{self, force_at, free_rate};

/// Into the bar on the left and on the right of a joint, as a sign in x.
const INWARD: [f64; 2] = [-1.0, 1.0];

/// A joint that can open.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Contact {
    /// The edge between blocks in whose place it stands, and the segment to its left.
    pub edge: usize,
    pub segment: usize,
    /// The cell to its right.
    pub cell: usize,
    sides: [HalfNode; 2],
    /// Both half nodes are the characteristics of their bars where these are elastic.
    are_characteristics: bool,
    /// Cells beside it have flowed.
    have_flowed: bool,
    /// At the current time and a step ahead of it.
    now: joint::Contact,
    ahead: joint::Contact,
    /// Force between the faces, N, compression positive: less than 0 only in the step in which they break.
    force: f64,
    /// Their force on each other over the steps ahead.
    impulses: Impulses,
    /// Force up to which both bars are elastic, N.
    limit: f64,
    /// Taken by the grid filter, J.
    damped: f64,
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
    /// What they carried, up to the end of the step ahead.
    pub pressed: joint::Pressed,
    /// A force passes in that step.
    pub presses: bool,
}

impl Contact {
    /// Behind `segment`, in place of `edge`, with `cell` to its right. The faces move with `velocities` (m/s); `masses` (kg) are those
    /// of the cells beside it, `areas` (m^2) their sections, `impedances` (N s/m) those of elastic bars there.
    pub fn new(
        [edge, segment, cell]: [usize; 3],
        contact: joint::Contact,
        velocities: [f64; 2],
        [masses, areas, impedances]: [[f64; 2]; 3],
        yield_stresses: [f64; 2],
        dt: f64,
    ) -> Self {
        let side = |k: usize| HalfNode::new(INWARD[k] * velocities[k], 0.5 * masses[k], areas[k], dt);
        Self {
            edge,
            segment,
            cell,
            sides: [side(0), side(1)],
            are_characteristics: [0, 1].iter().all(|&k| side(k).is_characteristic(impedances[k])),
            have_flowed: false,
            now: contact,
            ahead: contact,
            force: 0.0,
            impulses: Impulses::default(),
            limit: (areas[0] * yield_stresses[0]).min(areas[1] * yield_stresses[1]),
            damped: 0.0,
        }
    }

    /// The faces are suddenly loaded like this at t = 0; see [`joint::Contact::load`].
    pub fn load(&mut self, load: SuddenLoad, force: f64) {
        self.ahead.load(load, force);
    }

    /// See [`HalfNode::start_under`].
    pub fn start_under(&mut self, half: [f64; 2]) {
        self.sides.iter_mut().zip(half).for_each(|(side, half)| side.start_under(half));
    }

    /// Forces of the cells beside it, N, compression positive.
    fn cells(&self, sigma: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| -self.sides[k].area * sigma[k])
    }

    /// The step in which the bar breaks: the tension holds for its first half. Each face then leaves with the velocity of the
    /// wave that frees it; without that half every second node would run ahead, and the pieces would ring from cell to cell,
    /// ever louder.
    pub fn part(&mut self, sigma: [f64; 2], dt: f64) {
        let cells = self.cells(sigma);
        self.force = (0.25 * (cells[0] + cells[1])).min(0.0);
        self.move_on(cells);
        self.ahead.widen(dt, self.opening_rate());
    }

    /// Takes the faces from half a step before the current time to half a step after it; `sigma` are the stresses in
    /// the cells to their left and right, some of which `flow`.
    pub fn advance(&mut self, sigma: [f64; 2], flows: bool, dt: f64) {
        let cells = self.cells(sigma);
        let held = [0, 1].map(|k| Response { force: cells[k], impedance: self.sides[k].impedance });
        let mean = force_at(0.0, &held);
        let bounded = flows || !self.are_characteristics;
        let choice = self.impulses.choose(mean, bounded);
        let passed_on = self.impulses.passed_on(mean, choice);
        let bars = [0, 1].map(|k| self.sides[k].response(cells[k], passed_on));
        self.now = self.ahead;
        let closer = -dt * self.opening_rate();
        let force = force_at(self.ahead.closing_rate(dt), &bars);
        let touches = self.ahead.advance(dt, force, free_rate(&bars));
        let force = if touches { force } else { 0.0 };
        self.have_flowed |= flows;
        if self.have_flowed || !self.are_characteristics {
            self.impulses.push(force, mean, choice);
        } else {
            self.impulses.take(force, mean);
        }
        let before = std::mem::replace(&mut self.force, 0.5 * (force + passed_on));
        self.ahead.lose(0.5 * (before + self.force), closer);
        // What stops half a cell, more than its bar can carry, is not what the faces carry.
        let stops = touches && (self.force - mean).abs() > self.limit;
        // Where a bar yields, the force first is that of elastic ones; both cells together have less.
        let most = if flows || self.force > self.limit { cells[0].min(cells[1]) } else { f64::INFINITY };
        self.ahead.note(dt, if stops { mean.max(0.0) } else { self.force }, most);
        self.move_on(cells);
    }

    /// Changes the velocities of the left and the right face before and after the current time (m/s, in +x). Returns the energy that this takes, J.
    pub fn impose(&mut self, changes: [f64; 2], dt: f64) -> f64 {
        let mut taken = 0.0;
        for side in [0, 1] {
            let mass = self.mass(side, dt);
            let (node, change) = (&mut self.sides[side], INWARD[side] * changes[side]);
            let velocity_increment = node.after - node.before;
            node.before += change;
            taken -= 0.5 * mass * grid_filter::node(velocity_increment, change, &mut node.after);
        }
        if changes[0] != changes[1] {
            self.ahead.widen(dt, changes[1] - changes[0]);
        }
        taken
    }

    /// Takes on what the grid filter hands over in the cells on both sides, each as a velocity (m/s) of its own mass: faces that touch move
    /// together.
    pub fn damp(&mut self, [left, right]: [f64; 2], dt: f64) {
        let mut changes = [-2.0 * left, 2.0 * right];
        if !self.ahead.is_open() {
            let masses = [0, 1].map(|side| self.mass(side, dt));
            changes = [(masses[0] * changes[0] + masses[1] * changes[1]) / (masses[0] + masses[1]); 2];
        }
        self.damped -= self.impose(changes, dt);
    }

    /// Energy that the grid filter took from the faces, J.
    pub fn damped(&self) -> f64 {
        self.damped
    }

    fn move_on(&mut self, cells: [f64; 2]) {
        for (side, cell) in self.sides.iter_mut().zip(cells) {
            side.move_on(side.pushed(self.force, cell));
        }
    }

    /// Rate at which the gap grows half a step after the current time, m/s.
    fn opening_rate(&self) -> f64 {
        self.sides[0].after + self.sides[1].after
    }

    /// Velocities of the left (0) or right (1) face half a step before and after the current time, m/s.
    pub fn velocities(&self, side: usize) -> [f64; 2] {
        let HalfNode { before, after, .. } = self.sides[side];
        [INWARD[side] * before, INWARD[side] * after]
    }

    /// Velocity of a face at the current time, m/s.
    pub fn velocity(&self, side: usize) -> f64 {
        let [before, after] = self.velocities(side);
        0.5 * (before + after)
    }

    /// Mass of the left (0) or right (1) half node, kg.
    pub fn mass(&self, side: usize, dt: f64) -> f64 {
        self.sides[side].impedance * dt
    }

    /// Displacement of the right face against the left one at the current time, m.
    pub fn jump(&self) -> f64 {
        self.now.jump()
    }

    /// Lost by faces that met, J.
    pub fn lost(&self) -> f64 {
        self.ahead.lost()
    }

    /// As it is at the current time.
    pub fn state(&self) -> ContactState {
        ContactState {
            joint: self.segment,
            cell: self.cell,
            force: -self.force,
            gap: self.now.gap(),
            pressed: self.ahead.pressed(),
            presses: self.ahead.presses(),
        }
    }
}

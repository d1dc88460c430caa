//! Joints that can open, see [`crate::bar::joint`], on the staggered grid: the node at the joint is split into two [`HalfNode`]s.
//!
//! The force over a step acts on both in halves, as at an end. Faces that meet lose the energy of their relative motion, and regain it when
//! a wave separates them.

use serde::{Deserialize, Serialize};

use super::grid_filter;
use super::half_node::{HalfNode, Impulses};
use crate::bar::SuddenLoad;
use crate::bar::ends::Response;
use crate::bar::joint::{self, force_at, free_rate};

/// Direction into the bar on the left and on the right of a joint, as a sign in x.
const INWARD: [f64; 2] = [-1.0, 1.0];

/// A joint that can open.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Contact {
    /// Edge between blocks that the joint replaces, and segment to its left.
    pub edge: usize,
    pub segment: usize,
    /// Cell to its right.
    pub cell: usize,
    sides: [HalfNode; 2],
    /// Whether both half nodes are the characteristics of their bars where these are elastic.
    are_characteristics: bool,
    /// Whether cells beside the joint have flowed.
    have_flowed: bool,
    /// Contact state at the current time and one step ahead.
    now: joint::Contact,
    ahead: joint::Contact,
    /// Force between the faces, N, compression positive; negative only in the step in which the bar fractures.
    force: f64,
    /// Forces between the faces over the latest steps.
    impulses: Impulses,
    /// Largest force for which both bars are elastic, N.
    limit: f64,
    /// Energy taken by the grid filter, J.
    damped: f64,
}

/// State of a joint that can open, at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// Segment to the left of the joint, counted from 0; if the bar fractured inside a segment, that segment.
    pub joint: usize,
    /// Cell to the right of the joint.
    pub cell: usize,
    /// Force between the faces, N, tension positive; > 0 only in the step in which the bar fractures.
    pub force: f64,
    /// Distance between the faces, m, >= 0.
    pub gap: f64,
    /// Peak force and duration of the contact, up to the end of the step ahead.
    pub pressed: joint::Pressed,
    /// Whether the faces press on each other in that step.
    pub presses: bool,
}

impl Contact {
    /// Creates the joint behind `segment`, in place of `edge`, with `cell` to its right. The faces move with `velocities` (m/s). `masses`
    /// (kg) and `areas` (m^2) are the masses and sections of the cells beside it, `impedances` (N s/m) the elastic impedances there.
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

    /// Loads the faces suddenly at t = 0; see [`joint::Contact::load`].
    pub fn load(&mut self, load: SuddenLoad, force: f64) {
        self.ahead.load(load, force);
    }

    /// Starts the faces under initial stresses, see [`HalfNode::start_under`].
    pub fn start_under(&mut self, half: [f64; 2]) {
        self.sides.iter_mut().zip(half).for_each(|(side, half)| side.start_under(half));
    }

    /// Returns the forces of the cells beside the joint, N, compression positive.
    fn cells(&self, sigma: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| -self.sides[k].area * sigma[k])
    }

    /// Advances the step in which the bar fractures: the tension acts for its first half. Each face then leaves with the velocity of the
    /// release wave. Without that half step, every second node would run ahead, and the pieces would oscillate from cell to cell with
    /// growing amplitude.
    pub fn part(&mut self, sigma: [f64; 2], dt: f64) {
        let cells = self.cells(sigma);
        self.force = (0.25 * (cells[0] + cells[1])).min(0.0);
        self.advance_nodes(cells);
        self.ahead.widen(dt, self.opening_rate());
    }

    /// Advances the faces from half a step before the current time to half a step after it; `sigma` are the stresses of the cells to their
    /// left and right, Pa, and `flows` tells whether cells there have flowed in the latest steps.
    pub fn advance(&mut self, sigma: [f64; 2], flows: bool, dt: f64) {
        let cells = self.cells(sigma);
        let held = [0, 1].map(|k| Response { force: cells[k], impedance: self.sides[k].impedance });
        let mean = force_at(0.0, &held);
        let bounded = flows || !self.are_characteristics;
        let choice = self.impulses.choose(mean, bounded);
        let previous_force = self.impulses.previous_force(mean, choice);
        let bars = [0, 1].map(|k| self.sides[k].response(cells[k], previous_force));
        self.now = self.ahead;
        let closer = -dt * self.opening_rate();
        let force = force_at(self.ahead.closing_rate(dt), &bars);
        let touches = self.ahead.advance(dt, force, free_rate(&bars));
        let force = if touches { force } else { 0.0 };
        self.have_flowed |= flows;
        if self.have_flowed || !self.are_characteristics {
            self.impulses.record_damped(force, mean, choice);
        } else {
            self.impulses.record(force, mean);
        }
        let before = std::mem::replace(&mut self.force, 0.5 * (force + previous_force));
        self.ahead.add_lost_energy(0.5 * (before + self.force), closer);
        // A force that stops half a cell, above what its bar can carry, is not recorded as the force of the faces.
        let stops = touches && (self.force - mean).abs() > self.limit;
        // If a bar yields, the force is at first that of elastic bars; the recorded peak is limited to the smaller of the two cells'
        // forces.
        let most = if flows || self.force > self.limit { cells[0].min(cells[1]) } else { f64::INFINITY };
        self.ahead.record_force(dt, if stops { mean.max(0.0) } else { self.force }, most);
        self.advance_nodes(cells);
    }

    /// Changes the velocities of the left and the right face before and after the current time (m/s, in +x). Returns the energy that this
    /// takes, J.
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

    /// Applies the velocity changes of the grid filter in the cells on both sides, each given as a velocity (m/s) of the cell's own mass;
    /// faces in contact move together.
    pub fn damp(&mut self, [left, right]: [f64; 2], dt: f64) {
        let mut changes = [-2.0 * left, 2.0 * right];
        if !self.ahead.is_open() {
            let masses = [0, 1].map(|side| self.mass(side, dt));
            changes = [(masses[0] * changes[0] + masses[1] * changes[1]) / (masses[0] + masses[1]); 2];
        }
        self.damped -= self.impose(changes, dt);
    }

    /// Returns the energy that the grid filter took from the faces, J.
    pub fn damped(&self) -> f64 {
        self.damped
    }

    fn advance_nodes(&mut self, cells: [f64; 2]) {
        for (side, cell) in self.sides.iter_mut().zip(cells) {
            side.advance(side.velocity_under_force(self.force, cell));
        }
    }

    /// Returns the rate at which the gap grows half a step after the current time, m/s.
    fn opening_rate(&self) -> f64 {
        self.sides[0].after + self.sides[1].after
    }

    /// Returns the velocities of the left (0) or right (1) face half a step before and after the current time, m/s.
    pub fn velocities(&self, side: usize) -> [f64; 2] {
        let HalfNode { before, after, .. } = self.sides[side];
        [INWARD[side] * before, INWARD[side] * after]
    }

    /// Returns the velocity of a face at the current time, m/s.
    pub fn velocity(&self, side: usize) -> f64 {
        let [before, after] = self.velocities(side);
        0.5 * (before + after)
    }

    /// Returns the mass of the left (0) or right (1) half node, kg.
    pub fn mass(&self, side: usize, dt: f64) -> f64 {
        self.sides[side].impedance * dt
    }

    /// Returns the displacement of the right face relative to the left one at the current time, m.
    pub fn jump(&self) -> f64 {
        self.now.jump()
    }

    /// Returns the energy lost by faces that met, J.
    pub fn lost(&self) -> f64 {
        self.ahead.lost()
    }

    /// Returns the state at the current time.
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

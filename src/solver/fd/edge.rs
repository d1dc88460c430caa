//! Nodes between blocks.

use serde::{Deserialize, Serialize};

use super::block::Block;
use super::contact::Contact;
use super::grid_filter;
use super::segment::{Constants, SegmentLaw};
use crate::bar::{Bar, joint};

/// Node between two blocks: inside a segment, or at a bonded joint. At a joint that can open, it is an empty placeholder without mass or
/// motion, and a [`super::contact::Contact`] takes its place.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Edge {
    /// Velocity half a step after the current time, m/s.
    pub after: f64,
    /// Velocity change by the stresses in the latest step, m/s.
    pub velocity_increment: f64,
    /// dt A/m of the cells on both sides, m/s per Pa.
    gain_left: f64,
    gain_right: f64,
    /// Mass of the node, kg.
    pub mass: f64,
    /// Masses of the cells on both sides, divided by the mass of the node.
    cells: [f64; 2],
    /// Energy that the grid filter took from the node, J.
    pub damped: f64,
    /// Whether the latest step left the velocity unchanged, as another step with the same stresses would.
    pub still: bool,
}

impl Edge {
    /// Placeholder for a node that a contact replaces.
    pub const EMPTY: Self = Self {
        after: 0.0,
        velocity_increment: 0.0,
        gain_left: 0.0,
        gain_right: 0.0,
        mass: 0.0,
        cells: [0.0; 2],
        damped: 0.0,
        still: false,
    };

    /// Replaces the node by an empty placeholder, where the bar fractures. The energy taken by damping is kept.
    pub fn part(&mut self) {
        *self = Self { damped: self.damped, ..Self::EMPTY };
    }

    /// Advances the node by a step, from the stresses (Pa) on both sides. Inside a segment the result has the same bits as that of a node
    /// inside a block, so that results do not depend on the block boundaries.
    pub fn advance(&mut self, sigma_left: f64, sigma_right: f64) {
        self.velocity_increment = if self.gain_left == self.gain_right {
            self.gain_left * (sigma_right - sigma_left)
        } else {
            self.gain_right * sigma_right - self.gain_left * sigma_left
        };
        let after = self.after + self.velocity_increment;
        self.still = after == self.after;
        self.after = after;
    }

    /// Applies the impulses of the grid filter in the cells on both sides, each given as a velocity (m/s) of the cell's own mass. Returns
    /// false if the velocity does not change.
    pub fn damp(&mut self, [left, right]: [f64; 2]) -> bool {
        let change = self.cells[1] * right - self.cells[0] * left;
        if change != 0.0 {
            self.still = false;
            self.damped += 0.5 * self.mass * grid_filter::node(self.velocity_increment, change, &mut self.after);
        }
        change != 0.0
    }

    /// Changes the velocities before and after the current time by `change` (m/s). Returns the energy that this takes, J.
    pub fn impose(&mut self, change: f64) -> f64 {
        self.still = false;
        -0.5 * self.mass * grid_filter::node(self.velocity_increment, change, &mut self.after)
    }

    /// Returns the velocity half a step before the current time, m/s: that after it without the change by the stresses in between.
    pub fn before(&self) -> f64 {
        self.after - self.velocity_increment
    }

    /// Returns the velocity at the time of the stresses, m/s.
    pub fn velocity(&self) -> f64 {
        self.after - 0.5 * self.velocity_increment
    }
}

/// Creates the nodes between blocks. At a joint of segments with different velocities, the node starts with the velocity of their common
/// momentum.
pub(super) fn edges(blocks: &[Block], constants: &[Constants]) -> Vec<Edge> {
    let edge = |pair: &[Block]| {
        let (left, right) = (&constants[pair[0].segment], &constants[pair[1].segment]);
        let [left_mass, right_mass] = cell_masses(pair, constants);
        let [left_velocity, right_velocity] = [last(&pair[0].v), pair[1].v[0]];
        let after = if left_velocity == right_velocity {
            left_velocity
        } else {
            (left_mass * left_velocity + right_mass * right_velocity) / (left_mass + right_mass)
        };
        let mass = 0.5 * (left_mass + right_mass);
        let (gain_left, gain_right) = if pair[0].segment == pair[1].segment && pair[0].taper.is_none() {
            (left.velocity_gain, left.velocity_gain)
        } else {
            // dt A/m, written with the segment's own gain dt/(rho dx) = dt A/(cell mass).
            (left.velocity_gain * left_mass / mass, right.velocity_gain * right_mass / mass)
        };
        Edge { after, gain_left, gain_right, mass, cells: [left_mass / mass, right_mass / mass], ..Edge::EMPTY }
    };
    blocks.windows(2).map(edge).collect()
}

/// Returns the areas of the cells on both sides of the node between two blocks, divided by the mean areas of their segments.
fn relative_areas(pair: &[Block]) -> [f64; 2] {
    [pair[0].area(pair[0].sigma.len() - 1), pair[1].area(0)]
}

/// Returns the masses of the cells on both sides of that node, kg.
fn cell_masses(pair: &[Block], constants: &[Constants]) -> [f64; 2] {
    let areas = relative_areas(pair);
    [0, 1].map(|k| constants[pair[k].segment].cell_mass * areas[k])
}

/// Returns the masses (kg), sections (m^2) and elastic impedances (N s/m) of the cells on both sides of that node.
pub(super) fn adjacent_cell_data(pair: &[Block], constants: &[Constants], dt: f64) -> [[f64; 2]; 3] {
    let (relative, masses) = (relative_areas(pair), cell_masses(pair, constants));
    let areas = [0, 1].map(|k| constants[pair[k].segment].area * relative[k]);
    [masses, areas, [0, 1].map(|k| masses[k] * constants[pair[k].segment].courant / dt)]
}

/// Creates the joints that can open; their edges become empty placeholders.
pub(super) fn contacts(
    bar: &Bar,
    dt: f64,
    blocks: &[Block],
    constants: &[Constants],
    laws: &[SegmentLaw],
    edges: &mut [Edge],
) -> Vec<Contact> {
    let mut contacts = Vec::new();
    for (k, pair) in blocks.windows(2).enumerate() {
        let segments = [pair[0].segment, pair[1].segment];
        if segments[0] == segments[1] {
            continue;
        }
        if let Some(contact) = joint::Contact::new(bar.segments[segments[0]].joint) {
            let velocities = [last(&pair[0].v), pair[1].v[0]];
            let place = [k, segments[0], pair[1].cells.start];
            edges[k] = Edge::EMPTY;
            let yields = segments.map(|k| laws[k].yield_stress);
            contacts.push(Contact::new(
                place,
                contact,
                velocities,
                adjacent_cell_data(pair, constants, dt),
                yields,
                dt,
            ));
        }
    }
    contacts
}

/// Returns the last value, which is the one beside the right edge if the values are those of a block.
pub(super) fn last(values: &[f64]) -> f64 {
    values[values.len() - 1]
}

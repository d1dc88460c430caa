//! Masses, dampers and springs of cells and nodes, in the form in which a step uses them.

use std::ops::Range;

use super::DistributedForces;
use crate::solver::fd::Grid;
use crate::solver::fd::segment::Constants;

/// Weights of a cell, by segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellWeights {
    /// A dt: impulse per stress, m^2 s.
    pub impulse: f64,
    /// dt c1 A/dx: impulse per velocity difference, kg.
    pub viscous: f64,
    /// rho nu^2 r^2 A/dx: mass of the lateral motion per velocity difference, kg.
    pub lateral: f64,
}

/// Weights of a node.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodeWeights {
    /// Mass, kg.
    pub mass: f64,
    /// dt c2 times the node's length: impulse per velocity, kg.
    pub drag: f64,
    /// Mass in addition to `mass` with which the drag's change within the step acts, kg: m (z/(1 - exp(-z)) - 1) with z = drag/m, half of
    /// `drag` if z is small. A node on which nothing else acts then slows down exactly.
    pub drag_mass: f64,
    /// k times the node's length, N/m.
    pub spring: f64,
    /// dt f times the node's length: largest impulse of friction, N s.
    pub friction: f64,
}

/// Weights of all cells and nodes of a bar.
#[derive(Debug, Clone, Default)]
pub(super) struct Weights {
    pub dt: f64,
    parts: Vec<Range<usize>>,
    /// One entry per segment.
    cells: Vec<CellWeights>,
    /// Nodes inside each segment.
    inner: Vec<NodeWeights>,
    /// Left end, joints, right end.
    joints: Vec<NodeWeights>,
}

impl Weights {
    /// Computes the weights. The fraction `share` of the dampers' forces acts in the step: 1/2 in the one around t = 0, before which there
    /// are none.
    pub fn new(along: &DistributedForces, grid: &Grid, constants: &[Constants], share: f64) -> Self {
        let dt = grid.dt;
        let cell = |k: usize| {
            let (c, dx) = (&constants[k], grid.segments[k].dx);
            CellWeights {
                impulse: dt * c.area,
                viscous: share * dt * along.internal * c.area / dx,
                lateral: c.cell_mass * along.lateral[k] / (dx * dx),
            }
        };
        let node = |sides: &[usize]| {
            let mass = sides.iter().map(|&k| 0.5 * constants[k].cell_mass).sum::<f64>();
            let length = sides.iter().map(|&k| 0.5 * grid.segments[k].dx).sum::<f64>();
            let drag = share * dt * along.external * length;
            let z = drag / mass;
            let drag_mass = if drag > 0.0 { mass * (z / -(-z).exp_m1() - 1.0) } else { 0.0 };
            let friction = dt * along.friction * length;
            NodeWeights { mass, drag, drag_mass, spring: along.foundation * length, friction }
        };
        let last = constants.len() - 1;
        let joint = |k: usize| match k {
            0 => node(&[0]),
            k if k > last => node(&[last]),
            k => node(&[k - 1, k]),
        };
        Self {
            dt,
            parts: grid.segments.iter().map(|part| part.cells.clone()).collect(),
            cells: (0..=last).map(cell).collect(),
            inner: (0..=last).map(|k| node(&[k, k])).collect(),
            joints: (0..=last + 1).map(joint).collect(),
        }
    }

    /// Returns the number of cells of the bar.
    pub fn count(&self) -> usize {
        self.parts[self.parts.len() - 1].end
    }

    /// Returns the segments with their cells.
    pub fn cells(&self) -> impl Iterator<Item = (&CellWeights, Range<usize>)> {
        self.cells.iter().zip(self.parts.iter().cloned())
    }

    /// Returns all nodes from left to right, in runs of equal ones.
    pub fn nodes(&self) -> impl Iterator<Item = (&NodeWeights, Range<usize>)> {
        let runs = self.parts.iter().enumerate().flat_map(|(k, part)| {
            [(&self.joints[k], part.start..part.start + 1), (&self.inner[k], part.start + 1..part.end)]
        });
        let n = self.count();
        runs.chain([(&self.joints[self.parts.len()], n..n + 1)])
    }

    /// Returns the weights of one cell.
    pub fn cell(&self, cell: usize) -> &CellWeights {
        &self.cells[self.parts.partition_point(|part| part.end <= cell)]
    }

    fn node(&self, node: usize) -> &NodeWeights {
        let k = self.parts.partition_point(|part| part.end < node);
        if node == 0 {
            &self.joints[0]
        } else if node == self.parts[k].end {
            &self.joints[k + 1]
        } else {
            &self.inner[k]
        }
    }

    /// Returns the mass of a node in the node update if it is not coupled to others, kg.
    pub fn mass_of(&self, w: &NodeWeights) -> f64 {
        w.mass + w.drag_mass + 0.25 * self.dt * self.dt * w.spring
    }

    /// Returns the largest impulse of friction on a node, N s.
    pub fn friction(&self, node: usize) -> f64 {
        self.node(node).friction
    }

    /// Returns the diagonal element of the matrix of the node update, kg.
    pub fn diagonal(&self, node: usize) -> f64 {
        let w = self.node(node);
        let left = if node > 0 { -self.between(node - 1) } else { 0.0 };
        let right = if node < self.count() { -self.between(node) } else { 0.0 };
        self.mass_of(w) + left + right
    }

    /// Returns the element of the matrix between the nodes of a cell, kg.
    pub fn between(&self, cell: usize) -> f64 {
        let w = self.cell(cell);
        -(w.lateral + 0.5 * w.viscous)
    }
}

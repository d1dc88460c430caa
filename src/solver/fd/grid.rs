//! The staggered grid of a bar: stresses in cells, velocities at the nodes between them.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::sharing::share_out;
use crate::bar::{Bar, Segment};

/// One segment's part of the grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SegmentGrid {
    /// Its cells, counted over the whole bar.
    pub cells: Range<usize>,
    /// Place of its left end, m.
    pub x0: f64,
    /// Cell size, m.
    pub dx: f64,
}

impl SegmentGrid {
    /// A cell, m from the segment's left end.
    pub fn cell(&self, cell: usize) -> [f64; 2] {
        let i = cell - self.cells.start;
        [self.dx * i as f64, self.dx * (i + 1) as f64]
    }

    /// The half cells on both sides of a node that are in the segment, m from its left end.
    pub fn beside(&self, node: usize) -> [f64; 2] {
        let (i, count) = ((node - self.cells.start) as f64, self.cells.len() as f64);
        [(i - 0.5).max(0.0), (i + 0.5).min(count)].map(|i| self.dx * i)
    }

    /// Velocity (m/s) of a node of a segment half a step after t = 0, without what initial stresses give it: that of its cells' common
    /// momentum. At Courant number 1 this is the elastic solution at that time, (v(x - c dt/2) + v(x + c dt/2))/2 of the cells' mean
    /// velocities v. What alternates from node to node vanishes; the grid would let it grow with every step.
    pub(super) fn initial_velocity(&self, segment: &Segment, node: usize) -> f64 {
        let (mut mass, mut momentum) = (0.0, 0.0);
        for cell in node.saturating_sub(1).max(self.cells.start)..=node.min(self.cells.end - 1) {
            let [from, to] = self.cell(cell);
            let area = segment.mean_area(from, to);
            mass += area;
            momentum += area * segment.velocity_between(from, to);
        }
        momentum / mass
    }
}

/// The grid of a bar. Cells are shared out so that the fastest wave takes as nearly as possible the same time
/// across each of them, whatever its material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// Segments from left to right.
    pub segments: Vec<SegmentGrid>,
    /// Time step, s.
    pub dt: f64,
}

impl Grid {
    /// Shares about `cells` cells out over the bar, see `sharing`; the time step is `cfl` times the shortest transit of a cell.
    pub fn new(bar: &Bar, cells: usize, cfl: f64) -> Self {
        let transits: Vec<f64> = bar.segments.iter().map(|segment| segment.length / segment.material.c0()).collect();
        let mut segments = Vec::with_capacity(bar.segments.len());
        let (mut first, mut x0, mut dt) = (0, 0.0, f64::INFINITY);
        for (segment, count) in bar.segments.iter().zip(share_out(&transits, cells)) {
            let dx = segment.length / count as f64;
            dt = dt.min(cfl * dx / segment.material.c0());
            segments.push(SegmentGrid { cells: first..first + count, x0, dx });
            first += count;
            x0 += segment.length;
        }
        Self { segments, dt }
    }

    /// Steps up to a time, s: to the first that reaches it, one at least.
    pub fn steps_to(&self, until: f64) -> usize {
        // Rounding in until/dt must not cost a whole extra step.
        ((until / self.dt - 1e-9).ceil() as usize).max(1)
    }

    /// Cells of the whole bar.
    pub fn cells(&self) -> usize {
        self.segments.last().map_or(0, |s| s.cells.end)
    }

    /// Cell centres, m.
    pub fn centres(&self) -> Vec<f64> {
        let centre = |s: &SegmentGrid, i: usize| s.x0 + ((i - s.cells.start) as f64 + 0.5) * s.dx;
        self.segments.iter().flat_map(|s| s.cells.clone().map(move |i| centre(s, i))).collect()
    }

    /// Place of a node, m; its number is that of the cell to its right.
    pub fn node(&self, node: usize) -> f64 {
        let k = self.segments.partition_point(|s| s.cells.end < node).min(self.segments.len() - 1);
        let segment = &self.segments[k];
        segment.x0 + (node - segment.cells.start) as f64 * segment.dx
    }

    /// The segment that holds place `x` (the left one at a joint).
    pub fn segment_at(&self, x: f64) -> usize {
        let after = self.segments.partition_point(|s| s.x0 < x);
        after.max(1) - 1
    }
}

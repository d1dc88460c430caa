//! Tapered segments: the cells of a block with varying section.
//!
//! The momentum equation is rho A dv/dt = d(A sigma)/dx. A cell has the exact mean area A over its length; each of its nodes
//! carries half of its mass. Between cells with the areas a and b a node of mass rho dx (a + b)/2 obeys
//! `dv = dt/(rho dx) 2 (b sigma_b - a sigma_a)/(a + b) = dt/(rho dx) ((sigma_b - sigma_a) + k (sigma_b + sigma_a))` with
//! k = (b - a)/(b + a): the uniform rule and a correction. Forces of cells are equal and opposite on their nodes, so that
//! momentum and energy are balanced to round-off, and Courant number 1 stays stable, since no element's frequency rises.

use std::ops::Range;

use multiversion::multiversion;
use serde::{Deserialize, Serialize};

use super::SegmentGrid;
use super::grid_filter;
use crate::bar::Segment;

/// Bytes that a cell of a tapered segment takes more than one of a uniform one.
pub const BYTES_PER_CELL: usize = 2 * size_of::<f64>();

/// The sections of a block's cells.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct BlockTaper {
    /// Area of each cell over the mean of the segment.
    pub area: Vec<f64>,
    /// k of each node inside the block: one fewer than cells.
    skew: Vec<f64>,
}

impl BlockTaper {
    /// Of these cells of a segment (counted over the whole bar); none where the segment is uniform.
    pub fn of(segment: &Segment, part: &SegmentGrid, cells: &Range<usize>) -> Option<Box<Self>> {
        segment.taper.as_ref()?;
        let from = |cell: usize| (cell - part.cells.start) as f64 * part.spacing;
        // The last border is the segment's end, whatever rounding makes of it.
        let to = |cell: usize| from(cell + 1).min(segment.length);
        let area = cells.clone().map(|cell| segment.mean_area(from(cell), to(cell)) / segment.area).collect();
        Some(Box::new(Self::from_areas(area)))
    }

    fn from_areas(area: Vec<f64>) -> Self {
        let skew = area.windows(2).map(|a| (a[1] - a[0]) / (a[1] + a[0])).collect();
        Self { area, skew }
    }

    /// Takes the cells from `at` on away.
    pub fn split_off(&mut self, at: usize) -> Self {
        let right = self.area.split_off(at);
        *self = Self::from_areas(std::mem::take(&mut self.area));
        Self::from_areas(right)
    }

    /// Velocity change of the node to the left of cell `i` (0 < i < cells) in a step.
    pub fn velocity_increment(&self, gain: f64, sigma: &[f64], i: usize) -> f64 {
        velocity_increment(gain, self.skew[i - 1], sigma[i - 1], sigma[i])
    }

    /// Mass of the node to the left of cell `i` (0 < i < cells) over the mean mass of a cell of the segment.
    pub fn node_mass(&self, i: usize) -> f64 {
        0.5 * (self.area[i - 1] + self.area[i])
    }

    /// Takes these nodes inside the block a step on.
    pub fn advance_velocity(&self, gain: f64, sigma: &[f64], v: &mut [f64], nodes: Range<usize>) {
        advance_velocity(gain, &self.skew, sigma, v, nodes);
    }

    /// As [`grid_filter::apply_impulses`], to these nodes inside the block: the impulse of a cell is its mass times `impulses`.
    /// The sum that is returned is weighted with the nodes' masses over the mean mass of a cell.
    pub fn apply_impulses(
        &self,
        gain: f64,
        sigma: &[f64],
        impulses: &[f64],
        v: &mut [f64],
        nodes: Range<usize>,
    ) -> f64 {
        let mut lost = 0.0;
        for i in nodes {
            let (left, right) = (impulses[i - 1], impulses[i]);
            let change = (right - left) + self.skew[i - 1] * (right + left);
            lost += self.node_mass(i) * grid_filter::node(self.velocity_increment(gain, sigma, i), change, &mut v[i]);
        }
        lost
    }
}

#[inline(always)]
fn velocity_increment(gain: f64, skew: f64, left: f64, right: f64) -> f64 {
    gain * ((right - left) + skew * (right + left))
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn advance_velocity(gain: f64, skew: &[f64], sigma: &[f64], v: &mut [f64], nodes: Range<usize>) {
    let (skew, sigma, v) = (&skew[nodes.start - 1..], &sigma[nodes.start - 1..], &mut v[nodes]);
    let nodes = v.len();
    let (left, right, skew) = (&sigma[..nodes], &sigma[1..=nodes], &skew[..nodes]);
    for i in 0..nodes {
        v[i] += velocity_increment(gain, skew[i], left[i], right[i]);
    }
}

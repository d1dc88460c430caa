//! Tapered segments: cells of a block with varying section.
//!
//! The momentum equation is rho A dv/dt = d(A sigma)/dx. A cell has the exact mean area A over its length; each of its nodes carries half
//! of its mass. Between cells with the areas a and b, a node of mass rho dx (a + b)/2 obeys
//! `dv = dt/(rho dx) 2 (b sigma_b - a sigma_a)/(a + b) = dt/(rho dx) ((sigma_b - sigma_a) + k (sigma_b + sigma_a))` with
//! k = (b - a)/(b + a): the rule of a uniform segment plus a correction. The forces of a cell on its nodes are equal and opposite, so that
//! momentum and energy are balanced to round-off. Courant number 1 remains stable, since no element's frequency rises.

use std::ops::Range;

use multiversion::multiversion;
use serde::{Deserialize, Serialize};

use super::SegmentGrid;
use super::grid_filter;
use crate::bar::Segment;

/// Additional memory per cell of a tapered segment, bytes.
pub const BYTES_PER_CELL: usize = 2 * size_of::<f64>();

/// Sections of a block's cells.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct BlockTaper {
    /// Area of each cell divided by the mean area of the segment.
    pub area: Vec<f64>,
    /// k of each node inside the block, one fewer than cells.
    skew: Vec<f64>,
}

impl BlockTaper {
    /// Computes the sections of these cells of a segment (counted over the whole bar). Returns `None` if the segment is uniform.
    pub fn of(segment: &Segment, part: &SegmentGrid, cells: &Range<usize>) -> Option<Box<Self>> {
        segment.taper.as_ref()?;
        let from = |cell: usize| (cell - part.cells.start) as f64 * part.spacing;
        // The last cell ends at the segment's end, whatever the rounding.
        let to = |cell: usize| from(cell + 1).min(segment.length);
        let area = cells.clone().map(|cell| segment.mean_area(from(cell), to(cell)) / segment.area).collect();
        Some(Box::new(Self::from_areas(area)))
    }

    fn from_areas(area: Vec<f64>) -> Self {
        let skew = area.windows(2).map(|a| (a[1] - a[0]) / (a[1] + a[0])).collect();
        Self { area, skew }
    }

    /// Splits off the cells from `at` on.
    pub fn split_off(&mut self, at: usize) -> Self {
        let right = self.area.split_off(at);
        *self = Self::from_areas(std::mem::take(&mut self.area));
        Self::from_areas(right)
    }

    /// Returns the velocity change in a step of the node to the left of cell `i` (0 < i < cells), m/s.
    pub fn velocity_increment(&self, gain: f64, sigma: &[f64], i: usize) -> f64 {
        velocity_increment(gain, self.skew[i - 1], sigma[i - 1], sigma[i])
    }

    /// Returns the mass of the node to the left of cell `i` (0 < i < cells) divided by the mean mass of a cell of the segment.
    pub fn node_mass(&self, i: usize) -> f64 {
        0.5 * (self.area[i - 1] + self.area[i])
    }

    /// Advances these nodes inside the block by a step.
    pub fn advance_velocity(&self, gain: f64, sigma: &[f64], v: &mut [f64], nodes: Range<usize>) {
        advance_velocity(gain, &self.skew, sigma, v, nodes);
    }

    /// As [`grid_filter::apply_impulses`], in a tapered segment: the impulse of a cell is its mass times `impulses`. The returned sum is
    /// weighted with the nodes' masses divided by the mean mass of a cell.
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

//! Staggered grid of a bar: stresses in cells, velocities at the nodes between them.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::sharing::share_out;
use crate::bar::{Bar, Segment};

/// Relative difference of the transit times of cells up to which they count as equal.
const ROUND_OFF: f64 = 1e-14;

/// Relative tolerance of a position at a joint, which is a sum of lengths.
const SAME_PLACE: f64 = 1e-9;

/// Part of the grid on one segment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SegmentGrid {
    /// Cells of the segment, counted over the whole bar.
    pub cells: Range<usize>,
    /// Position of the left end of the segment, m.
    pub x0: f64,
    /// Distance between the centres of the cells, m.
    pub spacing: f64,
    /// Cell size with which the scheme computes, m: the spacing, or nearly so in [`Grid::in_whole_steps`].
    pub dx: f64,
}

impl SegmentGrid {
    /// Returns the left and right edge of a cell, m from the segment's left end.
    pub fn cell(&self, cell: usize) -> [f64; 2] {
        let i = cell - self.cells.start;
        [self.spacing * i as f64, self.spacing * (i + 1) as f64]
    }

    /// Returns the range of the half cells on both sides of a node that are in the segment, m from its left end.
    pub fn nodal_interval(&self, node: usize) -> [f64; 2] {
        let (i, count) = ((node - self.cells.start) as f64, self.cells.len() as f64);
        [(i - 0.5).max(0.0), (i + 0.5).min(count)].map(|i| self.spacing * i)
    }

    /// Returns the velocity (m/s) of a node of a segment half a step after t = 0, without the effect of initial stresses: that of the
    /// common momentum of its cells. At Courant number 1 this is the elastic solution at that time, (v(x - c dt/2) + v(x + c dt/2))/2 with
    /// the cells' mean velocities v. A velocity that alternates from node to node vanishes in it; the grid would let it grow with every
    /// step.
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

/// Grid of a bar. The cells are distributed so that the fastest wave takes as nearly as possible the same time to cross each of them,
/// whatever its material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// Segments from left to right.
    pub segments: Vec<SegmentGrid>,
    /// Time step, s.
    pub dt: f64,
}

impl Grid {
    /// Distributes about `cells` cells over the bar, see `sharing`. The time step is `cfl` times the shortest transit time of a cell,
    /// 0 < cfl <= 1: no explicit scheme is stable above.
    ///
    /// # Panics
    /// If `cfl` is out of this range.
    pub fn new(bar: &Bar, cells: usize, cfl: f64) -> Self {
        Self::with_counts(bar, &share_out(&bar.transit_times(), cells), cfl)
    }

    /// Creates the grid with these numbers of cells of the segments, with the time step of [`Grid::new`].
    ///
    /// # Panics
    /// If `cfl` is not in 0 < cfl <= 1.
    pub fn with_counts(bar: &Bar, counts: &[usize], cfl: f64) -> Self {
        assert!(cfl > 0.0 && cfl <= 1.0, "the Courant number is {cfl}; 0 < cfl <= 1");
        let mut segments = Vec::with_capacity(bar.segments.len());
        let (mut first, mut x0, mut dt) = (0, 0.0, f64::INFINITY);
        for (segment, count) in bar.segments.iter().zip(counts) {
            let spacing = segment.length / *count as f64;
            dt = dt.min(cfl * spacing / segment.material.c0());
            segments.push(SegmentGrid { cells: first..first + count, x0, spacing, dx: spacing });
            first += *count;
            x0 += segment.length;
        }
        Self { segments, dt }
    }

    /// Returns the same cells, which elastic waves cross in exactly one time step if their transit time exceeds the shortest one by at most
    /// the fraction `most`. The transit times are rounded, and up as much as down if this is so for all segments. The scheme computes with
    /// segments that are correspondingly longer or shorter; their impedance, cross-section and positions are unchanged. For a grid of
    /// Courant number 1.
    #[must_use]
    pub fn in_whole_steps(&self, bar: &Bar, most: f64) -> Self {
        let transit = |(part, segment): (&SegmentGrid, &Segment)| part.spacing / segment.material.c0();
        let transits: Vec<f64> = self.segments.iter().zip(&bar.segments).map(transit).collect();
        let is_near = |own: f64| own <= self.dt * (1.0 + most);
        let longest = transits.iter().copied().filter(|&own| is_near(own)).fold(0.0, f64::max);
        let all = transits.iter().all(|&own| is_near(own)) && longest > self.dt;
        let dt = if all { 2.0 / (1.0 / self.dt + 1.0 / longest) } else { self.dt };
        self.in_steps_of(bar, dt, is_near)
    }

    /// Returns the same cells with time steps of `dt` (s); waves cross those whose transit time (s) `is_rounded` in exactly one step.
    #[must_use]
    pub fn in_steps_of(&self, bar: &Bar, dt: f64, is_rounded: impl Fn(f64) -> bool) -> Self {
        let mut grid = Self { dt, ..self.clone() };
        for (part, segment) in grid.segments.iter_mut().zip(&bar.segments) {
            let c0 = segment.material.c0();
            let own = part.spacing / c0;
            if is_rounded(own) && (own - dt).abs() > ROUND_OFF * dt {
                part.dx = c0 * dt;
            }
        }
        grid
    }

    /// Returns the largest relative change of a segment's transit time by rounding to whole steps, >= 0.
    pub fn transit_shift(&self) -> f64 {
        self.segments.iter().map(|part| (part.dx / part.spacing - 1.0).abs()).fold(0.0, f64::max)
    }

    /// Returns the number of steps to the first one that reaches a time (s), at least one.
    pub fn steps_to(&self, until: f64) -> usize {
        // Rounding in until/dt must not cost a whole extra step.
        ((until / self.dt - 1e-9).ceil() as usize).max(1)
    }

    /// Returns the number of cells of the whole bar.
    pub fn cells(&self) -> usize {
        self.segments.last().map_or(0, |s| s.cells.end)
    }

    /// Returns the cell centres, m.
    pub fn centres(&self) -> Vec<f64> {
        let centre = |s: &SegmentGrid, i: usize| s.x0 + ((i - s.cells.start) as f64 + 0.5) * s.spacing;
        self.segments.iter().flat_map(|s| s.cells.clone().map(move |i| centre(s, i))).collect()
    }

    /// Returns the position of a node, m; its number is that of the cell to its right.
    pub fn node(&self, node: usize) -> f64 {
        let k = self.segments.partition_point(|s| s.cells.end < node).min(self.segments.len() - 1);
        let segment = &self.segments[k];
        segment.x0 + (node - segment.cells.start) as f64 * segment.spacing
    }

    /// Returns the segment at position `x` (the right one at a joint, as in front tracking).
    pub fn segment_at(&self, x: f64) -> usize {
        let after = self.segments.partition_point(|s| s.x0 <= x * (1.0 + SAME_PLACE));
        after.max(1) - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_whole_steps_waves_cross_a_cell_in_each() {
        let bar = Bar::elastic(&[(0.317, 7800.0), (0.123, 2700.0), (0.71, 8960.0)]);
        let grid = Grid::new(&bar, 1000, 1.0);
        let whole = grid.in_whole_steps(&bar, 1.0);
        assert_eq!((grid.transit_shift(), whole.centres()), (0.0, grid.centres()));
        assert!(whole.transit_shift() > 1e-6 && whole.transit_shift() < 2e-3, "{}", whole.transit_shift());
        let changes = whole.segments.iter().zip(&bar.segments).map(|(part, segment)| {
            assert!((segment.material.c0() * whole.dt / part.dx - 1.0).abs() < 1e-15);
            part.dx / part.spacing - 1.0
        });
        // As much longer as shorter.
        let [low, high] = changes.fold([0.0_f64; 2], |[low, high], change| [low.min(change), high.max(change)]);
        assert!((low + high).abs() < 1e-3 * high, "{low} {high}");
    }

    #[test]
    fn segments_that_differ_by_more_keep_their_transit_time() {
        let bar = Bar::elastic(&[(0.5, 7800.0), (0.0053, 2700.0), (0.5, 7800.0), (0.3, 8900.0)]);
        let grid = Grid::new(&bar, 500, 1.0);
        let whole = grid.in_whole_steps(&bar, 5e-3);
        assert_eq!((whole.dt, &whole.segments[1]), (grid.dt, &grid.segments[1]));
        let courant = |k: usize| bar.segments[k].material.c0() * whole.dt / whole.segments[k].dx;
        assert!(courant(1) < 0.99 && [0, 2, 3].into_iter().all(|k| (courant(k) - 1.0).abs() < 1e-15), "{}", courant(1));
        assert!(whole.transit_shift() > 1e-6 && whole.transit_shift() <= 5e-3, "{}", whole.transit_shift());
    }

    #[test]
    fn one_segment_needs_no_rounding() {
        let bar = Bar::elastic(&[(0.317, 7800.0)]);
        let grid = Grid::new(&bar, 123, 1.0);
        assert_eq!(grid.in_whole_steps(&bar, 1.0), grid);
    }
}

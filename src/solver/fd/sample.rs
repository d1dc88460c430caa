//! Sampling of the grid at given positions.

use super::Grid;
use crate::bar::Bar;

/// Positions on the bar, each between two neighbouring cell centres of one segment.
#[derive(Debug, Clone)]
pub struct Sampling {
    x: Vec<f64>,
    /// Left cell, and weight of the cell right of it (0 if the position is a centre).
    points: Vec<(usize, f64)>,
    every_cell: bool,
}

impl Sampling {
    /// Samples every cell centre of the grid.
    pub fn cells(grid: &Grid) -> Self {
        Self { x: grid.centres(), points: (0..grid.cells()).map(|i| (i, 0.0)).collect(), every_cell: true }
    }

    /// Samples the centres of `count` equal parts of the bar.
    pub fn even(bar: &Bar, grid: &Grid, count: usize) -> Self {
        let part = bar.length() / count as f64;
        Self::at(grid, (0..count).map(|i| (i as f64 + 0.5) * part).collect())
    }

    /// Samples given positions, m. Values are interpolated between two centres, never across a joint.
    pub fn at(grid: &Grid, x: Vec<f64>) -> Self {
        let points = x.iter().map(|&x| locate(grid, x)).collect();
        Self { x, points, every_cell: false }
    }

    /// Returns true if the positions are the cell centres, all of them in order.
    pub fn is_every_cell(&self) -> bool {
        self.every_cell
    }

    /// Returns the positions, m.
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// Returns the cells that are read, position by position.
    pub fn cells_read(&self) -> Vec<usize> {
        self.points.iter().flat_map(|&(cell, weight)| cell..=cell + usize::from(weight != 0.0)).collect()
    }

    /// Computes a quantity at every position, from its value in a cell, into `out` (one entry per position).
    pub fn read(&self, mut value: impl FnMut(usize) -> f64, out: &mut [f64]) {
        for (k, out) in out.iter_mut().enumerate() {
            *out = self.value(k, &mut value);
        }
    }

    /// Returns a quantity at position `k`, from its value in a cell.
    pub fn value(&self, k: usize, mut value: impl FnMut(usize) -> f64) -> f64 {
        let (cell, weight) = self.points[k];
        between(weight, value(cell), || value(cell + 1))
    }

    /// Returns the cell left of position `k`, and the weight of the cell right of that, for [`between`].
    pub fn point(&self, k: usize) -> (usize, f64) {
        self.points[k]
    }
}

/// Interpolates between two cells; the second one is read only if its weight is not zero.
pub fn between(weight: f64, here: f64, there: impl FnOnce() -> f64) -> f64 {
    if weight == 0.0 { here } else { here + weight * (there() - here) }
}

/// Returns the left cell and the weight of its right neighbour for a position; constant beyond the outermost centres of its segment.
fn locate(grid: &Grid, x: f64) -> (usize, f64) {
    let part = &grid.segments[grid.segment_at(x)];
    let last = (part.cells.len() - 1) as f64;
    let place = ((x - part.x0) / part.spacing - 0.5).clamp(0.0, last);
    let cell = (place.floor() as usize).min(part.cells.len() - 1);
    let weight = place - cell as f64;
    (part.cells.start + cell, weight)
}

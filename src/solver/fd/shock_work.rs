//! Energy that the grid filter takes inside shocks. It represents the dissipation of the shock, and is recorded with the plastic work;
//! elsewhere it is an error of the scheme.

use std::iter;

use super::block::Block;
use super::segment::SegmentLaw;
use super::sizes::MOST_CELLS;

/// Number of cells of a shock on either side of the one in which the curve stiffens.
const REACH: usize = 4;

/// Largest number of places, in a block and beside it, at which the position on the curve is checked: every [`REACH`] cells.
const MOST_PLACES: usize = MOST_CELLS.div_ceil(REACH) + 2;

/// Groups of [`REACH`] cells that lie inside a shock or next to one.
pub(super) struct InShock {
    /// Whether a stiffening knot lies between a place and the next one.
    crossed: [bool; MOST_PLACES],
}

impl InShock {
    /// Finds the shocks from the numbers of stiffening knots that the cells at the places have passed. Returns `None` if there are no
    /// shocks.
    fn new(passed: impl Iterator<Item = usize>) -> Option<Self> {
        let mut crossed = [false; MOST_PLACES];
        let mut before = None;
        for (passed, crossed) in passed.zip(iter::once(&mut false).chain(&mut crossed)) {
            *crossed = before.replace(passed).is_some_and(|before| before != passed);
        }
        crossed.contains(&true).then_some(Self { crossed })
    }

    fn contains(&self, cell: usize) -> bool {
        let group = cell / REACH;
        self.crossed[group..=group + 2].contains(&true)
    }
}

impl Block {
    /// Returns how many of the knots at which the curve stiffens a cell has passed.
    fn stiffenings(&self, law: &SegmentLaw, cell: usize) -> usize {
        if self.state.is_empty() {
            return 0;
        }
        let accumulated = law.law.accumulated(&self.state, cell);
        law.stiffenings[usize::from(self.stress(cell) < 0.0)].partition_point(|&knot| knot < accumulated)
    }

    /// As [`Self::stiffenings`], for the cell that is the reach of a shock inside the left (0) or right (1) edge of the block.
    pub fn stiffenings_inside(&self, law: &SegmentLaw, side: usize) -> usize {
        let depth = (REACH - 1).min(self.sigma.len() - 1);
        self.stiffenings(law, if side == 0 { depth } else { self.sigma.len() - 1 - depth })
    }

    /// As [`Self::stiffenings`], for the first (0) or the last (1) cell.
    pub fn stiffenings_at_edge(&self, law: &SegmentLaw, side: usize) -> usize {
        self.stiffenings(law, if side == 0 { 0 } else { self.sigma.len() - 1 })
    }

    /// Returns the cells inside shocks, `None` if there are none. `beside` are the [`Self::stiffenings_inside`] of both neighbours or,
    /// where the segment ends, [`Self::stiffenings_at_edge`].
    pub fn find_shocks(&self, law: &SegmentLaw, beside: [usize; 2]) -> Option<InShock> {
        if self.reached <= law.first_stiffening() && beside == [0; 2] {
            return None;
        }
        let own = (0..self.sigma.len()).step_by(REACH).map(|cell| self.stiffenings(law, cell));
        InShock::new(iter::once(beside[0]).chain(own).chain([beside[1]]))
    }

    /// Records the energy that these `impulses` of the filter have just taken in cells inside shocks; `outer` are the velocities (m/s) of
    /// the nodes at both edges. A cell loses its impulse times the velocity difference of its nodes at the time of the stresses, averaged
    /// over the values before and after the filter, so that all cells together lose what all nodes lose.
    pub fn note_shocks(&mut self, shocks: &InShock, velocity_gain: f64, outer: [f64; 2], impulses: &[f64]) {
        let cells = self.sigma.len();
        let velocity = |node: usize| {
            let filtered = if (1..cells).contains(&node) { impulses[node] - impulses[node - 1] } else { 0.0 };
            self.velocity_at_stresses(node, velocity_gain, outer, filtered)
        };
        let inside = self.active.clone().filter(|&cell| impulses[cell] != 0.0 && shocks.contains(cell));
        let taken = |cell: usize| self.area(cell) * impulses[cell] * (velocity(cell + 1) - velocity(cell));
        self.shock_loss.note(inside.map(taken).sum());
    }

    /// Adds the change by starting fans of the filter's work inside shocks, divided by the mass of a mean cell, (m/s)^2.
    pub fn note_lost_in_shocks(&mut self, lost: f64) {
        self.damped += 2.0 * lost;
        self.shock_loss.note(lost);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_within_reach_of_a_stiffening_knot_are_inside_a_shock() {
        // Beside the block, its cells 0, 4, 8 and 12, beside it.
        let inside = |passed: [usize; 6]| {
            let shocks = InShock::new(passed.into_iter());
            (0..16).filter(|&cell| shocks.as_ref().is_some_and(|shocks| shocks.contains(cell))).collect::<Vec<_>>()
        };
        assert!(inside([0; 6]).is_empty() && inside([3; 6]).is_empty());
        assert_eq!(inside([1, 1, 1, 0, 0, 0]), (0..12).collect::<Vec<_>>());
        // The knot lies between this block and the one to its right, or to its left.
        assert_eq!(inside([1, 1, 1, 1, 1, 0]), (8..16).collect::<Vec<_>>());
        assert_eq!(inside([1, 0, 0, 0, 0, 0]), (0..4).collect::<Vec<_>>());
    }
}

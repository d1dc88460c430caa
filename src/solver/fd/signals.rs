//! Domain of influence of a step.

use std::ops::Range;

/// How far a signal travels in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Signals {
    /// By one cell: nodes follow the stresses beside them.
    ThroughCells,
    /// Any distance: the nodes of the whole bar are solved for together.
    ThroughNodes,
}

/// Returns the nodes of these cells of a block, without those at the edges of the block.
pub(super) fn inner_nodes(cells: &Range<usize>, all: usize) -> Range<usize> {
    cells.start.max(1)..all.min(cells.end + 1)
}

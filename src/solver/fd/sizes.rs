//! Block sizes: small enough for the first-level cache, large enough that selecting their kernel costs nothing.

use crate::law::CHUNK;

/// Cells of a full block. Fixed, so that sums over blocks have the same bits whatever the number of threads.
const BLOCK: usize = 256;

/// Cells of the longest block.
pub(super) const MOST_CELLS: usize = 2 * BLOCK;

/// Sizes of the blocks of a segment of so many cells, the same from right to left: full blocks, and in the middle what is
/// left, in one or three blocks of more than half a full one and less than two. Only a short segment has a smaller one.
pub(super) fn block_sizes(cells: usize) -> impl Iterator<Item = usize> {
    let pairs = cells.saturating_sub(BLOCK) / (2 * BLOCK);
    let middle = cells - 2 * BLOCK * pairs;
    // Whole pieces, where that can be had.
    let third = if middle < 2 * BLOCK { 0 } else { (middle / 3) / CHUNK * CHUNK };
    let middle = [third, middle - 2 * third, third].into_iter().filter(|&cells| cells > 0);
    let full = std::iter::repeat_n(BLOCK, pairs);
    full.clone().chain(middle).chain(full)
}

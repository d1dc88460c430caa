//! Block sizes: small enough for the first-level cache, large enough that selecting their kernel costs nothing.

use crate::law::CHUNK;

/// Number of cells of a full block. It is fixed, so that sums over blocks have the same bits for any number of threads.
const BLOCK: usize = 256;

/// Number of cells of the longest block.
pub(super) const MOST_CELLS: usize = 2 * BLOCK;

/// Returns the sizes of the blocks of a segment with this many cells, symmetric about its middle: full blocks, and in the middle the
/// remaining cells, in one or three blocks of more than half and less than twice the size of a full one. Only a short segment has a smaller
/// block.
pub(super) fn block_sizes(cells: usize) -> impl Iterator<Item = usize> {
    let pairs = cells.saturating_sub(BLOCK) / (2 * BLOCK);
    let middle = cells - 2 * BLOCK * pairs;
    // Whole pieces, if possible.
    let third = if middle < 2 * BLOCK { 0 } else { (middle / 3) / CHUNK * CHUNK };
    let middle = [third, middle - 2 * third, third].into_iter().filter(|&cells| cells > 0);
    let full = std::iter::repeat_n(BLOCK, pairs);
    full.clone().chain(middle).chain(full)
}

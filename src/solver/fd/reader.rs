//! Reading of many cells of a bar.

use super::block::Block;
use super::cell_value::{block_values, cell_value};
use super::leapfrog::Leapfrog;
use super::nodes::Nodes;
use super::quantity::Quantity;
use super::segment::Constants;
use crate::law::RowLaw;

/// Reads one quantity, cell by cell. Data that the cells of a block have in common are looked up once, as long as cells of the same block
/// are read one after the other, in any order.
pub struct Reader<'a> {
    bar: &'a Leapfrog,
    quantity: Quantity,
    k: usize,
    block: &'a Block,
    law: &'a dyn RowLaw,
    constants: &'a Constants,
    outer: [f64; 2],
}

impl<'a> Reader<'a> {
    /// Creates a reader of the bar in its current state.
    pub fn new(bar: &'a Leapfrog, quantity: Quantity) -> Self {
        Self::in_block(bar, quantity, 0)
    }

    fn in_block(bar: &'a Leapfrog, quantity: Quantity, k: usize) -> Self {
        let block = &bar.blocks[k];
        let (law, constants) = (bar.laws[block.segment].law.as_ref(), &bar.constants[block.segment]);
        // Only the velocity depends on these.
        let outer = if quantity == Quantity::Velocity { nodes(bar).edge_velocities(k) } else { [f64::NAN; 2] };
        Self { bar, quantity, k, block, law, constants, outer }
    }

    /// Computes the quantity in all cells of the bar, into `out` (one entry per cell).
    pub fn all(mut self, out: &mut [f64]) {
        if self.bar.implicit.is_some() {
            return out.iter_mut().enumerate().for_each(|(cell, out)| *out = self.value(cell));
        }
        for k in 0..self.bar.blocks.len() {
            let Self { quantity, block, law, constants, outer, .. } = Self::in_block(self.bar, self.quantity, k);
            block_values(quantity, block, law, constants, outer, &mut out[block.cells.clone()]);
        }
    }

    /// Returns the quantity in this cell of the bar.
    #[inline]
    pub fn value(&mut self, cell: usize) -> f64 {
        if !self.block.cells.contains(&cell) {
            let next = self.bar.blocks.get(self.k + 1).is_some_and(|block| block.cells.contains(&cell));
            let k = if next { self.k + 1 } else { self.bar.blocks.partition_point(|b| b.cells.end <= cell) };
            *self = Self::in_block(self.bar, self.quantity, k);
        }
        if let (Quantity::Velocity, Some(nodes)) = (self.quantity, &self.bar.implicit) {
            return 0.5 * (nodes.velocity(cell) + nodes.velocity(cell + 1));
        }
        cell_value(self.quantity, self.block, self.law, self.constants, self.outer, cell - self.block.cells.start)
    }
}

fn nodes(bar: &Leapfrog) -> Nodes<'_> {
    Nodes { first: 0, edges: &bar.edges, contacts: &bar.contacts, ends: [Some(&bar.left), Some(&bar.right)] }
}

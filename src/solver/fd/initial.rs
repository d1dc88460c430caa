//! Bars that are stressed or have yielded at t = 0.
//!
//! What held the bar is removed at t = 0. Velocities are known half a step later, and the stresses have acted on them for half a step by
//! then: the nodes first receive half of the stresses ([`Leapfrog::apply_half_initial_stress`]), which makes elastic waves exact at Courant number 1 from
//! the start. The scheme's balance of energy counts whole steps; [`Leapfrog::restore_initial_stress`] therefore sets the velocities half a step
//! before t = 0 to those from which a whole step under these stresses would have begun. With distributed forces, the nodes start half a
//! step before t = 0 and take the whole step ([`super::implicit::Implicit::start_under`]).

use super::block::{Block, STEPS_WITHOUT_FLOW};
use super::edge::last;
use super::leapfrog::Leapfrog;
use crate::bar::Bar;

impl Leapfrog {
    /// Sets the initial stresses, and the states of cells that have yielded or are warm, to means over the cells.
    pub(super) fn set_initial(&mut self, bar: &Bar) {
        for block in &mut self.blocks {
            let (segment, part) = (&bar.segments[block.segment], &self.grid.segments[block.segment]);
            let (law, modulus) = (&self.laws[block.segment].law, self.constants[block.segment].modulus);
            for (local, cell) in block.cells.clone().enumerate() {
                let [from, to] = part.cell(cell);
                let initial = segment.initial_between(from, to);
                block.sigma[local] = initial.stress;
                if initial.is_of_a_law() {
                    block.set_state(local, &law.deformed(&initial.deformed(modulus)));
                }
            }
            block.wake();
        }
    }

    /// Halves the initial stresses and advances the nodes inside the blocks with them. The nodes at the edges are advanced next, with the
    /// same stresses.
    pub(super) fn apply_half_initial_stress(&mut self) {
        for block in &mut self.blocks {
            block.sigma.iter_mut().for_each(|sigma| *sigma *= 0.5);
            let gain = self.constants[block.segment].velocity_gain;
            for node in 1..block.sigma.len() {
                block.v[node] += block.velocity_increment(gain, node);
            }
            block.note_undamped();
        }
    }

    /// Restores the full initial stresses, after all nodes were advanced with half of them.
    pub(super) fn restore_initial_stress(&mut self, bar: &Bar) {
        for contact in &mut self.contacts {
            let [left, right] = [contact.edge, contact.edge + 1].map(|k| &self.blocks[k].sigma);
            contact.start_under([last(left), right[0]]);
        }
        self.left.start_under(self.blocks[0].sigma[0]);
        self.right.start_under(last(&self.blocks[self.blocks.len() - 1].sigma));
        self.edges.iter_mut().for_each(|edge| edge.velocity_increment *= 2.0);
        for block in &mut self.blocks {
            let (segment, part) = (&bar.segments[block.segment], &self.grid.segments[block.segment]);
            for (sigma, cell) in block.sigma.iter_mut().zip(block.cells.clone()) {
                let [from, to] = part.cell(cell);
                *sigma = segment.initial_between(from, to).stress;
            }
        }
        self.initial_energy = Some(self.energies());
    }
}

impl Block {
    /// Sets the law's state of a cell; the block has plastic state from then on.
    fn set_state(&mut self, cell: usize, state: &[f64]) {
        if self.is_elastic() {
            self.start_plastic(state.len());
            self.steps_without_flow = STEPS_WITHOUT_FLOW - 1;
        }
        let cells = self.sigma.len();
        self.state.chunks_exact_mut(cells).zip(state).for_each(|(column, &number)| column[cell] = number);
    }
}

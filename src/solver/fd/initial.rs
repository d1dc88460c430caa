//! Bars that are stressed or have yielded at t = 0.
//!
//! What held the bar is taken away at t = 0. Velocities are known half a step later and have felt the stresses for half a step by
//! then: the nodes meet half of them first ([`Leapfrog::set_initial`]), which makes elastic waves exact at Courant number 1 from the
//! start. The scheme's balance of energy counts whole steps; [`Leapfrog::complete_initial`] therefore puts the velocities half a step
//! before t = 0 where a whole step of these stresses would have begun.

use super::block::Stage;
use super::edge::last;
use super::leapfrog::Leapfrog;
use crate::bar::Initial;
use crate::law::aligned_row;

impl Leapfrog {
    /// Before the nodes meet: half the initial stresses, and the states of segments that have yielded.
    pub(super) fn set_initial(&mut self, initial: &[Initial]) {
        for block in &mut self.blocks {
            let Initial { stress, plastic_strain } = initial[block.segment];
            let (law, constants) = (&self.laws[block.segment].law, &self.constants[block.segment]);
            block.sigma.iter_mut().for_each(|sigma| *sigma = 0.5 * stress);
            if plastic_strain != 0.0 {
                let cells = block.sigma.len();
                let state = law.deformed(constants.modulus * plastic_strain);
                block.stage = Stage::Plastic;
                block.state = aligned_row(state.len() * cells, 0.0);
                let columns = block.state.chunks_exact_mut(cells);
                columns.zip(state).for_each(|(column, number)| column.fill(number));
                block.flow = vec![0; cells];
            }
            for node in 1..block.sigma.len() {
                block.v[node] += block.velocity_increment(constants.velocity_gain, node);
            }
            block.note_undamped();
            block.wake();
        }
    }

    /// After the nodes met half the initial stresses: the whole of them.
    pub(super) fn complete_initial(&mut self, initial: &[Initial]) {
        for contact in &mut self.contacts {
            let [left, right] = [contact.edge, contact.edge + 1].map(|k| &self.blocks[k].sigma);
            contact.start_under([last(left), right[0]]);
        }
        self.left.start_under(self.blocks[0].sigma[0]);
        self.right.start_under(last(&self.blocks[self.blocks.len() - 1].sigma));
        self.edges.iter_mut().for_each(|edge| edge.velocity_increment *= 2.0);
        for block in &mut self.blocks {
            let stress = initial[block.segment].stress;
            block.sigma.iter_mut().for_each(|sigma| *sigma = stress);
        }
        self.initial_energy = Some(self.energies());
    }
}

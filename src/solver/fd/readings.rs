//! Readings of a bar: fields, energies, and cells at limits of their data.

use super::block::{Block, NodeMotion};
use super::contact::Contact;
use super::end_node::EndNode;
use super::leapfrog::Leapfrog;
use super::quantity::Quantity;
use super::reader::Reader;
use crate::law::FirstPassed;
use crate::solver::Energies;

impl Leapfrog {
    /// Returns the mass of the bar, kg.
    pub fn mass(&self) -> f64 {
        self.blocks.iter().map(|b| self.constants[b.segment].cell_mass * b.volume()).sum()
    }

    /// Returns the memory of the plastic state, and of the nodes if distributed forces act along the bar, bytes.
    pub fn state_bytes(&self) -> usize {
        let blocks: usize = self.blocks.iter().map(|b| (b.state.len() + b.absorbed.len()) * size_of::<f64>()).sum();
        blocks + self.implicit.as_ref().map_or(0, |nodes| nodes.bytes())
    }

    /// Returns the impulse (N s in +x) that external damping, friction and a foundation have given to the bar so far, and the sum of its
    /// absolute values.
    pub fn impulse_along(&self) -> [f64; 2] {
        self.implicit.as_ref().map_or([0.0; 2], |nodes| nodes.impulse())
    }

    /// Returns a quantity in one cell.
    pub fn value(&self, quantity: Quantity, cell: usize) -> f64 {
        Reader::new(self, quantity).value(cell)
    }

    /// Computes a quantity in every cell, into `out` (one entry per cell).
    pub fn profile(&self, quantity: Quantity, out: &mut [f64]) {
        Reader::new(self, quantity).all(out);
    }

    /// Returns the displacement of every cell centre, m: that of the left end, plus the strain and the openings of joints up to the cell.
    pub fn displacements(&self) -> Vec<f64> {
        let mut strains = vec![0.0; self.grid.cells()];
        self.profile(Quantity::Strain, &mut strains);
        let mut centres = Vec::with_capacity(strains.len());
        let mut node = self.left.displacement();
        let mut contacts = self.contacts.iter().peekable();
        for part in &self.grid.segments {
            for (cell, &strain) in part.cells.clone().zip(&strains[part.cells.clone()]) {
                if let Some(contact) = contacts.next_if(|contact| contact.cell == cell) {
                    node += contact.jump();
                }
                let elongation = strain * part.dx;
                centres.push(node + 0.5 * elongation);
                node += elongation;
            }
        }
        centres
    }

    /// Returns energies and momentum at the current time, in one pass over all cells.
    pub fn energies(&self) -> Energies {
        if let Some(nodes) = &self.implicit {
            let sums = nodes.sums();
            return self.energies_with(Energies { momentum: sums.momentum - self.unbalanced_impulse(), ..sums });
        }
        let half_step = self.left.in_transit() + self.right.in_transit() + self.lost_to_fans;
        let momentum = -self.unbalanced_impulse();
        let mut total = Energies { numerical: self.taken_by_filter(), half_step, momentum, ..Energies::default() };
        for (k, block) in self.blocks.iter().enumerate() {
            let c = &self.constants[block.segment];
            self.add_material(&mut total, block);
            let in_shocks = c.cell_mass * block.shock_loss.dissipated();
            total.numerical -= in_shocks;
            total.add_flow(in_shocks, self.laws[block.segment].law.heat_fraction());
            add_nodes(&mut total, c.cell_mass, block.inner_nodes(c.velocity_gain));
            if let Some(edge) = self.edges.get(k) {
                add_nodes(&mut total, edge.mass, NodeMotion::of(edge.before(), edge.after));
            }
        }
        for contact in &self.contacts {
            total.half_step += contact.lost();
            for side in [0, 1] {
                let [before, after] = contact.velocities(side);
                add_nodes(&mut total, contact.mass(side, self.grid.dt), NodeMotion::of(before, after));
            }
        }
        for (end_node, mass) in [&self.left, &self.right].into_iter().zip(self.end_masses()) {
            add_nodes(&mut total, mass, NodeMotion::of(end_node.velocity_before(), end_node.velocity_after()));
        }
        total
    }

    /// Returns the energy that the grid filter has taken, J.
    pub(super) fn taken_by_filter(&self) -> f64 {
        let blocks = self.blocks.iter().map(|block| 0.5 * self.constants[block.segment].cell_mass * block.damped);
        let edges = self.edges.iter().map(|edge| edge.damped);
        let joints = self.contacts.iter().map(Contact::damped);
        let ends = [&self.left, &self.right].into_iter().map(EndNode::damped);
        blocks.chain(edges).chain(joints).chain(ends).sum()
    }

    /// Returns the part of that energy that cells inside shocks lost, J.
    pub(super) fn taken_in_shocks(&self) -> f64 {
        let blocks = self.blocks.iter();
        blocks.map(|block| self.constants[block.segment].cell_mass * block.shock_loss.dissipated()).sum()
    }

    /// Adds the strain energy and the work of flow of a block.
    fn add_material(&self, total: &mut Energies, block: &Block) {
        let (c, law) = (&self.constants[block.segment], self.laws[block.segment].law.as_ref());
        let over = c.cell_volume * block.overstress_work(law) / c.modulus;
        let flow = 0.5 * c.cell_volume * block.plastic / c.modulus;
        let heats = law.heat_fraction();
        total.half_step -= 0.5 * c.cell_volume * block.onset_correction / c.modulus;
        total.elastic += 0.5 * c.cell_volume * block.sum_of_squares() / c.modulus;
        total.add_flow(flow, heats);
        total.plastic -= (1.0 - heats) * over;
        total.viscoplastic += (1.0 - heats) * over;
    }

    /// As [`Self::energies`], if the nodes keep their own account.
    fn energies_with(&self, nodes: Energies) -> Energies {
        let mut total = nodes;
        total.half_step += self.left.in_transit() + self.right.in_transit() + self.lost_to_fans;
        for block in &self.blocks {
            self.add_material(&mut total, block);
        }
        total
    }

    /// Returns the masses of the nodes at the ends, kg.
    fn end_masses(&self) -> [f64; 2] {
        let (first, last) = (&self.blocks[0], &self.blocks[self.blocks.len() - 1]);
        [(first, 0), (last, last.sigma.len() - 1)]
            .map(|(block, cell)| 0.5 * (self.constants[block.segment].cell_mass * block.area(cell)))
    }

    /// Returns the kinetic energy and momentum of the nodes with their initial velocities, before anything acts on them.
    pub fn initial(&self) -> Energies {
        debug_assert_eq!(self.step, 0);
        if let Some(initial) = self.initial_energy {
            let momentum = initial.momentum - self.left.impulse() - self.right.impulse();
            return Energies { momentum, ..initial };
        }
        if let Some(nodes) = &self.implicit {
            return nodes.initial();
        }
        let mut total = Energies { momentum: -self.unbalanced_impulse(), ..Energies::default() };
        for (k, block) in self.blocks.iter().enumerate() {
            let c = &self.constants[block.segment];
            add_nodes(&mut total, c.cell_mass, block.inner_nodes_at_start());
            if let Some(edge) = self.edges.get(k) {
                add_nodes(&mut total, edge.mass, NodeMotion::of(edge.before(), edge.before()));
            }
        }
        for (contact, side) in self.contacts.iter().flat_map(|contact| [(contact, 0), (contact, 1)]) {
            let [before, _] = contact.velocities(side);
            add_nodes(&mut total, contact.mass(side, self.grid.dt), NodeMotion::of(before, before));
        }
        for (end_node, mass) in [&self.left, &self.right].into_iter().zip(self.end_masses()) {
            let v = end_node.velocity_before();
            add_nodes(&mut total, mass, NodeMotion::of(v, v));
        }
        total
    }

    /// Returns the cells that have reached a limit of their law's data.
    pub fn limits_reached(&self) -> FirstPassed {
        let mut all = FirstPassed::default();
        self.blocks.iter().for_each(|block| all.merge(&block.passed));
        all
    }

    /// Returns the first cell whose stress or state is not a finite number.
    pub fn not_finite(&self) -> Option<usize> {
        // Cells at rest are finite.
        let in_block = |b: &Block| {
            let bad = |column: &[f64]| column[b.active.clone()].iter().position(|value| !value.is_finite());
            let columns = std::iter::once(&b.sigma[..]).chain(b.state.chunks_exact(b.sigma.len()));
            columns.filter_map(bad).min().map(|i| b.cells.start + b.active.start + i)
        };
        self.blocks.iter().find_map(in_block)
    }
}

/// Adds nodes of mass `mass` (kg) to the balance, from sums over them: of the products of their velocities half a step before and after, of
/// the sums of both, and of the squares of these.
///
/// The scheme conserves m v- v+/2. The kinetic energy is that of the mean velocity, m (v- + v+)^2/8; the difference, of either sign, is in
/// `half_step`.
fn add_nodes(total: &mut Energies, mass: f64, nodes: NodeMotion) {
    let kinetic = 0.125 * mass * nodes.squares;
    total.kinetic += kinetic;
    total.half_step += 0.5 * mass * nodes.products - kinetic;
    total.momentum += 0.5 * mass * nodes.sums;
}

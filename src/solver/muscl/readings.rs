//! Readings of a bar.

use super::block::{Block, GHOSTS, Stage};
use super::end::End;
use super::joint::Joint;
use super::stepping::Muscl;
use crate::bar::joint::Contact;
use crate::law::{FirstPassed, StrainedRow};
use crate::solver::fd::Quantity;
use crate::solver::{EndSample, EndState, Energies};

impl Muscl {
    /// Iterates over the joints that can open, with the index of the segment to their left.
    pub fn contacts(&self) -> impl Iterator<Item = (usize, &Contact)> {
        self.joints.iter().filter_map(|joint| Some((self.blocks[joint.edge].part, joint.contact()?)))
    }

    /// Returns a quantity in one cell.
    pub fn value(&self, quantity: Quantity, cell: usize) -> f64 {
        let block = &self.blocks[self.blocks.partition_point(|b| b.cells.end <= cell)];
        self.read(quantity, block, GHOSTS + cell - block.cells.start)
    }

    /// Writes a quantity in every cell to `out` (one entry per cell).
    pub fn profile(&self, quantity: Quantity, out: &mut [f64]) {
        for block in &self.blocks {
            for (i, out) in out[block.cells.clone()].iter_mut().enumerate() {
                *out = self.read(quantity, block, GHOSTS + i);
            }
        }
    }

    fn read(&self, quantity: Quantity, block: &Block, i: usize) -> f64 {
        let part = &self.parts[block.part];
        match quantity {
            Quantity::Stress => block.sigma[i],
            Quantity::Velocity => block.v[i],
            Quantity::Strain => block.e_equivalent_strain(part, i) / part.modulus,
            Quantity::PlasticStrain => (block.e_equivalent_strain(part, i) - block.sigma[i]) / part.modulus,
            Quantity::Temperature => self.temperature(block, i),
            Quantity::AccumulatedPlasticStrain => self.accumulated(block, i) / part.modulus,
        }
    }

    /// Temperature of a cell, K; NaN without the effect of heat.
    fn temperature(&self, block: &Block, i: usize) -> f64 {
        let law = &self.parts[block.part].law.law;
        law.temperature(if block.stage == Stage::Plastic { &block.state } else { &[] }, i)
    }

    /// E times the accumulated plastic strain of a cell, Pa.
    fn accumulated(&self, block: &Block, i: usize) -> f64 {
        let law = &self.parts[block.part].law.law;
        if block.stage == Stage::Plastic { law.accumulated(&block.state, i) } else { 0.0 }
    }

    /// Displacement of every cell centre, m: that of the left end plus the strain summed up to the cell.
    pub fn displacements(&self) -> Vec<f64> {
        let mut centres = Vec::with_capacity(self.grid.cells());
        let mut border = self.ends[0].displacement();
        for (k, block) in self.blocks.iter().enumerate() {
            let part = &self.parts[block.part];
            for i in GHOSTS..block.sigma.len() - GHOSTS {
                let stretch = block.e_equivalent_strain(part, i) / part.modulus * part.dx;
                centres.push(border + 0.5 * stretch);
                border += stretch;
            }
            border += self.joints.iter().find(|joint| joint.edge == k).map_or(0.0, Joint::jump);
        }
        centres
    }

    /// Returns the mean state of the left and the right end over the latest step; at the start, the state just after t = 0.
    pub fn ends(&self) -> [EndState; 2] {
        if self.step == 0 { self.start } else { self.ends.each_ref().map(End::latest) }
    }

    /// Returns samples of the left and the right end after the latest step.
    pub fn end_samples(&self) -> [EndSample; 2] {
        if self.step == 0 {
            return self.start.map(|now| EndSample { now, latest: EndState::UNKNOWN });
        }
        self.ends().map(|latest| EndSample { now: EndState::UNKNOWN, latest })
    }

    /// Velocity of a striker at the left and the right end, m/s, positive in +x; `None` without a striker.
    pub fn striker_velocities(&self) -> [Option<f64>; 2] {
        self.ends.each_ref().map(End::striker_velocity)
    }

    /// Work done by the left and the right end so far, J.
    pub fn work(&self) -> [f64; 2] {
        self.ends.each_ref().map(|end| end.work)
    }

    /// Impulse of the left and the right end so far, N s, positive in +x.
    pub fn impulse(&self) -> [f64; 2] {
        self.ends.each_ref().map(|end| end.impulse)
    }

    /// Sum of the magnitudes of all impulses of both ends so far, N s.
    pub fn throughput(&self) -> f64 {
        self.ends.iter().map(|end| end.throughput).sum()
    }

    /// Mass of the bar, kg.
    pub fn mass(&self) -> f64 {
        self.blocks.iter().map(|b| self.parts[b.part].cell_mass() * b.cells.len() as f64).sum()
    }

    /// Returns energies and momentum at the present time. `numerical` is the dissipation of the scheme outside shocks.
    pub fn energies(&self) -> Energies {
        let joints: f64 = self.contacts().map(|(_, contact)| contact.lost()).sum();
        let ends: f64 = self.ends.iter().map(|end| end.work - end.work_on_face).sum();
        let mut total = Energies { numerical: joints + ends, ..Energies::default() };
        for block in &self.blocks {
            let part = &self.parts[block.part];
            let own = GHOSTS..block.sigma.len() - GHOSTS;
            let (sigma, v) = (&block.sigma[own.clone()], &block.v[own]);
            let (volume, mass) = (part.cell_volume(), part.cell_mass());
            total.kinetic += 0.5 * mass * v.iter().map(|v| v * v).sum::<f64>();
            total.momentum += mass * v.iter().sum::<f64>();
            total.elastic += 0.5 * volume / part.modulus * sigma.iter().map(|s| s * s).sum::<f64>();
            let (flow, heats) = (0.5 * volume / part.modulus * block.plastic, part.law.law.heat_fraction());
            let [lost, in_shocks] =
                [block.lost, block.shock_loss.dissipated()].map(|sum| part.area * self.grid.dt * sum);
            total.add_flow(flow + in_shocks, heats);
            total.numerical += lost - in_shocks;
        }
        total
    }

    /// Returns the first cells that reached an end of the data of their law.
    pub fn limits_reached(&self) -> FirstPassed {
        self.passed.clone()
    }

    /// Records the cells that reached an end of their data in the latest step.
    pub(super) fn note_limits(&mut self) {
        for block in self.blocks.iter().filter(|block| block.stage != Stage::Quiet) {
            let (sigma, state, cells) = (&block.sigma[..], &block.state[..], GHOSTS..block.sigma.len() - GHOSTS);
            let (first, segment) = (block.cells.start, block.part);
            let row = StrainedRow { sigma, state, cells, first, segment, step: self.step };
            let law = &self.parts[block.part].law;
            law.law.note_limits(&law.end, &row, &mut self.passed);
        }
    }

    /// Returns the first cell whose stress or velocity is not finite.
    pub fn not_finite(&self) -> Option<usize> {
        self.blocks.iter().find_map(|block| {
            let bad = |i: &usize| !(block.sigma[*i] + block.v[*i]).is_finite();
            let found = (GHOSTS..block.sigma.len() - GHOSTS).find(bad)?;
            Some(block.cells.start + found - GHOSTS)
        })
    }

    /// Memory of the plastic state, bytes.
    pub fn state_bytes(&self) -> usize {
        self.blocks.iter().map(|b| b.state.len() * size_of::<f64>()).sum()
    }
}

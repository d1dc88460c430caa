//! Readings of a net.

use super::end::End;
use super::joint::Joint;
use super::part::NetSegment;
use super::stepping::Net;
use crate::bar::joint::Contact;
use crate::law::rate::History;
use crate::law::{FirstPassed, Passed};
use crate::solver::fd::Quantity;
use crate::solver::{EndSample, EndState, Energies};

impl Net {
    /// Iterates over the joints that can open, with the index of the segment to their left.
    pub fn contacts(&self) -> impl Iterator<Item = (usize, &Contact)> {
        self.joints.iter().enumerate().filter_map(|(k, joint)| Some((k, joint.contact()?)))
    }

    /// Returns a quantity in one cell.
    pub fn value(&self, quantity: Quantity, cell: usize) -> f64 {
        let k = self.parts.partition_point(|p| p.cells.end <= cell);
        Self::read(quantity, &self.parts[k], cell - self.parts[k].cells.start)
    }

    /// Writes a quantity in every cell to `out` (one entry per cell).
    pub fn profile(&self, quantity: Quantity, out: &mut [f64]) {
        for part in &self.parts {
            for (i, out) in out[part.cells.clone()].iter_mut().enumerate() {
                *out = Self::read(quantity, part, i);
            }
        }
    }

    fn read(quantity: Quantity, part: &NetSegment, i: usize) -> f64 {
        if quantity == Quantity::Velocity {
            return part.velocity(i);
        }
        let (stress, history, _) = part.cell(i);
        match quantity {
            Quantity::Strain => (stress + history.signed) / part.modulus,
            Quantity::PlasticStrain => history.signed / part.modulus,
            Quantity::AccumulatedPlasticStrain => history.accumulated / part.modulus,
            Quantity::Temperature => f64::NAN,
            Quantity::Stress | Quantity::Velocity => stress,
        }
    }

    /// Static flow stress of a cell, Pa: the stress at which it would rest, in the sense of its present stress.
    pub fn static_stress(&self, cell: usize) -> f64 {
        let k = self.parts.partition_point(|p| p.cells.end <= cell);
        let part = &self.parts[k];
        let (stress, history, _) = part.cell(cell - part.cells.start);
        part.law.limits(&history)[usize::from(stress >= 0.0)]
    }

    /// Displacement of every cell centre, m: that of the left end plus the strain summed up to the cell.
    pub fn displacements(&self) -> Vec<f64> {
        let mut strains = vec![0.0; self.grid.cells()];
        self.profile(Quantity::Strain, &mut strains);
        let mut centres = Vec::with_capacity(strains.len());
        let mut border = self.ends[0].displacement();
        for (k, part) in self.grid.segments.iter().enumerate() {
            for &strain in &strains[part.cells.clone()] {
                let stretch = strain * part.dx;
                centres.push(border + 0.5 * stretch);
                border += stretch;
            }
            border += self.joints.get(k).map_or(0.0, Joint::opened);
        }
        centres
    }

    /// Returns the present state of the left and the right end.
    pub fn ends(&self) -> [EndState; 2] {
        let time = self.time();
        let leaving = |part: &NetSegment, i: usize| super::part::INSIDE * part.flow_of_cell(i).plastic;
        let (first, last) = (&self.parts[0], &self.parts[self.parts.len() - 1]);
        let right_cell = last.f.len() - 1;
        [
            self.ends[0].reading(time, first.g[0] - leaving(first, 0), first),
            self.ends[1].reading(time, last.f[right_cell] - leaving(last, right_cell), last),
        ]
    }

    /// Returns samples of the left and the right end after the latest step.
    pub fn end_samples(&self) -> [EndSample; 2] {
        let [left, right] = self.ends();
        [self.ends[0].sample(self.step, left), self.ends[1].sample(self.step, right)]
    }

    /// Velocity of a striker at the left and the right end, m/s, positive in +x; `None` without a striker.
    pub fn striker_velocities(&self) -> [Option<f64>; 2] {
        [self.ends[0].striker_velocity(), self.ends[1].striker_velocity()]
    }

    /// Work done by the left and the right end so far, J.
    pub fn work(&self) -> [f64; 2] {
        [self.ends[0].work(), self.ends[1].work()]
    }

    /// Impulse of the left and the right end so far, N s, positive in +x.
    pub fn impulse(&self) -> [f64; 2] {
        [self.ends[0].impulse(), self.ends[1].impulse()]
    }

    /// Sum of the magnitudes of all impulses of both ends so far, N s.
    pub fn throughput(&self) -> f64 {
        self.ends[0].throughput() + self.ends[1].throughput()
    }

    /// Mass of the bar, kg, with the transit time of every segment rounded to whole steps.
    pub fn mass(&self) -> f64 {
        self.parts.iter().map(|p| p.area * p.impedance * self.grid.dt * p.f.len() as f64).sum()
    }

    /// Returns energies and momentum at the present time. `plastic` is the work on the static curve (and of back stresses), `viscoplastic` that of
    /// the overstress.
    pub fn energies(&self) -> Energies {
        let dt = self.grid.dt;
        let joints: f64 = self.contacts().map(|(_, contact)| contact.lost()).sum();
        let ends: f64 = self.ends.iter().map(End::lost).sum();
        let mut total = Energies { numerical: joints + ends, ..Energies::default() };
        for part in &self.parts {
            let mut work = part.work;
            let (mut squares, mut speeds, mut momentum) = (0.0, 0.0, 0.0);
            for i in 0..part.f.len() {
                let (stress, _, late) = part.cell(i);
                let velocity = part.velocity(i);
                work.add(late);
                squares += stress * stress;
                speeds += velocity * velocity;
                momentum += velocity;
            }
            // The strain energy of a cell is A dx sigma^2/(2E) with dx/E = dt/Z; its mass is A Z dt.
            let (per_work, mass) = (part.per_work(dt), part.area * part.impedance * dt);
            total.elastic += per_work * squares;
            total.kinetic += 0.5 * mass * speeds;
            total.momentum += mass * momentum;
            total.plastic += per_work * (work.total - work.overstress - work.numerical);
            total.numerical += per_work * work.numerical;
            total.viscoplastic += per_work * work.overstress;
        }
        total
    }

    /// Returns the first cells that reached an end of the data of their law.
    pub fn limits_reached(&self) -> FirstPassed {
        self.passed.clone()
    }

    /// Records the cells that reached an end of their static data in the latest step.
    pub(super) fn note_limits(&mut self) {
        let step = self.step;
        for (segment, part) in self.parts.iter().enumerate() {
            for i in 0..part.f.len() {
                let cell = part.cells.start + i;
                if let Some(reached) = part.reached(i) {
                    self.passed.note(Passed { cell, segment, step, reached });
                }
            }
        }
    }

    /// Returns the first cell whose stress or velocity is not finite.
    pub fn not_finite(&self) -> Option<usize> {
        let bad =
            |p: &NetSegment| p.f.iter().zip(&p.g).position(|(f, g)| !(f + g).is_finite()).map(|i| p.cells.start + i);
        self.parts.iter().find_map(bad)
    }

    /// Returns whether nothing has flowed so far.
    pub fn stayed_elastic(&self) -> bool {
        self.parts.iter().all(|p| p.work.overstress == 0.0 && p.work.total == 0.0)
    }

    /// Memory per cell, bytes: its two travelling waves, and its two nodes with limits and histories.
    pub const BYTES_PER_CELL: usize = 2 * size_of::<f64>() + 2 * (size_of::<History>() + 2 * size_of::<f64>());
}

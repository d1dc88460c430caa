//! The conservative scheme as the recorders read it.

use super::Field;
use super::view::{Account, EndState, Start, Stepped, View, quantity};
use crate::solver::fd::{Grid, Passed, Quantity, Sampling};
use crate::solver::muscl::Muscl;

impl View for Muscl {
    type Places = Sampling;

    fn time(&self) -> f64 {
        self.time()
    }

    fn sample(&self, field: Field, places: &Sampling, out: &mut [f64]) {
        let Some(quantity) = quantity(field) else {
            let centres = self.displacements();
            return places.read(|cell| centres[cell], out);
        };
        if places.is_every_cell() {
            self.profile(quantity, out);
        } else {
            places.read(|cell| self.value(quantity, cell), out);
        }
    }

    fn ends(&self) -> [EndState; 2] {
        self.ends().map(|end| EndState { stress: end.stress, velocity: end.velocity })
    }

    fn strikers(&self) -> [Option<f64>; 2] {
        self.striker_velocities()
    }

    fn start(&self) -> Start {
        let initial = self.energies();
        Start { kinetic: initial.kinetic, momentum: initial.momentum, mass: self.mass() }
    }

    fn account(&self) -> Account {
        let now = self.energies();
        Account {
            kinetic: now.kinetic,
            elastic: now.elastic,
            plastic: now.plastic,
            heat: 0.0,
            viscous: now.viscous,
            concentrated: now.concentrated,
            fracture: 0.0,
            damping: 0.0,
            foundation: 0.0,
            impulse_along: 0.0,
            momentum: now.momentum,
            work: self.work(),
            impulse: self.impulse(),
            momentum_scale: self.throughput(),
        }
    }
}

impl Stepped for Muscl {
    fn grid(&self) -> &Grid {
        self.grid()
    }

    fn step(&self) -> usize {
        self.step()
    }

    fn advance(&mut self) {
        self.advance();
    }

    fn value(&self, quantity: Quantity, cell: usize) -> f64 {
        self.value(quantity, cell)
    }

    fn profile(&self, quantity: Quantity, out: &mut [f64]) {
        self.profile(quantity, out);
    }

    fn stayed_elastic(&self) -> bool {
        self.stayed_elastic()
    }

    fn data_can_end(&self) -> bool {
        self.data_can_end()
    }

    fn passed_end_of_data(&self) -> Option<Passed> {
        self.passed_end_of_data()
    }

    fn not_finite(&self) -> Option<usize> {
        self.not_finite()
    }
}

//! What the recorders read of a simulated bar: one small trait for every solver, and one more for those that go on in
//! equal steps on a grid.

use super::Field;
use crate::law::rupture::Rupture;
use crate::solver::fd::{Grid, Leapfrog, Passed, Quantity, Sampling};

/// A simulated bar at its current time.
pub trait View {
    /// Sample places in the form in which this solver reads them.
    type Places: ?Sized;

    /// Time, s.
    fn time(&self) -> f64;

    /// A field at every place, into `out` (one entry a place).
    fn sample(&self, field: Field, places: &Self::Places, out: &mut [f64]);

    /// The left and the right end now.
    fn ends(&self) -> [EndState; 2];

    /// Velocity of the striker at the left and the right end, m/s; none where there is none.
    fn strikers(&self) -> [Option<f64>; 2] {
        [None; 2]
    }

    /// Where and when the bar broke so far, in order of time.
    fn ruptures(&self) -> &[Rupture] {
        &[]
    }

    /// What the bar started with; asked for once, before the first step.
    fn start(&self) -> Start;

    /// What is in the bar and what came in through its ends, now.
    fn account(&self) -> Account;
}

/// A bar on a grid that goes on in steps of one length.
pub trait Stepped: View<Places = Sampling> {
    /// The grid.
    fn grid(&self) -> &Grid;

    /// Steps so far.
    fn step(&self) -> usize;

    /// One step.
    fn advance(&mut self);

    /// A quantity in one cell.
    fn value(&self, quantity: Quantity, cell: usize) -> f64;

    /// A quantity in every cell, into `out` (one entry a cell).
    fn profile(&self, quantity: Quantity, out: &mut [f64]);

    /// Nothing has yielded so far.
    fn stayed_elastic(&self) -> bool;

    /// Some material's data end, so that [`Stepped::passed_end_of_data`] can find a cell.
    fn data_can_end(&self) -> bool;

    /// A cell that has come to the end of its material's data.
    fn passed_end_of_data(&self) -> Option<Passed>;

    /// The first cell whose stress is not a finite number.
    fn not_finite(&self) -> Option<usize>;
}

/// Stress and velocity of an end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndState {
    /// Pa.
    pub stress: f64,
    /// m/s.
    pub velocity: f64,
}

/// A bar before its first step, with its initial velocities.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Start {
    /// J (per m^2 where the scene gives no area), like all energies here.
    pub kinetic: f64,
    /// N s, positive in +x.
    pub momentum: f64,
    /// kg.
    pub mass: f64,
}

/// Energies and momentum of a bar at a moment, and what its ends gave to it since the start.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Account {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Recoverable strain energy.
    pub elastic: f64,
    /// Plastic work that did not turn into heat.
    pub plastic: f64,
    /// Plastic work that turned into heat.
    pub heat: f64,
    /// Taken by a scheme's damping of ripples.
    pub viscous: f64,
    /// Taken at single points where velocities differ.
    pub concentrated: f64,
    /// Taken by ruptures.
    pub fracture: f64,
    /// Taken by internal and external damping.
    pub damping: f64,
    /// Stored in the foundation.
    pub foundation: f64,
    /// Momentum, positive in +x.
    pub momentum: f64,
    /// Work of the left and the right end.
    pub work: [f64; 2],
    /// Impulse of the left and the right end, positive in +x.
    pub impulse: [f64; 2],
    /// Impulse of what acts along the bar, external damping and a foundation.
    pub impulse_along: f64,
    /// Momentum that has gone through the bar: what a missing one is to be compared with.
    pub momentum_scale: f64,
}

impl Account {
    /// All energy in the bar, dissipated included.
    pub fn total(&self) -> f64 {
        self.kinetic
            + self.elastic
            + self.plastic
            + self.heat
            + self.viscous
            + self.concentrated
            + self.fracture
            + self.damping
            + self.foundation
    }
}

impl View for Leapfrog {
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
        [self.left(), self.right()].map(|d| EndState { stress: d.stress(), velocity: d.velocity() })
    }

    fn strikers(&self) -> [Option<f64>; 2] {
        [self.left(), self.right()].map(|device| device.striker().map(|(velocity, _)| velocity))
    }

    fn ruptures(&self) -> &[Rupture] {
        self.ruptures()
    }

    fn start(&self) -> Start {
        let initial = self.initial();
        Start { kinetic: initial.kinetic, momentum: initial.momentum, mass: self.mass() }
    }

    fn account(&self) -> Account {
        let (now, left, right) = (self.energies(), self.left(), self.right());
        let [impulse_along, throughput_along] = self.impulse_along();
        Account {
            kinetic: now.kinetic,
            elastic: now.elastic,
            plastic: now.plastic,
            heat: now.heat,
            viscous: now.viscous,
            concentrated: now.concentrated,
            fracture: now.fracture,
            damping: now.damping,
            foundation: now.foundation,
            momentum: now.momentum,
            work: [left.work(), right.work()],
            impulse: [left.impulse(), right.impulse()],
            impulse_along,
            momentum_scale: left.throughput() + right.throughput() + throughput_along,
        }
    }
}

impl Stepped for Leapfrog {
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

/// What a grid solver calls a field; none for the displacement, which is summed up from the strain.
pub fn quantity(field: Field) -> Option<Quantity> {
    match field.base() {
        Field::Strain => Some(Quantity::Strain),
        Field::Velocity => Some(Quantity::Velocity),
        Field::PlasticStrain => Some(Quantity::PlasticStrain),
        Field::AccumulatedPlasticStrain => Some(Quantity::AccumulatedPlasticStrain),
        Field::Temperature => Some(Quantity::Temperature),
        Field::Displacement => None,
        _ => Some(Quantity::Stress),
    }
}

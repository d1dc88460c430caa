//! Implementations of [`View`] and [`Stepped`] for the solvers on a grid.

use super::stepped::{Stepped, log_stepwise};
use super::view::{Account, ContactReading, Start, View};
use super::{Field, Traces};
use crate::bar::SuddenLoads;
use crate::bar::joint::Contact;
use crate::law::FirstPassed;
use crate::law::rupture::Rupture;
use crate::solver::fd::{EndNode, Grid, Leapfrog, Quantity, Reader, Sampling, Unresolved};
use crate::solver::muscl::Muscl;
use crate::solver::net::Net;
use crate::solver::{EndSample, EndState};

impl View for Leapfrog {
    type Places = Sampling;

    fn time(&self) -> f64 {
        self.time()
    }

    fn sample(&self, field: Field, places: &Sampling, out: &mut [f64]) {
        sample(self, || self.displacements(), field, places, out);
    }

    fn strains(&self, each: &mut dyn FnMut(f64, f64)) {
        let mut reader = Reader::new(self, Quantity::Strain);
        strains(self.grid(), |cell| reader.value(cell), each);
    }

    fn ends(&self) -> [EndState; 2] {
        [self.left(), self.right()].map(EndNode::reading)
    }

    fn strikers(&self) -> [Option<f64>; 2] {
        [self.left(), self.right()].map(|device| device.striker().map(|(velocity, _)| velocity))
    }

    /// Returns the contacts at joints only: a fracture inside a segment is not a joint.
    fn contacts(&self) -> Vec<ContactReading> {
        let starts = |joint: usize| self.grid().segments.get(joint + 1).map(|part| part.cells.start);
        let at_joints = self.contacts().filter(|contact| starts(contact.joint) == Some(contact.cell));
        at_joints
            .map(|contact| ContactReading { joint: contact.joint, presses: contact.presses, pressed: contact.pressed })
            .collect()
    }

    fn ruptures(&self) -> &[Rupture] {
        self.ruptures()
    }

    fn start(&self) -> Start {
        let initial = self.initial();
        Start { energy: initial.total(), momentum: initial.momentum, mass: self.mass() }
    }

    fn account(&self) -> Account {
        let (now, left, right) = (self.energies(), self.left(), self.right());
        let [impulse_along, throughput_along] = self.impulse_along();
        Account {
            work: [left.work(), right.work()],
            impulse: [left.impulse(), right.impulse()],
            impulse_along,
            momentum_scale: left.throughput() + right.throughput() + throughput_along,
            energies: now,
        }
    }
}

/// Passes the centre and the strain of every cell of a grid to `each`, see [`View::strains`].
fn strains(grid: &Grid, mut strain: impl FnMut(usize) -> f64, each: &mut dyn FnMut(f64, f64)) {
    for part in &grid.segments {
        for cell in part.cells.clone() {
            let [from, to] = part.cell(cell);
            each(part.x0 + 0.5 * (from + to), strain(cell));
        }
    }
}

/// Implements [`View`] for a solver without fracture and without distributed forces.
macro_rules! view_of_whole_bar {
    ($solver:ty) => {
        impl View for $solver {
            type Places = Sampling;

            fn time(&self) -> f64 {
                self.time()
            }

            fn sample(&self, field: Field, places: &Sampling, out: &mut [f64]) {
                sample(self, || self.displacements(), field, places, out);
            }

            fn strains(&self, each: &mut dyn FnMut(f64, f64)) {
                strains(self.grid(), |cell| self.value(Quantity::Strain, cell), each);
            }

            fn ends(&self) -> [EndState; 2] {
                self.ends()
            }

            fn strikers(&self) -> [Option<f64>; 2] {
                self.striker_velocities()
            }

            fn contacts(&self) -> Vec<ContactReading> {
                let reading = |(joint, contact): (usize, &Contact)| ContactReading {
                    joint,
                    presses: contact.presses(),
                    pressed: contact.pressed(),
                };
                self.contacts().map(reading).collect()
            }

            fn start(&self) -> Start {
                let initial = self.energies();
                Start { energy: initial.total(), momentum: initial.momentum, mass: self.mass() }
            }

            fn account(&self) -> Account {
                Account {
                    work: self.work(),
                    impulse: self.impulse(),
                    momentum_scale: self.throughput(),
                    impulse_along: 0.0,
                    energies: self.energies(),
                }
            }
        }
    };
}

view_of_whole_bar!(Net);
view_of_whole_bar!(Muscl);

/// Implements [`Stepped`]; `$more` are the methods in which a solver differs.
macro_rules! stepped {
    ($solver:ty $(, $more:item)*) => {
        impl Stepped for $solver {
            $($more)*

            fn grid(&self) -> &Grid {
                self.grid()
            }

            fn step(&self) -> usize {
                self.step()
            }

            fn advance(&mut self) {
                self.advance();
            }

            fn end_samples(&self) -> [EndSample; 2] {
                self.end_samples()
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

            fn limits_reached(&self) -> FirstPassed {
                self.limits_reached()
            }

            fn not_finite(&self) -> Option<usize> {
                self.not_finite()
            }
        }
    };
}

stepped!(
    Leapfrog,
    fn sudden_loads(&self) -> SuddenLoads {
        self.sudden_loads().clone()
    },
    fn read(&self, quantity: Quantity, places: &Sampling, out: &mut [f64]) {
        let mut reader = Reader::new(self, quantity);
        places.read(|cell| reader.value(cell), out);
    },
    fn unresolved_tension(&self) -> Option<Unresolved> {
        self.unresolved_tension()
    },
    fn advance_by(&mut self, steps: usize) {
        self.advance_by(steps);
    },
    fn watch(&mut self, traces: &Traces) {
        if self.sweeps() {
            self.watch(traces.cells());
        }
    },
    fn advance_logging(&mut self, steps: usize, traces: &mut Traces) {
        if !self.sweeps() {
            return log_stepwise(self, steps, traces);
        }
        let (before, dt) = (self.step(), self.grid().dt);
        self.advance_by(steps);
        traces.add_log(&(before..before + steps).map(|step| (step + 1) as f64 * dt), &self.log());
        self.clear_log();
    }
);
stepped!(
    Net,
    fn sudden_loads(&self) -> SuddenLoads {
        self.sudden_loads().clone()
    }
);
stepped!(
    Muscl,
    fn sudden_loads(&self) -> SuddenLoads {
        self.sudden_loads().clone()
    }
);

/// Samples a field at places of a bar in cells; `displacements` returns the displacements of the cell centres, m.
fn sample(
    bar: &impl Stepped,
    displacements: impl FnOnce() -> Vec<f64>,
    field: Field,
    places: &Sampling,
    out: &mut [f64],
) {
    let Some(quantity) = quantity(field) else {
        let centres = displacements();
        return places.read(|cell| centres[cell], out);
    };
    if places.is_every_cell() {
        bar.profile(quantity, out);
    } else {
        bar.read(quantity, places, out);
    }
}

/// Returns the grid quantity of a field; `None` for the displacement, which is integrated from the strain.
fn quantity(field: Field) -> Option<Quantity> {
    match field {
        Field::Stress | Field::Torque => Some(Quantity::Stress),
        Field::Strain | Field::Twist => Some(Quantity::Strain),
        Field::Velocity | Field::AngularVelocity => Some(Quantity::Velocity),
        Field::PlasticStrain => Some(Quantity::PlasticStrain),
        Field::AccumulatedPlasticStrain => Some(Quantity::AccumulatedPlasticStrain),
        Field::Temperature => Some(Quantity::Temperature),
        Field::Displacement => None,
    }
}

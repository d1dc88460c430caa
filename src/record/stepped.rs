//! Access of the recorders to a bar advanced in equal steps on a grid.

use super::{Traces, View};
use crate::bar::SuddenLoads;
use crate::law::FirstPassed;
use crate::solver::EndSample;
use crate::solver::fd::{Grid, Quantity, Sampling, Unresolved};

/// A bar on a grid with a constant time step.
pub trait Stepped: View<Places = Sampling> {
    /// The grid.
    fn grid(&self) -> &Grid;

    /// Steps so far.
    fn step(&self) -> usize;

    /// One step.
    fn advance(&mut self);

    /// So many steps.
    fn advance_by(&mut self, steps: usize) {
        (0..steps).for_each(|_| self.advance());
    }

    /// Makes ready for [`Stepped::advance_logging`] with these histories.
    fn watch(&mut self, _traces: &Traces) {}

    /// So many steps, each of which is added to the histories.
    fn advance_logging(&mut self, steps: usize, traces: &mut Traces)
    where
        Self: Sized,
    {
        log_stepwise(self, steps, traces);
    }

    /// Adds the current state to every history.
    fn add_to(&self, traces: &mut Traces) {
        traces.add(self.time(), self.end_samples(), |quantity, cell| self.value(quantity, cell));
    }

    /// Exact states of suddenly loaded ends and joints.
    fn sudden_loads(&self) -> SuddenLoads {
        SuddenLoads::default()
    }

    /// Both ends after the latest step.
    fn end_samples(&self) -> [EndSample; 2];

    /// A quantity in one cell.
    fn value(&self, quantity: Quantity, cell: usize) -> f64;

    /// A quantity at some places, into `out` (one entry a place).
    fn read(&self, quantity: Quantity, places: &Sampling, out: &mut [f64]) {
        places.read(|cell| self.value(quantity, cell), out);
    }

    /// A quantity in every cell, into `out` (one entry a cell).
    fn profile(&self, quantity: Quantity, out: &mut [f64]);

    /// Nothing has yielded so far.
    fn stayed_elastic(&self) -> bool;

    /// The cells that have come to a limit of what their law knows, up to now.
    fn passed(&self) -> FirstPassed;

    /// The largest tension that met the criterion of rupture over too few cells to break the bar.
    fn unresolved_tension(&self) -> Option<Unresolved> {
        None
    }

    /// The first cell of which something is not a finite number.
    fn not_finite(&self) -> Option<usize>;
}

/// Takes a bar so many steps on, one by one, and adds each to the histories.
pub(super) fn log_stepwise(bar: &mut impl Stepped, steps: usize, traces: &mut Traces) {
    for _ in 0..steps {
        bar.advance();
        bar.add_to(traces);
    }
}

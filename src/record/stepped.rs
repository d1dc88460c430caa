//! Interface of the recorders to a bar that is advanced in equal steps on a grid.

use super::{Traces, View};
use crate::bar::SuddenLoads;
use crate::law::FirstPassed;
use crate::solver::EndSample;
use crate::solver::fd::{Grid, Quantity, Sampling, Unresolved};

/// Bar on a grid with a constant time step.
pub trait Stepped: View<Places = Sampling> {
    /// Returns the grid.
    fn grid(&self) -> &Grid;

    /// Returns the number of steps so far.
    fn step(&self) -> usize;

    /// Advances the bar by one step.
    fn advance(&mut self);

    /// Advances the bar by a number of steps.
    fn advance_by(&mut self, steps: usize) {
        (0..steps).for_each(|_| self.advance());
    }

    /// Prepares [`Stepped::advance_logging`] with these histories.
    fn watch(&mut self, _traces: &Traces) {}

    /// Advances the bar by a number of steps and adds each of them to the histories.
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

    /// Returns the exact states of suddenly loaded ends and joints.
    fn sudden_loads(&self) -> SuddenLoads {
        SuddenLoads::default()
    }

    /// Returns the states of both ends after the latest step.
    fn end_samples(&self) -> [EndSample; 2];

    /// Returns a quantity in one cell.
    fn value(&self, quantity: Quantity, cell: usize) -> f64;

    /// Writes a quantity at some places into `out` (one entry per place).
    fn read(&self, quantity: Quantity, places: &Sampling, out: &mut [f64]) {
        places.read(|cell| self.value(quantity, cell), out);
    }

    /// Writes a quantity in every cell into `out` (one entry per cell).
    fn profile(&self, quantity: Quantity, out: &mut [f64]);

    /// Returns true if no cell has yielded so far.
    fn stayed_elastic(&self) -> bool;

    /// Returns the first cells that have reached a limit of the data of their material so far.
    fn limits_reached(&self) -> FirstPassed;

    /// Returns the largest tension that met the fracture criterion over too few cells to fracture the bar.
    fn unresolved_tension(&self) -> Option<Unresolved> {
        None
    }

    /// Returns the first cell in which a quantity is not finite.
    fn not_finite(&self) -> Option<usize>;
}

/// Advances a bar step by step and adds each step to the histories.
pub(super) fn log_stepwise(bar: &mut impl Stepped, steps: usize, traces: &mut Traces) {
    for _ in 0..steps {
        bar.advance();
        bar.add_to(traces);
    }
}

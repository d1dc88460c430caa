//! The time loop, which advances a bar from one observation to the next, independent of the solver.

use std::time::Instant;

use crate::record::{Stepped, Traces, View};
use crate::solver::moc::{FrontSegment, FrontTracking, Stopped};

/// A bar that is advanced in time: in steps on a grid, or by events with front tracking.
pub trait Solver: View {
    /// A time as the solver counts it: a step number, or s.
    type Mark: Copy;

    /// Record of the interval between two observations: histories in steps, or segments of fronts.
    type Log;

    /// Advances to a mark, limited by the given work in cell-steps or events. Returns true if the mark is reached.
    ///
    /// # Errors
    /// [`Stopped`] if the bar cannot be advanced.
    fn advance_toward(&mut self, to: Self::Mark, work: u64, log: Option<&mut Self::Log>) -> Result<bool, Stopped>;
}

impl<S: Stepped> Solver for S {
    type Mark = usize;
    type Log = Traces;

    fn advance_toward(&mut self, to: usize, work: u64, log: Option<&mut Traces>) -> Result<bool, Stopped> {
        let most = (work / self.grid().cells() as u64).max(1);
        let steps = (to.saturating_sub(self.step()) as u64).min(most) as usize;
        match log {
            Some(traces) => self.advance_logging(steps, traces),
            None => self.advance_by(steps),
        }
        Ok(self.step() >= to)
    }
}

impl Solver for FrontTracking {
    type Mark = f64;
    type Log = Vec<FrontSegment>;

    fn advance_toward(&mut self, to: f64, work: u64, log: Option<&mut Vec<FrontSegment>>) -> Result<bool, Stopped> {
        let arrived = self.advance_for(to, work);
        if let Some(front_segments) = log {
            front_segments.append(&mut self.take_front_segments());
        }
        arrived
    }
}

/// A bar together with the observers of its simulation.
pub trait Simulation {
    /// The bar's solver.
    type Solver: Solver;

    /// Reason for which a simulation ends early.
    type Error;

    /// Returns the mark of the next observation; `None` at the end.
    fn next(&self) -> Option<<Self::Solver as Solver>::Mark>;

    /// Returns the bar and the log of its motion, if one is kept.
    fn bar(&mut self) -> (&mut Self::Solver, Option<&mut <Self::Solver as Solver>::Log>);

    /// Observes the bar after an interval.
    ///
    /// # Errors
    /// The simulation ends here.
    fn look(&mut self, stretch: Interval) -> Result<(), Self::Error>;
}

/// What the solver did between two observations.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// Computing time of the solver, s.
    pub seconds: f64,
    /// Whether the bar has reached the mark, or the reason why it cannot be advanced.
    pub arrived: Result<bool, Stopped>,
}

/// Simulates a bar up to its end and observes it after every interval of at most the given work (cell-steps, or events).
///
/// # Errors
/// Those of [`Simulation::look`].
pub fn simulate<S: Simulation>(simulation: &mut S, work: u64) -> Result<(), S::Error> {
    while let Some(mark) = simulation.next() {
        let (bar, log) = simulation.bar();
        let before = Instant::now();
        let arrived = bar.advance_toward(mark, work, log);
        simulation.look(Interval { seconds: before.elapsed().as_secs_f64(), arrived })?;
    }
    Ok(())
}

//! Error of a front-tracking run, estimated from companion runs with larger and smaller tolerances.

use super::Response;
use crate::record::{ErrorTable, Measure};
use crate::solver::moc::{COMPANION_RATIO, FrontTracking, Settings};

/// Ratio of the estimate to the difference from a companion. If errors were proportional to the tolerance, the
/// difference from a finer companion would be two thirds of the error, and that from a coarser one twice the error.
/// Actual errors decrease faster or more slowly at random: `docs/front-tolerance.md` contains measurements.
pub const SAFETY_OF_TRACKING: f64 = 1.5;

/// Budget of events of all finer companions: a multiple of the events of the run, and an additional number (some milliseconds).
const EVENTS: u64 = 2;
const FREE_EVENTS: u64 = 5_000;

/// Largest number of finer companions, each with a third of the tolerance of the previous one. Several are needed
/// because a merge that changes a run of few events may occur in the same way at many tolerances.
const MOST_FINER: usize = 6;

/// Relative change of the difference from one finer companion to the next below which the estimate is accepted.
const SETTLED: f64 = 0.2;

/// Differences of a run from its companions.
#[derive(Debug)]
pub struct Companions {
    coarser: ErrorTable,
    finer: Option<(Settings, ErrorTable)>,
}

impl Companions {
    /// Creates the differences from a coarser companion only; `response` is that of the run.
    pub fn coarser(response: &Response, companion: &Response) -> Self {
        Self { coarser: companion.difference(response, response), finer: None }
    }

    /// Adds the finest companion that is expected to stay within a multiple of the run's events, if there is one.
    /// `coarser` is the number of events of the coarser companion. `follow` simulates the bar with other settings and
    /// returns `None` if the simulation does not reach its end.
    ///
    /// # Errors
    /// The errors of `follow`.
    pub fn with_finer<E>(
        mut self,
        (run, response): (&FrontTracking, &Response),
        coarser: u64,
        mut settings: Settings,
        mut follow: impl FnMut(Settings) -> Result<Option<(FrontTracking, Response)>, E>,
    ) -> Result<Self, E> {
        let mut left = settings.event_budget.min(EVENTS * run.events() + FREE_EVENTS);
        let mut events = [coarser, run.events()];
        let mut apart = f64::NAN;
        for _ in 0..MOST_FINER {
            if expected(events) > left as f64 {
                break;
            }
            settings = Settings { event_budget: left, ..settings.finer() };
            let Some((bar, finer)) = follow(settings)? else { break };
            left = left.saturating_sub(bar.events());
            events = [events[1], bar.events()];
            let before = apart;
            let table = response.difference(&finer, response);
            apart = table.largest().map_or(0.0, |largest| largest.1);
            self.finer = Some((settings, table));
            if apart > 0.0 && (apart - before).abs() <= SETTLED * apart {
                break;
            }
        }
        Ok(self)
    }

    /// Returns the settings of the finer companion, if there is one.
    pub fn finer(&self) -> Option<Settings> {
        self.finer.as_ref().map(|finer| finer.0)
    }

    /// Returns the errors of the run with this `response`, >= 0.
    pub fn errors(&self, run: &FrontTracking, response: &Response) -> ErrorTable {
        let merged = || {
            // Companions that merged the same fronts as the run show no difference; the sum of all merges is an upper
            // bound that is too large, but safe.
            let total = response.fields.last().map_or(0.0, |(_, field)| field.l1_difference(field).1);
            if total > 0.0 { run.merged() / total } else { 0.0 }
        };
        ErrorTable::of(|measure| {
            let coarser = self.coarser[measure]?;
            let error = match &self.finer {
                Some((_, finer)) => (SAFETY_OF_TRACKING * finer[measure]?).max(coarser / COMPANION_RATIO),
                None => SAFETY_OF_TRACKING * coarser,
            };
            let of_stress = matches!(measure, Measure::Field | Measure::FieldAtEnd);
            Some(if error == 0.0 && of_stress { merged() } else { error }.max(run.unresolved()))
        })
    }
}

/// Returns the expected number of events of the next finer companion, if it grows as between the last two runs; it seldom decreases.
fn expected([before, last]: [u64; 2]) -> f64 {
    let growth = (last as f64 / before.max(1) as f64).max(1.0);
    last as f64 * growth
}

//! Error of a front-tracking run, estimated from companion runs with larger and smaller tolerances.

use super::Response;
use crate::record::{ErrorTable, Measure};
use crate::solver::moc::{COMPANION_RATIO, FrontTracking, Settings};

/// The estimate, over the difference from a companion. If errors were proportional to the tolerance, the difference from a finer companion
/// would be two thirds of the error, and that from a coarser one twice the error. They fall faster or slower by chance:
/// `docs/front-tolerance.md` has measurements.
pub const SAFETY_OF_TRACKING: f64 = 1.5;

/// Events that finer companions may take: so many times those of the run, and so many more (some milliseconds).
const EVENTS: u64 = 2;
const FREE_EVENTS: u64 = 5_000;

/// Finer companions at most, each with a third of the tolerance of the one before. A merge that changes a run of few events may be made
/// with many tolerances in the same way.
const MOST_FINER: usize = 6;

/// The last companion tells the error where one more changed the difference by no more than this part.
const SETTLED: f64 = 0.2;

/// Differences of a run from its companions.
#[derive(Debug)]
pub struct Companions {
    coarser: ErrorTable,
    finer: Option<(Settings, ErrorTable)>,
}

impl Companions {
    /// A coarser companion alone, of the run that gave `response`.
    pub fn coarser(response: &Response, companion: &Response) -> Self {
        Self { coarser: companion.apart(response, response), finer: None }
    }

    /// Adds the finest companion that a multiple of the run's events is expected to pay for, if there is one. `coarser` is the number of
    /// events of the coarser one; `follow` simulates the bar with other settings, and gives none where it does not come to its end.
    ///
    /// # Errors
    /// Those of `follow`.
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
            let table = response.apart(&finer, response);
            apart = table.largest().map_or(0.0, |largest| largest.1);
            self.finer = Some((settings, table));
            if apart > 0.0 && (apart - before).abs() <= SETTLED * apart {
                break;
            }
        }
        Ok(self)
    }

    /// The settings of the finer companion, if there is one.
    pub fn finer(&self) -> Option<Settings> {
        self.finer.as_ref().map(|finer| finer.0)
    }

    /// Errors of the run that gave `response`, >= 0.
    pub fn errors(&self, run: &FrontTracking, response: &Response) -> ErrorTable {
        let merged = || {
            // Companions that merged just what the run did tell nothing; the sum of all merges is too much, but no less.
            let total = response.fields.last().map_or(0.0, |(_, field)| field.apart(field).1);
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

/// Events of the next finer companion, if they grow from run to run as they did between the last two; they seldom fall.
fn expected([before, last]: [u64; 2]) -> f64 {
    let growth = (last as f64 / before.max(1) as f64).max(1.0);
    last as f64 * growth
}

//! Error of a front-tracking run, estimated from a companion run with a coarser tolerance.

use super::Response;
use crate::record::{ErrorTable, Measure};
use crate::solver::moc::{FrontTracking, SAFETY};

/// Errors of a tracked bar that gave `response`, >= 0: [`SAFETY`] times the differences from a companion with [`COARSER`] times its
/// tolerance.
///
/// [`COARSER`]: crate::solver::moc::COARSER
pub fn front_errors(run: &FrontTracking, response: &Response, companion: &Response) -> ErrorTable {
    let apart = companion.apart(response, response);
    let merged = || {
        // A companion that merged just what the run did tells nothing; the sum of all merges is too much, but no less.
        let total = response.fields.last().map_or(0.0, |(_, field)| field.apart(field).1);
        if total > 0.0 { run.merged() / total } else { 0.0 }
    };
    let stress = [Measure::Field, Measure::FieldAtEnd];
    ErrorTable::of(|measure| {
        let apart = apart[measure]?;
        let error = if apart == 0.0 && stress.contains(&measure) { merged() } else { SAFETY * apart };
        Some(error.max(run.unresolved()))
    })
}

//! The points of a study, and the skipped ones.

use serde::Serialize;

use super::source::Resolution;
use crate::record::{ErrorTable, SolvedBy};

/// One method at one resolution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostPoint {
    /// Method and resolution.
    #[serde(flatten)]
    pub by: SolvedBy,
    /// Error in the measure of the study.
    pub error: f64,
    /// Errors in all measures.
    pub errors: ErrorTable,
    /// Median stepping time, s.
    pub step_wall_s: f64,
    /// Shortest stepping time, s: least affected by other load of the machine.
    pub shortest_s: f64,
    /// Interquartile range of the stepping times relative to their median; 0 for a single run.
    pub spread: f64,
    /// Number of timed runs.
    pub repetitions: usize,
    /// Time of the whole process, from its start to the finished result file, s; null if it was not measured.
    pub whole_wall_s: Option<f64>,
    /// Number of cell-steps or events.
    pub work: u64,
    /// "cell-steps" or "events".
    pub work_unit: &'static str,
    /// Solver memory, bytes.
    pub memory_bytes: u64,
    /// Whether no other point is both faster and more accurate.
    pub pareto: bool,
    /// Whether the error is below the uncertainty of the reference.
    pub below_reference: bool,
    /// For front tracking: whether no wave was merged, so that the result is exact for the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<bool>,
}

/// A point that was not run or did not finish.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Skipped {
    /// Method and resolution.
    #[serde(flatten)]
    pub by: SolvedBy,
    /// Expected time with all repetitions, s.
    pub expected_s: Option<f64>,
    /// Reason why the point was skipped.
    pub why: String,
}

impl CostPoint {
    /// Returns the resolution of the point.
    pub fn resolution(&self) -> Resolution {
        match (self.by.front_tolerance, self.by.cells) {
            (Some(tolerance), _) => Resolution::FrontTolerance(tolerance),
            (None, cells) => Resolution::Cells(cells.unwrap_or(0)),
        }
    }

    /// Creates a point with only its resolution, error and stepping time.
    #[cfg(test)]
    pub(crate) fn plain(method: &str, resolution: Resolution, error: f64, step_wall_s: f64) -> Self {
        let scheme = if matches!(resolution, Resolution::Cells(_)) { "leapfrog" } else { "front-tracking" };
        Self {
            by: resolution.solved_by([method, scheme]),
            error,
            errors: ErrorTable::default(),
            step_wall_s,
            shortest_s: step_wall_s,
            spread: 0.0,
            repetitions: 1,
            whole_wall_s: None,
            work: 0,
            work_unit: "cell-steps",
            memory_bytes: 0,
            pareto: false,
            below_reference: false,
            exact: None,
        }
    }
}

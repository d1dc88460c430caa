//! What a study found: points, what was left out, and what follows from them.

use serde::Serialize;

use super::effects::EffectCost;
use super::growth::Growth;
use super::judge::{self, OrderFit, Reach, TOLERANCES};
use super::source::Resolution;
use crate::record::{ErrorTable, SolvedBy};

/// The study of a scene. Keys are those of `barwave cost --json`.
#[derive(Debug, Clone, Serialize)]
pub struct Cost {
    /// Scene title.
    pub scene: String,
    /// What errors are measured against.
    pub reference: String,
    /// Difference of the two finest references in the same measure, or rounding where the reference is exact.
    pub reference_uncertainty: f64,
    /// What `error` is.
    pub measure: &'static str,
    /// One a method and resolution, method by method, coarse to fine.
    pub points: Vec<CostPoint>,
    /// Observed order of each scheme, null where there is none.
    pub orders: serde_json::Map<String, serde_json::Value>,
    /// How these were found.
    pub order_fits: Vec<OrderFit>,
    /// The cheapest way to each tolerance.
    pub cheapest: Vec<Reach>,
    /// Every method's way to each tolerance.
    pub reach: Vec<Reach>,
    /// What each effect adds.
    pub effects: Vec<EffectCost>,
    /// How time and memory grow.
    pub growth: Vec<Growth>,
    /// What was left out, and why.
    pub skipped: Vec<Skipped>,
    /// Methods that cannot do the scene, and why.
    pub unable: Vec<Unable>,
    /// Time that the study was given, s.
    pub budget_s: f64,
    /// Time that it took, s.
    pub wall_s: f64,
    /// Load of the machine (processes that want to run, mean of a minute) before and after; null where unknown.
    pub load: [Option<f64>; 2],
    /// Threads that a long bar may take.
    pub threads: usize,
    /// The user stopped it.
    pub interrupted: bool,
}

/// One method at one resolution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostPoint {
    /// By what.
    #[serde(flatten)]
    pub by: SolvedBy,
    /// Error in the measure of the study.
    pub error: f64,
    /// Errors in all measures.
    pub errors: ErrorTable,
    /// Median stepping time, s.
    pub step_wall_s: f64,
    /// Shortest stepping time, s: what is left where the machine has other work too.
    pub shortest_s: f64,
    /// Distance of the quartiles of the stepping times over their median; 0 for a single run.
    pub spread: f64,
    /// Runs that were timed.
    pub repetitions: usize,
    /// Time of the whole process, from its start to the finished result file, s; null where it was not measured.
    pub whole_wall_s: Option<f64>,
    /// Cell-steps or events.
    pub work: u64,
    /// "cell-steps" or "events".
    pub work_unit: &'static str,
    /// Solver memory, bytes.
    pub memory_bytes: u64,
    /// Nothing is both quicker and better.
    pub pareto: bool,
    /// The error is below what the reference is uncertain by: it says no more than that.
    pub below_reference: bool,
    /// Front tracking only: no wave was merged, so that the result is exact for the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<bool>,
}

/// A point that was not run, or came to no end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Skipped {
    /// By what.
    #[serde(flatten)]
    pub by: SolvedBy,
    /// Expected time with all repetitions, s.
    pub expected_s: Option<f64>,
    /// Why.
    pub why: String,
}

/// A method that cannot do the scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Unable {
    /// "fd" or "moc".
    pub method: String,
    /// The scheme, where the method has several.
    pub scheme: Option<String>,
    /// Why.
    pub why: String,
}

impl CostPoint {
    /// Its resolution.
    pub fn resolution(&self) -> Resolution {
        match (self.by.front_tolerance, self.by.cells) {
            (Some(tolerance), _) => Resolution::FrontTolerance(tolerance),
            (None, cells) => Resolution::Cells(cells.unwrap_or(0)),
        }
    }

    /// A point with nothing but its resolution, error and stepping time.
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

impl Cost {
    /// Schemes in the order of the points, each with its points and their indices.
    pub fn schemes(&self) -> Vec<(&str, Vec<(usize, &CostPoint)>)> {
        let mut schemes: Vec<(&str, Vec<(usize, &CostPoint)>)> = Vec::new();
        for (k, point) in self.points.iter().enumerate() {
            match schemes.iter_mut().find(|s| s.0 == point.by.scheme) {
                Some(scheme) => scheme.1.push((k, point)),
                None => schemes.push((&point.by.scheme, vec![(k, point)])),
            }
        }
        schemes
    }

    /// What follows from the points.
    pub(super) fn judge(&mut self) {
        let uncertainty = self.reference_uncertainty;
        let pareto = judge::pareto(&self.points, uncertainty);
        for (point, pareto) in self.points.iter_mut().zip(pareto) {
            point.pareto = pareto;
        }
        let (mut orders, mut fits, mut reaches) = (serde_json::Map::new(), Vec::new(), Vec::new());
        for (scheme, points) in self.schemes() {
            let alone: Vec<&CostPoint> = points.iter().map(|p| p.1).collect();
            let fit = judge::order(&alone, uncertainty);
            orders.insert(scheme.into(), fit.as_ref().map(|f| f.order).into());
            fits.extend(fit);
            reaches.extend(TOLERANCES.map(|tolerance| judge::reach(&points, tolerance, uncertainty)));
        }
        self.cheapest = TOLERANCES.map(|tolerance| judge::cheapest(&reaches, tolerance)).into();
        (self.orders, self.order_fits, self.reach) = (orders, fits, reaches);
    }
}

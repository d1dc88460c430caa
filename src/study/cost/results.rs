//! Results of a study: its points, the skipped points, and their evaluation.

use serde::Serialize;

use super::effects::EffectCost;
use super::growth::Growth;
use super::judge::{self, CostToTolerance, OrderFit, TOLERANCES};
use super::points::{CostPoint, Skipped};
use super::source::Unable;

/// Results of the study of a scene. Keys are those of `barwave cost --json`.
#[derive(Debug, Clone, Serialize)]
pub struct Cost {
    /// Scene title.
    pub scene: String,
    /// Reference against which errors are measured.
    pub reference: String,
    /// Uncertainty of the reference in the same measure: from its finest runs, from the contradiction by another method, or rounding if the reference
    /// is exact.
    pub reference_uncertainty: f64,
    /// Definition of `error`.
    pub measure: &'static str,
    /// One point per method and resolution, ordered by method, coarse to fine.
    pub points: Vec<CostPoint>,
    /// Observed order of each scheme, null if there is none.
    pub orders: serde_json::Map<String, serde_json::Value>,
    /// Fits of these orders.
    pub order_fits: Vec<OrderFit>,
    /// Cheapest method for each tolerance.
    pub cheapest: Vec<CostToTolerance>,
    /// Cost of each method for each tolerance.
    pub reach: Vec<CostToTolerance>,
    /// Additional cost of each effect.
    pub effects: Vec<EffectCost>,
    /// Growth of time and memory.
    pub growth: Vec<Growth>,
    /// Skipped points, and the reasons.
    pub skipped: Vec<Skipped>,
    /// Methods that do not support the scene, and the reasons.
    pub unable: Vec<Unable>,
    /// Time budget of the study, s.
    pub budget_s: f64,
    /// Duration of the study, s.
    pub wall_s: f64,
    /// Load of the machine (mean number of runnable processes over a minute) before and after the study; null if unknown.
    pub load: [Option<f64>; 2],
    /// Number of threads available to a long bar.
    pub threads: usize,
    /// Whether the user stopped the study.
    pub interrupted: bool,
}

impl Cost {
    /// Returns the schemes in the order of the points, each with its points and their indices.
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

    /// Evaluates the points: Pareto front, orders, and the cost of each tolerance.
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

//! `barwave cost` for impacts without waves in a bar.

use std::fmt::Write as _;

use super::output;
use crate::study::impact_cost::{ImpactCost, ImpactOrder, ImpactPoint};

/// Returns the points as CSV, one row each.
pub(super) fn csv(cost: &ImpactCost) -> String {
    let mut text = String::from("varied,modes,tolerance,steps,error,wall_s\n");
    for p in &cost.points {
        let modes = p.modes.map_or_else(String::new, |m| m.to_string());
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{},{modes},{},{},{},{}", p.varied, p.tolerance, p.steps, p.error, p.wall_s);
    }
    text
}

/// Returns all results as text.
pub(super) fn text(cost: &ImpactCost) -> String {
    let row = |p: &ImpactPoint| {
        vec![
            p.varied.to_owned(),
            p.modes.map_or_else(|| "-".into(), |m| m.to_string()),
            format!("{:.0e}", p.tolerance),
            p.steps.to_string(),
            format!("{:.2e}", p.error),
            format!("{:.3}", 1e3 * p.wall_s),
        ]
    };
    let rows: Vec<_> = cost.points.iter().map(row).collect();
    let table = output::table(&["varied", "modes", "tolerance", "steps", "error", "wall ms"], &rows, 1, false);
    let line = |o: &ImpactOrder| format!("order in {}: {:.2}, over {} points\n", o.varied, o.order, o.points);
    let orders = cost.orders.iter().map(line).collect::<Vec<_>>().concat();
    let mut text =
        format!("{}\n\nerror: {},\n  against {}\n\n{table}\n{orders}", cost.scene, cost.measure, cost.reference);
    if cost.interrupted {
        text += "interrupted: the results so far\n";
    }
    text
}

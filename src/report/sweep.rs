//! Figure of a sweep: its metrics against the axis with the most values.

use serde_json::Value;

use super::drawing::Picture;
use super::grid::{Panel, draw, stroke};
use super::panel::Series;
use crate::study::sweep::{Combine, Plan, Row};

/// Metrics that are drawn where the sweep file names none.
const USUAL: [&str; 8] = [
    "left.peak_force_N",
    "left.peak_stress_Pa",
    "right.peak_force_N",
    "right.peak_stress_Pa",
    "largest_plastic_strain",
    "permanent_elongation_m",
    "energy_absorbed_J",
    "left.restitution",
];

/// Most panels.
const MOST: usize = 6;

/// Each metric that is a number in two cases at least, against the longest axis of numbers, with a line for every combination of the others.
/// None where there is nothing to draw. SVG text.
pub fn figure(plan: &Plan, rows: &[Row]) -> Option<Picture> {
    let numbers = |k: &usize| plan.axes[*k].levels.iter().all(|level| level.si.is_some());
    let along = (0..plan.axes.len()).rev().filter(numbers).max_by_key(|k| plan.axes[*k].levels.len())?;
    let axis = &plan.axes[along];
    let label = if axis.unit.is_empty() { axis.key.clone() } else { format!("{} ({})", axis.key, axis.unit) };
    let usual = || USUAL.map(str::to_owned).to_vec();
    let metrics = if plan.metrics.is_empty() { usual() } else { plan.metrics.clone() };
    let panel = |metric: &String| {
        let series = lines(plan, rows, along, metric);
        // A figure that is zero in all cases, such as the force at a free end, is drawn only where it is asked for.
        if plan.metrics.is_empty() && series.iter().flat_map(|line| &line.points).all(|point| point.1 == 0.0) {
            return None;
        }
        let heading = metric.clone();
        (!series.is_empty()).then(|| Panel { heading, axes: [label.clone(), metric.clone()], series })
    };
    let panels: Vec<Panel> = metrics.iter().filter_map(panel).take(MOST).collect();
    (!panels.is_empty()).then(|| draw(&plan.title, &panels))
}

/// One line for each combination of the other axes. Axes of numbers that vary beside the first one are none.
fn lines(plan: &Plan, rows: &[Row], along: usize, metric: &str) -> Vec<Series> {
    let mut lines: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    for row in rows {
        let levels = plan.levels(row.case);
        let others = levels.iter().enumerate().filter(|(k, level)| {
            *k != along && plan.axes[*k].levels.len() > 1 && (plan.combine == Combine::Product || level.si.is_none())
        });
        let name = others.map(|(_, level)| level.typed.trim_matches('"')).collect::<Vec<_>>().join(", ");
        let value = row.metrics.get(metric).and_then(Value::as_f64);
        let (Some(x), Some(y)) = (levels[along].si, value) else { continue };
        match lines.iter_mut().find(|line| line.0 == name) {
            Some(line) => line.1.push((x, y)),
            None => lines.push((name, vec![(x, y)])),
        }
    }
    if lines.iter().all(|line| line.1.len() < 2) {
        return Vec::new();
    }
    let series = |(i, (name, mut points)): (usize, (String, Vec<(f64, f64)>))| {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Series::line(name, points, stroke(i))
    };
    lines.into_iter().enumerate().map(series).collect()
}

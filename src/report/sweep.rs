//! Figure of a sweep: its metrics against the axis with the most values.

use serde_json::Value;

use super::display::{Unit, Units};
use super::drawing::{Picture, Stroke};
use super::grid::{DASHES, Panel, draw_from};
use super::panel::Series;
use super::plot::colour;
use crate::study::sweep::{Combine, Plan, Row, unit_of};

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

/// Words that first name the metrics which are drawn of an impact without waves, whose figures are its own.
const TELLING: [&str; 5] = ["peak", "largest", "restitution", "duration", "permanent"];

/// Each metric that is a number in two cases at least, against the longest axis of numbers, with a line for every combination of the others.
/// None where there is nothing to draw. SVG text.
pub fn figure(title: &str, plan: &Plan, rows: &[Row]) -> Option<Picture> {
    let numbers = |k: &usize| plan.axes[*k].levels.iter().all(|level| level.si.is_some());
    let along = (0..plan.axes.len()).rev().filter(numbers).max_by_key(|k| plan.axes[*k].levels.len())?;
    let panels: Vec<Panel> =
        metrics(plan, rows).iter().filter_map(|metric| panel(plan, rows, along, metric)).take(MOST).collect();
    (!panels.is_empty()).then(|| draw_from(title, &panels, None))
}

/// Those of the sweep file, else the usual ones of bars, else all numbers.
fn metrics(plan: &Plan, rows: &[Row]) -> Vec<String> {
    let has = |name: &str| rows.iter().any(|row| row.metrics.get(name).is_some_and(Value::is_number));
    if !plan.metrics.is_empty() {
        return plan.metrics.clone();
    }
    if USUAL.iter().any(|name| has(name)) {
        return USUAL.map(str::to_owned).to_vec();
    }
    let mut all: Vec<String> = rows.first().map_or_else(Vec::new, |row| row.metrics.keys().cloned().collect());
    all.retain(|name| has(name));
    all.sort_by_key(|name| !TELLING.iter().any(|word| name.contains(word)));
    all
}

fn panel(plan: &Plan, rows: &[Row], along: usize, metric: &str) -> Option<Panel> {
    let mut lines = lines(plan, rows, along, metric);
    let values = || lines.iter().flat_map(|line| &line.1).map(|point| point.1);
    values().next()?;
    // A figure that is zero in all cases, such as the force at a free end, is drawn only where it is asked for.
    if plan.metrics.is_empty() && values().all(|value| value == 0.0) {
        return None;
    }
    let axis = &plan.axes[along];
    let points = || lines.iter().flat_map(|line| &line.1);
    let x = unit(&axis.unit, points().map(|point| point.0));
    let y = unit(unit_of(metric), points().map(|point| point.1));
    let (heading, words) = spoken(metric);
    let axes = [x.label(&axis.key), y.label(&words)];
    for point in lines.iter_mut().flat_map(|line| &mut line.1) {
        *point = (x.factor * point.0, y.factor * point.1);
    }
    Some(Panel { heading, axes, series: lines.into_iter().enumerate().flat_map(series).collect() })
}

/// The unit to show values in.
fn unit(symbol: &str, values: impl Iterator<Item = f64>) -> Unit {
    let most = values.fold(0.0, |most: f64, value| most.max(value.abs()));
    Units::Si.of_symbol(&symbol.replace(' ', "*"), most)
}

/// The name of a metric in words, with its place for headings and without it for axes: `left.peak_force_N` is "left end: peak force".
fn spoken(metric: &str) -> (String, String) {
    let unit = format!("_{}", unit_of(metric).replace([' ', '/'], "_").replace('^', ""));
    let name = metric.strip_suffix(&unit).unwrap_or(metric);
    let (place, name) = name.rsplit_once('.').unwrap_or(("", name));
    let words = name.replace('_', " ");
    let place = match place.split_once('.').unwrap_or((place, "")) {
        ("", _) => return (words.clone(), words),
        (end @ ("left" | "right"), "") => format!("{end} end"),
        (kind @ ("joints" | "segments" | "gauges"), which) => format!("{} {which}", kind.trim_end_matches('s')),
        _ => place.replace(['.', '_'], " "),
    };
    (format!("{place}: {words}"), words)
}

/// A line of the figure, and its points.
type Named = (String, Vec<(f64, f64)>);

/// One line for each combination of the other axes. Axes of numbers that vary beside the first one are none.
fn lines(plan: &Plan, rows: &[Row], along: usize, metric: &str) -> Vec<Named> {
    let mut lines: Vec<Named> = Vec::new();
    for row in rows {
        let levels = plan.levels(row.case);
        let others = levels.iter().enumerate().filter(|(k, level)| {
            *k != along && plan.axes[*k].levels.len() > 1 && (plan.combine == Combine::Product || level.si.is_none())
        });
        let name = others.map(|(k, level)| format!("{} = {}", plan.axes[k].key, level.typed.trim_matches('"')));
        let name = name.collect::<Vec<_>>().join(", ");
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
    for line in &mut lines {
        line.1.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    lines
}

/// A line and a mark for each case: lines that coincide differ by their dashes.
fn series((i, (name, points)): (usize, Named)) -> [Series; 2] {
    let stroke = Stroke::new(colour(i), 1.6);
    let line = Series::line(name, points.clone(), stroke.clone().dashed(DASHES[i % DASHES.len()]));
    [line, Series::marks("", points, stroke)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metrics_are_spoken() {
        for (metric, heading, words) in [
            ("left.peak_force_N", "left end: peak force", "peak force"),
            ("joints.2.impulse_N_s", "joint 2: impulse", "impulse"),
            ("permanent_elongation_m", "permanent elongation", "permanent elongation"),
            ("segments.1.final_length_ratio", "segment 1: final length ratio", "final length ratio"),
            ("ledger.energy_residual", "ledger: energy residual", "energy residual"),
        ] {
            assert_eq!(spoken(metric), (heading.to_owned(), words.to_owned()));
        }
    }
}

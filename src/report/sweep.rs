//! Figure of a sweep: its metrics against the axis with the most values.

use std::collections::HashSet;

use serde_json::Value;

use super::display::{Unit, Units};
use super::drawing::{Picture, RUPTURE, Stroke};
use super::grid::{Across, DASHES, Panel, draw_along};
use super::panel::Series;
use super::plot::colour;
use super::results::{place_name, words};
use crate::record::{dimension_of, without_unit};
use crate::study::sweep::{Axis, Combine, Plan, Row, Status};

/// Metrics that are drawn by default if the sweep file names none.
const USUAL: [&str; 11] = [
    "left.peak_force_N",
    "left.peak_torque_N_m",
    "left.peak_stress_Pa",
    "right.peak_force_N",
    "right.peak_torque_N_m",
    "right.peak_stress_Pa",
    "largest_plastic_strain",
    "permanent_elongation_m",
    "permanent_twist_rad",
    "energy_absorbed_J",
    "left.restitution",
];

/// Largest number of panels.
const MOST: usize = 6;

/// Words in the names of the metrics that are drawn first for impacts without waves in a bar, which have figures of their own.
const TELLING: [&str; 5] = ["peak", "largest", "restitution", "duration", "permanent"];

/// Parts of the names of metrics that are drawn last: those of places, of the first of several contacts, and of an estimate.
const LESS_TELLING: [&str; 3] = [".", "first_contact_", "half_sine_"];

/// Draws each metric that is numeric in at least two cases against the numeric axis with the most values, with one line for every combination
/// of values of the other axes. Returns `None` if there is nothing to draw.
pub fn figure(title: &str, plan: &Plan, rows: &[Row]) -> Option<Picture> {
    let along = (0..plan.axes.len())
        .rev()
        .filter(|&k| has_numbers(&plan.axes[k]))
        .max_by_key(|k| plan.axes[*k].levels.len())?;
    let mut panels: Vec<Panel> =
        metrics(plan, rows).iter().filter_map(|metric| panel(plan, rows, along, metric)).take(MOST).collect();
    tell_apart(&mut panels);
    let axis = &plan.axes[along];
    let is_positive = axis.levels.iter().all(|level| level.si.is_some_and(|si| si > 0.0));
    let across = if axis.logarithmic && is_positive { Across::Logarithmic } else { Across::AroundValues };
    (!panels.is_empty()).then(|| draw_along(title, &panels, across))
}

/// Adds the units to headings of several panels that are the same without: "capacity (kJ)" and "capacity (MJ/m^3)".
fn tell_apart(panels: &mut [Panel]) {
    let headings: Vec<String> = panels.iter().map(|panel| panel.heading.clone()).collect();
    for panel in panels {
        if headings.iter().filter(|heading| **heading == panel.heading).count() > 1 {
            panel.heading.clone_from(&panel.axes[1]);
        }
    }
}

/// Returns true if all values of the axis are numbers.
fn has_numbers(axis: &Axis) -> bool {
    axis.levels.iter().all(|level| level.si.is_some())
}

/// Returns the metrics of the sweep file, otherwise the default ones for bars, otherwise all numeric ones.
fn metrics(plan: &Plan, rows: &[Row]) -> Vec<String> {
    let has = |name: &str| rows.iter().any(|row| row.metrics.get(name).is_some_and(Value::is_number));
    if !plan.metrics.is_empty() {
        return plan.metrics.clone();
    }
    if USUAL.iter().any(|name| has(name)) {
        return USUAL.map(str::to_owned).to_vec();
    }
    // The names are those of all rows, since a failed case has no metrics.
    let mut seen = HashSet::new();
    let names = rows.iter().flat_map(|row| row.metrics.keys());
    let mut all: Vec<String> = names.filter(|name| seen.insert(name.as_str())).cloned().collect();
    all.retain(|name| has(name));
    let has_one_of = |name: &str, words: &[&str]| words.iter().any(|word| name.contains(word));
    all.sort_by_key(|name| (!has_one_of(name, &TELLING), has_one_of(name, &LESS_TELLING)));
    all
}

fn panel(plan: &Plan, rows: &[Row], along: usize, metric: &str) -> Option<Panel> {
    let mut lines = lines(plan, rows, along, metric);
    let values = || lines.iter().flat_map(|line| &line.1).map(|point| point.1);
    values().next()?;
    // A metric that is zero in all cases, such as the force at a free end, is drawn only if the sweep file names it.
    if plan.metrics.is_empty() && values().all(|value| value == 0.0) {
        return None;
    }
    let broken = rows.iter().filter(|row| row.status == Status::Rupture);
    let mut broken: Vec<_> = broken.filter_map(|row| point(plan, row, along, metric)).collect();
    let axis = &plan.axes[along];
    let points = || lines.iter().flat_map(|line| &line.1);
    let x = unit(&axis.unit, points().map(|point| point.0));
    let y = unit(dimension_of(metric).si_symbol(), points().map(|point| point.1));
    let heading = spoken(metric);
    let axes = [x.label(&spoken_key(&axis.key, &axis.unit)) + &varied_with(plan, along), y.label(&heading)];
    for point in lines.iter_mut().flat_map(|line| &mut line.1).chain(&mut broken) {
        *point = (x.factor * point.0, y.factor * point.1);
    }
    let ordered = axis.levels.is_sorted_by_key(|level| level.si) || axis.levels.iter().rev().is_sorted_by_key(|l| l.si);
    let mut drawn: Vec<Series> = lines.into_iter().enumerate().flat_map(|line| series(line, ordered)).collect();
    if !broken.is_empty() {
        drawn.push(Series::marks("bar fractured", broken, Stroke::new(RUPTURE, 1.6)));
    }
    Some(Panel { heading, axes, series: drawn })
}

/// Returns a phrase that names the other numeric axes that vary together with the drawn one; empty for a full product.
fn varied_with(plan: &Plan, along: usize) -> String {
    let varies = |k: &usize| {
        let axis = &plan.axes[*k];
        *k != along && plan.combine != Combine::Product && axis.levels.len() > 1 && has_numbers(axis)
    };
    let others = (0..plan.axes.len()).filter(varies).map(|k| spoken_key(&plan.axes[k].key, &plan.axes[k].unit));
    match &others.collect::<Vec<_>>()[..] {
        [] => String::new(),
        others => format!(", each with its {}", others.join(" and ")),
    }
}

/// Returns the unit in which values are shown.
fn unit(symbol: &str, values: impl Iterator<Item = f64>) -> Unit {
    let most = values.fold(0.0, |most: f64, value| most.max(value.abs()));
    Units::Si.of_symbol(symbol, most)
}

/// Returns the name of a metric in words: `left.peak_force_N` is "peak force at the left end".
fn spoken(metric: &str) -> String {
    let name = without_unit(metric.strip_prefix("figures.").unwrap_or(metric));
    let (place, name) = name.rsplit_once('.').unwrap_or(("", name));
    let words = words(name);
    match place.split_once('.').unwrap_or((place, "")) {
        ("", _) => words,
        (end @ ("left" | "right"), "") => format!("{words} at the {}", place_name(end, "")),
        (kind @ ("joints" | "gauges"), which) => format!("{words} at {}", place_name(kind, which)),
        (kind @ ("segments" | "fragments"), which) => format!("{words} of {}", place_name(kind, which)),
        _ => format!("{words} ({})", place.replace(['.', '_'], " ")),
    }
}

/// Returns a scene key in words: `left.value` of a velocity is "velocity of the left end", `bar.length` is "bar length".
fn spoken_key(key: &str, unit: &str) -> String {
    let words = |text: &str| text.replace(['.', '-', '_'], " ");
    let (place, name) = key.rsplit_once('.').unwrap_or(("", key));
    match (place, name) {
        ("left" | "right", "value") if unit == "m/s" => format!("velocity of the {place} end"),
        ("left" | "right", "value") => format!("{} at the {place} end", if unit == "Pa" { "stress" } else { "value" }),
        ("left" | "right" | "striker", "velocity") => "impact velocity".into(),
        ("left" | "right", _) => format!("{} at the {place} end", words(name)),
        ("" | "solve" | "effects" | "record", _) | (_, "material") => words(name),
        _ => words(key),
    }
}

/// Returns a value as it is written in the sweep file, a plain number with the SI unit of its axis; a material file by its name without folder and
/// ending.
fn spoken_value(typed: &str, unit: &str) -> String {
    if typed.parse::<f64>().is_ok() {
        return format!("{typed} {}", unit.replace(' ', "\u{b7}")).trim_end().to_owned();
    }
    let text = typed.trim_matches('"');
    let file = std::path::Path::new(text);
    let is_file = file.extension().is_some_and(|ending| ending == "toml");
    file.file_stem().and_then(std::ffi::OsStr::to_str).filter(|_| is_file).unwrap_or(text).to_owned()
}

/// Name of a line, and its points.
type Named = (String, Vec<(f64, f64)>);

/// Returns the point of a case: its value on the axis and that of the metric. `None` if either is not a number.
fn point(plan: &Plan, row: &Row, along: usize, metric: &str) -> Option<(f64, f64)> {
    Some((plan.levels(row.case)[along].si?, row.metrics.get(metric)?.as_f64()?))
}

/// Returns one line for each combination of values of the other axes. Numeric axes that vary together with the drawn one do not count. Empty if
/// no line has two points.
fn lines(plan: &Plan, rows: &[Row], along: usize, metric: &str) -> Vec<Named> {
    let mut lines: Vec<Named> = Vec::new();
    for row in rows {
        let Some(point) = point(plan, row, along, metric) else { continue };
        let levels = plan.levels(row.case).into_iter().zip(&plan.axes).enumerate();
        let others = levels.filter(|(k, (level, axis))| {
            *k != along && axis.levels.len() > 1 && (plan.combine == Combine::Product || level.si.is_none())
        });
        let name = others.map(|(_, (level, axis))| {
            format!("{} {}", spoken_key(&axis.key, &axis.unit), spoken_value(&level.typed, &axis.unit))
        });
        let name = name.collect::<Vec<_>>().join(", ");
        match lines.iter_mut().find(|line| line.0 == name) {
            Some(line) => line.1.push(point),
            None => lines.push((name, vec![point])),
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

/// Returns a line with a mark for each case if there are at most 40; only marks if the values have no order, such as random samples. Lines
/// differ in their dash patterns, so that coincident ones remain visible.
fn series((i, (name, points)): (usize, Named), ordered: bool) -> Vec<Series> {
    const FEW: usize = 40;
    let stroke = Stroke::new(colour(i), 1.6);
    if !ordered {
        return vec![Series::marks(name, points, stroke)];
    }
    let marks = (points.len() <= FEW).then(|| Series::marks("", points.clone(), stroke.clone()));
    let line = Series::line(name, points, stroke.dashed(DASHES[i % DASHES.len()]));
    std::iter::once(line).chain(marks).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metrics_are_spoken() {
        for (metric, words) in [
            ("left.peak_force_N", "peak force at the left end"),
            ("joints.2.impulse_N_s", "impulse at joint 2"),
            ("permanent_elongation_m", "permanent elongation"),
            ("peak_moment_N_m", "peak moment"),
            ("contact_area_m2", "contact area"),
            ("energy_density_J_m3", "energy density"),
            ("segments.1.final_length_ratio", "final length ratio of segment 1"),
            ("ledger.energy_residual", "energy residual (ledger)"),
        ] {
            assert_eq!(spoken(metric), words);
        }
    }

    #[test]
    fn equal_headings_get_their_units() {
        let panel = |heading: &str, unit: &str| {
            let label = format!("{heading} ({unit})");
            Panel { heading: heading.into(), axes: [String::new(), label], series: Vec::new() }
        };
        let mut panels = [panel("capacity", "kJ"), panel("largest force", "kN"), panel("capacity", "MJ/m^3")];
        tell_apart(&mut panels);
        let headings = panels.map(|panel| panel.heading);
        assert_eq!(headings, ["capacity (kJ)", "largest force", "capacity (MJ/m^3)"]);
    }

    #[test]
    fn keys_are_spoken() {
        for (key, unit, words) in [
            ("left.value", "m/s", "velocity of the left end"),
            ("right.value", "Pa", "stress at the right end"),
            ("striker.velocity", "m/s", "impact velocity"),
            ("left.mass", "kg", "mass at the left end"),
            ("bar.length", "m", "bar length"),
            ("bar.material", "", "material"),
            ("solve.cells", "", "cells"),
        ] {
            assert_eq!(spoken_key(key, unit), words);
        }
        for (typed, unit, words) in [
            ("\"../a b.toml\"", "", "a b"),
            ("\"0.5 m\"", "m", "0.5 m"),
            ("12.5", "kg", "12.5 kg"),
            ("3", "N s/m", "3 N\u{b7}s/m"),
            ("400", "", "400"),
        ] {
            assert_eq!(spoken_value(typed, unit), words);
        }
    }
}

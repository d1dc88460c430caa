//! Output of `barwave run` and `barwave plan` for impacts without waves in a bar.

use super::lines::Lines;
use super::summary::note_lines;
use crate::impact::{Line, Solution};
use crate::record::{ImpactPlan, ImpactSummary};
use crate::units::{System, format};

/// Returns the summary as text.
pub(super) fn text(s: &ImpactSummary, units: System) -> String {
    let mut lines = Lines::under(&s.scene);
    lines.add("outcome", s.solution.outcome);
    add(&mut lines, s.method, &s.solution, units);
    if !s.output.is_empty() {
        lines.add("result", &s.output);
    }
    lines.text()
}

/// Returns the plan as text.
pub(super) fn plan_text(p: &ImpactPlan, units: System) -> String {
    let mut lines = Lines::under(&p.scene);
    add(&mut lines, p.method, &p.solution, units);
    lines.text()
}

/// Adds the lines that plans and summaries share.
fn add(lines: &mut Lines, method: &str, solution: &Solution, units: System) {
    lines.add("method", std::format!("{method} {}", solution.scheme));
    lines.add("equation", &solution.equation);
    lines.add("validity", &solution.validity);
    for line in &solution.lines {
        lines.add(line.label, filled(line, units));
    }
    lines.extend(note_lines(&solution.warnings, units));
}

/// Returns the text of a line with its values inserted.
fn filled(line: &Line, units: System) -> String {
    let mut parts = line.text.split("{}");
    let mut text = parts.next().unwrap_or_default().to_owned();
    let mut values = line.values.iter();
    for part in parts {
        text += &values.next().map_or_else(String::new, |(value, dimension)| format(*value, *dimension, units));
        text += part;
    }
    text
}

//! Output of `barwave run` and `barwave plan` for impacts without waves in a bar.

use super::lines::Lines;
use super::summary::note_lines;
use crate::impact::Line;
use crate::record::ImpactSummary;
use crate::units::{System, format};

/// The summary for people.
pub(super) fn text(s: &ImpactSummary, units: System) -> String {
    let mut lines = Lines::under(&s.scene);
    let solution = &s.solution;
    if !s.output.is_empty() {
        lines.add("outcome", solution.outcome);
    }
    lines.add("method", std::format!("{} {}", s.method, solution.scheme));
    lines.add("equation", &solution.equation);
    lines.add("validity", &solution.validity);
    for line in &solution.lines {
        lines.add(line.label, filled(line, units));
    }
    lines.extend(note_lines(&solution.warnings, units));
    if !s.output.is_empty() {
        lines.add("result", &s.output);
    }
    lines.text()
}

/// The text with its values in their places.
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

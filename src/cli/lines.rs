//! Text output: a heading and labelled lines.

use std::fmt::Display;

/// Lines of the text.
pub(super) struct Lines(Vec<String>);

impl Lines {
    pub(super) fn under(heading: &str) -> Self {
        Self(vec![heading.to_owned()])
    }

    pub(super) fn add(&mut self, label: &str, value: impl Display) {
        let gap = if label.len() < 18 { "" } else { "  " };
        self.0.push(format!("  {label:<18}{gap}{value}"));
    }

    /// Appends lines that have a layout of their own.
    pub(super) fn extend(&mut self, lines: impl IntoIterator<Item = String>) {
        self.0.extend(lines);
    }

    pub(super) fn text(self) -> String {
        self.0.join("\n") + "\n"
    }
}

//! Results of an impact without waves in a bar: figures, histories and notes, for every kind.

use crate::units::Dimension;

/// A number of the result.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of the dataset.
    pub name: &'static str,
    /// Name in the summary; its unit follows it there.
    pub key: &'static str,
    /// What it is measured in.
    pub dimension: Dimension,
    /// What it is.
    pub long_name: &'static str,
    /// SI; NaN where there is none.
    pub value: f64,
    /// It counts something: an integer in the summary.
    pub is_count: bool,
}

impl Figure {
    /// With one name in file and summary.
    pub fn new(name: &'static str, dimension: Dimension, long_name: &'static str, value: f64) -> Self {
        Self { name, key: name, dimension, long_name, value, is_count: false }
    }

    /// A number of things.
    pub fn count(name: &'static str, long_name: &'static str, count: usize) -> Self {
        Self { is_count: true, ..Self::new(name, Dimension::None, long_name, count as f64) }
    }

    /// Key in the summary: `peak_force` and N give "`peak_force_N`".
    pub fn json_key(&self) -> String {
        let unit = self.dimension.si_symbol().replace(['/', '*'], "_").replace('^', "");
        if unit.is_empty() { self.key.to_owned() } else { format!("{}_{unit}", self.key) }
    }

    /// Value in the summary.
    pub fn json_value(&self) -> serde_json::Value {
        if self.is_count { (self.value as u64).into() } else { self.value.into() }
    }
}

/// A column of a table; all are equally long.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name of the dataset.
    pub name: &'static str,
    /// What it is measured in.
    pub dimension: Dimension,
    /// What it is.
    pub long_name: &'static str,
    /// Title of the panel of a report that shows it, with the others of this title; empty: none does.
    pub panel: &'static str,
    /// SI.
    pub values: Vec<f64>,
}

impl Column {
    /// Without values.
    pub fn new(name: &'static str, dimension: Dimension, long_name: &'static str, panel: &'static str) -> Self {
        Self { name, dimension, long_name, panel, values: Vec::new() }
    }

    /// The time, for the first column of a table.
    pub fn time() -> Self {
        Self::new("time", Dimension::Time, "time since the first contact", "")
    }
}

type Name = &'static str;

/// Columns over the first of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Path of the group below that of the kind, such as "gauges/middle".
    pub path: String,
    /// The first labels the others.
    pub columns: Vec<Column>,
    /// Where it is on the body, m.
    pub x: Option<f64>,
}

impl Table {
    /// Without rows.
    pub fn new(path: impl Into<String>, columns: Vec<Column>) -> Self {
        Self { path: path.into(), columns, x: None }
    }

    /// Columns over time: name, dimension, long name and panel of each.
    pub fn over_time<const N: usize>(path: impl Into<String>, columns: [(Name, Dimension, Name, Name); N]) -> Self {
        let columns = columns.map(|(name, dimension, long_name, panel)| Column::new(name, dimension, long_name, panel));
        Self::new(path, std::iter::once(Column::time()).chain(columns).collect())
    }

    /// An energy ledger: name and long name of each part, and the residual of their sum.
    pub fn ledger<const N: usize>(parts: [(Name, Name); N]) -> Self {
        let mut ledger =
            Self::over_time("ledger", parts.map(|(name, long_name)| (name, Dimension::Energy, long_name, "energy")));
        let long_name = "relative change of the energy since the start";
        ledger.columns.push(Column::new("residual", Dimension::None, long_name, ""));
        ledger
    }

    /// Adds a value to every column.
    pub fn push(&mut self, row: &[f64]) {
        self.columns.iter_mut().zip(row).for_each(|(column, value)| column.values.push(*value));
    }

    /// The column of this name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|column| column.name == name).map(|column| &column.values[..])
    }

    /// The same of a table that has it.
    pub(super) fn own(&self, name: &str) -> &[f64] {
        self.column(name).unwrap_or_default()
    }
}

/// Deflections over a length at several times.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shapes {
    /// s.
    pub time: Vec<f64>,
    /// m.
    pub x: Vec<f64>,
    /// m, a row a time.
    pub deflection: Vec<f64>,
}

/// A line of the summary: each "{}" of the text stands for the next value.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// What it is about.
    pub label: &'static str,
    /// The sentence.
    pub text: String,
    /// SI.
    pub values: Vec<(f64, Dimension)>,
}

impl Line {
    /// A sentence with its values.
    pub fn new(label: &'static str, text: impl Into<String>, values: &[(f64, Dimension)]) -> Self {
        Self { label, text: text.into(), values: values.to_vec() }
    }
}

/// A ratio with so many significant digits, zeros at the end included; with an exponent where it is very small.
pub(super) fn ratio(value: f64, digits: usize) -> String {
    let magnitude = value.abs().log10().floor();
    if magnitude < -4.0 && value != 0.0 {
        return format!("{value:.*e}", digits - 1);
    }
    let before = if magnitude.is_finite() { magnitude + 1.0 } else { 1.0 };
    format!("{value:.*}", (digits as f64 - before).max(0.0) as usize)
}

/// The result of an impact.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// "done", "rupture" where something breaks, "interrupted", or "not-converged" where the error exceeds the tolerance.
    pub outcome: &'static str,
    /// How it was solved, as "hertz".
    pub scheme: &'static str,
    /// The equations that were used, with their numbers.
    pub equation: String,
    /// For what these hold.
    pub validity: String,
    /// Where the scene leaves their range, a sentence each.
    pub warnings: Vec<String>,
    /// Numbers.
    pub figures: Vec<Figure>,
    /// Figures at gauges: name of the gauge, then its figures.
    pub gauges: Vec<(String, Vec<Figure>)>,
    /// Yes or no, by name.
    pub flags: Vec<(&'static str, bool)>,
    /// Histories.
    pub tables: Vec<Table>,
    /// Deflected shapes, if there are any.
    pub shapes: Option<Shapes>,
    /// The summary for people.
    pub lines: Vec<Line>,
}

impl Default for Solution {
    fn default() -> Self {
        Self {
            outcome: "done",
            scheme: "",
            equation: String::new(),
            validity: String::new(),
            warnings: Vec::new(),
            figures: Vec::new(),
            gauges: Vec::new(),
            flags: Vec::new(),
            tables: Vec::new(),
            shapes: None,
            lines: Vec::new(),
        }
    }
}

impl Solution {
    /// Outcome of an integration that was asked to stop before its end.
    pub const INTERRUPTED: &'static str = "interrupted";
    /// The outcome of a study of the error that ends above its tolerance.
    pub const NOT_CONVERGED: &'static str = "not-converged";

    /// The histories end before the end of the impact.
    pub fn is_interrupted(&self) -> bool {
        self.outcome == Self::INTERRUPTED
    }

    /// A figure by its name, as in the result file (`peak_force`) or as in the summary (`peak_force_N`); none where it has no value.
    pub fn figure(&self, name: &str) -> Option<f64> {
        let found = self.figures.iter().find(|figure| figure.name == name || figure.json_key() == name);
        found.map(|figure| figure.value).filter(|value| !value.is_nan())
    }

    /// Adds a figure, with its line of the summary where it has a value.
    pub fn add(&mut self, label: &'static str, figure: Figure) {
        let line = Line::new(label, "{}", &[(figure.value, figure.dimension)]);
        self.lines.extend(figure.value.is_finite().then_some(line));
        self.figures.push(figure);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_have_significant_digits() {
        for (value, text) in [
            (2.0, "2.00"),
            (0.305_4, "0.305"),
            (0.001_234_5, "0.00123"),
            (3.2e-7, "3.20e-7"),
            (0.0, "0.00"),
            (1234.5, "1234"),
        ] {
            assert_eq!(ratio(value, 3), text);
        }
    }
}

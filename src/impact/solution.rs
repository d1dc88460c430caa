//! Results of an impact without waves in a bar, the same for every kind: figures, histories and notes.

use crate::units::Dimension;

/// A scalar result.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of the dataset.
    pub name: &'static str,
    /// Name in the summary, where its unit follows.
    pub key: &'static str,
    /// Dimension of the value.
    pub dimension: Dimension,
    /// Description.
    pub long_name: &'static str,
    /// Value, SI; NaN if there is none.
    pub value: f64,
    /// Whether it counts something; it is then an integer in the summary.
    pub is_count: bool,
}

impl Figure {
    /// Creates a figure with the same name in file and summary.
    pub fn new(name: &'static str, dimension: Dimension, long_name: &'static str, value: f64) -> Self {
        Self { name, key: name, dimension, long_name, value, is_count: false }
    }

    /// Creates a figure that counts something.
    pub fn count(name: &'static str, long_name: &'static str, count: usize) -> Self {
        Self { is_count: true, ..Self::new(name, Dimension::None, long_name, count as f64) }
    }

    /// Returns the key in the summary: `peak_force` and N give "`peak_force_N`".
    pub fn json_key(&self) -> String {
        let unit = self.dimension.si_symbol().replace(['/', '*'], "_").replace('^', "");
        if unit.is_empty() { self.key.to_owned() } else { format!("{}_{unit}", self.key) }
    }

    /// Returns the value in the summary.
    pub fn json_value(&self) -> serde_json::Value {
        if self.is_count { (self.value as u64).into() } else { self.value.into() }
    }
}

/// A column of a table; all columns have the same length.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name of the dataset.
    pub name: &'static str,
    /// Dimension of the values.
    pub dimension: Dimension,
    /// Description.
    pub long_name: &'static str,
    /// Title of the panel of a report that shows it, together with the other columns of this title; empty if it is not shown.
    pub panel: &'static str,
    /// Values, SI.
    pub values: Vec<f64>,
}

impl Column {
    /// Creates a column without values.
    pub fn new(name: &'static str, dimension: Dimension, long_name: &'static str, panel: &'static str) -> Self {
        Self { name, dimension, long_name, panel, values: Vec::new() }
    }

    /// Creates the time column, the first column of a table.
    pub fn time() -> Self {
        Self::new("time", Dimension::Time, "time since the first contact", "")
    }
}

type Name = &'static str;

/// Columns as functions of the first one.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Path of the group below that of the kind of impact, such as "gauges/middle".
    pub path: String,
    /// The columns; the first labels the others.
    pub columns: Vec<Column>,
    /// Position on the body, m.
    pub x: Option<f64>,
}

impl Table {
    /// Creates a table without rows.
    pub fn new(path: impl Into<String>, columns: Vec<Column>) -> Self {
        Self { path: path.into(), columns, x: None }
    }

    /// Creates a table over time: name, dimension, long name and panel of each column.
    pub fn over_time<const N: usize>(path: impl Into<String>, columns: [(Name, Dimension, Name, Name); N]) -> Self {
        let columns = columns.map(|(name, dimension, long_name, panel)| Column::new(name, dimension, long_name, panel));
        Self::new(path, std::iter::once(Column::time()).chain(columns).collect())
    }

    /// Creates an energy ledger: name and long name of each part, and the residual of their sum.
    pub fn ledger<const N: usize>(parts: [(Name, Name); N]) -> Self {
        let mut ledger =
            Self::over_time("ledger", parts.map(|(name, long_name)| (name, Dimension::Energy, long_name, "energy")));
        let long_name = "relative change of the energy since the start";
        ledger.columns.push(Column::new("residual", Dimension::None, long_name, ""));
        ledger
    }

    /// Appends a row, one value per column.
    pub fn push(&mut self, row: &[f64]) {
        self.columns.iter_mut().zip(row).for_each(|(column, value)| column.values.push(*value));
    }

    /// Returns the values of the column of this name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|column| column.name == name).map(|column| &column.values[..])
    }

    /// Returns the values of a column that the table is known to have.
    pub(super) fn own(&self, name: &str) -> &[f64] {
        self.column(name).unwrap_or_default()
    }
}

/// Deflections over a length at several times.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shapes {
    /// Times, s.
    pub time: Vec<f64>,
    /// Positions, m.
    pub x: Vec<f64>,
    /// Deflections, m, one row per time.
    pub deflection: Vec<f64>,
}

/// A line of the summary: each "{}" of the text is replaced by the next value.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Label.
    pub label: &'static str,
    /// Text.
    pub text: String,
    /// Values, SI.
    pub values: Vec<(f64, Dimension)>,
}

impl Line {
    /// Creates a line from its text and values.
    pub fn new(label: &'static str, text: impl Into<String>, values: &[(f64, Dimension)]) -> Self {
        Self { label, text: text.into(), values: values.to_vec() }
    }
}

/// Formats a ratio with this number of significant digits, including trailing zeros; with an exponent if it is very small.
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
    /// Outcome: "done", "rupture" if a specimen breaks, "interrupted", or "not-converged" if the error exceeds the tolerance.
    pub outcome: &'static str,
    /// Method of solution, such as "hertz".
    pub scheme: &'static str,
    /// The equations that were used, with their numbers.
    pub equation: String,
    /// Range of validity of the equations.
    pub validity: String,
    /// Warnings where the scene is outside this range, one sentence each.
    pub warnings: Vec<String>,
    /// Scalar results.
    pub figures: Vec<Figure>,
    /// Figures at gauges: name of the gauge, then its figures.
    pub gauges: Vec<(String, Vec<Figure>)>,
    /// Yes-or-no results, by name.
    pub flags: Vec<(&'static str, bool)>,
    /// Histories.
    pub tables: Vec<Table>,
    /// Deflected shapes, if there are any.
    pub shapes: Option<Shapes>,
    /// Lines of the summary for people.
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
    /// Outcome of an integration that was interrupted.
    pub const INTERRUPTED: &'static str = "interrupted";
    /// Outcome of a convergence study that ends above its tolerance.
    pub const NOT_CONVERGED: &'static str = "not-converged";

    /// Whether the histories end before the end of the impact.
    pub fn is_interrupted(&self) -> bool {
        self.outcome == Self::INTERRUPTED
    }

    /// Returns a figure by its name in the result file (`peak_force`) or in the summary (`peak_force_N`); `None` if it has no value.
    pub fn figure(&self, name: &str) -> Option<f64> {
        let found = self.figures.iter().find(|figure| figure.name == name || figure.json_key() == name);
        found.map(|figure| figure.value).filter(|value| !value.is_nan())
    }

    /// Adds a figure, and its line of the summary if it has a value.
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

//! Material files of imported records.

use std::fmt::Write as _;

use crate::material::{Beyond, Measure, Scatter, Sense};

/// Contents of a material file.
#[derive(Debug, Clone)]
pub struct MaterialText<'a> {
    /// Short name.
    pub name: &'a str,
    /// Description, one line.
    pub description: &'a str,
    /// Density as typed: a number in SI, or with a unit.
    pub density: &'a str,
    /// Modulus, Pa; `None`: the steepest slope of the rows.
    pub modulus: Option<f64>,
    /// Whether the rows are engineering or true values.
    pub measure: Measure,
    /// Sense of loading in the test.
    pub sense: Sense,
    /// Behaviour after the last row.
    pub beyond: Beyond,
    /// Rows (strain, stress in Pa).
    pub rows: &'a [(f64, f64)],
    /// Scatter of repeated tests.
    pub scatter: Option<&'a Scatter>,
    /// Comment lines: contents of the record, and how it was reduced.
    pub comments: &'a [String],
    /// Publication or report; `None`: the file says that it is missing.
    pub citation: Option<&'a str>,
    /// What was measured.
    pub measured: &'a str,
}

impl MaterialText<'_> {
    /// Returns the text of the file.
    pub fn toml(&self) -> String {
        let mut text = String::new();
        for comment in self.comments {
            text += &["# ", comment, "\n"].concat();
        }
        let mut line = |key: &str, value: String| text += &[key, " = ", &value, "\n"].concat();
        line("name", quote(self.name));
        line("description", quote(self.description));
        line("density", number(self.density));
        if let Some(modulus) = self.modulus {
            line("modulus", quote(&format!("{} GPa", exact(modulus / 1e9))));
        }
        line("measure", quote(if self.measure == Measure::True { "true" } else { "engineering" }));
        line("sense", quote(self.sense.name()));
        line("beyond", quote(beyond(self.beyond)));
        text += &["\n[curve]\nunit = \"MPa\"\ntable = [\n", &table(self.rows), "]\n"].concat();
        if let Some(scatter) = self.scatter {
            text += &band(scatter);
        }
        text += "\n[source]\n";
        let (citation, confidence) = match self.citation {
            Some(citation) => (["citation = ", &quote(citation), "\n"].concat(), "confidence = \"measured\"\n"),
            None => ("# To be added: citation = \"who, where, when\" and confidence = \"measured\".\n".into(), ""),
        };
        text += &[&citation, "measured = ", &quote(self.measured), "\n", confidence].concat();
        text
    }
}

/// Returns the text of `[band]` and its tests.
fn band(scatter: &Scatter) -> String {
    let mut text = format!(
        "\n# Scatter of the tests: standard deviation of the stress against strain, and the curve of each test. Runs ignore it.\n\
         [band]\nunit = \"MPa\"\ndeviation = [\n{}]\n",
        table(&scatter.deviation)
    );
    for test in &scatter.tests {
        let rows: Vec<_> = test.curve.strain().iter().copied().zip(test.curve.stress().iter().copied()).collect();
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "\n[[band.test]]\nrecord = {}\nmodulus = {}\nbeyond = {}\ntable = [\n{}]\n",
            quote(&test.record),
            quote(&format!("{} GPa", exact(test.modulus / 1e9))),
            quote(beyond(test.curve.beyond())),
            table(&rows)
        );
    }
    text
}

/// Formats rows of strain and stress in MPa, four to a line.
fn table(rows: &[(f64, f64)]) -> String {
    let row = |&(strain, stress): &(f64, f64)| format!("[{}, {}]", strain, exact(stress / 1e6));
    let line = |four: &[(f64, f64)]| ["  ", &four.iter().map(row).collect::<Vec<_>>().join(", "), ",\n"].concat();
    rows.chunks(4).map(line).collect()
}

/// Formats a modulus or a stress with all its digits, but without the rounding error of a unit: rows on one line stay on it, and none is steeper
/// than the modulus.
fn exact(value: f64) -> String {
    let rounded = |digits: usize| format!("{value:.digits$e}").parse::<f64>().ok();
    let same = |rounded: &f64| (rounded / value - 1.0).abs() <= 2.0 * f64::EPSILON;
    (9..16).filter_map(rounded).find(same).unwrap_or(value).to_string()
}

fn beyond(beyond: Beyond) -> &'static str {
    match beyond {
        Beyond::Rupture => "rupture",
        Beyond::Extend => "extend",
        Beyond::Error => "error",
    }
}

/// Keeps a plain number; anything else is quoted as text with a unit.
fn number(typed: &str) -> String {
    if typed.trim().parse::<f64>().is_ok_and(f64::is_finite) { typed.trim().to_owned() } else { quote(typed) }
}

fn quote(text: &str) -> String {
    toml_edit::Value::from(text).to_string()
}

//! Material files of imported records.

use std::fmt::Write as _;

use crate::material::{Beyond, Measure, Scatter, Sense};

/// What a material file states.
#[derive(Debug, Clone)]
pub struct MaterialText<'a> {
    /// Short name.
    pub name: &'a str,
    /// Description, one line.
    pub description: &'a str,
    /// As typed: SI, or a number with a unit.
    pub density: &'a str,
    /// Pa; none: the steepest slope of the rows.
    pub modulus: Option<f64>,
    /// Whether the rows are engineering or true ones.
    pub measure: Measure,
    /// Sense of loading in the test.
    pub sense: Sense,
    /// Behaviour past the last row.
    pub beyond: Beyond,
    /// (strain, stress in Pa).
    pub rows: &'a [(f64, f64)],
    /// Scatter of repeated tests.
    pub scatter: Option<&'a Scatter>,
    /// What the record says and how it was reduced: comment lines.
    pub comments: &'a [String],
    /// The publication or report; none: the file says that it is missing.
    pub citation: Option<&'a str>,
    /// What was measured.
    pub measured: &'a str,
}

impl MaterialText<'_> {
    /// The text of the file.
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

/// `[band]` and its tests.
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

/// Rows of strain and MPa, four to a line.
fn table(rows: &[(f64, f64)]) -> String {
    let row = |&(strain, stress): &(f64, f64)| format!("[{}, {}]", strain, exact(stress / 1e6));
    let line = |four: &[(f64, f64)]| ["  ", &four.iter().map(row).collect::<Vec<_>>().join(", "), ",\n"].concat();
    rows.chunks(4).map(line).collect()
}

/// A modulus or a stress in as many digits as it has, without the rounding of a unit: rows on one line stay on it, and none is steeper than the modulus.
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

/// A plain number stays one; anything else is text with a unit.
fn number(typed: &str) -> String {
    if typed.trim().parse::<f64>().is_ok_and(f64::is_finite) { typed.trim().to_owned() } else { quote(typed) }
}

fn quote(text: &str) -> String {
    toml_edit::Value::from(text).to_string()
}

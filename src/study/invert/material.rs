//! Material files with inverted curves.

use std::fmt::Write as _;

/// What a material file states beside its curve.
#[derive(Debug, Clone)]
pub struct MaterialText<'a> {
    /// Name of the material.
    pub name: &'a str,
    /// One line.
    pub description: &'a str,
    /// kg/m^3.
    pub density: f64,
    /// Pa, where known.
    pub modulus: Option<f64>,
    /// "tension" or "compression".
    pub sense: &'a str,
    /// What was measured, and how the curve follows from it.
    pub measured: &'a str,
}

/// A knot of a curve, magnitudes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredKnot {
    /// Engineering strain.
    pub strain: f64,
    /// Engineering stress, Pa.
    pub stress: f64,
    /// Its 95 % interval, Pa.
    pub interval: [f64; 2],
}

/// The text of a material file with this curve, strain strictly increasing from above 0.
pub fn material_text(material: &MaterialText<'_>, knots: &[MeasuredKnot]) -> String {
    let quote = |text: &str| toml_edit::Value::from(text).to_string();
    let mut text = String::new();
    let mut line = |key: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{key} = {value}");
    };
    line("name", quote(material.name));
    line("description", quote(material.description));
    line("density", format!("{:?}", material.density));
    if let Some(modulus) = material.modulus {
        line("modulus", format!("{modulus:?}"));
    }
    line("measure", quote("engineering"));
    line("sense", quote(material.sense));
    line("beyond", quote("error"));
    text += "\n[curve]\n# strain, stress in Pa; 95 % interval of the stress\ntable = [\n";
    for MeasuredKnot { strain, stress, interval: [low, high] } in knots {
        let _ = writeln!(text, "    [{strain:e}, {stress:e}],  # {low:.4e} to {high:.4e}");
    }
    text += "]\n\n[source]\ncitation = \"\"\n";
    let _ = writeln!(text, "measured = {}\nconfidence = \"measured\"", quote(material.measured));
    text
}

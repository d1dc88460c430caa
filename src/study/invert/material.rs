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

/// The text of a material file with this curve: knots (strain, stress in Pa, half of the 95 % interval in Pa), magnitudes, strain strictly
/// increasing from above 0.
pub fn material_text(material: &MaterialText<'_>, knots: &[(f64, f64, f64)]) -> String {
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
    for (strain, stress, half) in knots {
        let _ = writeln!(text, "    [{strain:e}, {stress:e}],  # +- {half:.2e}");
    }
    text += "]\n\n[source]\ncitation = \"\"\n";
    let _ = writeln!(text, "measured = {}\nconfidence = \"measured\"", quote(material.measured));
    text
}

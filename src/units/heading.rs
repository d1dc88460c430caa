//! Units in the headings of columns, which instruments write in more ways than scenes do.

use super::{Dimension, one};

/// Units that instruments write in other capitalization.
const OTHER_CASE: [&str; 10] = ["MPa", "GPa", "kPa", "ksi", "psi", "kN", "lbf", "kip", "mm", "in"];

/// Returns the SI value of 1 in the unit of a heading, with or without brackets.
///
/// # Errors
/// The unit does not have this dimension.
pub(crate) fn in_heading(unit: &str, dimension: Dimension) -> Result<f64, String> {
    let unit = unit.trim().trim_matches(['(', ')', '[', ']']).trim();
    let of_strain = if dimension == Dimension::None { strain(unit) } else { None };
    of_strain.map_or_else(|| one(&spelled(unit), dimension), Ok)
}

/// Returns the value of units that have a meaning only for strains.
fn strain(unit: &str) -> Option<f64> {
    // The micro sign and the Greek letter mu look alike.
    let unit = unit.to_lowercase().replace(['\u{b5}', '\u{3bc}'], "u");
    match unit.as_str() {
        "-" | "1" => Some(1.0),
        "\u{2030}" | "1e-3" | "10^-3" | "millistrain" | "millistrains" | "mstrain" | "m\u{3b5}" => Some(1e-3),
        "microstrain" | "microstrains" | "ustrain" | "ue" | "u\u{3b5}" => Some(1e-6),
        _ => None,
    }
}

/// Returns the usual spelling of a unit as instruments write it: square millimetres as `mm2`, the kilopond, other capitalization.
fn spelled(unit: &str) -> String {
    let unit = unit.strip_suffix("m2").map_or_else(|| unit.to_owned(), |start| format!("{start}m^2"));
    let unit = match unit.split_once('/') {
        Some(("kp", area)) => format!("kgf/{area}"),
        _ if unit == "kp" => "kgf".to_owned(),
        _ => unit,
    };
    // "mPa" is a millipascal and is not read as "MPa".
    let capitals =
        OTHER_CASE.iter().find(|known| **known != unit && known.eq_ignore_ascii_case(&unit) && unit != "mPa");
    capitals.map_or(unit, |known| (*known).to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_in_the_spellings_of_machines() {
        let (stress, force, strain) = (Dimension::Stress, Dimension::Force, Dimension::None);
        for (unit, dimension, expected) in [
            ("kp/mm2", stress, 9.806_65e6),
            ("kp/mm\u{b2}", stress, 9.806_65e6),
            ("kgf/mm2", stress, 9.806_65e6),
            ("kgf/cm2", stress, 9.806_65e4),
            ("N/mm2", stress, 1e6),
            ("kN/mm2", stress, 1e9),
            ("Mpa", stress, 1e6),
            ("mpa", stress, 1e6),
            ("KSI", stress, 6.894_757_293_168_361e6),
            ("[MPa]", stress, 1e6),
            ("kp", force, 9.806_65),
            ("KN", force, 1e3),
            ("\u{2030}", strain, 1e-3),
            ("mm/m", strain, 1e-3),
            ("millistrain", strain, 1e-3),
            ("mstrain", strain, 1e-3),
            ("m\u{3b5}", strain, 1e-3),
            ("Microstrain", strain, 1e-6),
            ("\u{b5}\u{3b5}", strain, 1e-6),
            ("\u{3bc}m/m", strain, 1e-6),
            ("%", strain, 1e-2),
            ("-", strain, 1.0),
        ] {
            let found = in_heading(unit, dimension).unwrap_or_else(|error| panic!("{unit}: {error}"));
            assert!((found / expected - 1.0).abs() < 1e-12, "{unit}: {found}");
        }
        assert_eq!(in_heading("mPa", stress), Ok(1e-3));
        assert!(in_heading("furlong", stress).is_err() && in_heading("mm", strain).is_err());
    }
}

//! Units in the headings of columns, which instruments write in more ways than scenes do.

use super::parse::is_like_unit;
use super::{Dimension, one};

/// Splits a heading such as `Force [kN]`, `stress_MPa`, `Strain (%)`, `Load, N`, `stress/MPa`, `time us` or `Strain%` into name and unit, which is empty
/// if there is none. Text in brackets at the end is always a unit. After another separator only a word that looks like a unit is one: it can be a part
/// of the name. A unit of another quantity counts, too, so that it is refused.
pub(crate) fn split(heading: &str) -> (&str, &str) {
    let heading = heading.trim();
    let is_separator = |c: char| "_ /,".contains(c);
    let brackets = heading.rfind(['(', '[']).and_then(|open| {
        let close = heading[open..].find([')', ']'])?;
        Some((open, open + close))
    });
    if let Some((open, close)) = brackets {
        let (name, unit) = (heading[..open].trim_end_matches(is_separator), heading[open + 1..close].trim());
        if close + 1 == heading.len() || is_unit(unit) {
            return (name, unit);
        }
    }
    let ratio = RATIOS.iter().find_map(|unit| Some((heading.strip_suffix(unit)?.strip_suffix('_')?, *unit)));
    if let Some(found) = ratio {
        return found;
    }
    for separator in [',', '_', ' ', '/'] {
        if let Some((name, unit)) = heading.rsplit_once(separator)
            && is_unit(unit.trim())
            && !(is_bar(name, unit) || "_ ".contains(separator) && is_label(name, unit))
        {
            return (name.trim(), unit.trim());
        }
    }
    match heading.strip_suffix(['%', '\u{2030}']) {
        Some(name) => (name.trim_end(), &heading[name.len()..]),
        None => (heading, ""),
    }
}

/// Parts of headings, in lower case, of stresses and pressures.
const OF_STRESSES: [&str; 7] = ["stress", "pressure", "spannung", "druck", "contrainte", "sigma", "\u{3c3}"];

/// Whether the last word of a heading is that of an `incident bar`, not the unit of a stress.
fn is_bar(name: &str, word: &str) -> bool {
    let name = name.to_lowercase();
    word.trim() == "bar" && !OF_STRESSES.iter().any(|part| name.contains(part))
}

/// Units of strain with an underscore for the slash.
const RATIOS: [&str; 3] = ["mm_mm", "in_in", "m_m"];

/// Parts of headings, in lower case, of times, lengths and forces; a heading can also be their symbol alone.
const OF_TIMES: [&str; 3] = ["time", "zeit", "temps"];
const OF_LENGTHS: [&str; 15] = [
    "ext",
    "elong",
    "disp",
    "length",
    "position",
    "stroke",
    "crosshead",
    "distance",
    "place",
    "gap",
    "weg",
    "verl\u{e4}ng",
    "travers",
    "allongement",
    "d\u{e9}plac",
];
const OF_FORCES: [&str; 3] = ["force", "load", "kraft"];
const SYMBOLS: [&str; 8] = ["t", "x", "z", "u", "l", "d", "f", "p"];

/// Whether the last word of a heading is a label, as of the incident (`in`, `I`) or transmitted (`t`) pulse, a side or a gauge, although it is also a
/// unit in the heading of another quantity. Other single letters are labels as well.
fn is_label(name: &str, word: &str) -> bool {
    let name = name.to_lowercase();
    let is_of = |parts: &[&str]| SYMBOLS.contains(&name.as_str()) || parts.iter().any(|part| name.contains(part));
    match word.trim() {
        "s" | "h" | "min" => !is_of(&OF_TIMES),
        "m" | "in" => !is_of(&OF_LENGTHS),
        "N" => !is_of(&OF_FORCES),
        "K" | "C" | "F" => !is_of(&["temp"]),
        "V" => false,
        word => word.len() == 1 && word.chars().all(char::is_alphabetic),
    }
}

/// Units of the signal of an amplifier, which are those of no column.
const OF_SIGNALS: [&str; 5] = ["V", "mV", "uV", "kV", "mA"];

/// Whether a word of a heading is a unit of any quantity, or looks like one. A number is part of a name: `strain_1` is the strain of a gauge.
fn is_unit(word: &str) -> bool {
    let plain = word.replace(['\u{b5}', '\u{3bc}'], "u");
    let is_name = word.is_empty() || word == "-" || word.parse::<f64>().is_ok();
    let known = [Dimension::None, Dimension::Length, Dimension::Force, Dimension::Stress];
    let is_known = || known.iter().any(|&dimension| in_heading(word, dimension).is_ok());
    !is_name && (OF_SIGNALS.contains(&plain.as_str()) || is_like_unit(word) || is_known())
}

/// Units that instruments write in other capitalization.
const OTHER_CASE: [&str; 10] = ["MPa", "GPa", "kPa", "ksi", "psi", "kN", "lbf", "kip", "mm", "in"];

/// Returns the SI value of 1 in the unit of a heading, with or without brackets.
///
/// # Errors
/// The unit does not have this dimension.
pub(crate) fn in_heading(unit: &str, dimension: Dimension) -> Result<f64, String> {
    let unit = unit.trim().trim_matches(['(', ')', '[', ']']).trim();
    let of_strain = if dimension == Dimension::None { strain(unit) } else { None };
    of_strain.map_or_else(|| one(&spelled(unit), dimension), Ok).map_err(|reason| reason.replace("`1 ", "`"))
}

/// Returns the value of units that have a meaning only for strains.
fn strain(unit: &str) -> Option<f64> {
    // The micro sign and the Greek letter mu look alike.
    let unit = unit.to_lowercase().replace(['\u{b5}', '\u{3bc}'], "u");
    match unit.as_str() {
        "-" | "1" | "mm_mm" | "in_in" | "m_m" => Some(1.0),
        "pct" => Some(1e-2),
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
        let error = in_heading("mm", stress).expect_err("a length");
        assert!(error.contains("`mm`"), "{error}");
        assert!(in_heading("furlong", stress).is_err() && in_heading("mm", strain).is_err());
    }

    #[test]
    fn units_are_split_off_whatever_the_separator() {
        for unit in
            ["V", "mV", "\u{b5}V", "MPa", "kN", "mm", "us", "usec", "ue", "%", "m\u{3b5}", "mm/mm", "N/mm2", "Mpa"]
        {
            for heading in
                [format!("g20_{unit}"), format!("g20 {unit}"), format!("g20 ({unit})"), format!("g20 [{unit}] 2")]
            {
                assert_eq!(split(&heading), ("g20", unit), "{heading}");
            }
        }
        for name in
            ["g_1", "load_cell", "incident bar", "transmission_bar", "gauge_A", "residual_strain", "F/A", "strain"]
        {
            assert_eq!(split(name), (name, ""));
        }
        for label in ["i", "t", "I", "T", "in", "out", "l", "L", "m", "M", "n", "s", "g", "h", "min", "R", "C"] {
            assert_eq!(split(&format!("strain_{label}")).1, "", "{label}");
        }
        for (heading, name, unit) in [
            ("time_s", "time", "s"),
            ("t_s", "t", "s"),
            ("x m", "x", "m"),
            ("extension_in", "extension", "in"),
            ("Load_N", "Load", "N"),
            ("strain_V", "strain", "V"),
            ("temperature_K", "temperature", "K"),
            ("ext_mm", "ext", "mm"),
            ("strain_mm_mm", "strain", "mm_mm"),
            ("strain_in_in", "strain", "in_in"),
            ("strain_pct", "strain", "pct"),
        ] {
            assert_eq!(split(heading), (name, unit));
        }
        let values = ["mm_mm", "in_in", "pct"].map(|unit| in_heading(unit, Dimension::None));
        assert_eq!(values, [Ok(1.0), Ok(1.0), Ok(1e-2)]);
        assert_eq!(split("Strain (axial)"), ("Strain", "axial"));
        assert_eq!(split("Stress/MPa"), ("Stress", "MPa"));
        assert_eq!(split("stress_bar"), ("stress", "bar"));
        assert_eq!(split("Strain%"), ("Strain", "%"));
    }
}

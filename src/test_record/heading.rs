//! Headings of a record: the quantity of a column and its unit.

use crate::units::Dimension;

use crate::material::unit_size;

/// What a column of a record holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Elongation over gauge length.
    Strain,
    /// Elongation.
    Extension,
    /// Force over initial area.
    Stress,
    /// Force.
    Force,
}

impl Kind {
    /// What its numbers measure.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::Strain => Dimension::None,
            Self::Extension => Dimension::Length,
            Self::Stress => Dimension::Stress,
            Self::Force => Dimension::Force,
        }
    }

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Strain => "strain",
            Self::Extension => "extension",
            Self::Stress => "stress",
            Self::Force => "force",
        }
    }

    /// Parts of headings, in lower case, that name it.
    fn words(self) -> &'static [&'static str] {
        match self {
            Self::Strain => &["strain", "dehnung", "d\u{e9}formation", "deformation", "epsilon", "\u{3b5}"],
            Self::Extension => &[
                "extension",
                "elongation",
                "displacement",
                "crosshead",
                "stroke",
                "verl\u{e4}ngerung",
                "weg",
                "traverse",
                "allongement",
                "d\u{e9}placement",
            ],
            Self::Stress => &["stress", "spannung", "contrainte", "sigma", "\u{3c3}"],
            Self::Force => &["force", "load", "kraft"],
        }
    }
}

/// A heading such as `Force [kN]`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Heading {
    pub name: String,
    /// As written; empty where there is none.
    pub unit: String,
}

/// Splits `Force [kN]`, `stress_MPa`, `Strain (%)`, `Load, N`, `stress/MPa` or `Extension mm` into name and unit. Without brackets only
/// what is a unit is taken for one.
pub(super) fn split(title: &str) -> Heading {
    let title = title.trim();
    // "microstrain" is name and unit in one.
    if title.len() > 1 && !title.contains('/') && size(title, Kind::Strain).is_some_and(|size| size < 1e-2) {
        return Heading { name: "strain".into(), unit: title.into() };
    }
    if let Some(open) = title.rfind(['(', '[']).filter(|_| title.ends_with([')', ']'])) {
        let unit = title[open + 1..title.len() - 1].trim();
        return Heading { name: title[..open].trim_end_matches(['_', ' ', '/', ',']).into(), unit: unit.into() };
    }
    for separator in ['/', ',', '_', ' '] {
        if let Some((name, unit)) = title.rsplit_once(separator)
            && is_unit(unit.trim())
        {
            return Heading { name: name.trim().into(), unit: unit.trim().into() };
        }
    }
    Heading { name: title.into(), unit: String::new() }
}

fn is_unit(text: &str) -> bool {
    [Kind::Strain, Kind::Extension, Kind::Stress, Kind::Force].iter().any(|kind| size(text, *kind).is_some())
}

/// SI value of one unit of such a column; none where it is no unit of it.
pub(super) fn size(unit: &str, kind: Kind) -> Option<f64> {
    let unit = unit.trim().trim_matches(['(', ')', '[', ']']).trim();
    match (kind, unit) {
        (_, "") => None,
        (Kind::Strain, "-" | "1") => Some(1.0),
        (Kind::Strain, _) if matches!(unit.to_lowercase().as_str(), "microstrain" | "microstrains") => Some(1e-6),
        (Kind::Strain, "ustrain" | "ue" | "\u{b5}\u{3b5}" | "\u{3bc}\u{3b5}" | "\u{b5}m/m" | "\u{b5}e") => Some(1e-6),
        // Square millimetres without their sign are how many machines write them.
        (Kind::Stress, "N/mm2" | "N/mm\u{b2}") => Some(1e6),
        _ => unit_size(unit, kind.dimension()).ok(),
    }
}

/// What a heading says that its column holds: the unit decides where there is one, then the name.
pub(super) fn kind(heading: &Heading) -> Option<Kind> {
    let name = heading.name.to_lowercase();
    if name.contains("rate") || name.starts_with("time") {
        return None;
    }
    let all = [Kind::Strain, Kind::Stress, Kind::Force, Kind::Extension];
    let named = all.into_iter().find(|kind| kind.words().iter().any(|word| name.contains(word)));
    match named {
        // "Elongation (%)" is a strain.
        Some(Kind::Extension) if size(&heading.unit, Kind::Strain).is_some() => Some(Kind::Strain),
        Some(Kind::Strain) if size(&heading.unit, Kind::Extension).is_some() => Some(Kind::Extension),
        named => named,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_of_instruments_are_read() {
        for (title, name, unit, expected) in [
            ("Force [kN]", "Force", "kN", Some(Kind::Force)),
            ("stress_MPa", "stress", "MPa", Some(Kind::Stress)),
            ("Tensile strain (%)", "Tensile strain", "%", Some(Kind::Strain)),
            ("Strain (mm/mm)", "Strain", "mm/mm", Some(Kind::Strain)),
            ("Load, N", "Load", "N", Some(Kind::Force)),
            ("stress/MPa", "stress", "MPa", Some(Kind::Stress)),
            ("Extension mm", "Extension", "mm", Some(Kind::Extension)),
            ("Elongation (%)", "Elongation", "%", Some(Kind::Strain)),
            ("Strain rate (1/s)", "Strain rate", "1/s", None),
            ("load_cell", "load_cell", "", Some(Kind::Force)),
            ("Time (s)", "Time", "s", None),
            ("microstrain", "strain", "microstrain", Some(Kind::Strain)),
            ("Microstrain", "strain", "Microstrain", Some(Kind::Strain)),
            ("Strain Gauge (Microstrain)", "Strain Gauge", "Microstrain", Some(Kind::Strain)),
            ("Standardweg [mm]", "Standardweg", "mm", Some(Kind::Extension)),
            ("D\u{e9}formation (%)", "D\u{e9}formation", "%", Some(Kind::Strain)),
            ("Contrainte (N/mm\u{b2})", "Contrainte", "N/mm\u{b2}", Some(Kind::Stress)),
        ] {
            let heading = split(title);
            assert_eq!((heading.name.as_str(), heading.unit.as_str()), (name, unit), "{title}");
            assert_eq!(kind(&heading), expected, "{title}");
        }
        assert_eq!(size("\u{b5}\u{3b5}", Kind::Strain), Some(1e-6));
        assert_eq!(size("furlong", Kind::Stress), None);
    }
}

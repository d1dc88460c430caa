//! Headings of a record: the quantity of a column and its unit.

use crate::input::nearest;
use crate::material::Measure;
use crate::units::{self, Dimension, in_heading};

/// The quantity in a column of a record.
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
    /// Returns the dimension of the values.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::Strain => Dimension::None,
            Self::Extension => Dimension::Length,
            Self::Stress => Dimension::Stress,
            Self::Force => Dimension::Force,
        }
    }

    /// Returns the name of the quantity.
    pub fn name(self) -> &'static str {
        match self {
            Self::Strain => "strain",
            Self::Extension => "extension",
            Self::Stress => "stress",
            Self::Force => "force",
        }
    }

    /// Returns the parts of headings, in lower case, that identify the quantity.
    fn words(self) -> &'static [&'static str] {
        match self {
            Self::Strain => &["strain", "dehnung", "d\u{e9}formation", "deformation", "epsilon", "\u{3b5}"],
            Self::Extension => &[
                "extension",
                "extenso",
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

/// Parts of headings, in lower case, that indicate a measurement on the specimen itself.
const ON_SPECIMEN: [&str; 5] = ["extenso", "aufnehmer", "feindehn", "clip gauge", "clip-on"];

/// Parts of headings, in lower case, that indicate a measurement that includes the deformation of machine and grips.
const OF_MACHINE: [&str; 9] =
    ["crosshead", "stroke", "traverse", "actuator", "machine", "position", "standardweg", "querhaupt", "kolben"];

/// Place at which an extension or a strain was measured, in order of preference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Place {
    /// On the specimen, by an extensometer.
    Specimen,
    /// Not stated in the heading.
    Unknown,
    /// At the crosshead.
    Machine,
}

/// Returns the place of measurement stated in a heading.
pub(super) fn place(title: &str) -> Place {
    let title = title.to_lowercase();
    let names = |parts: &[&str]| parts.iter().any(|part| title.contains(part));
    if names(&ON_SPECIMEN) {
        Place::Specimen
    } else if names(&OF_MACHINE) {
        Place::Machine
    } else {
        Place::Unknown
    }
}

/// Whether a heading is one of shear strain or shear stress, or of torsion.
pub(super) fn is_shear(title: &str) -> bool {
    let title = title.to_lowercase();
    ["shear", "schub", "scher", "cisaillement", "torsion"].iter().any(|part| title.contains(part))
}

/// Words, or their beginnings, in lower case, in headings of logarithmic strain and true stress ...
const TRUE: [&str; 12] =
    ["true", "log", "ln", "natural", "hencky", "cauchy", "wahr", "umformgrad", "vrai", "rationnel", "verdader", "vero"];

/// ... and of values relative to the initial length and cross-section.
const ENGINEERING: [&str; 6] = ["eng", "nominal", "conventional", "conventionnel", "technisch", "nenn"];

/// Returns the measure of a column stated by its heading; `None` if it states none. Extensions and forces are always engineering values, relative
/// to the initial length and cross-section.
pub(super) fn measure(title: &str, kind: Kind) -> Option<Measure> {
    if matches!(kind, Kind::Extension | Kind::Force) {
        return Some(Measure::Engineering);
    }
    let title = title.to_lowercase();
    let words = || title.split(|c: char| !c.is_alphabetic());
    // "ln" and "true" are whole words; the others can have endings.
    let names = |known: &[&str]| {
        words().any(|word| known.iter().any(|known| word == *known || (known.len() > 2 && word.starts_with(known))))
    };
    match (names(&TRUE), names(&ENGINEERING)) {
        (true, false) => Some(Measure::True),
        (false, true) => Some(Measure::Engineering),
        _ => None,
    }
}

/// A heading such as `Force [kN]`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Heading {
    pub name: String,
    /// Unit as written; empty if there is none.
    pub unit: String,
}

/// Splits a heading into name and unit as [`units::split`] does, and also at a comma before a single word, and in `microstrain`.
pub(super) fn split(title: &str) -> Heading {
    let title = title.trim();
    // "microstrain" is name and unit in one.
    if title.len() > 1 && !title.contains('/') && size(title, Kind::Strain).is_some_and(|size| size < 1e-2) {
        return Heading { name: "strain".into(), unit: title.into() };
    }
    let (name, unit) = units::split(title);
    if name.len() < title.len() {
        return Heading { name: name.into(), unit: unit.into() };
    }
    // "Stress, kp/mm^2": a single word after a comma is meant as a unit, whether known or not.
    if let Some((name, unit)) = title.rsplit_once(',').filter(|(_, unit)| unit.split_whitespace().count() == 1) {
        return Heading { name: name.trim().into(), unit: unit.trim().into() };
    }
    Heading { name: title.into(), unit: String::new() }
}

pub(super) fn is_unit(text: &str) -> bool {
    [Kind::Strain, Kind::Extension, Kind::Stress, Kind::Force].iter().any(|kind| size(text, *kind).is_some())
}

/// Returns the SI value of one unit of a column of this kind; `None` if it is not a unit of it.
pub(super) fn size(unit: &str, kind: Kind) -> Option<f64> {
    if unit.trim().is_empty() { None } else { in_heading(unit, kind.dimension()).ok() }
}

/// Returns the unit of a column of this kind that is most similar to an unknown one.
pub(super) fn most_like(unit: &str, kind: Kind) -> Option<&'static str> {
    let known: &[&str] = match kind {
        Kind::Strain => &["%", "\u{2030}", "mm/mm", "in/in", "millistrain", "microstrain", "\u{b5}m/m"],
        Kind::Extension => &["mm", "\u{b5}m", "um", "in", "mil", "m"],
        Kind::Stress => &["MPa", "GPa", "kPa", "Pa", "N/mm^2", "ksi", "psi", "kgf/mm^2", "bar"],
        Kind::Force => &["kN", "N", "MN", "kgf", "lbf", "kip"],
    };
    // The first letter belongs to the prefix: with another one the suggestion would be another multiple.
    let initial = |unit: &str| unit.chars().next().map(|c| c.to_ascii_lowercase());
    nearest(unit, known.iter().copied().filter(|known| initial(known) == initial(unit)))
}

/// Returns the quantity that a heading states: by its unit if it has one, otherwise by its name.
pub(super) fn kind(heading: &Heading) -> Option<Kind> {
    let name = heading.name.to_lowercase();
    if name.contains("rate") || name.starts_with("time") {
        return None;
    }
    let all = [Kind::Strain, Kind::Stress, Kind::Force, Kind::Extension];
    let named = all.into_iter().find(|kind| kind.words().iter().any(|word| name.contains(word)));
    let named = named.or_else(|| (name == "ext").then_some(Kind::Extension));
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
            ("Strain (mstrain)", "Strain", "mstrain", Some(Kind::Strain)),
            ("millistrain", "strain", "millistrain", Some(Kind::Strain)),
            ("Strain Gauge (Microstrain)", "Strain Gauge", "Microstrain", Some(Kind::Strain)),
            ("Standardweg [mm]", "Standardweg", "mm", Some(Kind::Extension)),
            ("Stress, kp/mm\u{b2}", "Stress", "kp/mm\u{b2}", Some(Kind::Stress)),
            ("strain_mV", "strain", "mV", Some(Kind::Strain)),
            ("Stress, stones/acre", "Stress", "stones/acre", Some(Kind::Stress)),
            ("Strain%", "Strain", "%", Some(Kind::Strain)),
            ("stress_mpa", "stress", "mpa", Some(Kind::Stress)),
            ("Extensometer (mm)", "Extensometer", "mm", Some(Kind::Extension)),
            ("Extensometer (%)", "Extensometer", "%", Some(Kind::Strain)),
            ("D\u{e9}formation (%)", "D\u{e9}formation", "%", Some(Kind::Strain)),
            ("Contrainte (N/mm\u{b2})", "Contrainte", "N/mm\u{b2}", Some(Kind::Stress)),
        ] {
            let heading = split(title);
            assert_eq!((heading.name.as_str(), heading.unit.as_str()), (name, unit), "{title}");
            assert_eq!(kind(&heading), expected, "{title}");
        }
        assert_eq!(size("\u{b5}\u{3b5}", Kind::Strain), Some(1e-6));
        assert_eq!(size("millistrain", Kind::Strain), Some(1e-3));
        assert_eq!(size("furlong", Kind::Stress), None);
    }

    #[test]
    fn unknown_units_are_compared_with_known_ones() {
        assert_eq!(most_like("kgfmm2", Kind::Stress), Some("kgf/mm^2"));
        assert_eq!(most_like("milistrain", Kind::Strain), Some("millistrain"));
        assert_eq!(most_like("nanostrain", Kind::Strain), None);
    }

    #[test]
    fn headings_say_measure_and_place() {
        for (title, kind, expected) in [
            ("Logarithmic strain", Kind::Strain, Some(Measure::True)),
            ("log strain", Kind::Strain, Some(Measure::True)),
            ("wahre Dehnung", Kind::Strain, Some(Measure::True)),
            ("Wahre Spannung (MPa)", Kind::Stress, Some(Measure::True)),
            ("Contrainte vraie", Kind::Stress, Some(Measure::True)),
            ("Cauchy stress (MPa)", Kind::Stress, Some(Measure::True)),
            ("true_stress_MPa", Kind::Stress, Some(Measure::True)),
            ("Eng. Strain %", Kind::Strain, Some(Measure::Engineering)),
            ("nominal stress MPa", Kind::Stress, Some(Measure::Engineering)),
            ("technische Dehnung", Kind::Strain, Some(Measure::Engineering)),
            ("Load (kN)", Kind::Force, Some(Measure::Engineering)),
            ("Strain (in/in)", Kind::Strain, None),
            ("Stress", Kind::Stress, None),
        ] {
            assert_eq!(measure(title, kind), expected, "{title}");
        }
        assert_eq!(
            ["Extensometer (mm)", "Weg", "Crosshead", "Position (mm)", "Standardweg"].map(place),
            [Place::Specimen, Place::Unknown, Place::Machine, Place::Machine, Place::Machine]
        );
    }
}

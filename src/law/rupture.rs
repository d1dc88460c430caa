//! Fracture criteria of a section.
//!
//! A section breaks when one of three quantities reaches a threshold of its material: the nominal strain, the energy
//! absorbed per volume (the whole work of strain, elastic and plastic), or the tensile stress. A notch (or a poor
//! weld) divides the threshold by its factor. A section in compression never breaks. By strain or energy, a section that has yielded and unloaded
//! breaks only when it yields again, since elastic strain brings it no closer to fracture than it was.
//!
//! Quantities are in the units of the laws (strains times E, work times 2E), so that cells need no divisions.

use serde::{Deserialize, Serialize};

/// Quantity that causes fracture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// Nominal strain.
    CriticalStrain,
    /// Energy absorbed per volume.
    Energy,
    /// Tensile stress.
    Spall,
}

impl Cause {
    /// Returns the name of the criterion in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::CriticalStrain => "critical-strain",
            Self::Energy => "energy",
            Self::Spall => "spall",
        }
    }
}

/// Fraction of the threshold that counts as reached; the difference from 1 is rounding.
const REACHED: f64 = 1.0 - 1e-12;

/// State of a section, as needed by the criteria.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strained {
    /// Stress, Pa, tension positive.
    pub stress: f64,
    /// E times the signed plastic strain, Pa.
    pub plastic: f64,
    /// 2E times the plastic work per volume, Pa^2.
    pub work: f64,
}

/// Fracture criterion of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    cause: Cause,
    /// Threshold in the units of [`Strained`]; infinite if the segment cannot break.
    threshold: f64,
    modulus: f64,
}

impl Criterion {
    /// Builds a criterion from a threshold in SI units (strain, J/m^3 or Pa; infinite: never), E (Pa) and the notch factor, >= 1.
    pub fn new(cause: Cause, threshold: f64, modulus: f64, notch: f64) -> Self {
        let unit = match cause {
            Cause::CriticalStrain => modulus,
            Cause::Energy => 2.0 * modulus,
            Cause::Spall => 1.0,
        };
        Self { cause, threshold: unit * threshold / notch, modulus }
    }

    /// Returns the quantity that causes fracture.
    pub fn cause(&self) -> Cause {
        self.cause
    }

    /// Returns the fraction of the threshold that a section has reached; 0 in compression.
    pub fn share(&self, place: &Strained) -> f64 {
        if place.stress <= 0.0 {
            return 0.0;
        }
        let reached = match self.cause {
            Cause::CriticalStrain => place.stress + place.plastic,
            Cause::Energy => place.stress * place.stress + place.work,
            Cause::Spall => place.stress,
        };
        reached / self.threshold
    }

    /// Returns the exponent of the stress in [`Self::share`] for an elastic section.
    pub fn power_of_stress(&self) -> i32 {
        if self.cause == Cause::Energy { 2 } else { 1 }
    }

    /// Returns true if a section with this [`Self::share`] and an additional notch factor `notch` breaks.
    pub fn is_met(share: f64, notch: f64) -> bool {
        share * notch >= REACHED
    }

    /// Returns true if strain that grows without bound at constant stress meets the criterion.
    pub fn met_by_unbounded_strain(&self) -> bool {
        self.threshold.is_finite() && self.cause != Cause::Spall
    }

    /// Returns a stress below which no section that has never yielded can break, Pa.
    pub fn elastic_limit(&self) -> f64 {
        if self.cause == Cause::Energy { self.threshold.sqrt() } else { self.threshold }
    }

    /// Returns E times the strain below which no section can break, Pa. `None` if strain is not the criterion.
    pub fn strain_threshold(&self) -> Option<f64> {
        (self.cause == Cause::CriticalStrain).then_some(self.threshold)
    }

    /// Returns the nominal strain of a section.
    pub fn strain(&self, place: &Strained) -> f64 {
        (place.stress + place.plastic) / self.modulus
    }

    /// Returns the energy that a section has absorbed, J/m^3.
    pub fn absorbed(&self, place: &Strained) -> f64 {
        (place.stress * place.stress + place.work) / (2.0 * self.modulus)
    }
}

/// Fracture criteria of a bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Criteria {
    /// Criterion of each segment.
    pub segments: Vec<Criterion>,
    /// Additional notch factor of the joint to the right of each segment, >= 1; the entry of the last segment is unused.
    pub joints: Vec<f64>,
}

/// Location of a fracture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Site {
    /// The left end, which separates from what held or drove it.
    Left,
    /// The right end, which separates from what held or drove it.
    Right,
    /// The joint to the right of this segment, counted from 0.
    Joint(usize),
    /// Inside this segment, counted from 0.
    Inside(usize),
}

impl std::fmt::Display for Site {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Left => f.write_str("left end"),
            Self::Right => f.write_str("right end"),
            Self::Joint(k) => write!(f, "joint {}", k + 1),
            Self::Inside(k) => write!(f, "segment {}", k + 1),
        }
    }
}

/// A fracture that occurred.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Rupture {
    /// Time, s.
    pub time: f64,
    /// Position in the undeformed bar, m from the left end.
    pub x: f64,
    /// Location as a part of the bar.
    pub site: Site,
    /// The segment that broke; at a joint, one of the two.
    pub segment: usize,
    /// Criterion that was met.
    pub cause: Cause,
    /// Stress at the section when it broke, Pa.
    pub stress: f64,
    /// Nominal strain at the section.
    pub strain: f64,
    /// Energy absorbed per volume at the section, J/m^3.
    pub absorbed: f64,
    /// Strain energy and plastic work of the whole bar at that time, J (per m^2 if the bar has no area of its own).
    pub bar_absorbed: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    const E: f64 = 200e9;

    #[test]
    fn thresholds_are_met_in_tension_and_a_notch_divides_them() {
        let place = Strained { stress: 400e6, plastic: 0.1 * E, work: 2.0 * E * 30e6 };
        let strain = Criterion::new(Cause::CriticalStrain, 0.102, E, 1.0);
        assert!((strain.strain(&place) - 0.102).abs() < 1e-15);
        assert!(Criterion::is_met(strain.share(&place), 1.0));
        let notched = Criterion::new(Cause::CriticalStrain, 0.204, E, 2.0);
        assert!(Criterion::is_met(notched.share(&place), 1.0));
        let energy = Criterion::new(Cause::Energy, 60.8e6, E, 1.0);
        assert!(Criterion::is_met(energy.share(&place), 2.0) && !Criterion::is_met(energy.share(&place), 1.9));
        assert!((energy.absorbed(&place) - 30.4e6).abs() < 1.0);
        let spall = Criterion::new(Cause::Spall, 401e6, E, 1.0);
        assert!(!Criterion::is_met(spall.share(&place), 1.0));
        let pressed = Strained { stress: -1e9, ..place };
        for criterion in [strain, energy, spall] {
            assert!(criterion.share(&pressed) == 0.0);
        }
    }
}

//! Rupture: the fracture criteria of a section.
//!
//! A place breaks where what it has come to reaches a threshold of its material: its nominal strain, the energy that it
//! has absorbed per volume (the whole work of strain, elastic and plastic), or its tensile stress. A notch (or a poor
//! weld) divides the threshold by its factor. A place in compression never breaks; and one that has yielded and unloaded
//! breaks only as it yields again, since no elastic strain brings it nearer to breaking than it was.
//!
//! Quantities are in the units of the laws: strains times E, work times 2E, so that nothing is divided in a cell.

use serde::{Deserialize, Serialize};

/// What a place breaks of.
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
    /// The word of the scene language.
    pub fn name(self) -> &'static str {
        match self {
            Self::CriticalStrain => "critical-strain",
            Self::Energy => "energy",
            Self::Spall => "spall",
        }
    }
}

/// Shares of the threshold from here on count as all of it: what is missing is rounding.
const REACHED: f64 = 1.0 - 1e-12;

/// A place's state, as the criteria read it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strained {
    /// Pa, tension positive.
    pub stress: f64,
    /// E times the signed plastic strain, Pa.
    pub plastic: f64,
    /// 2E times the plastic work per volume, Pa^2.
    pub work: f64,
}

/// When a piece of bar breaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    cause: Cause,
    /// In the units of [`Strained`]; infinite: never.
    threshold: f64,
    modulus: f64,
}

impl Criterion {
    /// From a threshold in SI (strain, J/m^3 or Pa; infinite: never), E (Pa) and the notch factor, >= 1.
    pub fn new(cause: Cause, threshold: f64, modulus: f64, notch: f64) -> Self {
        let unit = match cause {
            Cause::CriticalStrain => modulus,
            Cause::Energy => 2.0 * modulus,
            Cause::Spall => 1.0,
        };
        Self { cause, threshold: unit * threshold / notch, modulus }
    }

    /// The criterion.
    pub fn cause(&self) -> Cause {
        self.cause
    }

    /// Part of the threshold that a place has come to; 0 in compression.
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

    /// Power of the stress with which that part goes in an elastic place.
    pub fn power_of_stress(&self) -> i32 {
        if self.cause == Cause::Energy { 2 } else { 1 }
    }

    /// Whether that share, at a place with the notch factor `notch` on top, is all of it.
    pub fn is_met(share: f64, notch: f64) -> bool {
        share * notch >= REACHED
    }

    /// True where strain without bound at a level stress breaks it.
    pub fn ends_gathering(&self) -> bool {
        self.threshold.is_finite() && self.cause != Cause::Spall
    }

    /// A stress below which no place that never yielded can break, Pa.
    pub fn elastic_limit(&self) -> f64 {
        if self.cause == Cause::Energy { self.threshold.sqrt() } else { self.threshold }
    }

    /// E times the strain below which no place can break, Pa; none where strain says nothing.
    pub fn least_reach(&self) -> Option<f64> {
        (self.cause == Cause::CriticalStrain).then_some(self.threshold)
    }

    /// Nominal strain of a place.
    pub fn strain(&self, place: &Strained) -> f64 {
        (place.stress + place.plastic) / self.modulus
    }

    /// Energy that a place has absorbed, J/m^3.
    pub fn absorbed(&self, place: &Strained) -> f64 {
        (place.stress * place.stress + place.work) / (2.0 * self.modulus)
    }
}

/// The criteria of a whole bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Criteria {
    /// One a segment.
    pub segments: Vec<Criterion>,
    /// Notch factor of the joint behind each segment, >= 1 (meaningless on the last); on top of the segments' own.
    pub joints: Vec<f64>,
}

/// Where a bar broke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Site {
    /// Off what held or drove its left end.
    Left,
    /// Off what held or drove its right end.
    Right,
    /// At the joint behind this segment, counted from 0.
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

/// A rupture that happened.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Rupture {
    /// s.
    pub time: f64,
    /// Place in the undeformed bar, m from the left end.
    pub x: f64,
    /// The same in words.
    pub site: Site,
    /// The segment that broke: at a joint one of two.
    pub segment: usize,
    /// What it broke of.
    pub cause: Cause,
    /// Stress at the place as it broke, Pa.
    pub stress: f64,
    /// Nominal strain there.
    pub strain: f64,
    /// Energy that had been absorbed there per volume, J/m^3.
    pub absorbed: f64,
    /// Strain energy and plastic work of the whole bar just then, J (per m^2 where the bar has no area of its own).
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

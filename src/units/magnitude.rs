//! Plausible magnitudes: smallest and largest values of each dimension in scenes and materials.
//!
//! The ranges are far wider than anything physical. They keep products of several values (energies are products of up to six) within the range of
//! double precision, and detect errors in units and exponents.

use super::Dimension;

/// The range of magnitudes of one dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnitudes {
    /// Smallest positive value if zero is not allowed, SI.
    pub least: f64,
    /// Largest magnitude, SI.
    pub most: f64,
    /// Examples of physical magnitudes, for messages.
    pub reason: &'static str,
}

const fn range(least: f64, most: f64, reason: &'static str) -> Magnitudes {
    Magnitudes { least, most, reason }
}

/// Speed of light in vacuum, m/s, exact.
const SPEED_OF_LIGHT: f64 = 299_792_458.0;

impl Dimension {
    /// Returns the range of magnitudes that values of this dimension can have.
    pub const fn magnitudes(self) -> Magnitudes {
        match self {
            Self::None => range(0.0, 1e12, "larger plain numbers are not meaningful here"),
            Self::Length => range(1e-12, 1e9, "an atom measures 1e-10 m, the Earth 1.3e7 m"),
            Self::Area => range(1e-24, 1e12, "the cross-section of an atom is about 1e-20 m^2"),
            Self::Time => range(1e-18, 1e12, "light crosses an atom in 3e-19 s"),
            Self::Velocity => range(1e-15, SPEED_OF_LIGHT, "nothing moves faster than light, 2.998e8 m/s"),
            Self::Stress => range(1e-9, 1e18, "soft gels have moduli of 1 Pa, diamond one of 1.2e12 Pa"),
            Self::Density => range(1e-3, 1e7, "aerogels have 1 kg/m^3, osmium 22600 kg/m^3"),
            Self::Mass => range(1e-27, 1e15, "an atom has 1e-26 kg, a large ship 1e9 kg"),
            Self::Force => range(1e-21, 1e21, "a section of 1 m^2 of diamond carries about 1e11 N"),
            Self::Stiffness | Self::ForcePerLength => {
                range(1e-15, 1e21, "the stiffness of a rigid support of a bar is about 1e15 N/m")
            }
            Self::DampingCoefficient => range(1e-18, 1e21, "rho c0 A of a steel bar of 1 m^2 is 4e7 N s/m"),
            Self::Impulse => range(1e-27, 1e21, "the impulse of a hammer blow is about 10 N s"),
            Self::Energy => range(1e-27, 1e21, "the energy of an atomic bond is about 1e-19 J"),
            Self::EnergyDensity => range(1e-9, 1e18, "metals absorb 1e6 to 1e9 J/m^3"),
            Self::Rate => range(1e-15, 1e18, "atoms vibrate at about 1e13 1/s"),
            Self::Temperature => range(1e-3, 1e6, "metals melt between 234 K and 3700 K"),
            Self::ReciprocalTemperature => range(1e-12, 1e3, "constants of rate laws are 1e-5 to 1e-1 1/K"),
            Self::SpecificHeat => range(1e-3, 1e6, "metals have 100 to 1000 J/(kg K)"),
            Self::Viscosity => range(1e-12, 1e21, "the internal damping of metals is about 1e2 to 1e6 Pa s"),
            Self::Drag => range(1e-15, 1e21, "the drag of a pile in clay is about 1e5 N s/m^2"),
            Self::Foundation => range(1e-15, 1e21, "the foundation modulus of a pile shaft in sand is about 1e8 N/m^2"),
            Self::AngularVelocity => {
                range(1e-15, 1e15, "the surface of a rod of 1 mm diameter reaches the speed of light at 6e11 rad/s")
            }
            Self::Torque => range(1e-27, 1e21, "a steel shaft of 1 m diameter carries about 1e8 N m"),
            Self::MomentOfInertia => {
                range(1e-36, 1e21, "the moment of inertia of a 1 t flywheel is about 1e2 to 1e3 kg m^2")
            }
            Self::SecondMomentOfArea => range(1e-36, 1e12, "a square wire of 1 um has 8e-26 m^4"),
            Self::TorsionalStiffness => {
                range(1e-24, 1e24, "a steel shaft 1 m in diameter and 1 m long has 8e9 N m/rad")
            }
            Self::TorsionalDampingCoefficient => {
                range(1e-27, 1e24, "the torsional impedance of a steel shaft of 1 m diameter is about 4e6 N m s/rad")
            }
            Self::AngularImpulse => range(1e-27, 1e21, "a torque of 100 N m gives 0.1 N m s in 1 ms"),
            Self::EnergyPerArea => range(1e-12, 1e21, "metals take 1e3 to 1e6 J/m^2 to fracture"),
            Self::Angle => range(1e-15, 1e12, "a turn is 6.28 rad"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares of any two values, and a quotient by a third, are numbers that keep all their digits.
    #[test]
    fn products_of_magnitudes_are_normal_numbers() {
        let spans = Dimension::ALL.iter().map(|dimension| dimension.magnitudes());
        let (least, most) = spans.fold((1.0_f64, 1.0_f64), |(least, most), range| {
            (if range.least > 0.0 { least.min(range.least) } else { least }, most.max(range.most))
        });
        assert!((least.powi(4) / most.powi(4)).is_normal() && (most.powi(4) / least.powi(4)).is_finite());
    }
}

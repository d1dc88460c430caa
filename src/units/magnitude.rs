//! Plausible magnitudes: smallest and largest values of each dimension in scenes and materials.
//!
//! The ranges are far wider than anything physical. They keep products of several values (energies are products of up to six) within the
//! numbers that a computer has, and catch slips of units and exponents.

use super::Dimension;

/// The magnitudes of one kind of value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnitudes {
    /// Least value above zero where zero is not allowed, SI.
    pub least: f64,
    /// Largest magnitude, SI.
    pub most: f64,
    /// What there is near the bounds.
    pub reason: &'static str,
}

const fn range(least: f64, most: f64, reason: &'static str) -> Magnitudes {
    Magnitudes { least, most, reason }
}

/// m/s in vacuum, exact.
const SPEED_OF_LIGHT: f64 = 299_792_458.0;

impl Dimension {
    /// The magnitudes that a value of this kind can have.
    pub const fn magnitudes(self) -> Magnitudes {
        match self {
            Self::None => range(0.0, 1e12, "larger plain numbers are not meaningful here"),
            Self::Length => range(1e-12, 1e9, "an atom measures 1e-10 m, the Earth 1.3e7 m"),
            Self::Area => range(1e-24, 1e12, "the section of an atom is some 1e-20 m^2"),
            Self::Time => range(1e-18, 1e12, "light crosses an atom in 3e-19 s"),
            Self::Velocity => range(1e-15, SPEED_OF_LIGHT, "nothing moves faster than light, 2.998e8 m/s"),
            Self::Stress => range(1e-9, 1e18, "soft gels have moduli of 1 Pa, diamond one of 1.2e12 Pa"),
            Self::Density => range(1e-3, 1e7, "aerogels have 1 kg/m^3, osmium 22600 kg/m^3"),
            Self::Mass => range(1e-27, 1e15, "an atom has 1e-26 kg, a large ship 1e9 kg"),
            Self::Force => range(1e-21, 1e21, "a section of 1 m^2 of diamond carries some 1e11 N"),
            Self::Stiffness | Self::ForcePerLength => range(1e-15, 1e21, "a rigid support of a bar has some 1e15 N/m"),
            Self::DampingCoefficient => range(1e-18, 1e21, "rho c0 A of a steel bar of 1 m^2 is 4e7 N s/m"),
            Self::Impulse => range(1e-27, 1e21, "a hammer gives some 10 N s"),
            Self::Energy => range(1e-27, 1e21, "a bond between atoms has 1e-19 J"),
            Self::EnergyDensity => range(1e-9, 1e18, "metals absorb 1e6 to 1e9 J/m^3"),
            Self::Rate => range(1e-15, 1e18, "atoms vibrate with some 1e13 1/s"),
            Self::Temperature => range(1e-3, 1e6, "metals melt between 234 K and 3700 K"),
            Self::ReciprocalTemperature => range(1e-12, 1e3, "constants of rate laws are 1e-5 to 1e-1 1/K"),
            Self::SpecificHeat => range(1e-3, 1e6, "metals have 100 to 1000 J/(kg K)"),
            Self::Viscosity => range(1e-12, 1e21, "internal damping of metals is some 1e2 to 1e6 Pa s"),
            Self::Drag => range(1e-15, 1e21, "the drag of a pile in clay is some 1e5 N s/m^2"),
            Self::Foundation => range(1e-15, 1e21, "the shaft of a pile in sand has some 1e8 N/m^2"),
            Self::AngularVelocity => range(1e-15, 1e15, "the surface of a rod of 1 mm moves with light at 6e11 rad/s"),
            Self::Torque => range(1e-27, 1e21, "a shaft of 1 m of steel carries some 1e8 N m"),
            Self::MomentOfInertia => range(1e-36, 1e21, "a flywheel of 1 t has some 1e2 to 1e3 kg m^2"),
            Self::SecondMomentOfArea => range(1e-36, 1e12, "a square wire of 1 um has 8e-26 m^4"),
            Self::TorsionalStiffness => range(1e-24, 1e24, "a shaft of 1 m of steel and as long has 8e9 N m/rad"),
            Self::TorsionalDampingCoefficient => range(1e-27, 1e24, "that of 1 m of steel is some 4e6 N m s/rad"),
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

//! Dimensions, each declared once: name in messages, SI unit, and display units.

use super::scale::{FOOT_POUND, INCH, POUND, POUND_FORCE, PSI, Scale};
use super::table::Exponents;

/// Declares [`Dimension`]. A row consists of: name; name with its article, for messages; a valid spelling; symbol of the SI unit; exponents of m,
/// kg, s, K; and the display units of the two systems with their SI values, in ascending order. The inch-pound list is empty if the SI units are
/// shown instead.
macro_rules! dimensions {
    ($(
        $(#[doc = $doc:literal])*
        $name:ident: $description:literal, $example:literal, $symbol:literal, $exponents:expr,
        { $($si:literal = $si_size:expr),* }, { $($us:literal = $us_size:expr),* };
    )*) => {
        /// The dimension of a number. Each has one SI unit, in which plain numbers are read.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Dimension {
            $($(#[doc = $doc])* $name,)*
        }

        impl Dimension {
            /// Every dimension.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// Returns the name with its article, for messages: "a length".
            pub fn describe(self) -> &'static str {
                match self { $(Self::$name => $description,)* }
            }

            /// Returns a valid spelling, for messages.
            pub fn example(self) -> &'static str {
                match self { $(Self::$name => $example,)* }
            }

            /// Returns the symbol of the SI unit, as [`super::Quantity`] reads it; empty for plain numbers.
            pub fn si_symbol(self) -> &'static str {
                match self { $(Self::$name => $symbol,)* }
            }

            /// Returns the symbol of the SI unit in files and tables, with spaces: "N s"; empty for plain numbers.
            pub fn spaced_symbol(self) -> String {
                self.si_symbol().replace('*', " ")
            }

            /// Returns the unit for the attribute `units` of a dataset: "N s", and "1" for plain numbers.
            pub fn units(self) -> String {
                Some(self.spaced_symbol()).filter(|symbol| !symbol.is_empty()).unwrap_or_else(|| "1".to_owned())
            }

            /// Returns the exponents of m, kg, s, K. Angles are plain numbers, so several dimensions share exponents.
            pub(super) const fn exponents(self) -> Exponents {
                match self { $(Self::$name => $exponents,)* }
            }

            /// Whether both have the same units, as torque and energy have.
            pub fn is_like(self, other: Self) -> bool {
                self.exponents() == other.exponents()
            }

            pub(super) fn si_scales(self) -> &'static [Scale] {
                match self { $(Self::$name => const { &[$(Scale { symbol: $si, si: $si_size }),*] },)* }
            }

            pub(super) fn us_scales(self) -> &'static [Scale] {
                let scales: &[Scale] = match self {
                    $(Self::$name => const { &[$(Scale { symbol: $us, si: $us_size }),*] },)*
                };
                if scales.is_empty() { self.si_scales() } else { scales }
            }
        }

        /// Each dimension as a type, for numbers whose dimension is part of their type.
        pub mod measures {
            $(
                $(#[doc = $doc])*
                #[derive(Debug, Clone, Copy)]
                pub struct $name;

                impl super::Measure for $name {
                    const DIMENSION: super::Dimension = super::Dimension::$name;
                }
            )*
        }
    };
}

/// A dimension as a type.
pub trait Measure {
    /// Dimension in an axial bar, and where there is no bar.
    const DIMENSION: Dimension;
    /// Dimension in a bar in torsion.
    const IN_TORSION: Dimension = Self::DIMENSION;
}

dimensions! {
    /// 1 (also "%").
    None: "a plain number", "0.5", "", [0, 0, 0, 0], { "" = 1.0 }, {};
    /// m.
    Length: "a length", "10 in", "m", [1, 0, 0, 0],
        { "um" = 1e-6, "mm" = 1e-3, "m" = 1.0 }, { "mil" = 1e-3 * INCH, "in" = INCH };
    /// m^2.
    Area: "an area", "1 cm^2", "m^2", [2, 0, 0, 0],
        { "mm^2" = 1e-6, "cm^2" = 1e-4, "m^2" = 1.0 }, { "in^2" = INCH * INCH };
    /// s.
    Time: "a time", "150 us", "s", [0, 0, 1, 0], { "ns" = 1e-9, "us" = 1e-6, "ms" = 1e-3, "s" = 1.0 }, {};
    /// m/s.
    Velocity: "a velocity", "80 ft/s", "m/s", [1, 0, -1, 0], { "m/s" = 1.0 }, { "ft/s" = 12.0 * INCH };
    /// Pa.
    Stress: "a stress", "200 MPa", "Pa", [-1, 1, -2, 0],
        { "Pa" = 1.0, "kPa" = 1e3, "MPa" = 1e6, "GPa" = 1e9 }, { "psi" = PSI, "ksi" = 1e3 * PSI };
    /// kg/m^3.
    Density: "a density", "7.8 g/cm^3", "kg/m^3", [-3, 1, 0, 0],
        { "kg/m^3" = 1.0 }, { "lb/in^3" = POUND / (INCH * INCH * INCH) };
    /// kg.
    Mass: "a mass", "200 lb", "kg", [0, 1, 0, 0], { "g" = 1e-3, "kg" = 1.0 }, { "lb" = POUND };
    /// N.
    Force: "a force", "5 kN", "N", [1, 1, -2, 0],
        { "N" = 1.0, "kN" = 1e3, "MN" = 1e6 }, { "lbf" = POUND_FORCE, "kip" = 1e3 * POUND_FORCE };
    /// N/m.
    Stiffness: "a stiffness", "10 kN/mm", "N/m", [0, 1, -2, 0],
        { "N/m" = 1.0, "kN/m" = 1e3, "MN/m" = 1e6 }, { "lbf/in" = POUND_FORCE / INCH };
    /// N/m.
    ForcePerLength: "a force per length", "200 N/m", "N/m", [0, 1, -2, 0],
        { "N/m" = 1.0, "kN/m" = 1e3, "MN/m" = 1e6 }, { "lbf/in" = POUND_FORCE / INCH };
    /// N s/m.
    DampingCoefficient: "a damping coefficient", "4 kN*s/m", "N*s/m", [0, 1, -1, 0],
        { "N*s/m" = 1.0, "kN*s/m" = 1e3, "MN*s/m" = 1e6 }, { "lbf*s/in" = POUND_FORCE / INCH };
    /// N m s/rad.
    TorsionalDampingCoefficient: "a torsional damping coefficient", "5 N*m*s/rad", "N*m*s/rad", [2, 1, -1, 0],
        { "N*m*s/rad" = 1.0, "kN*m*s/rad" = 1e3 }, { "lbf*ft*s/rad" = FOOT_POUND };
    /// N s.
    Impulse: "an impulse", "3 N*s", "N*s", [1, 1, -1, 0],
        { "N*s" = 1.0, "kN*s" = 1e3 }, { "lbf*s" = POUND_FORCE };
    /// J.
    Energy: "an energy", "50 J", "J", [2, 1, -2, 0], { "J" = 1.0, "kJ" = 1e3, "MJ" = 1e6 }, { "ft*lbf" = FOOT_POUND };
    /// J/m^3.
    EnergyDensity: "an energy per volume", "500 ft*lbf/in^3", "J/m^3", [-1, 1, -2, 0],
        { "J/m^3" = 1.0, "kJ/m^3" = 1e3, "MJ/m^3" = 1e6 }, { "ft*lbf/in^3" = FOOT_POUND / (INCH * INCH * INCH) };
    /// 1/s.
    Rate: "a rate", "100 1/s", "1/s", [0, 0, -1, 0], { "1/s" = 1.0 }, {};
    /// K (a difference, or absolute; "degC" as an absolute temperature).
    Temperature: "a temperature", "20 degC", "K", [0, 0, 0, 1], { "K" = 1.0 }, {};
    /// 1/K.
    ReciprocalTemperature: "a reciprocal temperature", "0.007 1/K", "1/K", [0, 0, 0, -1], { "1/K" = 1.0 }, {};
    /// J/(kg K).
    SpecificHeat: "a specific heat", "385 J/(kg*K)", "J/(kg*K)", [2, 0, -2, -1],
        { "J/(kg*K)" = 1.0 }, { "Btu/(lb*K)" = 1_055.055_852_62 / POUND };
    /// Pa s.
    Viscosity: "a viscosity", "20 kPa*s", "Pa*s", [-1, 1, -1, 0],
        { "Pa*s" = 1.0, "kPa*s" = 1e3, "MPa*s" = 1e6 }, { "psi*s" = PSI };
    /// N s/m^2: force per length and velocity.
    Drag: "a force per length and velocity", "300 N*s/m^2", "N*s/m^2", [-1, 1, -1, 0],
        { "N*s/m^2" = 1.0, "kN*s/m^2" = 1e3 }, { "lbf*s/in^2" = PSI };
    /// N/m^2: force per length and displacement.
    Foundation: "a force per length and displacement", "50 MN/m^2", "N/m^2", [-1, 1, -2, 0],
        { "N/m^2" = 1.0, "kN/m^2" = 1e3, "MN/m^2" = 1e6 }, { "lbf/in^2" = PSI };
    /// rad/s.
    AngularVelocity: "an angular velocity", "100 rad/s", "rad/s", [0, 0, -1, 0], { "rad/s" = 1.0 }, {};
    /// N m.
    Torque: "a torque", "50 N*m", "N*m", [2, 1, -2, 0], { "N*m" = 1.0, "kN*m" = 1e3 }, { "lbf*ft" = FOOT_POUND };
    /// kg m^2.
    MomentOfInertia: "a moment of inertia", "2 kg*m^2", "kg*m^2", [2, 1, 0, 0],
        { "kg*m^2" = 1.0 }, { "lb*ft^2" = POUND * 144.0 * INCH * INCH };
    /// m^4.
    SecondMomentOfArea: "a second moment of area", "8 cm^4", "m^4", [4, 0, 0, 0],
        { "mm^4" = 1e-12, "cm^4" = 1e-8, "m^4" = 1.0 }, { "in^4" = INCH * INCH * INCH * INCH };
    /// N m/rad.
    TorsionalStiffness: "a torsional stiffness", "300 N*m/rad", "N*m/rad", [2, 1, -2, 0],
        { "N*m/rad" = 1.0, "kN*m/rad" = 1e3 }, { "lbf*ft/rad" = FOOT_POUND };
    /// N m s.
    AngularImpulse: "an angular impulse", "3 N*m*s", "N*m*s", [2, 1, -1, 0],
        { "N*m*s" = 1.0, "kN*m*s" = 1e3 }, { "lbf*ft*s" = FOOT_POUND };
    /// J/m^2.
    EnergyPerArea: "an energy per area", "20 kJ/m^2", "J/m^2", [0, 1, -2, 0],
        { "J/m^2" = 1.0, "kJ/m^2" = 1e3, "MJ/m^2" = 1e6 }, { "ft*lbf/in^2" = FOOT_POUND / (INCH * INCH) };
    /// rad.
    Angle: "an angle", "0.2 rad", "rad", [0, 0, 0, 0], { "rad" = 1.0 }, {};
}

//! Units at the border: text with a unit in, SI out; and numbers for people, in SI or inch-pound units.
//!
//! Factors are exact: in = 0.0254 m, lb = 0.45359237 kg (mass), lbf = lb * 9.80665 m/s^2. A unit is any product or
//! quotient of known symbols with powers, so "lbf*s^2/in^4" is a density and "ft*lbf/in^3" an energy per volume.

mod format;
mod parse;
mod table;

use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize};

pub use format::{Scale, format, scale_for};

/// What a number measures. Each has one SI unit, in which plain numbers are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// 1 (also "%").
    None,
    /// m.
    Length,
    /// m^2.
    Area,
    /// s.
    Time,
    /// m/s.
    Velocity,
    /// Pa.
    Stress,
    /// kg/m^3.
    Density,
    /// kg.
    Mass,
    /// N.
    Force,
    /// N/m.
    Stiffness,
    /// N s/m.
    DampingCoefficient,
    /// N m s/rad.
    TorsionalDampingCoefficient,
    /// J.
    Energy,
    /// J/m^3.
    EnergyDensity,
    /// 1/s.
    Rate,
    /// K (a difference, or absolute; "degC" as an absolute temperature).
    Temperature,
    /// J/(kg K).
    SpecificHeat,
    /// Pa s.
    Viscosity,
    /// N s/m^2: force per length and velocity.
    Drag,
    /// N/m^2: force per length and displacement.
    Foundation,
    /// rad/s.
    AngularVelocity,
    /// N m.
    Torque,
    /// kg m^2.
    MomentOfInertia,
    /// N m/rad.
    TorsionalStiffness,
}

impl Dimension {
    /// Every dimension.
    pub const ALL: [Self; 24] = [
        Self::None,
        Self::Length,
        Self::Area,
        Self::Time,
        Self::Velocity,
        Self::Stress,
        Self::Density,
        Self::Mass,
        Self::Force,
        Self::Stiffness,
        Self::DampingCoefficient,
        Self::TorsionalDampingCoefficient,
        Self::Energy,
        Self::EnergyDensity,
        Self::Rate,
        Self::Temperature,
        Self::SpecificHeat,
        Self::Viscosity,
        Self::Drag,
        Self::Foundation,
        Self::AngularVelocity,
        Self::Torque,
        Self::MomentOfInertia,
        Self::TorsionalStiffness,
    ];

    /// With its article, for messages: "a length".
    pub fn describe(self) -> &'static str {
        match self {
            Self::None => "a plain number",
            Self::Length => "a length",
            Self::Area => "an area",
            Self::Time => "a time",
            Self::Velocity => "a velocity",
            Self::Stress => "a stress",
            Self::Density => "a density",
            Self::Mass => "a mass",
            Self::Force => "a force",
            Self::Stiffness => "a stiffness",
            Self::DampingCoefficient => "a damping coefficient",
            Self::TorsionalDampingCoefficient => "a torsional damping coefficient",
            Self::Energy => "an energy",
            Self::EnergyDensity => "an energy per volume",
            Self::Rate => "a rate",
            Self::Temperature => "a temperature",
            Self::SpecificHeat => "a specific heat",
            Self::Viscosity => "a viscosity",
            Self::Drag => "a force per length and velocity",
            Self::Foundation => "a force per length and displacement",
            Self::AngularVelocity => "an angular velocity",
            Self::Torque => "a torque",
            Self::MomentOfInertia => "a moment of inertia",
            Self::TorsionalStiffness => "a torsional stiffness",
        }
    }

    /// A right spelling, for messages.
    pub fn example(self) -> &'static str {
        match self {
            Self::None => "0.5",
            Self::Length => "10 in",
            Self::Area => "1 cm^2",
            Self::Time => "150 us",
            Self::Velocity => "80 ft/s",
            Self::Stress => "200 MPa",
            Self::Density => "7.8 g/cm^3",
            Self::Mass => "200 lb",
            Self::Force => "5 kN",
            Self::Stiffness => "10 kN/mm",
            Self::DampingCoefficient => "4 kN*s/m",
            Self::TorsionalDampingCoefficient => "5 N*m*s/rad",
            Self::Energy => "50 J",
            Self::EnergyDensity => "500 ft*lbf/in^3",
            Self::Rate => "100 1/s",
            Self::Temperature => "20 degC",
            Self::SpecificHeat => "385 J/(kg*K)",
            Self::Viscosity => "20 kPa*s",
            Self::Drag => "300 N*s/m^2",
            Self::Foundation => "50 MN/m^2",
            Self::AngularVelocity => "100 rad/s",
            Self::Torque => "50 N*m",
            Self::MomentOfInertia => "2 kg*m^2",
            Self::TorsionalStiffness => "300 N*m/rad",
        }
    }

    /// Symbol of the SI unit, as [`Quantity`] reads it; empty for plain numbers.
    pub fn si_symbol(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Length => "m",
            Self::Area => "m^2",
            Self::Time => "s",
            Self::Velocity => "m/s",
            Self::Stress => "Pa",
            Self::Density => "kg/m^3",
            Self::Mass => "kg",
            Self::Force => "N",
            Self::Stiffness => "N/m",
            Self::DampingCoefficient => "N*s/m",
            Self::TorsionalDampingCoefficient => "N*m*s/rad",
            Self::Energy => "J",
            Self::EnergyDensity => "J/m^3",
            Self::Rate => "1/s",
            Self::Temperature => "K",
            Self::SpecificHeat => "J/(kg*K)",
            Self::Viscosity => "Pa*s",
            Self::Drag => "N*s/m^2",
            Self::Foundation => "N/m^2",
            Self::AngularVelocity => "rad/s",
            Self::Torque => "N*m",
            Self::MomentOfInertia => "kg*m^2",
            Self::TorsionalStiffness => "N*m/rad",
        }
    }

    /// Exponents of m, kg, s, K. Stress, energy per volume and the foundation's force have the same, and so have the dampers
    /// and others; angles are plain numbers.
    const fn exponents(self) -> table::Exponents {
        match self {
            Self::None => [0, 0, 0, 0],
            Self::Length => [1, 0, 0, 0],
            Self::Area => [2, 0, 0, 0],
            Self::Time => [0, 0, 1, 0],
            Self::Velocity => [1, 0, -1, 0],
            Self::Stress | Self::EnergyDensity | Self::Foundation => [-1, 1, -2, 0],
            Self::Viscosity | Self::Drag => [-1, 1, -1, 0],
            Self::Density => [-3, 1, 0, 0],
            Self::Mass => [0, 1, 0, 0],
            Self::Force => [1, 1, -2, 0],
            Self::Stiffness => [0, 1, -2, 0],
            Self::DampingCoefficient => [0, 1, -1, 0],
            Self::TorsionalDampingCoefficient => [2, 1, -1, 0],
            Self::Energy | Self::Torque | Self::TorsionalStiffness => [2, 1, -2, 0],
            Self::Rate | Self::AngularVelocity => [0, 0, -1, 0],
            Self::MomentOfInertia => [2, 1, 0, 0],
            Self::Temperature => [0, 0, 0, 1],
            Self::SpecificHeat => [2, 0, -2, -1],
        }
    }
}

/// Units for people to read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum System {
    /// m, MPa, m/s.
    #[default]
    Si,
    /// in, ksi, ft/s.
    Us,
}

/// A number as a file gives it: a plain number in SI, or text with a unit such as "80 ft/s".
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[serde(untagged)]
pub enum Quantity {
    /// SI.
    Number(f64),
    /// e.g. "80 ft/s".
    Text(String),
}

impl Quantity {
    /// The value in SI.
    ///
    /// # Errors
    /// One sentence: not a number, an unknown unit (with the nearest known one), or the wrong dimension (with the
    /// one expected and an example).
    pub fn si(&self, dimension: Dimension) -> Result<f64, String> {
        match self {
            Self::Number(value) if value.is_finite() => Ok(*value),
            Self::Number(value) => Err(format!("{value} is not a finite number")),
            Self::Text(text) => parse::parse(text, dimension),
        }
    }
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(value) => write!(f, "{value}"),
            Self::Text(text) => write!(f, "{text}"),
        }
    }
}

impl FromStr for Quantity {
    type Err = std::convert::Infallible;

    /// From a command line: "40" is a plain number, anything else is text.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(text.trim().parse().map_or_else(|_| Self::Text(text.to_owned()), Self::Number))
    }
}

// By hand: an untagged derive would answer a wrong type with "did not match any variant".
impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;

        impl serde::de::Visitor<'_> for Visitor {
            type Value = Quantity;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number, or a text with a unit such as \"10 in\"")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Quantity, E> {
                Ok(Quantity::Number(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Quantity, E> {
                Ok(Quantity::Number(value as f64))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Quantity, E> {
                Ok(Quantity::Number(value as f64))
            }

            // Whole numbers that 64 bits do not hold.
            fn visit_i128<E>(self, value: i128) -> Result<Quantity, E> {
                Ok(Quantity::Number(value as f64))
            }

            fn visit_str<E>(self, text: &str) -> Result<Quantity, E> {
                Ok(Quantity::Text(text.to_owned()))
            }
        }

        deserializer.deserialize_any(Visitor)
    }
}

#[cfg(test)]
mod tests;

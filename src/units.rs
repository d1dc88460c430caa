//! Conversion of strings with a unit to SI, and of numbers to strings in SI or inch-pound units.
//!
//! Factors are exact: in = 0.0254 m, lb = 0.45359237 kg (mass), lbf = lb * 9.80665 m/s^2. A unit is any product or quotient of known symbols with
//! powers, so "lbf*s^2/in^4" is a density and "ft*lbf/in^3" an energy per volume.

mod dimension;
mod format;
mod heading;
mod magnitude;
mod parse;
mod scale;
mod sentence;
mod table;

use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize};

pub use dimension::{Dimension, Measure, measures};
pub use format::{format, scale_for};
pub(crate) use heading::{in_heading, split};
pub use magnitude::Magnitudes;
pub use scale::Scale;
pub use sentence::in_units;

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
    /// Returns the value in SI.
    ///
    /// # Errors
    /// One sentence: not a number, an unknown unit (with the nearest known one), or the wrong dimension (with the one expected and an example).
    pub fn si(&self, dimension: Dimension) -> Result<f64, String> {
        match self {
            Self::Number(value) if value.is_finite() => Ok(*value),
            Self::Number(value) => Err(format!("{value} is not a finite number")),
            Self::Text(text) => parse::parse(text, dimension),
        }
    }
}

/// Returns the SI value of 1 in this unit.
///
/// # Errors
/// As for [`Quantity::si`].
pub(crate) fn one(unit: &str, dimension: Dimension) -> Result<f64, String> {
    Quantity::Text(format!("1 {unit}")).si(dimension)
}

impl Quantity {
    /// Returns the value in SI and its dimension, which can be any. A plain number is dimensionless.
    ///
    /// # Errors
    /// As for [`Quantity::si`].
    pub fn in_si(&self) -> Result<(f64, Dimension), String> {
        let unit = self.number_and_unit().map_or("", |(_, unit)| unit);
        let is_typed = |dimension: &Dimension| {
            [dimension.si_scales(), dimension.us_scales()].into_iter().flatten().any(|scale| scale.symbol == unit)
        };
        let fits = || Dimension::ALL.iter().filter_map(|&dimension| Some((self.si(dimension).ok()?, dimension)));
        // Several dimensions can share a unit: "rad/s" is an angular velocity rather than a rate, "N*m" a torque rather than an energy.
        let found = fits().find(|(_, dimension)| is_typed(dimension)).or_else(|| fits().next());
        match self {
            Self::Number(_) => Ok((self.si(Dimension::None)?, Dimension::None)),
            Self::Text(_) => found.map_or_else(|| self.si(Dimension::None).map(|si| (si, Dimension::None)), Ok),
        }
    }

    /// Returns the number as typed and its unit, which is empty for a plain number.
    ///
    /// # Errors
    /// The text does not start with a number.
    pub fn number_and_unit(&self) -> Result<(f64, &str), String> {
        match self {
            Self::Number(value) => Ok((*value, "")),
            Self::Text(text) => parse::split_number(text.trim()).map(|(number, unit)| (number, unit.trim())),
        }
    }
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            // An exponent avoids a row of zeros.
            Self::Number(value) if *value != 0.0 && !(1e-4..1e9).contains(&value.abs()) => write!(f, "{value:e}"),
            Self::Number(value) => write!(f, "{value}"),
            Self::Text(text) => write!(f, "{text}"),
        }
    }
}

impl FromStr for Quantity {
    type Err = std::convert::Infallible;

    /// Converts a command-line argument: "40" is a plain number, anything else is text.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(text.trim().parse().map_or_else(|_| Self::Text(text.to_owned()), Self::Number))
    }
}

// Written by hand, because an untagged derive would report a wrong type as "did not match any variant".
impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;

        impl serde::de::Visitor<'_> for Visitor {
            type Value = Quantity;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number, or a string with a unit such as \"10 in\"")
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

            // Integers that do not fit into 64 bits.
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

//! Units at the border: text with a unit in, SI out.

use serde::{Deserialize, Serialize};

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
}

/// A number as a file gives it: SI, or text with a unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
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
        let _ = dimension;
        todo!()
    }
}

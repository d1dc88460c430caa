//! The constants of a material for heating and thermal softening.

use serde::Serialize;

/// Constants for adiabatic heating, and for the softening 1 - ((T - reference)/(melting - reference))^exponent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct HeatConstants {
    /// Specific heat, J/(kg K), > 0.
    pub specific_heat: Option<f64>,
    /// Fraction of the plastic work that is converted to heat, 0 to 1.
    pub fraction: Option<f64>,
    /// Temperature at which the curve was measured, K.
    pub reference_temperature: Option<f64>,
    /// Melting temperature, K.
    pub melting_temperature: Option<f64>,
    /// Exponent m of the softening, > 0.
    pub exponent: Option<f64>,
}

impl HeatConstants {
    /// Returns the keys of `[heat]` that heating and softening need and that are not stated.
    pub fn missing(&self) -> Vec<&'static str> {
        let needed = [
            ("specific-heat", self.specific_heat),
            ("reference-temperature", self.reference_temperature),
            ("melting-temperature", self.melting_temperature),
            ("m", self.exponent),
        ];
        needed.iter().filter(|(_, value)| value.is_none()).map(|(key, _)| *key).collect()
    }
}

//! What a material file states besides its curve: constants for the effects that need them.

use serde::Serialize;

use super::file::Keys;
use super::rate::{self, Rate};
use super::raw::{RawHeat, RawMaterial};
use crate::error::Result;
use crate::input::Allowed::{Positive, Within};
use crate::units::Dimension;

/// Constants beside the curve; every one is absent where the file does not give it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Constants {
    /// The law from which the table was made, with its constants, as one line; none for a measured table.
    pub law: Option<String>,
    /// The laws of the strain rate that it states.
    pub rate: Vec<Rate>,
    /// Heating and thermal softening.
    pub heat: HeatConstants,
}

/// Constants for adiabatic heating, and the softening 1 - ((T - reference)/(melting - reference))^exponent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct HeatConstants {
    /// J/(kg K), > 0.
    pub specific_heat: Option<f64>,
    /// Fraction of the plastic work that turns into heat, 0 to 1.
    pub fraction: Option<f64>,
    /// Temperature at which the curve holds, K.
    pub reference_temperature: Option<f64>,
    /// Melting temperature, K.
    pub melting_temperature: Option<f64>,
    /// Exponent m of the softening, > 0.
    pub exponent: Option<f64>,
}

impl HeatConstants {
    /// Keys of `[heat]` that heating and softening need and that are not stated.
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

/// Checks the constants of a file.
pub(super) fn resolve(raw: &RawMaterial, law: Option<String>, keys: Keys<'_>) -> Result<Constants> {
    let heat = raw.heat.as_ref().map_or_else(|| Ok(HeatConstants::default()), |h| heat(h, keys))?;
    let rate = raw.rate.as_ref().map_or_else(|| Ok(Vec::new()), |r| rate::resolve(r, &heat, keys))?;
    Ok(Constants { law, rate, heat })
}

fn heat(raw: &RawHeat, keys: Keys<'_>) -> Result<HeatConstants> {
    let temperature = |value, key| keys.optional(value, key, Dimension::Temperature, Positive);
    let reference = temperature(raw.reference_temperature.as_ref(), "heat.reference-temperature")?;
    let melting = temperature(raw.melting_temperature.as_ref(), "heat.melting-temperature")?;
    if let (Some(reference), Some(melting), Some(given)) = (reference, melting, &raw.melting_temperature)
        && melting <= reference
    {
        let message = format!("{melting} K is not above the reference temperature {reference} K");
        let error = keys.error(given.span(), "heat.melting-temperature", message);
        return Err(error.allowed("melting-temperature > reference-temperature").help("check the units").into());
    }
    let specific = raw.specific_heat.as_ref();
    Ok(HeatConstants {
        specific_heat: keys.optional(specific, "heat.specific-heat", Dimension::SpecificHeat, Positive)?,
        fraction: keys.optional(raw.fraction.as_ref(), "heat.fraction", Dimension::None, Within(0.0, 1.0))?,
        reference_temperature: reference,
        melting_temperature: melting,
        exponent: keys.optional(raw.exponent.as_ref(), "heat.m", Dimension::None, Positive)?,
    })
}

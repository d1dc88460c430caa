//! What a material file states besides its curve: constants for the effects that need them.

use serde::Serialize;

use super::heat_constants::HeatConstants;
use super::keys::Keys;
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

//! Constants of a material other than its curve.

use serde::Serialize;

use super::heat_constants::HeatConstants;
use super::keys::Keys;
use super::rate::{self, Rate};
use super::raw::{RawHeat, RawMaterial};
use crate::error::Result;

/// Constants of a material other than its curve; each is absent if the file does not state it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Constants {
    /// Law from which the table was made, with its constants, as one line; `None` for a measured table.
    pub law: Option<String>,
    /// Rate laws stated in the file.
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
    let reference = keys.si(&raw.reference_temperature)?;
    let melting = keys.si(&raw.melting_temperature)?;
    if let (Some(reference), Some(melting), Some(given)) = (reference, melting, &raw.melting_temperature)
        && melting <= reference
    {
        let message = format!("{melting} K is not above the reference temperature {reference} K");
        let error = keys.error(given.span(), "heat.melting-temperature", message);
        return Err(error.allowed("melting-temperature > reference-temperature").help("check the units").into());
    }
    Ok(HeatConstants {
        specific_heat: keys.si(&raw.specific_heat)?,
        fraction: keys.si(&raw.fraction)?,
        reference_temperature: reference,
        melting_temperature: melting,
        exponent: keys.si(&raw.exponent)?,
    })
}

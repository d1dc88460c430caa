//! What a material file states besides its curve: constants for the effects that need them.

use serde::Serialize;

/// Constants beside the curve; every one is absent where the file does not give it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Constants {
    /// The law from which the table was made, with its constants, as one line; none for a measured table.
    pub law: Option<String>,
    /// Rate dependence.
    pub rate: RateConstants,
    /// Heating and thermal softening.
    pub heat: HeatConstants,
}

/// Constants of the rate laws.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct RateConstants {
    /// Johnson-Cook: stress times 1 + C ln(rate/reference).
    pub johnson_cook: Option<JohnsonCookRate>,
    /// Cowper-Symonds: plastic rate = D (stress/static - 1)^q.
    pub cowper_symonds: Option<CowperSymonds>,
    /// Malvern's k, 1/s, > 0: plastic rate = k (stress - static)/E.
    pub malvern: Option<f64>,
}

/// Johnson-Cook's rate factor 1 + C ln(rate/reference).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct JohnsonCookRate {
    /// C, >= 0.
    pub c: f64,
    /// Reference plastic strain rate, 1/s, > 0.
    pub reference: f64,
}

/// Cowper and Symonds' constants.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CowperSymonds {
    /// D, 1/s, > 0.
    pub d: f64,
    /// Exponent q, > 0.
    pub q: f64,
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

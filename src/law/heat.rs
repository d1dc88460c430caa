//! Temperature of laws on an adiabatic curve. The table includes the heating; the temperature follows from the accumulated plastic strain.

use crate::material::{Heating, Sense};

/// Temperature of a cell on an adiabatic curve.
///
/// It is exact for a cell that has always flowed in one sense. If tension and compression have the same curve, this is no
/// restriction.
#[derive(Debug, Clone)]
pub(super) struct AdiabaticTemperature {
    pub heating: Heating,
    /// Elastic modulus, Pa.
    pub modulus: f64,
}

impl AdiabaticTemperature {
    /// Returns the temperature, K, for E times the signed and the accumulated plastic strain, Pa.
    pub fn at(&self, plastic_strain: f64, accumulated: f64) -> f64 {
        self.heating.temperature(Sense::of(plastic_strain), accumulated / self.modulus)
    }
}

//! Heat in laws on the adiabatic curve: the table includes it, and the temperature follows from the accumulated plastic strain.

use crate::material::{Heating, Sense};

/// Temperature of a cell on an adiabatic curve.
///
/// It is that of a cell whose flow went one way all the time; where tension and compression share a curve that is no
/// restriction.
#[derive(Debug, Clone)]
pub(super) struct AdiabaticTemperature {
    pub heating: Heating,
    /// Elastic modulus, Pa.
    pub modulus: f64,
}

impl AdiabaticTemperature {
    /// K, with E times the signed and the accumulated plastic strain, Pa.
    pub fn at(&self, plastic_strain: f64, accumulated: f64) -> f64 {
        self.heating.temperature(Sense::of(plastic_strain), accumulated / self.modulus)
    }
}

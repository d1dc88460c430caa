//! Warnings about improbable constants of a valid material.

use super::{Loading, Material, Sense};
use crate::units::{Dimension, System, format};

/// Young's modulus of diamond, Pa, the stiffest material.
const STIFFEST: f64 = 1.22e12;
/// Density of osmium, kg/m^3, the densest material.
const DENSEST: f64 = 22_650.0;
/// Range of elastic wave speeds of solids, m/s: 30 in soft rubber, 18,000 in diamond.
const WAVE_SPEEDS: std::ops::Range<f64> = 10.0..25_000.0;
/// Initial slope over the modulus above which the difference can be due to rows with three digits.
const ROUNDED: f64 = 0.99;

impl Material {
    /// Returns the warnings, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        [self.too_stiff(), self.too_dense(), self.improbable_wave_speed(), self.never_elastic()]
            .into_iter()
            .flatten()
            .collect()
    }

    fn too_stiff(&self) -> Option<String> {
        let (name, gpa) = (&self.name, self.modulus / 1e9);
        (self.modulus > STIFFEST).then(|| {
            format!("the modulus of `{name}` is {gpa:.0} GPa: stiffer than diamond (1220 GPa); check the number and its unit")
        })
    }

    fn too_dense(&self) -> Option<String> {
        let (name, density) = (&self.name, self.density);
        (density > DENSEST).then(|| {
            format!("the density of `{name}` is {density:.0} kg/m^3: denser than osmium (22600 kg/m^3); check the number and \
                     its unit")
        })
    }

    /// Warns if the units of modulus and density do not match. A modulus or density that is too large by itself has its own warning.
    fn improbable_wave_speed(&self) -> Option<String> {
        let (name, c0) = (&self.name, self.c0());
        let noted = self.modulus > STIFFEST || self.density > DENSEST;
        (!noted && !WAVE_SPEEDS.contains(&c0)).then(|| {
            format!(
                "the elastic wave speed of `{name}` is {}, outside that of solids (soft rubber 30 m/s, diamond \
                 18000 m/s); without a unit the density, {} kg/m^3, and the modulus, {:e} Pa, are in SI: check both",
                format(c0, Dimension::Velocity, System::Si),
                self.density,
                self.modulus
            )
        })
    }

    /// Warns if the curve has no elastic part. Curves in torsion are those of a section, which can be nonlinear from the start, and are not
    /// checked.
    fn never_elastic(&self) -> Option<String> {
        let curve = self.branch(Sense::Tension);
        let slope = curve.slopes().next().unwrap_or(self.modulus);
        let bends = self.loading == Loading::Axial && slope < ROUNDED * self.modulus;
        bends.then(|| {
            format!(
                "the curve of `{}` has no elastic part: its initial slope, {:.4e} Pa, is {:.3} of the modulus, so the material \
                 yields at any load; add the elastic limit as the first row (`materials import --elastic-range` fits it), or set the \
                 modulus to that slope",
                self.name,
                slope,
                slope / self.modulus
            )
        })
    }
}

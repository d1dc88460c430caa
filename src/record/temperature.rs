//! Temperature rise of a bar and its uncertainty.

use super::AuditRow;
use crate::material::{Material, Sense};

/// Smallest uncertainty of the temperature that is reported, K. A change of 1 K softens common metals by less than 0.1 %.
const UNCERTAIN: f64 = 1.0;

/// Fraction of the plastic strain that must have been reversed before a section counts as one that yielded in both senses.
const BOTH_SENSES: f64 = 1e-6;

/// Returns the largest temperature rise, K. Each item holds the temperature of a place and its excess over the
/// reference temperature at t = 0, K. Returns `None` if the material is not heated.
pub fn largest_rise(material: &Material, temperatures: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let reference = material.heating.as_ref()?.reference_temperature;
    Some(temperatures.map(|(temperature, at_start)| temperature - (reference + at_start)).fold(0.0, f64::max))
}

/// Reports sections that yielded in both senses, in a material with different curves in tension and compression on its
/// adiabatic curves. These curves give the temperature of flow in one sense only; the true temperature lies between
/// those of the two curves. `places` are pairs of accumulated and signed plastic strain. Returns `None` if the
/// uncertainty is at most 1 K.
pub fn flowed_both_ways(material: &Material, places: impl Iterator<Item = (f64, f64)>) -> Option<AuditRow> {
    let heating = material.heating.as_ref().filter(|heating| heating.warms())?;
    material.compression.as_ref()?;
    let apart = |p: f64| (heating.temperature(Sense::Tension, p) - heating.temperature(Sense::Compression, p)).abs();
    let both = places.filter(|&(accumulated, signed)| accumulated - signed.abs() > BOTH_SENSES * accumulated);
    let largest = both.map(|(accumulated, _)| apart(accumulated)).fold(0.0, f64::max);
    (largest > UNCERTAIN).then(|| AuditRow {
        effect: "heat".into(),
        estimate: largest,
        threshold: UNCERTAIN,
        finding: std::format!(
            "sections of {} yielded in tension and in compression, which have separate curves; their temperature is uncertain \
             by {largest:.0} K. One curve for both senses (without `symmetry`), or `rate` with method = \"fd\", gives the \
             exact temperature",
            material.name
        ),
        ..AuditRow::default()
    })
}

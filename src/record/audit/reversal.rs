//! Reversed plastic flow after a large strain, for which engineering measures are inaccurate.
//!
//! Hardening is computed in engineering measures: a point that was compressed to the plastic strain p yields in tension
//! at the engineering stress of the tension curve at p, which refers to the section of a specimen that was stretched.
//! On the actual section, the stress of isotropic hardening is the compressive stress that the point has just carried
//! (equal true stress, equal section). The same holds for tension followed by compression. If one curve serves both
//! senses the two stresses agree, and nothing is reported.

use super::AuditRow;
use crate::law::Table;
use crate::law::rate::Hardening;
use crate::material::{Loading, Material, Sense};
use crate::units::{Dimension, System, format};

/// Engineering plastic strain before the reversal from which the change of the section is significant.
const LARGE: f64 = 0.1;

/// Fraction of the plastic strain that must have been reversed before a place counts as reversed.
const REVERSED_FRACTION: f64 = 1e-6;

/// Flow stresses at a reversal.
#[derive(Debug, Clone, Copy)]
struct Reversal {
    /// Sense of the flow before the reversal.
    sense: Sense,
    /// Magnitude of the plastic strain in this sense.
    strain: f64,
    /// Flow stress before the reversal, and flow stress of the reversed flow, Pa, magnitudes.
    stress: [f64; 2],
}

impl Reversal {
    fn error(&self) -> f64 {
        (self.stress[1] / self.stress[0] - 1.0).abs()
    }
}

/// Returns the row for a material of which some places (accumulated and signed plastic strains) yielded in reverse
/// after a large strain; `None` unless the reversal changes their flow stress by more than the fraction `tolerance`.
pub fn reversed_flow(
    material: &Material,
    places: impl Iterator<Item = (f64, f64)>,
    tolerance: f64,
) -> Option<AuditRow> {
    if material.loading == Loading::Shear {
        return None;
    }
    material.compression.as_ref()?;
    let hardening = [Sense::Tension, Sense::Compression]
        .map(|sense| Hardening::new(&Table::new(material.branch(sense), material.modulus)));
    let reversals =
        places.filter_map(|(accumulated, signed)| reversal(&hardening, material.modulus, accumulated, signed));
    let worst = reversals.max_by(|a, b| a.error().total_cmp(&b.error())).filter(|r| r.error() > tolerance)?;
    let show = |stress| format(stress, Dimension::Stress, System::Si);
    let finding = std::format!(
        "plastic flow of {} reversed after a plastic strain of {:.3} in {}, at a stress of {}; isotropic hardening in true \
         stress gives {}. Hardening is computed in engineering measures, which is inaccurate for reversals after strains above \
         {LARGE}",
        material.name,
        worst.strain,
        worst.sense.name(),
        show(worst.stress[1]),
        show(worst.stress[0]),
    );
    Some(AuditRow {
        effect: "reversal".into(),
        estimate: worst.error(),
        threshold: tolerance,
        finding,
        ..AuditRow::default()
    })
}

/// Returns the reversal of a place, which is assumed to have yielded first in the sense in which it yielded more;
/// `None` if the strain was small or not reversed.
fn reversal(hardening: &[Hardening; 2], modulus: f64, accumulated: f64, signed: f64) -> Option<Reversal> {
    let (sense, strain) = (Sense::of(signed), 0.5 * (accumulated + signed.abs()));
    if strain < LARGE || accumulated - strain <= REVERSED_FRACTION * accumulated {
        return None;
    }
    let p = modulus * strain;
    let flow_stress = |k: usize| hardening[k].pieces()[hardening[k].find(p) as usize].at(p);
    Some(Reversal { sense, strain, stress: [flow_stress(sense.index()), flow_stress(1 - sense.index())] })
}

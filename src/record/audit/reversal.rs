//! Reversed plastic flow after a large strain, for which engineering measures are inaccurate.
//!
//! Hardening is kept in engineering measures: a point that was compressed to the plastic strain p flows in tension from the
//! engineering stress of the tension curve at p on, which belongs to the section of a specimen that was stretched. On the section
//! that it has, the stress of isotropic hardening is the compressive one that it has just carried (one true stress, one section),
//! and likewise mirrored. Where one curve serves both senses the two agree, and nothing is to be said.

use super::AuditRow;
use crate::law::Table;
use crate::law::rate::Hardening;
use crate::material::{Loading, Material, Sense};
use crate::units::{Dimension, System, format};

/// Engineering plastic strain before the reversal from which on the change of the section is worth a note.
const LARGE: f64 = 0.1;

/// Part of the plastic strain that must have gone back before a place counts as reversed.
const WENT_BACK: f64 = 1e-6;

/// The flow stresses at a reversal.
#[derive(Debug, Clone, Copy)]
struct Reversal {
    /// Of the flow before it.
    sense: Sense,
    /// Plastic strain by it.
    strain: f64,
    /// Stress that it had come to, and at which the point flows back, Pa.
    stress: [f64; 2],
}

impl Reversal {
    fn error(&self) -> f64 {
        (self.stress[1] / self.stress[0] - 1.0).abs()
    }
}

/// A material some of whose places (accumulated and signed plastic strains) flowed back after a large strain, where that makes
/// more of a difference to their flow stress than `tolerance`.
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

/// Of a place that flowed first in the sense in which it flowed more.
fn reversal(hardening: &[Hardening; 2], modulus: f64, accumulated: f64, signed: f64) -> Option<Reversal> {
    let (sense, strain) = (Sense::of(signed), 0.5 * (accumulated + signed.abs()));
    if strain < LARGE || accumulated - strain <= WENT_BACK * accumulated {
        return None;
    }
    let p = modulus * strain;
    let flow_stress = |k: usize| hardening[k].pieces()[hardening[k].find(p) as usize].at(p);
    Some(Reversal { sense, strain, stress: [flow_stress(sense.index()), flow_stress(1 - sense.index())] })
}

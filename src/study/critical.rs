//! Critical impact velocities of materials, computed from their curves alone.

use serde::Serialize;

use crate::material::{Beyond, Curve, Material, Sense, UltimateReason};
use crate::wave::similarity;

/// Critical impact velocity of one material, computed from its curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CriticalRow {
    /// Name of the material.
    pub material: String,
    /// Density.
    pub density_kg_m3: f64,
    /// Sense of the loading.
    pub sense: Sense,
    /// Critical velocity, m/s; `None` if the curve has no ultimate point, see `reason`.
    pub critical_velocity_m_s: Option<f64>,
    /// Engineering strain at the ultimate point, up to which the critical velocity is integrated.
    pub strain_at_max: Option<f64>,
    /// Engineering stress at the ultimate point, Pa.
    #[serde(rename = "stress_at_max_Pa")]
    pub stress_at_max_pa: Option<f64>,
    /// Impact velocity at which the curve leaves the elastic line, m/s: `sigma_y/(rho c0)`.
    pub yield_velocity_m_s: f64,
    /// Criterion: "maximum-stress" or "rupture-strain", or the reason why there is no critical velocity.
    pub reason: String,
}

/// Computes the critical velocity of one material in one sense of loading.
pub fn critical(material: &Material, sense: Sense) -> CriticalRow {
    let curve = material.branch(sense);
    let found = similarity::critical(curve, material.density);
    CriticalRow {
        material: material.name.clone(),
        density_kg_m3: material.density,
        sense,
        critical_velocity_m_s: found.map(|c| c.velocity),
        strain_at_max: found.map(|c| c.strain),
        stress_at_max_pa: found.map(|c| c.stress),
        yield_velocity_m_s: curve.elastic_limit(material.modulus).1 / material.impedance(),
        reason: found.map_or_else(|| why_none(curve), |c| words(c.reason).to_owned()),
    }
}

/// Returns the name of a criterion in JSON and tables.
pub fn words(reason: UltimateReason) -> &'static str {
    match reason {
        UltimateReason::MaximumStress => "maximum-stress",
        UltimateReason::RuptureStrain => "rupture-strain",
    }
}

fn why_none(curve: &Curve) -> String {
    match curve.beyond() {
        Beyond::Extend => "the stress increases without limit: the curve is extrapolated beyond its last row".into(),
        Beyond::Error | Beyond::Rupture => {
            format!("the stress still increases at the end of the data (strain {:.6})", curve.last_strain())
        }
    }
}

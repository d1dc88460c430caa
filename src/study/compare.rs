//! Materials side by side: curve, front speed and impact velocity against strain.

use serde::Serialize;

use super::critical::{CriticalRow, critical};
use crate::material::{Material, Sense};
use crate::wave::similarity;

/// One material of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Compared {
    /// Critical velocity, and what it rests on.
    pub critical: CriticalRow,
    /// Elastic modulus, Pa.
    #[serde(rename = "modulus_Pa")]
    pub modulus_pa: f64,
    /// Elastic wave speed, m/s.
    pub elastic_speed_m_s: f64,
    /// The knots of the curve, from the origin on.
    pub curve: Vec<CurvePoint>,
    /// Fronts that load the bar to the ultimate point, or to the last knot where there is none; fastest first.
    pub fronts: Vec<similarity::Edge>,
}

/// One knot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Engineering strain.
    pub strain: f64,
    /// Engineering stress, Pa.
    #[serde(rename = "stress_Pa")]
    pub stress_pa: f64,
    /// Impact velocity that loads a long bar to this strain, m/s; past the ultimate point none does.
    pub impact_velocity_m_s: Option<f64>,
    /// Speed of the front that carries this strain into a bar loaded to the ultimate point, m/s; past that point
    /// there is none. At the origin: the elastic precursor's.
    pub wave_speed_m_s: Option<f64>,
}

/// Compares materials in one sense of loading.
pub fn compare(materials: &[Material], sense: Sense) -> Vec<Compared> {
    materials.iter().map(|material| one(material, sense)).collect()
}

fn one(material: &Material, sense: Sense) -> Compared {
    let curve = material.branch(sense);
    let end = curve.ultimate().map_or(curve.last_strain(), |u| u.strain);
    let fronts = similarity::hull(curve, material.density, end);
    let velocities = similarity::impact_velocities(curve, material.density);
    let velocity_at = |strain: f64| velocities.iter().find(|v| v.0 == strain).map(|v| v.1);
    let points = curve.strain().iter().zip(curve.stress()).map(|(&strain, &stress_pa)| CurvePoint {
        strain,
        stress_pa,
        impact_velocity_m_s: velocity_at(strain).filter(|_| strain <= end),
        wave_speed_m_s: fronts.iter().find(|front| front.strain_behind >= strain).map(|front| front.speed),
    });
    Compared {
        critical: critical(material, sense),
        modulus_pa: material.modulus,
        elastic_speed_m_s: material.c0(),
        curve: points.collect(),
        fronts,
    }
}

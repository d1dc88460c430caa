//! Comparison of materials: stress, front speed and impact velocity as functions of strain.

use serde::Serialize;

use super::critical::{CriticalRow, critical};
use crate::material::{Curve, Material, Sense};
use crate::wave::similarity;

/// One material of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Compared {
    /// Critical velocity and its criterion.
    pub critical: CriticalRow,
    /// Elastic modulus, Pa.
    #[serde(rename = "modulus_Pa")]
    pub modulus_pa: f64,
    /// Elastic wave speed, m/s.
    pub elastic_speed_m_s: f64,
    /// Knots of the curve, starting at the origin.
    pub curve: Vec<CurvePoint>,
    /// Impact velocity as a function of the strain behind the wave, up to the ultimate point or the last knot. The points are the knots, the points
    /// at which the stress recovers after a drop, and intermediate points, because the velocity does not vary linearly between the knots.
    pub loading: Vec<LoadingPoint>,
    /// Speed of the last front in a bar loaded to a strain of 1 %, m/s; `None` beyond the ultimate point or the last knot.
    #[serde(rename = "wave_speed_1_percent_m_s")]
    pub speed_at_1_percent: Option<f64>,
    /// Speed of the last front in a bar loaded to a strain of 10 %, m/s; `None` beyond the ultimate point or the last knot.
    #[serde(rename = "wave_speed_10_percent_m_s")]
    pub speed_at_10_percent: Option<f64>,
    /// Fronts that load the bar to the ultimate point, or to the last knot if there is none; fastest first.
    pub fronts: Vec<similarity::Edge>,
}

/// One knot of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Engineering strain.
    pub strain: f64,
    /// Engineering stress, Pa.
    #[serde(rename = "stress_Pa")]
    pub stress_pa: f64,
    /// Impact velocity that loads a long bar to this strain, m/s; `None` beyond the ultimate point.
    pub impact_velocity_m_s: Option<f64>,
    /// Speed of the last front in a bar loaded to this strain, m/s: that of a shock if the curve stiffens, 0 if the stress does not increase. At the
    /// origin it is the speed of the elastic precursor. `None` beyond the ultimate point.
    pub wave_speed_m_s: Option<f64>,
}

/// Impact that loads a bar to a given strain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LoadingPoint {
    /// Engineering strain behind the last front.
    pub strain: f64,
    /// Impact velocity, m/s.
    pub impact_velocity_m_s: f64,
    /// Speed of the last front, m/s.
    pub wave_speed_m_s: f64,
}

/// Compares materials in one sense of loading.
pub fn compare(materials: &[Material], sense: Sense) -> Vec<Compared> {
    materials.iter().map(|material| one(material, sense)).collect()
}

fn one(material: &Material, sense: Sense) -> Compared {
    let curve = material.branch(sense);
    let end = curve.ultimate().map_or(curve.last_strain(), |u| u.strain);
    let velocity_at = |strain: f64| match strain {
        0.0 => 0.0,
        _ => similarity::impact_velocity(curve, material.density, strain),
    };
    let speed_at = |strain: f64| last_speed(curve, material.density, strain);
    let within = |strain: f64| (strain <= end).then(|| speed_at(strain));
    let points = curve.strain().iter().zip(curve.stress()).map(|(&strain, &stress_pa)| CurvePoint {
        strain,
        stress_pa,
        impact_velocity_m_s: (strain <= end).then(|| velocity_at(strain)),
        wave_speed_m_s: within(strain),
    });
    let loading = loading_strains(curve, end).into_iter();
    Compared {
        critical: critical(material, sense),
        modulus_pa: material.modulus,
        elastic_speed_m_s: material.c0(),
        curve: points.collect(),
        loading: loading
            .map(|strain| LoadingPoint {
                strain,
                impact_velocity_m_s: velocity_at(strain),
                wave_speed_m_s: speed_at(strain),
            })
            .collect(),
        speed_at_1_percent: within(0.01),
        speed_at_10_percent: within(0.1),
        fronts: similarity::hull(curve, material.density, end),
    }
}

/// Returns the speed of the last front in a bar loaded to a strain, m/s; for strain 0, that of the first front.
fn last_speed(curve: &Curve, density: f64, strain: f64) -> f64 {
    let to = if strain > 0.0 { strain } else { curve.strain()[1] };
    similarity::hull(curve, density, to).last().map_or(0.0, |front| front.speed)
}

/// Returns strains up to `end`: the knots of the running maximum and, between them, points whose mean distance is at most a hundredth of the range.
/// They are denser after a knot, where the velocity can increase like a square root.
fn loading_strains(curve: &Curve, end: f64) -> Vec<f64> {
    let loading = curve.running_maximum();
    let mut strains = vec![0.0];
    for pair in loading.strain().windows(2).filter(|pair| pair[1] <= end) {
        let pieces = ((pair[1] - pair[0]) / (0.01 * end)).ceil().max(1.0);
        let part = |i: usize| pair[0] + (pair[1] - pair[0]) * (i as f64 / pieces).powi(2);
        strains.extend((1..pieces as usize).map(part));
        strains.push(pair[1]);
    }
    strains
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Beyond;

    /// The speed must not be that of the shock to the end of the table, 358 m/s at a strain of 10 %.
    #[test]
    fn speeds_are_those_of_bars_loaded_to_the_strain_where_the_curve_stiffens() {
        let (density, modulus) = (7850.0_f64, 200e9);
        let rows = [(0.001, 200e6), (0.1, 220e6), (0.2, 400e6), (0.3, 420e6)];
        let curve = Curve::new(&rows, Beyond::Rupture).expect("the table is right");
        let compared =
            &compare(&[Material::from_curve("stiff", density, curve).expect("a material")], Sense::Tension)[0];
        let chord = |stress: f64, strain: f64| (stress / strain / density).sqrt();
        let expected =
            [chord(modulus, 1.0), chord(modulus, 1.0), chord(20e6, 0.099), chord(200e6, 0.199), chord(20e6, 0.1)];
        for (point, speed) in compared.curve.iter().zip(expected) {
            let found = point.wave_speed_m_s.expect("within the data");
            assert!((found / speed - 1.0).abs() < 1e-9, "{}: {found} {speed}", point.strain);
        }
        let at = compared.speed_at_1_percent.zip(compared.speed_at_10_percent).expect("within the data");
        assert!((at.0 / expected[2] - 1.0).abs() < 1e-9 && (at.1 / expected[2] - 1.0).abs() < 1e-9, "{at:?}");
        // A shock up to the strain.
        let middle = compared.loading.iter().find(|p| p.strain > 0.15).expect("points between");
        let stress = 220e6 + 1.8e9 * (middle.strain - 0.1);
        assert!((middle.wave_speed_m_s / chord(stress - 200e6, middle.strain - 0.001) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_velocity_stalls_across_a_yield_drop_and_starts_again_where_the_stress_returns() {
        let rows = [(0.0015, 310e6), (0.0016, 250e6), (0.02, 250e6), (0.1, 380e6), (0.2, 430e6)];
        let curve = Curve::new(&rows, Beyond::Error).expect("the table is right");
        let compared = &compare(&[Material::from_curve("drop", 7850.0, curve).expect("a material")], Sense::Tension)[0];
        let back = 0.02 + 60.0 / 130.0 * 0.08;
        let stalled: Vec<_> = compared.loading.iter().filter(|p| p.strain >= 0.0015 && p.strain < back).collect();
        assert!(stalled.len() > 10);
        // Yield velocity of this table to seven digits.
        assert!(stalled.iter().all(|p| (p.impact_velocity_m_s / 7.696_471 - 1.0).abs() < 1e-6));
        let last = compared.loading[compared.loading.len() - 1];
        assert_eq!(last.strain, 0.2);
        assert!((last.impact_velocity_m_s / 62.571_063 - 1.0).abs() < 1e-6);
        assert!(compared.loading.windows(2).all(|p| p[1].strain > p[0].strain));
    }
}

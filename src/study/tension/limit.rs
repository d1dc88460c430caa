//! End of the part of a curve that a specimen can follow in tension: its maximum, or the point at which the fracture criterion is met.

use crate::law::rupture::Cause;
use crate::material::{Beyond, Curve, Material, Sense};
use crate::scene::{Rupture, Scene};
use crate::wave::similarity;

/// Point of the curve of the struck segment at which a section localizes or breaks, whichever comes first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limit {
    /// Engineering strain.
    pub strain: f64,
    /// Engineering stress, Pa.
    pub stress: f64,
}

impl Limit {
    /// Returns the limit of the first segment of a scene; `None` if its curve has no maximum and does not meet the fracture criterion.
    pub fn of(scene: &Scene) -> Option<Self> {
        let curve = scene.bar.segments[0].material.branch(Sense::Tension);
        let broken = scene.effects.rupture.as_ref().and_then(|rupture| strain_at_fracture(curve, rupture));
        let largest = curve.ultimate().map(|ultimate| ultimate.strain);
        let strain = largest.into_iter().chain(broken).min_by(f64::total_cmp)?;
        Some(Self { strain, stress: curve.stress_at(strain) })
    }

    /// Returns the impact velocity that loads the struck end to the limit, m/s.
    pub fn velocity(&self, material: &Material) -> f64 {
        similarity::impact_velocity(material.branch(Sense::Tension), material.density, self.strain)
    }
}

/// Returns the strain at which the first segment breaks under rising load; `None` if its curve does not reach the threshold.
fn strain_at_fracture(curve: &Curve, rupture: &Rupture) -> Option<f64> {
    let notch = rupture.notches.first().copied().unwrap_or(1.0);
    match (rupture.cause, rupture.threshold) {
        (Cause::CriticalStrain, _) => Some(curve.ultimate()?.strain / notch),
        (Cause::Energy, Some(energy)) => strain_of_energy(curve, energy / notch),
        (Cause::Spall, Some(stress)) => strain_of_stress(curve, stress / notch),
        (_, None) => None,
    }
}

/// Iterates over the straight lines of a curve: strain and stress (Pa) at the start, slope (Pa) and length. The last one has no end if the curve is
/// extended.
fn lines(curve: &Curve) -> impl Iterator<Item = [f64; 4]> + '_ {
    let knots = || curve.strain().iter().copied().zip(curve.stress().iter().copied());
    let inside = knots().zip(knots().skip(1)).map(|((e0, s0), (e1, s1))| [e0, s0, (s1 - s0) / (e1 - e0), e1 - e0]);
    let beyond = (curve.beyond() == Beyond::Extend).then(|| knots().next_back()).flatten();
    inside.chain(beyond.map(|(strain, stress)| [strain, stress, curve.last_slope(), f64::INFINITY]))
}

/// Returns the strain up to which a curve absorbs `energy`, J/m^3.
fn strain_of_energy(curve: &Curve, energy: f64) -> Option<f64> {
    let mut left = energy;
    for [strain, stress, slope, length] in lines(curve) {
        // stress d + slope d^2/2 = left, in a form without cancellation.
        let further = 2.0 * left / (stress + (stress * stress + 2.0 * slope * left).sqrt());
        if further <= length {
            return Some(strain + further);
        }
        left -= length * (stress + 0.5 * slope * length);
    }
    None
}

/// Returns the strain at which a curve reaches a stress, Pa.
fn strain_of_stress(curve: &Curve, target: f64) -> Option<f64> {
    lines(curve).find_map(|[strain, stress, slope, length]| {
        let further = (target - stress) / slope;
        (slope > 0.0 && further <= length).then_some(strain + further)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(beyond: Beyond) -> Curve {
        Curve::new(&[(0.001, 200e6), (0.05, 350e6), (0.1, 400e6)], beyond).expect("a curve")
    }

    #[test]
    fn thresholds_are_found_inside_and_beyond_the_table() {
        let (extended, ending) = (curve(Beyond::Extend), curve(Beyond::Error));
        // Areas below the lines: 0.1 MJ/m^3, 13.475 MJ/m^3 and 18.75 MJ/m^3.
        for (energy, strain) in [(0.1e6, 0.001), (13.575e6, 0.05), (32.325e6, 0.1), (0.025e6, 0.0005)] {
            let found = strain_of_energy(&extended, energy).expect("a strain");
            assert!((found - strain).abs() < 1e-12, "{energy}: {found}");
        }
        // Beyond the table: 400 MPa d + 1 GPa d^2/2 = 41 MJ/m^3 for d = 0.0917.
        let d = 0.0917;
        let found = strain_of_energy(&extended, 32.325e6 + 400e6 * d + 0.5e9 * d * d).expect("a strain");
        assert!((found - 0.1 - d).abs() < 1e-12, "{found}");
        assert_eq!((strain_of_energy(&ending, 40e6), strain_of_stress(&ending, 401e6)), (None, None));
        for (stress, strain) in [(100e6, 0.0005), (375e6, 0.075), (450e6, 0.15)] {
            assert!((strain_of_stress(&extended, stress).expect("a strain") - strain).abs() < 1e-12);
        }
    }
}

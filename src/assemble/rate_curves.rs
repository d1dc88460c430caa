//! Curves along which a rate-dependent bar is loaded just after a sudden load.
//!
//! A jump of the load starts no centred fan in such a bar: the waves spread with time, the strain rates in them fall as 1/t, and the stress falls
//! with them. By most rate laws, however, it falls only with the logarithm of the rate. Over the few steps for which grid schemes need an exact
//! start, that change is negligible, and the bar can be treated as rate-independent, with curves raised by the overstress at the rates of these
//! steps.

use std::sync::Arc;

use crate::bar::{Driver, InitialFan};
use crate::law::Table;
use crate::law::rate::{Hardening, Overstress};
use crate::material::{Beyond, Curve, Material};
use crate::scene::{Effects, Scene};

/// Plastic strain rate times the time since the load, relative to the plastic strain. In the fan of a power law with exponent n the value is
/// `2/(1 - n)`; at the slow end of the fan, where the strain comes to rest, it is a hundredth of that.
const RATE: f64 = 0.4;

/// Plastic strains at which a raised curve has knots besides those of its material: a geometric series from the first value by this factor, up to the
/// last value for curves that are extended.
const FIRST: f64 = 1e-8;
const FACTOR: f64 = 1.3;
const LAST: f64 = 1.0;

/// Relative difference below which two strains count as equal.
const SAME: f64 = 1e-9;

/// Number of relaxation times after which the overstress of an elastic wave has decayed.
const RELAXATION_TIMES: f64 = 3.0;

/// Returns the scene with a rate-independent bar, on the curves that its rate law gives at `time` (s) after a load.
pub(super) fn rate_independent(scene: &Scene, time: f64) -> Scene {
    let mut scene = scene.clone();
    for segment in &mut scene.parts.bar.segments {
        raise_curves(Arc::make_mut(&mut segment.material), &scene.parts.effects, time);
    }
    (scene.parts.effects.rate, scene.parts.effects.heat) = (None, None);
    scene
}

/// Returns whether flow relaxes the elastic stress of the first response within `time` (s) after a load, so that the state behind the load is that of
/// the fan.
pub(super) fn has_relaxed(fan: &InitialFan, scene: &Scene, time: f64) -> bool {
    let material = &scene.bar.segments[fan.segment].material;
    let Some(law) = scene.effects.rate.and_then(|rate| Overstress::of(rate, material)) else { return true };
    let (ahead, behind) = (fan.sense.sign() * fan.stress_ahead(), fan.fan.stress);
    let elastic = if fan.driver == Driver::Stress { behind } else { ahead + material.impedance() * fan.fan.velocity };
    let (_, limit) = material.branch(fan.sense).elastic_limit(material.modulus);
    elastic > limit && law.relaxation_rate(elastic - limit, limit) * time > RELAXATION_TIMES
}

/// Raises the curves of a material to the rates at `time` (s) after a load. The curves of a heated material are its adiabatic ones.
fn raise_curves(material: &mut Material, effects: &Effects, time: f64) {
    material.heating = None;
    let Some(law) = effects.rate.and_then(|rate| Overstress::of(rate, material)) else { return };
    let modulus = material.modulus;
    for curve in [&mut material.tension].into_iter().chain(&mut material.compression) {
        *curve = raised(curve, modulus, law, time);
    }
}

fn raised(curve: &Curve, modulus: f64, law: Overstress, time: f64) -> Curve {
    let hardening = Hardening::new(&Table::new(curve, modulus));
    let end = curve.ultimate().map_or(curve.last_strain(), |ultimate| ultimate.strain);
    let known = end * modulus - curve.stress_at(end);
    let last = if curve.beyond() == Beyond::Extend { known.max(LAST * modulus) } else { known };
    let geometric = std::iter::successors(Some(FIRST * modulus), |p| Some(FACTOR * p));
    let mut flowed: Vec<f64> = hardening.pieces().iter().map(|piece| piece.start).chain([last]).collect();
    flowed.extend(geometric.take_while(|&p| p < last));
    flowed.retain(|&p| p <= last);
    flowed.sort_by(f64::total_cmp);
    let knot = |&p: &f64| {
        let f = hardening.pieces()[hardening.find(p) as usize].at(p);
        let stress = if p > 0.0 { f + law.overstress(RATE * p / time, f) } else { f };
        ((stress + p) / modulus, stress)
    };
    let mut rows: Vec<(f64, f64)> = flowed.iter().map(knot).collect();
    rows.dedup_by(|next, row| next.0 <= row.0 * (1.0 + SAME));
    // The table of the raised curve ends at the ultimate point.
    let beyond = if curve.ultimate().is_some() { Beyond::Rupture } else { curve.beyond() };
    // A curve that never yields is left unchanged.
    Curve::new(&rows, beyond).unwrap_or_else(|_| curve.clone())
}

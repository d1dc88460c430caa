//! The curves along which a rate-dependent bar is loaded right behind a sudden load.
//!
//! A load that jumps starts no centred fan in such a bar: the waves of a fan spread with time, the strain rates in it fall as 1/t, and the
//! stress falls with them. But by most rate laws it falls with the logarithm of the rate only. In the few steps that schemes on a grid need an
//! exact start for, that is next to nothing, and the bar is one that takes no time, on curves lifted by the overstress of the rates meanwhile.

use std::sync::Arc;

use crate::bar::{Driver, InitialFan};
use crate::law::Table;
use crate::law::rate::{Hardening, Overstress};
use crate::material::{Beyond, Curve, Material};
use crate::scene::{Effects, Scene};

/// The plastic strain rate at a plastic strain, as a part of that over the time since the load. In a fan of a power law with exponent n it is
/// `2/(1 - n)`, at its slow end, where the strain comes to rest, a hundredth of that.
const RATE: f64 = 0.4;

/// Plastic strains at which a lifted curve has knots, beside those of its material: from the first one, each larger by a factor, up to the
/// last one where a curve is extended.
const FIRST: f64 = 1e-8;
const FACTOR: f64 = 1.3;
const LAST: f64 = 1.0;

/// Strains that differ by less are one.
const SAME: f64 = 1e-9;

/// Relaxation times after which the stress of an elastic wave is gone.
const GONE: f64 = 3.0;

/// The scene with a bar that takes no time to flow, on the curves of its rate law at a `time` (s) after a load.
pub(super) fn taking_no_time(scene: &Scene, time: f64) -> Scene {
    let mut scene = scene.clone();
    for segment in &mut scene.parts.bar.segments {
        lift(Arc::make_mut(&mut segment.material), &scene.parts.effects, time);
    }
    (scene.parts.effects.rate, scene.parts.effects.heat) = (None, None);
    scene
}

/// Within this `time` (s) after a load, flow relaxes the elastic stress with which the bar of this scene answers it at first: the state behind it is
/// then that of the fan.
pub(super) fn has_relaxed(fan: &InitialFan, scene: &Scene, time: f64) -> bool {
    let material = &scene.bar.segments[fan.segment].material;
    let Some(law) = scene.effects.rate.and_then(|rate| Overstress::of(rate, material)) else { return true };
    let (ahead, behind) = (fan.sense.sign() * fan.stress_ahead(), fan.fan.stress);
    let elastic = if fan.driver == Driver::Stress { behind } else { ahead + material.impedance() * fan.fan.velocity };
    let (_, limit) = material.branch(fan.sense).elastic_limit(material.modulus);
    elastic > limit && law.relaxation_rate(elastic - limit, limit) * time > GONE
}

/// The curves of a heated material are its adiabatic ones.
fn lift(material: &mut Material, effects: &Effects, time: f64) {
    material.heating = None;
    let Some(law) = effects.rate.and_then(|rate| Overstress::of(rate, material)) else { return };
    let modulus = material.modulus;
    for curve in [&mut material.tension].into_iter().chain(&mut material.compression) {
        *curve = lifted(curve, modulus, law, time);
    }
}

fn lifted(curve: &Curve, modulus: f64, law: Overstress, time: f64) -> Curve {
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
    // Its table ends at the ultimate point.
    let beyond = if curve.ultimate().is_some() { Beyond::Rupture } else { curve.beyond() };
    // A curve that never yields stays as it is.
    Curve::new(&rows, beyond).unwrap_or_else(|_| curve.clone())
}

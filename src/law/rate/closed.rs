//! Closed formulas of the overstress laws, for many cells at once.

#![expect(
    clippy::needless_bitwise_bool,
    reason = "`&&` and `||` are branches, and the compiler does not turn these into vectors"
)]

use super::driven::{Driven, relaxed};
use crate::elementary::{exp, exp_m1, ln, ln_1p};

/// A closed, branch-free form of [`super::Overstress::flow`].
pub(super) trait Closed: Copy {
    /// Returns true if the rate depends on the static stress too.
    fn needs_static_stress(self) -> bool;

    /// Computes a quantity that stays constant during the iteration for the flow, from overstress and static stress at the start, Pa.
    fn at_start(self, excess: f64, f: f64) -> f64;

    /// Returns the flow, Pa, and whether the formula is valid. `known` is the result of [`Self::at_start`], and a guess of the flow.
    fn flow(self, driven: Driven, gain: f64, f: f64, known: [f64; 2]) -> (f64, bool);

    /// Returns the overstress over which the rate changes by a factor e, see [`super::Overstress::width`].
    fn width(self, x: f64, f: f64) -> f64;
}

/// Largest logarithm of a factor of the flow; products of such factors do not overflow.
const LARGEST: f64 = 300.0;

/// Returns `(exp(a) - 1)/a`.
#[inline(always)]
fn mean_exp(a: f64) -> f64 {
    let mean = exp_m1(a) / a;
    if a.abs() < 1e-9 { 1.0 + 0.5 * a } else { mean }
}

/// Returns `a` and true if |a| < [`LARGEST`], else [`LARGEST`] and false.
#[inline(always)]
fn bounded(a: f64) -> (f64, bool) {
    let is_fine = a.abs() < LARGEST;
    (if is_fine { a } else { LARGEST }, is_fine)
}

/// Limits the drop of the overstress to the whole excess and rise. Below the rate at which the law flows on the static curve, the curve is followed.
#[inline(always)]
fn to_curve(drop: f64, driven: Driven) -> f64 {
    let most = driven.excess + driven.rise;
    if (driven.rise > 0.0) & (drop > most) { most } else { drop }
}

/// Closed form of [`super::Overstress::Malvern`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Malvern {
    pub k: f64,
}

impl Closed for Malvern {
    #[inline(always)]
    fn needs_static_stress(self) -> bool {
        false
    }

    #[inline(always)]
    fn at_start(self, _: f64, _: f64) -> f64 {
        0.0
    }

    #[inline(always)]
    fn flow(self, driven: Driven, gain: f64, _: f64, _: [f64; 2]) -> (f64, bool) {
        let [start, rise] = relaxed(self.k, gain, driven.time);
        (driven.excess * start + driven.rise * rise, true)
    }

    #[inline(always)]
    fn width(self, x: f64, _: f64) -> f64 {
        x
    }
}

/// Closed form of [`super::Overstress::JohnsonCook`].
#[derive(Debug, Clone, Copy)]
pub(super) struct JohnsonCook {
    pub c: f64,
    pub rate: f64,
}

impl Closed for JohnsonCook {
    #[inline(always)]
    fn needs_static_stress(self) -> bool {
        true
    }

    #[inline(always)]
    fn at_start(self, excess: f64, f: f64) -> f64 {
        let (start, is_fine) = bounded(excess / (self.c * f));
        if is_fine { exp(start) } else { f64::NAN }
    }

    /// Uses the formula of [`Driven::exponential`].
    #[inline(always)]
    fn flow(self, driven: Driven, gain: f64, f: f64, [start, _]: [f64; 2]) -> (f64, bool) {
        let width = self.c * f;
        let part = width.recip();
        let (a, is_fine) = bounded(driven.rise * part);
        let grown = gain * self.rate * driven.time * part * start * mean_exp(a);
        (to_curve(width * ln_1p(grown), driven) / gain, is_fine & (grown < f64::MAX))
    }

    #[inline(always)]
    fn width(self, _: f64, f: f64) -> f64 {
        self.c * f
    }
}

/// Power law with an exponent above 1: [`super::Overstress::CowperSymonds`] and, with a thermal stress, [`super::Overstress::ZerilliArmstrong`].
#[derive(Debug, Clone, Copy)]
pub(super) struct PowerAboveOne {
    pub rate: f64,
    pub exponent: f64,
    /// Thermal stress X of Zerilli and Armstrong's law, Pa.
    pub thermal: Option<f64>,
}

/// Smallest stress after a guessed flow, relative to the stress without flow. A smaller value means that the guess was too large.
const LEAST: f64 = 1e-3;

impl Closed for PowerAboveOne {
    #[inline(always)]
    fn needs_static_stress(self) -> bool {
        self.thermal.is_none()
    }

    #[inline(always)]
    fn at_start(self, _: f64, _: f64) -> f64 {
        0.0
    }

    /// Uses the formula of [`Driven::power`].
    #[inline(always)]
    fn flow(self, driven: Driven, gain: f64, f: f64, [_, guess]: [f64; 2]) -> (f64, bool) {
        let (f, start) = self.thermal.map_or((f, 0.0), |thermal| (thermal, thermal));
        let first = start + driven.excess;
        let (end, least) = (first + driven.rise - gain * guess, LEAST * (first + driven.rise.abs()));
        let y = if end > least { end } else { least };
        let (width, part) = (y / self.exponent, self.exponent / y);
        let (a, is_fine) = bounded(driven.rise * part);
        let fall = first - y;
        let (exponent, is_number) = bounded(self.exponent * ln(y / f) + fall * part);
        let grown = gain * self.rate * driven.time * part * exp(exponent) * mean_exp(a);
        let flow = to_curve(width * ln_1p(grown), driven) / gain;
        // For a large drop, the exponential flows more than the power law needs to reach its static curve.
        let is_near = (driven.rise > 0.0) | ((driven.rise < 0.0) & (fall * part <= 1.0) & (fall <= y - start));
        (flow, is_fine & is_number & (end > least) & is_near & !driven.is_still(first))
    }

    #[inline(always)]
    fn width(self, x: f64, _: f64) -> f64 {
        (self.thermal.unwrap_or(0.0) + x) / self.exponent
    }
}

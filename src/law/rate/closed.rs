//! Laws of overstress as plain formulas for many cells at once.

#![expect(
    clippy::needless_bitwise_bool,
    reason = "`&&` and `||` are branches, and the compiler does not turn these into vectors"
)]

use super::driven::{Driven, relaxed};
use crate::elementary::{exp, exp_m1, ln, ln_1p};

/// [`super::Overstress::flow`] without a choice between operations.
pub(super) trait Closed: Copy {
    /// The rate depends on the static stress too.
    fn needs_static_stress(self) -> bool;

    /// What does not change while the flow is looked for, from overstress and static stress at the start, Pa.
    fn at_start(self, excess: f64, f: f64) -> f64;

    /// What flows, Pa, and whether the formula holds; from what [`Self::at_start`] gave, and a guess of the flow.
    fn flow(self, driven: Driven, gain: f64, f: f64, known: [f64; 2]) -> (f64, bool);

    /// Overstress over which the rate changes by a factor e, see [`super::Overstress::width`].
    fn width(self, x: f64, f: f64) -> f64;
}

/// Largest logarithm of a part of what flows: products of such parts are numbers.
const LARGEST: f64 = 300.0;

/// `(exp(a) - 1)/a`.
#[inline(always)]
fn mean_exp(a: f64) -> f64 {
    let mean = exp_m1(a) / a;
    if a.abs() < 1e-9 { 1.0 + 0.5 * a } else { mean }
}

/// `a` where it is an exponent whose power is a number, else the largest one; and whether it is.
#[inline(always)]
fn bounded(a: f64) -> (f64, bool) {
    let is_fine = a.abs() < LARGEST;
    (if is_fine { a } else { LARGEST }, is_fine)
}

/// No more than what rises: below the rate at which it would flow on the static curve, that curve is followed.
#[inline(always)]
fn to_curve(drop: f64, driven: Driven) -> f64 {
    let most = driven.excess + driven.rise;
    if (driven.rise > 0.0) & (drop > most) { most } else { drop }
}

/// See [`super::Overstress::Malvern`].
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

/// See [`super::Overstress::JohnsonCook`].
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

    /// As by [`Driven::exponential`].
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

/// A power of more than 1: [`super::Overstress::CowperSymonds`] and, with a thermal stress, [`super::Overstress::ZerilliArmstrong`].
#[derive(Debug, Clone, Copy)]
pub(super) struct PowerAboveOne {
    pub rate: f64,
    pub exponent: f64,
    /// Pa.
    pub thermal: Option<f64>,
}

/// A stress after a flow that is a guess, of what it is without: that of a better guess is larger.
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

    /// As by [`Driven::power`].
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
        // Far down, an exponential flows more than the power does down to its static curve.
        let is_near = (driven.rise > 0.0) | ((driven.rise < 0.0) & (fall * part <= 1.0) & (fall <= y - start));
        (flow, is_fine & is_number & (end > least) & is_near & !driven.is_still(first))
    }

    #[inline(always)]
    fn width(self, x: f64, _: f64) -> f64 {
        (self.thermal.unwrap_or(0.0) + x) / self.exponent
    }
}

//! Relaxation of an overstress over a step, for laws that are linear in it, a power of it, or exponential.

use crate::elementary::{LARGEST_EXPONENT, exp_m1};
use crate::root::{Tolerance, fixed_point};

/// Returns two coefficients for a law that is linear in the overstress: the flow in a step per initial overstress, and per overstress that rises from
/// zero during the step.
#[inline(always)]
pub(super) fn relaxed(k: f64, gain: f64, time: f64) -> [f64; 2] {
    let z = k * gain * time;
    let used = -exp_m1(if z < LARGEST_EXPONENT { -z } else { -LARGEST_EXPONENT });
    let start = k * time * (1.0 - z * (0.5 - z * (1.0 / 6.0 - z / 24.0)));
    let rise = k * time * (0.5 - z * (1.0 / 6.0 - z * (1.0 / 24.0 - z / 120.0)));
    let part = gain.recip();
    if z < 1e-3 { [start, rise] } else { [used * part, (1.0 - used / z) * part] }
}

/// An overstress x > 0, or x = 0 and rising, with the rise that it would have within a time if nothing flowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Driven {
    /// Overstress at the start, Pa, >= 0.
    pub excess: f64,
    /// Rise during the step if nothing flowed, Pa.
    pub rise: f64,
    /// Duration of the step, s.
    pub time: f64,
}

/// Relative rise below which a stress counts as not driven, see [`Driven::is_still`]. Strains of a few per cent are rounded to some 1e-13 of an
/// overstress.
const STILL: f64 = 1e-11;

/// Power law dp/dt = `rate` ((`start` + x)/`f`)^`exponent` above the static curve x = 0.
#[derive(Clone, Copy)]
pub(super) struct Power {
    pub rate: f64,
    pub exponent: f64,
    pub f: f64,
    /// Stress at x = 0, Pa, >= 0.
    pub start: f64,
}

impl Power {
    /// Returns the rate at y = start + x.
    fn at(self, y: f64) -> f64 {
        self.rate * (y / self.f).powf(self.exponent)
    }
}

impl Driven {
    /// Returns the flow by a law that is linear in x; the coefficients are those of [`relaxed`].
    #[inline]
    pub(super) fn linear(self, k: f64, gain: f64, [start, rise]: [f64; 2]) -> f64 {
        let flow = self.excess * start + self.rise * rise;
        // The condition is a difference of rounded numbers. Where its sign is uncertain, both formulas agree.
        if self.rise >= 0.0 || self.excess + self.rise - gain * flow > 4.0 * f64::EPSILON * (self.excess - self.rise) {
            return flow;
        }
        // The cell unloads to the static curve within the step.
        let fall = -self.rise / (self.time * k * gain);
        let ratio = self.excess / fall;
        let used = match ratio {
            slow if slow < 1e-8 => 0.5 * slow * self.excess,
            quick if quick < f64::MAX => self.excess - fall * quick.ln_1p(),
            _ => self.excess,
        };
        used / gain
    }

    /// Returns the drop of x by the law `gain q = quick exp(x/width)`, for which exp(-x/width) obeys a linear equation.
    pub(super) fn exponential(self, quick: f64, width: f64) -> f64 {
        let flow = exponential_drop(width, quick * self.time / width, self.excess / width, self.rise / width);
        if self.rise > 0.0 {
            // Below the rate at which the law flows on the static curve, the curve is followed.
            return flow.min(self.excess + self.rise);
        }
        let fall = -self.rise / self.time;
        let to_curve = self.excess + width * ((quick + fall * (-self.excess / width).exp()) / (quick + fall)).ln();
        if to_curve >= 0.0 { flow.min(to_curve) } else { flow.min(self.excess) }
    }

    /// Returns true if the stress changes by no more than the rounding of strains; `first` is the stress of the power law, Pa. The flow is then the
    /// closed solution without loading. The solutions with loading differ from it by their error, and rounding must not decide between the two.
    #[inline(always)]
    pub(super) fn is_still(self, first: f64) -> bool {
        self.rise.abs() <= STILL * first
    }

    /// Returns the drop of x by a power of y = start + x.
    pub(super) fn power(self, law: Power, gain: f64) -> f64 {
        let Self { excess, rise, time } = self;
        let first = law.start + excess;
        let decayed = first - self.free(law, gain);
        if self.is_still(first) {
            return (first - decayed).min(excess);
        }
        let most = if rise < 0.0 { self.to_curve(law, gain) } else { excess + rise };
        if excess + rise <= most && rise < 0.0 {
            return most;
        }
        let steady =
            if rise > 0.0 { law.f * (rise / (gain * time * law.rate)).powf(law.exponent.recip()) } else { 0.0 };
        let bounds = [first.min(steady), first.max(steady).min(first + rise)];
        let guess = if steady > first { bounds[1] } else { decayed.max(steady).min(bounds[1]) };
        let from = law.at(first);
        let answer = |y: f64| {
            let drop = if law.exponent > 1.0 {
                let width = y / law.exponent;
                exponential_drop(width, gain * law.at(y) * time / width, (first - y) / width, rise / width)
            } else {
                let slope = if y == first { law.exponent * from / y } else { (law.at(y) - from) / (y - first) };
                let z = gain * slope * time;
                let part = if z.abs() < 1e-9 { 1.0 } else { -(-z).exp_m1() / z };
                rise - (rise - gain * from * time) * part
            };
            first + rise - drop
        };
        let end = fixed_point(guess, bounds, Tolerance::of_differences(first + rise.abs()), answer);
        // If the end is below the static curve, y < start, the curve is followed: the whole overstress is used up.
        (first + rise - end).clamp(0.0, most)
    }

    /// Returns the drop by a power of y without loading: y^(1-q) = y0^(1-q) + (q - 1) gain D f^-q t.
    fn free(self, law: Power, gain: f64) -> f64 {
        let (first, power) = (law.start + self.excess, law.exponent - 1.0);
        if power == 0.0 {
            return -first * (-gain * law.rate / law.f * self.time).exp_m1();
        }
        let grown = power * gain * law.rate / law.f * (first / law.f).powf(power) * self.time;
        // For q < 1 the overstress is used up within a finite time.
        if self.excess <= 0.0 || grown.is_nan() || grown <= -1.0 {
            self.excess
        } else {
            -first * (-grown.ln_1p() / power).exp_m1()
        }
    }

    /// Returns the drop due to flow, by a power of y, until unloading reaches the static curve: the integral of gain q/(gain q + fall) over
    /// x, by Gauss quadrature.
    fn to_curve(self, law: Power, gain: f64) -> f64 {
        let fall = -self.rise / self.time;
        let part = |at: f64| {
            let q = gain * law.at(law.start + self.excess * at);
            if q < f64::MAX { q / (q + fall) } else { 1.0 }
        };
        let pair = |[node, weight]: [f64; 2]| 0.5 * weight * (part(0.5 - 0.5 * node) + part(0.5 + 0.5 * node));
        self.excess * GAUSS.map(pair).iter().sum::<f64>()
    }
}

/// Nodes and weights of the 8-point Gauss rule on -1..1; one of each symmetric pair.
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];

/// Returns `width ln(1 + quick exp(start) (exp(a) - 1)/a)`: the drop of x for a rate that grows as exp(x/width) and amounts to `quick`
/// widths in the step at x = 0. x starts at `start` widths, and the loading raises it by `a` widths.
fn exponential_drop(width: f64, quick: f64, start: f64, a: f64) -> f64 {
    let (start, a) = (start.min(LARGEST), a.clamp(-LARGEST, LARGEST));
    if start + a.max(0.0) < 600.0 && start > -600.0 {
        let mean = if a.abs() < 1e-9 { 1.0 + 0.5 * a } else { a.exp_m1() / a };
        let grown = quick * start.exp() * mean;
        if grown < f64::MAX {
            return width * grown.ln_1p();
        }
    }
    let mean = match a {
        small if small.abs() < 1e-9 => 0.5 * small,
        up if up > 0.0 => up + (-(-up).exp_m1() / up).ln(),
        down => (down.exp_m1() / down).ln(),
    };
    let log = quick.ln() + start + mean;
    width * if log > 40.0 { log } else { log.exp().ln_1p() }
}

/// Replacement for quotients that overflow.
const LARGEST: f64 = 1e300;

#[cfg(test)]
mod tests {
    use super::*;

    /// Under a prescribed stress above a level curve the overstress does not relax.
    #[test]
    fn an_overstress_that_flow_does_not_reduce_flows_at_a_constant_rate() {
        for gain in [0.0, 1e-300, 1e-20] {
            assert_eq!(relaxed(3e6, gain, 2e-7), [3e6 * 2e-7, 0.5 * 3e6 * 2e-7], "{gain}");
        }
    }

    /// The overstress of an impact at hundreds of metres per second is more than a thousand times C f.
    #[test]
    fn no_overstress_is_too_large_to_flow() {
        let (width, time, quick) = (3.2e6, 2e-8, 1e9);
        let mut last = 0.0;
        for k in 1..4000 {
            let excess = f64::from(k) * width;
            let flows = [-1e-3, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-3].map(|part| {
                let driven = Driven { excess, rise: part * width, time };
                driven.exponential(quick, width)
            });
            let [least, most] = [0, 6].map(|i| flows[i]);
            assert!(flows.windows(2).all(|pair| pair[0] <= pair[1] + 1e-12 * excess), "{k}: {flows:?}");
            assert!(most - least <= 2e-3 * width && least >= last - 1e-12 * excess, "{k}: {flows:?}");
            last = least;
        }
        assert!(last > 0.99 * 3999.0 * width, "{last}");
    }
}

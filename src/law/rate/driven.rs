//! Relaxation of an overstress over a step, for laws linear in it, a power of it, or exponential.

use crate::elementary::{LARGEST_EXPONENT, exp_m1};
use crate::root::{Tolerance, fixed_point};

/// For a law that is linear in the overstress: what flows in a step of an overstress, and of one that rises from zero.
#[inline(always)]
pub(super) fn relaxed(k: f64, gain: f64, time: f64) -> [f64; 2] {
    let z = k * gain * time;
    let used = -exp_m1(if z < LARGEST_EXPONENT { -z } else { -LARGEST_EXPONENT });
    let start = k * time * (1.0 - z * (0.5 - z * (1.0 / 6.0 - z / 24.0)));
    let rise = k * time * (0.5 - z * (1.0 / 6.0 - z * (1.0 / 24.0 - z / 120.0)));
    let part = gain.recip();
    if z < 1e-3 { [start, rise] } else { [used * part, (1.0 - used / z) * part] }
}

/// An overstress x > 0, or = 0 and rising, with what it would rise by within a time if nothing flowed: Pa, Pa, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Driven {
    /// At the start, Pa, >= 0.
    pub excess: f64,
    /// Pa.
    pub rise: f64,
    /// s.
    pub time: f64,
}

/// See [`Driven::is_still`]: strains of a few per cent are rounded to some 1e-13 of an overstress.
const STILL: f64 = 1e-11;

/// dp/dt = `rate` ((`start` + x)/`f`)^`exponent` above the static curve, x = 0.
#[derive(Clone, Copy)]
pub(super) struct Power {
    pub rate: f64,
    pub exponent: f64,
    pub f: f64,
    /// >= 0.
    pub start: f64,
}

impl Power {
    /// At y = start + x.
    fn at(self, y: f64) -> f64 {
        self.rate * (y / self.f).powf(self.exponent)
    }
}

impl Driven {
    /// By a law that is linear in x; `parts` as from [`relaxed`].
    #[inline]
    pub(super) fn linear(self, k: f64, gain: f64, [start, rise]: [f64; 2]) -> f64 {
        let flow = self.excess * start + self.rise * rise;
        // Differences of rounded numbers: in doubt both ways are one.
        if self.rise >= 0.0 || self.excess + self.rise - gain * flow > 4.0 * f64::EPSILON * (self.excess - self.rise) {
            return flow;
        }
        // It unloads to the static curve within the step.
        let fall = -self.rise / (self.time * k * gain);
        let ratio = self.excess / fall;
        let used = match ratio {
            slow if slow < 1e-8 => 0.5 * slow * self.excess,
            quick if quick < f64::MAX => self.excess - fall * quick.ln_1p(),
            _ => self.excess,
        };
        used / gain
    }

    /// By `gain q = quick exp(x/width)`: exp(-x/width) obeys a linear equation. As a drop of x.
    pub(super) fn exponential(self, quick: f64, width: f64) -> f64 {
        let flow = exponential_drop(width, quick * self.time / width, self.excess / width, self.rise / width);
        if self.rise > 0.0 {
            // Below the rate at which it would flow on the static curve, that curve is followed.
            return flow.min(self.excess + self.rise);
        }
        let fall = -self.rise / self.time;
        let to_curve = self.excess + width * ((quick + fall * (-self.excess / width).exp()) / (quick + fall)).ln();
        if to_curve >= 0.0 { flow.min(to_curve) } else { flow.min(self.excess) }
    }

    /// The stress is driven by no more than the rounding of strains; `first` is the stress of which a power flows, Pa. What flows is then the
    /// closed solution without a drive, from which those with one differ by their error: rounding must not decide between the two.
    #[inline(always)]
    pub(super) fn is_still(self, first: f64) -> bool {
        self.rise.abs() <= STILL * first
    }

    /// By a power of y = start + x, as a drop of x.
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
        // Where that is below the static curve, y < start, the curve is followed: all of it flows.
        (first + rise - end).clamp(0.0, most)
    }

    /// Drop by a power of y while nothing drives it: y^(1-q) = y0^(1-q) + (q - 1) gain D f^-q t.
    fn free(self, law: Power, gain: f64) -> f64 {
        let (first, power) = (law.start + self.excess, law.exponent - 1.0);
        if power == 0.0 {
            return -first * (-gain * law.rate / law.f * self.time).exp_m1();
        }
        let grown = power * gain * law.rate / law.f * (first / law.f).powf(power) * self.time;
        // Below q = 1 the overstress is used up within a finite time.
        if self.excess <= 0.0 || grown.is_nan() || grown <= -1.0 {
            self.excess
        } else {
            -first * (-grown.ln_1p() / power).exp_m1()
        }
    }

    /// Drop by flow, by a power of y, until unloading has come to the static curve: integral of gain q/(gain q + fall) over
    /// x, by the quadrature of Gauss.
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

/// Nodes and weights of the 8-point rule on -1..1, one of each pair.
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];

/// `width ln(1 + quick exp(start) (exp(a) - 1)/a)`: drop of x by a rate that grows as exp(x/width) and would take `quick`
/// widths in the step at x = 0, from `start` widths on, while x is driven up by `a` widths.
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

/// Stands for a quotient beyond numbers.
const LARGEST: f64 = 1e300;

#[cfg(test)]
mod tests {
    use super::*;

    /// Under a prescribed stress beyond a level curve nothing relaxes.
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

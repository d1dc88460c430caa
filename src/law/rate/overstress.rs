//! Overstress laws: plastic strain rate as a function of the overstress, and its integral over a step of constant strain rate.
//!
//! With x = stress - f the overstress and p = E times the plastic strain, a cell that is strained at a constant rate obeys
//!
//! ```text
//!   dx/dt = rise/time - gain dp/dt,   dp/dt = q(x, f),   no flow below x = 0,
//! ```
//!
//! where `rise` is the increase of x within `time` if nothing flowed (Pa, either sign) and `gain` >= 0 the decrease of x per flow: `E d_eps` and
//! `1 + df/dp` in a cell of given strain. [`Overstress::flow`] integrates this over a whole step. It uses the closed solution for Malvern's law
//! (linear in x) and Johnson and Cook's (linear in exp(-x/(C f))). For powers (Cowper and Symonds; Zerilli and Armstrong) it uses the solution of an
//! exponential (q > 1: with the rate and its derivative at the end of the step) or of a chord (q < 1: with the rates at both ends), which is of
//! second order in the step. Whatever the step, x stays between its start and the steady overstress, where q = rise/(gain time): a step that is long
//! compared with the relaxation time ends there.

use super::driven::{Driven, Power, relaxed};
use crate::material::{Material, Rate};

/// An overstress law. All of them flow only above the static curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Overstress {
    /// Malvern and Sokolovsky: plastic strain rate = k x/E.
    Malvern {
        /// 1/s, > 0.
        k: f64,
    },
    /// Cowper and Symonds (Perzyna): plastic strain rate = D (x/f)^q.
    CowperSymonds {
        /// E D, Pa/s, > 0.
        rate: f64,
        /// q, > 0.
        exponent: f64,
    },
    /// Johnson and Cook: stress = f (1 + C ln(rate/reference)). Above the static curve the rate is at least the reference
    /// rate: plastic strain rate = reference exp(x/(C f)).
    JohnsonCook {
        /// C, > 0.
        c: f64,
        /// E times the reference rate, Pa/s, > 0.
        rate: f64,
    },
    /// Zerilli and Armstrong, the thermal part of body-centred cubic metals, s(rate, T) = C1 exp(-C3 T + C4 T ln(rate/(1/s))): stress = f + s(rate,
    /// T) - s(reference, T), with an overstress independent of f. Above the static curve the rate is at least the reference rate. With X =
    /// s(reference, T) and m = C4 T this is `x = X ((rate/reference)^m - 1)`, plastic strain rate = reference (1 + x/X)^(1/m). F. J. Zerilli, R. W.
    /// Armstrong 1987 (J. Appl. Phys. 61, 1816).
    ZerilliArmstrong {
        /// X, Pa, > 0.
        stress: f64,
        /// m, > 0.
        sensitivity: f64,
        /// E times the reference rate, Pa/s, > 0.
        rate: f64,
        /// -d ln X/dT = C3 - C4 ln(reference/(1/s)) and dm/dT = C4, 1/K.
        thermal: [f64; 2],
    },
}

impl Overstress {
    /// Limit of Malvern's law for an infinite rate: a step ends on the static curve. Used for materials without rate constants.
    pub const RATE_INDEPENDENT: Self = Self::Malvern { k: f64::MAX };

    /// Returns the overstress law of a material. Returns `None` if the constants make the stress that of the static curve, or if the material is to
    /// provide them and does not. If its curve was converted from tension to shear, the constants are converted with it.
    pub fn of(rate: Rate, material: &Material) -> Option<Self> {
        let modulus = material.modulus;
        match material.shear_from_tension.map_or(rate, |ratio| rate.in_shear(ratio)) {
            Rate::Malvern { k } => Some(Self::Malvern { k }),
            Rate::CowperSymonds { d, q } => Some(Self::CowperSymonds { rate: modulus * d, exponent: q }),
            Rate::JohnsonCook { c: 0.0, .. } => None,
            Rate::JohnsonCook { c, reference } => Some(Self::JohnsonCook { c, rate: modulus * reference }),
            Rate::ZerilliArmstrong { c1, c3, c4, reference } => {
                let temperature = material.constants.heat.reference_temperature?;
                let thermal = [c3 - c4 * reference.ln(), c4];
                let cold = Self::ZerilliArmstrong { stress: c1, sensitivity: 0.0, rate: modulus * reference, thermal };
                Some(cold.at_rise(temperature))
            }
            Rate::Material => material.constants.rate.iter().find_map(|&law| Self::of(law, material)),
        }
    }

    /// Returns true if the rate of flow grows so fast with the overstress that the elastic stress of a sharp wave relaxes long before a time step
    /// ends.
    pub fn relaxes_at_once(self) -> bool {
        matches!(self, Self::JohnsonCook { .. } | Self::ZerilliArmstrong { .. })
    }

    /// Returns the law at a temperature that is higher by `rise`, K.
    #[must_use]
    pub fn at_rise(self, rise: f64) -> Self {
        let Self::ZerilliArmstrong { stress, sensitivity, rate, thermal } = self else { return self };
        let [decay, slope] = thermal;
        let stress = stress * (-decay * rise).max(LEAST_LOG).exp();
        Self::ZerilliArmstrong { stress, sensitivity: sensitivity + slope * rise, rate, thermal }
    }
}

/// Smallest logarithm of a thermal stress ratio; a smaller ratio is negligible.
const LEAST_LOG: f64 = -40.0;

/// Smallest `gain` used by the power and exponential laws. A smaller one does not change the rate of flow noticeably.
const LEAST_GAIN: f64 = 1e-12;

/// Largest exponent that is evaluated: e^500 times any rate removes any overstress at once.
const LARGEST_EXPONENT: f64 = 500.0;

impl Overstress {
    /// Returns dp/dt, Pa/s: E times the plastic strain rate at overstress x > 0 above the static stress f, Pa.
    pub fn rate(self, x: f64, f: f64) -> f64 {
        match self {
            Self::Malvern { k } => k * x,
            Self::CowperSymonds { rate, exponent } => rate * (x / f).powf(exponent),
            Self::JohnsonCook { c, rate } => rate * (x / (c * f)).min(LARGEST_EXPONENT).exp(),
            Self::ZerilliArmstrong { stress, sensitivity, rate, .. } => {
                rate * ((x / stress).ln_1p() / sensitivity).min(LARGEST_EXPONENT).exp()
            }
        }
    }

    /// Returns the overstress, Pa, at which the law flows at `flow_rate`, Pa/s (E times the plastic strain rate, > 0), above the static stress
    /// f, Pa: the inverse of [`Self::rate`]. 0 below a reference rate.
    pub fn overstress(self, flow_rate: f64, f: f64) -> f64 {
        match self {
            Self::Malvern { k } => flow_rate / k,
            Self::CowperSymonds { rate, exponent } => f * (flow_rate / rate).powf(1.0 / exponent),
            Self::JohnsonCook { c, rate } => c * f * (flow_rate / rate).ln().max(0.0),
            Self::ZerilliArmstrong { stress, sensitivity, rate, .. } => {
                stress * (sensitivity * (flow_rate / rate).ln()).exp_m1().max(0.0)
            }
        }
    }

    /// Returns the plastic flow of a cell strained at a constant rate above a static stress f, Pa: E times plastic strain, Pa, >= 0.
    #[inline]
    pub fn flow(self, driven: Driven, gain: f64, f: f64) -> f64 {
        if driven.time <= 0.0 {
            return 0.0;
        }
        match self {
            Self::Malvern { k } => driven.linear(k, gain, relaxed(k, gain, driven.time)),
            // q = 1 is Malvern's law with k = D E/f.
            Self::CowperSymonds { rate, exponent: 1.0 } => {
                driven.linear(rate / f, gain, relaxed(rate / f, gain, driven.time))
            }
            Self::CowperSymonds { rate, exponent } => {
                let gain = gain.max(LEAST_GAIN);
                driven.power(Power { rate, exponent, f, start: 0.0 }, gain) / gain
            }
            Self::JohnsonCook { c, rate } => {
                let gain = gain.max(LEAST_GAIN);
                driven.exponential(gain * rate, c * f) / gain
            }
            Self::ZerilliArmstrong { stress, sensitivity, rate, .. } => {
                let (gain, exponent) = (gain.max(LEAST_GAIN), sensitivity.recip());
                driven.power(Power { rate, exponent, f: stress, start: stress }, gain) / gain
            }
        }
    }

    /// Returns the relative rate at which a small change of the overstress decays in a cell of given strain, 1/s: the reciprocal of the relaxation
    /// time.
    pub fn relaxation_rate(self, x: f64, f: f64) -> f64 {
        self.rate(x, f) / self.width(x, f)
    }

    /// Returns the overstress over which the rate changes by a factor e (for Malvern's law: x itself), Pa.
    pub fn width(self, x: f64, f: f64) -> f64 {
        match self {
            Self::Malvern { .. } => x,
            Self::CowperSymonds { exponent, .. } => x / exponent,
            Self::JohnsonCook { c, .. } => c * f,
            Self::ZerilliArmstrong { stress, sensitivity, .. } => sensitivity * (stress + x),
        }
    }

    /// Returns true if the rate depends on f too, which then changes while the cell flows.
    pub fn needs_static_stress(self) -> bool {
        !matches!(self, Self::Malvern { .. } | Self::ZerilliArmstrong { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAWS: [Overstress; 9] = [
        zerilli_armstrong(100e6, 0.12),
        zerilli_armstrong(1e6, 0.4),
        zerilli_armstrong(50e6, 1.5),
        Overstress::Malvern { k: 1e6 },
        Overstress::CowperSymonds { rate: 200e9 * 40.0, exponent: 5.0 },
        Overstress::CowperSymonds { rate: 200e9 * 40.0, exponent: 1.0 },
        Overstress::CowperSymonds { rate: 200e9 * 40.0, exponent: 0.5 },
        Overstress::JohnsonCook { c: 0.014, rate: 200e9 },
        Overstress::JohnsonCook { c: 0.3, rate: 200e9 * 50.0 },
    ];

    const fn zerilli_armstrong(stress: f64, sensitivity: f64) -> Overstress {
        Overstress::ZerilliArmstrong { stress, sensitivity, rate: 200e9, thermal: [5e-3, 4e-4] }
    }

    /// Returns the overstress after a step, by many steps of the midpoint rule; the one that reaches the static curve is split there.
    fn integrated(law: Overstress, driven: Driven, gain: f64, f: f64) -> f64 {
        let steps = 20_000;
        let h = driven.time / f64::from(steps);
        let drive = driven.rise / driven.time;
        let slope = |x: f64| drive - if x > 0.0 { gain * law.rate(x, f) } else { 0.0 };
        (0..steps).fold(driven.excess, |x, _| {
            let step = h * slope(x + 0.5 * h * slope(x));
            if x > 0.0 && x + step < 0.0 { drive * h * (1.0 + x / step) } else { x + step }
        })
    }

    /// Returns the error bound of a step as long as `part` of the relaxation time, loaded at `drive` times the initial rate of flow. Closed
    /// solutions have the error of the reference. Approximations are of third order unless the loading is steady; the
    /// quadrature to the static curve has eight points.
    fn error_bound(law: Overstress, part: f64, drive: f64, to_curve: bool) -> f64 {
        let closed = 1e-7;
        let (third_order, quadrature) = match law {
            Overstress::CowperSymonds { exponent, .. } if exponent > 1.0 => (0.04, closed),
            Overstress::CowperSymonds { exponent, .. } if exponent < 1.0 => (1.2, 4e-4),
            // Error of a power law, 1/q^2, of the thermal stress X + x.
            Overstress::ZerilliArmstrong { sensitivity, stress, .. } if sensitivity < 1.0 => {
                (sensitivity * sensitivity * (1.0 + stress / 50e6), closed)
            }
            Overstress::ZerilliArmstrong { .. } => (1.2, 4e-4),
            _ => return closed,
        };
        match (drive, to_curve) {
            (0.0 | 1.0, _) => closed,
            (_, true) => quadrature,
            _ => (third_order * part.powi(3) * drive.abs()).min(0.04),
        }
    }

    #[test]
    fn the_flow_solves_its_differential_equation() {
        let (x, f, gain) = (50e6, 200e6, 0.6);
        for law in LAWS {
            for part in [0.02, 0.2, 2.0] {
                let time = part * law.width(x, f) / gain / law.rate(x, f);
                for drive in [-3.0, -0.5, 0.0, 0.3, 1.0, 3.0] {
                    let driven = Driven { excess: x, rise: drive * gain * law.rate(x, f) * time, time };
                    let exact = integrated(law, driven, gain, f);
                    let end = x + driven.rise - gain * law.flow(driven, gain, f);
                    let bound = error_bound(law, part, drive, end < 0.0) * x.max(exact);
                    assert!((end - exact).abs() < bound, "{law:?} {part} {drive}: {end:e} {exact:e}");
                }
            }
        }
    }

    #[test]
    fn a_long_step_ends_at_the_steady_overstress() {
        let (f, gain) = (200e6, 1.1);
        for law in LAWS {
            for steady in [1e4, 1e6, 60e6] {
                let rate = gain * law.rate(steady, f);
                for start in [0.0, 0.1 * steady, 0.99 * steady, steady, 2.0 * steady] {
                    let time = 100.0 * law.width(steady, f).max(steady) / rate;
                    let driven = Driven { excess: start, rise: rate * time, time };
                    let end = start + driven.rise - gain * law.flow(driven, gain, f);
                    // The loading is 200 times the overstress, and in Zerilli and Armstrong's law the overstress is a difference of thermal stresses:
                    // both are differences of large numbers.
                    let size = if let Overstress::ZerilliArmstrong { stress, .. } = law { 1e-3 * stress } else { 0.0 };
                    assert!((end - steady).abs() < 1e-11 * (steady + size), "{law:?} {steady} {start}: {end}");
                }
            }
        }
    }

    #[test]
    fn the_overstress_of_a_rate_flows_at_that_rate() {
        for law in LAWS {
            // Above Johnson and Cook's reference rates.
            for rate in [200e9 * 60.0, 200e9 * 1e4] {
                let back = law.rate(law.overstress(rate, 200e6), 200e6);
                // A power of 5 and an exponential of 20 amplify rounding.
                assert!((back / rate - 1.0).abs() < 1e-12, "{law:?}: {back:e} {rate:e}");
            }
        }
    }

    #[test]
    fn the_overstress_never_falls_below_zero() {
        for law in LAWS {
            for x in [1e-200, 1e-3, 1e6, 1e12] {
                for f in [1e-300, 1.0, 200e6] {
                    for gain in [1e-12, 0.25, 0.5, 1e9] {
                        for time in [0.0, 1e-300, 1e-9, 1.0, 1e12] {
                            for rise in [-1e9, -1.0, 0.0, 1e-3, 1e9] {
                                let flow = law.flow(Driven { excess: x, rise, time }, gain, f);
                                let most = x + f64::max(rise, 0.0);
                                let fine = flow >= 0.0 && flow * gain <= most * (1.0 + 1e-15);
                                assert!(fine, "{law:?} {x} {f} {gain} {time} {rise}: {flow}");
                            }
                        }
                    }
                }
            }
        }
    }
}

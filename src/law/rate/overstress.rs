//! How fast a cell flows that carries more than its static flow stress.
//!
//! Along one straight piece of the static curve the overstress x = stress - f obeys `dx/dt = -gain dp/dt`, with
//! `dp/dt = E` times the plastic strain rate and `gain` a constant >= 0. For each law below this has a closed solution
//! (where f enters the law, for a fixed f). So a step of any length needs no iteration, and x never falls below zero.

use crate::material::Material;

/// A law of overstress. All of them flow only above the static curve.
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
    /// Johnson and Cook: stress = f (1 + C ln(rate/reference)), no slower than the reference rate above the static
    /// curve: plastic strain rate = reference exp(x/(C f)).
    JohnsonCook {
        /// C, > 0.
        c: f64,
        /// E times the reference rate, Pa/s, > 0.
        rate: f64,
    },
}

impl Overstress {
    /// The law whose constants a material states: Johnson-Cook's, else Cowper and Symonds', else Malvern's; none where it
    /// states none.
    pub fn of(material: &Material) -> Option<Self> {
        let (stated, modulus) = (&material.constants.rate, material.modulus);
        let johnson_cook = stated.johnson_cook.filter(|law| law.c > 0.0);
        let johnson_cook = johnson_cook.map(|law| Self::JohnsonCook { c: law.c, rate: modulus * law.reference });
        let cowper_symonds =
            || stated.cowper_symonds.map(|law| Self::CowperSymonds { rate: modulus * law.d, exponent: law.q });
        johnson_cook.or_else(cowper_symonds).or_else(|| stated.malvern.map(|k| Self::Malvern { k }))
    }
}

/// Largest exponent that is taken literally: e^500 times any rate empties any overstress at once.
const LARGEST_EXPONENT: f64 = 500.0;

impl Overstress {
    /// dp/dt, Pa/s: E times the plastic strain rate at overstress x > 0 over the static stress f, Pa.
    pub fn rate(self, x: f64, f: f64) -> f64 {
        match self {
            Self::Malvern { k } => k * x,
            Self::CowperSymonds { rate, exponent } => rate * (x / f).powf(exponent),
            Self::JohnsonCook { c, rate } => rate * (x / (c * f)).min(LARGEST_EXPONENT).exp(),
        }
    }

    /// The overstress at which it flows at `flow_rate`, Pa/s (E times the plastic strain rate, > 0), over the static stress
    /// f, Pa: the inverse of [`Self::rate`]. 0 below Johnson and Cook's reference rate.
    pub fn overstress(self, flow_rate: f64, f: f64) -> f64 {
        match self {
            Self::Malvern { k } => flow_rate / k,
            Self::CowperSymonds { rate, exponent } => f * (flow_rate / rate).powf(1.0 / exponent),
            Self::JohnsonCook { c, rate } => c * f * (flow_rate / rate).ln().max(0.0),
        }
    }

    /// Plastic flow within `time`, as E times plastic strain, Pa, from overstress x > 0 on, while f keeps its value.
    /// Never more than x/gain, where the flow stops.
    #[inline]
    pub fn flow(self, x: f64, f: f64, gain: f64, time: f64) -> f64 {
        if gain <= 0.0 {
            return self.rate(x, f) * time;
        }
        let used = match self {
            Self::Malvern { k } => -x * (-k * gain * time).exp_m1(),
            // q = 1 is Malvern's law with k = D E/f.
            Self::CowperSymonds { rate, exponent: 1.0 } => -x * (-rate / f * gain * time).exp_m1(),
            Self::CowperSymonds { rate, exponent } => {
                // x' = -gain D (x/f)^q gives x^(1-q) = x0^(1-q) + (q - 1) gain D f^-q t.
                let power = exponent - 1.0;
                let grown = power * gain * rate / f * (x / f).powf(power) * time;
                // Below q = 1 the overstress is used up within a finite time.
                if grown <= -1.0 { x } else { -x * (-grown.ln_1p() / power).exp_m1() }
            }
            Self::JohnsonCook { c, rate } => {
                // x' = -gain r exp(x/w) gives exp(-x/w) = exp(-x0/w) + gain r t/w.
                let width = c * f;
                width * (gain * rate * time / width * (x / width).min(LARGEST_EXPONENT).exp()).ln_1p()
            }
        };
        used.min(x) / gain
    }

    /// The time in which the overstress x > 0 falls to `to`, 0 < to <= x, by a flow of `flow`, Pa: the inverse of
    /// [`Self::flow`].
    pub fn time(self, [x, to]: [f64; 2], f: f64, gain: f64, flow: f64) -> f64 {
        if gain <= 0.0 {
            return flow / self.rate(x, f);
        }
        match self {
            Self::Malvern { k } => (x / to).ln() / (k * gain),
            Self::CowperSymonds { rate, exponent: 1.0 } => (x / to).ln() / (rate / f * gain),
            Self::CowperSymonds { rate, exponent } => {
                let power = exponent - 1.0;
                ((to / f).powf(-power) - (x / f).powf(-power)) * f / (power * gain * rate)
            }
            Self::JohnsonCook { c, rate } => {
                let width = c * f;
                ((-to / width).exp() - (-x / width).exp()) * width / (gain * rate)
            }
        }
    }

    /// True where the rate depends on f too, which then changes while the cell flows.
    pub fn needs_static_stress(self) -> bool {
        !matches!(self, Self::Malvern { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAWS: [Overstress; 6] = [
        Overstress::Malvern { k: 1e6 },
        Overstress::CowperSymonds { rate: 200e9 * 40.0, exponent: 5.0 },
        Overstress::CowperSymonds { rate: 200e9 * 40.0, exponent: 1.0 },
        Overstress::CowperSymonds { rate: 200e9 * 40.0, exponent: 0.5 },
        Overstress::JohnsonCook { c: 0.014, rate: 200e9 },
        Overstress::JohnsonCook { c: 0.3, rate: 200e9 * 50.0 },
    ];

    #[test]
    fn the_flow_solves_its_differential_equation() {
        let (x, f, gain) = (50e6, 200e6, 0.6);
        for law in LAWS {
            let time = 0.2 * x / gain / law.rate(x, f);
            let steps = 20_000;
            // Midpoint rule with 2e4 steps: an error of 1e-8 or so.
            let h = time / f64::from(steps);
            let mut now = x;
            for _ in 0..steps {
                let middle = now - 0.5 * h * gain * law.rate(now, f);
                now -= h * gain * law.rate(middle, f);
            }
            let flow = law.flow(x, f, gain, time);
            assert!((x - gain * flow - now).abs() < 1e-7 * x, "{law:?}: {} {now}", x - gain * flow);
            let back = law.time([x, x - gain * flow], f, gain, flow);
            assert!((back - time).abs() < 1e-9 * time, "{law:?}: {back:e} {time:e}");
        }
    }

    #[test]
    fn the_overstress_of_a_rate_flows_at_that_rate() {
        for law in LAWS {
            // Above Johnson and Cook's reference rates.
            for rate in [200e9 * 60.0, 200e9 * 1e4] {
                let back = law.rate(law.overstress(rate, 200e6), 200e6);
                // A power of 5 and an exponential of 20 multiply rounding.
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
                            let flow = law.flow(x, f, gain, time);
                            assert!(flow >= 0.0 && flow * gain <= x * (1.0 + 1e-15), "{law:?} {x} {f} {gain} {time}");
                        }
                    }
                }
            }
        }
    }
}

//! Thermal softening: the homologous temperature as a function of plastic work.
//!
//! With theta = (T - Tref)/(Tm - Tref) the stress is the cold stress times g = 1 - theta^m (Johnson and Cook), and plastic work causes the heating
//! `d theta = chi f g dp/(rho c (Tm - Tref))`. In terms of the cold work, `d omega = chi f dp/(rho c (Tm - Tref))`, this is
//! `d theta/d omega = 1 - theta^m`: one function theta(omega) for each m, independent of the curve. It never reaches 1.

/// Nodes and weights of the Gauss-Legendre rule with eight points, the positive half.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

/// Value of x above which theta is 1 to the last bit, and d omega/dx has its limit 1/m.
const MELTED: f64 = 40.0;

/// State of a heated element, stored as x = -ln(1 - theta), which is unbounded and grows roughly in proportion to the work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AdiabaticState {
    exponent: f64,
    x: f64,
}

impl AdiabaticState {
    /// Creates the state at theta = `share`, from 0 (cold) to less than 1; `exponent` is m > 0.
    pub fn at(exponent: f64, share: f64) -> Self {
        Self { exponent, x: -(-share).ln_1p() }
    }

    /// Returns theta, 0 to 1.
    #[cfg(test)]
    pub fn share(self) -> f64 {
        -(-self.x).exp_m1()
    }

    /// Returns the factor of the stress, 1 - theta^m.
    pub fn strength(self) -> f64 {
        -(self.exponent * ln_share(self.x)).exp_m1()
    }

    /// Returns the state after additional cold work `omega` >= 0. The relative error of x is about 1e-12.
    #[must_use]
    pub fn after(self, omega: f64) -> Self {
        if omega <= 0.0 {
            return self;
        }
        let mut x = self.x + omega;
        let mut done = self.work(self.x, x);
        // Newton's method; the function increases and its curvature has one sign, so that a handful of steps suffices.
        for _ in 0..60 {
            let next = (x + (omega - done) / self.pace(x)).max(self.x);
            done += self.work(x, next);
            let change = (next - x).abs();
            x = next;
            if change <= 1e-14 * x {
                break;
            }
        }
        Self { x, ..self }
    }

    /// Returns d omega/dx = (1 - theta)/(1 - theta^m): 1 when cold, 1/m near melting.
    fn pace(self, x: f64) -> f64 {
        if x > MELTED {
            return self.exponent.recip();
        }
        (-x).exp() / -(self.exponent * ln_share(x)).exp_m1()
    }

    /// Returns the cold work from one x to another (negative if that is smaller) by the Gauss rule on intervals that avoid the root at 0, where
    /// theta^m need not be smooth, and are short compared with the scale on which theta^m changes.
    fn work(self, from: f64, to: f64) -> f64 {
        if to < from {
            return -self.work(to, from);
        }
        let molten = (to - from.max(MELTED)).max(0.0) * self.exponent.recip();
        let to = to.min(MELTED);
        let longest = 0.5 / self.exponent.max(1.0);
        let (mut sum, mut b) = (0.0, to);
        while b > from {
            let a = (0.5 * b).max(b - longest).max(from);
            // Contributions below 1e-18 of the whole are neglected.
            let a = if a < 1e-18 * to { from } else { a };
            let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
            let pair = |&(node, weight): &(f64, f64)| {
                weight * (self.pace(middle - half * node) + self.pace(middle + half * node))
            };
            sum += half * GAUSS.iter().map(pair).sum::<f64>();
            b = a;
        }
        sum + molten
    }
}

/// Returns ln theta, accurate at both ends.
fn ln_share(x: f64) -> f64 {
    if x < 1.0 { (-(-x).exp_m1()).ln() } else { (-(-x).exp()).ln_1p() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_integrals_of_the_softening() {
        for omega in [1e-9, 1e-3, 0.1, 0.9, 3.0, 12.0] {
            let share = |m| AdiabaticState::at(m, 0.0).after(omega).share();
            // m = 1: 1 - exp(-omega); m = 2: tanh; and the way from cold may be taken in parts.
            assert!((share(1.0) / -(-omega).exp_m1() - 1.0).abs() < 1e-12, "{omega}");
            assert!((share(2.0) / omega.tanh() - 1.0).abs() < 1e-12, "{omega}");
            for m in [0.3, 0.55, 1.34, 7.5] {
                let parts = (0..10).fold(AdiabaticState::at(m, 0.0), |w, _| w.after(0.1 * omega));
                assert!((parts.share() / share(m) - 1.0).abs() < 1e-11, "{m} {omega}");
            }
        }
        // m = 1/2, with u^2 = theta: omega = 2 (-u - ln(1 - u)).
        for u in [1e-4_f64, 0.1, 0.5, 0.9] {
            let omega = 2.0 * (-u - (-u).ln_1p());
            let share = AdiabaticState::at(0.5, 0.0).after(omega).share();
            assert!((share / (u * u) - 1.0).abs() < 1e-9, "{u}: {share}");
        }
    }

    #[test]
    fn it_never_melts_quite() {
        for m in [0.2, 1.0, 5.0] {
            let warm = AdiabaticState::at(m, 0.0).after(1e6);
            assert!(warm.share() <= 1.0 && warm.strength() >= 0.0 && warm.strength() < 1e-9, "{m} {warm:?}");
        }
    }
}

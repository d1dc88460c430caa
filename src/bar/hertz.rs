//! Hertz contact of a ball with a flat end: the force as a function of the approach.

/// Contact of a ball with a flat end: F = K a^(3/2) at the approach a > 0, K = 4/3 E* sqrt(R); no tension.
///
/// Valid for elastic bodies without friction and a contact area that is small compared with the ball. K. L. Johnson, Contact Mechanics (1985),
/// section 4.2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hertz {
    /// Radius R of the ball, m, > 0.
    pub radius: f64,
    /// Contact modulus E*, Pa, > 0: 1/E* is the sum of (1 - nu^2)/E over both bodies.
    pub modulus: f64,
}

impl Hertz {
    /// Returns the contact of a ball of `radius` (m). `sides` are the modulus (Pa, infinite if rigid) and Poisson's ratio of ball and flat.
    pub fn new(radius: f64, sides: [(f64, f64); 2]) -> Self {
        let compliance: f64 = sides.iter().map(|(modulus, poisson)| (1.0 - poisson * poisson) / modulus).sum();
        Self { radius, modulus: 1.0 / compliance }
    }

    /// Returns K, N/m^(3/2).
    pub fn stiffness(&self) -> f64 {
        4.0 / 3.0 * self.modulus * self.radius.sqrt()
    }

    /// Returns the force at an approach (m), N, >= 0.
    pub fn force(&self, approach: f64) -> f64 {
        let a = approach.max(0.0);
        self.stiffness() * a * a.sqrt()
    }

    /// Returns the approach under a force (N), m; 0 for a force <= 0.
    pub fn approach(&self, force: f64) -> f64 {
        (force.max(0.0) / self.stiffness()).powf(2.0 / 3.0)
    }

    /// Returns the energy stored at an approach (m), J: 2/5 K a^(5/2).
    pub fn energy(&self, approach: f64) -> f64 {
        0.4 * self.force(approach) * approach.max(0.0)
    }

    /// Returns the mean of the force over the approaches between two (m), N: the difference of the energies divided by that of the
    /// approaches. A step that uses it stores exactly the work done.
    pub fn mean_force(&self, from: f64, to: f64) -> f64 {
        let (low, high) = (from.min(to), from.max(to));
        if high <= 0.0 {
            return 0.0;
        }
        if low <= 0.0 {
            return self.energy(high) / (high - low);
        }
        // (q^5 - p^5)/(q^2 - p^2) with the common factor q - p cancelled, which would consist of rounding for close values.
        let (p, q) = (low.sqrt(), high.sqrt());
        let sum = high * high + high * q * p + high * low + q * p * low + low * low;
        0.4 * self.stiffness() * sum / (p + q)
    }

    /// Solves a step that starts at the approach `from` (m), would end at `free` (m) without a force, and is reduced by
    /// `compliance` (m/N, > 0) times the force: the only root of a = free - compliance * `mean_force(from, a)`. Returns that mean force, N.
    ///
    /// The mean force never falls with a and is convex, so that Newton's method converges monotonically from `free` down to the root; the
    /// last steps are rounding.
    pub fn solve(&self, from: f64, free: f64, compliance: f64) -> f64 {
        let mut approach = free;
        for _ in 0..200 {
            let force = self.mean_force(from, approach);
            let missed = approach - free + compliance * force;
            let step = missed / (1.0 + compliance * self.slope(from, approach, force));
            if missed <= 0.0 || approach - step == approach {
                break;
            }
            approach -= step;
        }
        self.mean_force(from, approach)
    }

    /// Returns the derivative of [`Hertz::mean_force`] with respect to `to`, N/m: (force - mean)/(to - from).
    pub fn slope(&self, from: f64, to: f64, mean: f64) -> f64 {
        let width = to - from;
        if width.abs() < 1e-5 * to.abs() {
            return 0.75 * self.stiffness() * to.max(0.0).sqrt();
        }
        (self.force(to) - mean) / width
    }

    /// Returns the largest approach in the impact of a free body of `mass` (kg) at `velocity` (m/s) on a fixed flat, m.
    pub fn largest_approach(&self, mass: f64, velocity: f64) -> f64 {
        (1.25 * mass * velocity * velocity / self.stiffness()).powf(0.4)
    }

    /// Returns the contact time of such an impact, s: 2.943275 times the largest approach over the velocity.
    pub fn contact_time(&self, mass: f64, velocity: f64) -> f64 {
        CONTACT_TIME * self.largest_approach(mass, velocity) / velocity.abs()
    }

    /// Returns an upper bound of the force on the end of a long bar of this `impedance` (N s/m), N: the smaller of the force on a fixed flat and the
    /// force that stops the body at once.
    pub fn most_force(&self, mass: f64, velocity: f64, impedance: f64) -> f64 {
        self.force(self.largest_approach(mass, velocity)).min(impedance * velocity.abs())
    }

    /// Returns the time in which a contact force with this maximum rises and falls, s, by the ratio of approach to time on a fixed flat.
    pub fn time_under(&self, force: f64, velocity: f64) -> f64 {
        CONTACT_TIME * self.approach(force) / velocity.abs()
    }
}

/// 4/5 sqrt(pi) Gamma(2/5)/Gamma(9/10), the integral of 2 dx/sqrt(1 - x^(5/2)) from 0 to 1.
const CONTACT_TIME: f64 = 2.943_275_184_3;

#[cfg(test)]
mod tests {
    use super::*;

    /// A steel ball of 10 mm on steel.
    const STEEL: Hertz = Hertz { radius: 0.005, modulus: 109.89e9 };

    #[test]
    fn the_mean_force_takes_what_is_stored() {
        for (from, to) in [(0.0, 1e-5), (2e-6, 9e-6), (9e-6, 2e-6), (-1e-6, 3e-6), (3e-6, -4e-5)] {
            let stored = STEEL.energy(to) - STEEL.energy(from);
            let work = STEEL.mean_force(from, to) * (to - from);
            // Rounding of the larger energy.
            assert!((work - stored).abs() <= 1e-15 * STEEL.energy(from.max(to)) * 4.0, "{from} {to}");
        }
        assert_eq!(STEEL.mean_force(-1e-6, -2e-6), 0.0);
        let (at, near) = (STEEL.force(5e-6), STEEL.mean_force(5e-6, 5e-6 * (1.0 + 1e-15)));
        assert!((near / at - 1.0).abs() < 1e-14, "{near} {at}");
    }

    #[test]
    fn the_step_is_solved_to_rounding_for_any_compliance() {
        for compliance in [1e-14, 1e-9, 1e-4, 1e3] {
            for (from, free) in [(0.0, 1e-6), (-1e-6, 4e-6), (5e-6, 3e-6), (3e-6, 3e-6), (1e-5, -2e-5)] {
                let force = STEEL.solve(from, free, compliance);
                let approach = free - compliance * force;
                // Error of the approach by its own rounding, and by that of the force times the compliance.
                let rounding = 1e-14 * (compliance * force + free.abs() + f64::abs(from));
                let root = STEEL.mean_force(from, approach + rounding) * compliance - (compliance * force);
                let below = STEEL.mean_force(from, approach - rounding) * compliance - (compliance * force);
                assert!(root >= -rounding && below <= rounding, "{compliance} {from} {free}: {root:e} {below:e}");
            }
        }
        assert_eq!(STEEL.solve(-1e-6, -2e-6, 1e-9), 0.0);
    }

    #[test]
    fn the_largest_approach_is_where_all_energy_is_stored() {
        let most = STEEL.largest_approach(0.004, 3.0);
        assert!((STEEL.energy(most) / (0.5 * 0.004 * 9.0) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_contact_modulus_is_that_of_both_sides() {
        let hertz = Hertz::new(0.005, [(200e9, 0.3), (200e9, 0.3)]);
        assert!((hertz.modulus / (200e9 / (2.0 * 0.91)) - 1.0).abs() < 1e-14);
        let rigid = Hertz::new(0.005, [(f64::INFINITY, 0.0), (200e9, 0.3)]);
        assert!((rigid.modulus / (200e9 / 0.91) - 1.0).abs() < 1e-14);
    }
}

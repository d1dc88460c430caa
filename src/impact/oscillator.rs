//! A linear degree of freedom under a force that is a polynomial in time over a step. Its motion is exact for any step.

use super::decay::decay;

/// Number of coefficients of the force over a step: powers 0 to 3 of time.
pub(super) const TERMS: usize = 4;

/// An oscillator q'' + 2 delta q' + omega^2 q = shape F/mass. Its contribution to the displacement at the contact is shape times q.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    /// Modal mass, kg, > 0.
    pub mass: f64,
    /// Undamped angular frequency, rad/s, >= 0; 0 for a free mass.
    pub omega: f64,
    /// Damping number delta, 1/s, >= 0; above `omega` the motion is overdamped.
    pub delta: f64,
    /// Mode shape at the contact.
    pub shape: f64,
    /// Modal displacement, m.
    pub q: f64,
    /// Modal velocity, m/s.
    pub v: f64,
}

/// g'(t), g(t) and the repeated integrals of g, where g is the response of a unit mass at rest to a unit impulse.
pub(super) type Kernel = [f64; 2 + TERMS];

impl Oscillator {
    /// Creates an oscillator at rest.
    pub fn new(mass: f64, [omega, delta]: [f64; 2], shape: f64) -> Self {
        Self { mass, omega, delta, shape, q: 0.0, v: 0.0 }
    }

    /// Returns the kinetic and elastic energy, J.
    pub fn energy(&self) -> f64 {
        0.5 * self.mass * (self.v * self.v + self.omega * self.omega * self.q * self.q)
    }

    /// Returns a bound of |q| in the free motion that follows: damping only reduces the energy.
    pub(super) fn amplitude(&self) -> f64 {
        self.q.hypot(self.v / self.omega)
    }

    /// Returns bounds of |q| and |v| in the free motion that follows.
    pub(super) fn swing(&self) -> Self {
        let q = self.amplitude();
        Self { q, v: self.omega * q, ..*self }
    }

    /// Returns the oscillator after a time t >= 0 of free motion.
    pub(super) fn after(&self, t: f64) -> Self {
        let mut then = *self;
        if self.q != 0.0 || self.v != 0.0 {
            let [cosine, sine] = decay(self.omega, self.delta, t);
            then.advance(&[cosine - self.delta * sine, sine, 0.0, 0.0, 0.0, 0.0], &[0.0; TERMS]);
        }
        then
    }

    /// Returns bounds of |q''| and |v''| in the free motion that follows, in place of q and v.
    pub(super) fn bend(&self) -> Self {
        let [q, v] = if self.is_aperiodic() {
            let [slow, fast] = self.exponents();
            let parts = [(self.v + fast * self.q, slow), (self.v + slow * self.q, fast)];
            [2, 3].map(|power| parts.iter().map(|(a, rate)| a.abs() * rate.powi(power)).sum::<f64>() / (fast - slow))
        } else {
            // The energy cannot grow, and q' obeys the same equation as q.
            let (stiffness, damping) = (self.omega * self.omega, 2.0 * self.delta);
            let speed = (self.v * self.v + stiffness * self.q * self.q).sqrt();
            let acceleration = (stiffness + damping * damping).sqrt() * speed;
            [acceleration, stiffness * speed + damping * acceleration]
        };
        Self { q, v, ..*self }
    }

    /// Whether the motion is overdamped with two well separated exponents.
    fn is_aperiodic(&self) -> bool {
        self.delta > 1.2 * self.omega
    }

    /// Returns minus the two exponents of overdamped motion, the smaller one first, 1/s.
    fn exponents(&self) -> [f64; 2] {
        let fast = self.delta + ((self.delta - self.omega) * (self.delta + self.omega)).sqrt();
        [self.omega * self.omega / fast, fast]
    }

    /// Returns the displacement after the time of a kernel without a force.
    pub(super) fn coasted(&self, kernel: &Kernel) -> f64 {
        self.q * (kernel[0] + 2.0 * self.delta * kernel[1]) + self.v * kernel[1]
    }

    /// Advances by the time of `kernel`; `terms` are the factors of s^k/k! in the force.
    pub(super) fn advance(&mut self, kernel: &Kernel, terms: &[f64; TERMS]) {
        let sum = |first: usize| terms.iter().zip(&kernel[first..]).map(|(f, g)| f * g).sum::<f64>();
        let push = self.shape / self.mass;
        let q = self.coasted(kernel) + push * sum(2);
        self.v = self.v * kernel[0] - self.omega * self.omega * kernel[1] * self.q + push * sum(1);
        self.q = q;
    }

    /// Returns the kernel at a time t >= 0.
    pub(super) fn kernel(&self, t: f64) -> Kernel {
        let (x, y) = (self.omega * t, 2.0 * self.delta * t);
        if x.max(y) < 1.5 {
            return series(x, y, t);
        }
        if self.is_aperiodic() {
            return self.aperiodic(t);
        }
        let [cosine, sine] = decay(self.omega, self.delta, t);
        let (omega2, damping) = (self.omega * self.omega, 2.0 * self.delta);
        let mut kernel = [cosine - self.delta * sine, sine, 0.0, 0.0, 0.0, 0.0];
        let mut power = 1.0;
        // From the equation of motion: omega^2 G_k = t^k/k! - G_(k-2) - 2 delta G_(k-1).
        for k in 0..TERMS {
            kernel[k + 2] = (power - kernel[k] - damping * kernel[k + 1]) / omega2;
            power *= t / (k + 1) as f64;
        }
        kernel
    }

    fn aperiodic(&self, t: f64) -> Kernel {
        let [slow, fast] = self.exponents();
        let apart = fast - slow;
        let (a, b) = (phi(-slow * t), phi(-fast * t));
        let mut kernel = [(fast * b[0] - slow * a[0]) / apart, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut power = 1.0;
        for k in 0..=TERMS {
            kernel[k + 1] = power * (a[k] - b[k]) / apart;
            power *= t;
        }
        kernel
    }
}

/// Returns the kernel for small omega t = x and 2 delta t = y from its power series.
fn series(x: f64, y: f64, t: f64) -> Kernel {
    const MOST: usize = 40;
    let mut kernel = [0.0; 2 + TERMS];
    let (mut before, mut now) = (0.0, 1.0);
    let mut factorial = 1.0;
    for j in 0..MOST {
        factorial *= if j == 0 { 1.0 } else { j as f64 };
        let mut term = now / factorial;
        for (m, value) in kernel.iter_mut().enumerate() {
            *value += term;
            term /= (j + m + 1) as f64;
        }
        (before, now) = (now, -y * now - x * x * before);
        if now.abs() + before.abs() < 1e-18 * factorial {
            break;
        }
    }
    let mut power = 1.0;
    for value in &mut kernel {
        *value *= power;
        power *= t;
    }
    kernel
}

/// Returns `phi_0 = e^z` and `phi_(k+1)(z) = (phi_k(z) - 1/k!)/z` for z <= 0.
fn phi(z: f64) -> [f64; TERMS + 1] {
    let mut values = [z.exp(), 0.0, 0.0, 0.0, 0.0];
    let mut factorial = 1.0;
    for k in 0..TERMS {
        values[k + 1] = if z.abs() < 1.0 { phi_series(z, k + 1) } else { (values[k] - 1.0 / factorial) / z };
        factorial *= (k + 1) as f64;
    }
    values
}

fn phi_series(z: f64, k: usize) -> f64 {
    let mut term = 1.0 / (1..=k).product::<usize>() as f64;
    let mut sum = 0.0;
    for j in 1..=25 {
        sum += term;
        term *= z / (j + k) as f64;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kernel by many small steps of its series.
    fn stepped(oscillator: Oscillator, t: f64) -> Kernel {
        let steps = 4096;
        let dt = t / f64::from(steps);
        let small = oscillator.kernel(dt);
        let mut sums: Kernel = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for _ in 0..steps {
            // G_k(t + dt): free motion of each integral, and what its own source adds over the step.
            let mut next = sums;
            next[1] = sums[1] * (small[0] + 2.0 * oscillator.delta * small[1]) + sums[0] * small[1];
            next[0] = sums[0] * small[0] - oscillator.omega * oscillator.omega * small[1] * sums[1];
            let mut source = [1.0, 0.0, 0.0, 0.0];
            let _ = &mut source;
            for k in 0..TERMS {
                // Integral over the step of G_(k-1), by its values at the old time and the Taylor terms of the impulse answer.
                next[k + 2] = sums[k + 2] + simpson(&oscillator, sums, k, dt);
            }
            sums = next;
        }
        sums
    }

    fn simpson(oscillator: &Oscillator, sums: Kernel, k: usize, dt: f64) -> f64 {
        let at = |t: f64| taylor(oscillator, sums, k, t);
        dt / 6.0 * (at(0.0) + 4.0 * at(0.5 * dt) + at(dt))
    }

    /// G_(k-1) a little later.
    fn taylor(oscillator: &Oscillator, sums: Kernel, k: usize, t: f64) -> f64 {
        let small = oscillator.kernel(t);
        let free = sums[1] * (small[0] + 2.0 * oscillator.delta * small[1]) + sums[0] * small[1];
        match k {
            0 => free,
            _ => sums[k + 1] + if t == 0.0 { 0.0 } else { simpson(oscillator, sums, k - 1, t) },
        }
    }

    #[test]
    fn free_motion_obeys_its_equation_and_its_bounds() {
        for (omega, delta) in [(3.0, 0.0), (3.0, 0.4), (3.0, 3.0), (3.0, 3.3), (3.0, 4.0), (0.5, 40.0), (0.0, 0.0)] {
            let start = Oscillator { q: 0.3, v: -0.7, ..Oscillator::new(1.0, [omega, delta], 1.0) };
            let (bend, swing) = (start.bend(), start.swing());
            for t in [0.0, 0.01, 0.2, 1.0, 4.0] {
                let [now, then] = [t, t + 1e-6].map(|t| start.after(t));
                let moves = |now: f64, most: f64| now.abs() <= most * (1.0 + 1e-9) || omega == 0.0;
                assert!(moves(now.q, swing.q) && moves(now.v, swing.v), "{omega} {delta} {t}: {now:?} {swing:?}");
                let rate = |q: f64, v: f64| -omega * omega * q - 2.0 * delta * v;
                let acceleration = rate(now.q, now.v);
                let jerk = rate(now.v, acceleration);
                assert!(((then.q - now.q) / 1e-6 - now.v).abs() < 1e-4, "{omega} {delta} {t}");
                assert!(((then.v - now.v) / 1e-6 - acceleration).abs() < 1e-2, "{omega} {delta} {t}");
                assert!(acceleration.abs() <= bend.q * (1.0 + 1e-9), "{omega} {delta} {t}: {acceleration} {bend:?}");
                assert!(jerk.abs() <= bend.v * (1.0 + 1e-9), "{omega} {delta} {t}: {jerk} {bend:?}");
            }
        }
    }

    #[test]
    fn kernels_agree_with_small_steps() {
        for (omega, delta) in [(3.0, 0.0), (3.0, 0.4), (3.0, 3.0), (3.0, 3.3), (3.0, 4.0), (0.5, 40.0), (40.0, 1.0)] {
            let oscillator = Oscillator::new(1.0, [omega, delta], 1.0);
            let (fast, small) = (oscillator.kernel(2.0), stepped(oscillator, 2.0));
            for (a, b) in fast.iter().zip(small) {
                assert!((a - b).abs() < 1e-10 * (1.0 + b.abs()), "{omega} {delta}: {fast:?} {small:?}");
            }
        }
    }
}

//! The half-sine pulse (9.22) on an oscillator: Hoppmann's functions Phi and Psi, and the response (9.24), in closed form.

use std::f64::consts::PI;

use super::decay::decay;
use super::oscillator::Oscillator;

/// Response of an oscillator of unit mass to a pulse of unit impulse.
#[derive(Debug, Clone, Copy)]
pub struct Pulse {
    omega: f64,
    delta: f64,
    /// Angular frequency of the pulse, rad/s.
    rate: f64,
    /// Amplitudes of the forced motion a sin + b cos.
    a: f64,
    b: f64,
}

/// Relative distance from undamped resonance within which the frequency is shifted to this distance above it. The relative error of the response is
/// of the same order, up to 1.5e-4.
const RESONANCE: f64 = 1e-4;

impl Pulse {
    /// Creates a pulse of a duration, s, on an oscillator with omega (rad/s, > 0) and delta (1/s, >= 0).
    pub fn new(omega: f64, delta: f64, duration: f64) -> Self {
        let rate = PI / duration;
        let near = (omega / rate - 1.0).abs().max(delta / rate) < RESONANCE;
        let omega = if near { rate * (1.0 + RESONANCE) } else { omega };
        let (off, loss) = ((omega - rate) * (omega + rate), 2.0 * delta * rate);
        let size = 0.5 * rate / (off * off + loss * loss);
        Self { omega, delta, rate, a: size * off, b: -size * loss }
    }

    /// Returns displacement and velocity at a time t >= 0.
    pub fn at(&self, t: f64) -> [f64; 2] {
        let duration = PI / self.rate;
        if t <= duration {
            return self.forced(t);
        }
        let [q, v] = self.forced(duration);
        let [c, s] = self.free(t - duration);
        [q * c + v * s, v * (c - 2.0 * self.delta * s) - self.omega * self.omega * s * q]
    }

    /// Returns g' + 2 delta g, and g, where g is the response to a unit impulse.
    fn free(&self, t: f64) -> [f64; 2] {
        let [cosine, sine] = decay(self.omega, self.delta, t);
        [cosine + self.delta * sine, sine]
    }

    fn forced(&self, t: f64) -> [f64; 2] {
        let (sine, cosine) = (self.rate * t).sin_cos();
        let [c, s] = self.free(t);
        let start = -self.a * self.rate;
        let q = self.a * sine + self.b * cosine + start * s - self.b * c;
        let velocity = self.rate * (self.a * cosine - self.b * sine) + start * (c - 2.0 * self.delta * s);
        [q, velocity + self.b * self.omega * self.omega * s]
    }

    /// Returns the work of the pulse, J.
    fn work(&self) -> f64 {
        let duration = PI / self.rate;
        let [c, s] = self.free(duration);
        let (p, damping) = (self.rate, 2.0 * self.delta);
        let slope = c - damping * s;
        // Integrals of sin g and cos g over the pulse, from the equation of motion by integration by parts.
        let (off, loss) = ((self.omega - p) * (self.omega + p), damping * p);
        let (x, y) = (-p * s, 1.0 + slope + damping * s);
        let size = off * off + loss * loss;
        let (sine, cosine) = ((off * x + loss * y) / size, (off * y - loss * x) / size);
        // Integral of sin g'.
        let slope = -p * cosine;
        // Integrals of sin times the velocity of the forced and of the free part.
        let forced = -0.5 * self.b * PI;
        let free = -self.a * p * slope + self.b * self.omega * self.omega * sine;
        0.5 * p * (forced + free)
    }
}

/// Returns Hoppmann's Phi and Psi for the damping beta = delta/omega and Q = omega tau/(2 pi): the energy of a mode at the end of the pulse, and
/// the energy dissipated by then, times 2 modal mass over the square of the impulse. Figures 9.3 and 9.4.
pub fn phi_psi(beta: f64, q: f64) -> [f64; 2] {
    if beta == 0.0 {
        let off = 1.0 - 4.0 * q * q;
        // The limit at Q = 1/2 is pi/4; within this distance its relative error is below 3e-8.
        let root = if off.abs() < 1e-7 { PI / 4.0 } else { (PI * q).cos() / off };
        return [root * root, 0.0];
    }
    let omega = 2.0 * PI * q;
    let pulse = Pulse::new(omega, beta * omega, 1.0);
    let [q, v] = pulse.at(1.0);
    let phi = v * v + (omega * q).powi(2);
    [phi, 2.0 * pulse.work() - phi]
}

impl Oscillator {
    /// Returns Phi and Psi for a pulse of a duration, s.
    pub(super) fn phi_psi(&self, duration: f64) -> [f64; 2] {
        phi_psi(self.delta / self.omega, self.omega * duration / (2.0 * PI))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hoppmann_s_table_to_its_printed_digits() {
        let mut rows = 0;
        for row in include_str!("hoppmann_phi_psi.csv").lines().skip(1) {
            let row: Vec<f64> = row.split(',').map(|cell| cell.parse().expect("a number")).collect();
            let [phi, psi] = phi_psi(row[0], row[1]);
            assert!((phi - row[2]).abs() < 0.51e-6 && (psi - row[3]).abs() < 0.51e-6, "{row:?}: {phi} {psi}");
            rows += 1;
        }
        assert_eq!(rows, 48);
    }

    #[test]
    fn the_response_obeys_the_equation_of_motion() {
        for (omega, delta) in [(3.0, 0.0), (3.0, 0.7), (3.0, 3.0), (2.0, 9.0)] {
            let pulse = Pulse::new(omega, delta, 1.5);
            for t in [0.2, 0.7, 1.4, 2.0, 5.0] {
                let h = 1e-5;
                let [q, v] = pulse.at(t);
                let [[before, slower], [after, faster]] = [pulse.at(t - h), pulse.at(t + h)];
                let force = if t < 1.5 { PI / 3.0 * (PI * t / 1.5).sin() } else { 0.0 };
                let acceleration = (faster - slower) / (2.0 * h);
                assert!(((after - before) / (2.0 * h) - v).abs() < 1e-8, "{omega} {delta} {t}");
                assert!(
                    (acceleration + 2.0 * delta * v + omega * omega * q - force).abs() < 1e-7,
                    "{omega} {delta} {t}"
                );
            }
        }
    }
}

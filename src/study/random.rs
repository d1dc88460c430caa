//! Random numbers for the studies. The same seed gives the same numbers on every machine.

use rand::RngExt;
use rand_xorshift::XorShiftRng;

/// Draws a number from the standard normal distribution by the Box-Muller method.
pub(super) fn standard_normal(rng: &mut XorShiftRng) -> f64 {
    let (radius, angle) = (1.0 - rng.random::<f64>(), rng.random::<f64>());
    (-2.0 * radius.ln()).sqrt() * (2.0 * std::f64::consts::PI * angle).cos()
}

//! The area of contact of two bodies: an ellipse if their relative curvatures differ in two directions.

use std::f64::consts::PI;

use crate::bar::Hertz;
use crate::root::bisect;

/// Hertz's contact of bodies with two relative radii of curvature. The force grows with the power 3/2 of the approach, as for a circle. The bodies
/// are elastic and frictionless, and the contact is small compared with both radii. K. L. Johnson, Contact Mechanics (1985), section 4.2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// Hertz's law of the ball on a flat with the same stiffness.
    pub law: Hertz,
    /// Relative radii of curvature, m, the larger first.
    pub radii: [f64; 2],
    /// Squares of the semi-axes in the directions of the radii, divided by the approach, m.
    squares: [f64; 2],
}

impl Ellipse {
    /// Creates the contact of a ball and a flat, or of two balls.
    pub fn circle(law: Hertz) -> Self {
        Self { law, radii: [law.radius; 2], squares: [law.radius; 2] }
    }

    /// Creates the contact of bodies with two relative radii of curvature, m, the larger first; `sides` as for [`Hertz::new`].
    pub fn new(radii: [f64; 2], sides: [(f64, f64); 2]) -> Self {
        let mean = (radii[0] * radii[1]).sqrt();
        let q = axes_ratio(radii[0] / radii[1]);
        let [b, d] = integrals(q);
        // F1 and F2 of (4.26): mean semi-axis and approach under a force, relative to those of a circle with the mean radius.
        let size = (4.0 / PI * (q * b * d).sqrt()).cbrt();
        let approach = 2.0 / PI * q.sqrt() * (b + d) / size;
        let law = Hertz::new(mean * approach.powi(-3), sides);
        let square = mean * size * size / approach;
        Self { law, radii, squares: [square / q, square * q] }
    }

    /// Whether the area is a circle.
    pub fn is_circle(&self) -> bool {
        self.squares[0] == self.squares[1]
    }

    /// Returns the semi-axes at an approach, in the directions of the radii, m.
    pub fn semi_axes(&self, approach: f64) -> [f64; 2] {
        self.squares.map(|square| (square * approach.max(0.0)).sqrt())
    }

    /// Returns the radius of the circle with the area of the contact at an approach, m.
    pub fn mean_radius(&self, approach: f64) -> f64 {
        (self.mean_square() * approach.max(0.0)).sqrt()
    }

    /// Returns the largest pressure at an approach, Pa: 3/2 of the mean pressure.
    pub fn pressure(&self, approach: f64) -> f64 {
        let circle = 2.0 * self.law.modulus / PI * (approach.max(0.0) / self.law.radius).sqrt();
        circle * self.law.radius / self.mean_square()
    }

    fn mean_square(&self) -> f64 {
        if self.is_circle() { self.squares[0] } else { (self.squares[0] * self.squares[1]).sqrt() }
    }
}

/// Returns the ratio of the minor to the major axis of the ellipse for a ratio of the radii >= 1: (4.28), R'/R'' = B/(q^2 D).
fn axes_ratio(radii: f64) -> f64 {
    let ratio = |logarithm: f64| {
        let q = (-logarithm).exp();
        let [b, d] = integrals(q);
        b / (q * q * d)
    };
    // The axes differ by a smaller factor than the radii.
    (-bisect([0.0, radii.max(1.0).ln()], 0.0, |logarithm| ratio(logarithm) < radii)).exp()
}

/// Returns the complete elliptic integrals B and D for the complementary modulus q, 0 < q <= 1: the integrals of cos^2 and sin^2 over sqrt(cos^2 +
/// q^2 sin^2) from 0 to pi/2, with K = B + D and E = B + q^2 D. The arithmetic-geometric mean avoids differences of K and E.
fn integrals(q: f64) -> [f64; 2] {
    let modulus = (1.0 - q) * (1.0 + q);
    let (mut mean, mut other) = (1.0, q);
    // Squares of half the difference of the two means, relative to the initial 1 - q^2, and their weights 2^(n-1).
    let (mut square, mut weight, mut sum) = (1.0, 0.5, 0.5);
    while weight * square > 1e-17 * sum {
        (mean, other) = (0.5 * (mean + other), (mean * other).sqrt());
        square *= square * modulus / (16.0 * mean * mean);
        weight *= 2.0;
        sum += weight * square;
    }
    let k = 0.5 * PI / mean;
    [k * (1.0 - sum), k * sum]
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: [(f64, f64); 2] = [(207e9, 0.3); 2];

    fn close(a: f64, b: f64, most: f64) {
        assert!((a / b - 1.0).abs() < most, "{a} {b}: {:e}", a / b - 1.0);
    }

    #[test]
    fn the_integrals_are_those_of_the_tables() {
        // K and E at the modulus squared 1/2.
        let [b, d] = integrals(0.5_f64.sqrt());
        close(b + d, 1.854_074_677_301_372, 1e-15);
        close(b + 0.5 * d, 1.350_643_881_047_675_5, 1e-15);
        let [b, d] = integrals(1.0);
        close(b, 0.25 * PI, 1e-15);
        close(d, 0.25 * PI, 1e-15);
        // K = ln(4/q) and E = 1 in the limit.
        let [b, d] = integrals(1e-6);
        close(b + d, 4e6_f64.ln(), 1e-11);
        close(b, 1.0, 1e-10);
    }

    #[test]
    fn equal_curvatures_have_the_circle_of_a_ball() {
        let circle = Ellipse::circle(Hertz::new(0.01, STEEL));
        for (larger, most) in [(0.01, 1e-14), (0.01 * (1.0 + 1e-9), 1e-8)] {
            let ellipse = Ellipse::new([larger, 0.01], STEEL);
            close(ellipse.law.stiffness(), circle.law.stiffness(), most);
            close(ellipse.pressure(1e-6), circle.pressure(1e-6), most);
            close(ellipse.mean_radius(1e-6), circle.mean_radius(1e-6), most);
            let [a, b] = ellipse.semi_axes(1e-6);
            close(a, 1e-4, most);
            close(b, 1e-4, most);
        }
    }

    /// The tables of S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, art. 142 (m and n), and of R. J. Roark, Formulas for Stress
    /// and Strain (lambda): cos theta = (R' - R'')/(R' + R''), semi-axes m and n times (3 F/(2 E* (1/R' + 1/R'')))^(1/3), approach lambda
    /// times (F^2 (1/R' + 1/R'')/(1.5 E*^2))^(1/3).
    #[test]
    fn the_ellipse_has_the_coefficients_of_the_tables() {
        for (cosine, m, n, lambda) in [
            (0.1, 1.070, 0.936, 0.748),
            (0.3, 1.242, 0.822, 0.734),
            (0.5, 1.486, 0.717, 0.703),
            (0.8, 2.292, 0.544, 0.594),
        ] {
            let radii = [0.01 * (1.0 + cosine) / (1.0 - cosine), 0.01];
            let ellipse = Ellipse::new(radii, STEEL);
            let (force, modulus, sum) = (1000.0, ellipse.law.modulus, 1.0 / radii[0] + 1.0 / radii[1]);
            let approach = ellipse.law.approach(force);
            let [a, b] = ellipse.semi_axes(approach);
            let unit = (1.5 * force / (modulus * sum)).cbrt();
            // Three decimals.
            close(a / unit, m, 0.001);
            close(b / unit, n, 0.0015);
            close(approach, lambda * (force * force * sum / (1.5 * modulus * modulus)).cbrt(), 0.0015);
            // The force is the integral of the pressure.
            close(ellipse.pressure(approach), 1.5 * force / (PI * a * b), 1e-13);
            close(ellipse.mean_radius(approach), (a * b).sqrt(), 1e-14);
        }
    }
}

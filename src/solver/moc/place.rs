//! Lengths of pieces beyond the rounding of positions, and the accounting of what that rounding shifts.
//!
//! Positions and times are rounded to 1e-16 of the bar's length and of the time. For a wave as short as 1e-9 of the bar that is 1e-7 of its length,
//! and of its energy. Two measures keep energy and momentum balanced: lengths are differences of positions stored as unevaluated sums of two numbers
//! (T. J. Dekker, Numerische Mathematik 18 (1971) 224), and where nodes are moved to a common point, the energy and momentum that this adds to or
//! removes from the bar are accounted for.

use serde::{Deserialize, Serialize};

use super::list::Node;

/// A position, m: an unevaluated sum of some 32 digits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    high: f64,
    low: f64,
}

impl Place {
    pub(super) fn at_rest(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }

    /// Distance from `other` to this position, m.
    pub(super) fn from(self, other: Self) -> f64 {
        (self.high - other.high) + (self.low - other.low)
    }
}

impl Node {
    pub(super) fn place(&self, t: f64) -> Place {
        if self.speed == 0.0 {
            return Place::at_rest(self.x);
        }
        let (elapsed, elapsed_low) = two_sum(t, -self.t);
        let path = self.speed * elapsed;
        let path_low = self.speed.mul_add(elapsed, -path) + self.speed * elapsed_low;
        let (high, low) = two_sum(self.x, path);
        Place { high, low: low + path_low }
    }
}

/// Returns the sum of two numbers and its rounding error (D. E. Knuth, The Art of Computer Programming, vol. 2, 4.2.2).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// Energy (J) and momentum (N s) of some pieces.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Content {
    pub energy: f64,
    pub momentum: f64,
}

/// Sums of what moving nodes to common points has added to the bar so far.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Shifted {
    /// Energy, J, positive if the bar gained.
    pub energy: f64,
    /// Momentum, N s.
    pub momentum: f64,
    /// Sum of the magnitudes of the energy changes, J.
    pub turnover: f64,
}

impl Shifted {
    pub fn add(&mut self, before: Content, after: Content) {
        let gained = after.energy - before.energy;
        self.energy += gained;
        self.momentum += after.momentum - before.momentum;
        self.turnover += gained.abs();
    }
}

#[cfg(test)]
mod tests {
    use super::super::list::Kind;
    use super::*;
    use crate::wave::riemann::Point;

    #[test]
    fn places_keep_what_is_rounded_off() {
        // The number next to 1/3 is 2^-54 of itself less; 1024 less 2^-44 is 1024 to sixteen digits.
        let front = Node::new(Kind::Front, 1.0, 1.0, 1.0 / 3.0, Point::default(), 0);
        let place = front.place(1.0 + 3072.0);
        assert_eq!(front.at(1.0 + 3072.0), 1025.0);
        assert_eq!(place.from(Place::at_rest(1025.0)), -(2.0_f64.powi(-44)));
    }

    #[test]
    fn sums_keep_what_is_rounded_off() {
        assert_eq!(two_sum(1.0, 1e-20), (1.0, 1e-20));
        assert_eq!(two_sum(-1e-20, 1.0), (1.0, -1e-20));
    }
}

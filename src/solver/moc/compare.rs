//! Difference of two front-tracking bars, and whether one is exact.

use super::{FrontTracking, Piece};

impl FrontTracking {
    /// Integrals over x of |difference of stress| from another run of the same bar, and of this run's |stress|, Pa m: exact sums over the constant
    /// pieces of both.
    pub fn stress_difference(&self, other: &Self) -> (f64, f64) {
        self.difference(other, |_, piece| piece.point.stress)
    }

    /// Same for the plastic strain, m.
    pub fn plastic_difference(&self, other: &Self) -> (f64, f64) {
        self.difference(other, |bar, piece| bar.medium(piece.segment).plastic_strain(piece.point))
    }

    fn difference(&self, other: &Self, value: impl Fn(&Self, &Piece<'_>) -> f64) -> (f64, f64) {
        let (mut ours, mut theirs) = (self.pieces().peekable(), other.pieces().peekable());
        let (mut from, mut apart, mut total) = (0.0, 0.0, 0.0);
        while let (Some(a), Some(b)) = (ours.peek(), theirs.peek()) {
            let to = a.to.min(b.to);
            let length = (to - from).max(0.0);
            let (one, another) = (value(self, a), value(other, b));
            apart += (one - another).abs() * length;
            total += one.abs() * length;
            let (a_ends, b_ends) = (a.to <= to, b.to <= to);
            if a_ends {
                ours.next();
            }
            if b_ends {
                theirs.next();
            }
            from = to;
        }
        (apart, total)
    }

    /// Sum of the integrals over x of |change of stress| of all merges so far, Pa m. It is an upper bound of their combined change, and often much
    /// larger.
    pub fn merged(&self) -> f64 {
        self.merging.changed
    }

    /// Returns whether no wave was merged and no ramp or body was resolved by steps: then the solution is exact for the tables, to rounding.
    pub fn is_exact(&self) -> bool {
        self.merging.changed == 0.0 && !self.in_steps
    }
}

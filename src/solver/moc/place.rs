//! Lengths of pieces beyond the rounding of places, and the account of what that rounding moves.
//!
//! Places and times are rounded to 1e-16 of the bar's length and of the time. For a wave as short as 1e-9 of the bar that is
//! 1e-7 of its length, and of its energy. Two measures keep the account of energy and momentum: lengths are differences of
//! places held as unevaluated sums of two numbers (T. J. Dekker, Numerische Mathematik 18 (1971) 224), and where nodes are
//! brought to one point what the shift adds to the bar or takes from it is booked.

use super::FrontTracking;
use super::list::{NONE, Node};

/// A place, m: an unevaluated sum of some 32 digits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    high: f64,
    low: f64,
}

impl Place {
    fn at_rest(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }

    /// Distance from `other` to this place, m.
    fn from(self, other: Self) -> f64 {
        (self.high - other.high) + (self.low - other.low)
    }
}

impl Node {
    fn place(&self, t: f64) -> Place {
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

/// The sum of two numbers and its rounding (D. E. Knuth, The Art of Computer Programming, vol. 2, 4.2.2).
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

/// What bringing nodes to one point has given to the bar so far.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shifted {
    /// J, positive where the bar gained.
    pub energy: f64,
    /// N s.
    pub momentum: f64,
    /// Sum of the magnitudes of the energies, J.
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

impl FrontTracking {
    /// Length of the piece to the right of a node now, m; below zero where rounding let its borders pass each other.
    pub(super) fn length_after(&self, node: &Node) -> f64 {
        self.list.get(node.next).place(self.now).from(node.place(self.now))
    }

    fn add_piece(&self, node: &Node, length: f64, sum: &mut Content) {
        let medium = &self.media[node.segment as usize];
        let volume = medium.area * length;
        sum.energy += volume * medium.energy(&node.right);
        sum.momentum += volume * medium.density * node.right.velocity;
    }

    /// What is between two nodes now.
    pub(super) fn content(&self, first: u32, last: u32) -> Content {
        let (mut sum, mut id) = (Content::default(), first);
        while id != last {
            let node = self.list.get(id);
            self.add_piece(node, self.length_after(node), &mut sum);
            id = node.next;
        }
        sum
    }

    /// The neighbours of the nodes `first..=last`; an end is its own.
    fn around(&self, first: u32, last: u32) -> (u32, u32) {
        let (prev, next) = (self.list.get(first).prev, self.list.get(last).next);
        (if prev == NONE { first } else { prev }, if next == NONE { last } else { next })
    }

    /// Books what it changes that the nodes `first..=last` are all brought to x.
    pub(super) fn book_shift(&mut self, first: u32, last: u32, x: f64) {
        let (from, to) = self.around(first, last);
        let before = self.content(from, to);
        let (place, mut after) = (Place::at_rest(x), Content::default());
        let left = self.list.get(from);
        self.add_piece(left, place.from(left.place(self.now)), &mut after);
        if to != last {
            let right = self.list.get(last);
            self.add_piece(right, self.list.get(to).place(self.now).from(place), &mut after);
        }
        self.booked.shifted.add(before, after);
    }

    /// What part of the energy that is in the bar was moved because places are rounded and near ones count as one: a measure
    /// of the errors of waves too short to be resolved.
    pub fn unresolved(&self) -> f64 {
        let total = self.content(self.end_nodes[0], self.end_nodes[1]).energy;
        if total > 0.0 { self.booked.shifted.turnover / total } else { 0.0 }
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

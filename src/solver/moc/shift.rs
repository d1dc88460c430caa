//! Changes of energy and momentum by moving nodes to a common point.

use super::FrontTracking;
use super::list::{NONE, Node};
use super::place::{Content, Place};

impl FrontTracking {
    /// Present length of the piece to the right of a node, m; negative if its borders have passed each other by rounding.
    pub(super) fn length_after(&self, node: &Node) -> f64 {
        self.list.get(node.next).place(self.now).from(node.place(self.now))
    }

    pub(super) fn add_piece(&self, node: &Node, length: f64, sum: &mut Content) {
        let medium = &self.media[node.segment as usize];
        let volume = medium.area * length;
        sum.energy += volume * medium.energy(&node.right);
        sum.momentum += volume * medium.density * node.right.velocity;
    }

    /// Returns the present energy and momentum between two nodes.
    pub(super) fn content(&self, first: u32, last: u32) -> Content {
        let (mut sum, mut id) = (Content::default(), first);
        while id != last {
            let node = self.list.get(id);
            self.add_piece(node, self.length_after(node), &mut sum);
            id = node.next;
        }
        sum
    }

    /// Returns the neighbours of the nodes `first..=last`; an end is its own neighbour.
    fn around(&self, first: u32, last: u32) -> (u32, u32) {
        let (prev, next) = (self.list.get(first).prev, self.list.get(last).next);
        (if prev == NONE { first } else { prev }, if next == NONE { last } else { next })
    }

    /// Accounts for the change of energy and momentum when the nodes `first..=last` are all moved to x.
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
        self.removed_nodes.shifted.add(before, after);
    }

    /// Energy moved by rounding of positions and by merging of near positions, as a fraction of the energy in the bar: a measure of the errors of
    /// waves too short to be resolved.
    pub fn unresolved(&self) -> f64 {
        let total = self.content(self.end_nodes[0], self.end_nodes[1]).energy;
        if total > 0.0 { self.removed_nodes.shifted.turnover / total } else { 0.0 }
    }
}

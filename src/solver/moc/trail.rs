//! The lives of fronts: straight lines in (x, t), from which x-t diagrams are drawn and gauges are read.

use super::FrontTracking;
use super::list::{Kind, Node};
use crate::wave::riemann::Point;

/// The straight life of a front, from where it was sent to where it met something (or to now), with the constant
/// states on both sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trail {
    /// Places of its start and its end, m.
    pub x: [f64; 2],
    /// Times of its start and its end, s.
    pub t: [f64; 2],
    /// Index of the segment in which it ran.
    pub segment: usize,
    /// State ahead of it.
    pub ahead: Point,
    /// State behind it.
    pub behind: Point,
}

impl FrontTracking {
    /// Trails of the fronts that ended since the last call, in the order in which they ended; empty unless
    /// [`super::Settings::trails`] asks for them.
    pub fn take_trails(&mut self) -> Vec<Trail> {
        self.trails.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Trails, up to now, of the fronts under way, from left to right.
    pub fn living_trails(&self) -> impl Iterator<Item = Trail> + '_ {
        self.list.iter().filter(|n| n.kind == Kind::Front).map(|n| self.trail(n))
    }

    /// Keeps the trail of a front that ends now, where trails are asked for.
    pub(super) fn keep_trail(&mut self, node: &Node) {
        if node.kind == Kind::Front && self.trails.is_some() {
            let trail = self.trail(node);
            self.trails.iter_mut().for_each(|kept| kept.push(trail));
        }
    }

    fn trail(&self, node: &Node) -> Trail {
        let (left, right) = (self.list.get(node.prev).right, node.right);
        let (ahead, behind) = if node.speed > 0.0 { (right, left) } else { (left, right) };
        Trail { x: [node.x, node.at(self.now)], t: [node.t, self.now], segment: node.segment as usize, ahead, behind }
    }
}

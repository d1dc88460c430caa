//! Hands out the trails of fronts, of those that ended and of those under way.

use super::list::{Kind, Node};
use super::{FrontTracking, Trail};

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

//! Output of the segments of ended and active fronts.

use super::list::{Kind, Node};
use super::{FrontSegment, FrontTracking};

impl FrontTracking {
    /// Returns the segments of the fronts that ended since the last call, in the order in which they ended. Empty unless
    /// [`super::Settings::front_segments`] is set.
    pub fn take_front_segments(&mut self) -> Vec<FrontSegment> {
        self.front_segments.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Iterates over the segments of the active fronts up to the present, from left to right.
    pub fn living_front_segments(&self) -> impl Iterator<Item = FrontSegment> + '_ {
        self.list.iter().filter(|n| n.kind == Kind::Front).map(|n| self.piece(n))
    }

    /// Records the segment of a front that ends now, if segments are kept.
    pub(super) fn keep_front_segment(&mut self, node: &Node) {
        if node.kind == Kind::Front && self.front_segments.is_some() {
            let piece = self.piece(node);
            self.front_segments.iter_mut().for_each(|kept| kept.push(piece));
        }
    }

    fn piece(&self, node: &Node) -> FrontSegment {
        let (left, right) = (self.list.get(node.prev).right, node.right);
        let (ahead, behind) = if node.speed > 0.0 { (right, left) } else { (left, right) };
        // By rounding, a front that reaches an end of the bar may pass it.
        let [first, last] = self.end_nodes.map(|id| self.list.get(id).x);
        FrontSegment {
            x: [node.x, node.at(self.now).clamp(first, last)],
            t: [node.t, self.now],
            speed: node.speed,
            segment: node.segment as usize,
            ahead,
            behind,
        }
    }
}

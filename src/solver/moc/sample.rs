//! Reading a tracked bar at many places in one sweep, and letting it go on in bursts.

use super::FrontTracking;
use super::list::{Kind, Node};
use super::tracking::Meeting;
use crate::wave::riemann::Point;

impl FrontTracking {
    /// Memory of a front under way: its node, and its next meeting in the queue.
    pub const BYTES_PER_FRONT: usize = size_of::<Node>() + size_of::<Meeting>();

    /// Hands on the state at every place of `x` (m, increasing, in 0..=length): its index, segment and state. One pass
    /// over the fronts. On a front: the state behind it; on a contact or joint: the right one.
    pub fn sweep(&self, x: &[f64], mut visit: impl FnMut(usize, usize, &Point)) {
        let mut nodes = self.list.iter().peekable();
        let Some(mut found) = nodes.next() else { return };
        for (k, &x) in x.iter().enumerate() {
            while let Some(node) = nodes.next_if(|n| self.is_before(n, x)) {
                found = node;
            }
            visit(k, found.segment as usize, &found.right);
        }
    }

    /// Whether the state to the right of a node counts at x.
    fn is_before(&self, node: &Node, x: f64) -> bool {
        let place = node.at(self.now);
        let right_end = node.kind == Kind::End;
        !right_end && (place < x || (place == x && node.speed <= 0.0))
    }

    /// Displacement at every place of `x` (m, increasing), m: that of the left end, which is the integral of its exact
    /// steps, and the strain summed up exactly over the constant pieces, with what velocity jumps at rest have opened
    /// since they arose. What a wave held back earlier would have opened is left out: with a front tolerance, the
    /// displacement is as good as the tolerance.
    pub fn displacements(&self, x: &[f64], out: &mut [f64]) {
        let mut u = self.end_displacement(0);
        let mut k = 0;
        let right = self.list.iter().skip(1);
        for (a, b) in self.list.iter().zip(right) {
            let (from, to) = (a.at(self.now), b.at(self.now));
            let strain = self.medium(a.segment as usize).strain(&a.right);
            while k < x.len() && (x[k] < to || b.kind == Kind::End) {
                out[k] = u + strain * (x[k] - from);
                k += 1;
            }
            u += strain * (to - from) + self.opening(a, b);
        }
    }

    /// Displacement of the left (0) or right (1) end since the start, m.
    pub fn end_displacement(&self, which: usize) -> f64 {
        let steps = &self.ends()[which].steps;
        let until = steps.iter().skip(1).map(|s| s.time).chain([self.now]);
        steps.iter().zip(until).map(|(step, until)| step.velocity * (until - step.time)).sum()
    }

    /// By how much the place of `node`, to the right of the piece that starts at `before`, has opened since its states
    /// hold, m.
    fn opening(&self, before: &Node, node: &Node) -> f64 {
        match node.kind {
            Kind::Contact | Kind::Joint => (node.right.velocity - before.right.velocity) * (self.now - node.t),
            Kind::Front | Kind::End => 0.0,
        }
    }

    /// Fronts under way.
    pub fn front_count(&self) -> usize {
        self.fronts
    }

    /// Changes the number of events that the run may take in all. [`FrontTracking::advance_to`] stops there, and goes on
    /// when it is called again with a larger budget: so a long run can be interrupted.
    pub fn set_event_budget(&mut self, events: u64) {
        self.budget = events;
    }
}

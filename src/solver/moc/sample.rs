//! Sampling of a front-tracking bar at many positions in one pass, and its advance in batches.

use super::interaction::Interaction;
use super::list::{Kind, Node};
use super::openings::Opening;
use super::{FrontTracking, Stopped};
use crate::wave::riemann::Point;

impl FrontTracking {
    /// Memory of an active front, bytes: its node, and its next interaction in the queue.
    pub const BYTES_PER_FRONT: usize = size_of::<Node>() + size_of::<Interaction>();

    /// Calls `visit` with index, segment and state for every position of `x` (m, increasing, in 0..=length), in one pass over the fronts. On a front,
    /// the state is that behind it; at a contact or joint, that to its right.
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

    /// Returns whether the state to the right of a node applies at x.
    fn is_before(&self, node: &Node, x: f64) -> bool {
        let place = node.at(self.now);
        let right_end = node.kind == Kind::End;
        !right_end && (place < x || (place == x && node.speed <= 0.0))
    }

    /// Displacement at every position of `x` (m, increasing), m: that of the left end, which is the integral of its exact steps, plus the exact sum
    /// of the strains of the constant pieces and of the openings of stationary velocity jumps at joints and at points of a level curve.
    pub fn displacements(&self, x: &[f64], out: &mut [f64]) {
        let left = self.end_displacement(0);
        let (mut stretch, mut k) = (0.0, 0);
        let right = self.list.iter().skip(1);
        for (a, b) in self.list.iter().zip(right) {
            let (from, to) = (a.at(self.now), b.at(self.now));
            let strain = self.medium(a.segment as usize).strain(&a.right);
            while k < x.len() && (x[k] < to || b.kind == Kind::End) {
                out[k] = left + stretch + strain * (x[k] - from);
                k += 1;
            }
            stretch += strain * (to - from) + self.opening(b) + self.jump_at(b);
        }
        self.removed_nodes.opened.add_up(x, self.bar_length(), out);
    }

    /// Displacement of the left (0) or right (1) end since the start, m.
    pub fn end_displacement(&self, which: usize) -> f64 {
        let steps = &self.ends()[which].steps;
        let until = steps.iter().skip(1).map(|s| s.time).chain([self.now]);
        steps.iter().zip(until).map(|(step, until)| step.velocity * (until - step.time)).sum()
    }

    /// Opening at the position of a node since its states hold, m; 0 for a joint that can open, whose opening is recorded separately.
    fn opening(&self, node: &Node) -> f64 {
        match node.kind {
            Kind::Joint if self.contact_at(node).is_some() => 0.0,
            Kind::Contact | Kind::Joint => {
                (node.right.velocity - self.list.get(node.prev).right.velocity) * (self.now - node.t)
            }
            Kind::Front | Kind::End => 0.0,
        }
    }

    /// Opening of a joint that can open since the start, m; 0 for all other nodes.
    fn jump_at(&self, node: &Node) -> f64 {
        if node.kind == Kind::Joint {
            self.contact_at(node).map_or(0.0, |contact| contact.jump_at(self.now))
        } else {
            0.0
        }
    }

    /// Records the opening at the position of a node, before its states change or it is removed.
    pub(super) fn keep_opening(&mut self, node: &Node) {
        let opening = self.opening(node);
        if opening != 0.0 {
            self.removed_nodes.opened.add(node.x / self.bar_length(), opening);
        }
    }

    fn bar_length(&self) -> f64 {
        self.list.get(self.end_nodes[1]).x
    }

    /// Iterates over the stationary positions inside the bar whose two sides move apart or towards each other: points of a level curve where strain
    /// gathers.
    pub fn openings(&self) -> impl Iterator<Item = Opening> + '_ {
        self.list.iter().filter(|n| matches!(n.kind, Kind::Contact | Kind::Joint)).filter_map(|node| {
            let left = self.list.get(node.prev);
            let velocity = node.right.velocity - left.right.velocity;
            (velocity != 0.0).then_some(Opening {
                x: node.x,
                since: node.t,
                velocity,
                sides: [(left.segment as usize, left.right.stress), (node.segment as usize, node.right.stress)],
            })
        })
    }

    /// Number of active fronts.
    pub fn front_count(&self) -> usize {
        self.fronts
    }

    /// Advances the fronts up to and including `until` (s), as [`FrontTracking::advance_to`] does, but by at most `events` events. Returns whether
    /// `until` was reached.
    ///
    /// # Errors
    /// As for [`FrontTracking::advance_to`]; the event budget applies to all calls together.
    pub fn advance_for(&mut self, until: f64, events: u64) -> Result<bool, Stopped> {
        let budget = self.budget;
        self.budget = budget.min(self.events.saturating_add(events));
        let ended = self.advance_to(until);
        self.budget = budget;
        match ended {
            Err(Stopped::EventBudget { events, .. }) if events < budget => Ok(false),
            ended => ended.map(|()| true),
        }
    }
}

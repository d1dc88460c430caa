//! Waves emitted from an interaction of fronts, inside the bar and at its ends.

use super::FrontTracking;
use super::list::{Kind, NONE, Node};
use super::nearness::{ONE_STATE, REST, in_balance, same_motion};
use super::tracking::Scratch;
use crate::wave::riemann::{Emitted, Path, Point, Side, Workspace, solve};

/// Result of the Riemann problem between two states.
struct Inside {
    /// States behind the waves that they emit.
    behind: [Point; 2],
    /// Whether a level curve keeps the velocities of the two sides different.
    capped: bool,
    /// Whether all waves are elastic, so that no paths were computed and those in the workspace belong to an earlier position.
    elastic: bool,
}

impl Scratch {
    /// Solves the Riemann problem of two sides and emits their waves.
    fn send(&mut self, left: Side<'_>, right: Side<'_>) -> Inside {
        let star = solve(left, right, &mut self.work);
        let tau = |path: &Path| (path.sense() * star.force / path.area()).min(path.cap());
        let Workspace { left, right } = &mut self.work;
        let behind_left = left.emit(tau(left), -1.0, &mut self.sent_left);
        let behind_right = right.emit(tau(right), 1.0, &mut self.sent_right);
        Inside { behind: [behind_left, behind_right], capped: star.capped, elastic: false }
    }

    /// Same for one elastic wave, or none, on either side.
    fn send_elastic(&mut self, ahead: [&Point; 2], waves: [Emitted; 2]) -> Inside {
        for (k, sent) in [&mut self.sent_left, &mut self.sent_right].into_iter().enumerate() {
            sent.clear();
            sent.extend((waves[k].behind != *ahead[k]).then_some(waves[k]));
        }
        Inside { behind: waves.map(|wave| wave.behind), capped: false, elastic: true }
    }
}

impl FrontTracking {
    /// Solves the Riemann problem of the nodes `first..=last` that meet at x at the present time, and replaces them by the emitted waves.
    pub(super) fn resolve(&mut self, first: u32, last: u32, x: f64) {
        self.book_shift(first, last, x);
        let before = if self.rupture.is_some() { self.beside_joint(first, last) } else { None };
        let fixed = self.clear(first, last);
        match fixed {
            Some(id) if id == self.end_nodes[0] => self.resolve_end(0, id, x),
            Some(id) if id == self.end_nodes[1] => self.resolve_end(1, id, x),
            Some(id) => {
                let prev = self.list.get(id).prev;
                let right = self.list.get(id).right;
                if !self.resolve_apart(prev, id, right, x) {
                    self.resolve_between((prev, right), Some(id), before, x);
                }
            }
            None => {
                let prev = self.list.get(last).prev;
                let right = self.list.get(last).right;
                self.drop_node(last);
                self.resolve_inside(prev, None, right, x);
            }
        }
    }

    /// Removes the nodes `first..=last` except an end or joint among them, which receives the state to the right of all of them and is returned. If
    /// there is none, the last node remains for the caller to remove.
    fn clear(&mut self, first: u32, last: u32) -> Option<u32> {
        let (right, mut fixed, mut id) = (self.list.get(last).right, None, first);
        loop {
            let node = *self.list.get(id);
            self.book_end_of(&node);
            if node.is_fixed() {
                fixed = Some(id);
            }
            if id == last {
                break;
            }
            id = node.next;
        }
        let Some(kept) = fixed else {
            self.remove_until(first, last);
            return None;
        };
        self.remove_until(first, kept);
        while kept != last && self.list.get(kept).next != last {
            self.drop_node(self.list.get(kept).next);
        }
        if kept != last {
            self.drop_node(last);
        }
        self.list.get_mut(kept).right = right;
        Some(kept)
    }

    /// Accounts for the work, opening and front segment of a node since its states hold, before they change or the node is removed.
    fn book_end_of(&mut self, node: &Node) {
        if matches!(node.kind, Kind::Contact | Kind::Joint) {
            self.removed_nodes.concentrated += self.stretch_work(node);
            self.keep_opening(node);
        }
        self.keep_front_segment(node);
        self.book_work_of(node);
    }

    /// Removes the nodes from `first` to just before `last`.
    fn remove_until(&mut self, first: u32, last: u32) {
        let mut id = first;
        while id != last {
            let next = self.list.get(id).next;
            self.drop_node(id);
            id = next;
        }
    }

    pub(super) fn drop_node(&mut self, id: u32) {
        self.fronts -= usize::from(self.list.get(id).kind == Kind::Front);
        self.list.remove(id);
    }

    /// Work dissipated by a velocity jump at a stationary place since the node was set, J.
    pub(super) fn stretch_work(&self, node: &Node) -> f64 {
        let (left, right) = (self.list.get(node.prev), node);
        let force = |n: &Node| self.media[n.segment as usize].area * n.right.stress;
        0.5 * (force(left) + force(right)) * (right.right.velocity - left.right.velocity) * (self.now - node.t)
    }

    /// Returns the states on both sides of a joint among the nodes `first..=last`, before any of these reaches it; `None` if there is no joint.
    fn beside_joint(&self, first: u32, last: u32) -> Option<[Point; 2]> {
        let mut id = first;
        while !self.list.get(id).is_fixed() {
            if id == last {
                return None;
            }
            id = self.list.get(id).next;
        }
        let node = self.list.get(id);
        (node.prev != NONE).then(|| [self.list.get(node.prev).right, node.right])
    }

    /// Resolves the interaction between the piece to the right of `prev` and the state `right`, at a joint or anywhere.
    pub(super) fn resolve_inside(&mut self, prev: u32, joint: Option<u32>, right: Point, x: f64) {
        self.resolve_between((prev, right), joint, None, x);
    }

    /// Same for sides that were in the states `before` until the waves arrived, as at a joint.
    fn resolve_between(&mut self, (prev, right): (u32, Point), joint: Option<u32>, before: Option<[Point; 2]>, x: f64) {
        let left = self.list.get(prev).right;
        let left_segment = self.list.get(prev).segment;
        let right_segment = joint.map_or(left_segment, |id| self.list.get(id).segment);
        let Inside { behind: [behind_left, behind_right], capped, elastic } =
            self.answer_inside((left_segment, left), (right_segment, right));
        if self.rupture.is_some() {
            // The change of state at the joint may come from waves of both sides at once.
            let [from_left, from_right] = before.unwrap_or([left, right]);
            let sides = [(left_segment, from_left, behind_left), (right_segment, from_right, behind_right)];
            if self.breaks_inside(&sides, capped, joint, x) {
                return self.part(prev, joint, right, x);
            }
        }
        self.note_limit(0, left_segment, [&left, &behind_left], x, elastic);
        self.note_limit(1, right_segment, [&right, &behind_right], x, elastic);
        let medium = &self.media[left_segment as usize];
        let apart = capped
            || !behind_left.same_history(&behind_right, medium)
            || !same_motion(&behind_left, &behind_right, medium, 1.0);
        let before_new = self.send_left(prev, x, left_segment);
        let middle = match joint {
            Some(id) => {
                let kept = self.list.get_mut(id);
                (kept.right, kept.t) = (behind_right, self.now);
                id
            }
            None if apart => {
                self.list.insert(before_new, Node::new(Kind::Contact, x, self.now, 0.0, behind_right, left_segment))
            }
            None => before_new,
        };
        let after_new = self.send_right(middle, x, right, right_segment);
        self.schedule(prev);
        self.schedule(after_new);
    }

    /// Computes the waves emitted by two states in contact, into the scratch of their sides.
    fn answer_inside(&mut self, (left_segment, left): (u32, Point), (right_segment, right): (u32, Point)) -> Inside {
        let (a, b) = (&self.media[left_segment as usize], &self.media[right_segment as usize]);
        let inside = left_segment == right_segment;
        let at_rest = if inside {
            same_motion(&left, &right, a, REST)
        } else {
            self.merging.is_on() && in_balance(a, &left, b, &right)
        };
        if at_rest {
            self.scratch.sent_left.clear();
            self.scratch.sent_right.clear();
            return Inside { behind: [left, right], capped: false, elastic: true };
        }
        let waves = inside.then(|| a.elastic_waves(&left, &right)).flatten();
        let Inside { behind: [mut behind_left, mut behind_right], capped, elastic } = match waves {
            Some(waves) => self.scratch.send_elastic([&left, &right], waves),
            None => self.scratch.send(Side::Bar(a, &left), Side::Bar(b, &right)),
        };
        // Rounding differences travel with a front instead of remaining as a stationary step that the next wave meets. (A velocity step remains where
        // a curve is level, or so nearly level that the stress of the wave is rounding.)
        if inside && same_motion(&behind_left, &behind_right, a, ONE_STATE) {
            if let Some(inner) = self.scratch.sent_right.last_mut() {
                (behind_right.stress, behind_right.velocity) = (behind_left.stress, behind_left.velocity);
                inner.behind = behind_right;
            } else if let Some(inner) = self.scratch.sent_left.last_mut() {
                (behind_left.stress, behind_left.velocity) = (behind_right.stress, behind_right.velocity);
                inner.behind = behind_left;
            }
        }
        Inside { behind: [behind_left, behind_right], capped, elastic }
    }

    /// Inserts the fronts emitted in -x after `prev`, and returns the last node before x.
    pub(super) fn send_left(&mut self, prev: u32, x: f64, segment: u32) -> u32 {
        let mut after = prev;
        for k in 0..self.scratch.sent_left.len() {
            let Emitted { speed, behind } = self.scratch.sent_left[k];
            after = self.list.insert(after, Node::new(Kind::Front, x, self.now, -speed, behind, segment));
        }
        self.fronts += self.scratch.sent_left.len();
        after
    }

    /// Inserts the fronts emitted in +x after `after`, with the state `ahead` in front of them, and returns the last of them.
    pub(super) fn send_right(&mut self, mut after: u32, x: f64, ahead: Point, segment: u32) -> u32 {
        for k in (0..self.scratch.sent_right.len()).rev() {
            let state = if k == 0 { ahead } else { self.scratch.sent_right[k - 1].behind };
            after = self
                .list
                .insert(after, Node::new(Kind::Front, x, self.now, self.scratch.sent_right[k].speed, state, segment));
        }
        self.fronts += self.scratch.sent_right.len();
        after
    }
}

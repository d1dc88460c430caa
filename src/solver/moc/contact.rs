//! Joints that can open, see [`crate::bar::joint`], between events. Velocities are constant then, so that the time at which a gap closes is exact; it
//! is an event of its own. Faces that press against each other are one Riemann problem, like a bonded joint.

use super::FrontTracking;
use super::joint_clock::{Contact, JointState};
use super::list::Node;
use crate::wave::riemann::{Point, Side, solve};

impl FrontTracking {
    /// Iterates over the present states of the joints that can open, from left to right.
    pub fn contacts(&self) -> impl Iterator<Item = JointState<'_>> {
        self.contacts.iter().map(|contact| {
            let state = contact.at(self.now);
            JointState {
                joint: contact.joint,
                open: state.is_open(),
                gap: state.gap(),
                jump: state.jump(),
                changes: &contact.changes,
            }
        })
    }

    /// Returns the contact state of a joint; `None` if it cannot open.
    pub(super) fn contact_at(&self, joint: &Node) -> Option<&Contact> {
        self.contacts.iter().find(|contact| self.list.get(contact.node).stamp == joint.stamp)
    }

    /// If `id` is a joint whose faces are apart, or separate now, emits the waves of two free faces and returns true. Otherwise returns false: the
    /// joint behaves as if bonded.
    pub(super) fn resolve_apart(&mut self, prev: u32, id: u32, right: Point, x: f64) -> bool {
        let Some(k) = self.contacts.iter().position(|contact| contact.node == id) else { return false };
        let (left, left_segment) = (self.list.get(prev).right, self.list.get(prev).segment);
        let right_segment = self.list.get(id).segment;
        self.contacts[k].bring_to(self.now, self.nearness.time);
        if self.contacts[k].state.gap() == 0.0 {
            let (force, round_off) = self.force_between((left_segment, &left), (right_segment, &right));
            if self.contacts[k].state.press(force, round_off) {
                self.contacts[k].update(0.0);
                return false;
            }
        }
        let (behind_left, _) = self.emit_under(0.0, -1.0, &left, left_segment);
        let (behind_right, _) = self.emit_under(0.0, 1.0, &right, right_segment);
        self.contacts[k].update(behind_right.velocity - behind_left.velocity);
        self.send_left(prev, x, left_segment);
        let node = self.list.get_mut(id);
        (node.right, node.t) = (behind_right, self.now);
        let last = self.send_right(id, x, right, right_segment);
        self.schedule(prev);
        self.schedule(last);
        true
    }

    /// Force between two faces that are held together, N, compression positive, and its rounding.
    fn force_between(&mut self, left: (u32, &Point), right: (u32, &Point)) -> (f64, f64) {
        let (a, b) = (&self.media[left.0 as usize], &self.media[right.0 as usize]);
        let star = solve(Side::Bar(a, left.1), Side::Bar(b, right.1), &mut self.scratch.work);
        (-star.force, a.round_off * a.area.min(b.area))
    }
}

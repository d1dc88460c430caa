//! Joints that can open, see [`crate::bar::joint`], between events: velocities are constant then, so that the time at which a gap closes
//! is exact, an event of its own. Faces that press each other are one Riemann problem, like a bonded joint.

use super::FrontTracking;
use super::list::Node;
use crate::bar::{Bar, joint};
use crate::wave::riemann::{Point, Side, solve};

/// When a joint opened or closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointChange {
    /// s.
    pub time: f64,
    /// Open from then on.
    pub open: bool,
}

/// A joint that can open, at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointState<'a> {
    /// Behind segment `joint`, counted from 0; inside it where the bar broke there.
    pub joint: usize,
    /// No force passes: the faces are apart, or touch without pressing.
    pub open: bool,
    /// Distance of the faces, m.
    pub gap: f64,
    /// Displacement of the right face against the left one since the start, m.
    pub jump: f64,
    /// Openings and closings so far, in order; the first entry tells how it started.
    pub changes: &'a [JointChange],
}

/// A joint that can open, with its clock.
#[derive(Debug, Clone)]
pub(super) struct Contact {
    pub node: u32,
    joint: usize,
    /// At the latest event, at `since` (s).
    state: joint::Contact,
    since: f64,
    /// Velocity at which the gap grows since then, m/s; 0 while closed.
    rate: f64,
    /// When the gap will be closed, s.
    pub closes: f64,
    changes: Vec<JointChange>,
}

impl Contact {
    /// Those of a bar; node k + 1 is the joint behind segment k.
    pub fn all(bar: &Bar) -> Vec<Self> {
        let inner = &bar.segments[..bar.segments.len() - 1];
        let states = inner.iter().enumerate().map(|(k, s)| (k, joint::Contact::new(s.joint)));
        states.filter_map(|(k, state)| Some(Self::new(k as u32 + 1, k, state?, 0.0))).collect()
    }

    fn new(node: u32, joint: usize, state: joint::Contact, since: f64) -> Self {
        Self { node, joint, state, since, rate: 0.0, closes: f64::INFINITY, changes: Vec::new() }
    }

    /// A place where the bar breaks at t.
    pub fn broken(node: u32, segment: usize, t: f64) -> Self {
        Self::new(node, segment, joint::Contact::broken(), t)
    }

    fn at(&self, t: f64) -> joint::Contact {
        let mut state = self.state;
        state.widen(t - self.since, self.rate);
        state
    }

    /// Displacement of the right face against the left one since the start, m, at time t.
    pub fn jump_at(&self, t: f64) -> f64 {
        self.at(t).jump()
    }

    /// Brings the gap to t. Times up to `tolerance` later count as t.
    fn bring_to(&mut self, t: f64, tolerance: f64) {
        self.state = self.at(t);
        if self.closes <= t + tolerance {
            self.state.close();
        }
        self.since = t;
    }

    /// From now on the gap grows at `rate` (m/s; 0 where the faces press each other). Rates within `round_off` are no closing.
    fn settle(&mut self, rate: f64, round_off: f64) {
        self.rate = rate;
        self.closes = if rate < -round_off { self.since + self.state.gap() / -rate } else { f64::INFINITY };
        let open = self.state.is_open();
        if self.changes.last().is_none_or(|last| last.open != open) {
            self.changes.push(JointChange { time: self.since, open });
        }
    }
}

impl FrontTracking {
    /// The joints that can open, from left to right, now.
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

    /// The clock of a joint, if it can open.
    pub(super) fn contact_at(&self, joint: &Node) -> Option<&Contact> {
        self.contacts.iter().find(|contact| self.list.get(contact.node).stamp == joint.stamp)
    }

    /// Where `id` is a joint whose faces are apart, or part now: sends what two free faces send, and returns true. Else
    /// the joint is as good as bonded.
    pub(super) fn resolve_apart(&mut self, prev: u32, id: u32, right: Point, x: f64) -> bool {
        let Some(k) = self.contacts.iter().position(|contact| contact.node == id) else { return false };
        let (left, left_segment) = (self.list.get(prev).right, self.list.get(prev).segment);
        let right_segment = self.list.get(id).segment;
        self.contacts[k].bring_to(self.now, self.nearness.time);
        if self.contacts[k].state.gap() == 0.0 {
            let (force, round_off) = self.force_between((left_segment, &left), (right_segment, &right));
            if self.contacts[k].state.press(force, round_off) {
                self.contacts[k].settle(0.0, 0.0);
                return false;
            }
        }
        let (behind_left, _) = self.emit_under(0.0, -1.0, &left, left_segment);
        let (behind_right, _) = self.emit_under(0.0, 1.0, &right, right_segment);
        let medium = &self.media[left_segment as usize];
        self.contacts[k].settle(behind_right.velocity - behind_left.velocity, medium.round_off / medium.impedance());
        self.send_left(prev, x, left_segment);
        let node = self.list.get_mut(id);
        (node.right, node.t) = (behind_right, self.now);
        let last = self.send_right(id, x, right, right_segment);
        self.schedule(prev);
        self.schedule(last);
        true
    }

    /// Force between two faces that are held together, N, compression positive, and how much of it is rounding.
    fn force_between(&mut self, left: (u32, &Point), right: (u32, &Point)) -> (f64, f64) {
        let (a, b) = (&self.media[left.0 as usize], &self.media[right.0 as usize]);
        let star = solve(Side::Bar(a, left.1), Side::Bar(b, right.1), &mut self.scratch.work);
        (-star.force, a.round_off * a.area.min(b.area))
    }
}

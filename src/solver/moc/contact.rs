//! Joints that carry no tension: two faces that touch, part, and meet again.
//!
//! While they touch they are one Riemann problem, like a bonded joint. Where its force would be tensile both faces are
//! free. The gap then changes at the rate of their velocities, which are constant between events, so that the time at
//! which it closes is exact: an event of its own.

use super::FrontTracking;
use super::list::Node;
use crate::bar::{Bar, Joint};
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
    start: f64,
    gap: f64,
    /// Velocity at which the gap grows since the last event, m/s; 0 while closed.
    rate: f64,
    since: f64,
    open: bool,
    /// When the gap will be closed, s.
    pub closes: f64,
    changes: Vec<JointChange>,
}

impl Contact {
    /// Those of a bar; node k + 1 is the joint behind segment k.
    pub fn all(bar: &Bar) -> Vec<Self> {
        let inner = &bar.segments[..bar.segments.len() - 1];
        inner.iter().enumerate().filter_map(|(k, s)| Self::new(k, s.joint)).collect()
    }

    fn new(joint: usize, kind: Joint) -> Option<Self> {
        let Joint::Contact { gap } = kind else { return None };
        Some(Self {
            node: joint as u32 + 1,
            joint,
            start: gap,
            gap,
            rate: 0.0,
            since: 0.0,
            open: gap > 0.0,
            closes: f64::INFINITY,
            changes: Vec::new(),
        })
    }

    /// A place where the bar breaks at t.
    pub fn broken(node: u32, segment: usize, t: f64) -> Self {
        Self {
            node,
            joint: segment,
            start: 0.0,
            gap: 0.0,
            rate: 0.0,
            since: t,
            open: false,
            closes: f64::INFINITY,
            changes: Vec::new(),
        }
    }

    fn gap_at(&self, t: f64) -> f64 {
        (self.gap + self.rate * (t - self.since)).max(0.0)
    }

    /// Displacement of the right face against the left one since the start, m, at time t.
    pub fn jump_at(&self, t: f64) -> f64 {
        self.gap_at(t) - self.start
    }

    /// Brings the gap to t; whether the faces are apart there. Times up to `tolerance` later count as t.
    fn bring_to(&mut self, t: f64, tolerance: f64) -> bool {
        self.gap = if self.closes <= t + tolerance { 0.0 } else { self.gap_at(t) };
        self.since = t;
        self.gap > 0.0
    }

    /// From now on the gap grows at `rate` (m/s; none: the faces press each other). Rates within `round_off` are no
    /// closing.
    fn settle(&mut self, rate: Option<f64>, round_off: f64) {
        let open = rate.is_some();
        self.rate = rate.unwrap_or(0.0);
        self.closes = if self.rate < -round_off { self.since + self.gap / -self.rate } else { f64::INFINITY };
        if self.changes.last().is_none_or(|last| last.open != open) {
            self.changes.push(JointChange { time: self.since, open });
        }
        self.open = open;
    }
}

impl FrontTracking {
    /// The joints that can open, from left to right, now.
    pub fn contacts(&self) -> impl Iterator<Item = JointState<'_>> {
        self.contacts.iter().map(|contact| {
            let gap = contact.gap_at(self.now);
            JointState {
                joint: contact.joint,
                open: contact.open,
                gap,
                jump: contact.jump_at(self.now),
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
        let apart = self.contacts[k].bring_to(self.now, self.nearness.time);
        let round_off = self.media[left_segment as usize].round_off;
        if !apart && self.presses(&left, left_segment, &right, right_segment) {
            self.contacts[k].settle(None, 0.0);
            return false;
        }
        let behind_left = self.free_left(&left, left_segment);
        let behind_right = self.free_right(&right, right_segment);
        let slowest = round_off / self.media[left_segment as usize].impedance();
        self.contacts[k].settle(Some(behind_right.velocity - behind_left.velocity), slowest);
        self.send_left(prev, x, left_segment);
        let node = self.list.get_mut(id);
        (node.right, node.t) = (behind_right, self.now);
        let last = self.send_right(id, x, right, right_segment);
        self.schedule(prev);
        self.schedule(last);
        true
    }

    /// Whether two faces that touch press each other.
    fn presses(&mut self, left: &Point, left_segment: u32, right: &Point, right_segment: u32) -> bool {
        let (a, b) = (&self.media[left_segment as usize], &self.media[right_segment as usize]);
        let star = solve(Side::Bar(a, left), Side::Bar(b, right), &mut self.scratch.work);
        star.force < -a.round_off * a.area.min(b.area)
    }

    /// The state behind the waves that a free face at the right of `point` sends into `sent_left`.
    fn free_left(&mut self, point: &Point, segment: u32) -> Point {
        let sense = if point.stress > 0.0 { -1.0 } else { 1.0 };
        self.scratch.work.left.fill(&self.media[segment as usize], point, sense);
        self.scratch.work.left.emit(0.0, -1.0, &mut self.scratch.sent_left)
    }

    /// The same of a free face at the left of `point`, into `sent_right`.
    fn free_right(&mut self, point: &Point, segment: u32) -> Point {
        let sense = if point.stress > 0.0 { -1.0 } else { 1.0 };
        self.scratch.work.right.fill(&self.media[segment as usize], point, sense);
        self.scratch.work.right.emit(0.0, 1.0, &mut self.scratch.sent_right)
    }
}

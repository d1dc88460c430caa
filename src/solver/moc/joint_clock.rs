//! A contact joint between two events: its gap and closing time.

use serde::{Deserialize, Serialize};

use crate::bar::{Bar, joint};

/// When a joint opened or closed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Contact {
    pub node: u32,
    pub joint: usize,
    /// At the latest event, at `since` (s).
    pub state: joint::Contact,
    since: f64,
    /// Velocity at which the gap grows since then, m/s; 0 while closed.
    rate: f64,
    /// When the gap will be closed, s.
    pub closes: f64,
    pub changes: Vec<JointChange>,
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

    pub fn at(&self, t: f64) -> joint::Contact {
        let mut state = self.state;
        state.widen(t - self.since, self.rate);
        state
    }

    /// Displacement of the right face against the left one since the start, m, at time t.
    pub fn jump_at(&self, t: f64) -> f64 {
        self.at(t).jump()
    }

    /// Brings the gap to t. Times up to `tolerance` later count as t.
    pub fn bring_to(&mut self, t: f64, tolerance: f64) {
        self.state = self.at(t);
        if self.closes <= t + tolerance {
            self.state.close();
        }
        self.since = t;
    }

    /// From now on the gap grows at `rate` (m/s; 0 where the faces press each other). Faces without a gap that do not press are not
    /// closing either: the force has told, and a rate that says otherwise is rounding, however it compares across two impedances.
    pub fn update(&mut self, rate: f64) {
        self.rate = rate;
        let gap = self.state.gap();
        self.closes = if gap > 0.0 && rate < 0.0 { self.since + gap / -rate } else { f64::INFINITY };
        let open = self.state.is_open();
        if self.changes.last().is_none_or(|last| last.open != open) {
            self.changes.push(JointChange { time: self.since, open });
        }
    }
}

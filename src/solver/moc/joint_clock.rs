//! A contact joint between two events: its gap and closing time.

use serde::{Deserialize, Serialize};

use crate::bar::{Bar, joint};

/// Opening or closing of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct JointChange {
    /// Time, s.
    pub time: f64,
    /// Whether the joint is open from then on.
    pub open: bool,
}

/// Present state of a joint that can open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointState<'a> {
    /// Index of the segment to its left, counted from 0; if the bar fractured inside a segment, the index of that segment.
    pub joint: usize,
    /// Whether no force is transmitted: the faces are apart, or touch without pressing.
    pub open: bool,
    /// Distance of the faces, m.
    pub gap: f64,
    /// Displacement of the right face relative to the left one since the start, m.
    pub jump: f64,
    /// Openings and closings so far, in order; the first entry gives the state at the start.
    pub changes: &'a [JointChange],
}

/// A joint that can open, with the time at which it closes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Contact {
    pub node: u32,
    pub joint: usize,
    /// State at the latest event, at time `since` (s).
    pub state: joint::Contact,
    since: f64,
    /// Velocity at which the gap grows since then, m/s; 0 while closed.
    rate: f64,
    /// Time at which the gap will be closed, s.
    pub closes: f64,
    pub changes: Vec<JointChange>,
}

impl Contact {
    /// Returns the contacts of a bar; node k + 1 is the joint to the right of segment k.
    pub fn all(bar: &Bar) -> Vec<Self> {
        let inner = &bar.segments[..bar.segments.len() - 1];
        let states = inner.iter().enumerate().map(|(k, s)| (k, joint::Contact::new(s.joint)));
        states.filter_map(|(k, state)| Some(Self::new(k as u32 + 1, k, state?, 0.0))).collect()
    }

    fn new(node: u32, joint: usize, state: joint::Contact, since: f64) -> Self {
        Self { node, joint, state, since, rate: 0.0, closes: f64::INFINITY, changes: Vec::new() }
    }

    /// Creates the contact of a section where the bar fractures at t.
    pub fn broken(node: u32, segment: usize, t: f64) -> Self {
        Self::new(node, segment, joint::Contact::broken(), t)
    }

    pub fn at(&self, t: f64) -> joint::Contact {
        let mut state = self.state;
        state.widen(t - self.since, self.rate);
        state
    }

    /// Displacement of the right face relative to the left one since the start, m, at time t.
    pub fn jump_at(&self, t: f64) -> f64 {
        self.at(t).jump()
    }

    /// Advances the gap to t. Closing times up to `tolerance` later count as t.
    pub fn bring_to(&mut self, t: f64, tolerance: f64) {
        self.state = self.at(t);
        if self.closes <= t + tolerance {
            self.state.close();
        }
        self.since = t;
    }

    /// Sets the rate at which the gap grows from now on (m/s; 0 if the faces press against each other). Faces without a gap that do not press do not
    /// close either: the force decides that, and a rate of the opposite sign is rounding, however it compares across two impedances.
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

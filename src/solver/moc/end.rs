//! The ends of a tracked bar: what drives them, and what they record.

use crate::bar::{EndCondition, History};

/// Stress and velocity of the bar's end from `time` on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStep {
    /// s.
    pub time: f64,
    /// Pa.
    pub stress: f64,
    /// m/s.
    pub velocity: f64,
}

/// What happened at an end so far.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EndRecord {
    /// Exact steps: each holds until the next.
    pub steps: Vec<EndStep>,
    /// First time at which the stress-strain curve could not carry the imposed velocity into the bar, s.
    pub above_critical: Option<f64>,
}

/// What an end imposes at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// m/s.
    Velocity(f64),
    /// Pa.
    Stress(f64),
    /// A bar without end, of the same section, elastic, unloaded, and moving with this velocity.
    Elastic(f64),
    /// Velocity 0, unless that would take tension.
    Push,
}

/// An end with its clock.
#[derive(Debug, Clone)]
pub struct End {
    condition: EndCondition,
    /// +1 at the left end, -1 at the right: the way into the bar.
    pub inward: f64,
    /// Velocity of the bar there at the start, for the absorbing end.
    rest: f64,
    /// Distance to the wall, m.
    gap: f64,
    /// When the wall will be reached, s.
    closes: f64,
    /// The wall holds the end: its gap stays 0, whatever the rounding of its velocity.
    held: bool,
    /// Since when the present stress and velocity hold, and they.
    since: f64,
    pub stress: f64,
    pub velocity: f64,
    /// Work done on the bar's end and impulse given to it up to `since`, per area.
    work: f64,
    impulse: f64,
    pub record: EndRecord,
}

impl End {
    pub fn new(condition: EndCondition, inward: f64, rest: f64) -> Self {
        let gap = if let EndCondition::Wall { gap } = condition { gap } else { 0.0 };
        Self {
            condition,
            inward,
            rest,
            gap,
            closes: f64::INFINITY,
            held: false,
            since: 0.0,
            stress: 0.0,
            velocity: rest,
            work: 0.0,
            impulse: 0.0,
            record: EndRecord::default(),
        }
    }

    /// Work done on the end, J/m^2, and impulse given to it in +x, N s/m^2, up to t.
    pub fn account(&self, t: f64) -> (f64, f64) {
        let dt = t - self.since;
        let traction = -self.inward * self.stress;
        (self.work + traction * self.velocity * dt, self.impulse + traction * dt)
    }

    /// Brings the account and the gap to t and returns what drives the end from t on. Times up to `tolerance` later
    /// count as t.
    pub fn drive(&mut self, t: f64, tolerance: f64) -> Drive {
        (self.work, self.impulse) = self.account(t);
        if !self.held {
            self.gap += self.inward * self.velocity * (t - self.since);
        }
        self.since = t;
        let at = t + tolerance;
        match &self.condition {
            EndCondition::Velocity { release: Some(release), .. } if *release <= at => Drive::Stress(0.0),
            EndCondition::Velocity { history, .. } => Drive::Velocity(history.at(at)),
            EndCondition::Stress { history } => Drive::Stress(history.at(at)),
            EndCondition::Free => Drive::Stress(0.0),
            EndCondition::Fixed => Drive::Velocity(0.0),
            EndCondition::Absorbing => Drive::Elastic(self.rest),
            EndCondition::Wall { .. } => {
                if self.closes <= at || self.gap <= 0.0 {
                    self.gap = 0.0;
                    Drive::Push
                } else {
                    Drive::Stress(0.0)
                }
            }
        }
    }

    /// Takes the answer: stress and velocity of the bar's end from t on, and whether a wall holds it.
    pub fn settle(&mut self, stress: f64, velocity: f64, held: bool, round_off: f64, scale: f64) {
        let t = self.since;
        self.held = held;
        let opening = self.inward * velocity;
        self.closes = if matches!(self.condition, EndCondition::Wall { .. }) && !held && opening < 0.0 {
            t + self.gap / -opening
        } else {
            f64::INFINITY
        };
        (self.stress, self.velocity) = (stress, velocity);
        let same = |last: &EndStep| {
            (last.stress - stress).abs() <= round_off && (last.velocity - velocity).abs() <= round_off / scale
        };
        if !self.record.steps.last().is_some_and(same) {
            self.record.steps.push(EndStep { time: t, stress, velocity });
        }
    }

    /// When the end next does something of its own accord, s: later, by more than `tolerance`, than it was last asked
    /// what drives it, not than now: something else may be due at the same time and come first.
    pub fn next_time(&self, tolerance: f64) -> f64 {
        let t = self.since + tolerance;
        let step = |history: &History| {
            let next = history.time().partition_point(|&row| row <= t);
            history.time().get(next).copied().unwrap_or(f64::INFINITY)
        };
        match &self.condition {
            EndCondition::Velocity { release: Some(release), .. } if *release <= t => f64::INFINITY,
            EndCondition::Velocity { history, release } => step(history).min(release.unwrap_or(f64::INFINITY)),
            EndCondition::Stress { history } => step(history),
            EndCondition::Wall { .. } => self.closes,
            EndCondition::Free | EndCondition::Fixed | EndCondition::Absorbing => f64::INFINITY,
        }
    }

    /// Largest stress (Pa) and the range of velocities (m/s) that it imposes.
    pub fn reach(&self) -> (f64, [f64; 2]) {
        let range = |h: &History| {
            [h.value().iter().fold(0.0, |m: f64, &v| m.min(v)), h.value().iter().fold(0.0, |m: f64, &v| m.max(v))]
        };
        match &self.condition {
            EndCondition::Velocity { history, .. } => (0.0, range(history)),
            EndCondition::Stress { history } => (history.extreme().abs(), [self.rest; 2]),
            EndCondition::Fixed | EndCondition::Wall { .. } => (0.0, [0.0; 2]),
            EndCondition::Free | EndCondition::Absorbing => (0.0, [self.rest; 2]),
        }
    }

    /// True where its history has a ramp.
    pub fn has_ramp(&self) -> bool {
        let (EndCondition::Velocity { history, .. } | EndCondition::Stress { history }) = &self.condition else {
            return false;
        };
        let (t, v) = (history.time(), history.value());
        t.windows(2).zip(v.windows(2)).any(|(t, v)| t[1] > t[0] && v[1] != v[0])
    }
}

/// A history with its ramps made into steps no higher than `increment` (> 0), each in the middle of its part of the
/// ramp, so that the integral stays the same.
pub fn stepped(history: &History, increment: f64) -> History {
    let (t, v) = (history.time(), history.value());
    let mut rows = vec![(t[0], v[0])];
    for k in 1..t.len() {
        let (duration, rise) = (t[k] - t[k - 1], v[k] - v[k - 1]);
        let steps = if duration > 0.0 { (rise.abs() / increment).ceil().max(1.0) } else { 1.0 };
        for step in 0..steps as u32 {
            let part = |s: f64| s / steps;
            let middle = t[k - 1] + duration * part(f64::from(step) + 0.5);
            if rise != 0.0 && duration > 0.0 {
                rows.push((middle, v[k - 1] + rise * part(f64::from(step))));
                rows.push((middle, v[k - 1] + rise * part(f64::from(step) + 1.0)));
            }
        }
        rows.push((t[k], v[k]));
    }
    History::new(&rows).unwrap_or_else(|_| history.clone())
}

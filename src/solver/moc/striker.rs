//! A rigid mass that pushes against an end of the bar and flies on where it would have to pull.
//!
//! Over a step the bar's end moves with one velocity v and carries one stress, so that the solution stays made of
//! constant pieces. The force f on the mass takes its velocity from V to V + f t/M. The bar gets the work -f v t, the mass
//! loses -f t (V + f t/(2M)): what is still owed, the integral of f (v - V), is zero again when v is the mean of the
//! mass's velocities, and there the step ends. Momentum is exact at all times and energy at the end of every step.
//! A step that is to last dt is a Riemann problem against a driver that gives way by dt/(2M) (the midpoint rule).

use super::contact::JointChange;
use super::end::Drive;
use super::pace::{Pace, first_zero};
use crate::wave::riemann::Point;

/// What happens at a striker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrikerState {
    /// kg.
    pub mass: f64,
    /// Velocity now, m/s, positive in +x.
    pub velocity: f64,
    /// Distance between the mass and the bar's end, m.
    pub gap: f64,
    /// Whether they touch.
    pub touching: bool,
}

/// The mass and its step.
///
/// A force that dies away does so in steps, as the waves that arrive are made of steps: the mass is let go at the first
/// wave behind which it would have to pull. When the force itself was zero is found between the middles of the last step
/// that pushed and the first that would pull: second order, like everything else.
#[derive(Debug, Clone)]
pub(super) struct Striker {
    state: StrikerState,
    inward: f64,
    area: f64,
    impedance: f64,
    /// When the gap will close, s.
    closes: f64,
    /// Work that the bar's end still owes the mass in the present step, J.
    owed: f64,
    /// When the present step is over, and how long it was meant to be, s.
    over: f64,
    planned: f64,
    /// Nothing is owed any more when the present step is over.
    settles: bool,
    /// When the present step started, s, and the stress in it; what stress the step that lets go would have had, Pa.
    started: f64,
    stress: f64,
    pull: f64,
    /// The stress jumped just now.
    jumped: bool,
    /// When it touched the bar and let go of it.
    changes: Vec<JointChange>,
    pub pace: Pace,
}

impl Striker {
    /// At the end with the way into the bar `inward`, on a section `area` (m^2) of elastic impedance `impedance`
    /// (Pa s/m), touching it.
    pub fn new(mass: f64, velocity: f64, inward: f64, area: f64, impedance: f64) -> Self {
        Self {
            state: StrikerState { mass, velocity, gap: 0.0, touching: true },
            inward,
            area,
            impedance,
            closes: f64::INFINITY,
            owed: 0.0,
            over: 0.0,
            planned: 0.0,
            settles: false,
            started: 0.0,
            stress: 0.0,
            pull: 0.0,
            jumped: true,
            changes: Vec::new(),
            pace: Pace::new(mass / (area * impedance)),
        }
    }

    /// The mass at time t, `dt` after the last event, with the end's stress and velocity since then.
    pub fn at(&self, dt: f64, stress: f64, velocity: f64) -> StrikerState {
        let mut state = self.state;
        if state.touching {
            state.velocity += self.inward * self.area * stress * dt / state.mass;
        } else {
            state.gap = (state.gap + self.inward * (velocity - state.velocity) * dt).max(0.0);
        }
        state
    }

    /// Brings it to time t, `dt` after the last event.
    pub fn bring_to(&mut self, t: f64, dt: f64, stress: f64, velocity: f64, tolerance: f64) {
        let state = self.at(dt, stress, velocity);
        if state.touching {
            let push = self.inward * self.area * stress * dt;
            self.owed += push * (velocity - self.state.velocity - 0.5 * push / state.mass);
        }
        self.state = state;
        if self.settles && (t - self.over).abs() <= tolerance {
            self.owed = 0.0;
        }
        if self.closes <= t + tolerance {
            self.state.gap = 0.0;
            self.state.touching = true;
            self.pace.restart();
        }
    }

    /// Whether it touches the bar.
    pub fn touches(&self) -> bool {
        self.state.touching
    }

    /// How long the next step should be, s, where one begins: `bar` is what has come near, the stress changed by `change`
    /// (Pa) just now.
    pub fn wish(&mut self, bar: &Point, change: f64) -> Option<f64> {
        if !self.state.touching || (self.owed != 0.0 && change <= self.pace.passing() && bar.stress < 0.0) {
            return None;
        }
        self.jumped = self.pace.is_jump(change, bar.stress);
        if self.jumped {
            self.pace.restart();
        }
        // The stress that an elastic answer to the mass's velocity would bring.
        Some(self.pace.next(bar.stress - self.inward * self.impedance * (self.state.velocity - bar.velocity)))
    }

    /// The bar's end would have to be pulled with this stress (Pa): it will be let go.
    pub fn would_pull(&mut self, stress: f64) {
        self.pull = stress;
    }

    /// When the force was zero that makes it let go at t.
    fn last_touch(&self, t: f64) -> f64 {
        if self.jumped || self.stress >= 0.0 || self.pull <= 0.0 {
            return t;
        }
        let (before, after) = (0.5 * (self.started + t), t + 0.5 * self.planned);
        before + (after - before) * (self.stress / (self.stress - self.pull))
    }

    /// What it does to the bar in a step of `step` (s), at a present stress of `stress` (Pa).
    pub fn drive(&mut self, step: f64, stress: f64) -> Drive {
        self.planned = step;
        let StrikerState { mass, velocity, .. } = self.state;
        if self.owed == 0.0 {
            return Drive::Mass { velocity, compliance: 0.5 * step / mass };
        }
        // Broken off in the middle of a step. The end moves just like the mass now, if that settles the account; else
        // somewhat ahead of it (the least that would do is 1).
        let sense = (self.inward * self.area * stress).signum();
        let ahead = if self.owed > 0.0 { 0.0 } else { 1.5 * sense * (2.0 * self.owed.abs() / mass).sqrt() };
        Drive::Mass { velocity: velocity + ahead, compliance: 0.0 }
    }

    /// Takes the answer: the end's stress and velocity from t on, and whether the mass touches it.
    pub fn settle(&mut self, t: f64, stress: f64, velocity: f64, touching: bool, round_off: f64) {
        if self.changes.last().is_none_or(|last| last.open == touching) {
            let time = if touching { t } else { self.last_touch(t) };
            self.changes.push(JointChange { time, open: !touching });
        }
        (self.started, self.stress) = (t, stress);
        self.state.touching = touching;
        self.closes = f64::INFINITY;
        self.over = f64::INFINITY;
        let push = self.inward * self.area * stress;
        if !touching {
            let opening = self.inward * (velocity - self.state.velocity);
            if opening * self.impedance < -round_off {
                self.closes = t + self.state.gap / -opening;
            }
        } else if stress.abs() > round_off {
            let (rise, fall) = (push * (velocity - self.state.velocity), 0.5 * push * push / self.state.mass);
            let (length, settles) = step_length(first_zero(self.owed, rise, fall), self.planned);
            (self.over, self.settles) = (t + length, settles);
        }
    }

    /// When it touched the bar and let go of it, in order.
    pub fn changes(&self) -> &[JointChange] {
        &self.changes
    }

    /// When it next does something of its own accord, s.
    pub fn next_time(&self) -> f64 {
        self.closes.min(self.over)
    }
}

/// The length of a step that settles its account after `settled`, with `planned` for what is within its rounding, and
/// whether it does settle it.
///
/// A step that never settles, or takes much longer than planned, is broken off: the next one takes over what is owed.
pub(super) fn step_length(settled: Option<f64>, planned: f64) -> (f64, bool) {
    match settled {
        Some(length) if (length - planned).abs() <= 1e-6 * planned => (planned, true),
        Some(length) if length <= 4.0 * planned => (length, true),
        Some(_) => (4.0 * planned, false),
        None => (planned, false),
    }
}

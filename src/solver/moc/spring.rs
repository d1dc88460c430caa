//! A linear spring between an end of the bar and the ground.
//!
//! Over a step the bar's end moves with one velocity v and carries one force f (in the direction in which the spring is
//! stretched). The spring's own force goes from k u to k (u + v t). The difference of the works, the integral of
//! (f - k u) v, is zero again when f is the mean of the spring's forces, and there the step ends: what the bar gives, the
//! spring has. A step that is to last dt is a Riemann problem against a driver that gives way by 2/(k dt).

use super::end::Drive;
use super::pace::{Pace, first_zero};
use super::striker::step_length;
use crate::wave::riemann::Point;

/// The spring and its step.
#[derive(Debug, Clone)]
pub(super) struct Spring {
    /// N/m.
    stiffness: f64,
    inward: f64,
    area: f64,
    impedance: f64,
    /// Displacement of the bar's end, m, positive in +x.
    stretch: f64,
    /// Work that the spring still owes the bar's end in the present step, J.
    owed: f64,
    over: f64,
    planned: f64,
    settles: bool,
    pub pace: Pace,
}

impl Spring {
    /// At the end with the way into the bar `inward`, on a section `area` (m^2) of elastic impedance `impedance`
    /// (Pa s/m), at rest length.
    pub fn new(stiffness: f64, inward: f64, area: f64, impedance: f64) -> Self {
        let pace = Pace::new(area * impedance / stiffness);
        Self {
            stiffness,
            inward,
            area,
            impedance,
            stretch: 0.0,
            owed: 0.0,
            over: f64::INFINITY,
            planned: 0.0,
            settles: false,
            pace,
        }
    }

    /// Energy stored `dt` after the last event, with the end's velocity since then, J.
    pub fn energy(&self, dt: f64, velocity: f64) -> f64 {
        0.5 * self.stiffness * (self.stretch + velocity * dt).powi(2)
    }

    /// Brings it to time t, `dt` after the last event.
    pub fn bring_to(&mut self, t: f64, dt: f64, stress: f64, velocity: f64, tolerance: f64) {
        let own = self.stiffness * (self.stretch + 0.5 * velocity * dt);
        self.owed += (self.inward * self.area * stress - own) * velocity * dt;
        self.stretch += velocity * dt;
        if self.settles && (t - self.over).abs() <= tolerance {
            self.owed = 0.0;
        }
    }

    /// How long the next step should be, s, where one begins: `bar` is what has come near, the stress changed by `change`
    /// (Pa) just now.
    pub fn wish(&mut self, bar: &Point, change: f64) -> Option<f64> {
        if self.owed != 0.0 && change <= self.pace.passing() {
            return None;
        }
        // rho c0 times the velocity that an elastic answer to the spring's force would bring.
        let own = self.inward * self.stiffness * self.stretch / self.area;
        let strength = self.impedance * bar.velocity - self.inward * (own - bar.stress);
        if self.pace.is_jump(change, strength) {
            self.pace.restart();
        }
        Some(self.pace.next(strength))
    }

    /// What it does to the bar in a step of `step` (s), at a present velocity of `velocity` (m/s).
    pub fn drive(&mut self, step: f64, velocity: f64) -> Drive {
        self.planned = step;
        let own = self.stiffness * self.stretch;
        if self.owed == 0.0 {
            return Drive::Spring { force: self.inward * own, compliance: 2.0 / (self.stiffness * step) };
        }
        // Broken off in the middle of a step. The end feels the spring as it is now, if that settles the account; else
        // somewhat more (the least that would do is 1).
        let more = 1.5 * velocity.signum() * (2.0 * self.stiffness * self.owed.abs()).sqrt();
        Drive::Stress(self.inward * (if self.owed > 0.0 { own } else { own + more }) / self.area)
    }

    /// Takes the answer: the end's stress and velocity from t on.
    pub fn settle(&mut self, t: f64, stress: f64, velocity: f64, round_off: f64) {
        self.over = f64::INFINITY;
        if velocity.abs() * self.impedance > round_off {
            let own = self.stiffness * self.stretch;
            let rise = (self.inward * self.area * stress - own) * velocity;
            let fall = 0.5 * self.stiffness * velocity * velocity;
            let (length, settles) = step_length(first_zero(self.owed, rise, fall), self.planned);
            (self.over, self.settles) = (t + length, settles);
        }
    }

    /// When it next does something of its own accord, s.
    pub fn next_time(&self) -> f64 {
        self.over
    }
}

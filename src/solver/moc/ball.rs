//! A ball that pushes against an end of the bar by Hertz's contact.
//!
//! Over a step the bar's end moves with one velocity v and carries one force f, the mean of the contact's over the step. The
//! ball's velocity and the approach follow from both exactly, and the next step starts from the force that belongs to the
//! approach: momentum is exact, the rest of second order in the step, the energy of ball and contact too (the bar's account
//! does not need it). A step starts from what an elastic bar would answer, a Riemann problem against a driver that gives
//! way as the contact does there. Steps are such that the force changes by one part of the largest, and no longer than a part
//! of the contact time that goes with it, so that the largest force is of second order too.

use super::contact::JointChange;
use super::end::Drive;
use super::striker::StrikerState;
use crate::bar::Hertz;
use crate::wave::riemann::Point;

/// A wave that changes the stress by less than this part of a step's worth does not break a step.
const PASSING: f64 = 0.1;

/// Shortest step, in parts of the contact time: below, times are rounding.
const SHORTEST: f64 = 1e-7;

/// Longest step, in parts of the contact time, over the part by which a step changes the force: around its largest value the
/// force hardly changes, and its mean over a step falls short of it by the square of the step's length.
const LONGEST: f64 = 1.0;

/// The ball and its step. Velocities here are into the bar.
#[derive(Debug, Clone)]
pub(super) struct Ball {
    contact: Hertz,
    /// kg.
    mass: f64,
    inward: f64,
    area: f64,
    impedance: f64,
    velocity: f64,
    /// m; less than 0 where it is apart from the end.
    approach: f64,
    touching: bool,
    /// When the gap will close, and when the present step is over, s.
    closes: f64,
    over: f64,
    /// Part of the largest force by which a step changes it, and stress to which that is held, Pa.
    step: f64,
    level: f64,
    /// Largest force (N) and duration (s) of the contact if the end stayed where it is.
    peak: f64,
    lasts: f64,
    changes: Vec<JointChange>,
    /// Length of the step to come, s.
    planned: f64,
}

impl Ball {
    /// At the end with the way into the bar `inward`, on a section `area` (m^2) of elastic impedance `impedance`
    /// (Pa s/m), touching it; `velocity` (m/s) is in +x.
    pub fn new(contact: Hertz, (mass, velocity): (f64, f64), inward: f64, area: f64, impedance: f64) -> Self {
        Self {
            contact,
            mass,
            inward,
            area,
            impedance,
            velocity: inward * velocity,
            approach: 0.0,
            touching: false,
            closes: 0.0,
            over: f64::INFINITY,
            step: 1e-3,
            level: 1.0,
            peak: 0.0,
            lasts: 0.0,
            changes: Vec::new(),
            planned: 0.0,
        }
    }

    /// Steps of `step` (> 0) of the largest stress, or of `level` (Pa) where that is less.
    pub fn set(&mut self, step: f64, level: f64) {
        (self.step, self.level) = (step, level);
    }

    /// Largest stress that it can bring to an end that moves with `rest` (m/s, in +x), Pa.
    pub fn reach(&self, rest: f64) -> f64 {
        let closing = (self.velocity - self.inward * rest).max(0.0);
        let peak = self.contact.force(self.contact.largest_approach(self.mass, closing)) / self.area;
        peak.min(self.impedance * closing)
    }

    /// Approach (m) and velocity (m/s, into the bar) `dt` after the last event, with the end's stress and velocity since.
    fn after(&self, dt: f64, stress: f64, velocity: f64) -> (f64, f64) {
        let slower = self.area * stress * dt / self.mass;
        let closing = self.velocity - self.inward * velocity + 0.5 * slower;
        (self.approach + closing * dt, self.velocity + slower)
    }

    /// The ball `dt` after the last event.
    pub fn at(&self, dt: f64, stress: f64, velocity: f64) -> StrikerState {
        let (approach, own) = self.after(dt, stress, velocity);
        let gap = (-approach).max(0.0);
        StrikerState { mass: self.mass, velocity: self.inward * own, gap, touching: self.touching }
    }

    /// Its energy of motion and that of the contact then, J.
    pub fn energy(&self, dt: f64, stress: f64, velocity: f64) -> f64 {
        let (approach, own) = self.after(dt, stress, velocity);
        0.5 * self.mass * own * own + self.contact.energy(approach)
    }

    /// Brings it to time t, `dt` after the last event.
    pub fn bring_to(&mut self, t: f64, dt: f64, stress: f64, velocity: f64, tolerance: f64) {
        (self.approach, self.velocity) = self.after(dt, stress, velocity);
        if !self.touching && self.closes <= t + tolerance {
            self.approach = 0.0;
        }
        if self.over <= t + tolerance {
            self.over = f64::INFINITY;
        }
    }

    /// Whether it touches the bar.
    pub fn touches(&self) -> bool {
        self.touching
    }

    /// Waves weaker than this (Pa) do not break a step: the end goes along with them.
    pub fn passing(&self) -> f64 {
        PASSING * self.step * self.level
    }

    /// Velocity of the end (m/s, into the bar) without a force, as an elastic bar answers.
    fn free(&self, bar: &Point) -> f64 {
        self.inward * bar.velocity + bar.stress / self.impedance
    }

    /// How long the next step should be, s, where one begins at t: `bar` is what has come near, the stress changed by
    /// `change` (Pa) just now.
    pub fn wish(&mut self, t: f64, bar: &Point, change: f64) -> Option<f64> {
        let mobility = 1.0 / (self.area * self.impedance);
        let force = self.contact.force(self.approach);
        let closing = self.velocity - self.free(bar) - mobility * force;
        let touches = (self.touching && self.approach > 0.0) || (self.approach >= 0.0 && closing > 0.0);
        if touches != self.touching {
            // A force that dies away was over a little before the step that it ended with.
            let late = if touches { 0.0 } else { self.approach / closing };
            self.changes.push(JointChange { time: t - late, open: !touches });
            self.touching = touches;
            (self.over, self.closes) = (f64::INFINITY, f64::INFINITY);
            if touches {
                self.peak = self.contact.force(self.contact.largest_approach(self.mass, closing));
                self.lasts = self.contact.contact_time(self.mass, closing);
            }
        }
        if !touches || (self.over < f64::INFINITY && change <= self.passing()) {
            return None;
        }
        let part = self.step * self.peak.min(self.level * self.area);
        let to = self.approach_at((force + part * closing.signum()).max(0.0));
        let wish = (to - self.approach) / closing;
        Some(wish.clamp(SHORTEST * self.lasts, (LONGEST * self.step).min(1.0) * self.lasts))
    }

    /// The approach at a force (N), m.
    fn approach_at(&self, force: f64) -> f64 {
        (force / self.contact.stiffness()).powf(2.0 / 3.0)
    }

    /// What it does to the bar in a step of `step` (s).
    pub fn drive(&mut self, step: f64, bar: &Point) -> Drive {
        self.planned = step;
        let mobility = 1.0 / (self.area * self.impedance);
        let free = self.approach + step * (self.velocity - self.free(bar));
        let compliance = step * (0.5 * step / self.mass + mobility);
        let force = self.contact.solve(self.approach, free, compliance);
        let to = free - compliance * force;
        let slope = self.contact.slope(self.approach, to, force);
        if slope <= 0.0 {
            return Drive::Stress(0.0);
        }
        // force + slope (a - to), where a = approach + step (velocity - v - f step/(2 M)) at f.
        let velocity = self.velocity + (force / slope + self.approach - to) / step;
        Drive::Mass { velocity: self.inward * velocity, compliance: 1.0 / (slope * step) + 0.5 * step / self.mass }
    }

    /// Takes the answer: the end's velocity from t on.
    pub fn settle(&mut self, t: f64, velocity: f64, round_off: f64) {
        if self.touching {
            // Without a step of its own the end goes along with what passes, and the present step goes on.
            if self.planned > 0.0 {
                self.over = t + std::mem::take(&mut self.planned);
            }
            return;
        }
        let closing = self.velocity - self.inward * velocity;
        self.closes =
            if closing * self.impedance > round_off { t - self.approach.min(0.0) / closing } else { f64::INFINITY };
    }

    /// When it touched the bar and let go of it, in order.
    pub fn changes(&self) -> &[JointChange] {
        &self.changes
    }

    /// When it next does something of its own accord, s.
    pub fn next_time(&self) -> f64 {
        if self.touching { self.over } else { self.closes }
    }
}

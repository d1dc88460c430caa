//! The ball at an end of the staggered grid: approaches live at whole steps, velocities at half steps.
//!
//! In step n it pushes with F = (P(a+) - P(a-))/(a+ - a-), P being the energy stored in the contact and a-, a+ the approaches
//! a step before and a step after (W. A. Strauss and L. Vazquez, J. Comput. Phys. 28, 1978). Then `M V- V+/2 + S` loses
//! exactly what the bar gets, with `S = (P(a) + P(a-))/2 + F (a - a-)/2` for the stored part.

use crate::bar::{EndCondition, Hertz};

/// A ball that moves by itself.
#[derive(Debug, Clone)]
pub(super) struct Ball {
    contact: Hertz,
    /// kg.
    mass: f64,
    /// Outward normal of the end: -1 left, +1 right.
    normal: f64,
    /// Velocity half a step before and after the current time, m/s.
    before: f64,
    after: f64,
    /// Approach a step before, at and a step after the current time, m; less than 0 where they are apart.
    earlier: f64,
    now: f64,
    pub approach: f64,
    /// N, >= 0.
    force: f64,
}

impl Ball {
    /// The ball of an end, if it has one; the end moves with `velocity` (m/s) at the start.
    pub fn of(condition: &EndCondition, velocity: f64, normal: f64, dt: f64) -> Option<Self> {
        let EndCondition::Ball { mass, velocity: own, contact } = *condition else { return None };
        let earlier = normal * dt * (own - velocity);
        let (before, after) = (own, own);
        Some(Self { contact, mass, normal, before, after, earlier, now: earlier, approach: 0.0, force: 0.0 })
    }

    /// The force (N, >= 0) of the next step, in which the end would move with `free` (m/s) without it, and gives way to it
    /// by `gain` (m/s per N) and this step `dt` (s).
    pub fn force(&self, free: f64, gain: f64, dt: f64) -> f64 {
        let closing = -self.normal * (self.after - free);
        self.contact.solve(self.now, self.approach + dt * closing, dt * (dt / self.mass + gain))
    }

    /// Takes it a step on, with the force (N, >= 0) at the middle and the end's velocity (m/s) after it.
    pub fn advance(&mut self, force: f64, end: f64, dt: f64) {
        self.before = self.after;
        self.after += self.normal * dt * force / self.mass;
        (self.earlier, self.now) = (self.now, self.approach);
        self.approach += -self.normal * dt * (self.after - end);
        self.force = force;
    }

    /// Velocity at the current time, m/s.
    pub fn velocity(&self) -> f64 {
        0.5 * (self.before + self.after)
    }

    /// Energy of motion and of the contact at the current time, J.
    pub fn energy(&self) -> f64 {
        let stored = self.contact.energy(self.now) + self.contact.energy(self.earlier);
        let under_way = self.force * (self.now - self.earlier);
        0.5 * (self.mass * self.before * self.after + stored + under_way)
    }
}

//! Ends with a prescribed history, free ends and fixed ends.

use super::{Boundary, EndModel, Face, Push, Relation, Response, Step};
use crate::bar::History;

/// End whose velocity follows a history; from `release` on the face is free.
///
/// The exact mean of the history over each step is imposed, so that the displacement of the end is exact after every
/// step. In the step of the release, the force of the step before is applied for the fraction of the step in which the end is still held.
#[derive(Debug, Clone)]
pub(super) struct Velocity {
    history: History,
    release: Option<f64>,
    inward: f64,
    held_force: f64,
}

impl Velocity {
    pub fn new(history: History, release: Option<f64>, face: Face) -> Self {
        Self { history, release, inward: face.inward, held_force: 0.0 }
    }

    /// Returns the fraction of the step in which the end is still held; >= 1 if it is held during the whole step.
    fn held_share(&self, step: &Step) -> f64 {
        self.release.map_or(1.0, |release| (release - step.time) / step.dt)
    }
}

impl EndModel for Velocity {
    fn relation(&self, step: &Step, _: &Response) -> Relation {
        let share = self.held_share(step);
        if share < 1.0 {
            return Relation::force(share.max(0.0) * self.held_force);
        }
        Relation::velocity(self.inward * self.history.mean(step.time, step.time + step.dt))
    }

    fn boundary(&self, step: &Step, _: &Push, _: bool) -> Boundary {
        if self.held_share(step) <= 0.5 {
            return Boundary::FREE;
        }
        let (value, rate) = (self.history.at(step.time), self.history.rate(step.time));
        Boundary::Velocity { value: self.inward * value, rate: self.inward * rate }
    }

    fn advance(&mut self, step: &Step, push: &Push, _: bool) {
        if self.held_share(step) >= 1.0 {
            self.held_force = push.force;
        }
    }

    fn jumps(&self, time: f64, dt: f64) -> bool {
        let released = self.release.is_some_and(|release| (release - time).abs() <= dt);
        released || self.history.jumps_between(time - dt, time + dt)
    }

    fn state(&self) -> [f64; 2] {
        [self.held_force, 0.0]
    }

    fn restore(&mut self, [held_force, _]: [f64; 2]) {
        self.held_force = held_force;
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(self.clone())
    }
}

/// End whose stress follows a history.
#[derive(Debug, Clone)]
pub(super) struct Stress {
    history: History,
    area: f64,
}

impl Stress {
    pub fn new(history: History, face: Face) -> Self {
        Self { history, area: face.area }
    }
}

impl EndModel for Stress {
    fn relation(&self, step: &Step, _: &Response) -> Relation {
        Relation::force(-self.area * self.history.mean(step.time, step.time + step.dt))
    }

    fn boundary(&self, step: &Step, _: &Push, _: bool) -> Boundary {
        let (value, rate) = (self.history.at(step.time), self.history.rate(step.time));
        Boundary::Force { value: -self.area * value, rate: -self.area * rate }
    }

    fn jumps(&self, time: f64, dt: f64) -> bool {
        self.history.jumps_between(time - dt, time + dt)
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(self.clone())
    }
}

/// End without a force.
#[derive(Debug, Clone)]
pub(super) struct Free;

impl EndModel for Free {
    fn relation(&self, _: &Step, _: &Response) -> Relation {
        Relation::force(0.0)
    }

    fn boundary(&self, _: &Step, _: &Push, _: bool) -> Boundary {
        Boundary::FREE
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(Self)
    }
}

/// End without motion.
#[derive(Debug, Clone)]
pub(super) struct Fixed;

impl EndModel for Fixed {
    fn relation(&self, _: &Step, _: &Response) -> Relation {
        Relation::velocity(0.0)
    }

    fn boundary(&self, _: &Step, _: &Push, _: bool) -> Boundary {
        Boundary::FIXED
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(Self)
    }
}

//! The ends of a tracked bar: what drives them, and what they record.

use super::ball::Ball;
use super::contact::JointChange;
use super::ramp::{SHORTEST, Staircase};
use super::spring::Spring;
use super::striker::{Striker, StrikerState};
use crate::bar::{EndCondition, History};
use crate::wave::riemann::{Medium, Point};

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
    /// A dashpot whose other side moves with this velocity (m/s); a force drives it at `compliance` (m/(s N)).
    Dashpot {
        /// m/s.
        velocity: f64,
        /// m/(s N).
        compliance: f64,
    },
    /// Velocity 0, unless that would take tension.
    Push,
    /// Nothing: the end goes along with what comes.
    Pass,
    /// A rigid mass with this velocity (m/s) at no force, which gives way by `compliance` (m/(s N)), unless that would
    /// take tension.
    Mass {
        /// m/s.
        velocity: f64,
        /// m/(s N).
        compliance: f64,
    },
    /// A spring with this force (N, tension positive) at rest, which gives way by `compliance` (m/(s N)).
    Spring {
        /// N.
        force: f64,
        /// m/(s N).
        compliance: f64,
    },
}

/// A body at an end that moves by itself.
#[derive(Debug, Clone)]
enum Body {
    None,
    Striker(Striker),
    Ball(Ball),
    Spring(Spring),
}

/// An end with its clock.
#[derive(Debug, Clone)]
pub struct End {
    condition: EndCondition,
    /// What it imposes over time, if it does.
    imposed: Option<Staircase>,
    body: Body,
    /// +1 at the left end, -1 at the right: the way into the bar.
    pub inward: f64,
    /// Velocity of the bar there at the start, m/s, and 1/(rho c0 A), m/(s N), for the absorbing end.
    rest: f64,
    absorbing: f64,
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
    /// At an end of a bar that moves there with `rest` (m/s).
    pub fn new(condition: EndCondition, inward: f64, rest: f64, medium: &Medium) -> Self {
        let gap = if let EndCondition::Wall { gap } = condition { gap } else { 0.0 };
        let (area, impedance) = (medium.area, medium.impedance());
        let body = match condition {
            EndCondition::Striker { mass, velocity } => {
                Body::Striker(Striker::new(mass, velocity, inward, area, impedance))
            }
            EndCondition::Ball { mass, velocity, contact } => {
                Body::Ball(Ball::new(contact, (mass, velocity), inward, area, impedance))
            }
            EndCondition::Spring { stiffness } => Body::Spring(Spring::new(stiffness, inward, area, impedance)),
            _ => Body::None,
        };
        Self {
            condition,
            imposed: None,
            body,
            inward,
            rest,
            absorbing: 1.0 / (impedance * area),
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

    /// True where its history has a ramp, or a body moves with it.
    pub fn needs_steps(&self) -> bool {
        match &self.condition {
            EndCondition::Velocity { history, .. } | EndCondition::Stress { history } => history.has_ramp(),
            _ => !matches!(self.body, Body::None),
        }
    }

    /// Makes the ramps of its history into steps of `step` times `level` (Pa; velocities by the elastic impedance), and
    /// lets a body at the end take steps of that kind. `transit` is the bar's elastic transit time, s.
    pub fn set_steps(&mut self, step: f64, level: f64, impedance: f64, transit: f64) {
        let shortest = SHORTEST * transit;
        self.imposed = match &self.condition {
            EndCondition::Velocity { history, .. } => Some(Staircase::new(history, step * level / impedance, shortest)),
            EndCondition::Stress { history } => Some(Staircase::new(history, step * level, shortest)),
            _ => None,
        };
        match &mut self.body {
            Body::Striker(striker) => striker.pace.set(step, level),
            Body::Ball(ball) => ball.set(step, level),
            Body::Spring(spring) => spring.pace.set(step, level),
            Body::None => {}
        }
    }

    /// Brings the account and the gap to t. Times up to `tolerance` later count as t.
    pub fn bring_to(&mut self, t: f64, tolerance: f64) {
        (self.work, self.impulse) = self.account(t);
        let dt = t - self.since;
        if !self.held {
            self.gap += self.inward * self.velocity * dt;
        }
        match &mut self.body {
            Body::Striker(striker) => striker.bring_to(t, dt, self.stress, self.velocity, tolerance),
            Body::Ball(ball) => ball.bring_to(t, dt, self.stress, self.velocity, tolerance),
            Body::Spring(spring) => spring.bring_to(t, dt, self.stress, self.velocity, tolerance),
            Body::None => {}
        }
        self.since = t;
    }

    /// Waves weaker than this (Pa) do not break the step of a body at the end.
    pub fn passing(&self) -> f64 {
        match &self.body {
            Body::Striker(striker) => striker.pace.passing(),
            Body::Ball(ball) => ball.passing(),
            Body::Spring(spring) => spring.pace.passing(),
            Body::None => 0.0,
        }
    }

    /// How long the next step of a body at the end should be, s, if there is to be one: `bar` is what has come near.
    pub fn wish(&mut self, bar: &Point, impedance: f64) -> Option<f64> {
        let change = (bar.stress - self.stress).abs().max((bar.velocity - self.velocity).abs() * impedance);
        match &mut self.body {
            Body::Striker(striker) => striker.wish(bar, change),
            Body::Ball(ball) => ball.wish(self.since, bar, change),
            Body::Spring(spring) => spring.wish(bar, change),
            Body::None => None,
        }
    }

    /// What drives the end from now on, where it has been brought; a body is to take a step of `step` (s), none: to go on
    /// with the present one. Times up to `tolerance` later count as now.
    pub fn drive(&mut self, bar: &Point, step: Option<f64>, tolerance: f64) -> Drive {
        let at = self.since + tolerance;
        match (&mut self.body, step) {
            (Body::Striker(striker), _) if !striker.touches() => return Drive::Stress(0.0),
            (Body::Ball(ball), _) if !ball.touches() => return Drive::Stress(0.0),
            (Body::None, _) => {}
            (_, None) => return Drive::Pass,
            (Body::Striker(striker), Some(step)) => return striker.drive(step, bar.stress),
            (Body::Ball(ball), Some(step)) => return ball.drive(step, bar),
            (Body::Spring(spring), Some(step)) => return spring.drive(step, bar.velocity),
        }
        match &self.condition {
            EndCondition::Velocity { release: Some(release), .. } if *release <= at => Drive::Stress(0.0),
            EndCondition::Velocity { history, .. } => Drive::Velocity(self.imposed_at(history, at)),
            EndCondition::Stress { history } => Drive::Stress(self.imposed_at(history, at)),
            EndCondition::Fixed => Drive::Velocity(0.0),
            EndCondition::Absorbing => Drive::Dashpot { velocity: self.rest, compliance: self.absorbing },
            EndCondition::Dashpot { coefficient } if *coefficient > 0.0 => {
                Drive::Dashpot { velocity: 0.0, compliance: 1.0 / coefficient }
            }
            // Striker, ball and spring have answered above.
            EndCondition::Free
            | EndCondition::Dashpot { .. }
            | EndCondition::Striker { .. }
            | EndCondition::Ball { .. }
            | EndCondition::Spring { .. } => Drive::Stress(0.0),
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

    fn imposed_at(&self, history: &History, t: f64) -> f64 {
        self.imposed.as_ref().map_or_else(|| history.at(t), |imposed| imposed.at(t))
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
        match &mut self.body {
            Body::Striker(striker) => striker.settle(t, stress, velocity, held, round_off),
            Body::Ball(ball) => ball.settle(t, velocity, round_off),
            Body::Spring(spring) => spring.settle(t, stress, velocity, round_off),
            Body::None => {}
        }
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
        let step = self.imposed.as_ref().map_or(f64::INFINITY, |imposed| imposed.next_after(t));
        match &self.body {
            Body::Striker(striker) => return striker.next_time(),
            Body::Ball(ball) => return ball.next_time(),
            Body::Spring(spring) => return spring.next_time(),
            Body::None => {}
        }
        match &self.condition {
            EndCondition::Velocity { release: Some(release), .. } if *release <= t => f64::INFINITY,
            EndCondition::Velocity { release, .. } => step.min(release.unwrap_or(f64::INFINITY)),
            EndCondition::Stress { .. } => step,
            EndCondition::Wall { .. } => self.closes,
            _ => f64::INFINITY,
        }
    }

    /// Largest stress (Pa) and the range of velocities (m/s) that it imposes.
    pub fn reach(&self) -> (f64, [f64; 2]) {
        let range = |h: &History| {
            [h.value().iter().fold(0.0, |m: f64, &v| m.min(v)), h.value().iter().fold(0.0, |m: f64, &v| m.max(v))]
        };
        if let Body::Ball(ball) = &self.body {
            return (ball.reach(self.rest), [self.rest; 2]);
        }
        match &self.condition {
            EndCondition::Velocity { history, .. } => (0.0, range(history)),
            EndCondition::Stress { history } => (history.extreme().abs(), [self.rest; 2]),
            EndCondition::Fixed | EndCondition::Wall { .. } => (0.0, [0.0; 2]),
            EndCondition::Striker { velocity, .. } => (0.0, [*velocity; 2]),
            EndCondition::Spring { .. } | EndCondition::Dashpot { .. } => (0.0, [0.0, self.rest]),
            EndCondition::Free | EndCondition::Absorbing | EndCondition::Ball { .. } => (0.0, [self.rest; 2]),
        }
    }

    /// The bar breaks off what is at its end, which is free from now on.
    pub fn let_go(&mut self) {
        (self.condition, self.imposed) = (EndCondition::Free, None);
        self.body = Body::None;
    }

    /// The striker or ball at time t, if there is one.
    pub fn striker(&self, t: f64) -> Option<StrikerState> {
        let dt = t - self.since;
        match &self.body {
            Body::Striker(striker) => Some(striker.at(dt, self.stress, self.velocity)),
            Body::Ball(ball) => Some(ball.at(dt, self.stress, self.velocity)),
            Body::None | Body::Spring(_) => None,
        }
    }

    /// A striker would have to pull with this stress, Pa.
    pub fn would_pull(&mut self, stress: f64) {
        if let Body::Striker(striker) = &mut self.body {
            striker.would_pull(stress);
        }
    }

    /// When a striker or a ball touched the end and let go of it.
    pub fn striker_changes(&self) -> &[JointChange] {
        match &self.body {
            Body::Striker(striker) => striker.changes(),
            Body::Ball(ball) => ball.changes(),
            Body::None | Body::Spring(_) => &[],
        }
    }

    /// Energy of the body at the end at time t, J: of motion for a striker, stored for a spring, both for a ball.
    pub fn body_energy(&self, t: f64) -> f64 {
        match &self.body {
            Body::Striker(striker) => {
                let state = striker.at(t - self.since, self.stress, self.velocity);
                0.5 * state.mass * state.velocity * state.velocity
            }
            Body::Ball(ball) => ball.energy(t - self.since, self.stress, self.velocity),
            Body::Spring(spring) => spring.energy(t - self.since, self.velocity),
            Body::None => 0.0,
        }
    }
}

//! Boundary conditions: one relation between force and velocity for every solver.
//!
//! Everything here is seen from the bar: u is the velocity of the face **into** the bar (m/s), p the force that presses on the
//! face (N, compression positive), both means over a step. The bar answers a push with
//!
//! ```text
//! p = q + Y u          (Response: q the force at u = 0, Y > 0 the impedance of the face, N s/m)
//! ```
//!
//! and an end asks for
//!
//! ```text
//! a u + b p = c        (Relation: a, b >= 0, not both 0)
//! ```
//!
//! A prescribed velocity has b = 0, a prescribed force a = 0. Springs, dashpots and masses lie between and reach these limits
//! without dividing by anything that vanishes. A solver whose bar is not linear solves its Riemann problem against the same
//! relation.
//!
//! A kind of end is one [`EndModel`] in a file of its own.

mod ball;
mod dashpot;
mod driven;
mod spring;
mod striker;
mod wall;

use serde::{Deserialize, Serialize};

use super::EndCondition;

/// What an end is attached to.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Face {
    /// +1 at the left end, -1 at the right: the way into the bar.
    pub inward: f64,
    /// Section, m^2.
    pub area: f64,
    /// Elastic impedance of the section, rho c0 A, N s/m.
    pub impedance: f64,
    /// Velocity into the bar at the start, m/s.
    pub velocity: f64,
}

/// A step of a face.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// s.
    pub time: f64,
    /// s, > 0.
    pub dt: f64,
    /// Displacement of the face at `time` since the start, into the bar, m.
    pub displacement: f64,
}

impl Step {
    /// The beginning of the step: so short that no body feels anything of it.
    #[must_use]
    pub fn short(self) -> Self {
        Self { dt: SHORT * self.dt, ..self }
    }
}

/// The beginning of a step, in steps.
const SHORT: f64 = 1e-9;

/// Part by which an end's impedance may exceed the bar's where they are equal.
const ROUNDING: f64 = 1e-9;

/// How the bar answers at its face: p = `force` + `impedance` u.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// q, N.
    pub force: f64,
    /// Y, N s/m, > 0.
    pub impedance: f64,
}

impl Response {
    /// u of the face under a force p (N), m/s.
    pub fn velocity(&self, force: f64) -> f64 {
        (force - self.force) / self.impedance
    }
}

/// The relation of an end: a u + b p = c.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Relation {
    /// a, N s/m (or 1 with b = 0), >= 0.
    pub of_velocity: f64,
    /// b, >= 0.
    pub of_force: f64,
    /// c.
    pub value: f64,
    /// The end pushes and cannot pull: where p would be negative, the face is free instead.
    pub unilateral: bool,
}

/// Force (N, compression positive) and velocity (m/s, into the bar) of a face over a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Push {
    /// p.
    pub force: f64,
    /// u.
    pub velocity: f64,
    /// Impulse on the bar in the step, N s: p dt, except for corrections of the solver.
    pub impulse: f64,
}

impl Relation {
    /// u is given, m/s.
    pub fn velocity(u: f64) -> Self {
        Self { of_velocity: 1.0, of_force: 0.0, value: u, unilateral: false }
    }

    /// p is given, N.
    pub fn force(p: f64) -> Self {
        Self { of_velocity: 0.0, of_force: 1.0, value: p, unilateral: false }
    }

    /// The same, without a pull.
    #[must_use]
    pub fn without_pull(self) -> Self {
        Self { unilateral: true, ..self }
    }

    /// What is at the end resists its motion more than the bar does, and not as much but for rounding.
    pub fn resists(&self, bar: &Response) -> bool {
        self.of_velocity > (1.0 + ROUNDING) * self.of_force * bar.impedance
    }

    /// Force and velocity at which bar and end agree, whether or not that is a pull.
    /// Returns p and u.
    pub fn solve_with(&self, bar: &Response) -> [f64; 2] {
        let (a, b, c) = (self.of_velocity, self.of_force, self.value);
        let sum = a + b * bar.impedance;
        let velocity = (c - b * bar.force) / sum;
        // From the side that loses no digits: a prescribed force comes back to the bit.
        let force = if a == 0.0 { c / b } else { (a * bar.force + bar.impedance * c) / sum };
        [force, velocity]
    }
}

/// What is known of the face at the beginning of a step, with its rate of change: what the slopes of a second-order scheme fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Boundary {
    /// u, m/s, and its rate, m/s^2.
    Velocity {
        /// m/s.
        value: f64,
        /// m/s^2.
        rate: f64,
    },
    /// p, N, and its rate, N/s.
    Force {
        /// N.
        value: f64,
        /// N/s.
        rate: f64,
    },
    /// Nothing: waves pass.
    Open,
}

impl Boundary {
    const FREE: Self = Self::Force { value: 0.0, rate: 0.0 };
    const FIXED: Self = Self::Velocity { value: 0.0, rate: 0.0 };
}

/// A body at an end that moves by itself.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Velocity into the bar, m/s.
    pub velocity: f64,
    /// Distance from the face, m; for a ball in contact less than 0, the approach.
    pub gap: f64,
}

/// How the force of a body relaxes, or swings, against a bar that brings a constant one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// Time constant, s, >= 0.
    pub time: f64,
    /// Force that still has to relax, N, >= 0.
    pub force: f64,
}

/// An end with its state. Between steps the state belongs to the end of the latest one.
pub trait EndModel: std::fmt::Debug + Send + Sync {
    /// The relation of the end over the coming step.
    fn relation(&self, step: &Step, bar: &Response) -> Relation;

    /// What is known of the face at the beginning of the coming step; `latest` is the push of the step before, in which the relation was
    /// `met`.
    fn boundary(&self, step: &Step, latest: &Push, met: bool) -> Boundary;

    /// Takes the step with what came of it; `held`: the relation was met (false where a unilateral end left the face free).
    fn advance(&mut self, _step: &Step, _push: &Push, _held: bool) {}

    /// A body gives the bar this impulse (N s, into the bar) in the latest step of `dt` (s), besides that of the step. Returns the change of
    /// velocity (m/s, into the bar) with which a face of this `mass` (kg) stays with it; it gives the impulse for that, too.
    fn give(&mut self, _dt: f64, _impulse: f64, _mass: f64) -> f64 {
        0.0
    }

    /// The face has moved this much farther into the bar in the latest step than its push says, m.
    fn shift(&mut self, _farther: f64) {}

    /// The body that moves at this end, if there is one.
    fn body(&self) -> Option<Body> {
        None
    }

    /// Distance between the face at `displacement` (m, into the bar) and what it can strike, m; less than 0 where a ball is
    /// compressed. None where nothing can part.
    fn gap(&self, _displacement: f64) -> Option<f64> {
        self.body().map(|body| body.gap)
    }

    /// How a body in contact with the face relaxes; none where nothing moves by itself.
    fn relaxation(&self, _displacement: f64, _bar: &Response) -> Option<Relaxation> {
        None
    }

    /// Energy that the end holds after the latest step, J: of motion for a mass, stored for a spring, both for a ball; >= 0.
    /// `displacement` is that of the face, m, into the bar.
    fn energy(&self, _displacement: f64) -> f64 {
        0.0
    }

    /// The relation depends on the force that the bar brings, so that it must be found together with a bar that flows: see [`agree`].
    fn is_nonlinear(&self) -> bool {
        false
    }

    /// The end has an energy of its own, so that its work is what that loses.
    fn stores(&self) -> bool {
        false
    }

    /// What is prescribed jumps, or is released, within `dt` (s) of `time`.
    fn jumps(&self, _time: f64, _dt: f64) -> bool {
        false
    }

    /// The place of the face matters to what is there, and not its velocity alone.
    fn follows_place(&self) -> bool {
        false
    }

    /// The numbers that change from step to step, for a checkpoint; 0 where there are fewer.
    fn state(&self) -> [f64; 2] {
        [0.0; 2]
    }

    /// Takes over what [`Self::state`] gave.
    fn restore(&mut self, _state: [f64; 2]) {}

    /// A copy with its state.
    fn boxed(&self) -> Box<dyn EndModel>;
}

impl Clone for Box<dyn EndModel> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}

/// The relation of an end whose own law is not linear (a ball) against a bar that does not answer linearly either: repeated with what the
/// bar's answer was worth at `impedance`, until it stays. `respond` gives p and u for a relation.
pub fn agree(
    model: &dyn EndModel,
    step: &Step,
    bar: &Response,
    mut respond: impl FnMut(&Relation) -> [f64; 2],
) -> Relation {
    let mut relation = model.relation(step, bar);
    for _ in 0..MOST_REPEATS {
        let [force, velocity] = respond(&relation);
        let next = model.relation(step, &Response { force: force - bar.impedance * velocity, ..*bar });
        if next == relation {
            break;
        }
        relation = next;
    }
    relation
}

/// Force and velocity just after the beginning of a step, against a bar that answers at once by `bar`.
pub fn at_once(model: &dyn EndModel, step: &Step, bar: &Response) -> [f64; 2] {
    let relation = model.relation(&step.short(), bar);
    let [force, velocity] = relation.solve_with(bar);
    if relation.unilateral && force <= 0.0 { [0.0, bar.velocity(0.0)] } else { [force, velocity] }
}

/// Flow changes the answer by a part of a step's worth: each repeat is closer by that, and some ten reach the last bit.
const MOST_REPEATS: usize = 40;

/// Weight of a step's end in the mean of a quantity that relaxes exponentially, `1/(1 - exp(-z)) - 1/z` with z the step over the
/// relaxation time: from 1/2 where the step resolves the relaxation (the midpoint rule) to 1 where it does not. The mean is then exact
/// for a constant force from the bar, and no step is too long.
fn relaxation_weight(z: f64) -> f64 {
    if z < 1e-3 { 0.5 + z / 12.0 } else { -1.0 / (-z).exp_m1() - 1.0 / z }
}

/// A place holder for a model that is put back, for what is read from a checkpoint.
pub(crate) fn stateless() -> Box<dyn EndModel> {
    Box::new(driven::Free)
}

/// The model of an end.
pub fn model(condition: &EndCondition, face: Face) -> Box<dyn EndModel> {
    match condition.clone() {
        EndCondition::Velocity { history, release } => Box::new(driven::Velocity::new(history, release, face)),
        EndCondition::Stress { history } => Box::new(driven::Stress::new(history, face)),
        EndCondition::Free => Box::new(driven::Free),
        EndCondition::Fixed => Box::new(driven::Fixed),
        EndCondition::Absorbing => Box::new(dashpot::Dashpot::absorbing(face)),
        EndCondition::Dashpot { coefficient } => Box::new(dashpot::Dashpot::to_ground(coefficient)),
        EndCondition::Wall { gap } => Box::new(wall::Wall { gap }),
        EndCondition::Striker { mass, velocity } => Box::new(striker::Striker::new(mass, velocity, face)),
        EndCondition::Ball { mass, velocity, contact } => Box::new(ball::Ball::new(contact, mass, velocity, face)),
        EndCondition::Spring { stiffness } => Box::new(spring::Spring::new(stiffness)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_relaxation_weight_rises_smoothly_between_its_limits() {
        assert_eq!(relaxation_weight(0.0), 0.5);
        // Two terms of its series against the formula, where they take over.
        assert!((relaxation_weight(0.999_999e-3) - relaxation_weight(1.000_001e-3)).abs() < 1e-9);
        assert_eq!(relaxation_weight(f64::INFINITY), 1.0);
        let all: Vec<f64> = (0..200).map(|k| relaxation_weight(1e-6 * 1.2_f64.powi(k))).collect();
        assert!(all.windows(2).all(|pair| pair[0] <= pair[1] + 1e-12));
    }
}

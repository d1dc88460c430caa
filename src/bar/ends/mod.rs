//! Boundary conditions: one relation between force and velocity for every solver.
//!
//! All quantities are as seen from the bar: u is the velocity of the face **into** the bar (m/s), p the force that presses on the
//! face (N, compression positive), both as means over a step. The bar responds to a push with
//!
//! ```text
//! p = q + Y u          (Response: q the force at u = 0, Y > 0 the impedance of the face, N s/m)
//! ```
//!
//! and an end requires
//!
//! ```text
//! a u + b p = c        (Relation: a, b >= 0, not both 0)
//! ```
//!
//! A prescribed velocity has b = 0, a prescribed force a = 0. Springs, dashpots and masses lie in between and reach these limits
//! without vanishing denominators. A solver with a nonlinear bar solves its Riemann problem with the same
//! relation.
//!
//! Each kind of end is an [`EndModel`] in a file of its own.

mod ball;
mod dashpot;
mod driven;
mod spring;
mod striker;
mod wall;

use serde::{Deserialize, Serialize};

use super::EndCondition;

/// Face of the bar to which an end is attached.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Face {
    /// Direction into the bar: +1 at the left end, -1 at the right.
    pub inward: f64,
    /// Cross-sectional area, m^2.
    pub area: f64,
    /// Elastic impedance of the section, rho c0 A, N s/m.
    pub impedance: f64,
    /// Velocity into the bar at t = 0, m/s.
    pub velocity: f64,
}

/// A time step of a face.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// Start of the step, s.
    pub time: f64,
    /// Duration of the step, s, > 0.
    pub dt: f64,
    /// Displacement of the face at `time` since t = 0, into the bar, m.
    pub displacement: f64,
}

impl Step {
    /// Returns the beginning of the step, so short that no body reacts to it.
    #[must_use]
    pub fn short(self) -> Self {
        Self { dt: SHORT * self.dt, ..self }
    }
}

/// Duration of [`Step::short`], relative to the step.
const SHORT: f64 = 1e-9;

/// Relative excess of an end's impedance over the bar's up to which they count as equal.
const ROUNDING: f64 = 1e-9;

/// Response of the bar at its face: p = `force` + `impedance` u.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// q, N.
    pub force: f64,
    /// Y, N s/m, > 0.
    pub impedance: f64,
}

impl Response {
    /// Returns the velocity u of the face under a force p (N), m/s.
    pub fn velocity(&self, force: f64) -> f64 {
        (force - self.force) / self.impedance
    }
}

/// Relation of an end: a u + b p = c.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Relation {
    /// a, N s/m (or 1 with b = 0), >= 0.
    pub of_velocity: f64,
    /// b, >= 0.
    pub of_force: f64,
    /// c.
    pub value: f64,
    /// Whether the end can push but not pull: where p would be negative, the face is free instead.
    pub unilateral: bool,
}

/// Force (N, compression positive) and velocity (m/s, into the bar) of a face over a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Push {
    /// p, N.
    pub force: f64,
    /// u, m/s.
    pub velocity: f64,
    /// Impulse on the bar in the step, N s: p dt, except for corrections by the solver.
    pub impulse: f64,
}

impl Relation {
    /// Returns the relation of a prescribed velocity u, m/s.
    pub fn velocity(u: f64) -> Self {
        Self { of_velocity: 1.0, of_force: 0.0, value: u, unilateral: false }
    }

    /// Returns the relation of a prescribed force p, N.
    pub fn force(p: f64) -> Self {
        Self { of_velocity: 0.0, of_force: 1.0, value: p, unilateral: false }
    }

    /// Returns the relation without tension.
    #[must_use]
    pub fn without_pull(self) -> Self {
        Self { unilateral: true, ..self }
    }

    /// Returns true if the end resists the motion of the face more than the bar does, by more than rounding.
    pub fn resists(&self, bar: &Response) -> bool {
        self.of_velocity > (1.0 + ROUNDING) * self.of_force * bar.impedance
    }

    /// Returns the force p and the velocity u at which bar and end agree, even if p is a tension.
    pub fn solve_with(&self, bar: &Response) -> [f64; 2] {
        let (a, b, c) = (self.of_velocity, self.of_force, self.value);
        let sum = a + b * bar.impedance;
        let velocity = (c - b * bar.force) / sum;
        // This form loses no digits: a prescribed force is reproduced exactly.
        let force = if a == 0.0 { c / b } else { (a * bar.force + bar.impedance * c) / sum };
        [force, velocity]
    }
}

/// Known quantity of the face at the beginning of a step, with its rate of change, to which the slopes of a second-order scheme are fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Boundary {
    /// The velocity u, m/s, and its rate, m/s^2.
    Velocity {
        /// Velocity, m/s.
        value: f64,
        /// Rate of change, m/s^2.
        rate: f64,
    },
    /// The force p, N, and its rate, N/s.
    Force {
        /// Force, N.
        value: f64,
        /// Rate of change, N/s.
        rate: f64,
    },
    /// Neither is known: waves pass.
    Open,
}

impl Boundary {
    const FREE: Self = Self::Force { value: 0.0, rate: 0.0 };
    const FIXED: Self = Self::Velocity { value: 0.0, rate: 0.0 };
}

/// A freely moving body at an end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Velocity into the bar, m/s.
    pub velocity: f64,
    /// Distance from the face, m; for a ball in contact, minus the approach.
    pub gap: f64,
}

/// Relaxation (or oscillation) of the force of an end against a bar whose incident force is constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// Time constant, s, >= 0.
    pub time: f64,
    /// Remaining force to relax, N, >= 0.
    pub force: f64,
}

/// An end with its state. Between steps, the state is that at the end of the latest step.
pub trait EndModel: std::fmt::Debug + Send + Sync {
    /// Returns the relation of the end over the coming step.
    fn relation(&self, step: &Step, bar: &Response) -> Relation;

    /// Returns the known quantity of the face at the beginning of the coming step. `latest` is the push of the previous step; `met` tells whether the
    /// relation was met in it.
    fn boundary(&self, step: &Step, latest: &Push, met: bool) -> Boundary;

    /// Advances the end by a step, given its result. `held` tells whether the relation was met (false if a unilateral end left the face free).
    fn advance(&mut self, _step: &Step, _push: &Push, _held: bool) {}

    /// Applies an additional impulse (N s, into the bar) from a body to the bar in the latest step of `dt` (s). Returns the change of velocity (m/s,
    /// into the bar) with which a face of this `mass` (kg) stays in contact with the body; the body supplies the impulse for that, too.
    fn apply_impulse(&mut self, _dt: f64, _impulse: f64, _mass: f64) -> f64 {
        0.0
    }

    /// Adds a displacement of the face (m, into the bar) in the latest step to that of its push.
    fn add_displacement(&mut self, _farther: f64) {}

    /// Returns the body that moves at this end, if there is one.
    fn body(&self) -> Option<Body> {
        None
    }

    /// Returns the distance between the face at `displacement` (m, into the bar) and the body or wall that it can strike, m; negative for a
    /// compressed ball contact. `None` if nothing can separate from the face.
    fn gap(&self, _displacement: f64) -> Option<f64> {
        self.body().map(|body| body.gap)
    }

    /// Returns the relaxation of the end, e.g. of a body in contact with the face; `None` if the end has none.
    fn relaxation(&self, _displacement: f64, _bar: &Response) -> Option<Relaxation> {
        None
    }

    /// Returns the energy of the end after the latest step, J, >= 0: kinetic for a mass, stored for a spring, both for a ball.
    /// `displacement` is that of the face, m, into the bar.
    fn energy(&self, _displacement: f64) -> f64 {
        0.0
    }

    /// Returns true if the relation depends on the force that the bar brings. It must then be solved together with a nonlinear bar, see [`agree`].
    fn is_nonlinear(&self) -> bool {
        false
    }

    /// Returns true if the work of the end is the energy that it loses: it stores energy, or does no work at all, as a wall.
    fn is_conservative(&self) -> bool {
        false
    }

    /// Returns true if the prescribed quantity jumps, or the end is released, within `dt` (s) of `time`.
    fn jumps(&self, _time: f64, _dt: f64) -> bool {
        false
    }

    /// Returns true if the end depends on the position of the face, not only on its velocity.
    fn depends_on_displacement(&self) -> bool {
        false
    }

    /// Returns the variables that change from step to step, for a checkpoint; unused ones are 0.
    fn state(&self) -> [f64; 2] {
        [0.0; 2]
    }

    /// Restores the variables returned by [`Self::state`].
    fn restore(&mut self, _state: [f64; 2]) {}

    /// Returns a copy, including the state.
    fn boxed(&self) -> Box<dyn EndModel>;
}

impl Clone for Box<dyn EndModel> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}

/// Returns the relation of a nonlinear end (a ball) with a bar whose response is nonlinear, too. Iterates with the linear response at
/// `bar.impedance` that is equivalent to the latest response, until the relation is unchanged. `respond` returns p and u for a relation.
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

/// Returns force and velocity just after the beginning of a step, for a bar with the immediate response `bar`.
pub fn at_once(model: &dyn EndModel, step: &Step, bar: &Response) -> [f64; 2] {
    let relation = model.relation(&step.short(), bar);
    let [force, velocity] = relation.solve_with(bar);
    if relation.unilateral && force <= 0.0 { [0.0, bar.velocity(0.0)] } else { [force, velocity] }
}

/// Largest number of iterations of [`agree`]. Plastic flow changes the response by a fraction; each iteration reduces the error by that factor, and
/// about ten reach the last bit.
const MOST_REPEATS: usize = 40;

/// Returns the weight of the end of a step in the mean of a quantity that relaxes exponentially, `1/(1 - exp(-z)) - 1/z` with z the ratio of the step
/// to the relaxation time: from 1/2 where the step resolves the relaxation (the midpoint rule) to 1 where it does not. The mean is then exact
/// for a constant force from the bar, and stable for any step.
fn relaxation_weight(z: f64) -> f64 {
    if z < 1e-3 { 0.5 + z / 12.0 } else { -1.0 / (-z).exp_m1() - 1.0 / z }
}

/// Returns a placeholder for a model, for data read from a checkpoint before the model is restored.
pub(crate) fn stateless() -> Box<dyn EndModel> {
    Box::new(driven::Free)
}

/// Returns the model of an end.
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
        // Two terms of the series against the formula, at the argument where the code switches.
        assert!((relaxation_weight(0.999_999e-3) - relaxation_weight(1.000_001e-3)).abs() < 1e-9);
        assert_eq!(relaxation_weight(f64::INFINITY), 1.0);
        let all: Vec<f64> = (0..200).map(|k| relaxation_weight(1e-6 * 1.2_f64.powi(k))).collect();
        assert!(all.windows(2).all(|pair| pair[0] <= pair[1] + 1e-12));
    }
}

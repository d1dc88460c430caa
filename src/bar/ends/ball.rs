//! Elastic ball in Hertz contact with the end.

use super::{Body, Boundary, EndModel, Face, Push, Relation, Relaxation, Response, Step};
use crate::bar::Hertz;

/// A ball that pushes over a step with (P(a+) - P(a))/(a+ - a), where P is the energy stored in the contact and a, a+ are the approaches before
/// and after the step (a discrete gradient; W. A. Strauss and L. Vazquez, J. Comput. Phys. 28, 1978). This is stable for any stiffness, and
/// the contact returns exactly the energy that it stored. Against a bar with a linear response the force is exact; against a bar that flows it is
/// linearized.
#[derive(Debug, Clone)]
pub(super) struct Ball {
    contact: Hertz,
    /// Mass, kg, > 0.
    mass: f64,
    /// Velocity into the bar, m/s.
    velocity: f64,
    /// Approach, m; negative if ball and face are apart.
    approach: f64,
}

impl Ball {
    /// Returns a ball that touches the face; `velocity` (m/s) is positive in +x.
    pub fn new(contact: Hertz, mass: f64, velocity: f64, face: Face) -> Self {
        Self { contact, mass, velocity: face.inward * velocity, approach: 0.0 }
    }
}

impl EndModel for Ball {
    fn relation(&self, step: &Step, bar: &Response) -> Relation {
        let dt = step.dt;
        let free = self.approach + dt * (self.velocity + bar.force / bar.impedance);
        let inertia = 0.5 * dt * dt / self.mass;
        let compliance = inertia + dt / bar.impedance;
        let force = self.contact.solve(self.approach, free, compliance);
        let to = free - compliance * force;
        let slope = self.contact.slope(self.approach, to, force).max(0.0);
        // Linearization: p = force + slope (a+ - to).
        Relation {
            of_velocity: slope * dt,
            of_force: 1.0 + slope * inertia,
            value: force + slope * (self.approach + dt * self.velocity - to),
            unilateral: false,
        }
    }

    fn boundary(&self, _: &Step, latest: &Push, _: bool) -> Boundary {
        let stiffness = self.contact.slope(self.approach, self.approach, 0.0);
        Boundary::Force {
            value: self.contact.force(self.approach),
            rate: 2.0 * stiffness * (self.velocity - latest.velocity),
        }
    }

    fn advance(&mut self, step: &Step, push: &Push, _: bool) {
        let change = -push.impulse / self.mass;
        self.approach += step.dt * (self.velocity + 0.5 * change - push.velocity);
        self.velocity += change;
    }

    fn apply_impulse(&mut self, dt: f64, impulse: f64, _: f64) -> f64 {
        let change = -impulse / self.mass;
        self.velocity += change;
        self.approach += 0.5 * dt * change;
        0.0
    }

    fn add_displacement(&mut self, farther: f64) {
        self.approach -= farther;
    }

    fn body(&self) -> Option<Body> {
        Some(Body { velocity: self.velocity, gap: -self.approach })
    }

    /// Returns the larger of half the contact time on a fixed flat, and the relaxation time of the mass in a rigid contact.
    fn relaxation(&self, _: f64, bar: &Response) -> Option<Relaxation> {
        let closing = self.velocity + bar.force / bar.impedance;
        let compressed = 2.0 * self.contact.energy(self.approach) / self.mass;
        let swing = 0.5 * self.contact.contact_time(self.mass, closing.hypot(compressed.sqrt()));
        let force = self.contact.force(self.approach).max((bar.impedance * closing).abs());
        Some(Relaxation { time: swing.max(self.mass / bar.impedance), force })
    }

    fn energy(&self, _: f64) -> f64 {
        0.5 * self.mass * self.velocity * self.velocity + self.contact.energy(self.approach)
    }

    fn depends_on_displacement(&self) -> bool {
        true
    }

    fn is_conservative(&self) -> bool {
        true
    }

    fn is_nonlinear(&self) -> bool {
        true
    }

    fn state(&self) -> [f64; 2] {
        [self.velocity, self.approach]
    }

    fn restore(&mut self, state: [f64; 2]) {
        [self.velocity, self.approach] = state;
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(self.clone())
    }
}

//! Rigid striker in unilateral contact with the end.

use super::{Body, Boundary, EndModel, Face, Push, Relation, Relaxation, Response, Step, relaxation_weight};

/// A rigid mass. In contact it moves over a step with `V - theta p dt/M`, and closes the gap, if any:
///
/// ```text
/// M/dt u + theta p = M/dt (V - gap/dt)
/// ```
///
/// Against the bar's impedance Y its velocity relaxes with the time constant M/Y, and theta is the [`relaxation_weight`] for it: second order
/// where the step resolves the mass. M = 0 gives a free end, M to infinity a prescribed velocity. Momentum is exchanged exactly.
#[derive(Debug, Clone)]
pub(super) struct Striker {
    /// Mass M, kg, >= 0.
    mass: f64,
    /// Velocity V into the bar, m/s.
    velocity: f64,
    /// Distance from the face, m.
    gap: f64,
}

impl Striker {
    /// Returns a striker that touches the face; `velocity` (m/s) is positive in +x.
    pub fn new(mass: f64, velocity: f64, face: Face) -> Self {
        Self { mass, velocity: face.inward * velocity, gap: 0.0 }
    }
}

impl EndModel for Striker {
    fn relation(&self, step: &Step, bar: &Response) -> Relation {
        let of_velocity = self.mass / step.dt;
        Relation {
            of_velocity,
            of_force: relaxation_weight(bar.impedance / of_velocity),
            value: of_velocity * (self.velocity - self.gap / step.dt),
            unilateral: true,
        }
    }

    fn boundary(&self, _: &Step, latest: &Push, met: bool) -> Boundary {
        if !met || self.mass == 0.0 {
            return Boundary::FREE;
        }
        Boundary::Velocity { value: self.velocity, rate: -latest.force / self.mass }
    }

    fn advance(&mut self, step: &Step, push: &Push, held: bool) {
        let before = self.velocity;
        if self.mass > 0.0 {
            self.velocity -= push.impulse / self.mass;
        }
        let moved = step.dt * (push.velocity - 0.5 * (before + self.velocity));
        // A gap that closes at the end of the step counts as closed within the rounding of the time.
        let rounding = 4.0 * f64::EPSILON * (step.time + step.dt) * (push.velocity - self.velocity).abs();
        let gap = self.gap + moved;
        self.gap = if held || gap <= rounding { 0.0 } else { gap };
    }

    fn apply_impulse(&mut self, dt: f64, impulse: f64, mass: f64) -> f64 {
        if self.mass == 0.0 {
            return 0.0;
        }
        // With the change u of the face's velocity: gap + dt (u + (impulse + mass u)/(2 M)) = 0.
        let change = -(self.gap / dt + 0.5 * impulse / self.mass) / (1.0 + 0.5 * mass / self.mass);
        self.velocity -= (impulse + mass * change) / self.mass;
        self.gap = 0.0;
        change
    }

    fn relaxation(&self, _: f64, bar: &Response) -> Option<Relaxation> {
        let force = (bar.force + bar.impedance * self.velocity).abs();
        Some(Relaxation { time: self.mass / bar.impedance, force })
    }

    fn body(&self) -> Option<Body> {
        Some(Body { velocity: self.velocity, gap: self.gap })
    }

    fn energy(&self, _: f64) -> f64 {
        0.5 * self.mass * self.velocity * self.velocity
    }

    fn is_conservative(&self) -> bool {
        true
    }

    fn state(&self) -> [f64; 2] {
        [self.velocity, self.gap]
    }

    fn restore(&mut self, state: [f64; 2]) {
        [self.velocity, self.gap] = state;
    }

    fn boxed(&self) -> Box<dyn EndModel> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_striker_gives_keeps_momentum_and_closes_the_gap() {
        let (dt, mass) = (1e-7, 0.02);
        let mut striker = Striker { mass: 0.5, velocity: 30.0, gap: 2e-8 };
        let change = striker.apply_impulse(dt, 0.3, mass);
        assert!((0.5 * striker.velocity + 0.3 + mass * change - 15.0).abs() < 1e-14);
        // The face moves with the body's mean velocity over the step, and catches up with it.
        let gap = 2e-8 + dt * (change - 0.5 * (striker.velocity - 30.0));
        assert!(gap.abs() < 1e-20 && striker.gap == 0.0, "{gap}");
    }
}

//! The ball at an end of the net: its approach and its velocity live at whole steps.
//!
//! Over a step it pushes with F = (P(a+) - P(a))/(a+ - a), P being the energy stored in the contact and a, a+ the approaches
//! before and after: `M V^2/2 + P(a)` loses exactly what the bar gets.

use crate::bar::{EndCondition, Hertz};

/// A ball that moves by itself.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    contact: Hertz,
    /// kg.
    mass: f64,
    /// Into the bar, m/s.
    pub velocity: f64,
    /// m; less than 0 where it is apart from the end.
    approach: f64,
}

impl Ball {
    /// The ball of an end with the way into the bar `inward`, if it has one.
    pub fn of(condition: &EndCondition, inward: f64) -> Option<Self> {
        let EndCondition::Ball { mass, velocity, contact } = *condition else { return None };
        Some(Self { contact, mass, velocity: inward * velocity, approach: 0.0 })
    }

    /// The force (N, >= 0) over a step of `dt` (s) in which the end would move with `free` (m/s, into the bar) without it and
    /// gives way elastically by `mobility` (m/s per N).
    pub fn force(&self, free: f64, mobility: f64, dt: f64) -> f64 {
        let closing = dt * (self.velocity - free);
        self.contact.solve(self.approach, self.approach + closing, dt * (0.5 * dt / self.mass + mobility))
    }

    /// The same, at most `most` (N), for an end that moves with `end(force)`, which never falls: to the last bit, by halving.
    pub fn force_on(&self, most: f64, end: impl Fn(f64) -> f64, dt: f64) -> f64 {
        let (mut low, mut high) = (0.0, most);
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            let needed = self.contact.mean_force(self.approach, self.after(middle, end(middle), dt));
            if needed > middle {
                low = middle;
            } else {
                high = middle;
            }
        }
    }

    /// The approach after a step with this force (N) and velocity of the end (m/s, into the bar).
    fn after(&self, force: f64, end: f64, dt: f64) -> f64 {
        self.approach + dt * (self.velocity - 0.5 * dt * force / self.mass - end)
    }

    /// Takes that step.
    pub fn advance(&mut self, force: f64, end: f64, dt: f64) {
        self.approach = self.after(force, end, dt);
        self.velocity -= dt * force / self.mass;
    }

    /// Energy of motion and of the contact, J.
    #[cfg(test)]
    pub fn energy(&self) -> f64 {
        0.5 * self.mass * self.velocity * self.velocity + self.contact.energy(self.approach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_takes_from_the_ball_what_it_gives_to_the_end() {
        let contact = Hertz { radius: 0.005, modulus: 1e11 };
        let condition = EndCondition::Ball { mass: 0.004, velocity: -7.0, contact };
        let mut ball = Ball::of(&condition, -1.0).expect("a ball");
        let (start, dt, mobility) = (ball.energy(), 1e-7, 2e-4);
        let mut given = 0.0;
        for _ in 0..600 {
            let elastic = ball.force(0.0, mobility, dt);
            let force = ball.force_on(elastic * 1.5, |force| mobility * force, dt);
            // Both ways lead to one force; the approach is rounded on both.
            assert!((force - elastic).abs() <= 1e-10 * elastic.max(1.0), "{force} {elastic}");
            given += dt * mobility * elastic * elastic;
            ball.advance(elastic, mobility * elastic, dt);
        }
        assert!((ball.energy() + given - start).abs() < 1e-12 * start);
        assert!(ball.velocity < 0.0, "thrown back with {}", ball.velocity);
    }
}

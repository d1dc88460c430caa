//! The rigid mass at an end of the staggered grid: its velocity lives at half steps, like that of the end's node.

use crate::bar::EndCondition;

/// A mass that moves by itself.
#[derive(Debug, Clone)]
pub(super) struct Striker {
    /// kg.
    pub mass: f64,
    /// Velocity half a step before and after the current time, m/s.
    pub before: f64,
    pub after: f64,
    /// Displacement since the start a step ahead of the current time, m: as far as `after` takes it.
    pub place: f64,
}

impl Striker {
    /// The striker of an end, if it has one.
    pub fn of(condition: &EndCondition) -> Option<Self> {
        let EndCondition::Striker { mass, velocity } = *condition else { return None };
        Some(Self { mass, before: velocity, after: velocity, place: 0.0 })
    }

    /// Takes it a step on, with the impulse (N s, in +x) that it gets at the middle.
    pub fn advance(&mut self, impulse: f64, dt: f64) {
        self.before = self.after;
        self.after += impulse / self.mass;
        self.place += dt * self.after;
    }
}

//! The current step of an end: its model, its relation, and its energy balance.
//!
//! Waves that arrive within a step are answered by the same relation a u + b p = c, so that the means of u and p over the step also satisfy it. The
//! models of [`crate::bar::ends`] require that.

use serde::{Deserialize, Serialize};

use crate::bar::ends::{self, EndModel, Push, Relation, Step};

/// Work and impulse through an end.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct EndSums {
    /// Work done on the bar, J: the energy lost by a body, otherwise the work of the force at the face.
    pub work: f64,
    /// Work of the force at the face, J. A body loses more than this, by what its steps do not resolve.
    pub on_face: f64,
    /// Part of that work that is absorbed by strain gathering at the face, J.
    pub gathered: f64,
    /// Impulse given to the bar, N s, into the bar.
    pub impulse: f64,
    /// Sum of the magnitudes of the impulses of all steps, N s.
    pub throughput: f64,
}

/// Force and velocities of an end between two events.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Held {
    /// Force, N, compression positive.
    pub force: f64,
    /// Velocity of the face, m/s, into the bar.
    pub velocity: f64,
    /// Velocity of the bar's end, m/s, into the bar. It differs from that of the face only if the curve is level and strain gathers at the face.
    pub edge: f64,
}

/// An end within a step. Velocities and forces have the signs of [`crate::bar::ends`].
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Stepping {
    #[serde(skip, default = "ends::stateless")]
    pub model: Box<dyn EndModel>,
    pub relation: Relation,
    /// Start and end of the step, s.
    pub start: f64,
    pub until: f64,
    /// Displacement of the face at the start of the step, m.
    pub displacement: f64,
    /// Sums over the step so far: displacement (m), impulse (N s), work at the face, and its part that strain gathering there absorbs (J).
    moved: f64,
    impulse: f64,
    on_face: f64,
    gathered: f64,
    /// Time since which the values in `held` apply, s, and these values.
    since: f64,
    pub held: Held,
    /// Whether the relation is met: no body or wall is separated from the face.
    pub met: bool,
    /// Sums up to the start of the step.
    sums: EndSums,
    /// Middle (s) and mean force (N) of the previous step.
    pub latest: (f64, f64),
}

impl Stepping {
    /// Creates the state of an end that moves at `velocity` (m/s).
    pub fn new(model: Box<dyn EndModel>, velocity: f64) -> Self {
        Self {
            model,
            relation: Relation::force(0.0),
            start: 0.0,
            until: 0.0,
            displacement: 0.0,
            moved: 0.0,
            impulse: 0.0,
            on_face: 0.0,
            gathered: 0.0,
            since: 0.0,
            held: Held { force: 0.0, velocity, edge: velocity },
            met: false,
            sums: EndSums::default(),
            latest: (0.0, 0.0),
        }
    }

    /// Advances the sums to t (s).
    pub fn bring_to(&mut self, t: f64) {
        let (dt, Held { force, velocity, edge }) = (t - self.since, self.held);
        self.moved += velocity * dt;
        self.impulse += force * dt;
        self.on_face += force * velocity * dt;
        self.gathered += force * (velocity - edge) * dt;
        self.since = t;
    }

    /// Ends the step at the time reached and advances the model. A planned end within `tolerance` (s) of that time counts as reached exactly.
    pub fn commit(&mut self, tolerance: f64) {
        let elapsed = self.since - self.start;
        if elapsed > 0.0 {
            let planned = (self.until - self.since).abs() <= tolerance;
            let dt = if planned { self.until - self.start } else { elapsed };
            let step = Step { time: self.start, dt, displacement: self.displacement };
            let push = Push { force: self.impulse / elapsed, velocity: self.moved / elapsed, impulse: self.impulse };
            let before = self.model.energy(self.displacement);
            self.model.advance(&step, &push, self.met);
            let given = before - self.model.energy(self.displacement + self.moved);
            self.sums.work += if self.model.is_conservative() { given } else { self.on_face };
            self.latest = (self.start + 0.5 * elapsed, push.force);
        }
        self.sums.on_face += self.on_face;
        self.sums.gathered += self.gathered;
        self.sums.impulse += self.impulse;
        self.sums.throughput += self.impulse.abs();
        self.displacement += self.moved;
        (self.moved, self.impulse, self.on_face, self.gathered) = (0.0, 0.0, 0.0, 0.0);
        self.start = self.since;
    }

    /// Returns the state as if the step ended at t (s).
    pub fn at(&self, t: f64) -> Self {
        let mut ahead = self.clone();
        ahead.bring_to(t);
        ahead.commit(0.0);
        ahead
    }

    /// Returns the sums up to the start of the step.
    pub fn sums(&self) -> EndSums {
        self.sums
    }

    /// Returns the current step with the length `dt` (s).
    pub fn step(&self, dt: f64) -> Step {
        Step { time: self.start, dt, displacement: self.displacement }
    }

    /// Time up to which the sums have been advanced, s.
    pub fn since(&self) -> f64 {
        self.since
    }

    /// Displacement of the face at that time, m.
    pub fn present_displacement(&self) -> f64 {
        self.displacement + self.moved
    }
}

//! An end of the net: half a node between the bar and its end condition.
//!
//! With the arriving characteristic W and the velocity u into the bar, the end obeys `sigma + Z u = W - d` and sends back `sigma - Z u - d`, where d
//! is a quarter of the plastic flow of the end node in the step: half of it occurs before, half after the time at which sigma and u hold. This is the
//! bar's side of [`crate::bar::ends`], with `q = -A (W - d)` and `Y = A Z`.

use serde::{Deserialize, Serialize};

use super::part::{INSIDE, Load, NetSegment};
use crate::bar::EndCondition;
use crate::bar::ends::{self, EndModel, Face, Push, Relation, Response, Step};
use crate::law::rate::{Flow, History};
use crate::solver::{EndSample, EndState};

/// An end with its work and impulse.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct End {
    #[serde(skip, default = "ends::stateless")]
    model: Box<dyn EndModel>,
    face: Face,
    dt: f64,
    /// Displacement, m, into the bar.
    displacement: f64,
    /// Work done on the bar, J, and work done at the face, J. A body loses more energy in a step than the face receives, because the step does not
    /// resolve the exchange.
    work: f64,
    work_on_face: f64,
    /// Impulse given to the bar, N s, positive in +x.
    impulse: f64,
    /// Sum of |impulse|, N s.
    throughput: f64,
    /// State over the latest step.
    last: EndState,
    /// Whether the end node flowed in the latest step.
    flowed: bool,
}

/// Response of an end over a step.
#[derive(Clone, Copy)]
struct Answer {
    /// Force, N, compression positive.
    force: f64,
    /// Velocity into the bar, m/s.
    velocity: f64,
    /// Force and velocity at the reading, after the stress drop of the flow that precedes it.
    read: [f64; 2],
    flow: Flow,
    history: History,
    /// Whether the relation of the end was met, i.e. no contact opened.
    met: bool,
}

impl End {
    /// Creates an end. `inward` is +1 at the left end and -1 at the right one; `velocity` is that of the bar at the start, in +x.
    pub fn new(condition: &EndCondition, inward: f64, part: &NetSegment, velocity: f64, dt: f64) -> Self {
        let impedance = part.impedance * part.area;
        let face = Face { inward, area: part.area, impedance, velocity: inward * velocity };
        Self {
            model: ends::model(condition, face),
            face,
            dt,
            displacement: 0.0,
            work: 0.0,
            work_on_face: 0.0,
            impulse: 0.0,
            throughput: 0.0,
            last: EndState { stress: 0.0, velocity },
            flowed: false,
        }
    }

    /// Advances the end over the step that begins at `time`. Receives the arriving characteristic W and returns the leaving one.
    pub fn advance(&mut self, time: f64, arriving: f64, part: &mut NetSegment) -> f64 {
        let answer = self.answer(time, arriving, part);
        let half_way = self.reading_of(answer.force, answer.velocity);
        part.record_flow(self.node(part), half_way.stress, &answer.flow, answer.history);
        let impulse = self.dt * answer.force;
        let push = Push { force: answer.force, velocity: answer.velocity, impulse };
        let held = self.model.energy(self.displacement);
        self.model.advance(&self.step(time), &push, answer.met);
        self.displacement += self.dt * answer.velocity;
        let given = held - self.model.energy(self.displacement);
        let on_face = impulse * answer.velocity;
        self.work_on_face += on_face;
        self.work += if self.model.is_conservative() { given } else { on_face };
        self.impulse += self.face.inward * impulse;
        self.throughput += impulse.abs();
        let [force, velocity] = answer.read;
        (self.last, self.flowed) = (self.reading_of(force, velocity), answer.flow.plastic != 0.0);
        // Follows from sigma + Z u = W - d and sigma - Z u - d.
        2.0 * half_way.stress - arriving
    }

    fn node(&self, part: &NetSegment) -> usize {
        if self.face.inward > 0.0 { 0 } else { part.f.len() }
    }

    /// Returns everything that changes from step to step.
    pub fn state(&self) -> (&Self, [f64; 2]) {
        (self, self.model.state())
    }

    /// Restores the state that [`Self::state`] returned.
    pub fn restore(&mut self, (saved, state): (Self, [f64; 2])) {
        self.model = std::mem::replace(self, saved).model;
        self.model.restore(state);
    }

    fn step(&self, time: f64) -> Step {
        Step { time, dt: self.dt, displacement: self.displacement }
    }

    fn reading_of(&self, force: f64, velocity: f64) -> EndState {
        EndState { stress: -force / self.face.area, velocity: self.face.inward * velocity }
    }

    /// State of the end at the whole step `time`: the mean of the half steps before and after. If its history jumps there, the half step after; at
    /// the start, the state just after t = 0, before any flow.
    pub fn reading(&self, time: f64, arriving: f64, part: &NetSegment) -> EndState {
        if time <= 0.5 * self.dt {
            let bar = Response { force: -self.face.area * arriving, impedance: self.face.impedance };
            let [force, velocity] = ends::at_once(self.model.as_ref(), &self.step(time), &bar);
            return self.reading_of(force, velocity);
        }
        let [force, velocity] = self.answer(time, arriving, part).read;
        let after = self.reading_of(force, velocity);
        if self.model.jumps(time, 0.5 * self.dt) {
            return after;
        }
        self.last.mean(after)
    }

    /// Returns the sample of the end after `step` steps; `now` is its reading.
    pub fn sample(&self, step: usize, now: EndState) -> EndSample {
        EndSample { now, latest: if step == 0 || self.flowed { EndState::UNKNOWN } else { self.last } }
    }

    fn answer(&self, time: f64, arriving: f64, part: &NetSegment) -> Answer {
        let bar = Response { force: -self.face.area * arriving, impedance: self.face.impedance };
        let (model, step) = (self.model.as_ref(), self.step(time));
        let mut relation = model.relation(&step, &bar);
        let mut answer = self.respond(&relation, &bar, part);
        if model.is_nonlinear() && answer.flow.plastic != 0.0 {
            relation = ends::agree(model, &step, &bar, |relation| {
                let answer = self.respond(relation, &bar, part);
                [answer.force, answer.velocity]
            });
            answer = self.respond(&relation, &bar, part);
        }
        if relation.unilateral && answer.force <= 0.0 {
            return Answer { met: false, ..self.respond(&Relation::force(0.0), &bar, part) };
        }
        answer
    }

    fn respond(&self, relation: &Relation, bar: &Response, part: &NetSegment) -> Answer {
        let [elastic, _] = relation.solve_with(bar);
        let share = INSIDE * relation.of_velocity / (relation.of_velocity + relation.of_force * bar.impedance);
        let load = |share| Load { stress: -elastic / self.face.area, share, time: self.dt };
        let node = self.node(part);
        let (mut flow, mut history) = part.flow_of_border(node, load(share));
        // A force that exceeds the largest stress of the curve still acts on the face, and accelerates it as if it were elastic.
        if part.runs_away(node, load(share), &flow) {
            (flow, history) = part.flow_of_border(node, load(INSIDE));
        }
        let after = |flowed: f64| relation.solve_with(&Response { force: bar.force + self.face.area * flowed, ..*bar });
        let [force, velocity] = after(0.25 * flow.plastic);
        Answer { force, velocity, read: after(0.5 * flow.before), flow, history, met: true }
    }

    /// Displacement at the whole step, m, positive in +x.
    pub fn displacement(&self) -> f64 {
        self.face.inward * self.displacement
    }

    /// Velocity of a striker or ball at the whole step, m/s, positive in +x; `None` if there is none.
    pub fn striker_velocity(&self) -> Option<f64> {
        self.model.body().map(|body| self.face.inward * body.velocity)
    }

    /// Work done on the bar so far, J.
    pub fn work(&self) -> f64 {
        self.work
    }

    /// Part of that work that did not reach the face, J.
    pub fn lost(&self) -> f64 {
        self.work - self.work_on_face
    }

    /// Impulse given to the bar so far, N s, positive in +x.
    pub fn impulse(&self) -> f64 {
        self.impulse
    }

    /// Sum of the magnitudes of all impulses so far, N s.
    pub fn throughput(&self) -> f64 {
        self.throughput
    }
}

//! Ends of a front-tracking bar: start and end of their steps, and their records. The relation comes from the end model, see [`crate::bar::ends`].

use serde::{Deserialize, Serialize};

use super::joint_clock::JointChange;
use super::ramp::Imposed;
use super::step_control::StepControl;
use super::stepping::{EndSums, Held, Stepping};
use crate::bar::EndCondition;
use crate::bar::ends::{self, Body, Face, Relation, Response, Step};
use crate::wave::riemann::{Medium, Point};

/// Stress and velocity of the bar's end from `time` on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EndStep {
    /// Time, s.
    pub time: f64,
    /// Stress, Pa, tension positive.
    pub stress: f64,
    /// Velocity, m/s, positive in +x.
    pub velocity: f64,
}

/// Record of an end so far.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct EndRecord {
    /// Exact steps, each of which holds until the next one.
    pub steps: Vec<EndStep>,
    /// Time at which the stress-strain curve could first not carry the imposed value into the bar, and state of the bar's end then.
    pub above_critical: Option<EndStep>,
}

/// Response of an end. The emitted waves are in the scratch of its side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Answer {
    /// State of the bar's end behind the emitted waves.
    pub behind: Point,
    /// Velocity of the face, m/s, into the bar.
    pub velocity: f64,
    /// Whether the curve could not carry the imposed value.
    pub short: bool,
    /// Whether the end responded; false if a weak wave passed.
    pub answers: bool,
}

/// Effect of an arriving wave, or of time, on the step of an end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Arrival {
    /// The wave is weak: the end follows it.
    Passes,
    /// The relation of the step responds to it.
    Within,
    /// The step ends.
    Ends,
}

/// State of a striker or ball at an end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrikerState {
    /// Velocity, m/s, positive in +x.
    pub velocity: f64,
    /// Distance from the bar's end, m, >= 0.
    pub gap: f64,
    /// Whether they touch.
    pub touching: bool,
}

/// Scales of a run.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Scales {
    /// Stress to which steps are relative, Pa.
    pub stress: f64,
    /// Change of stress in a step, relative to that stress.
    pub step: f64,
    /// Elastic transit time of the bar, s.
    pub transit: f64,
    /// Differences below which times (s) and stresses (Pa) count as equal.
    pub same_time: f64,
    pub same_stress: f64,
}

/// An end with the state of its steps.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct End {
    pub face: Face,
    stepping: Stepping,
    #[serde(skip)]
    imposed: Option<Imposed>,
    /// Control of the steps of a body.
    control: Option<StepControl>,
    /// Whether the end imposes a velocity or a force and does not only follow.
    pub demands: bool,
    scales: Scales,
    /// State of the bar's end since the latest response.
    answered: Point,
    /// Whether the latest wave was a jump.
    jumped: bool,
    /// Times at which a body touched the end and separated from it.
    changes: Vec<JointChange>,
    pub record: EndRecord,
}

/// Returns the face at an end. `inward` is +1 at the left end and -1 at the right one, `velocity` (m/s) that of the bar there, in +x.
pub(super) fn face(inward: f64, velocity: f64, medium: &Medium) -> Face {
    Face { inward, area: medium.area, impedance: medium.area * medium.impedance(), velocity: inward * velocity }
}

impl End {
    /// Creates an end of a bar whose state there is `start` at t = 0.
    pub fn new(condition: &EndCondition, face: Face, start: Point, scales: Scales) -> Self {
        let imposed = Imposed::new(condition, &face, scales.step * scales.stress, scales.transit);
        let model = ends::model(if imposed.is_some() { &EndCondition::Free } else { condition }, face);
        let at_rest = Response { force: 0.0, impedance: face.impedance };
        let moves = model.relaxation(0.0, &at_rest).is_some();
        let control = moves.then(|| StepControl::new(scales.step, scales.stress * face.area, scales.transit));
        Self {
            face,
            stepping: Stepping::new(model, face.velocity),
            imposed,
            control,
            demands: !matches!(condition, EndCondition::Absorbing | EndCondition::Dashpot { .. }),
            scales,
            answered: start,
            jumped: false,
            changes: Vec::new(),
            record: EndRecord::default(),
        }
    }

    /// Returns everything that changes: the end, the state of its model, and whether its history still applies.
    pub fn state(&self) -> (&Self, [f64; 2], bool) {
        (self, self.stepping.model.state(), self.imposed.is_some())
    }

    /// Restores what [`Self::state`] returned. `released`: the bar has broken off at this end.
    pub fn restore(&mut self, (saved, state, imposes): (Self, [f64; 2], bool), released: bool) {
        if released {
            self.release();
        }
        let before = std::mem::replace(self, saved);
        (self.stepping.model, self.imposed) = (before.stepping.model, before.imposed.filter(|_| imposes));
        self.stepping.model.restore(state);
    }

    /// Returns whether the history of the end has a ramp, or a body moves with it.
    pub fn needs_steps(&self) -> bool {
        self.control.is_some() || self.imposed.as_ref().is_some_and(Imposed::needs_steps)
    }

    /// Returns the response of an elastic bar in the state `bar`.
    pub fn response(&self, bar: &Point) -> Response {
        let Face { inward, area, impedance, .. } = self.face;
        Response { force: -area * bar.stress - impedance * (inward * bar.velocity), impedance }
    }

    /// Returns the stress change (Pa) below which waves do not end a step.
    pub fn passing(&self) -> f64 {
        self.control.as_ref().map_or(0.0, |control| control.passing() / self.face.area)
    }

    /// Processes an event at the end at the time `now` (s), where the bar has reached the state `bar`.
    pub fn arrive(&mut self, now: f64, bar: &Point) -> Arrival {
        self.stepping.bring_to(now);
        let Face { area, impedance, .. } = self.face;
        let [stress, velocity] = [bar.stress - self.answered.stress, bar.velocity - self.answered.velocity];
        let change = (area * stress).abs().max((impedance * velocity).abs());
        self.jumped = self.control.as_ref().is_some_and(|control| control.is_jump(change, area * bar.stress));
        if self.jumped {
            self.control.iter_mut().for_each(StepControl::restart);
        }
        let due = self.stepping.until <= now + self.scales.same_time;
        if due || self.jumped || !self.stepping.met {
            return Arrival::Ends;
        }
        let Some(control) = &self.control else { return Arrival::Within };
        if change <= control.passing() && !(self.can_part() && bar.stress >= 0.0) {
            return Arrival::Passes;
        }
        // A step planned for slow changes is too long for the wave that has arrived.
        let planned = self.stepping.until - self.stepping.start;
        let relaxation = self.stepping.model.relaxation(self.stepping.present_displacement(), &self.response(bar));
        if relaxation.is_some_and(|relaxation| control.resolving(&relaxation) < 0.5 * planned) {
            return Arrival::Ends;
        }
        Arrival::Within
    }

    /// Returns whether the end has a body or wall that cannot pull.
    pub fn can_part(&self) -> bool {
        self.stepping.model.gap(0.0).is_some()
    }

    /// Returns the relation of the current step.
    pub fn relation(&self) -> Relation {
        self.stepping.relation
    }

    /// Returns the step of a body in contact, for a relation that has to be found together with the response of the bar; `None` without contact.
    pub fn body_step(&self) -> Option<Step> {
        let Stepping { start, until, met, .. } = &self.stepping;
        (*met && self.control.is_some()).then(|| self.stepping.step(until - start))
    }

    /// Sets the relation of the body in that step for a bar with this response.
    pub fn agree_with(&mut self, step: &Step, response: &Response) {
        self.stepping.relation = self.stepping.model.relation(step, response);
    }

    /// Ends the step. Returns the length of the next step (s) if a body moves with the end, or would if it did not separate now. A face without load
    /// moves at `free` (m/s, into the bar).
    pub fn end_step(&mut self, bar: &Point, free: f64) -> Option<f64> {
        self.stepping.commit(self.scales.same_time);
        let now = self.stepping.start;
        if self.imposed.as_ref().is_some_and(|imposed| imposed.is_over(now + self.scales.same_time)) {
            self.imposed = None;
        }
        let response = self.response(bar);
        let pushes = self.pushes(free);
        let pushed = std::mem::replace(&mut self.stepping.met, pushes);
        let control = self.control.as_mut()?;
        if !pushes && !pushed {
            return None;
        }
        if !pushed {
            control.restart();
        }
        let relaxation = self.stepping.model.relaxation(self.stepping.displacement, &response)?;
        let length = control.next(&relaxation);
        Some(if self.stepping.model.is_nonlinear() { self.resolving_contact(length, &response) } else { length })
    }

    /// Returns whether the end acts on the face from now on: always, unless it can separate from a face that moves at `free` (m/s, into the bar).
    fn pushes(&self, free: f64) -> bool {
        let Some(gap) = self.stepping.model.gap(self.stepping.displacement) else { return true };
        let closing = self.closing(free);
        gap < 0.0 || (gap <= closing * self.scales.same_time && self.is_closing(closing))
    }

    /// Velocity at which the body or wall approaches a face that moves at `velocity` (m/s, into the bar), m/s.
    fn closing(&self, velocity: f64) -> f64 {
        self.stepping.model.body().map_or(0.0, |body| body.velocity) - velocity
    }

    /// Returns whether this velocity (m/s) is positive beyond rounding.
    fn is_closing(&self, closing: f64) -> bool {
        closing * self.face.impedance > self.scales.same_stress * self.face.area
    }

    /// Records that a body touches the end or separates from it now; `next` is the step (s) that it would take.
    fn note_change(&mut self, next: f64, bar: &Response, free: f64) {
        let Some(body) = self.stepping.model.body() else { return };
        let touches = self.stepping.met;
        if self.changes.last().is_none_or(|last| last.open) == touches {
            let time = if touches { self.stepping.start } else { self.parting(body.gap, next, bar, free) };
            self.changes.push(JointChange { time, open: !touches });
        }
    }

    /// Returns the time at which the force of a body that is found separated became zero.
    ///
    /// A decaying force does so in steps, as the arriving waves are steps: a mass is released at the first wave behind which it would have to pull.
    /// The time at which the force itself was zero is interpolated between the middles of the last step that pushed and the first one that would
    /// pull. This is second-order accurate, like the rest of the method.
    fn parting(&self, gap: f64, next: f64, bar: &Response, free: f64) -> f64 {
        let (now, closing) = (self.stepping.start, self.closing(free));
        if self.jumped {
            return now;
        }
        if gap > 0.0 {
            return if closing < 0.0 { now + gap / closing } else { now };
        }
        let [pull, _] = self.stepping.model.relation(&self.stepping.step(next), bar).solve_with(bar);
        let (before, push) = self.stepping.latest;
        if push <= 0.0 || pull >= 0.0 {
            return now;
        }
        before + (now + 0.5 * next - before) * (push / (push - pull))
    }

    /// Returns a step of at most `most` (s) in which the force of a nonlinear contact changes by no more than one step height.
    fn resolving_contact(&self, most: f64, bar: &Response) -> f64 {
        let (Some(control), mut length) = (&self.control, most) else { return most };
        for _ in 0..3 {
            let [force, _] = self.stepping.model.relation(&self.stepping.step(length), bar).solve_with(bar);
            let change = (force - self.stepping.held.force).abs();
            if change <= control.largest_change() {
                break;
            }
            length = (length * control.largest_change() / change).max(control.shortest()).min(most);
        }
        length
    }

    /// Begins a step, of `length` (s) if a body moves with the end. A face without load moves at `free` (m/s, into the bar).
    pub fn begin_step(&mut self, length: Option<f64>, bar: &Point, free: f64) {
        let (now, response) = (self.stepping.start, self.response(bar));
        self.note_change(length.unwrap_or(f64::INFINITY), &response, free);
        (self.stepping.relation, self.stepping.until) = match (&self.imposed, self.stepping.met) {
            (Some(imposed), _) => {
                let at = now + self.scales.same_time;
                (imposed.relation(at), imposed.next_after(at))
            }
            (None, true) => {
                let dt = length.unwrap_or(f64::INFINITY);
                (self.stepping.model.relation(&self.stepping.step(dt), &response), now + dt)
            }
            (None, false) => (Relation::force(0.0), f64::INFINITY),
        };
    }

    /// Separates the face from the body or wall.
    pub fn part(&mut self) {
        (self.stepping.met, self.stepping.relation) = (false, Relation::force(0.0));
    }

    /// Releases the end: the bar has broken off there and the end is free from now on.
    pub fn release(&mut self) {
        self.stepping.commit(self.scales.same_time);
        self.stepping.model = ends::model(&EndCondition::Free, self.face);
        (self.stepping.relation, self.stepping.until) = (Relation::force(0.0), f64::INFINITY);
        (self.imposed, self.control) = (None, None);
    }

    /// Applies the response: state of the bar's end, and velocity of the face into the bar, from now on.
    pub fn update(&mut self, &Answer { ref behind, velocity, short, answers }: &Answer) {
        let Face { inward, area, impedance, .. } = self.face;
        // Apart from rounding the bar's end moves with the face, unless strain gathers there.
        let edge = if short { inward * behind.velocity } else { velocity };
        self.stepping.held = Held { force: -area * behind.stress, velocity, edge };
        if answers {
            self.answered = *behind;
        }
        if !self.stepping.met {
            self.stepping.until = self.closing_time(velocity);
        }
        let (round_off, scale) = (self.scales.same_stress, impedance / area);
        let same = |last: &EndStep| {
            (last.stress - behind.stress).abs() <= round_off
                && (last.velocity - behind.velocity).abs() <= round_off / scale
        };
        if !self.record.steps.last().is_some_and(same) {
            let (time, stress, velocity) = (self.stepping.since(), behind.stress, behind.velocity);
            self.record.steps.push(EndStep { time, stress, velocity });
        }
    }

    /// Returns the time (s) at which a separated body or wall touches the face, if the face moves at `velocity` (m/s, into the bar).
    fn closing_time(&self, velocity: f64) -> f64 {
        let model = &self.stepping.model;
        let Some(gap) = model.gap(self.stepping.displacement) else { return f64::INFINITY };
        let closing = self.closing(velocity);
        if !self.is_closing(closing) {
            return f64::INFINITY;
        }
        self.stepping.start + gap.max(0.0) / closing
    }

    /// Returns the time of the next event of the end that no wave causes, s.
    pub fn next_time(&self) -> f64 {
        self.stepping.until
    }

    /// Returns work and impulse through the end up to t (s).
    pub fn sums(&self, t: f64) -> EndSums {
        self.stepping.at(t).sums()
    }

    /// Returns the state of the striker or ball at time t (s); `None` without one.
    pub fn striker(&self, t: f64) -> Option<StrikerState> {
        let touching = self.stepping.met;
        self.stepping.at(t).model.body().map(|Body { velocity, gap }| StrikerState {
            velocity: self.face.inward * velocity,
            gap: gap.max(0.0),
            touching,
        })
    }

    /// Returns the times at which a striker or ball touched the end and separated from it.
    pub fn striker_changes(&self) -> &[JointChange] {
        &self.changes
    }

    /// Energy of the body at the end at time t (s), J: kinetic for a striker, stored for a spring, both for a ball.
    pub fn body_energy(&self, t: f64) -> f64 {
        let ahead = self.stepping.at(t);
        ahead.model.energy(ahead.displacement)
    }
}

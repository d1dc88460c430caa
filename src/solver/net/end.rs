//! An end of the net: half a node between the bar and what holds or drives it.
//!
//! With W the characteristic that arrives and u the velocity into the bar, the end obeys `sigma + Z u = W - d`, and sends
//! back `sigma - Z u - d`, where d is a quarter of what the end node flows in the step: half of it before, half after the
//! moment at which sigma and u hold. Histories enter by their means over the step.

use super::ball::Ball;
use super::part::{INSIDE, Part, Work};
use crate::bar::EndCondition;
use crate::law::rate::{Flow, History};

/// An end and its account.
#[derive(Debug, Clone)]
pub(super) struct End {
    condition: EndCondition,
    /// +1 at the left end, -1 at the right: the way into the bar.
    inward: f64,
    dt: f64,
    area: f64,
    impedance: f64,
    /// Velocity into the bar at which nothing is radiated, m/s.
    rest: f64,
    /// m, positive in +x.
    displacement: f64,
    /// J.
    work: f64,
    /// N s, positive in +x.
    impulse: f64,
    /// Sum of |impulse|, N s.
    throughput: f64,
    /// Stress of the latest step in which the end was held, Pa.
    held_stress: f64,
    /// What a striker is doing.
    body: Option<Body>,
    /// And what a ball is.
    ball: Option<Ball>,
    last: EndReading,
}

/// Stress and velocity of an end, and what it took and gave so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EndReading {
    /// Pa.
    pub stress: f64,
    /// m/s, positive in +x.
    pub velocity: f64,
}

/// What drives an end over a step.
#[derive(Clone, Copy)]
enum Drive {
    /// Pa.
    Stress(f64),
    /// A velocity into the bar that follows the stress: u = velocity + mobility sigma (m/s, m/(s Pa), mobility >= 0).
    Motion { velocity: f64, mobility: f64 },
}

impl Drive {
    fn velocity(velocity: f64) -> Self {
        Self::Motion { velocity, mobility: 0.0 }
    }
}

/// A rigid body that strikes the end.
#[derive(Debug, Clone, Copy)]
struct Body {
    /// dt A/M, m/s per Pa.
    gain: f64,
    /// Velocity into the bar at the whole step, m/s.
    velocity: f64,
    /// Distance from the end, m, >= 0.
    gap: f64,
}

/// The answer of an end over a step.
#[derive(Clone, Copy)]
struct Answer {
    stress: f64,
    /// Into the bar.
    velocity: f64,
    flow: Flow,
    history: History,
    /// Something else than a given stress drives the end.
    held: bool,
}

impl End {
    /// `inward` is +1 at the left end and -1 at the right one; `velocity` is that of the bar at the start, in +x.
    pub fn new(condition: EndCondition, inward: f64, part: &Part, velocity: f64, dt: f64) -> Self {
        let body = if let EndCondition::Striker { mass, velocity } = condition {
            Some(Body { gain: dt * part.area / mass, velocity: inward * velocity, gap: 0.0 })
        } else {
            None
        };
        let ball = Ball::of(&condition, inward);
        Self {
            condition,
            inward,
            dt,
            area: part.area,
            impedance: part.impedance,
            rest: inward * velocity,
            displacement: 0.0,
            work: 0.0,
            impulse: 0.0,
            throughput: 0.0,
            held_stress: 0.0,
            body,
            ball,
            last: EndReading { stress: 0.0, velocity },
        }
    }

    /// The step that begins at `time`: takes what arrives, W, and returns what leaves.
    pub fn advance(&mut self, time: f64, arriving: f64, part: &mut Part) -> f64 {
        let answer = self.answer(time, arriving, part);
        if answer.held {
            self.held_stress = answer.stress;
        }
        if answer.flow.plastic != 0.0 || part.borders.flowed(self.node(part)) {
            let total = 0.5 * answer.stress * answer.flow.plastic;
            part.work.add(Work { total, overstress: 0.5 * answer.flow.overstress });
            let node = self.node(part);
            part.borders.set(&part.law, node, answer.flow, answer.history);
        }
        if let Some(body) = &mut self.body {
            let moved = self.dt * (answer.velocity - (body.velocity + 0.5 * body.gain * answer.stress));
            body.gap = if answer.held { 0.0 } else { (body.gap + moved).max(0.0) };
            body.velocity += body.gain * answer.stress;
        }
        if let Some(ball) = &mut self.ball {
            ball.advance(-answer.stress * self.area, answer.velocity, self.dt);
        }
        let velocity = self.inward * answer.velocity;
        let impulse = -self.inward * self.area * self.dt * answer.stress;
        self.displacement += self.dt * velocity;
        self.work += impulse * velocity;
        self.impulse += impulse;
        self.throughput += impulse.abs();
        self.last = EndReading { stress: answer.stress, velocity };
        // From sigma + Z u = W - d and sigma - Z u - d.
        2.0 * answer.stress - arriving
    }

    fn node(&self, part: &Part) -> usize {
        if self.inward > 0.0 { 0 } else { part.f.len() }
    }

    /// The end at the whole step `time`: the mean of the half steps before and after, and at the start and where its
    /// history jumps the half step after.
    pub fn reading(&self, time: f64, arriving: f64, part: &Part) -> EndReading {
        let answer = self.answer(time, arriving, part);
        let after = EndReading { stress: answer.stress, velocity: self.inward * answer.velocity };
        if self.changes_suddenly(time) {
            return after;
        }
        EndReading {
            stress: 0.5 * (self.last.stress + after.stress),
            velocity: 0.5 * (self.last.velocity + after.velocity),
        }
    }

    /// True at the start, and within half a step of a jump in the history.
    fn changes_suddenly(&self, time: f64) -> bool {
        let near = |t: f64| (t - time).abs() <= 0.5 * self.dt;
        let history = match &self.condition {
            EndCondition::Velocity { history, release } => {
                if release.is_some_and(near) {
                    return true;
                }
                history
            }
            EndCondition::Stress { history } => history,
            _ => return near(0.0),
        };
        near(0.0) || history.time().windows(2).any(|pair| pair[0] == pair[1] && near(pair[0]))
    }

    fn answer(&self, time: f64, arriving: f64, part: &Part) -> Answer {
        let until = time + self.dt;
        match &self.condition {
            EndCondition::Velocity { history, release } => {
                // Share of the step in which the end is still held.
                let held = release.map_or(1.0, |r| ((r - time) / self.dt).clamp(0.0, 1.0));
                let velocity = self.inward * history.mean(time, until);
                match held {
                    1.0 => self.respond(Drive::velocity(velocity), arriving, part),
                    0.0 => self.respond(Drive::Stress(0.0), arriving, part),
                    _ => self.respond(Drive::Stress(held * self.held_stress), arriving, part),
                }
            }
            EndCondition::Stress { history } => self.respond(Drive::Stress(history.mean(time, until)), arriving, part),
            EndCondition::Free => self.respond(Drive::Stress(0.0), arriving, part),
            EndCondition::Fixed => self.respond(Drive::velocity(0.0), arriving, part),
            EndCondition::Absorbing => {
                // The same bar without end, elastic.
                let drive = Drive::Motion { velocity: self.rest, mobility: 1.0 / self.impedance };
                self.respond(drive, arriving, part)
            }
            EndCondition::Wall { gap } => {
                // The wall lets the end go no farther outwards than it stands.
                let limit = (-self.inward * self.displacement - gap) / self.dt;
                self.unless_free(Drive::velocity(limit), arriving, part)
            }
            EndCondition::Striker { .. } => {
                // The body's mean velocity over the step, and what closes the gap; it is slowed down by half the impulse.
                let (velocity, mobility) =
                    self.body.map_or((0.0, 0.0), |b| (b.velocity - b.gap / self.dt, 0.5 * b.gain));
                self.unless_free(Drive::Motion { velocity, mobility }, arriving, part)
            }
            EndCondition::Ball { .. } => self.against_ball(arriving, part),
            EndCondition::Spring { stiffness } => {
                // sigma A = k (displacement into the bar at mid-step).
                let per_half_step = 0.5 * self.dt * stiffness / self.area;
                let velocity = -self.inward * self.displacement / (0.5 * self.dt);
                self.respond(Drive::Motion { velocity, mobility: 1.0 / per_half_step }, arriving, part)
            }
        }
    }

    /// The ball's force as if the end answered elastically is the most it can be: one that flows gives way more.
    fn against_ball(&self, arriving: f64, part: &Part) -> Answer {
        let under = |force: f64| self.respond(Drive::Stress(-force / self.area), arriving, part);
        let Some(ball) = &self.ball else { return under(0.0) };
        let mobility = 1.0 / (self.area * self.impedance);
        let elastic = ball.force(arriving / self.impedance, mobility, self.dt);
        let answer = under(elastic);
        if answer.flow.plastic == 0.0 {
            return answer;
        }
        under(ball.force_on(elastic, |force| under(force).velocity, self.dt))
    }

    /// What can push but not pull: the end is free where it moves away by itself.
    fn unless_free(&self, drive: Drive, arriving: f64, part: &Part) -> Answer {
        let free = self.respond(Drive::Stress(0.0), arriving, part);
        let Drive::Motion { velocity, .. } = drive else { return free };
        if free.velocity < velocity { self.respond(drive, arriving, part) } else { free }
    }

    fn respond(&self, drive: Drive, arriving: f64, part: &Part) -> Answer {
        let z = self.impedance;
        let (elastic, share) = match drive {
            Drive::Stress(stress) => (stress, 0.0),
            Drive::Motion { velocity, mobility } => {
                let yielding = 1.0 + z * mobility;
                ((arriving - z * velocity) / yielding, INSIDE / yielding)
            }
        };
        let (flow, history) = part.borders.flow(&part.law, self.node(part), elastic, share, self.dt);
        let stress = elastic - 0.5 * share * flow.plastic;
        let (velocity, held) = match drive {
            Drive::Motion { velocity, mobility } => (velocity + mobility * stress, true),
            Drive::Stress(_) => ((arriving - 0.25 * flow.plastic - stress) / z, false),
        };
        Answer { stress, velocity, flow, history, held }
    }

    /// Displacement at the whole step, m.
    pub fn displacement(&self) -> f64 {
        self.displacement
    }

    /// Velocity of a striker or a ball at the whole step, m/s, positive in +x; none where there is none.
    pub fn striker_velocity(&self) -> Option<f64> {
        let body = self.body.map(|body| body.velocity);
        body.or(self.ball.map(|ball| ball.velocity)).map(|velocity| self.inward * velocity)
    }

    /// Work done on the bar so far, J.
    pub fn work(&self) -> f64 {
        self.work
    }

    /// Impulse given to the bar so far, N s, positive in +x.
    pub fn impulse(&self) -> f64 {
        self.impulse
    }

    /// Sum of the sizes of all impulses so far, N s.
    pub fn throughput(&self) -> f64 {
        self.throughput
    }
}

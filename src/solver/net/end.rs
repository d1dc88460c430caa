//! An end of the net: half a node between the bar and what holds or drives it.
//!
//! With W the characteristic that arrives and u the velocity into the bar, the end obeys `sigma + Z u = W - d`, and sends
//! back `sigma - Z u - d`, where d is a quarter of what the end node flows in the step: half of it before, half after the
//! moment at which sigma and u hold. Histories enter by their means over the step.

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
    /// Velocity into the bar, m/s.
    Velocity(f64),
    /// Pa.
    Stress(f64),
    /// The same bar without end, elastic and at rest.
    Elastic,
}

/// The answer of an end over a step.
#[derive(Clone, Copy)]
struct Answer {
    stress: f64,
    /// Into the bar.
    velocity: f64,
    leaving: f64,
    flow: Flow,
    history: History,
    /// The velocity was prescribed.
    held: bool,
}

impl End {
    /// `inward` is +1 at the left end and -1 at the right one; `velocity` is that of the bar at the start, in +x.
    pub fn new(condition: EndCondition, inward: f64, part: &Part, velocity: f64, dt: f64) -> Self {
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
            last: EndReading { stress: 0.0, velocity },
        }
    }

    /// The step that begins at `time`: takes what arrives, W, and returns what leaves.
    pub fn advance(&mut self, time: f64, arriving: f64, part: &mut Part) -> f64 {
        let answer = self.answer(time, arriving, part);
        if answer.held {
            self.held_stress = answer.stress;
        }
        if answer.flow.plastic != 0.0 {
            let total = 0.5 * answer.stress * answer.flow.plastic;
            part.work.add(Work { total, overstress: 0.5 * answer.flow.overstress });
            let node = self.node(part);
            part.borders.set(&part.law, node, answer.history);
        }
        let velocity = self.inward * answer.velocity;
        let impulse = -self.inward * self.area * self.dt * answer.stress;
        self.displacement += self.dt * velocity;
        self.work += impulse * velocity;
        self.impulse += impulse;
        self.throughput += impulse.abs();
        self.last = EndReading { stress: answer.stress, velocity };
        answer.leaving
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
                    1.0 => self.respond(Drive::Velocity(velocity), arriving, part),
                    0.0 => self.respond(Drive::Stress(0.0), arriving, part),
                    _ => self.respond(Drive::Stress(held * self.held_stress), arriving, part),
                }
            }
            EndCondition::Stress { history } => self.respond(Drive::Stress(history.mean(time, until)), arriving, part),
            EndCondition::Free => self.respond(Drive::Stress(0.0), arriving, part),
            EndCondition::Fixed => self.respond(Drive::Velocity(0.0), arriving, part),
            EndCondition::Absorbing => self.respond(Drive::Elastic, arriving, part),
            EndCondition::Wall { gap } => {
                let free = self.respond(Drive::Stress(0.0), arriving, part);
                // The wall lets the end go no farther outwards than it stands.
                let limit = (-self.inward * self.displacement - gap) / self.dt;
                let stopped = free.velocity < limit;
                if stopped { self.respond(Drive::Velocity(limit), arriving, part) } else { free }
            }
        }
    }

    fn respond(&self, drive: Drive, arriving: f64, part: &Part) -> Answer {
        let z = self.impedance;
        let (elastic, share) = match drive {
            Drive::Velocity(u) => (arriving - z * u, INSIDE),
            Drive::Stress(stress) => (stress, 0.0),
            // The elastic bar outside takes half of what the node relaxes.
            Drive::Elastic => (0.5 * (arriving - z * self.rest), 0.5 * INSIDE),
        };
        let (flow, history) = part.borders.flow(&part.law, self.node(part), elastic, share, self.dt);
        let kept = 0.25 * flow.plastic;
        let stress = elastic - 0.5 * share * flow.plastic;
        let velocity = if let Drive::Velocity(u) = drive { u } else { (arriving - kept - stress) / z };
        let held = matches!(drive, Drive::Velocity(_));
        Answer { stress, velocity, leaving: stress - z * velocity - kept, flow, history, held }
    }

    /// Displacement at the whole step, m.
    pub fn displacement(&self) -> f64 {
        self.displacement
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

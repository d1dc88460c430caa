//! The ends: Riemann problems against what drives them, with the driver's mean over the step.
//!
//! With outward normal n (-1 left, +1 right) a wave that leaves the end obeys `d v = n d sigma/(rho c)`. A driver answers the
//! force F = A sigma with the velocity `V - n C (F - F0)`. Prescribed velocities and stresses enter by their exact means
//! over the step. A mass or a spring gives way by what its mean over the step does (C = dt/(2M), C = 2/(k dt)): its energy
//! and momentum are exact. Walls and masses take up just what would carry the end into them, and never pull.

use super::block::Block;
use super::stepping::Part;
use crate::bar::{EndCondition, History};
use crate::wave::riemann::{Flux, Near, Side, Workspace, solve};

/// Stress and velocity of an end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndReading {
    /// Mean over the latest step, Pa.
    pub stress: f64,
    /// Mean over the latest step, m/s.
    pub velocity: f64,
}

/// A mass that moves by itself.
#[derive(Debug, Clone)]
struct Striker {
    mass: f64,
    velocity: f64,
    place: f64,
}

/// An end of the bar.
#[derive(Debug, Clone)]
pub(super) struct End {
    condition: EndCondition,
    striker: Option<Striker>,
    /// Outward normal.
    normal: f64,
    area: f64,
    impedance: f64,
    /// Velocity at the start, for the absorbing end.
    rest: f64,
    /// A wall or a mass pushed in the latest step.
    pushed: bool,
    latest: Flux,
    pub displacement: f64,
    pub work: f64,
    pub impulse: f64,
    pub throughput: f64,
}

/// What an end asks of the bar over a step.
enum Drive {
    /// m/s.
    Velocity(f64),
    /// Pa.
    Stress(f64),
    /// Velocity at the force F0 (N), and what it gives way by (m/(s N)).
    Yielding { velocity: f64, force: f64, compliance: f64 },
}

/// What an end is known to do at a moment: one of its quantities and the rate of that.
enum Known {
    Velocity(f64, f64),
    Stress(f64, f64),
    Nothing,
}

impl End {
    pub fn new(condition: EndCondition, normal: f64, part: &Part, velocity: f64) -> Self {
        let striker = match condition {
            EndCondition::Striker { mass, velocity } => Some(Striker { mass, velocity, place: 0.0 }),
            _ => None,
        };
        Self {
            condition,
            striker,
            normal,
            area: part.area,
            impedance: (part.modulus * part.density).sqrt(),
            rest: velocity,
            pushed: false,
            latest: Flux { stress: 0.0, velocity },
            displacement: 0.0,
            work: 0.0,
            impulse: 0.0,
            throughput: 0.0,
        }
    }

    /// How the bar seems to go on beyond its end at `time`: stress, velocity and E times strain of a cell there. Such that
    /// the slopes of the last cell fit what the end does: mirrored, where that does not change.
    pub fn beyond(&self, time: f64, dt: f64, block: &Block, part: &Part) -> [f64; 3] {
        let side = usize::from(self.normal > 0.0);
        let (i, j) = (block.inside(side, 0), block.inside(side, 1));
        let (stress, velocity, reach) = (block.sigma[i], block.v[i], block.reach(part, i));
        // Strain per elastic strain of the same stress change, from the bar's own slope.
        let ratio = (block.reach(part, j) - reach) / (block.sigma[j] - stress);
        let ratio = if ratio.is_finite() && ratio > 1.0 { ratio } else { 1.0 };
        let outward = self.normal * part.dx;
        let (beyond, moving) = match self.known(time, dt) {
            Known::Velocity(v, rate) => (stress + outward * part.density * rate, 2.0 * v - velocity),
            Known::Stress(s, rate) => (2.0 * s - stress, velocity + outward * rate * ratio / part.modulus),
            Known::Nothing => (stress, velocity),
        };
        [beyond, moving, reach + ratio * (beyond - stress)]
    }

    fn known(&self, time: f64, dt: f64) -> Known {
        match &self.condition {
            EndCondition::Velocity { release: Some(release), .. } if *release <= time + 0.5 * dt => {
                Known::Stress(0.0, 0.0)
            }
            EndCondition::Velocity { history, .. } => Known::Velocity(history.at(time), rate(history, time)),
            EndCondition::Stress { history } => Known::Stress(history.at(time), rate(history, time)),
            EndCondition::Fixed => Known::Velocity(0.0, 0.0),
            EndCondition::Wall { .. } if self.pushed => Known::Velocity(0.0, 0.0),
            EndCondition::Striker { .. } if self.pushed => {
                let mass = self.striker.as_ref().map_or(f64::INFINITY, |s| s.mass);
                let velocity = self.striker.as_ref().map_or(0.0, |s| s.velocity);
                Known::Velocity(velocity, -self.normal * self.area * self.latest.stress / mass)
            }
            EndCondition::Spring { stiffness } => {
                let per = -self.normal * stiffness / self.area;
                Known::Stress(per * self.displacement, per * self.latest.velocity)
            }
            EndCondition::Free
            | EndCondition::Wall { .. }
            | EndCondition::Striker { .. }
            | EndCondition::Ball { .. } => Known::Stress(0.0, 0.0),
            EndCondition::Absorbing => Known::Nothing,
        }
    }

    /// What goes through the end in the step from `time` on, with the account of it.
    pub fn settle(&mut self, time: f64, dt: f64, part: &Part, near: &Near, work: &mut Workspace) -> Flux {
        let flux = self.respond(time, dt, part, near, work);
        if let Some(striker) = &mut self.striker {
            let change = -self.normal * self.area * flux.stress * dt / striker.mass;
            striker.place += dt * (striker.velocity + 0.5 * change);
            striker.velocity += change;
        }
        let impulse = self.normal * self.area * flux.stress * dt;
        self.impulse += impulse;
        self.throughput += impulse.abs();
        self.work += impulse * flux.velocity;
        self.displacement += dt * flux.velocity;
        self.latest = flux;
        flux
    }

    fn respond(&mut self, time: f64, dt: f64, part: &Part, near: &Near, work: &mut Workspace) -> Flux {
        let mut ask = |drive: Drive| self.answer(&drive, part, near, work);
        match &self.condition {
            EndCondition::Velocity { history, release } => {
                let held = release.map_or(1.0, |r| ((r - time) / dt).clamp(0.0, 1.0));
                if held <= 0.0 {
                    return ask(Drive::Stress(0.0));
                }
                let moved = ask(Drive::Velocity(history.mean(time, time + held * dt)));
                if held >= 1.0 {
                    return moved;
                }
                // Let go within the step: both in their shares.
                let free = ask(Drive::Stress(0.0));
                let mean = |a: f64, b: f64| held * a + (1.0 - held) * b;
                Flux { stress: mean(moved.stress, free.stress), velocity: mean(moved.velocity, free.velocity) }
            }
            EndCondition::Stress { history } => ask(Drive::Stress(history.mean(time, time + dt))),
            EndCondition::Free | EndCondition::Ball { .. } => ask(Drive::Stress(0.0)),
            EndCondition::Fixed => ask(Drive::Velocity(0.0)),
            EndCondition::Absorbing => {
                ask(Drive::Yielding { velocity: self.rest, force: 0.0, compliance: 1.0 / (self.area * self.impedance) })
            }
            EndCondition::Spring { stiffness } => ask(Drive::Yielding {
                velocity: 0.0,
                force: -self.normal * stiffness * self.displacement,
                compliance: 2.0 / (stiffness * dt),
            }),
            EndCondition::Wall { gap } => {
                let limit = self.normal * (gap - self.normal * self.displacement) / dt;
                let body = Drive::Velocity(limit);
                let (free, held) = (ask(Drive::Stress(0.0)), ask(body));
                self.unilateral(free, held, limit)
            }
            EndCondition::Striker { .. } => {
                let Some(Striker { mass, velocity, place }) = self.striker.clone() else {
                    return ask(Drive::Stress(0.0));
                };
                let velocity = velocity + (place - self.displacement) / dt;
                let body = Drive::Yielding { velocity, force: 0.0, compliance: 0.5 * dt / mass };
                let (free, held) = (ask(Drive::Stress(0.0)), ask(body));
                self.unilateral(free, held, velocity)
            }
        }
    }

    /// Of an end that is free, or held by a body which `limit` is the velocity of at no force: held where the free one would
    /// run into it and the body would not have to pull.
    fn unilateral(&mut self, free: Flux, held: Flux, limit: f64) -> Flux {
        self.pushed = self.normal * (free.velocity - limit) > 0.0 && held.stress < 0.0;
        if self.pushed { held } else { free }
    }

    fn answer(&self, drive: &Drive, part: &Part, near: &Near, work: &mut Workspace) -> Flux {
        match *drive {
            Drive::Velocity(velocity) => self.against(velocity, 0.0, 0.0, part, near, work),
            Drive::Yielding { velocity, force, compliance } => {
                self.against(velocity, force, compliance, part, near, work)
            }
            Drive::Stress(stress) => self.under(stress, part, near, work),
        }
    }

    /// Against a driver that moves with `velocity` at the force `force` and gives way by `compliance`.
    fn against(
        &self,
        velocity: f64,
        force: f64,
        compliance: f64,
        part: &Part,
        near: &Near,
        work: &mut Workspace,
    ) -> Flux {
        let (point, n) = (&near.point, self.normal);
        let softness = 1.0 / self.impedance + compliance * self.area;
        let elastic = (n * (velocity - point.velocity) + point.stress / self.impedance + compliance * force) / softness;
        let driven = |stress: f64| velocity - n * compliance * (self.area * stress - force);
        if part.faces.stays_elastic(near, elastic) {
            return Flux { stress: elastic, velocity: driven(elastic) };
        }
        let (driver, placed) = (Side::Straight { force, velocity, compliance }, part.faces.point(near));
        let bar = Side::Bar(&part.faces.medium, &placed);
        let star = if n < 0.0 { solve(driver, bar, work) } else { solve(bar, driver, work) };
        let stress = star.force / self.area;
        Flux { stress, velocity: driven(stress) }
    }

    /// Under a stress. What the curve cannot carry into the bar pulls at its end all the same.
    fn under(&self, stress: f64, part: &Part, near: &Near, work: &mut Workspace) -> Flux {
        let point = &near.point;
        if part.faces.stays_elastic(near, stress) {
            let velocity = point.velocity + self.normal * (stress - point.stress) / self.impedance;
            return Flux { stress, velocity };
        }
        let sense = if stress < point.stress { -1.0 } else { 1.0 };
        let path = &mut work.left;
        path.fill(&part.faces.medium, &part.faces.point(near), sense);
        let carried = (sense * stress).min(path.cap());
        // The rest accelerates the end as if it were elastic.
        let change = path.velocity(carried) + (sense * stress - carried) / self.impedance;
        Flux { stress, velocity: point.velocity + self.normal * sense * change }
    }

    /// Now.
    pub fn reading(&self) -> EndReading {
        EndReading { stress: self.latest.stress, velocity: self.latest.velocity }
    }

    /// Velocity of the mass that strikes the end, m/s, where there is one.
    pub fn striker_velocity(&self) -> Option<f64> {
        self.striker.as_ref().map(|striker| striker.velocity)
    }
}

/// Rate of change of a history just after `time`, apart from its jumps.
fn rate(history: &History, time: f64) -> f64 {
    let (t, v) = (history.time(), history.value());
    let next = t.partition_point(|&row| row <= time);
    if next == 0 || next == t.len() { 0.0 } else { (v[next] - v[next - 1]) / (t[next] - t[next - 1]) }
}

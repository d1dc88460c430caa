//! Ends: Riemann problems with boundary conditions, see [`crate::bar::ends`].

use serde::{Deserialize, Serialize};

use super::block::Block;
use super::face::{compliance_ratio, response, under};
use super::part::Part;
use crate::bar::EndCondition;
use crate::bar::ends::{self, Boundary, EndModel, Face, Push, Relation, Response, Step};
use crate::solver::{EndState, StartingFan};
use crate::wave::riemann::{FaceState, Flux, Side, Workspace, solve};

/// An end of the bar.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct End {
    #[serde(skip, default = "ends::stateless")]
    model: Box<dyn EndModel>,
    face: Face,
    /// Whether the relation of the end was met in the latest step, i.e. no contact opened.
    met: bool,
    latest: Push,
    /// Displacement, m, into the bar.
    displacement: f64,
    /// Work done on the bar, J, and work done at the face, J. A body loses more energy in a step than the face receives, because the step does not
    /// resolve the exchange.
    pub work: f64,
    pub work_on_face: f64,
    pub impulse: f64,
    pub throughput: f64,
}

impl End {
    pub fn new(condition: &EndCondition, inward: f64, part: &Part, velocity: f64) -> Self {
        let impedance = (part.modulus * part.density).sqrt() * part.area;
        let face = Face { inward, area: part.area, impedance, velocity: inward * velocity };
        Self {
            model: ends::model(condition, face),
            face,
            met: false,
            latest: Push { velocity: face.velocity, ..Push::default() },
            displacement: 0.0,
            work: 0.0,
            work_on_face: 0.0,
            impulse: 0.0,
            throughput: 0.0,
        }
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

    fn step(&self, time: f64, dt: f64) -> Step {
        Step { time, dt, displacement: self.displacement }
    }

    /// Returns the ghost state beyond the end at `time`: stress, velocity, and E times strain. It is such that the slopes of the last cell suit the
    /// end condition: a mirror image if that is constant.
    pub fn beyond(&self, time: f64, dt: f64, block: &Block, part: &Part, work: &mut Workspace) -> [f64; 3] {
        let (normal, area) = (-self.face.inward, self.face.area);
        let side = usize::from(normal > 0.0);
        let i = block.inside(side, 0);
        let (stress, velocity, e_equivalent_strain) = (block.sigma[i], block.v[i], block.e_equivalent_strain(part, i));
        let mut compliance_ratio = |change: f64| compliance_ratio(block, part, side, change, work);
        let outward = normal * part.dx;
        let (beyond, moving) = match self.model.boundary(&self.step(time, dt), &self.latest, self.met) {
            Boundary::Velocity { value, rate } => {
                let (value, rate) = (-normal * value, -normal * rate);
                (stress + outward * part.density * rate, 2.0 * value - velocity)
            }
            Boundary::Force { value, rate } => (
                -2.0 * value / area - stress,
                velocity - outward * rate / area * compliance_ratio(-rate) / part.modulus,
            ),
            Boundary::Open => (stress, velocity),
        };
        let change = beyond - stress;
        // The strain is used only where the curve is followed both ways.
        let stretch = if part.path_independent { compliance_ratio(change) * change } else { change };
        [beyond, moving, e_equivalent_strain + stretch]
    }

    /// Returns the state just after t = 0; `dt` is the time step, s.
    pub fn start(&self, dt: f64, part: &Part, near: &FaceState, work: &mut Workspace) -> EndState {
        let Flux { stress, velocity } = self.respond(&self.step(0.0, dt).short(), part, near, work).0;
        EndState { stress, velocity }
    }

    /// Returns the flux through the end in the step that begins at `time`, and accounts for it.
    pub fn step_flux(&mut self, time: f64, dt: f64, part: &Part, near: &FaceState, work: &mut Workspace) -> Flux {
        let step = self.step(time, dt);
        let (flux, met) = self.respond(&step, part, near, work);
        self.record_step(&step, flux, met)
    }

    /// Same with a known flux.
    pub fn step_with(&mut self, time: f64, dt: f64, flux: Flux) -> Flux {
        self.record_step(&self.step(time, dt), flux, true)
    }

    /// Same behind a fan.
    pub fn step_behind(&mut self, time: f64, dt: f64, fan: &StartingFan) -> Flux {
        let (step, Face { inward, area, .. }) = (self.step(time, dt), self.face);
        let [stress, impedance] = fan.answer(time - fan.from + 0.5 * dt);
        let impedance = area * impedance;
        let bar = Response { force: -area * stress - impedance * inward * fan.velocity_behind, impedance };
        let [force, velocity] = self.model.relation(&step, &bar).solve_with(&bar);
        self.record_step(&step, Flux { stress: -force / area, velocity: inward * velocity }, true)
    }

    fn record_step(&mut self, step: &Step, flux: Flux, met: bool) -> Flux {
        let (force, velocity) = (-self.face.area * flux.stress, self.face.inward * flux.velocity);
        let push = Push { force, velocity, impulse: force * step.dt };
        let held = self.model.energy(self.displacement);
        self.model.advance(step, &push, met);
        self.displacement += step.dt * velocity;
        let given = held - self.model.energy(self.displacement);
        let on_face = push.impulse * velocity;
        self.work_on_face += on_face;
        self.work += if self.model.is_conservative() { given } else { on_face };
        self.impulse += self.face.inward * push.impulse;
        self.throughput += push.impulse.abs();
        (self.latest, self.met) = (push, met);
        flux
    }

    fn respond(&self, step: &Step, part: &Part, near: &FaceState, work: &mut Workspace) -> (Flux, bool) {
        let face = &self.face;
        let bar = response(part, &near.point, face.inward);
        let mut relation = self.model.relation(step, &bar);
        let mut flux = self.flux(&relation, &bar, part, near, work);
        if self.model.is_nonlinear() {
            relation = ends::agree(self.model.as_ref(), step, &bar, |relation| {
                let flux = self.flux(relation, &bar, part, near, work);
                [-face.area * flux.stress, face.inward * flux.velocity]
            });
            flux = self.flux(&relation, &bar, part, near, work);
        }
        if relation.unilateral && flux.stress >= 0.0 {
            return (under(0.0, face.inward, part, near, work), false);
        }
        (flux, true)
    }

    /// Solves the Riemann problem between the bar and the relation of the end.
    fn flux(&self, relation: &Relation, bar: &Response, part: &Part, near: &FaceState, work: &mut Workspace) -> Flux {
        let Relation { of_velocity, of_force, value, .. } = *relation;
        let face = &self.face;
        if of_velocity == 0.0 {
            return under(-value / of_force / face.area, face.inward, part, near, work);
        }
        let [force, velocity] = relation.solve_with(bar);
        let stress = -force / face.area;
        if part.faces.stays_elastic(near, stress) {
            return Flux { stress, velocity: face.inward * velocity };
        }
        let (velocity, compliance) = (face.inward * value / of_velocity, of_force / of_velocity);
        let (driver, placed) = (Side::Straight { force: 0.0, velocity, compliance }, part.faces.placed(near));
        let side = Side::Face(&part.faces.medium, &placed);
        let star = if face.inward > 0.0 { solve(driver, side, work) } else { solve(side, driver, work) };
        let velocity = velocity + face.inward * compliance * star.force;
        Flux { stress: star.force / face.area, velocity }
    }

    /// Mean state over the latest step.
    pub fn latest(&self) -> EndState {
        let Push { force, velocity, .. } = self.latest;
        EndState { stress: -force / self.face.area, velocity: self.face.inward * velocity }
    }

    /// Displacement, m, positive in +x.
    pub fn displacement(&self) -> f64 {
        self.face.inward * self.displacement
    }

    /// Velocity of a body at the end, m/s, positive in +x; `None` if there is none.
    pub fn striker_velocity(&self) -> Option<f64> {
        self.model.body().map(|body| self.face.inward * body.velocity)
    }
}

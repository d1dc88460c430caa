//! End of the staggered grid: a [`HalfNode`] between the bar and what holds or drives its end, see [`crate::bar::ends`].

use serde::{Deserialize, Serialize};

use super::grid_filter;
use super::half_node::{HalfNode, Impulses, PreviousForce};
use crate::bar::EndCondition;
use crate::bar::ends::{self, Body, EndModel, Face, Push, Response, Step};
use crate::solver::{EndSample, EndState};

/// Ratio of the rise in stress to E times the plastic strain of a step up to which the curve counts as level: plastic waves of 0.01 c0.
const LEVEL: f64 = 1e-4;

/// End of the bar with its node.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EndNode {
    #[serde(skip, default = "ends::stateless")]
    model: Box<dyn EndModel>,
    face: Face,
    node: HalfNode,
    /// Half the mass of the end cell, kg.
    mass: f64,
    dt: f64,
    /// Largest force for which the bar is elastic, N; infinite if the node moves an effective mass.
    limit: f64,
    /// Force on the end at the current time, N, compression positive, including the impulse of a sudden motion.
    force: f64,
    /// Recorded stress, Pa, see [`EndNode::stress`].
    stress: f64,
    /// Stress of the end cell in the previous and in this step, Pa.
    of_cell: [f64; 2],
    impulses: Impulses,
    /// Mean force over the latest step and over the step ahead, N; NaN before t = 0.
    means: [f64; 2],
    /// State just after t = 0, while that is the current time.
    start: Option<EndState>,
    /// Body at the end and its energy (J) at the current time.
    body: Option<Body>,
    body_energy: f64,
    /// Displacement one step ahead of the current time, m, into the bar.
    displacement: f64,
    /// Work done on the bar up to the current time, and in the step ahead, J.
    work: f64,
    work_ahead: f64,
    /// Work of the end's force on the node up to the current time, J.
    work_on_node: f64,
    impulse: f64,
    /// Sum of |impulse| over the steps, the scale for the momentum residual.
    throughput: f64,
    /// Number of consecutive steps in which the end has prescribed the velocity, up to [`u8::MAX`].
    held_for: u8,
    /// Whether the end resists motion more than the bar does.
    resists: bool,
    /// Part of the velocity half a step before t = 0 that the balance of a held end needs but the end did not have, m/s, into the bar; 0
    /// after the first step.
    not_moved: f64,
    cells: Cells,
    /// Choice of f- in the present step, see [`Impulses::choose`].
    previous_force: PreviousForce,
    /// Whether the end was suddenly made to move in the latest step.
    struck: bool,
    /// Energy taken by the grid filter, J.
    damped: f64,
    /// Impulse that the end has given because of the grid filter since the latest step, N s in +x.
    #[serde(skip)]
    given_to_filter: f64,
    /// Samples of every step, if they are logged.
    #[serde(skip)]
    log: Option<Vec<EndSample>>,
}

/// Flow history of the cells beside an end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Cells {
    /// No cell has ever flowed.
    Elastic,
    /// Some cells have flowed in the latest steps.
    Flowing,
    /// Some cells have flowed, but none in the latest steps.
    Flowed,
}

/// Force and velocity of an end in a step.
#[derive(Clone, Copy)]
struct Motion {
    /// Force P, N, compression positive.
    force: f64,
    /// Velocity u+ half a step after the current time, m/s, into the bar.
    velocity: f64,
    /// Whether the end's relation was met.
    met: bool,
    /// Whether the end prescribed the velocity; a body or wall in contact does so, too.
    held: bool,
    /// Whether the end resisted the motion more than the bar does.
    resists: bool,
}

/// Grid and material data at an end of the bar.
#[derive(Debug, Clone, Copy)]
pub struct EndGrid {
    /// Time step, s.
    pub dt: f64,
    /// Cell size, m.
    pub dx: f64,
    /// Density, kg/m^3.
    pub density: f64,
    /// Elastic impedance rho c0, Pa s/m.
    pub impedance: f64,
    /// Section of the end face, m^2.
    pub area: f64,
    /// Section of the end cell, m^2.
    pub cell_area: f64,
    /// Initial velocity of the end node, and of the very end of the bar, m/s.
    pub velocity: f64,
    pub end_velocity: f64,
    /// Absolute value of the stress up to which the end cell is elastic, Pa.
    pub yield_stress: f64,
}

impl EndNode {
    /// Creates the node at an end with the outward normal `normal` (-1 at the left end, +1 at the right end).
    pub fn new(condition: &EndCondition, normal: f64, grid: EndGrid) -> Self {
        let [velocity, at_end] = [grid.velocity, grid.end_velocity].map(|velocity| -normal * velocity);
        let face = Face { inward: -normal, area: grid.area, impedance: grid.impedance * grid.area, velocity: at_end };
        let mass = 0.5 * grid.density * grid.dx * grid.cell_area;
        Self {
            model: ends::model(condition, face),
            face,
            node: HalfNode::new(velocity, mass, grid.cell_area, grid.dt),
            mass,
            dt: grid.dt,
            limit: grid.yield_stress * grid.area,
            force: 0.0,
            stress: 0.0,
            of_cell: [0.0; 2],
            impulses: Impulses::default(),
            means: [f64::NAN; 2],
            start: None,
            body: None,
            body_energy: 0.0,
            displacement: 0.0,
            work: 0.0,
            work_ahead: 0.0,
            work_on_node: 0.0,
            impulse: 0.0,
            throughput: 0.0,
            held_for: 0,
            resists: false,
            not_moved: 0.0,
            cells: Cells::Elastic,
            previous_force: PreviousForce::default(),
            struck: false,
            damped: 0.0,
            given_to_filter: 0.0,
            log: None,
        }
    }

    /// Returns everything that changes from step to step.
    pub(super) fn state(&self) -> (&Self, [f64; 2]) {
        (self, self.model.state())
    }

    /// Restores what [`Self::state`] returned.
    pub(super) fn restore(&mut self, (saved, state): (Self, [f64; 2])) {
        let before = std::mem::replace(self, saved);
        (self.model, self.log) = (before.model, before.log);
        self.model.restore(state);
    }

    /// Sets the node's velocity at t = 0, m/s in +x, if nothing holds the node.
    pub(super) fn start_with(&mut self, velocity: f64) {
        let velocity = self.face.inward * velocity;
        (self.node.before, self.node.after) = (velocity, velocity);
        self.displacement = self.dt * velocity;
    }

    /// Sets the node's velocity half a step before t = 0, m/s in +x.
    pub(super) fn start_before(&mut self, velocity: f64) {
        let velocity = self.face.inward * velocity;
        (self.node.before, self.node.after) = (velocity, velocity);
    }

    /// Starts the node under an initial stress, see [`HalfNode::start_under`].
    pub(super) fn start_under(&mut self, half: f64) {
        let before = self.node.before;
        self.node.start_under(half);
        if self.held_for > 0 {
            self.stress = 2.0 * half;
            self.not_moved = self.node.before - before;
        }
    }

    /// Advances the node from half a step before `time` to half a step after it. `sigma_cell` is the stress of the end cell at `time`, Pa;
    /// `flows` tells whether cells beside the end have flowed in the latest steps.
    pub fn advance(&mut self, time: f64, sigma_cell: f64, flows: bool) {
        let cell = -self.node.area * sigma_cell;
        self.prepare(cell, flows);
        self.advance_showing(time, cell, sigma_cell);
    }

    /// Chooses f- of a step (see [`Impulses::choose`]) for a cell force of about `cell` (N); the choice holds whatever the final force is.
    fn prepare(&mut self, cell: f64, flows: bool) {
        self.cells = match self.cells {
            _ if flows => Cells::Flowing,
            Cells::Elastic => Cells::Elastic,
            Cells::Flowing | Cells::Flowed => Cells::Flowed,
        };
        self.previous_force = self.impulses.choose(cell, self.is_bounded());
    }

    /// Advances the node under the force `cell` (N) of the end cell; `shown` is the stress of that cell for the record, Pa.
    fn advance_showing(&mut self, time: f64, cell: f64, shown: f64) {
        self.of_cell = [self.of_cell[1], shown];
        let (step, previous) = (self.step(time), self.force);
        let Motion { force, velocity, met, held, resists } = self.respond(&step, cell);
        // A force that differs from the cell's by more than the bar can carry stops half a cell, possibly over two steps. Lateral inertia
        // takes up an impulse in both.
        let stopped = (force - cell).abs() > self.limit
            || self.limit.is_infinite() && self.held_for == 1 && !self.means[0].is_nan();
        self.struck = held && (self.held_for == 0 || stopped || self.model.jumps(time, self.dt));
        // The stress before is known if the end prescribed the force (0 if it was free); otherwise the end cell's stress is used.
        let before = if self.held_for > 0 || self.means[1].is_nan() { shown } else { -self.means[1] / self.face.area };
        self.stress = if self.struck { before } else { -force / self.face.area };
        if self.model.gap(self.displacement).is_some() {
            self.stress = self.stress.min(0.0);
        }
        let ahead = 2.0 * force - self.impulses.previous_force(cell, self.previous_force);
        self.means = [self.means[1], ahead];
        (self.start, self.not_moved, self.given_to_filter) = (None, 0.0, 0.0);
        // Once cells have flowed, waves one cell long run back and forth between these cells and the end. They would open contacts in every
        // second step; `record_damped` damps them.
        let impulse = self.dt
            * if self.is_characteristic() && self.cells == Cells::Elastic {
                self.impulses.record(ahead, cell)
            } else {
                self.impulses.record_damped(ahead, cell, self.previous_force)
            };
        (self.body, self.body_energy) = (self.model.body(), self.model.energy(self.displacement));
        self.model.advance(&step, &Push { force: ahead, velocity, impulse }, met);
        let given = self.body_energy - self.model.energy(self.displacement + self.dt * velocity);
        self.work += std::mem::replace(
            &mut self.work_ahead,
            if self.model.is_conservative() { given } else { impulse * velocity },
        );
        self.node.advance(velocity);
        self.held_for = if held { self.held_for.saturating_add(1) } else { 0 };
        (self.force, self.resists) = (force, resists);
        self.record_work(previous);
        self.displacement += self.dt * self.node.after;
    }

    fn step(&self, time: f64) -> Step {
        Step { time, dt: self.dt, displacement: self.displacement }
    }

    /// Sets the effective mass that the end moves, kg, in place of half the mass of its cell.
    pub(super) fn set_mass(&mut self, mass: f64) {
        // The force of the bar then contains more than the stress of a cell.
        self.limit = f64::INFINITY;
        self.node.impedance = mass / self.dt;
    }

    /// Chooses f- of a step (see [`Impulses::choose`]) if the bar gives an impulse of about `pull`, N s in +x. The choice is made
    /// beforehand so that [`Self::answer`] is a continuous function of the impulse.
    pub(super) fn prepare_for(&mut self, pull: f64, flows: bool) {
        self.prepare(-self.face.inward * pull / self.dt, flows);
    }

    /// Returns the velocity change (m/s, in +x) of the step around `time` if the bar gives the effective mass an impulse of `pull`, N s in
    /// +x.
    pub(super) fn answer(&self, time: f64, pull: f64) -> f64 {
        let motion = self.respond(&self.step(time), -self.face.inward * pull / self.dt);
        self.face.inward * (motion.velocity - self.node.after)
    }

    /// Advances the node by that step. `sigma_cell` is the stress of the end cell for the record, Pa.
    pub(super) fn advance_by(&mut self, time: f64, pull: f64, sigma_cell: f64) {
        self.advance_showing(time, -self.face.inward * pull / self.dt, sigma_cell);
    }

    /// Returns the force and the velocity of a step under the force `cell` (N) of the end cell.
    fn respond(&self, step: &Step, cell: f64) -> Motion {
        let previous_force = self.impulses.previous_force(cell, self.previous_force);
        let bar = self.node.response(cell, previous_force);
        let relation = self.model.relation(step, &bar);
        let [ahead, velocity] = relation.solve_with(&bar);
        let met = !relation.unilateral || ahead > 0.0;
        if relation.of_velocity == 0.0 || !met {
            // The force is known; the velocity follows.
            let force = 0.5 * (previous_force + if met { ahead } else { 0.0 });
            return Motion {
                force,
                velocity: self.node.velocity_under_force(force, cell),
                met,
                held: false,
                resists: false,
            };
        }
        let held = relation.unilateral || relation.of_force == 0.0;
        let resists = held || relation.resists(&bar);
        let force = cell + self.node.impedance * (velocity - self.node.after);
        Motion { force, velocity, met, held, resists }
    }

    /// Brings the node exactly to rest in the step that was taken, by friction.
    pub(super) fn stop(&mut self) {
        self.displacement -= self.dt * self.node.after;
        self.node.after = 0.0;
    }

    /// Returns the energy of the body at the end at the current time, J: the kinetic energy of a striker, the stored energy of a spring,
    /// both for a ball; 0 without a body.
    pub fn body_energy(&self) -> f64 {
        self.body_energy
    }

    /// Returns the velocity (m/s, in +x) of the striker or ball and its distance from the end (m; negative for a ball in contact: the
    /// approach) at the current time. `None` if there is neither.
    pub fn striker(&self) -> Option<(f64, f64)> {
        self.body.map(|body| (self.face.inward * body.velocity, body.gap))
    }

    /// Returns true if the end pulls the bar.
    pub(super) fn pulls(&self) -> bool {
        self.force < 0.0
    }

    /// Fractures the bar at its end, which is free from the next step on.
    pub(super) fn release(&mut self) {
        self.model = ends::model(&EndCondition::Free, self.face);
    }

    /// Changes the node's velocity by the grid filter (m/s, in +x); if the velocity is prescribed in this step, the end takes the impulse
    /// instead. `sigma_cell` is the stress of the end cell, Pa.
    pub(super) fn damp(&mut self, change: f64, sigma_cell: f64) {
        if change == 0.0 {
            return;
        }
        let change = self.face.inward * change;
        if self.is_held() {
            let impulse = -self.face.inward * change * self.mass;
            let [work, taken] = self.apply_impulse(impulse, self.velocity_after());
            self.damped += work - taken;
            self.given_to_filter += impulse;
            return;
        }
        let velocity_increment = self.velocity_increment(sigma_cell);
        self.damped += 0.5 * self.mass * grid_filter::node(velocity_increment, change, &mut self.node.after);
        self.node.before += change;
        self.displacement += self.dt * change;
    }

    /// Returns the mass of the node, kg.
    pub(super) fn mass(&self) -> f64 {
        self.mass
    }

    /// Changes the velocities before and after the current time by `change` (m/s, in +x); [`Self::apply_impulse`] accounts for the impulse. Returns
    /// the energy that this takes, J.
    pub(super) fn impose(&mut self, change: f64) -> f64 {
        let change = self.face.inward * change;
        let velocity_increment = self.node.after - self.node.before;
        self.node.before += change;
        self.add_velocity(change);
        -0.5 * self.mass * grid_filter::node(velocity_increment, change, &mut self.node.after)
    }

    /// Gives the bar beyond the node an impulse (N s in +x) from the end in the present step, in which the end moves with `velocity` (m/s).
    /// A body gives it from its own momentum, and takes the node with it. Returns the work on the bar and the part of it that the node
    /// gained, J.
    pub(super) fn apply_impulse(&mut self, impulse: f64, velocity: f64) -> [f64; 2] {
        let before = self.model.energy(self.displacement);
        let change = self.face.inward * self.model.apply_impulse(self.dt, self.face.inward * impulse, self.mass);
        let given = before - self.model.energy(self.displacement);
        let work = if self.model.body().is_some() { given } else { impulse * velocity };
        let taken = if change == 0.0 { 0.0 } else { self.impose(change) };
        self.record_impulse(impulse + self.mass * change);
        self.work += work;
        self.work_on_node += work;
        [work, taken]
    }

    /// Records an additional impulse (N s in +x) that the end has given to the bar.
    pub(super) fn record_impulse(&mut self, impulse: f64) {
        self.impulse += impulse;
        self.throughput += impulse.abs();
    }

    /// Returns whether there is a body at the end.
    pub(super) fn has_body(&self) -> bool {
        self.model.body().is_some()
    }

    /// Returns the impulse that the end has given because of the grid filter since the latest step, N s in +x.
    pub(super) fn given_to_filter(&self) -> f64 {
        self.given_to_filter
    }

    /// Makes the end move with this velocity (m/s, in +x) in the step ahead, driven by its own force. For t = 0.
    pub(super) fn start_moving(&mut self, velocity: f64) {
        let change = self.face.inward * velocity - self.node.after;
        let more = self.node.impedance * change;
        self.force += more;
        self.by_store(|end| {
            end.model.apply_impulse(end.dt, end.dt * more, end.mass);
        });
        self.add_velocity(change);
        self.node.after += change;
        let impulse = 0.5 * self.dt * more;
        self.impulse += self.face.inward * impulse;
        self.throughput += impulse.abs();
        self.work_on_node += impulse * self.node.before;
    }

    /// Makes the end move faster by `change` (m/s, into the bar) in the step ahead; a spring or a ball supplies the work.
    fn add_velocity(&mut self, change: f64) {
        self.by_store(|end| {
            end.displacement += end.dt * change;
            end.model.add_displacement(end.dt * change);
        });
    }

    /// Runs `act`, and counts the energy that it takes from what the end stores as work of the step ahead.
    fn by_store(&mut self, act: impl FnOnce(&mut Self)) {
        let before = self.model.energy(self.displacement);
        act(self);
        if self.model.is_conservative() {
            self.work_ahead += before - self.model.energy(self.displacement);
        }
    }

    /// Returns whether the force of the end is known, however the bar moves.
    pub(super) fn imposes_force(&self) -> bool {
        self.model.relation(&self.step(0.0), &self.node.response(0.0, 0.0)).of_velocity == 0.0
    }

    /// Sets the mean stress at the face over the step ahead, Pa, from which the next step takes f-.
    pub(super) fn set_stress_ahead(&mut self, stress: f64) {
        self.impulses.set_latest(-self.face.area * stress);
    }

    /// Sets the recorded stress at the current time, Pa.
    pub(super) fn set_recorded_stress(&mut self, stress: f64) {
        self.stress = stress;
    }

    /// Returns the mean stress on the end over the step ahead, Pa.
    pub(super) fn stress_ahead(&self) -> f64 {
        -self.means[1] / self.face.area
    }

    /// Returns the mean velocity (m/s, in +x) over the step ahead of the body at the end; that of the node if there is no body.
    pub(super) fn velocity_of_body(&self) -> f64 {
        let gap = self.model.body().map_or(0.0, |body| body.gap);
        self.face.inward * (self.node.after - gap / self.dt)
    }

    /// Returns the velocity (m/s, in +x) which, times an impulse of the grid filter, is the energy that the bar loses by it, see
    /// [`Self::damp`]. The impulse changes the node's velocity by `change` (m/s, in +x).
    pub(super) fn velocity_damped(&self, change: f64, sigma_cell: f64) -> f64 {
        let from_stress = self.face.inward * self.velocity_increment(sigma_cell);
        self.velocity_after() + if self.is_held() { 0.0 } else { 0.5 * (change - from_stress) }
    }

    /// Returns the velocity change of the node in the latest step, m/s, into the bar.
    fn velocity_increment(&self, sigma_cell: f64) -> f64 {
        (self.force + self.node.area * sigma_cell) / self.node.impedance
    }

    /// Returns the size of the velocity difference (m/s) of the end cell that the force on the end supports. `flow` is E times the plastic
    /// strain of the end cell in the latest step, Pa. In a wave that leaves the end, the stress falls by rho c w/2 over half the cell,
    /// where w is the velocity difference and c the wave speed of the cell's tangent modulus. Returns `None` if the end does not load the
    /// cell, and on a level part of the curve, which carries no wave.
    pub(super) fn supported_by_load(&self, flow: f64) -> Option<f64> {
        let sense = 1.0_f64.copysign(flow);
        let ([before, now], stress) = (self.of_cell, -self.force / self.face.area);
        if flow == 0.0 || sense * stress <= 0.0 {
            return None;
        }
        let rise = (sense * (now - before)).max(0.0);
        if rise < LEVEL * flow.abs() {
            return None;
        }
        let slowness = ((rise + flow.abs()) / rise).sqrt();
        let fall = sense * (stress - now);
        let impedance = self.face.impedance / self.face.area;
        Some(if fall > 0.0 { 2.0 * fall / impedance * slowness } else { 0.0 })
    }

    /// Returns the energy that the grid filter took from the node, J.
    pub(super) fn damped(&self) -> f64 {
        self.damped
    }

    /// Starts a log.
    pub(super) fn watch(&mut self) {
        self.log.get_or_insert_default();
    }

    /// Appends the current state to the log.
    pub(super) fn note(&mut self, is_elastic: bool) {
        let now = self.sample(is_elastic);
        self.log.iter_mut().for_each(|log| log.push(now));
    }

    /// Returns the state of the end after the latest step; `is_elastic` tells whether the bar beside it was elastic in that step. The mean
    /// state over the step is known if the bar was elastic and the half node is the characteristic.
    pub(super) fn sample(&self, is_elastic: bool) -> EndSample {
        let [mean, _] = self.means;
        let latest = if is_elastic && mean.abs() <= self.limit && self.is_characteristic() {
            EndState { stress: -mean / self.face.area, velocity: self.velocity_before() }
        } else {
            EndState::UNKNOWN
        };
        EndSample { now: self.start.unwrap_or_else(|| self.reading()), latest }
    }

    /// Returns whether the end stops the node at once with a force that the cells may not be able to carry.
    fn is_bounded(&self) -> bool {
        self.resists && (self.cells == Cells::Flowing || !self.is_characteristic())
    }

    /// Returns whether the half node responds as an elastic bar does: at Courant number 1.
    pub(super) fn is_characteristic(&self) -> bool {
        self.node.is_characteristic(self.face.impedance)
    }

    /// Returns the state just after t = 0 under this end condition, if the bar responds elastically from the stress `stress` (Pa).
    pub(super) fn at_once(&self, condition: &EndCondition, stress: f64) -> EndState {
        let impedance = self.face.impedance;
        let force = -self.face.area * stress - impedance * self.face.velocity;
        let (model, start) = (ends::model(condition, self.face), Step { time: 0.0, dt: self.dt, displacement: 0.0 });
        let [force, velocity] = ends::at_once(model.as_ref(), &start, &Response { force, impedance });
        EndState { stress: -force / self.face.area, velocity: self.face.inward * velocity }
    }

    /// Sets the state just after t = 0.
    pub(super) fn start_in(&mut self, state: EndState) {
        self.start = Some(state);
    }

    /// Returns the log; empty if none is kept.
    pub(super) fn log(&self) -> &[EndSample] {
        self.log.as_deref().unwrap_or_default()
    }

    /// Clears the log.
    pub(super) fn clear_log(&mut self) {
        self.log.iter_mut().for_each(Vec::clear);
    }

    /// Returns true if the end's velocity follows from the end condition rather than from the stress, or if the end's position matters: the
    /// end then takes the impulses of the grid filter. (The node of a stiff dashpot would respond to each with an impulse of the same size
    /// in the opposite direction, in every step in which the bar flows.)
    pub(super) fn is_held(&self) -> bool {
        self.resists || self.model.depends_on_displacement()
    }

    /// Records impulse and work by the trapezoidal rule in the end's force, the form in which the staggered scheme balances momentum and
    /// energy to round-off. The first half step starts from the initial velocity.
    fn record_work(&mut self, previous: f64) {
        let half = 0.5 * self.dt;
        let is_first = self.means[0].is_nan();
        let impulse = if is_first { half * self.force } else { half * (previous + self.force) };
        self.impulse += self.face.inward * impulse;
        self.throughput += impulse.abs();
        self.work_on_node += impulse * self.node.before;
    }

    /// Returns the velocity half a step after the current time, m/s.
    pub fn velocity_after(&self) -> f64 {
        self.face.inward * self.node.after
    }

    /// Returns the velocity half a step before the current time, m/s.
    pub fn velocity_before(&self) -> f64 {
        self.face.inward * self.node.before
    }

    /// Returns stress and velocity at the current time.
    pub fn reading(&self) -> EndState {
        EndState { stress: self.stress(), velocity: self.velocity() }
    }

    /// Returns the velocity at the current time, m/s. If the end is suddenly made to move, it is the velocity before the jump.
    pub fn velocity(&self) -> f64 {
        let before = self.velocity_before() - self.face.inward * self.not_moved;
        if self.struck { before } else { 0.5 * (before + self.velocity_after()) }
    }

    /// Returns the stress at the end at the current time, Pa. If the end is suddenly made to move, it is the stress before the jump,
    /// without the impulse that accelerates half a cell; if the end was held before, too, it is the stress of the end cell.
    pub fn stress(&self) -> f64 {
        self.stress
    }

    /// Returns the displacement at the current time, m.
    pub fn displacement(&self) -> f64 {
        self.face.inward * (self.displacement - self.dt * self.node.after)
    }

    /// Returns the displacement after the step ahead, m.
    pub(super) fn displacement_ahead(&self) -> f64 {
        self.face.inward * self.displacement
    }

    /// Returns the work done on the bar so far, J: the energy lost by a body at the end, or else force times displacement summed over the
    /// steps.
    pub fn work(&self) -> f64 {
        self.work
    }

    /// Returns the part of that work which is neither in the node's motion nor in the bar, J: the force of a step acts on the node in
    /// halves. At a sudden velocity change w it is about m w^2, of first order in the cell size, of either sign.
    pub fn in_transit(&self) -> f64 {
        self.work - self.work_on_node
    }

    /// Returns the impulse given to the bar so far, N s, positive in +x.
    pub fn impulse(&self) -> f64 {
        self.impulse
    }

    /// Returns the sum of the absolute values of all impulses so far, N s.
    pub fn throughput(&self) -> f64 {
        self.throughput
    }
}

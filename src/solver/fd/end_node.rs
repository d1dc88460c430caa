//! An end of the staggered grid: a [`HalfNode`] between the bar and what holds or drives its end, see [`crate::bar::ends`].

use serde::{Deserialize, Serialize};

use super::grid_filter;
use super::half_node::{HalfNode, Impulses, PassedOn};
use crate::bar::EndCondition;
use crate::bar::ends::{self, Body, EndModel, Face, Push, Response, Step};
use crate::solver::{EndSample, EndState};

/// Rise of the stress over E times the plastic strain of a step up to which a curve counts as level: plastic waves of 0.01 c0.
const LEVEL: f64 = 1e-4;

/// An end of the bar and its node.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EndNode {
    #[serde(skip, default = "ends::stateless")]
    model: Box<dyn EndModel>,
    face: Face,
    node: HalfNode,
    /// Of half its cell, kg.
    mass: f64,
    dt: f64,
    /// Force up to which the bar is elastic, N.
    limit: f64,
    /// Force on the end at the current time, N, with the impulse of a sudden motion.
    force: f64,
    /// The stress for the record, see [`EndNode::stress`].
    stress: f64,
    /// Stress of the end cell in the step before and in this one, Pa.
    of_cell: [f64; 2],
    impulses: Impulses,
    /// Mean force over the latest step and over the step ahead, N; not a number before t = 0.
    means: [f64; 2],
    /// Just after t = 0, as long as that is the current time.
    start: Option<EndState>,
    /// The body at the end and its energy at the current time.
    body: Option<Body>,
    body_energy: f64,
    /// A step ahead of the current time, m, into the bar.
    displacement: f64,
    /// Work done on the bar up to the current time, and in the step ahead, J.
    work: f64,
    to_give: f64,
    /// Work of the forces on the node up to the current time, J.
    work_on_node: f64,
    impulse: f64,
    /// Sum of |impulse| of the steps, the scale for the momentum residual.
    throughput: f64,
    /// For how many steps the velocity has followed from what holds the end, up to [`u8::MAX`].
    held_for: u8,
    /// What is at the end resists its motion more than the bar does.
    resists: bool,
    /// Of the velocity half a step before t = 0, while that is the current time: what the balance of a held end needs and the end has not had, m/s,
    /// into the bar.
    not_moved: f64,
    cells: Cells,
    /// What the present step takes over, see [`Impulses::choose`].
    passed_on: PassedOn,
    /// It was suddenly made to move in the latest step.
    struck: bool,
    /// Taken by the grid filter, J.
    damped: f64,
    /// What the end has given because of the grid filter since the latest step, N s in +x.
    #[serde(skip)]
    given_to_filter: f64,
    /// Of every step, where they are asked for.
    #[serde(skip)]
    log: Option<Vec<EndSample>>,
}

/// The cells beside an end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Cells {
    /// None has ever flowed.
    Elastic,
    /// Some flow.
    Flowing,
    /// Some have flowed.
    Flowed,
}

/// What a step makes of an end.
#[derive(Clone, Copy)]
struct Motion {
    /// P, N.
    force: f64,
    /// u+, m/s.
    velocity: f64,
    /// The end's relation was met.
    met: bool,
    /// Its velocity was prescribed.
    held: bool,
    /// What is there resisted its motion more than the bar does.
    resists: bool,
}

/// The grid at an end, as a device needs it.
#[derive(Debug, Clone, Copy)]
pub struct EndGrid {
    /// Time step, s.
    pub dt: f64,
    /// Cell size, m.
    pub dx: f64,
    /// kg/m^3.
    pub density: f64,
    /// Elastic impedance rho c0, Pa s/m.
    pub impedance: f64,
    /// Of the end, m^2.
    pub area: f64,
    /// Of the end cell, m^2.
    pub cell_area: f64,
    /// Initial velocity of its node, and of the very end of the bar, m/s.
    pub velocity: f64,
    pub end_velocity: f64,
    /// Size of the stress up to which the end cell is elastic, Pa.
    pub yield_stress: f64,
}

impl EndNode {
    /// The device at an end with outward normal `normal` (-1 left, +1 right).
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
            to_give: 0.0,
            work_on_node: 0.0,
            impulse: 0.0,
            throughput: 0.0,
            held_for: 0,
            resists: false,
            not_moved: 0.0,
            cells: Cells::Elastic,
            passed_on: PassedOn::default(),
            struck: false,
            damped: 0.0,
            given_to_filter: 0.0,
            log: None,
        }
    }

    /// All that changes from step to step.
    pub(super) fn state(&self) -> (&Self, [f64; 2]) {
        (self, self.model.state())
    }

    /// Takes over what [`Self::state`] gave.
    pub(super) fn restore(&mut self, (saved, state): (Self, [f64; 2])) {
        let before = std::mem::replace(self, saved);
        (self.model, self.log) = (before.model, before.log);
        self.model.restore(state);
    }

    /// The node's velocity at t = 0, m/s, where nothing holds it.
    pub(super) fn start_with(&mut self, velocity: f64) {
        let velocity = self.face.inward * velocity;
        (self.node.before, self.node.after) = (velocity, velocity);
        self.displacement = self.dt * velocity;
    }

    /// The node's velocity half a step before t = 0, m/s.
    pub(super) fn start_before(&mut self, velocity: f64) {
        let velocity = self.face.inward * velocity;
        (self.node.before, self.node.after) = (velocity, velocity);
    }

    /// See [`HalfNode::start_under`].
    pub(super) fn start_under(&mut self, half: f64) {
        let before = self.node.before;
        self.node.start_under(half);
        if self.held_for > 0 {
            self.stress = 2.0 * half;
            self.not_moved = self.node.before - before;
        }
    }

    /// Takes the node from half a step before `time` to half a step after it. `sigma_cell` is the stress at `time`
    /// in the end cell, beside which some `flow`.
    pub fn advance(&mut self, time: f64, sigma_cell: f64, flows: bool) {
        let cell = -self.node.area * sigma_cell;
        self.prepare(cell, flows);
        self.advance_showing(time, cell, sigma_cell);
    }

    /// Settles what a step under the force `cell` (N) takes over from the one before, whatever the force turns out to be.
    fn prepare(&mut self, cell: f64, flows: bool) {
        self.cells = match self.cells {
            _ if flows => Cells::Flowing,
            Cells::Elastic => Cells::Elastic,
            Cells::Flowing | Cells::Flowed => Cells::Flowed,
        };
        self.passed_on = self.impulses.choose(cell, self.is_bounded());
    }

    /// The same under the force `cell` (N) of the end cell; `shown` is its stress for the record.
    fn advance_showing(&mut self, time: f64, cell: f64, shown: f64) {
        self.of_cell = [self.of_cell[1], shown];
        let (step, previous) = (self.step(time), self.force);
        let Motion { force, velocity, met, held, resists } = self.respond(&step, cell);
        // More than the bar can carry on half a cell: it is stopped, perhaps over two steps. Sideways motion takes an impulse in both.
        let stopped = (force - cell).abs() > self.limit
            || self.limit.is_infinite() && self.held_for == 1 && !self.means[0].is_nan();
        self.struck = held && (self.held_for == 0 || stopped || self.model.jumps(time, self.dt));
        // A force that the end gave before, as none where it was free, is known; else its cell tells what it carried.
        let before = if self.held_for > 0 || self.means[1].is_nan() { shown } else { -self.means[1] / self.face.area };
        self.stress = if self.struck { before } else { -force / self.face.area };
        if self.model.gap(self.displacement).is_some() {
            self.stress = self.stress.min(0.0);
        }
        let ahead = 2.0 * force - self.impulses.passed_on(cell, self.passed_on);
        self.means = [self.means[1], ahead];
        (self.start, self.not_moved, self.given_to_filter) = (None, 0.0, 0.0);
        // Once cells have flowed, waves of a cell's length run to and fro before them, and would open contacts in every second step.
        let impulse = self.dt
            * if self.is_characteristic() && self.cells == Cells::Elastic {
                self.impulses.take(ahead, cell)
            } else {
                self.impulses.push(ahead, cell, self.passed_on)
            };
        (self.body, self.body_energy) = (self.model.body(), self.model.energy(self.displacement));
        self.model.advance(&step, &Push { force: ahead, velocity, impulse }, met);
        let given = self.body_energy - self.model.energy(self.displacement + self.dt * velocity);
        self.work += std::mem::replace(&mut self.to_give, if self.model.stores() { given } else { impulse * velocity });
        self.node.move_on(velocity);
        self.held_for = if held { self.held_for.saturating_add(1) } else { 0 };
        (self.force, self.resists) = (force, resists);
        self.account(previous);
        self.displacement += self.dt * self.node.after;
    }

    fn step(&self, time: f64) -> Step {
        Step { time, dt: self.dt, displacement: self.displacement }
    }

    /// The end moves this mass, kg, in place of half its cell's.
    pub(super) fn set_mass(&mut self, mass: f64) {
        // The force of the bar holds more than the stress of a cell then.
        self.limit = f64::INFINITY;
        self.node.impedance = mass / self.dt;
    }

    /// Settles what a step takes over from the one before where the bar gives about the impulse `pull`, N s in +x. So the answer to a
    /// pull that is looked for does not jump.
    pub(super) fn prepare_for(&mut self, pull: f64, flows: bool) {
        self.prepare(-self.face.inward * pull / self.dt, flows);
    }

    /// Velocity change of the step around `time` if the bar gives that mass an impulse of `pull`, N s in +x.
    pub(super) fn answer(&self, time: f64, pull: f64) -> f64 {
        let motion = self.respond(&self.step(time), -self.face.inward * pull / self.dt);
        self.face.inward * (motion.velocity - self.node.after)
    }

    /// Takes that step. `sigma_cell` is the stress of the end cell, for the record.
    pub(super) fn advance_by(&mut self, time: f64, pull: f64, sigma_cell: f64) {
        self.advance_showing(time, -self.face.inward * pull / self.dt, sigma_cell);
    }

    /// Force and velocity of a step under the force `cell` (N) of the end cell.
    fn respond(&self, step: &Step, cell: f64) -> Motion {
        let passed_on = self.impulses.passed_on(cell, self.passed_on);
        let bar = self.node.response(cell, passed_on);
        let relation = self.model.relation(step, &bar);
        let [ahead, velocity] = relation.solve_with(&bar);
        let met = !relation.unilateral || ahead > 0.0;
        if relation.of_velocity == 0.0 || !met {
            // The force is known; the velocity follows.
            let force = 0.5 * (passed_on + if met { ahead } else { 0.0 });
            return Motion { force, velocity: self.node.pushed(force, cell), met, held: false, resists: false };
        }
        let held = relation.unilateral || relation.of_force == 0.0;
        let resists = held || relation.resists(&bar);
        let force = cell + self.node.impedance * (velocity - self.node.after);
        Motion { force, velocity, met, held, resists }
    }

    /// Friction brings the node to rest in the step that was taken: to the last bit.
    pub(super) fn stop(&mut self) {
        self.displacement -= self.dt * self.node.after;
        self.node.after = 0.0;
    }

    /// Energy of the body at the end at the current time, J: of motion for a striker, stored for a spring, both for a ball; 0
    /// without one.
    pub fn body_energy(&self) -> f64 {
        self.body_energy
    }

    /// The striker's or ball's velocity (m/s) and its distance from the end (m; for a ball that touches it, less than 0: the
    /// approach) at the current time. None without one.
    pub fn striker(&self) -> Option<(f64, f64)> {
        self.body.map(|body| (self.face.inward * body.velocity, body.gap))
    }

    /// True where the end pulls the bar.
    pub(super) fn pulls(&self) -> bool {
        self.force < 0.0
    }

    /// The bar breaks off what is at its end, which is free from the next step on.
    pub(super) fn let_go(&mut self) {
        self.model = ends::model(&EndCondition::Free, self.face);
    }

    /// The grid filter changes the node's velocity (m/s, in +x); where that is prescribed just now the end takes the impulse. `sigma_cell` is
    /// the stress of the end cell.
    pub(super) fn damp(&mut self, change: f64, sigma_cell: f64) {
        if change == 0.0 {
            return;
        }
        let change = self.face.inward * change;
        if self.is_held() {
            let impulse = -self.face.inward * change * self.mass;
            let [work, taken] = self.give(impulse, self.velocity_after());
            self.damped += work - taken;
            self.given_to_filter += impulse;
            return;
        }
        let velocity_increment = self.velocity_increment(sigma_cell);
        self.damped += 0.5 * self.mass * grid_filter::node(velocity_increment, change, &mut self.node.after);
        self.node.before += change;
        self.displacement += self.dt * change;
    }

    /// Mass of the node, kg.
    pub(super) fn mass(&self) -> f64 {
        self.mass
    }

    /// Changes the velocities before and after the current time by `change` (m/s, in +x), with an impulse that [`Self::give`] books.
    /// Returns the energy that this takes, J.
    pub(super) fn impose(&mut self, change: f64) -> f64 {
        let change = self.face.inward * change;
        let velocity_increment = self.node.after - self.node.before;
        self.node.before += change;
        self.shift(change);
        -0.5 * self.mass * grid_filter::node(velocity_increment, change, &mut self.node.after)
    }

    /// The bar beyond the node gets this impulse (N s in +x) from the end in the present step, where the end moves with `velocity` (m/s). A body
    /// gives it of its own motion, and takes the node with it. Returns the work on the bar and what of it the node took, J.
    pub(super) fn give(&mut self, impulse: f64, velocity: f64) -> [f64; 2] {
        let before = self.model.energy(self.displacement);
        let change = self.face.inward * self.model.give(self.dt, self.face.inward * impulse, self.mass);
        let given = before - self.model.energy(self.displacement);
        let work = if self.model.body().is_some() { given } else { impulse * velocity };
        let taken = if change == 0.0 { 0.0 } else { self.impose(change) };
        self.book_impulse(impulse + self.mass * change);
        self.work += work;
        self.work_on_node += work;
        [work, taken]
    }

    /// The end has given the bar this impulse (N s in +x), too.
    pub(super) fn book_impulse(&mut self, impulse: f64) {
        self.impulse += impulse;
        self.throughput += impulse.abs();
    }

    /// A body is at the end.
    pub(super) fn has_body(&self) -> bool {
        self.model.body().is_some()
    }

    /// What the end has given because of the grid filter since the latest step, N s in +x.
    pub(super) fn given_to_filter(&self) -> f64 {
        self.given_to_filter
    }

    /// At t = 0: in the step ahead the end moves with this velocity (m/s, in +x), which its own force gives it.
    pub(super) fn start_moving(&mut self, velocity: f64) {
        let change = self.face.inward * velocity - self.node.after;
        let more = self.node.impedance * change;
        self.force += more;
        self.by_store(|end| {
            end.model.give(end.dt, end.dt * more, end.mass);
        });
        self.shift(change);
        self.node.after += change;
        let impulse = 0.5 * self.dt * more;
        self.impulse += self.face.inward * impulse;
        self.throughput += impulse.abs();
        self.work_on_node += impulse * self.node.before;
    }

    /// The end moves faster by this in the step ahead, m/s, into the bar: a spring or a ball gives that work.
    fn shift(&mut self, change: f64) {
        self.by_store(|end| {
            end.displacement += end.dt * change;
            end.model.shift(end.dt * change);
        });
    }

    /// What the end stores gives the energy of this.
    fn by_store(&mut self, act: impl FnOnce(&mut Self)) {
        let before = self.model.energy(self.displacement);
        act(self);
        if self.model.stores() {
            self.to_give += before - self.model.energy(self.displacement);
        }
    }

    /// Its force is known, however the bar moves.
    pub(super) fn imposes_force(&self) -> bool {
        self.model.relation(&self.step(0.0), &self.node.response(0.0, 0.0)).of_velocity == 0.0
    }

    /// The mean stress at the face over the step ahead is this, Pa: what the next step takes over.
    pub(super) fn carry(&mut self, stress: f64) {
        self.impulses.correct(-self.face.area * stress);
    }

    /// The record shows this stress, Pa, at the current time.
    pub(super) fn show(&mut self, stress: f64) {
        self.stress = stress;
    }

    /// Mean stress on the end over the step ahead, Pa.
    pub(super) fn stress_ahead(&self) -> f64 {
        -self.means[1] / self.face.area
    }

    /// Mean velocity (m/s) of the node over the step ahead, with the body at the end where there is one.
    pub(super) fn velocity_of_body(&self) -> f64 {
        let gap = self.model.body().map_or(0.0, |body| body.gap);
        self.face.inward * (self.node.after - gap / self.dt)
    }

    /// Velocity (m/s, in +x) at which the bar loses an impulse of the grid filter that changes the node's by `change` (m/s, in +x), see
    /// [`Self::damp`].
    pub(super) fn velocity_damped(&self, change: f64, sigma_cell: f64) -> f64 {
        let from_stress = self.face.inward * self.velocity_increment(sigma_cell);
        self.velocity_after() + if self.is_held() { 0.0 } else { 0.5 * (change - from_stress) }
    }

    /// Velocity change of the node in the latest step, into the bar, m/s.
    fn velocity_increment(&self, sigma_cell: f64) -> f64 {
        (self.force + self.node.area * sigma_cell) / self.node.impedance
    }

    /// Size of the velocity difference (m/s) of the end cell, which flowed by `flow` (E times the plastic strain of the latest step, Pa), that the force on
    /// the end supports. In a wave that leaves the end the stress falls by rho c w/2 over half the cell, c being the speed of the cell's tangent. None
    /// where the end does not load the cell, and on a level part of the curve, which carries no wave.
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

    /// Energy that the grid filter took from the node, J.
    pub(super) fn damped(&self) -> f64 {
        self.damped
    }

    /// Keeps a log from now on.
    pub(super) fn watch(&mut self) {
        self.log.get_or_insert_default();
    }

    /// Adds the current state to the log.
    pub(super) fn note(&mut self, is_elastic: bool) {
        let now = self.sample(is_elastic);
        self.log.iter_mut().for_each(|log| log.push(now));
    }

    /// The end after the latest step, in which the bar beside it was elastic or not. The mean over the step is the elastic one where the
    /// half node is the characteristic.
    pub(super) fn sample(&self, is_elastic: bool) -> EndSample {
        let [mean, _] = self.means;
        let latest = if is_elastic && mean.abs() <= self.limit && self.is_characteristic() {
            EndState { stress: -mean / self.face.area, velocity: self.velocity_before() }
        } else {
            EndState::UNKNOWN
        };
        EndSample { now: self.start.unwrap_or_else(|| self.reading()), latest }
    }

    /// It stops the node at once with a force that cells may not be able to carry.
    fn is_bounded(&self) -> bool {
        self.resists && (self.cells == Cells::Flowing || !self.is_characteristic())
    }

    /// At Courant number 1 the half node answers as an elastic bar does.
    pub(super) fn is_characteristic(&self) -> bool {
        self.node.is_characteristic(self.face.impedance)
    }

    /// The state just after t = 0 at an end of this kind, where the bar answers elastically and has the stress `stress` (Pa) before.
    pub(super) fn at_once(&self, condition: &EndCondition, stress: f64) -> EndState {
        let impedance = self.face.impedance;
        let force = -self.face.area * stress - impedance * self.face.velocity;
        let (model, start) = (ends::model(condition, self.face), Step { time: 0.0, dt: self.dt, displacement: 0.0 });
        let [force, velocity] = ends::at_once(model.as_ref(), &start, &Response { force, impedance });
        EndState { stress: -force / self.face.area, velocity: self.face.inward * velocity }
    }

    /// The state just after t = 0.
    pub(super) fn start_in(&mut self, state: EndState) {
        self.start = Some(state);
    }

    /// The log; empty where none is kept.
    pub(super) fn log(&self) -> &[EndSample] {
        self.log.as_deref().unwrap_or_default()
    }

    /// Starts the log anew.
    pub(super) fn clear_log(&mut self) {
        self.log.iter_mut().for_each(Vec::clear);
    }

    /// True where the end's velocity follows from what is there rather than from the stress, or its place matters: it takes the impulses of the
    /// grid filter. (The node of a stiff dashpot would answer them by as much the other way, step by step, for as long as the bar flows.)
    pub(super) fn is_held(&self) -> bool {
        self.resists || self.model.follows_place()
    }

    /// Impulse and work by the trapezoidal rule in the end's force: the form in which the staggered scheme balances
    /// momentum and energy to round-off. The first half step starts from the initial velocity.
    fn account(&mut self, previous: f64) {
        let half = 0.5 * self.dt;
        let is_first = self.means[0].is_nan();
        let impulse = if is_first { half * self.force } else { half * (previous + self.force) };
        self.impulse += self.face.inward * impulse;
        self.throughput += impulse.abs();
        self.work_on_node += impulse * self.node.before;
    }

    /// Velocity half a step after the current time, m/s.
    pub fn velocity_after(&self) -> f64 {
        self.face.inward * self.node.after
    }

    /// Velocity half a step before the current time, m/s.
    pub fn velocity_before(&self) -> f64 {
        self.face.inward * self.node.before
    }

    /// Stress and velocity at the current time.
    pub fn reading(&self) -> EndState {
        EndState { stress: self.stress(), velocity: self.velocity() }
    }

    /// Velocity at the current time, m/s. Where the end is suddenly made to move it is that before the jump.
    pub fn velocity(&self) -> f64 {
        let before = self.velocity_before() - self.face.inward * self.not_moved;
        if self.struck { before } else { 0.5 * (before + self.velocity_after()) }
    }

    /// Stress at the end at the current time, Pa. Where the end is suddenly made to move it is that before the jump, without the impulse
    /// that the half cell's mass takes up: that of the end cell where the end was held before, too.
    pub fn stress(&self) -> f64 {
        self.stress
    }

    /// Displacement at the current time, m.
    pub fn displacement(&self) -> f64 {
        self.face.inward * (self.displacement - self.dt * self.node.after)
    }

    /// Displacement after the step ahead, m.
    pub(super) fn displacement_ahead(&self) -> f64 {
        self.face.inward * self.displacement
    }

    /// Work done on the bar so far, J: what a body at the end lost, else force times displacement over the steps.
    pub fn work(&self) -> f64 {
        self.work
    }

    /// What of it is not in the node's motion and the bar, J: forces over the steps act on the node in halves. At a sudden change of the
    /// velocity by w it is some m w^2, of first order in the cell size, of either sign.
    pub fn in_transit(&self) -> f64 {
        self.work - self.work_on_node
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

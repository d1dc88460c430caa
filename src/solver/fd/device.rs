//! What happens at an end node of the staggered grid: half a cell's mass between the bar and whatever drives it.
//!
//! With outward normal n (-1 left, +1 right) the node obeys `m (v+ - v-)/dt = n A (sigma_end - sigma_cell)`, m being
//! half a cell's mass. Prescribed velocities enter by their exact mean over a step, so that the end is where it should
//! be after every step. Prescribed stresses enter by their exact mean over two steps: at Courant number 1 odd and even
//! steps drive two lattices that know nothing of each other, and so each of them gets the impulse that was asked for.

use super::ball::Ball;
use super::body::Striker;
use super::ripple;
use crate::bar::EndCondition;

/// An end of the bar and its node.
#[derive(Debug, Clone)]
pub struct Device {
    condition: EndCondition,
    /// Outward normal: -1 left, +1 right.
    normal: f64,
    /// dt A/m, m/s per Pa: 2 dt/(rho dx) times A over the end cell's area.
    gain: f64,
    /// Area of the end cell over that of the end: by which the cell's stress counts at the end; 1 but in a taper.
    cell_share: f64,
    /// A dt: impulse per stress, m^2 s.
    impulse_per_stress: f64,
    dt: f64,
    /// rho c0 of the end cell, and the velocity at which nothing is radiated.
    impedance: f64,
    rest_velocity: f64,
    /// Velocity half a step before and after the current time, m/s.
    before: f64,
    after: f64,
    /// Stress at the end at the current time, Pa, with the impulse of a sudden motion.
    reaction: f64,
    /// The same for the record, see [`Device::stress`].
    stress: f64,
    /// Stress in the latest step in which the end was held.
    held_stress: f64,
    displacement: f64,
    work: f64,
    impulse: f64,
    /// Sum of |impulse| of the steps, the scale for the momentum residual.
    throughput: f64,
    started: bool,
    /// The velocity is prescribed just now.
    held: bool,
    /// The bar has just broken off here.
    breaks: bool,
    /// The mass that strikes the end, where one does.
    striker: Option<Striker>,
    /// The ball, where there is one.
    ball: Option<Ball>,
    /// Taken by the ripple damping, J.
    damped: f64,
    /// Stress and velocity of every step, where they are asked for.
    log: Option<Vec<[f64; 2]>>,
}

/// What a step makes of an end.
struct Motion {
    velocity: f64,
    stress: f64,
    /// The velocity was prescribed, the stress is the reaction.
    held: bool,
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
    /// Initial velocity, m/s.
    pub velocity: f64,
}

impl Device {
    /// The device at an end with outward normal `normal` (-1 left, +1 right).
    pub fn new(condition: EndCondition, normal: f64, grid: EndGrid) -> Self {
        let striker = Striker::of(&condition);
        let ball = Ball::of(&condition, grid.velocity, normal, grid.dt);
        Self {
            condition,
            striker,
            ball,
            normal,
            gain: 2.0 * grid.dt / (grid.density * grid.dx) * (grid.area / grid.cell_area),
            cell_share: grid.cell_area / grid.area,
            impulse_per_stress: grid.area * grid.dt,
            dt: grid.dt,
            impedance: grid.impedance,
            rest_velocity: grid.velocity,
            before: grid.velocity,
            after: grid.velocity,
            reaction: 0.0,
            stress: 0.0,
            held_stress: 0.0,
            displacement: 0.0,
            work: 0.0,
            impulse: 0.0,
            throughput: 0.0,
            started: false,
            held: false,
            breaks: false,
            damped: 0.0,
            log: None,
        }
    }

    /// The node's velocity at t = 0, m/s, where nothing holds it.
    pub(super) fn start_with(&mut self, velocity: f64) {
        (self.before, self.after) = (velocity, velocity);
        self.displacement = self.dt * velocity;
    }

    /// Takes the node from half a step before `time` to half a step after it. `sigma_cell` is the stress at `time`
    /// in the end cell.
    pub fn advance(&mut self, time: f64, sigma_cell: f64) {
        self.advance_showing(time, sigma_cell, sigma_cell);
    }

    /// The same; `shown` is the stress of the end cell for the record.
    fn advance_showing(&mut self, time: f64, sigma_cell: f64, shown: f64) {
        let previous_stress = self.reaction;
        let sigma_cell = self.cell_share * sigma_cell;
        let motion = self.respond(time, sigma_cell);
        self.breaks = false;
        let struck = motion.held && (!self.held || self.jumps(time));
        self.stress = if struck { shown } else { motion.stress };
        if motion.held {
            self.held_stress = motion.stress;
        }
        (self.before, self.after) = (self.after, motion.velocity);
        (self.reaction, self.held) = (motion.stress, motion.held);
        if let Some(striker) = &mut self.striker {
            striker.advance(-self.normal * self.impulse_per_stress * motion.stress, self.dt);
        }
        if let Some(ball) = &mut self.ball {
            ball.advance(-self.reaction * self.impulse_per_stress / self.dt, self.after, self.dt);
        }
        self.account(previous_stress);
        self.displacement += self.dt * self.after;
    }

    /// The end moves this mass, kg, in place of half its cell's.
    pub(super) fn set_mass(&mut self, mass: f64) {
        self.gain = self.impulse_per_stress / mass;
    }

    /// Velocity change of the step around `time` if the bar gives that mass an impulse of `pull`, N s in +x.
    pub(super) fn answer(&self, time: f64, pull: f64) -> f64 {
        self.respond(time, self.stress_of(pull)).velocity - self.after
    }

    /// Takes that step. `sigma_cell` is the stress of the end cell, for the record.
    pub(super) fn advance_by(&mut self, time: f64, pull: f64, sigma_cell: f64) {
        self.advance_showing(time, self.stress_of(pull), sigma_cell);
    }

    /// Stress of a cell that gives the node this impulse in a step.
    fn stress_of(&self, pull: f64) -> f64 {
        -self.normal * pull / self.impulse_per_stress
    }

    /// True where a prescribed velocity jumps within a step of `time`.
    fn jumps(&self, time: f64) -> bool {
        let EndCondition::Velocity { history, .. } = &self.condition else { return false };
        let close = |t: f64| (t - time).abs() <= self.dt;
        history.time().windows(2).any(|pair| pair[0] == pair[1] && close(pair[0]))
    }

    /// The node's velocity after the step and the end's stress at its middle.
    fn respond(&self, time: f64, sigma_cell: f64) -> Motion {
        match &self.condition {
            EndCondition::Velocity { history, release } => {
                // Share of the two steps around `time` in which the end is still held.
                let held = release.map_or(1.0, |r| 0.5 * ((r - time) / self.dt + 1.0));
                if held < 1.0 {
                    return self.under_stress(held.max(0.0) * self.held_stress, sigma_cell);
                }
                self.moving(history.mean(time, time + self.dt), sigma_cell)
            }
            EndCondition::Stress { history } => {
                self.under_stress(history.mean(time - self.dt, time + self.dt), sigma_cell)
            }
            // As where a wall lets go, what pulled has done so for the first half of the step.
            EndCondition::Free if self.breaks => self.under_stress(0.5 * self.reaction, sigma_cell),
            EndCondition::Free => self.under_stress(0.0, sigma_cell),
            EndCondition::Fixed => self.moving(0.0, sigma_cell),
            EndCondition::Absorbing => self.radiating(sigma_cell),
            EndCondition::Wall { gap } => self.against_wall(*gap, sigma_cell),
            EndCondition::Striker { .. } => self.against_mass(sigma_cell),
            EndCondition::Ball { .. } => self.against_ball(sigma_cell),
            EndCondition::Spring { stiffness } => self.on_spring(*stiffness, sigma_cell),
        }
    }

    fn moving(&self, velocity: f64, sigma_cell: f64) -> Motion {
        let stress = sigma_cell + self.normal * (velocity - self.after) / self.gain;
        Motion { velocity, stress, held: true }
    }

    fn under_stress(&self, stress: f64, sigma_cell: f64) -> Motion {
        Motion { velocity: self.after + self.normal * self.gain * (stress - sigma_cell), stress, held: false }
    }

    /// `sigma_end` = -n Z (v - `v_rest`) with v the mean over the step: exact at Courant number 1.
    fn radiating(&self, sigma_cell: f64) -> Motion {
        let h = 0.5 * self.gain * self.impedance;
        let before = self.after - self.rest_velocity;
        let after = ((1.0 - h) * before - self.normal * self.gain * sigma_cell) / (1.0 + h);
        let stress = -self.normal * self.impedance * 0.5 * (before + after);
        Motion { velocity: after + self.rest_velocity, stress, held: false }
    }

    /// The wall takes up just the velocity that would carry the node into it; it never pulls.
    ///
    /// Where it lets go, it has pushed for the first half of the step. That half impulse is what the end needs to
    /// leave with the velocity of the wave that frees it; without it every second node would lag behind, and the
    /// bar would ring from cell to cell.
    fn against_wall(&self, gap: f64, sigma_cell: f64) -> Motion {
        let free = self.under_stress(0.0, sigma_cell);
        let limit = self.normal * (gap - self.normal * self.displacement) / self.dt;
        if self.normal * (free.velocity - limit) > 0.0 {
            return self.moving(limit, sigma_cell);
        }
        self.under_stress(if self.held { 0.5 * self.reaction } else { 0.0 }, sigma_cell)
    }

    /// The mass and the node exchange what takes both to one place at the end of the step, unless that is a pull.
    ///
    /// Where the mass touches a node that moves otherwise, the two go on together. The impulse that this takes is right to
    /// second order, what it takes from their energy (half the node's mass times the square of the difference) to first.
    fn against_mass(&self, sigma_cell: f64) -> Motion {
        let Some(striker) = &self.striker else { return self.under_stress(0.0, sigma_cell) };
        let free = self.under_stress(0.0, sigma_cell);
        let apart = (striker.place - self.displacement) / self.dt + striker.after - free.velocity;
        let stress = self.normal * apart / (self.gain + self.impulse_per_stress / striker.mass);
        if stress < 0.0 {
            let velocity = free.velocity + self.normal * self.gain * stress;
            return Motion { velocity, stress, held: true };
        }
        // As against a wall: it has pushed for the first half of the step in which it lets go.
        self.under_stress(if self.held { 0.5 * self.reaction } else { 0.0 }, sigma_cell)
    }

    /// The ball pushes with the mean of its force between the approaches a step before and a step after: stable for any
    /// stiffness, and exact in energy, see [`Ball`].
    fn against_ball(&self, sigma_cell: f64) -> Motion {
        let Some(ball) = &self.ball else { return self.under_stress(0.0, sigma_cell) };
        let free = self.under_stress(0.0, sigma_cell);
        let area = self.impulse_per_stress / self.dt;
        let force = ball.force(free.velocity, self.gain / area, self.dt);
        self.under_stress(-force / area, sigma_cell)
    }

    /// The force is -k times the mean `(u- + 2 u + u+)/4` of the displacements a step before, now and a step after: stable
    /// for any k, and exact in energy, see [`Device::body_energy`].
    fn on_spring(&self, stiffness: f64, sigma_cell: f64) -> Motion {
        let area = self.impulse_per_stress / self.dt;
        let stress_now = -self.normal * stiffness * self.displacement / area;
        // What the change of the velocity in this step adds, as a mass would: k dt^2/4 beside m = A dt/gain.
        let heavier = 1.0 + 0.25 * stiffness * self.dt * self.gain / area;
        let velocity = self.after + self.normal * self.gain * (stress_now - sigma_cell) / heavier;
        let stress = sigma_cell + self.normal * (velocity - self.after) / self.gain;
        Motion { velocity, stress, held: false }
    }

    /// Energy of the body at the end at the current time, J, in the form that the scheme conserves: `M V- V+/2` for a
    /// striker, with the contact's for a ball (see [`Ball`]), `k u^2/2 + k dt^2 (v- v+ - v0^2)/8` for a spring (v0: at the start), 0 without one.
    pub fn body_energy(&self) -> f64 {
        if let Some(striker) = &self.striker {
            return 0.5 * striker.mass * striker.before * striker.after;
        }
        if let Some(ball) = &self.ball {
            return ball.energy();
        }
        let EndCondition::Spring { stiffness } = self.condition else { return 0.0 };
        let stretch = self.displacement();
        let motion = self.before * self.after - self.rest_velocity * self.rest_velocity;
        0.5 * stiffness * (stretch * stretch + 0.25 * self.dt * self.dt * motion)
    }

    /// The striker's or ball's velocity at the current time, m/s, and its distance from the end, m, half a step later;
    /// for a ball that touches it, less than 0: the approach. None without one.
    pub fn striker(&self) -> Option<(f64, f64)> {
        if let Some(ball) = &self.ball {
            return Some((ball.velocity(), -ball.approach));
        }
        let striker = self.striker.as_ref()?;
        Some((0.5 * (striker.before + striker.after), self.normal * (striker.place - self.displacement)))
    }

    /// True where the end pulls the bar.
    pub(super) fn pulls(&self) -> bool {
        self.reaction > 0.0
    }

    /// The bar breaks off what is at its end, which is free from the next step on.
    pub(super) fn let_go(&mut self) {
        self.condition = EndCondition::Free;
        self.striker = None;
        self.ball = None;
        self.breaks = true;
    }

    /// The ripple damping changes the node's velocity, unless that is prescribed just now. `sigma_cell` is the stress of the
    /// end cell.
    pub(super) fn damp(&mut self, change: f64, sigma_cell: f64) {
        if change == 0.0 || self.is_held() {
            return;
        }
        let g = self.normal * self.gain * (self.reaction - self.cell_share * sigma_cell);
        let half_mass = 0.5 * self.impulse_per_stress / self.gain;
        self.damped += half_mass * ripple::node(g, change, &mut self.after);
        self.before += change;
        self.displacement += self.dt * change;
    }

    /// Energy that the ripple damping took from the node, J.
    pub(super) fn damped(&self) -> f64 {
        self.damped
    }

    /// Keeps a log from now on.
    pub(super) fn watch(&mut self) {
        self.log.get_or_insert_default();
    }

    /// Adds the current stress and velocity to the log.
    pub(super) fn note(&mut self) {
        let now = [self.stress(), self.velocity()];
        self.log.iter_mut().for_each(|log| log.push(now));
    }

    /// The log; empty where none is kept.
    pub(super) fn log(&self) -> &[[f64; 2]] {
        self.log.as_deref().unwrap_or_default()
    }

    /// Starts the log anew.
    pub(super) fn clear_log(&mut self) {
        self.log.iter_mut().for_each(Vec::clear);
    }

    /// True where the end's velocity is prescribed just now, or its place matters to a spring or a ball; false where it
    /// follows from the stress.
    pub(super) fn is_held(&self) -> bool {
        self.held || matches!(self.condition, EndCondition::Spring { .. } | EndCondition::Ball { .. })
    }

    /// Impulse and work by the trapezoidal rule in the end stress: the form in which the staggered scheme balances
    /// momentum and energy to round-off. The first half step starts from the initial velocity.
    fn account(&mut self, previous_stress: f64) {
        let half = 0.5 * self.normal * self.impulse_per_stress;
        let impulse = if self.started { half * (previous_stress + self.reaction) } else { half * self.reaction };
        self.started = true;
        self.impulse += impulse;
        self.throughput += impulse.abs();
        self.work += impulse * self.before;
    }

    /// Velocity half a step after the current time, m/s.
    pub fn velocity_after(&self) -> f64 {
        self.after
    }

    /// Velocity half a step before the current time, m/s.
    pub fn velocity_before(&self) -> f64 {
        self.before
    }

    /// Velocity at the current time, m/s.
    pub fn velocity(&self) -> f64 {
        0.5 * (self.before + self.after)
    }

    /// Stress at the end at the current time, Pa. In a step in which the end is suddenly made to move it is that of the
    /// end cell, without the impulse that the half cell's mass takes up.
    pub fn stress(&self) -> f64 {
        self.stress
    }

    /// Displacement at the current time, m.
    pub fn displacement(&self) -> f64 {
        self.displacement - self.dt * self.after
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

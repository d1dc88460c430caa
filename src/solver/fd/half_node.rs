//! Half a cell's mass at a face of the staggered grid: the bar's side of [`crate::bar::ends`] and [`crate::bar::joint`].
//!
//! With u the velocity into the bar and compression positive, a half node obeys `m (u+ - u-)/dt = P - p`, where m is half of the cell's
//! mass, p the force of its cell, and P the force on the face over the step from half a step before the current time to half a step after
//! it. An end or a joint exerts the force f over the step ahead, which starts at the current time and in which the face moves with u+. Each
//! f acts on the node in halves, P = (f- + f)/2, where f- is the force of the step before:
//!
//! ```text
//! f = q + Y u+        Y = 2 m/dt        q = 2 p - f- - Y u-
//! ```
//!
//! This is the elastic characteristic, exactly so at Courant number 1: Y is then the impedance, and q is what arrives at the face in the
//! step ahead. Walls, masses, springs and contacts need no other data of the grid. (If f acted in one piece, odd and even steps would drive
//! two uncoupled lattices, which would oscillate against each other for ever.)
//!
//! At smaller Courant numbers f may alternate about its mean without an effect on P; [`Impulses`] removes this alternation.

use serde::{Deserialize, Serialize};

use crate::bar::ends::Response;

/// Relative difference up to which two impedances count as equal.
const ROUNDING: f64 = 1e-9;

/// Node at a face, with half the mass of a cell.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct HalfNode {
    /// Velocity half a step before and after the current time, m/s, into the bar.
    pub before: f64,
    pub after: f64,
    /// m/dt, N s/m.
    pub impedance: f64,
    /// Section of the cell, m^2.
    pub area: f64,
}

impl HalfNode {
    /// Creates a half node that moves with `velocity` (m/s, into the bar). `mass` (kg) is half the mass of its cell, and `area` (m^2) the
    /// section of the cell.
    pub fn new(velocity: f64, mass: f64, area: f64, dt: f64) -> Self {
        Self { before: velocity, after: velocity, impedance: mass / dt, area }
    }

    /// Returns whether the half node is the characteristic of an elastic bar, as it is at Courant number 1. `impedance` is that of the
    /// bar's section, N s/m.
    pub fn is_characteristic(&self, impedance: f64) -> bool {
        (2.0 * self.impedance - impedance).abs() <= ROUNDING * impedance
    }

    /// Returns the response of the bar in the step ahead: the cell presses with the force `cell` (N), and f- is `previous_force` (N).
    pub fn response(&self, cell: f64, previous_force: f64) -> Response {
        let impedance = 2.0 * self.impedance;
        Response { force: 2.0 * cell - previous_force - impedance * self.after, impedance }
    }

    /// Returns u+ (m/s) under the force P (N); `cell` is the force of the cell (N).
    pub fn velocity_under_force(&self, force: f64, cell: f64) -> f64 {
        self.after + (force - cell) / self.impedance
    }

    /// Advances to the next step, with this velocity (m/s) after it.
    pub fn advance(&mut self, velocity: f64) {
        (self.before, self.after) = (self.after, velocity);
    }

    /// Corrects the velocity half a step before t = 0, after the node has been accelerated by half of the initial stress of its cell,
    /// `half` (Pa): it becomes the velocity from which a whole step under the initial stress would have started.
    pub fn start_under(&mut self, half: f64) {
        self.before -= self.area * half / self.impedance;
    }
}

/// Force that acts as f- in a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) enum PreviousForce {
    /// The force f of the step before.
    #[default]
    LastForce,
    /// The force of the cells, which is smaller.
    CellForce,
}

/// Forces f of the latest steps.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Impulses {
    /// Forces, N, the newest first.
    forces: [f64; 3],
    /// Force of the cells beside the node in the step before, N.
    cells: f64,
}

impl Impulses {
    /// Chooses f- for a step in which the cells' force is about `cells` (N).
    ///
    /// The force that stops a node at once is the elastic one, above what yielded cells can carry (`bounded`). As long as the cells' force
    /// grows, no wave has come back, and f- is at most the cells' force.
    pub fn choose(&self, cells: f64, bounded: bool) -> PreviousForce {
        let last = self.forces[0];
        let grows = bounded && cells.abs() >= self.cells.abs() && cells * last > 0.0;
        if grows && cells.abs() < last.abs() { PreviousForce::CellForce } else { PreviousForce::LastForce }
    }

    /// Returns f- (N), half of which acts in the step in which the cells' force is `cells` (N).
    pub fn previous_force(&self, cells: f64, previous_force: PreviousForce) -> f64 {
        match previous_force {
            PreviousForce::LastForce => self.forces[0],
            PreviousForce::CellForce => cells,
        }
    }

    /// Sets the force of the latest step, N.
    pub fn set_latest(&mut self, f: f64) {
        self.forces[0] = f;
    }

    /// Records the force `f` (N) of a step in which the half node is the characteristic, and returns it.
    pub fn record(&mut self, f: f64, cells: f64) -> f64 {
        *self = Self { forces: [f, self.forces[0], self.forces[1]], cells };
        f
    }

    /// Records the force `f` (N) of a step. If the last three changes alternate in sign, half of the smallest of them is taken back.
    /// Returns the impulse on the bar in the step per unit time (N): the mean of `f` and the force that is kept, corrected for the part of
    /// the previous force that was not passed on.
    pub fn record_damped(&mut self, f: f64, cells: f64, previous_force: PreviousForce) -> f64 {
        let previous_force = self.previous_force(cells, previous_force);
        let omitted = self.forces[0] - previous_force;
        let changes = [f - previous_force, previous_force - self.forces[1], self.forces[1] - self.forces[2]];
        let alternate = changes[0] * changes[1] < 0.0 && changes[1] * changes[2] < 0.0;
        let ringing = if alternate { changes.iter().fold(f64::INFINITY, |least, c| least.min(c.abs())) } else { 0.0 };
        let kept = f - 0.5 * ringing.copysign(changes[0]);
        *self = Self { forces: [kept, previous_force, self.forces[1]], cells };
        0.5 * (f + kept - omitted)
    }
}

//! Half a cell's mass at a face of the staggered grid: the bar's side of [`crate::bar::ends`] and [`crate::bar::joint`].
//!
//! With u the velocity into the bar and pressures positive a half node obeys `m (u+ - u-)/dt = P - p`, m being half a cell's mass, p the
//! force of its cell and P that on the face over the step from half a step before now to half a step after. An end or a joint gives
//! the force f over the step ahead, from now on, in which u+ moves the face. Each f acts on the node in halves, P = (f- + f)/2:
//!
//! ```text
//! f = q + Y u+        Y = 2 m/dt        q = 2 p - f- - Y u-
//! ```
//!
//! That is the elastic characteristic, at Courant number 1 exactly: Y is then the impedance, and q what arrives at the face in the
//! step ahead. Walls, masses, springs and contacts need to know no more of the grid. (With f in one piece, odd and even steps would
//! drive two lattices that know nothing of each other, and ring against each other for ever.)
//!
//! At smaller Courant numbers f may alternate about its mean without an effect on P; [`Impulses`] takes that out of it.

use serde::{Deserialize, Serialize};

use crate::bar::ends::Response;

/// Part by which two impedances that are equal may differ.
const ROUNDING: f64 = 1e-9;

/// A half node.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct HalfNode {
    /// Velocity half a step before and after the current time, m/s, into the bar.
    pub before: f64,
    pub after: f64,
    /// m/dt, N s/m.
    pub impedance: f64,
    /// Section of its cell, m^2.
    pub area: f64,
}

impl HalfNode {
    /// That moves with `velocity` (m/s, into the bar); `mass` (kg) is half of its cell's, `area` (m^2) the cell's section.
    pub fn new(velocity: f64, mass: f64, area: f64, dt: f64) -> Self {
        Self { before: velocity, after: velocity, impedance: mass / dt, area }
    }

    /// At Courant number 1 the half node of a cell is the characteristic of an elastic bar; `impedance` is that of its section, N s/m.
    pub fn is_characteristic(&self, impedance: f64) -> bool {
        (2.0 * self.impedance - impedance).abs() <= ROUNDING * impedance
    }

    /// The bar's answer in the step ahead: its cell presses with the force `cell` (N), and f- is `passed_on` (N).
    pub fn response(&self, cell: f64, passed_on: f64) -> Response {
        let impedance = 2.0 * self.impedance;
        Response { force: 2.0 * cell - passed_on - impedance * self.after, impedance }
    }

    /// u+ under the force P (N), with `cell` that of its cell.
    pub fn pushed(&self, force: f64, cell: f64) -> f64 {
        self.after + (force - cell) / self.impedance
    }

    /// Goes on to the next step with that velocity.
    pub fn move_on(&mut self, velocity: f64) {
        (self.before, self.after) = (self.after, velocity);
    }

    /// The node has met half of the initial stress of its cell, `half` (Pa): its velocity half a step before t = 0 becomes that from
    /// which a whole step of it would have begun.
    pub fn start_under(&mut self, half: f64) {
        self.before -= self.area * half / self.impedance;
    }
}

/// What a step takes over from the one before as f-.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) enum PassedOn {
    /// The force f of that step.
    #[default]
    LastForce,
    /// The force of the cells, which is less.
    CellForce,
}

/// The forces f of the latest steps.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Impulses {
    /// N, the newest first.
    forces: [f64; 3],
    /// Force of the cells beside the node in the step before, N.
    cells: f64,
}

impl Impulses {
    /// What is f- in a step in which the cells' force is about `cells` (N).
    ///
    /// What stops a node at once is the elastic answer, above what cells that have yielded can carry (`bounded`): if their force is still
    /// growing no wave has come back, and it is no more than that.
    pub fn choose(&self, cells: f64, bounded: bool) -> PassedOn {
        let last = self.forces[0];
        let grows = bounded && cells.abs() >= self.cells.abs() && cells * last > 0.0;
        if grows && cells.abs() < last.abs() { PassedOn::CellForce } else { PassedOn::LastForce }
    }

    /// f-, the half of which acts in the step in which the cells' force is `cells` (N).
    pub fn passed_on(&self, cells: f64, passed_on: PassedOn) -> f64 {
        match passed_on {
            PassedOn::LastForce => self.forces[0],
            PassedOn::CellForce => cells,
        }
    }

    /// The force of the latest step was this, N.
    pub fn correct(&mut self, f: f64) {
        self.forces[0] = f;
    }

    /// Takes the force of a step in which the half node is the characteristic.
    pub fn take(&mut self, f: f64, cells: f64) -> f64 {
        *self = Self { forces: [f, self.forces[0], self.forces[1]], cells };
        f
    }

    /// Takes the force of a step. Where the last three changes alternate in sign, half of the least of them is taken back. Returns what
    /// the step gives to the bar, per time: the mean of the force asked for and the one that is passed on, with what of the step before
    /// was not.
    pub fn push(&mut self, f: f64, cells: f64, passed_on: PassedOn) -> f64 {
        let passed_on = self.passed_on(cells, passed_on);
        let not_passed_on = self.forces[0] - passed_on;
        let changes = [f - passed_on, passed_on - self.forces[1], self.forces[1] - self.forces[2]];
        let alternate = changes[0] * changes[1] < 0.0 && changes[1] * changes[2] < 0.0;
        let ringing = if alternate { changes.iter().fold(f64::INFINITY, |least, c| least.min(c.abs())) } else { 0.0 };
        let kept = f - 0.5 * ringing.copysign(changes[0]);
        *self = Self { forces: [kept, passed_on, self.forces[1]], cells };
        0.5 * (f + kept - not_passed_on)
    }
}

//! Interface of the recorders to a simulated bar, independent of the solver.

use serde::{Deserialize, Serialize};

use super::Field;
use crate::bar::joint::Pressed;
use crate::law::rupture::Rupture;
use crate::solver::{EndState, Energies};

/// Simulated bar at its current time.
pub trait View {
    /// Sample places, in the form in which this solver reads them.
    type Places: ?Sized;

    /// Returns the current time, s.
    fn time(&self) -> f64;

    /// Writes a field at every place into `out` (one entry per place).
    fn sample(&self, field: Field, places: &Self::Places, out: &mut [f64]);

    /// Calls `each` with the centre (m) and the strain of every part of the bar that has a state of its own: a cell, or a section between two fronts.
    fn strains(&self, each: &mut dyn FnMut(f64, f64));

    /// Returns the current state of the left and the right end.
    fn ends(&self) -> [EndState; 2];

    /// Returns the velocity of the striker at the left and the right end, m/s; `None` without a striker.
    fn strikers(&self) -> [Option<f64>; 2] {
        [None; 2]
    }

    /// Returns the joints that can open; empty unless the solver advances in time steps.
    fn contacts(&self) -> Vec<ContactReading> {
        Vec::new()
    }

    /// Returns the fractures of the bar so far, in order of time.
    fn ruptures(&self) -> &[Rupture] {
        &[]
    }

    /// Returns the initial energy and momentum; called once, before the first step.
    fn start(&self) -> Start;

    /// Returns the energies and momentum in the bar, and what its ends have contributed, at the current time.
    fn account(&self) -> Account;
}

/// Reading of a joint that can open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactReading {
    /// Index of the segment to the left of the joint, counted from 0.
    pub joint: usize,
    /// True if the joint transmits a force.
    pub presses: bool,
    /// Force history of the faces so far.
    pub pressed: Pressed,
}

/// State of a bar before its first step, with its initial velocities and stresses.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Kinetic and strain energy, J (per m^2 if the scene gives no area, as for all quantities of this struct).
    pub energy: f64,
    /// Momentum, N s, positive in +x.
    pub momentum: f64,
    /// Mass, kg.
    pub mass: f64,
}

/// Energies (J) and momentum (N s) of a bar at one time, and the contributions of its ends since the start.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Account {
    /// Energies and momentum in the bar.
    pub energies: Energies,
    /// Work done on the bar by the left and the right end.
    pub work: [f64; 2],
    /// Impulse given to the bar by the left and the right end, positive in +x.
    pub impulse: [f64; 2],
    /// Impulse of distributed forces: external damping and a foundation.
    pub impulse_along: f64,
    /// Momentum transferred through the bar: the scale of the momentum residual.
    pub momentum_scale: f64,
}

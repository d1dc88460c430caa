//! Access of the recorders to a simulated bar, independent of the solver.

use serde::{Deserialize, Serialize};

use super::Field;
use crate::bar::joint::Pressed;
use crate::law::rupture::Rupture;
use crate::solver::{EndState, Energies};

/// A simulated bar at its current time.
pub trait View {
    /// Sample places in the form in which this solver reads them.
    type Places: ?Sized;

    /// Time, s.
    fn time(&self) -> f64;

    /// A field at every place, into `out` (one entry a place).
    fn sample(&self, field: Field, places: &Self::Places, out: &mut [f64]);

    /// Passes on the centre (m) and the strain of every part of the bar with a state of its own: cells, or what lies between fronts.
    fn strains(&self, each: &mut dyn FnMut(f64, f64));

    /// The left and the right end now.
    fn ends(&self) -> [EndState; 2];

    /// Velocity of the striker at the left and the right end, m/s; none where there is none.
    fn strikers(&self) -> [Option<f64>; 2] {
        [None; 2]
    }

    /// The joints that can open, if the solver advances in time steps.
    fn contacts(&self) -> Vec<ContactReading> {
        Vec::new()
    }

    /// Where and when the bar broke so far, in order of time.
    fn ruptures(&self) -> &[Rupture] {
        &[]
    }

    /// The initial energy and momentum; called once, before the first step.
    fn start(&self) -> Start;

    /// What is in the bar and what came in through its ends, now.
    fn account(&self) -> Account;
}

/// A joint that can open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactReading {
    /// Behind this segment, counted from 0.
    pub joint: usize,
    /// A force passes.
    pub presses: bool,
    /// What the faces carried.
    pub pressed: Pressed,
}

/// A bar before its first step, with its initial velocities and stresses.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Of motion and strain, J (per m^2 where the scene gives no area), like all energies here.
    pub energy: f64,
    /// N s, positive in +x.
    pub momentum: f64,
    /// kg.
    pub mass: f64,
}

/// Energies (J) and momentum (N s) of a bar at a moment, and what its ends gave to it since the start.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Account {
    /// What is in the bar.
    pub energies: Energies,
    /// Work of the left and the right end.
    pub work: [f64; 2],
    /// Impulse of the left and the right end, positive in +x.
    pub impulse: [f64; 2],
    /// Impulse of distributed forces: external damping and a foundation.
    pub impulse_along: f64,
    /// Momentum transferred through the bar: the scale of the momentum residual.
    pub momentum_scale: f64,
}

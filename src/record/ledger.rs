//! The account of momentum and energy that every run keeps.

use super::LedgerRow;
use crate::solver::fd::{Energies, Leapfrog};

/// Compares what is in the bar with what came in through its ends.
#[derive(Debug, Clone)]
pub struct Ledger {
    initial: Energies,
    /// Momentum of all nodes as if they moved one way at the start: the scale where opposing parts cancel.
    initial_momentum: f64,
    worst_energy: f64,
    worst_momentum: f64,
}

impl Ledger {
    /// Opens the account of a bar at t = 0.
    pub fn new(bar: &Leapfrog) -> Self {
        let initial = bar.initial();
        Self {
            initial,
            initial_momentum: (2.0 * initial.kinetic * bar.mass()).sqrt(),
            worst_energy: 0.0,
            worst_momentum: 0.0,
        }
    }

    /// The account at the current time.
    pub fn row(&mut self, bar: &Leapfrog) -> LedgerRow {
        let now = bar.energies();
        let (left, right) = (bar.left(), bar.right());
        let put_in = self.initial.kinetic + left.work() + right.work();
        let energy_scale = self.initial.kinetic.max(left.work().abs()).max(right.work().abs()).max(now.total());
        let residual = relative(now.total() - put_in, energy_scale);
        let impulse = left.impulse() + right.impulse();
        let momentum_scale = self.initial_momentum.max(left.throughput() + right.throughput());
        let missing = relative(now.momentum - self.initial.momentum - impulse, momentum_scale);
        self.worst_energy = self.worst_energy.max(residual.abs());
        self.worst_momentum = self.worst_momentum.max(missing.abs());
        LedgerRow {
            time: bar.time(),
            kinetic: now.kinetic,
            elastic: now.elastic,
            plastic: now.plastic,
            viscous: now.viscous,
            work_left: left.work(),
            work_right: right.work(),
            momentum: now.momentum,
            impulse,
            residual,
        }
    }

    /// Largest relative energy residual so far.
    pub fn worst_energy(&self) -> f64 {
        self.worst_energy
    }

    /// Largest relative momentum residual so far.
    pub fn worst_momentum(&self) -> f64 {
        self.worst_momentum
    }
}

fn relative(missing: f64, scale: f64) -> f64 {
    if missing == 0.0 { 0.0 } else { missing / scale }
}

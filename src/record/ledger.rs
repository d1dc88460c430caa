//! Balance of momentum and energy of a run.

use serde::{Deserialize, Serialize};

use super::{Account, LedgerRow, Start, View};
use crate::snapshot::{self, Snapshot, pack, unpack};
use crate::solver::Energies;

/// Comparison of the energy and momentum in the bar with what came in through its ends.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Ledger {
    start: Start,
    /// Factor of the recorded momenta: 1, or in torsion the radius, m, which turns them into angular momenta.
    arm: f64,
    /// Momentum transferred through the bar so far. It starts at sqrt(2 E m), an upper bound of the sum of the
    /// magnitudes of the momenta of the bar's parts, which remains a scale if these cancel.
    momentum_scale: f64,
    /// Largest energy that was in the bar or came in through an end so far, J. All of it may leave again, up to rounding.
    energy_scale: f64,
    /// Initial energy or largest work of an end so far, J. Unlike the sum of the energy columns, it does not grow with energy that the method adds.
    supplied: f64,
    worst_energy: f64,
    worst_momentum: f64,
    largest_energy_gain: f64,
}

impl Ledger {
    /// Opens the ledger of a bar at t = 0.
    pub fn new(bar: &impl View) -> Self {
        let start = bar.start();
        Self {
            start,
            arm: 1.0,
            momentum_scale: (2.0 * start.energy * start.mass).sqrt(),
            energy_scale: start.energy,
            supplied: start.energy,
            worst_energy: 0.0,
            worst_momentum: 0.0,
            largest_energy_gain: 0.0,
        }
    }

    /// Converts momenta into angular momenta, for a bar in torsion of radius `arm`, m.
    #[must_use]
    pub fn with_arm(self, arm: f64) -> Self {
        Self { arm, ..self }
    }

    /// Returns the row of the current time.
    pub fn row(&mut self, bar: &impl View) -> LedgerRow {
        let now: Account = bar.account();
        let ([left, right], impulse) = (now.work, now.impulse[0] + now.impulse[1] + now.impulse_along);
        let put_in = self.start.energy + left + right;
        let held: f64 = now.energies.values().iter().map(|energy| energy.abs()).sum();
        self.supplied = self.supplied.max(left.abs()).max(right.abs());
        self.energy_scale = self.energy_scale.max(self.supplied).max(held);
        let residual = relative(now.energies.total() - put_in, self.energy_scale);
        self.momentum_scale = self.momentum_scale.max(now.momentum_scale);
        let missing = relative(now.energies.momentum - self.start.momentum - impulse, self.momentum_scale);
        self.worst_energy = self.worst_energy.max(residual.abs());
        self.worst_momentum = self.worst_momentum.max(missing.abs());
        self.largest_energy_gain = self.largest_energy_gain.max(-now.energies.numerical);
        LedgerRow {
            time: bar.time(),
            energies: Energies { momentum: self.arm * now.energies.momentum, ..now.energies },
            work_left: left,
            work_right: right,
            impulse: self.arm * impulse,
            residual,
        }
    }

    /// Returns the largest relative energy residual so far.
    pub fn worst_energy(&self) -> f64 {
        self.worst_energy
    }

    /// Returns the largest energy that the method itself has added to the bar so far, relative to the largest supplied
    /// energy up to now: while a load starts, both are small. 0 if the method has only dissipated energy.
    pub fn largest_energy_gain(&self) -> f64 {
        relative(self.largest_energy_gain, self.supplied)
    }

    /// Returns the largest relative momentum residual so far.
    pub fn worst_momentum(&self) -> f64 {
        self.worst_momentum
    }
}

impl Snapshot for Ledger {
    fn save(&self) -> snapshot::Result<Vec<u8>> {
        pack(self)
    }

    fn restore(&mut self, saved: &[u8]) -> snapshot::Result<()> {
        *self = unpack(saved)?;
        Ok(())
    }
}

fn relative(missing: f64, scale: f64) -> f64 {
    if missing == 0.0 { 0.0 } else { missing / scale }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Field;
    use crate::solver::EndState;

    /// Bar with an initial energy of 1 J, its current energies, and the work of its left end, J.
    struct Bar(Energies, f64);

    impl View for Bar {
        type Places = ();

        fn time(&self) -> f64 {
            0.0
        }

        fn sample(&self, _: Field, (): &(), _: &mut [f64]) {}

        fn strains(&self, _: &mut dyn FnMut(f64, f64)) {}

        fn ends(&self) -> [EndState; 2] {
            [EndState::default(); 2]
        }

        fn start(&self) -> Start {
            Start { energy: 1.0, momentum: 0.0, mass: 1.0 }
        }

        fn account(&self) -> Account {
            Account { energies: self.0, work: [self.1, 0.0], ..Account::default() }
        }
    }

    /// Energy added by the method is relative to the energy supplied to the bar, not to the sum of the columns.
    #[test]
    fn energy_from_the_method_is_a_part_of_what_the_bar_was_supplied_with() {
        let mut bar = Bar(Energies { kinetic: 1.0, ..Energies::default() }, 0.0);
        let mut ledger = Ledger::new(&bar);
        ledger.row(&bar);
        assert_eq!(ledger.largest_energy_gain(), 0.0);
        bar.0 = Energies { elastic: 90.0, half_step: -84.0, numerical: -5.0, ..Energies::default() };
        assert_eq!(ledger.row(&bar).residual, 0.0);
        assert_eq!(ledger.largest_energy_gain(), 5.0);
        // The energy added at the start is small compared with the energy supplied by the end.
        bar.0 = Energies { elastic: 96.0, half_step: -92.0, ..Energies::default() };
        bar.1 = 500.0;
        ledger.row(&bar);
        assert_eq!(ledger.largest_energy_gain(), 0.01);
    }
}

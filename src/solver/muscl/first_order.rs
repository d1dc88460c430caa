//! The cells without slopes.

use super::block::{Block, Stage};
use super::history::{Stiffenings, passed};
use super::part::Part;

impl Block {
    /// How many stiffening knots of its curve a cell has passed. Hardening tells that, not the stress: a cell that unloads, through
    /// zero stress or not, passes none.
    fn stiffenings(&self, part: &Part, i: usize) -> Stiffenings {
        if let Some(history) = self.histories.get(i).filter(|history| !history.is_unknown()) {
            return history.passed;
        }
        if part.path_independent {
            let z = self.e_equivalent_strain(part, i);
            return passed(part, [z, -z]);
        }
        let yielded = self.stage == Stage::Plastic;
        passed(part, [if yielded { part.law.law.accumulated(&self.state, i) } else { 0.0 }; 2])
    }

    /// True where a cell has no slopes: where a stiffening knot of the curve lies between it and one of the two next on either side, in a
    /// shock or next to it; where the scheme has given energy, or next to there.
    pub fn is_first_order(&self, part: &Part, i: usize) -> bool {
        let passed = |i| self.stiffenings(part, i);
        let in_shock = || (i - 2..i + 2).any(|i| passed(i) != passed(i + 1));
        self.owes_near(part, i) || (part.stiffens.is_some() && in_shock())
    }

    /// [`Self::is_first_order`] for all cells but the two next to each end, into `flat`, and which of these are in a shock or next to it;
    /// `changes` is room for as many.
    pub fn find_first_order(&self, part: &Part, changes: &mut [bool], in_shock: &mut [bool], flat: &mut [bool]) {
        let row = self.sigma.len();
        if part.stiffens.is_some() {
            let mut before = self.stiffenings(part, 0);
            for (i, change) in (1..row).zip(changes.iter_mut()) {
                let passed = self.stiffenings(part, i);
                *change = passed != before;
                before = passed;
            }
            for (in_shock, near) in in_shock[2..row - 2].iter_mut().zip(changes[..row - 1].windows(4)) {
                *in_shock = near[0] | near[1] | near[2] | near[3];
            }
            flat[2..row - 2].copy_from_slice(&in_shock[2..row - 2]);
        }
        if part.most_energy_defect.is_some() {
            (2..row - 2).for_each(|i| flat[i] |= self.owes_near(part, i));
        }
    }
}

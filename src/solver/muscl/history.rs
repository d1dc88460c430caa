//! What a cell's history tells of it, which holds until the cell flows again.

use super::block::{Block, Stage};
use super::part::Part;

/// How many stiffening knots of its curve a cell has passed, in tension and compression.
pub(super) type Stiffenings = [u32; 2];

/// What makes an elastic range that a stress was just within no smaller: rounding.
pub(super) const WITHIN: f64 = 1e-12;

/// The history of a cell with its own past.
#[derive(Debug, Clone, Copy)]
pub(super) struct History {
    /// Elastic range of the stress, Pa; not a number until it is known.
    low: f64,
    high: f64,
    passed: Stiffenings,
}

impl History {
    /// The cell has flowed, or is another one.
    pub const UNKNOWN: Self = Self { low: f64::NAN, high: f64::NAN, passed: [0; 2] };

    /// The cell comes to this stress (Pa) elastically.
    pub fn contains(&self, stress: f64) -> bool {
        let rounding = WITHIN * (self.high - self.low);
        self.low - rounding <= stress && stress <= self.high + rounding
    }

    /// sense * stress at which the cell starts to flow, Pa.
    pub fn limit(&self, sense: f64) -> f64 {
        if sense < 0.0 { -self.low } else { self.high }
    }
}

impl Block {
    /// Brings the histories of a yielded block's cells up to date, where these have a past of their own.
    pub fn update_histories(&mut self, part: &Part) {
        self.histories.resize(self.sigma.len(), History::UNKNOWN);
        for i in 0..self.sigma.len() {
            if self.histories[i].low.is_nan() {
                self.histories[i] = self.history(part, i);
            }
        }
    }

    fn history(&self, part: &Part, i: usize) -> History {
        let law = part.law.law.as_ref();
        let (accumulated, back) = (law.accumulated(&self.state, i), law.back_stress(&self.state, i));
        let [high, low] = [1.0, -1.0].map(|sense| sense * part.faces.limit(accumulated, back, sense));
        History { low, high, passed: self.stiffenings(part, i) }
    }

    /// How many stiffening knots of its curve a cell has passed. Hardening tells that, not the stress: a cell that unloads, through
    /// zero stress or not, passes none.
    fn stiffenings(&self, part: &Part, i: usize) -> Stiffenings {
        let Some(knots) = &part.stiffens else { return [0; 2] };
        let along = if part.path_independent {
            let z = self.e_equivalent_strain(part, i);
            [z, -z]
        } else if self.stage == Stage::Plastic {
            [part.law.law.accumulated(&self.state, i); 2]
        } else {
            [0.0; 2]
        };
        [0, 1].map(|side| knots[side].iter().take_while(|&&knot| knot < along[side]).count() as u32)
    }

    /// [`Self::stiffenings`] of a yielded block whose histories are up to date.
    fn known_stiffenings(&self, part: &Part, i: usize) -> Stiffenings {
        if part.path_independent { self.stiffenings(part, i) } else { self.histories[i].passed }
    }

    /// True where a cell has no slopes: where a stiffening knot of the curve lies between it and one of the two next on either side, in a
    /// shock or next to it; where the scheme has given energy, or next to there.
    pub fn is_first_order(&self, part: &Part, i: usize) -> bool {
        let passed = |i| self.stiffenings(part, i);
        let in_shock = || (i - 2..i + 2).any(|i| passed(i) != passed(i + 1));
        self.owes_near(part, i) || (part.stiffens.is_some() && in_shock())
    }

    /// [`Self::is_first_order`] for all cells of a yielded block but the two next to each end, into `flat`; `changes` is room for as many.
    pub fn find_first_order(&self, part: &Part, changes: &mut [bool], flat: &mut [bool]) {
        let row = self.sigma.len();
        if part.stiffens.is_some() {
            let mut before = self.known_stiffenings(part, 0);
            for (i, change) in (1..row).zip(changes.iter_mut()) {
                let passed = self.known_stiffenings(part, i);
                *change = passed != before;
                before = passed;
            }
            for (flat, near) in flat[2..row - 2].iter_mut().zip(changes[..row - 1].windows(4)) {
                *flat = near[0] | near[1] | near[2] | near[3];
            }
        }
        if part.most_energy_defect.is_some() {
            (2..row - 2).for_each(|i| flat[i] |= self.owes_near(part, i));
        }
    }
}

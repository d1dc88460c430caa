//! Cells without slopes.

use std::ops::Range;

use super::block::{Block, GHOSTS, NEARBY, Stage};
use super::history::{History, Stiffenings, passed};
use super::part::Part;

/// Fraction of the elastic limit by which the strain must have reversed.
const REVERSED: f64 = 0.25;

impl Block {
    /// Returns how far a cell has advanced along its curve in tension and compression, Pa, as [`Part::stiffens`] counts. The measure is hardening,
    /// not stress: a cell that unloads, through zero stress or not, passes no knot.
    fn along(&self, part: &Part, i: usize) -> [f64; 2] {
        if part.path_independent {
            let z = self.e_equivalent_strain(part, i);
            return [z, -z];
        }
        let yielded = self.stage == Stage::Plastic;
        [if yielded { part.law.law.accumulated(&self.state, i) } else { 0.0 }; 2]
    }

    /// Returns the derived history of a cell; `None` while it is unknown.
    fn history(&self, i: usize) -> Option<&History> {
        self.histories.get(i).filter(|history| !history.is_unknown())
    }

    /// Number of stiffening knots of its curve that a cell has passed.
    fn stiffenings(&self, part: &Part, i: usize) -> Stiffenings {
        self.history(i).map_or_else(|| passed(part, self.along(part, i)), |history| history.passed)
    }

    /// Returns whether one of these cells has reached a level or falling part of its curve.
    fn come_to_level(&self, part: &Part, mut cells: Range<usize>) -> bool {
        cells.any(|i| self.history(i).map_or_else(|| part.is_level(self.along(part, i)), |history| history.is_level))
    }

    /// Returns whether slopes gave energy to a cell or a neighbour, near a cell that has reached a level or falling part of its curve. Elsewhere the
    /// scheme dissipates that energy again, and fronts without slopes would be spread as by a first-order scheme.
    fn is_level_and_owes(&self, part: &Part, i: usize) -> bool {
        self.has_energy_defect_near(part, i) && self.come_to_level(part, self.around(i))
    }

    /// Returns whether strains of these cells lie beyond the elastic limit in one sense and extend into the other: a shock that reverses the strain,
    /// where the curve is followed both ways.
    fn reverse(&self, part: &Part, cells: Range<usize>) -> bool {
        let [mut least, mut most] = [0.0_f64; 2];
        for i in cells {
            let z = self.e_equivalent_strain(part, i);
            (least, most) = (least.min(z), most.max(z));
        }
        let (further, other) = if most > -least { (most, -least) } else { (-least, most) };
        further > part.limit && other > REVERSED * part.limit
    }

    /// Returns the cells of the bar within [`NEARBY`] of cell `i`.
    fn around(&self, i: usize) -> Range<usize> {
        let [left, right] = self.outer.map(|outer| if outer.is_some() { GHOSTS } else { 0 });
        left.max(i.saturating_sub(NEARBY))..(self.sigma.len() - right).min(i + NEARBY + 1)
    }

    /// Returns whether a cell has no slopes. This is so if a stiffening knot of the curve lies between any of the cells within two of it, in a shock
    /// or next to one; near a shock that reverses the strain; and where slopes have given energy, or next to there.
    pub fn is_first_order(&self, part: &Part, i: usize) -> bool {
        let passed = |i| self.stiffenings(part, i);
        let in_shock = || (i - 2..i + 2).any(|i| passed(i) != passed(i + 1));
        self.is_level_and_owes(part, i)
            || (part.stiffens.is_some() && in_shock())
            || (part.path_independent && self.reverse(part, self.around(i)))
    }

    /// Evaluates [`Self::is_first_order`] for all cells except two at each end, into `flat`, and whether they are in a shock or next to one, into
    /// `in_shock`. `changes` is scratch of the same length.
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
        let some = |sense: f64| self.sigma.iter().any(|stress| sense * stress > 0.0);
        if part.path_independent && some(1.0) && some(-1.0) && self.reverse(part, 0..row) {
            (2..row - 2).for_each(|i| flat[i] |= self.reverse(part, self.around(i)));
        }
        if part.most_energy_defect.is_some() && self.come_to_level(part, 0..row) {
            (2..row - 2).for_each(|i| flat[i] |= self.is_level_and_owes(part, i));
        }
    }
}

//! Quantities derived from the history of a cell, valid until the cell flows again.

use super::part::Part;

/// Number of stiffening knots of its curve that a cell has passed, in tension and compression.
pub(super) type Stiffenings = [u32; 2];

/// Relative tolerance for rounding at the limits of the elastic range.
pub(super) const WITHIN: f64 = 1e-12;

/// Fraction of the elastic range by which a stress must be inside it to count as safely elastic.
const INSIDE: f64 = 1e-9;

/// Derived history of a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct History {
    /// Elastic range of the stress, Pa; NaN while it is unknown.
    low: f64,
    high: f64,
    /// Lines of the curve in tension and compression on which these limits lie.
    lines: [usize; 2],
    pub passed: Stiffenings,
    /// Whether the cell has reached a level or falling part of its curve.
    pub is_level: bool,
}

impl History {
    /// Unknown history: the cell has flowed since, or its ghost copy was overwritten.
    pub const UNKNOWN: Self = Self { low: f64::NAN, high: f64::NAN, lines: [0; 2], passed: [0; 2], is_level: false };

    /// Derives the history of cell `i` of a row from its law state.
    pub fn of(part: &Part, state: &[f64], i: usize) -> Self {
        let law = part.law.law.as_ref();
        let (accumulated, back) = (law.accumulated(state, i), law.back_stress(state, i));
        let [(tension, high), (compression, low)] = part.faces.limits(accumulated, back);
        let along = [accumulated; 2];
        let (passed, is_level) = (passed(part, along), part.is_level(along));
        Self { low: -low, high, lines: [tension, compression], passed, is_level }
    }

    pub fn is_unknown(&self) -> bool {
        self.low.is_nan()
    }

    /// Returns whether the cell reaches this stress (Pa) elastically.
    pub fn contains(&self, stress: f64) -> bool {
        // A curve may never leave its elastic line in one sense.
        let width = self.high - self.low;
        let rounding = WITHIN * if width.is_finite() { width } else { self.high.abs().min(self.low.abs()) };
        self.low - rounding <= stress && stress <= self.high + rounding
    }

    /// Same, except for stresses near the limits, so that the law does not flow either.
    fn contains_safely(&self, stress: f64) -> bool {
        let near = INSIDE * (self.high - self.low);
        self.low + near <= stress && stress <= self.high - near
    }

    /// Returns sense * stress at which the cell starts to flow (Pa), and the line of the curve on which that point lies.
    pub fn limit(&self, sense: f64) -> (f64, usize) {
        if sense < 0.0 { (-self.low, self.lines[1]) } else { (self.high, self.lines[0]) }
    }
}

/// Returns whether histories are known and no cell of a row comes near the limits of its elastic range: then every law only adds the increments (Pa).
pub(super) fn stay_elastic(histories: &[History], sigma: &[f64], increment: &[f64]) -> bool {
    let after = sigma.iter().zip(increment).map(|(sigma, increment)| sigma + increment);
    !histories.is_empty() && histories.iter().zip(after).all(|(history, stress)| history.contains_safely(stress))
}

/// Returns the number of stiffening knots passed for these values (Pa) of the quantity that [`Part::stiffens`] counts.
pub(super) fn passed(part: &Part, along: [f64; 2]) -> Stiffenings {
    let Some(knots) = &part.stiffens else { return [0; 2] };
    [0, 1].map(|side| knots[side].iter().take_while(|&&knot| knot < along[side]).count() as u32)
}

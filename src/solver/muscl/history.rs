//! What a cell's history tells of it, which holds until the cell flows again.

use super::part::Part;

/// How many stiffening knots of its curve a cell has passed, in tension and compression.
pub(super) type Stiffenings = [u32; 2];

/// What makes an elastic range that a stress was just within no smaller: rounding.
pub(super) const WITHIN: f64 = 1e-12;

/// Part of its elastic range by which a stress is inside it whatever rounding says.
const INSIDE: f64 = 1e-9;

/// The history of a cell with its own past.
#[derive(Debug, Clone, Copy)]
pub(super) struct History {
    /// Elastic range of the stress, Pa; not a number until it is known.
    low: f64,
    high: f64,
    /// The lines of the curve in tension and compression on which these are.
    lines: [usize; 2],
    pub passed: Stiffenings,
    /// It has come to where its curve is level or falls.
    pub is_level: bool,
}

impl History {
    /// The cell has flowed, or is another one.
    pub const UNKNOWN: Self = Self { low: f64::NAN, high: f64::NAN, lines: [0; 2], passed: [0; 2], is_level: false };

    /// That of a cell of a row with this law state.
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

    /// The cell comes to this stress (Pa) elastically.
    pub fn contains(&self, stress: f64) -> bool {
        // A curve may never leave its elastic line in one sense.
        let width = self.high - self.low;
        let rounding = WITHIN * if width.is_finite() { width } else { self.high.abs().min(self.low.abs()) };
        self.low - rounding <= stress && stress <= self.high + rounding
    }

    /// The same, but for stresses near its limits: a law then does not flow either.
    fn contains_safely(&self, stress: f64) -> bool {
        let near = INSIDE * (self.high - self.low);
        self.low + near <= stress && stress <= self.high - near
    }

    /// sense * stress at which the cell starts to flow, Pa, and the line of the curve on which that is.
    pub fn limit(&self, sense: f64) -> (f64, usize) {
        if sense < 0.0 { (-self.low, self.lines[1]) } else { (self.high, self.lines[0]) }
    }
}

/// True where histories are known and no cell of a row comes near to a limit of its elastic range: all laws then do no more than to add the
/// increments (Pa).
pub(super) fn stay_elastic(histories: &[History], sigma: &[f64], increment: &[f64]) -> bool {
    let after = sigma.iter().zip(increment).map(|(sigma, increment)| sigma + increment);
    !histories.is_empty() && histories.iter().zip(after).all(|(history, stress)| history.contains_safely(stress))
}

/// Stiffening knots passed with so much of what [`Part::stiffens`] counts, Pa.
pub(super) fn passed(part: &Part, along: [f64; 2]) -> Stiffenings {
    let Some(knots) = &part.stiffens else { return [0; 2] };
    [0, 1].map(|side| knots[side].iter().take_while(|&&knot| knot < along[side]).count() as u32)
}

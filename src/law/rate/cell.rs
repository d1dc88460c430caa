//! A rate-dependent law on the staggered grid: whole strain increments, with half a step of flow on either side of each.
//!
//! Over a step a cell flows for dt/2 at its stress, takes the strain increment elastically, and flows for dt/2 again, each
//! time by the closed solution at fixed strain ([`RateLaw::flow`] with share 1). The stress after the second half belongs to
//! the whole step, so the splitting is symmetric and of second order. No step is too long: flow that is quicker than a step
//! ends on the static curve, and the step is then that of the rate-independent law.

use super::{Flow, History, Pace, RateLaw};
use crate::law::{CellLaw, Response};

/// Overstress below this part of the stresses it is the difference of is rounding and does not flow.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Stands for an overstress that the latest step took away to the last bit.
const GONE: f64 = f64::MIN_POSITIVE;

/// A rate-dependent cell in steps of one length.
///
/// State: `[E p accumulated, E eps_p signed, E eps_p still to come, signed overstress, work of the overstress times E]`, and
/// the back stress where `N` is 6. The first two (and the back stress) are those after the half step of flow that
/// follows the stress: what that half step adds is the third, so that the stress need not be asked twice.
#[derive(Debug, Clone)]
pub struct Timed<const N: usize> {
    law: RateLaw,
    half: Pace,
}

impl<const N: usize> Timed<N> {
    /// The law in steps of `time`, s. `N` is 5, or 6 for a law with a back stress.
    pub fn new(law: RateLaw, time: f64) -> Self {
        Self { half: law.pace(1.0, 0.5 * time), law }
    }

    /// Half a step of flow at fixed strain from stress `sigma`: the flow, and the signed overstress before it.
    #[inline]
    fn flow(&self, sigma: f64, history: &mut History) -> (Flow, f64) {
        let [low, high] = self.law.limits(history);
        let least = ROUNDING * (sigma.abs() + history.back.abs() + (high - low));
        if sigma - high > least {
            (self.law.flow_at(&self.half, sigma - high, 0, history), sigma - high)
        } else if low - sigma > least {
            (self.law.flow_at(&self.half, low - sigma, 1, history), sigma - low)
        } else {
            (Flow::default(), 0.0)
        }
    }
}

impl<const N: usize> CellLaw<N> for Timed<N> {
    const TAKES_TIME: bool = true;

    #[inline]
    fn base(&self, sigma: f64, state: [f64; N]) -> f64 {
        sigma - state[2]
    }

    fn respond(&self, predictor: f64, state: [f64; N]) -> Response<N> {
        let back = if N > 5 { state[5] } else { 0.0 };
        let mut history = self.law.history(state[0], state[1], back);
        let (second_half, _) = self.flow(predictor, &mut history);
        let sigma = predictor - second_half.plastic;
        let (to_come, mut overstress) = self.flow(sigma, &mut history);
        if overstress == 0.0 && second_half.plastic != 0.0 {
            overstress = GONE.copysign(second_half.plastic);
        }
        let plastic = state[2] + second_half.plastic;
        let work = state[4] + 0.5 * (state[3] + overstress) * plastic;
        let after = [history.accumulated, history.signed, to_come.plastic, overstress, work, history.back];
        Response { sigma, state: std::array::from_fn(|k| after[k]), plastic }
    }

    #[inline]
    fn plastic_strain(&self, state: [f64; N]) -> f64 {
        state[1] - state[2]
    }

    #[inline]
    fn accumulated(&self, state: [f64; N]) -> f64 {
        state[0] - state[2].abs()
    }

    /// The overstress is no part of the way along the static curve.
    #[inline]
    fn reach(&self, sigma: f64, state: [f64; N]) -> f64 {
        sigma.abs() - state[3].abs() + self.accumulated(state)
    }

    #[inline]
    fn overstress_work(&self, state: [f64; N]) -> f64 {
        state[4]
    }

    #[inline]
    fn flows(&self, state: [f64; N]) -> bool {
        state[3] != 0.0
    }

    /// The cell is loaded, and at least half of its overstress goes within half a step: it follows the static curve. A cell
    /// that unloaded within the step has no overstress at its end.
    #[inline]
    fn keeps_up(&self, state: [f64; N]) -> bool {
        let left = state[3].abs();
        left == GONE || (left > 0.0 && state[2].abs() >= 0.5 * left)
    }
}

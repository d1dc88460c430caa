//! A rate-dependent law on the staggered grid: whole strain increments, with half a step of flow on either side of each.
//!
//! Over a step a cell flows for dt/2 at its stress, takes the strain increment elastically, and flows for dt/2 again, each
//! time by the closed solution at fixed strain ([`RateLaw::flow`] with share 1). The stress after the second half belongs to
//! the whole step, so the splitting is symmetric and of second order. No step is too long: flow that is quicker than a step
//! ends on the static curve, and the step is then that of the rate-independent law.

use super::split::{GONE, excess, readings_of_split_state, signed};
use super::{Flow, History, Pace, RateLaw};
use crate::law::{CellLaw, Response};

/// A rate-dependent cell in steps of one length.
///
/// State: that of [`super::split`], and the back stress where `N` is 6: it, too, is that after the half step of flow that
/// follows the stress.
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
        match excess(sigma, self.law.limits(history), history.back) {
            Some((size, sense)) => (self.law.flow_at(&self.half, size, sense, history), signed((size, sense))),
            None => (Flow::default(), 0.0),
        }
    }
}

impl<const N: usize> CellLaw<N> for Timed<N> {
    readings_of_split_state!();

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
}

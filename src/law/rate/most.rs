//! Malvern's law for many cells at once: those that are elastic in a step, or flow all the step long along one piece of the static curve.
//!
//! The operations are those of [`super::Timed`] for one cell, without a choice between them.

#![expect(
    clippy::needless_bitwise_bool,
    reason = "`&&` and `||` are branches, and the compiler does not turn these into vectors"
)]

use super::Sides;
use super::step::{GONE, rounding};
use crate::law::Steps;
use crate::root::Tolerance;

/// The static curves and the flow of a step along each of their pieces, see [`super::relaxed`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Pieces<'a> {
    pub curves: Sides<'a>,
    pub parts: [&'a [[f64; 2]]; 2],
}

/// What a cell needs of the piece it is on.
#[derive(Clone, Copy)]
struct On {
    /// Static flow stress, and in the other sense, Pa.
    limit: f64,
    across: f64,
    slope: f64,
    end: f64,
    part: [f64; 2],
}

impl Pieces<'_> {
    /// Steps the cells from their stresses and states to the stresses that they would have elastically; `after.known` tells which of them are done.
    #[inline(always)]
    pub(super) fn step<const N: usize, const W: usize>(
        &self,
        sigma: &[f64; W],
        predictor: &[f64; W],
        state: [&[f64; W]; N],
        after: &mut Steps<N, W>,
    ) {
        if let Some(piece) = self.curves.single() {
            let part = self.parts[0][0];
            for i in 0..W {
                let limit = piece.at(state[0][i]);
                let on = On { limit, across: limit, slope: piece.slope, end: f64::INFINITY, part };
                step_one(i, on, sigma[i], predictor[i], state, after);
            }
            return;
        }
        let located = self.curves.locate(sigma, predictor, state[0]);
        let part: [[f64; 2]; W] =
            std::array::from_fn(|i| self.parts[located.side[i] as usize][located.piece[i] as usize]);
        for i in 0..W {
            let on = On {
                limit: located.stress[i],
                across: located.across[i],
                slope: located.slope[i],
                end: located.end[i],
                part: part[i],
            };
            step_one(i, on, sigma[i], predictor[i], state, after);
        }
    }
}

#[inline(always)]
fn step_one<const N: usize, const W: usize>(
    i: usize,
    On { limit, across, slope, end, part }: On,
    sigma: f64,
    predictor: f64,
    state: [&[f64; W]; N],
    after: &mut Steps<N, W>,
) {
    let sign = 1.0_f64.copysign(sigma);
    let (excess, rise) = (sign * sigma - limit, sign * (predictor - sigma));
    let gain = 1.0 + slope;
    let flow = excess * part[0] + rise * part[1];
    let is_found = (rise >= 0.0) | (excess + rise - gain * flow > 4.0 * f64::EPSILON * (excess - rise));
    let limit = [limit, limit + slope * flow];
    let flown = Flown { sign, excess, rise, flow, limit, across, gain, end, is_found };
    flown.note(i, [sigma, predictor], |x, _| x, state, after);
}

/// A cell that flows all the step long, if it does.
pub(super) struct Flown {
    pub sign: f64,
    /// Overstress at the start, what it rises by if nothing flows, and what flows, Pa.
    pub excess: f64,
    pub rise: f64,
    pub flow: f64,
    /// Elastic limit at the start and at the end, and at the start in the other sense, Pa.
    pub limit: [f64; 2],
    pub across: f64,
    /// What the overstress loses by flow.
    pub gain: f64,
    /// E times the plastic strain at which the piece ends, Pa.
    pub end: f64,
    /// The flow is that of the law.
    pub is_found: bool,
}

impl Flown {
    /// Notes what the cell does where it is elastic, or flows from the start on and ends beyond the static curve or on it.
    #[inline(always)]
    pub fn note<const N: usize, const W: usize>(
        self,
        i: usize,
        [sigma, predictor]: [f64; 2],
        width: impl Fn(f64, f64) -> f64,
        state: [&[f64; W]; N],
        after: &mut Steps<N, W>,
    ) {
        let Self { sign, excess, rise, flow, limit: [limit, limit_end], across, gain, end, is_found } = self;
        let is_beyond = |stress: f64, limit: f64| stress.abs() - limit > rounding(stress, [-limit, limit], 0.0);
        let is_elastic =
            !(is_beyond(sigma, limit) | is_beyond(predictor, if sign * predictor < 0.0 { across } else { limit }));
        let p = state[0][i];
        let (p_end, plastic) = (p + flow, sign * flow);
        let is_on_piece = (flow < end - p) & (p_end < end);
        let stress = predictor - plastic;
        let left = sign * stress - limit_end;
        let unsolved = gain * Tolerance::of_differences(excess + rise.abs()).at(flow);
        let least = rounding(stress, [-limit_end, limit_end], 0.0) + unsolved;
        let is_resolved = left > least;
        let is_gone = (left >= -least) & (flow > 0.0) & (limit_end > least) & (rise >= 0.0);
        let is_loaded = (rise >= 0.0) | (excess + rise >= flow);
        let flows = is_beyond(sigma, limit) & is_found & is_loaded & is_on_piece & (is_resolved | is_gone);
        let choose = |flowing: f64, elastic: f64| if is_elastic { elastic } else { flowing };
        after.sigma[i] = choose(stress, predictor);
        after.plastic[i] = choose(plastic, 0.0);
        after.state[0][i] = choose(p_end, p);
        after.state[1][i] = choose(state[1][i] + plastic, state[1][i]);
        after.state[2][i] = choose(if is_resolved { flow / width(left, limit_end) } else { 0.0 }, 0.0);
        after.state[3][i] = choose(sign * if is_resolved { left } else { GONE }, 0.0);
        after.state[4][i] = state[4][i] + choose(0.5 * (excess + left.max(0.0)) * flow, 0.0);
        after.known[i] = u64::from(is_elastic | flows);
    }
}

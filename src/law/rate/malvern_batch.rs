//! Malvern's law for many cells at once: for cells that are elastic in a step, or that flow during the whole step along one piece of the static
//! curve. The curve may move with a back stress.
//!
//! The operations are those of [`super::Timed`] for one cell, without branches.

#![expect(
    clippy::needless_bitwise_bool,
    reason = "`&&` and `||` are branches, and the compiler does not turn these into vectors"
)]

use super::Sides;
use super::step::{FULLY_RELAXED, rounding};
use crate::law::Steps;
use crate::root::Tolerance;

/// The static curves, and the coefficients of the flow of a step along each of their pieces, see [`super::relaxed`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Pieces<'a> {
    pub curves: Sides<'a>,
    pub parts: [&'a [[f64; 2]]; 2],
    /// Kinematic fraction of the hardening, and elastic limit of first loading, Pa; both 0 if the curves do not move.
    pub kinematic: [f64; 2],
}

/// Data of the piece of the static curve on which a cell is.
#[derive(Clone, Copy)]
struct On {
    /// Static flow stress of first loading in the sense of the stress, and in the other sense, Pa.
    stress: f64,
    across: f64,
    slope: f64,
    end: f64,
    part: [f64; 2],
}

impl Pieces<'_> {
    /// Advances cells from stresses `sigma` and states `state`, given their elastic predictors. Sets `after.known` to 1 for the cells whose result is
    /// valid.
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
                let stress = piece.at(state[0][i]);
                let on = On { stress, across: stress, slope: piece.slope, end: f64::INFINITY, part };
                self.step_one(i, on, sigma[i], predictor[i], state, after);
            }
            return;
        }
        let located = self.curves.locate(sigma, predictor, state[0]);
        let part: [[f64; 2]; W] =
            std::array::from_fn(|i| self.parts[located.side[i] as usize][located.piece[i] as usize]);
        for i in 0..W {
            let on = On {
                stress: located.stress[i],
                across: located.across[i],
                slope: located.slope[i],
                end: located.end[i],
                part: part[i],
            };
            self.step_one(i, on, sigma[i], predictor[i], state, after);
        }
    }

    #[inline(always)]
    fn step_one<const N: usize, const W: usize>(
        &self,
        i: usize,
        On { stress, across, slope, end, part }: On,
        sigma: f64,
        predictor: f64,
        state: [&[f64; W]; N],
        after: &mut Steps<N, W>,
    ) {
        let (moves, [kinematic, yield_stress]) = (N > 5, self.kinematic);
        let back = if moves { state[N - 1][i] } else { 0.0 };
        let sign = 1.0_f64.copysign(sigma - back);
        let (half, widens) =
            if moves { half_range_and_slope(kinematic, yield_stress, stress, slope) } else { (stress, slope) };
        let limit = half + sign * back;
        let (excess, rise) = (sign * sigma - limit, sign * (predictor - sigma));
        let gain = 1.0 + slope;
        let flow = excess * part[0] + rise * part[1];
        let is_found = (rise >= 0.0) | (excess + rise - gain * flow > 4.0 * f64::EPSILON * (excess - rise));
        let flown = Flown {
            sign,
            excess,
            rise,
            flow,
            limit: [limit, limit + slope * flow],
            half: [half, half + widens * flow],
            across: if moves { [half - sign * back, half] } else { [across; 2] },
            back,
            gain,
            end,
            is_found,
        };
        flown.note(i, [sigma, predictor], |x| x, state, after);
        if moves {
            after.state[N - 1][i] = back + kinematic * slope * after.plastic[i];
        }
    }
}

/// Returns half the elastic range of a cell whose curve moves, Pa, and its derivative with respect to the flow; from the static flow stress of
/// first loading and its slope.
#[inline(always)]
pub(super) fn half_range_and_slope(kinematic: f64, yield_stress: f64, stress: f64, slope: f64) -> (f64, f64) {
    let moved = if kinematic > 0.0 { kinematic * (stress - yield_stress) } else { 0.0 };
    (stress - moved, (1.0 - kinematic) * slope)
}

/// A candidate solution in which a cell flows during the whole step.
pub(super) struct Flown {
    pub sign: f64,
    /// Overstress at the start, its rise if nothing flows, and the flow, Pa.
    pub excess: f64,
    pub rise: f64,
    pub flow: f64,
    /// Elastic limit in the sense of the flow, and half the elastic range, each at the start and at the end, Pa.
    pub limit: [f64; 2],
    pub half: [f64; 2],
    /// Elastic limit at the start in the other sense, and the half range from which its rounding is computed, Pa.
    pub across: [f64; 2],
    /// Back stress, Pa.
    pub back: f64,
    /// Decrease of the overstress per flow.
    pub gain: f64,
    /// E times the plastic strain at the end of the piece, Pa.
    pub end: f64,
    /// Whether `flow` solves the law.
    pub is_found: bool,
}

impl Flown {
    /// Stores the result of the cell if it is elastic, or if it flows from the start on and ends beyond the static curve or on it. `width` returns
    /// the overstress over which the rate changes by a factor e at the end.
    #[inline(always)]
    pub fn note<const N: usize, const W: usize>(
        self,
        i: usize,
        [sigma, predictor]: [f64; 2],
        width: impl Fn(f64) -> f64,
        state: [&[f64; W]; N],
        after: &mut Steps<N, W>,
    ) {
        let Self { sign, excess, rise, flow, limit: [limit, limit_end], half: [half, half_end], .. } = self;
        let Self { across: [across, half_across], back, gain, end, is_found, .. } = self;
        let is_beyond = |stress: f64, limit: f64, half: f64| stress - limit > rounding(stress, [-half, half], back);
        let is_over = is_beyond(sign * sigma, limit, half);
        let is_elastic =
            !(is_over | is_beyond(sign * predictor, limit, half) | is_beyond(-sign * predictor, across, half_across));
        let p = state[0][i];
        let (p_end, plastic) = (p + flow, sign * flow);
        let is_on_piece = (flow < end - p) & (p_end < end);
        let stress = predictor - plastic;
        let left = sign * stress - limit_end;
        let unsolved = gain * Tolerance::of_differences(excess + rise.abs()).at(flow);
        let least = rounding(stress, [-half_end, half_end], back) + unsolved;
        let is_resolved = left > least;
        let is_gone = (left >= -least) & (flow > 0.0) & (half_end > least) & (rise >= 0.0);
        let is_loaded = (rise >= 0.0) | (excess + rise >= flow);
        let flows = is_over & is_found & is_loaded & is_on_piece & (is_resolved | is_gone);
        let choose = |flowing: f64, elastic: f64| if is_elastic { elastic } else { flowing };
        after.sigma[i] = choose(stress, predictor);
        after.plastic[i] = choose(plastic, 0.0);
        after.state[0][i] = choose(p_end, p);
        after.state[1][i] = choose(state[1][i] + plastic, state[1][i]);
        after.state[2][i] = choose(if is_resolved { flow / width(left) } else { 0.0 }, 0.0);
        after.state[3][i] = choose(sign * if is_resolved { left } else { FULLY_RELAXED }, 0.0);
        after.state[4][i] = state[4][i] + choose(0.5 * (excess + left.max(0.0)) * flow, 0.0);
        after.known[i] = u64::from(is_elastic | flows);
    }
}

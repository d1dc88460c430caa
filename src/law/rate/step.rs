//! Common parts of the rate laws: a step of given strain, the first five state variables, and the flow criterion.
//!
//! State: `[E p accumulated, E eps_p signed, step per relaxation time, signed overstress, work of the overstress times E, ..]`. The third is
//! the flow of the latest step over the overstress that changes the rate by a factor e, i.e. the ratio of the step to the relaxation time.

use super::{Driven, Overstress};
use crate::root::Tolerance;

/// Overstress, relative to the stresses of which it is the difference, below which it is rounding and does not flow.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Marks an overstress that the latest step removed completely.
pub(super) const FULLY_RELAXED: f64 = f64::MIN_POSITIVE;

/// Ratio of the step to the relaxation time above which a cell loses at least half of an overstress within half a step.
pub(super) const FAST_RELAXATION: f64 = 2.0 * std::f64::consts::LN_2;

/// A cell that flows, as seen by an overstress law between two instants of a step.
pub(super) trait Flowing {
    /// Returns the lower and the upper stress between which the cell is elastic, Pa.
    fn limits(&self) -> [f64; 2];

    /// Returns the back stress: the middle between the limits as far as hardening moves it, Pa.
    fn back(&self) -> f64;

    /// Returns the flow in a sense (0: at or beyond the upper limit, 1: the lower one): E times plastic strain, Pa, >= 0.
    fn flow(&self, driven: Driven, sense: usize) -> f64;

    /// Advances the cell to the end of a flow.
    fn advance(&mut self, driven: Driven, flow: f64, sense: usize);

    /// Returns the slope d f/dp of the static curve in a sense.
    fn slope(&self, sense: usize) -> f64;

    /// Returns the overstress law, and the static flow stress in a sense, Pa.
    fn law(&self, sense: usize) -> (Overstress, f64);
}

/// Result of a step of a cell.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Step {
    /// E times the signed plastic strain, Pa.
    pub plastic: f64,
    /// E times the work of the overstress, Pa^2, >= 0.
    pub work: f64,
    /// Signed overstress at the end, Pa; [`FULLY_RELAXED`] if the cell flows and ends on the static curve.
    pub overstress: f64,
    /// Ratio of the step to the relaxation time.
    pub dt_over_relaxation_time: f64,
}

/// Computes a step of length `time` from stress `sigma` to the elastic predictor `predictor`, Pa: elastic up to a limit, then flow, and
/// flow in the other sense if the step continues to the other limit.
#[inline]
pub(super) fn step(cell: &mut impl Flowing, sigma: f64, predictor: f64, time: f64) -> Step {
    let [low, high] = cell.limits();
    if sigma.min(predictor) >= low && sigma.max(predictor) <= high {
        return Step::default();
    }
    let whole = predictor - sigma;
    let from_limit = |(x, sense): (f64, usize)| {
        // Without strain, rounding may put the cell beyond a limit: the fraction is limited to 1.
        let part = (x / whole.abs()).min(1.0);
        (Driven { excess: 0.0, rise: x, time: part * time }, sense)
    };
    let flowing = excess(sigma, cell).map(|(x, sense)| {
        let rise = if sense == 0 { whole } else { -whole };
        (Driven { excess: x, rise, time }, sense)
    });
    let mut step = Step::default();
    let Some((driven, sense)) = flowing.or_else(|| excess(predictor, cell).map(from_limit)) else { return step };
    step.take(cell, (driven, sense), time, predictor);
    if let Some((driven, back)) = excess(predictor - step.plastic, cell).map(from_limit).filter(|(_, s)| *s != sense) {
        step.take(cell, (driven, back), time, predictor);
    }
    step
}

impl Step {
    #[inline]
    fn take(&mut self, cell: &mut impl Flowing, (driven, sense): (Driven, usize), time: f64, predictor: f64) {
        let flow = across_limit(cell, driven, sense, time);
        cell.advance(driven, flow, sense);
        self.plastic += if sense == 0 { flow } else { -flow };
        let (stress, [low, high]) = (predictor - self.plastic, cell.limits());
        let left = if sense == 0 { stress - high } else { low - stress };
        self.work += 0.5 * (driven.excess + left.max(0.0)) * flow;
        let least = rounding(stress, [low, high], cell.back()) + unsolved(cell, driven, flow, sense);
        // A cell that is strained further does not leave its limit. A smaller stress is the error of the computed flow, however large.
        let stays = flow > 0.0 && (driven.rise >= 0.0 || left >= -least);
        let size = match left {
            left if left > least => left,
            _ if stays => FULLY_RELAXED,
            _ => 0.0,
        };
        self.overstress = if sense == 0 { size } else { -size };
        self.dt_over_relaxation_time = if left > least { flow / width(cell, left, sense) } else { 0.0 };
    }
}

/// Returns the flow in a step of length `time`. If the cell reaches its limit or leaves it within the step, the result is a weighted mean of two
/// solutions.
///
/// A front that advances by one cell per step, as an elastic front does at Courant number 1, meets every cell at the same fraction of a step. A
/// stress path that is linear in time, which is right for a material point, then has the same error in all cells. The errors add up to a first-order
/// error and, for a jump, to an error that does not vanish with the step. Flow for half a step at the overstress of the end that is beyond the limit
/// has no such error. Its weight tends to 1 as the step resolves the relaxation.
#[inline]
fn across_limit(cell: &impl Flowing, driven: Driven, sense: usize, time: f64) -> f64 {
    let flow = cell.flow(driven, sense);
    let unloads = driven.rise < 0.0 && driven.excess + driven.rise < flow;
    if driven.excess > 0.0 && !unloads {
        return flow;
    }
    let excess = if unloads { driven.excess } else { driven.rise };
    let (law, f) = cell.law(sense);
    let steps = time * law.relaxation_rate(excess, f);
    let part = 1.0 / (1.0 + steps * steps);
    if part.is_nan() || part < f64::EPSILON {
        return flow;
    }
    flow + part * (cell.flow(Driven { excess, rise: 0.0, time: 0.5 * time }, sense) - flow)
}

/// Returns the distance from the elastic limit that the tolerance of the flow allows for a stress. The stress falls by the flow, and the limit
/// rises by the slope of the curve times the flow: tens of times as much along a line that is nearly as steep as the elastic one.
fn unsolved(cell: &impl Flowing, driven: Driven, flow: f64, sense: usize) -> f64 {
    (1.0 + cell.slope(sense)) * Tolerance::of_differences(driven.excess + driven.rise.abs()).at(flow)
}

fn width(cell: &impl Flowing, x: f64, sense: usize) -> f64 {
    let (law, f) = cell.law(sense);
    law.width(x, f)
}

#[inline(always)]
pub(super) fn rounding(sigma: f64, [low, high]: [f64; 2], back: f64) -> f64 {
    ROUNDING * (sigma.abs() + back.abs() + (high - low))
}

/// Returns how far a stress is beyond the elastic limits, Pa, and in which sense (0: the upper one, 1: the lower one). `None` if it is
/// between them.
#[inline]
fn excess(sigma: f64, cell: &impl Flowing) -> Option<(f64, usize)> {
    let [low, high] = cell.limits();
    let least = rounding(sigma, [low, high], cell.back());
    if sigma - high > least {
        Some((sigma - high, 0))
    } else if low - sigma > least {
        Some((low - sigma, 1))
    } else {
        None
    }
}

/// Returns the flow in each sense (up, down) in a step, from E times the accumulated plastic strain before and after it and the signed one of the
/// step, Pa.
pub(super) fn both_ways([before, after]: [f64; 2], plastic: f64) -> [f64; 2] {
    let all = after - before;
    [0.5 * (all + plastic), 0.5 * (all - plastic)]
}

/// Returns true if a cell flows in both senses in a step: from an overstress in one sense to beyond the elastic limit of the other.
pub(super) fn is_both_ways(accumulated: [f64; 2], plastic: f64) -> bool {
    let [up, down] = both_ways(accumulated, plastic);
    up.min(down) > ROUNDING * accumulated[1]
}

/// Methods of [`crate::law::CellLaw`] that only read the state.
macro_rules! readings_of_state {
    () => {
        const TAKES_TIME: bool = true;

        #[inline]
        fn base(&self, sigma: f64, _: [f64; N]) -> f64 {
            sigma
        }

        fn onset(&self, sigma: f64, state: [f64; N], after: &Response<N>) -> f64 {
            if $crate::law::rate::step::is_both_ways([state[0], after.state[0]], after.plastic) {
                return -1.0;
            }
            let end = (after.sigma - Self::middle(self, after.state)) * after.plastic;
            after.onset(sigma, Self::middle(self, state)).min(end)
        }

        /// If a cell flows in both senses, or flows at first and is then unloaded beyond the middle of its elastic range: the work of each flow
        /// against its elastic limit at the end of the step, plus that of the overstress.
        fn turned_work(&self, state: [f64; N], after: &Response<N>) -> f64 {
            let accumulated = [state[0], after.state[0]];
            let end = (after.sigma - Self::middle(self, after.state)) * after.plastic;
            if end >= 0.0 && !$crate::law::rate::step::is_both_ways(accumulated, after.plastic) {
                return 2.0 * after.sigma * after.plastic;
            }
            let [up, down] = $crate::law::rate::step::both_ways(accumulated, after.plastic);
            let [low, high] = self.limits(after.state);
            2.0 * (up * high - down * low + after.state[4] - state[4])
        }

        fn elastic_up_to(&self, _yield_stress: f64, cells: impl Iterator<Item = [f64; N]>) -> f64 {
            let up_to = |state: [f64; N]| {
                let flows = state[2] != 0.0 || state[3] != 0.0;
                if flows { 0.0 } else { $crate::law::within(self.limits(state)) }
            };
            cells.map(up_to).fold(f64::INFINITY, f64::min)
        }

        #[inline]
        fn plastic_strain(&self, state: [f64; N]) -> f64 {
            state[1]
        }

        #[inline]
        fn accumulated(&self, state: [f64; N]) -> f64 {
            state[0]
        }

        /// Returns the sense of the overstress.
        fn sense(&self, sigma: f64, state: [f64; N]) -> $crate::material::Sense {
            $crate::material::Sense::of(if state[3] == 0.0 { sigma } else { state[3] })
        }

        fn yields(&self, _sigma: f64, state: [f64; N]) -> bool {
            state[3] != 0.0
        }

        #[inline]
        fn overstress_work(&self, state: [f64; N]) -> f64 {
            state[4]
        }

        #[inline]
        fn flows(&self, state: [f64; N]) -> bool {
            state[3] != 0.0
        }

        /// Returns true if the cell is loaded and loses at least half of an overstress within half a step: it follows the curve of its strain
        /// rate. A cell that unloaded within the step has no overstress at its end.
        #[inline]
        fn is_relaxed(&self, state: [f64; N]) -> bool {
            use $crate::law::rate::step::{FAST_RELAXATION, FULLY_RELAXED};
            state[3].abs() == FULLY_RELAXED || (state[3] != 0.0 && state[2] >= FAST_RELAXATION)
        }
    };
}

pub(super) use readings_of_state;

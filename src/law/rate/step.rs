//! Common parts of the rate laws: a step of given strain, the first five state variables, and the flow criterion.
//!
//! State: `[E p accumulated, E eps_p signed, quickness, signed overstress, work of the overstress times E, ..]`. The quickness
//! is the flow of the latest step over the overstress that makes a factor e in the rate: the step over the relaxation time.

use super::{Driven, Overstress};
use crate::root::Tolerance;

/// Overstress below this part of the stresses it is the difference of is rounding and does not flow.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Stands for an overstress that the latest step took away to the last bit.
pub(super) const GONE: f64 = f64::MIN_POSITIVE;

/// Steps over relaxation times from which on a cell loses half of an overstress within half a step.
pub(super) const QUICK: f64 = 2.0 * std::f64::consts::LN_2;

/// A cell that flows: what a law of overstress knows of it between two instants of a step.
pub(super) trait Flowing {
    /// Stresses between which it is elastic, Pa: lower and upper.
    fn limits(&self) -> [f64; 2];

    /// Middle between them as far as hardening moves it, Pa.
    fn back(&self) -> f64;

    /// What it flows in a sense (0: at or beyond the upper limit, 1: the lower one): E times plastic strain, Pa, >= 0.
    fn flow(&self, driven: Driven, sense: usize) -> f64;

    /// Takes it to the end of a flow.
    fn advance(&mut self, driven: Driven, flow: f64, sense: usize);

    /// d f/dp of its static curve in a sense.
    fn slope(&self, sense: usize) -> f64;

    /// Its law of overstress, and the static flow stress in a sense, Pa.
    fn law(&self, sense: usize) -> (Overstress, f64);
}

/// What a cell did in a step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Step {
    /// E times signed plastic strain, Pa.
    pub plastic: f64,
    /// E times the work of the overstress, Pa^2, >= 0.
    pub work: f64,
    /// Signed overstress at the end, Pa; [`GONE`] on the static curve.
    pub overstress: f64,
    /// Step over relaxation time.
    pub quickness: f64,
}

/// A step of length `time` from stress `sigma` to `predictor`, Pa, where nothing flows: elastic up to a limit, then flow, and
/// once more where the step goes on to the other limit.
#[inline]
pub(super) fn step(cell: &mut impl Flowing, sigma: f64, predictor: f64, time: f64) -> Step {
    let [low, high] = cell.limits();
    if sigma.min(predictor) >= low && sigma.max(predictor) <= high {
        return Step::default();
    }
    let whole = predictor - sigma;
    let from_limit = |(x, sense): (f64, usize)| {
        // No strain at all brings no cell beyond a limit.
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
        // What is strained on does not leave its limit: less than that is the error of the flow that was found, however large.
        let stays = flow > 0.0 && (driven.rise >= 0.0 || left >= -least);
        let size = match left {
            left if left > least => left,
            _ if stays => GONE,
            _ => 0.0,
        };
        self.overstress = if sense == 0 { size } else { -size };
        self.quickness = if left > least { flow / width(cell, left, sense) } else { 0.0 };
    }
}

/// The flow in a step of length `time`; where the cell comes to its limit or leaves it within the step, of a mean.
///
/// A front that moves on by a cell in each step, as an elastic one does at Courant number 1, meets every cell at the same part
/// of a step: a path through it that is straight in time, right for a material point, then errs alike in all cells, which
/// adds up to an error of first order and, for a jump, of none. Flow for half a step at the overstress of the end that is
/// beyond the limit knows no such error. It is taken as far as the step resolves the relaxation.
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

/// How far from its elastic limit a stress may end by the tolerance to which a flow is solved: the stress falls by what flows, and the limit
/// rises by the slope of the curve times that, tens of times as much along a line that is nearly as steep as the elastic one.
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

/// How far a stress is beyond the elastic limits, and in which sense (0: the upper one, 1: the lower one); none where it is
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

/// Flow in both senses in a step, from E times the accumulated plastic strain before and after it and the signed one of the step, Pa.
pub(super) fn both_ways([before, after]: [f64; 2], plastic: f64) -> [f64; 2] {
    let all = after - before;
    [0.5 * (all + plastic), 0.5 * (all - plastic)]
}

/// Whether a cell flows in both senses in a step: from an overstress in one to beyond the elastic limit of the other.
pub(super) fn is_both_ways(accumulated: [f64; 2], plastic: f64) -> bool {
    let [up, down] = both_ways(accumulated, plastic);
    up.min(down) > ROUNDING * accumulated[1]
}

/// What [`crate::law::CellLaw`] reads off the state.
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

        /// Where a cell flows in both senses, or flows at first and is unloaded to beyond the middle of its elastic range: the work of each flow
        /// under its elastic limit at the end of the step, and that of the overstress.
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

        /// That of the overstress.
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

        /// The cell is loaded, and at least half of an overstress goes within half a step: it follows the curve of its strain
        /// rate. A cell that unloaded within the step has no overstress at its end.
        #[inline]
        fn keeps_up(&self, state: [f64; N]) -> bool {
            use $crate::law::rate::step::{GONE, QUICK};
            state[3].abs() == GONE || (state[3] != 0.0 && state[2] >= QUICK)
        }
    };
}

pub(super) use readings_of_state;

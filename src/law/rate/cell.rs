//! Rate-dependent law on the staggered grid: the response of a cell to a strain increment.
//!
//! The strain rate is constant over a step. Up to the elastic limit the cell is elastic. From there on (or
//! from the start, if the cell already flows) stress and plastic strain obey, in the sense of the flow,
//!
//! ```text
//!   d sigma/dt = E d_eps/dt - q(x, f(p)),   dp/dt = q,   x = sigma - limit(p)
//! ```
//!
//! until the step ends, or until the cell has unloaded to its elastic limit; the remainder is elastic, and may yield in the other
//! sense. [`RateLaw::strained`] solves this to second order in the step, and any step ends between the static curve and the
//! steady overstress at its own strain rate. So fast relaxation ends on the static curve, as the rate-independent law does, and a
//! step much longer than the relaxation time ends at the stress of its strain rate, which does not depend on the length of the step.
//!
//! The work of the overstress in a step is the mean of its values at both ends times the plastic strain, >= 0.
//!
//! Most cells are advanced side by side, see [`super::most`] and [`super::many`]; the code below is for the others.

use super::malvern_batch::Pieces;
use super::secant_batch::step_batch;
use super::step::{Flowing, readings_of_state, step};
use super::{Driven, History, Overstress, RateLaw, RelaxationStep};
use crate::law::{CellLaw, Deformed, Response, Steps, respond_alone};

/// A rate-dependent cell in steps of one length.
///
/// State: the variables of every rate-dependent law, and the back stress if `N` is 6.
#[derive(Debug, Clone)]
pub struct Timed<const N: usize> {
    law: RateLaw,
    relaxation_step: RelaxationStep,
    time: f64,
}

impl<const N: usize> Timed<N> {
    /// Builds the law for steps of `time`, s. `N` is 5, or 6 for a law with a back stress.
    pub fn new(law: RateLaw, time: f64) -> Self {
        Self { relaxation_step: law.relaxation_step(1.0, time), law, time }
    }

    /// Returns the middle of the elastic range, Pa.
    fn middle(_: &Self, state: [f64; N]) -> f64 {
        if N > 5 { state[5] } else { 0.0 }
    }

    fn history(&self, state: [f64; N]) -> History {
        self.law.history(state[0], state[1], Self::middle(self, state))
    }

    /// Returns the lower and the upper stress between which a cell is elastic, Pa.
    fn limits(&self, state: [f64; N]) -> [f64; 2] {
        self.law.limits(&self.history(state))
    }
}

/// State of a cell within a step.
struct Cell<'a> {
    law: &'a RateLaw,
    relaxation_step: &'a RelaxationStep,
    time: f64,
    history: History,
}

impl Flowing for Cell<'_> {
    #[inline]
    fn limits(&self) -> [f64; 2] {
        self.law.limits(&self.history)
    }

    #[inline]
    fn back(&self) -> f64 {
        self.history.back
    }

    #[inline]
    fn flow(&self, driven: Driven, sense: usize) -> f64 {
        if driven.time == self.time {
            return self.law.strained_at(self.relaxation_step, [driven.excess, driven.rise], sense, &self.history);
        }
        self.law.strained(driven, 1.0, sense, &self.history)
    }

    #[inline]
    fn advance(&mut self, _: Driven, flow: f64, sense: usize) {
        self.law.advance(flow, sense, &mut self.history);
    }

    #[inline]
    fn slope(&self, sense: usize) -> f64 {
        self.law.slope(&self.history, sense)
    }

    #[inline]
    fn law(&self, sense: usize) -> (Overstress, f64) {
        (self.law.overstress(), self.law.static_stress(&self.history, sense))
    }
}

impl<const N: usize> CellLaw<N> for Timed<N> {
    readings_of_state!();

    fn deformed(&self, deformed: &Deformed) -> [f64; N] {
        let history = self.law.deformed(deformed);
        let state = [history.accumulated, history.signed, 0.0, 0.0, 0.0, history.back];
        std::array::from_fn(|k| state[k])
    }

    #[inline(always)]
    fn respond_batch<const W: usize>(
        &self,
        sigma: &[f64; W],
        predictor: &[f64; W],
        state: [&[f64; W]; N],
        after: &mut Steps<N, W>,
    ) {
        if let Overstress::Malvern { .. } = self.law.overstress {
            let parts = self.relaxation_step.parts.each_ref().map(Vec::as_slice);
            let pieces = Pieces { curves: self.law.curves(), parts, kinematic: self.law.moving() };
            return pieces.step(sigma, predictor, state, after);
        }
        step_batch(&self.law, self.time, None, [sigma, predictor], state, after);
    }

    fn respond(&self, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N> {
        respond_alone(self, sigma, predictor, state)
    }

    fn respond_scalar(&self, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N> {
        let mut cell = Cell {
            law: &self.law,
            relaxation_step: &self.relaxation_step,
            time: self.time,
            history: self.history(state),
        };
        let step = step(&mut cell, sigma, predictor, self.time);
        let History { accumulated, signed, back, .. } = cell.history;
        let after = [accumulated, signed, step.dt_over_relaxation_time, step.overstress, state[4] + step.work, back];
        Response { sigma: predictor - step.plastic, state: std::array::from_fn(|k| after[k]), plastic: step.plastic }
    }
}

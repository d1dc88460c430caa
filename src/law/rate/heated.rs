//! A cell that its plastic work heats: the temperature is a state, and scales all stresses of the static curve.
//!
//! For flow whose work is not a function of the plastic strain alone: hardening that is kinematic, or a rate of strain that
//! counts (also with both at once). Elastic limits, back stress, and the static stress that a law of overstress asks for, are
//! those of the cold curve times g = 1 - ((T - Tref)/(Tm - Tref))^m. The scheme is that of [`super::Timed`]: half a step of
//! flow on either side of the strain increment. Each half takes g at the mean of its temperatures where it leaves the
//! overstress nearly as it was, at the last of them where it takes all of it away (the stress is then that of the warm static
//! curve), in proportion between; found by going through it again until the temperature stands. T is held below melting, where the stress is
//! gone.

use super::split::{GONE, excess, readings_of_split_state, signed};
use super::{Flow, History, RateLaw};
use crate::law::{CellLaw, Response};
use crate::material::Heating;

/// Temperatures whose difference is this part of the range to melting are the same.
const SAME_RISE: f64 = 1e-13;

/// Times that a half step is gone through. Each takes the error of the temperature down by about what the cell warms in the
/// step, over the range to melting: five or six leave rounding.
const MOST_PASSES: usize = 8;

/// What is left of the strength of metal that melts: nothing that counts, and no division by zero.
const MOLTEN: f64 = 1e-9;

/// A heated cell in steps of one length.
///
/// State: that of [`super::split`], then `[rise in temperature, rise by the static stress still to come, rise at which the
/// elastic limits were last taken]`, and the back stress of the cold curve where `N` is 9.
///
/// What warms is the work of the static stress, exact along the flow, and that of the overstress as the energy account has it,
/// which knows none where a step ends on the static curve.
#[derive(Debug, Clone)]
pub struct Heated<const N: usize> {
    law: RateLaw,
    half: f64,
    heating: Heating,
    /// Rise by E times plastic work, K/Pa^2.
    rise: f64,
}

/// Where a cell has come to.
#[derive(Debug, Clone, Copy)]
struct Past {
    history: History,
    /// Rise in temperature so far, K.
    rise: f64,
    /// The one that the elastic limits are taken at: theirs stays as it was when the cell last flowed, or cells would creep
    /// by what rounding and the order of the scheme leave between the two.
    limit: f64,
}

/// Half a step of flow.
#[derive(Debug, Clone, Copy, Default)]
struct Half {
    flow: Flow,
    /// Signed, before the flow.
    overstress: f64,
    /// Rise in temperature by the static stress, K.
    warmed: f64,
}

impl<const N: usize> Heated<N> {
    /// The law over the cold tables, in steps of `time`, s. `N` is 8, or 9 for a law with a back stress.
    pub fn new(law: RateLaw, heating: &Heating, modulus: f64, time: f64) -> Self {
        let rise = heating.rise_per_work() / modulus;
        Self { law, half: 0.5 * time, heating: heating.clone(), rise }
    }

    /// Half a step of flow at fixed strain from stress `sigma`.
    #[inline]
    fn flow(&self, sigma: f64, past: &mut Past) -> Half {
        let (before, cold) = (past.history, self.law.limits(&past.history));
        let (mut at, mut end) = (past.limit, past.rise);
        let mut half = Half::default();
        for _ in 0..MOST_PASSES {
            past.history = before;
            let g = self.softening(at);
            half = self.flow_at(g, sigma, cold, &mut past.history);
            if half.flow.plastic == 0.0 {
                break;
            }
            let left = self.left(g, sigma, &half, &past.history);
            half.warmed = self.rise * self.softening(0.5 * (past.rise + end)) * self.cold_work(&half, cold, &before);
            end = past.rise + half.warmed + self.rise * left * half.flow.overstress;
            let last = at;
            at = end + 0.5 * left * (past.rise - end);
            if (at - last).abs() <= SAME_RISE * self.heating.range() {
                break;
            }
        }
        (past.limit, past.rise) = (at, end);
        half
    }

    /// Part of its overstress that a cell keeps to the end of a flow.
    fn left(&self, g: f64, sigma: f64, half: &Half, history: &History) -> f64 {
        let [low, high] = self.law.limits(history).map(|limit| g * limit);
        let stress = sigma - half.flow.plastic;
        let left = if half.overstress > 0.0 { stress - high } else { low - stress };
        (left / half.overstress.abs()).clamp(0.0, 1.0)
    }

    /// E times the work of the static stress of a cold cell: in the sense of the flow its elastic limit rises as the curve of
    /// first loading does.
    fn cold_work(&self, half: &Half, [low, high]: [f64; 2], before: &History) -> f64 {
        let sense = usize::from(half.overstress < 0.0);
        let beside = if sense == 0 { high } else { -low } - self.law.static_stress(before, sense);
        half.flow.first_loading + half.flow.plastic.abs() * beside
    }

    fn softening(&self, rise: f64) -> f64 {
        self.heating.softening(rise).max(MOLTEN)
    }

    /// The same with stresses `g` times those of the cold limits.
    #[inline]
    fn flow_at(&self, g: f64, sigma: f64, cold: [f64; 2], history: &mut History) -> Half {
        let limits = cold.map(|limit| g * limit);
        let Some((size, sense)) = excess(sigma, limits, history.back) else { return Half::default() };
        let flow = self.law.flow_softened(size, sense, g, self.half, history);
        Half { flow, overstress: signed((size, sense)), warmed: 0.0 }
    }
}

impl<const N: usize> CellLaw<N> for Heated<N> {
    readings_of_split_state!();

    fn respond(&self, predictor: f64, state: [f64; N]) -> Response<N> {
        let back = if N > 8 { state[8] } else { 0.0 };
        // Of the overstress of the half step before, as much as if it had stayed.
        let rise = state[5] + state[6] + self.rise * state[3] * state[2];
        let mut past = Past { history: self.law.history(state[0], state[1], back), rise, limit: state[7] };
        let first = self.flow(predictor, &mut past);
        let sigma = predictor - first.flow.plastic;
        let second = self.flow(sigma, &mut past);
        let mut overstress = second.overstress;
        if overstress == 0.0 && first.flow.plastic != 0.0 {
            overstress = GONE.copysign(first.flow.plastic);
        }
        let plastic = state[2] + first.flow.plastic;
        let over = 0.5 * (state[3] + overstress) * plastic;
        let warm = (state[5] + state[6] + first.warmed + self.rise * over).clamp(0.0, self.heating.range());
        let History { accumulated, signed, back, .. } = past.history;
        let (to_come, work) = (second.flow.plastic, state[4] + over);
        let all = [accumulated, signed, to_come, overstress, work, warm, second.warmed, past.limit, back];
        Response { sigma, state: std::array::from_fn(|k| all[k]), plastic }
    }

    fn temperature(&self, state: [f64; N]) -> f64 {
        self.heating.reference_temperature + state[5]
    }

    fn heat_fraction(&self) -> f64 {
        self.heating.fraction
    }
}

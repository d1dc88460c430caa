//! A cell that its plastic work heats: the temperature is a state, and scales all stresses of the static curve.
//!
//! For flow whose work is not a function of the plastic strain alone: hardening that is kinematic, or a rate of strain that
//! counts (also with both at once). Elastic limits, back stress, and the static stress that a law of overstress asks for, are
//! those of the cold curve times g = 1 - ((T - Tref)/(Tm - Tref))^m. The scheme is that of [`super::Timed`]: half a step of
//! flow on either side of the strain increment. Each half takes g at the mean of its temperatures, found by flowing once at
//! the first of them: second order. T is held below melting, where the stress is gone.

use super::{Flow, History, RateLaw};
use crate::law::{CellLaw, Response};
use crate::material::Heating;

/// Overstress below this part of the stresses it is the difference of is rounding and does not flow.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Stands for an overstress that the latest step took away to the last bit.
const GONE: f64 = f64::MIN_POSITIVE;

/// What is left of the strength of metal that melts: nothing that counts, and no division by zero.
const MOLTEN: f64 = 1e-9;

/// A heated cell in steps of one length.
///
/// State: `[E p accumulated, E eps_p signed, E eps_p still to come, signed overstress, work of the overstress times E, rise in
/// temperature, rise still to come]`, and the back stress of the cold curve where `N` is 8. As for [`super::Timed`], the half
/// step of flow that follows the stress is in the state already, and what it adds is what is still to come.
#[derive(Debug, Clone)]
pub struct Heated<const N: usize> {
    law: RateLaw,
    half: f64,
    heating: Heating,
    /// Rise by E times plastic work, K/Pa^2.
    rise: f64,
}

/// The past of a cell.
#[derive(Debug, Clone, Copy)]
struct Past {
    history: History,
    /// Above the reference temperature, K.
    rise: f64,
}

/// Half a step of flow.
#[derive(Debug, Clone, Copy, Default)]
struct Half {
    flow: Flow,
    /// Signed, before the flow.
    overstress: f64,
}

impl<const N: usize> Heated<N> {
    /// The law over the cold tables, in steps of `time`, s. `N` is 7, or 8 for a law with a back stress.
    pub fn new(law: RateLaw, heating: &Heating, modulus: f64, time: f64) -> Self {
        let rise = heating.rise_per_work() / modulus;
        Self { law, half: 0.5 * time, heating: heating.clone(), rise }
    }

    /// Half a step of flow at fixed strain from stress `sigma`.
    #[inline]
    fn flow(&self, sigma: f64, past: &mut Past) -> Half {
        let limits = self.law.limits(&past.history);
        let before = *past;
        let half = self.flow_at(self.softening(past.rise), sigma, limits, past);
        if half.flow.plastic == 0.0 {
            return half;
        }
        let mean = 0.5 * (before.rise + past.rise);
        *past = before;
        self.flow_at(self.softening(mean), sigma, limits, past)
    }

    fn softening(&self, rise: f64) -> f64 {
        self.heating.softening(rise).max(MOLTEN)
    }

    /// The same with stresses `g` times the cold ones.
    #[inline]
    fn flow_at(&self, g: f64, sigma: f64, limits: [f64; 2], past: &mut Past) -> Half {
        let [low, high] = limits.map(|limit| g * limit);
        let least = ROUNDING * (sigma.abs() + past.history.back.abs() + (high - low));
        let (excess, sense) = if sigma - high > least {
            (sigma - high, 0)
        } else if low - sigma > least {
            (low - sigma, 1)
        } else {
            return Half::default();
        };
        let flow = self.law.flow_softened(excess, sense, g, self.half, &mut past.history);
        // At fixed strain the stress falls by what flows.
        let work = flow.plastic * (sigma - 0.5 * flow.plastic);
        past.rise = (past.rise + self.rise * work).clamp(0.0, self.heating.range());
        Half { flow, overstress: if sense == 0 { excess } else { -excess } }
    }
}

impl<const N: usize> CellLaw<N> for Heated<N> {
    const TAKES_TIME: bool = true;

    #[inline]
    fn base(&self, sigma: f64, state: [f64; N]) -> f64 {
        sigma - state[2]
    }

    fn respond(&self, predictor: f64, state: [f64; N]) -> Response<N> {
        let back = if N > 7 { state[7] } else { 0.0 };
        let mut past = Past { history: self.law.history(state[0], state[1], back), rise: state[5] };
        let first = self.flow(predictor, &mut past).flow;
        let sigma = predictor - first.plastic;
        let rise = past.rise;
        let Half { flow: to_come, mut overstress } = self.flow(sigma, &mut past);
        if overstress == 0.0 && first.plastic != 0.0 {
            overstress = GONE.copysign(first.plastic);
        }
        let plastic = state[2] + first.plastic;
        let work = state[4] + 0.5 * (state[3] + overstress) * plastic;
        let Past { history, rise: after } = past;
        let to_warm = after - rise;
        let all =
            [history.accumulated, history.signed, to_come.plastic, overstress, work, after, to_warm, history.back];
        Response { sigma, state: std::array::from_fn(|k| all[k]), plastic }
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

    /// As for [`super::Timed`].
    #[inline]
    fn keeps_up(&self, state: [f64; N]) -> bool {
        let left = state[3].abs();
        left == GONE || (left > 0.0 && state[2].abs() >= 0.5 * left)
    }

    fn temperature(&self, state: [f64; N]) -> f64 {
        self.heating.reference_temperature + (state[5] - state[6])
    }

    fn heat_fraction(&self) -> f64 {
        self.heating.fraction
    }
}

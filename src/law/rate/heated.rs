//! A cell with adiabatic heating: the temperature is a state variable and scales all stresses of the static curve.
//!
//! For flow whose work is not a function of the plastic strain alone: hardening that is kinematic, or a rate of strain that
//! counts (also with both at once). Elastic limits, back stress, and the static stress that a law of overstress asks for, are
//! those of the cold curve times g = 1 - ((T - Tref)/(Tm - Tref))^m. The step is that of [`super::Timed`]: flow at the step's
//! own strain rate while the limits go, straight, to those of the plastic strain and the temperature at its end, which are
//! found with the flow. T is limited to the melting temperature, where the stress vanishes.
//!
//! What warms is the work of the static stress, that of the cold curve times the g of the step's mean temperature, and the
//! work of the overstress as the energy account has it. Second order in the step.
//!
//! The heat is the fraction beta of all plastic work, beta sigma d `eps_p` (Taylor and Quinney, Proc. R. Soc. A 143, 1934), of either
//! sign. In reverse flow while the back stress is larger than the elastic limit sigma d `eps_p` < 0: stored work comes back, and the cell
//! cools by the fraction beta of it, as it warmed when the work was stored. A law that splits stored from dissipated work otherwise
//! (Rosakis et al., J. Mech. Phys. Solids 48, 2000) would need a measured beta that depends on the path.

use super::many::{FOUND, MOLTEN, TemperatureRise, step_most};
use super::step::{Flowing, readings_of_state, step};
use super::{Course, Driven, History, Overstress, RateLaw};
use crate::law::{CellLaw, Deformed, Response, Steps, respond_alone};
use crate::material::Heating;
use crate::root::{Tolerance, fixed_point};

/// Most times that the temperature at the end of a flow is worked out. Each takes its error down by about what the cell warms in
/// the step, over the range to melting.
const PASSES: usize = 4;

/// A heated cell in steps of one length.
///
/// State: that of every law that takes time, then the rise in temperature, and the back stress of the cold curve where `N` is 7.
#[derive(Debug, Clone)]
pub struct Heated<const N: usize> {
    law: RateLaw,
    time: f64,
    heating: Heating,
    /// Rise by E times plastic work, K/Pa^2.
    rise: f64,
}

impl<const N: usize> Heated<N> {
    /// The law over the cold tables, in steps of `time`, s. `N` is 6, or 7 for a law with a back stress.
    pub fn new(law: RateLaw, heating: &Heating, modulus: f64, time: f64) -> Self {
        let rise = heating.rise_per_work() / modulus;
        Self { law, time, heating: heating.clone(), rise }
    }

    fn softening(&self, rise: f64) -> f64 {
        self.heating.softening(rise).max(MOLTEN)
    }

    /// Middle of the elastic range, Pa.
    fn middle(law: &Self, state: [f64; N]) -> f64 {
        if N > 6 { law.softening(state[5]) * state[6] } else { 0.0 }
    }

    fn history(&self, state: [f64; N]) -> History {
        self.law.history(state[0], state[1], if N > 6 { state[6] } else { 0.0 })
    }

    /// Stresses between which a cell is elastic, Pa.
    fn limits(&self, state: [f64; N]) -> [f64; 2] {
        self.law.limits(&self.history(state)).map(|limit| self.softening(state[5]) * limit)
    }
}

/// A cell within a step.
struct Cell<'a, const N: usize> {
    heated: &'a Heated<N>,
    history: History,
    /// Rise in temperature, K.
    rise: f64,
    softening: f64,
    /// Both at the end of the flow tried last: flows that are tried one after the other are alike.
    latest: std::cell::Cell<[f64; 2]>,
}

/// Where a flow would take a cell.
struct Flowed {
    history: History,
    rise: f64,
    softening: f64,
}

impl<const N: usize> Cell<'_, N> {
    /// The cold elastic limit in a sense, positive away from the other one, Pa.
    fn cold_limit(&self, history: &History, sense: usize) -> f64 {
        let [low, high] = self.heated.law.limits(history);
        if sense == 0 { high } else { -low }
    }

    fn cold_stress(&self, history: &History, sense: usize) -> f64 {
        self.heated.law.static_stress(history, sense)
    }

    /// The cell after a flow.
    fn flowed(&self, driven: Driven, sense: usize, flow: f64) -> Flowed {
        let (law, heating) = (&self.heated.law, &self.heated.heating);
        let mut history = self.history;
        if flow <= 0.0 {
            return Flowed { history, rise: self.rise, softening: self.softening };
        }
        law.advance(flow, sense, &mut history);
        let (cold, end) = (self.cold_limit(&self.history, sense), self.cold_limit(&history, sense));
        // The elastic limit rises as the curve of first loading does.
        let beside = cold - self.cold_stress(&self.history, sense);
        let work = law.first_loading(sense, &self.history, &history) + flow * beside;
        let [mut rise, mut softening] = self.latest.get();
        for _ in 0..PASSES {
            let left = driven.excess + driven.rise - flow - (softening * end - self.softening * cold);
            let mean = self.heated.softening(0.5 * (self.rise + rise));
            let heat = mean * work + 0.5 * (driven.excess + left.max(0.0)) * flow;
            let before = rise;
            rise = (self.rise + self.heated.rise * heat).clamp(0.0, heating.range());
            softening = self.heated.softening(rise);
            if (rise - before).abs() <= FOUND * heating.range() {
                break;
            }
        }
        self.latest.set([rise, softening]);
        Flowed { history, rise, softening }
    }

    /// What flows if the limits go on to those after a flow.
    fn answer(&self, driven: Driven, sense: usize, flow: f64) -> f64 {
        let (law, end) = (&self.heated.law, self.flowed(driven, sense, flow));
        let limit = |g: f64, history: &History| g * self.cold_limit(history, sense);
        let stress = |g: f64, history: &History| g * self.cold_stress(history, sense);
        let course = Course {
            law: law.overstress().at_rise(0.5 * (self.rise + end.rise)),
            limit: limit(end.softening, &end.history) - limit(self.softening, &self.history),
            flow_stress: [stress(self.softening, &self.history), stress(end.softening, &end.history)],
        };
        course.answer(driven, 1.0, flow)
    }
}

impl<const N: usize> Flowing for Cell<'_, N> {
    fn limits(&self) -> [f64; 2] {
        self.heated.law.limits(&self.history).map(|limit| self.softening * limit)
    }

    fn back(&self) -> f64 {
        self.history.back
    }

    fn flow(&self, driven: Driven, sense: usize) -> f64 {
        let most = driven.excess + driven.rise.max(0.0);
        // A static stress that falls gives a little more than what would stay elastic.
        let most = most + self.softening * self.cold_limit(&self.history, sense).max(0.0);
        let tolerance = Tolerance::of_differences(most);
        fixed_point(self.answer(driven, sense, 0.0), [0.0, most], tolerance, |flow| self.answer(driven, sense, flow))
    }

    fn advance(&mut self, driven: Driven, flow: f64, sense: usize) {
        let Flowed { history, rise, softening } = self.flowed(driven, sense, flow);
        (self.history, self.rise, self.softening) = (history, rise, softening);
    }

    fn slope(&self, sense: usize) -> f64 {
        self.softening * self.heated.law.slope(&self.history, sense)
    }

    fn law(&self, sense: usize) -> (Overstress, f64) {
        (self.heated.law.overstress().at_rise(self.rise), self.softening * self.cold_stress(&self.history, sense))
    }
}

impl<const N: usize> CellLaw<N> for Heated<N> {
    readings_of_state!();

    fn deformed(&self, deformed: &Deformed) -> [f64; N] {
        let history = self.law.deformed(deformed);
        let state = [history.accumulated, history.signed, 0.0, 0.0, 0.0, deformed.temperature_rise, history.back];
        std::array::from_fn(|k| state[k])
    }

    #[inline(always)]
    fn respond_to_most<const W: usize>(
        &self,
        sigma: &[f64; W],
        predictor: &[f64; W],
        state: [&[f64; W]; N],
        after: &mut Steps<N, W>,
    ) {
        let Self { time, rise, heating, .. } = self;
        let temperature = TemperatureRise { rise: *rise, range: heating.range(), exponent: heating.exponent };
        step_most(&self.law, *time, Some(temperature), [sigma, predictor], state, after);
    }

    fn respond(&self, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N> {
        respond_alone(self, sigma, predictor, state)
    }

    fn respond_to_other(&self, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N> {
        let history = self.history(state);
        let (rise, softening) = (state[5], self.softening(state[5]));
        let mut cell = Cell { heated: self, history, rise, softening, latest: [rise, softening].into() };
        let step = step(&mut cell, sigma, predictor, self.time);
        let History { accumulated, signed, back, .. } = cell.history;
        let after = [accumulated, signed, step.quickness, step.overstress, state[4] + step.work, cell.rise, back];
        Response { sigma: predictor - step.plastic, state: std::array::from_fn(|k| after[k]), plastic: step.plastic }
    }

    fn temperature(&self, state: [f64; N]) -> f64 {
        self.heating.reference_temperature + state[5]
    }

    fn heat_fraction(&self) -> f64 {
        self.heating.fraction
    }
}

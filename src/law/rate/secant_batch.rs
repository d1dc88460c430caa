//! Advances many cells at once by laws whose flow is found by iteration: cells that are elastic in a step, or flow during the whole step in
//! one sense along one piece of the static curve, which may move with a back stress.
//!
//! As in [`super::Timed`] and [`super::Heated`], the elastic limit changes linearly within the step, to the limit at the flow and the temperature
//! at its end. Both are found by the secant method, for all cells side by side and without branches; a cell that has
//! converged is not changed any more. So its bits depend neither on its neighbours nor on how many cells are advanced at once.

#![expect(
    clippy::needless_bitwise_bool,
    clippy::needless_range_loop,
    reason = "`&&`, `||` and iterators with their ends are branches, and the compiler does not turn these into vectors"
)]

use super::malvern_batch::{Flown, half_range_and_slope};
use super::step::rounding;
use super::{Closed, Driven, JohnsonCook, Malvern, Overstress, PowerAboveOne, RateLaw, Sides};
use crate::elementary::{exp, ln};
use crate::law::Steps;
use crate::root::Tolerance;

/// Largest number of iterations for the flow; usual convergence takes four. Slower cells are left to [`crate::root::fixed_point`].
const MAX_ITERATIONS: usize = 8;

/// Change of temperature, relative to the range to melting, that counts as converged: the next iterate would differ by rounding.
pub(super) const FOUND: f64 = 1e-13;

/// Remaining strength of molten metal, relative to the cold one: negligible, but avoids division by zero.
pub(super) const MOLTEN: f64 = 1e-9;

/// Temperature rise due to plastic work, and thermal softening.
#[derive(Debug, Clone, Copy)]
pub(super) struct TemperatureRise {
    /// Temperature rise per E times plastic work, K/Pa^2.
    pub rise: f64,
    /// Range from the reference temperature to melting, K.
    pub range: f64,
    pub exponent: f64,
}

impl TemperatureRise {
    /// Computes the factors of the static stresses at the given temperature rises.
    #[inline(always)]
    fn softening<const W: usize>(self, rise: &[f64; W], softening: &mut [f64; W]) {
        let part = self.range.recip();
        for i in 0..W {
            softening[i] = rise[i] * part;
        }
        if self.exponent != 1.0 {
            for share in softening.iter_mut() {
                let power = exp(self.exponent * ln(if *share > LEAST { *share } else { LEAST }));
                *share = if *share > LEAST { power } else { 0.0 };
            }
        }
        for share in softening.iter_mut() {
            let left = 1.0 - *share;
            *share = if left > MOLTEN { left } else { MOLTEN };
        }
    }

    /// Updates the temperatures after the flows, for the cells with nonzero `of`, from the previous iterates.
    #[inline(always)]
    fn heat<const W: usize>(self, start: &Start<W>, found: &mut Found<W>, of: &[u64; W]) {
        let mut softening = [0.0; W];
        let mut middle = [0.0; W];
        for i in 0..W {
            middle[i] = 0.5 * (start.temperature_rise[i] + found.temperature_rise[i]);
        }
        self.softening(&middle, &mut softening);
        for i in 0..W {
            let (excess, flow, cold) = (start.excess[i], found.flow[i], start.cold[i]);
            let end = cold + start.slope[i] * flow;
            let left = excess + start.rise[i] - flow - (found.softening[i] * end - start.softening[i] * cold);
            let overstress = 0.5 * (excess + if left > 0.0 { left } else { 0.0 });
            let work = (softening[i] * (0.5 * (cold + end)) + overstress) * flow;
            let temperature_rise = start.temperature_rise[i] + self.rise * work;
            let temperature_rise = if temperature_rise < self.range { temperature_rise } else { self.range };
            found.temperature_rise[i] = if of[i] != 0 { temperature_rise } else { found.temperature_rise[i] };
        }
        self.softening(&found.temperature_rise, &mut found.softening);
    }
}

/// Share of the range to melting below which there is no softening.
const LEAST: f64 = 1e-40;

/// State of the cells at the start of a step.
struct Start<const W: usize> {
    sign: [f64; W],
    /// Stress beyond the elastic limit, and its rise if nothing flows; Pa.
    excess: [f64; W],
    rise: [f64; W],
    /// Elastic limit on the cold curve in the sense of the stress (`cold`), its difference from the static stress of first loading (`beside`), half
    /// the elastic range (`half`) and its derivative with respect to the flow (`widens`), and the limit in the other sense (`across`); Pa.
    cold: [f64; W],
    beside: [f64; W],
    half: [f64; W],
    widens: [f64; W],
    across: [f64; W],
    back: [f64; W],
    /// Slope of the cold curve, and E times the plastic strain at the end of the piece.
    slope: [f64; W],
    end: [f64; W],
    /// Temperature rise, K, and softening factor of the cold curve.
    temperature_rise: [f64; W],
    softening: [f64; W],
    /// Result of [`Closed::at_start`].
    of_law: [f64; W],
}

impl<const W: usize> Start<W> {
    /// Returns the elastic limit in the sense of the stress, the static stress of first loading, and half the elastic range of cell `i`, Pa.
    #[inline(always)]
    fn stresses(&self, i: usize) -> [f64; 3] {
        [self.cold[i], self.cold[i] - self.beside[i], self.half[i]].map(|cold| self.softening[i] * cold)
    }
}

/// Iterates of the flows and temperatures.
struct Found<const W: usize> {
    flow: [f64; W],
    /// Previously tried flow, and the error of its result.
    before: [f64; W],
    off: [f64; W],
    temperature_rise: [f64; W],
    softening: [f64; W],
    /// 1 for cells whose flow has not converged yet, else 0.
    sought: [u64; W],
}

/// An overstress law in steps of `time`, s.
#[derive(Debug, Clone, Copy)]
struct Many<'a, L> {
    law: L,
    curves: Sides<'a>,
    /// Result of [`super::RateLaw::moving`].
    moving: [f64; 2],
    time: f64,
    heating: Option<TemperatureRise>,
}

/// Advances the cells if the law has a closed formula, see [`Many::step`]; otherwise does nothing.
#[inline(always)]
pub(super) fn step_batch<const N: usize, const W: usize>(
    law: &RateLaw,
    time: f64,
    heating: Option<TemperatureRise>,
    cells: [&[f64; W]; 2],
    state: [&[f64; W]; N],
    after: &mut Steps<N, W>,
) {
    let (curves, moving) = (law.curves(), law.moving());
    match law.overstress {
        Overstress::Malvern { k } => {
            Many { law: Malvern { k }, curves, moving, time, heating }.step(cells, state, after);
        }
        Overstress::JohnsonCook { c, rate } => {
            Many { law: JohnsonCook { c, rate }, curves, moving, time, heating }.step(cells, state, after);
        }
        Overstress::CowperSymonds { rate, exponent } if exponent > 1.0 => {
            let law = PowerAboveOne { rate, exponent, thermal: None };
            Many { law, curves, moving, time, heating }.step(cells, state, after);
        }
        // With heating, its rate depends on the temperature too.
        Overstress::ZerilliArmstrong { stress, sensitivity, rate, .. } if sensitivity < 1.0 && heating.is_none() => {
            let law = PowerAboveOne { rate, exponent: sensitivity.recip(), thermal: Some(stress) };
            Many { law, curves, moving, time, heating }.step(cells, state, after);
        }
        _ => {}
    }
}

impl<L: Closed> Many<'_, L> {
    /// Advances cells from stresses `sigma` and states `state`, given their elastic predictors. Sets `after.known` to 1 for the cells whose result is
    /// valid.
    #[inline(always)]
    fn step<const N: usize, const W: usize>(
        &self,
        [sigma, predictor]: [&[f64; W]; 2],
        state: [&[f64; W]; N],
        after: &mut Steps<N, W>,
    ) {
        let start = self.start(sigma, predictor, state);
        let mut found = Found {
            flow: [0.0; W],
            before: [f64::NAN; W],
            off: [f64::NAN; W],
            temperature_rise: start.temperature_rise,
            softening: start.softening,
            sought: [0; W],
        };
        for i in 0..W {
            let [limit, f, half] = start.stresses(i);
            let stress = limit + start.excess[i];
            // The starting value is the flow of the previous step.
            found.flow[i] = state[2][i] * self.law.width(start.excess[i], f);
            found.sought[i] = u64::from(start.excess[i] > rounding(stress, [-half, half], start.back[i]));
        }
        for _ in 0..MAX_ITERATIONS {
            if found.sought.iter().fold(0, |any, sought| any | sought) == 0 {
                break;
            }
            self.sweep(&start, &mut found);
        }
        if let Some(heating) = self.heating {
            heating.heat(&start, &mut found, &[1; W]);
        }
        for i in 0..W {
            let (flow, softening) = (found.flow[i], found.softening[i]);
            let [limit, _, half] = start.stresses(i);
            let limit_end = start.cold[i] + start.slope[i] * flow;
            let across = start.softening[i] * start.across[i];
            let flown = Flown {
                sign: start.sign[i],
                excess: start.excess[i],
                rise: start.rise[i],
                flow,
                limit: [limit, softening * limit_end],
                half: [half, softening * (start.half[i] + start.widens[i] * flow)],
                across: [across, if self.moves::<N>() { half } else { across }],
                back: start.back[i],
                gain: 1.0 + softening * start.slope[i],
                end: start.end[i],
                is_found: (found.sought[i] == 0) & (flow >= 0.0),
            };
            let f_end = softening * (limit_end - start.beside[i]);
            flown.note(i, [sigma[i], predictor[i]], |x| self.law.width(x, f_end), state, after);
            let flows = after.plastic[i] != 0.0;
            if self.heating.is_some() {
                after.state[5][i] = if flows { found.temperature_rise[i] } else { start.temperature_rise[i] };
            }
            if self.moves::<N>() {
                after.state[N - 1][i] = start.back[i] + self.moving[0] * start.slope[i] * after.plastic[i];
            }
        }
    }

    /// Returns true if the state has a back stress, as its last variable.
    #[inline(always)]
    fn moves<const N: usize>(&self) -> bool {
        N > 5 + usize::from(self.heating.is_some())
    }

    #[inline(always)]
    fn start<const N: usize, const W: usize>(
        &self,
        sigma: &[f64; W],
        predictor: &[f64; W],
        state: [&[f64; W]; N],
    ) -> Start<W> {
        let zeros = [0.0; W];
        let located = self.curves.locate(sigma, predictor, state[0]);
        let mut start = Start {
            sign: zeros,
            excess: zeros,
            rise: zeros,
            cold: located.stress,
            beside: zeros,
            half: located.stress,
            widens: located.slope,
            across: located.across,
            back: zeros,
            slope: located.slope,
            end: located.end,
            temperature_rise: zeros,
            softening: [1.0; W],
            of_law: zeros,
        };
        if let Some(heating) = self.heating {
            start.temperature_rise = *state[5];
            heating.softening(&start.temperature_rise, &mut start.softening);
        }
        if self.moves::<N>() {
            start.back = *state[N - 1];
        }
        for i in 0..W {
            let back = start.back[i];
            let sign = 1.0_f64.copysign(sigma[i] - start.softening[i] * back);
            if self.moves::<N>() {
                let [kinematic, yield_stress] = self.moving;
                let (half, widens) = half_range_and_slope(kinematic, yield_stress, located.stress[i], located.slope[i]);
                (start.half[i], start.widens[i]) = (half, widens);
                (start.cold[i], start.across[i]) = (half + sign * back, half - sign * back);
                start.beside[i] = start.cold[i] - located.stress[i];
            }
            let [limit, f, _] = start.stresses(i);
            start.sign[i] = sign;
            start.excess[i] = sign * sigma[i] - limit;
            start.rise[i] = sign * (predictor[i] - sigma[i]);
            start.of_law[i] = self.law.at_start(start.excess[i], f);
        }
        start
    }

    /// Computes the next iterates of flows and temperatures.
    #[inline(always)]
    fn sweep<const W: usize>(&self, start: &Start<W>, found: &mut Found<W>) {
        let rise_before = found.temperature_rise;
        if let Some(heating) = self.heating {
            let sought = found.sought;
            heating.heat(start, found, &sought);
        }
        let near = self.heating.map_or(0.0, |heating| FOUND * heating.range * heating.range);
        for i in 0..W {
            let (excess, rise, flow) = (start.excess[i], start.rise[i], found.flow[i]);
            let (cold, slope, temperature_rise) = (start.cold[i], start.slope[i], found.temperature_rise[i]);
            let [g, g_end] = [start.softening[i], found.softening[i]];
            // Mean slopes, over the flow, of the elastic limit and of the static stress.
            let rises = |cold: f64| g_end * slope + if flow > 0.0 { (g_end - g) * cold / flow } else { 0.0 };
            let static_stress = cold - start.beside[i];
            let (f, f_end) = (g * static_stress, g_end * (static_stress + slope * flow));
            let (mut gain, mut mean, mut over) = (1.0 + rises(cold), f, excess);
            if self.law.needs_static_stress() {
                // With u = x/f: f du = rise - (gain + u df/dp) dp.
                let left = excess + rise - flow - (g_end * (cold + slope * flow) - g * cold);
                over = excess / f;
                mean = 0.5 * (f + f_end);
                gain += 0.5 * (over + if left > 0.0 { left / f_end } else { 0.0 }) * rises(static_stress);
                over *= mean;
            }
            let driven = Driven { excess: over, rise, time: self.time };
            let (answer, holds) = self.law.flow(driven, gain, mean, [start.of_law[i], flow]);
            let off = answer - flow;
            let secant = flow - off * (flow - found.before[i]) / (off - found.off[i]);
            let next = if (secant > 0.0) & (secant < excess + rise.abs() + f) { secant } else { answer };
            // Distance of the result from the fixed point.
            let error = if next == secant { answer - next } else { off };
            let tolerance = Tolerance::of_differences(excess + rise.abs()).at(flow);
            let is_there = holds
                & (error.abs() <= tolerance)
                & ((temperature_rise - rise_before[i]).abs() * (temperature_rise - start.temperature_rise[i]) <= near);
            found.before[i] = flow;
            found.off[i] = off;
            found.flow[i] = if found.sought[i] != 0 { next } else { flow };
            found.sought[i] &= u64::from(!is_there);
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use crate::law::rate::{Heated, Overstress, RateLaw, Timed};
    use crate::law::{CellLaw, Response, Steps, Table};
    use crate::material::{Beyond, Curve, Heating, Material};

    const MODULUS: f64 = 200e9;

    /// One law of each form.
    pub const LAWS: [Overstress; 4] = [
        Overstress::Malvern { k: 1e6 },
        Overstress::JohnsonCook { c: 0.02, rate: MODULUS },
        Overstress::CowperSymonds { rate: 40.0 * MODULUS, exponent: 5.0 },
        Overstress::ZerilliArmstrong { stress: 300e6, sensitivity: 0.1, rate: MODULUS, thermal: [5e-3, 3e-4] },
    ];

    fn curve() -> Curve {
        Curve::new(&[(0.001, 200e6), (0.004, 260e6), (0.05, 340e6)], Beyond::Extend).expect("rows rise")
    }

    fn power_law(rows: u32) -> Curve {
        let strain = |k: u32| 1e-3 * 50.0_f64.powf(f64::from(k) / f64::from(rows - 1));
        let rows: Vec<(f64, f64)> = (0..rows).map(|k| (strain(k), 200e6 * (strain(k) / 1e-3).powf(0.2))).collect();
        Curve::new(&rows, Beyond::Extend).expect("rows rise")
    }

    /// Heating constants of steel.
    pub fn heating(exponent: f64) -> Heating {
        let mut steel =
            Material { modulus: MODULUS, ..Material::from_curve("steel", 7800.0, curve()).expect("a material") };
        let heat = &mut steel.constants.heat;
        (heat.specific_heat, heat.exponent) = (Some(480.0), Some(exponent));
        (heat.reference_temperature, heat.melting_temperature) = (Some(293.0), Some(1800.0));
        *steel.heated(Some(0.9)).expect("all constants are there").heating.expect("it heats")
    }

    /// Loads and unloads a cell, and compares the results for most cells with those of the search for a single cell.
    fn assert_found<L: CellLaw<N>, const N: usize>(law: &L, what: &str) {
        let moves = N > 5 + usize::from(!law.temperature([0.0; N]).is_nan());
        let (mut sigma, mut state, mut known) = (0.0, [0.0; N], 0);
        for step in 0..4000 {
            let part = f64::from(step) / 400.0;
            let predictor = sigma + 4e6 * part.sin() * (1.0 + (7.0 * part).cos());
            let mut alone = Steps::<N, 1>::unknown();
            law.respond_batch(&[sigma], &[predictor], state.each_ref().map(std::array::from_ref), &mut alone);
            let other = law.respond_scalar(sigma, predictor, state);
            if alone.known[0] != 0 {
                let most = alone.of(0);
                known += usize::from(most.plastic != 0.0);
                let of = |r: &Response<N>| {
                    [r.sigma, r.plastic, r.state[0], r.state[1], r.state[3], if moves { r.state[N - 1] } else { 0.0 }]
                };
                let mut off = of(&most).into_iter().zip(of(&other)).map(|(one, other)| (one - other).abs());
                assert!(off.all(|off| off <= 1e-12 * sigma.abs()), "{what}, step {step}: {most:?} {other:?}");
                let warmer = law.temperature(most.state) - law.temperature(other.state);
                assert!(warmer.is_nan() || warmer.abs() <= 1e-10, "{what}, step {step}: {most:?} {other:?}");
            }
            (sigma, state) = (other.sigma, other.state);
        }
        assert!(known > 1000, "{what}: {known}");
    }

    #[test]
    fn most_cells_are_known_and_are_where_their_own_search_takes_them() {
        let table = Table::new(&curve(), MODULUS);
        let stronger = [(0.001, 200e6), (0.0015, 230e6), (0.003, 270e6), (0.05, 420e6)];
        let compression = Table::new(&Curve::new(&stronger, Beyond::Extend).expect("rows rise"), MODULUS);
        let of_many_rows = Table::new(&power_law(200), MODULUS);
        for overstress in LAWS {
            for time in [1e-9, 1e-7, 1e-5] {
                for (table, own) in [(&table, None), (&table, Some(&compression)), (&of_many_rows, None)] {
                    let law = RateLaw::new(overstress, table, own, 0.0);
                    let lines = table.lines().len();
                    assert_most_are_found(&law, time, &format!("{overstress:?} {time} {lines} {}", own.is_some()));
                }
                for (table, kinematic) in [(&table, 1.0), (&table, 0.4), (&of_many_rows, 0.7)] {
                    let law = RateLaw::new(overstress, table, None, kinematic);
                    assert_most_are_found(&law, time, &format!("{overstress:?} {time} kinematic {kinematic}"));
                }
            }
        }
    }

    fn assert_most_are_found(law: &RateLaw, time: f64, what: &str) {
        let moves = law.kinematic > 0.0;
        if moves {
            assert_found(&Timed::<6>::new(law.clone(), time), what);
        } else {
            assert_found(&Timed::<5>::new(law.clone(), time), what);
        }
        if matches!(law.overstress(), Overstress::ZerilliArmstrong { .. }) {
            return;
        }
        for exponent in [1.0, 1.09] {
            let (law, heating, what) = (law.clone(), heating(exponent), format!("{what}, heated, m = {exponent}"));
            if moves {
                assert_found(&Heated::<7>::new(law, &heating, MODULUS, time), &what);
            } else {
                assert_found(&Heated::<6>::new(law, &heating, MODULUS, time), &what);
            }
        }
    }
}

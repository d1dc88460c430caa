//! Material laws for the solvers. A law maps the state of a cell and a strain increment to the stress and the new state.
//!
//! All laws work in stress units. The strain of a cell enters as E times strain, so that the elastic step is
//! `sigma + E d_eps` with no division, and so that a law reduces to the elastic one **bit for bit** until the
//! cell first yields. Solvers use this: rows of cells that have never yielded run the elastic kernel and carry
//! no plastic state at all.
//!
//! A law is a pure function: it receives the elastic predictor and the state at the start of a step and returns the stress and
//! the state at its end. The state contains exactly what the law needs: `N` numbers per cell of a [`CellLaw`].

mod aligned;
mod armstrong_frederick;
mod backbone;
mod data_end;
mod elastic;
mod heat;
mod overlay;
mod path_independent;
mod plastic;
pub mod rate;
mod reversals;
mod row;
pub mod rupture;

use std::ops::Range;

use crate::material::{Heating, Sense};
use crate::root::bisect;

use heat::AdiabaticTemperature;

pub use aligned::{Aligned, AlignedRow, aligned_row, split_off};
pub use armstrong_frederick::{ArmstrongFrederick, BackStress};
pub(crate) use backbone::PieceIndex;
pub use backbone::{Backbone, Chord, Envelope, Indexed, Line, Searched, Table, TwoSided};
pub use data_end::{DataEnd, FirstPassed, Flowing, Limit, Passed, Reached, StrainedRow};
pub use elastic::elastic_row;
pub use overlay::Overlay;
pub use path_independent::PathIndependent;
pub use plastic::{Isotropic, Mixed};
pub use reversals::Reversals;

pub use row::{Advanced, Row, any_flows, flows, piece_flows};

/// Number of partial sums (lanes) of a sum over cells. A fixed number makes the bits of the sum independent of the width of the
/// processor's registers.
pub const LANES: usize = 8;

/// Number of cells of a row that are advanced together.
pub const CHUNK: usize = 64;

/// Relative distance of a stress from yield within which only the return mapping of the cell decides whether it flows. The mapping compares the
/// stress with the stress on the curve. Their difference is this distance times (1 - slope of the curve), which exceeds rounding for slopes up to 1 -
/// 1e-6.
const CLOSE_TO_YIELD: f64 = 1e-9;

/// Smallest plastic fraction of a strain increment for which [`CellLaw::complete_flow`] lets a cell flow further; below it the curve counts as elastic
/// there. Also the largest fraction of the plastic strain by which the cell may flow without a strain increment (viscoplastic flow) or while it
/// unloads.
const LEAST_FLOW: f64 = 1e-3;

/// Returns the largest stress magnitude (Pa) that lies inside the elastic range in both senses, with a margin of 2 [`CLOSE_TO_YIELD`]. Returns 0 if
/// the range does not contain 0.
fn within([low, high]: [f64; 2]) -> f64 {
    let margin = 2.0 * CLOSE_TO_YIELD * (high.abs() + low.abs());
    (high - margin).min(-low - margin).max(0.0)
}

/// Result of one step of one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<const N: usize> {
    /// Stress at the end of the step, Pa.
    pub sigma: f64,
    /// State at the end of the step.
    pub state: [f64; N],
    /// E times the plastic strain increment, Pa, signed; exactly 0 in an elastic step.
    pub plastic: f64,
}

impl<const N: usize> Response<N> {
    /// Returns `plastic` times the effective stress at the start of the step, which began at stress `sigma`, Pa^2. It is negative if the cell crosses
    /// its elastic range from the other side. The plastic work of such a cell is that of the stress at the end of the step, since the mean stress of
    /// the step may have the other sign. The plastic work of all other cells is that of the mean stress.
    #[inline(always)]
    pub fn onset(&self, sigma: f64, back_stress: f64) -> f64 {
        (sigma - back_stress) * self.plastic
    }
}

/// Results of one step of neighbouring cells.
#[derive(Debug)]
pub struct Steps<const N: usize, const W: usize = CHUNK> {
    /// Stress of each cell at the end of the step, Pa, as in [`Response`].
    pub sigma: [f64; W],
    /// State of each cell at the end of the step, one array per state variable, as in [`Response`].
    pub state: [[f64; W]; N],
    /// E times the plastic strain increment of each cell, Pa, as in [`Response`].
    pub plastic: [f64; W],
    /// 1 for each cell whose result has been computed, else 0.
    pub known: [u64; W],
}

impl<const N: usize, const W: usize> Steps<N, W> {
    /// Returns results in which no cell is known.
    #[inline(always)]
    fn unknown() -> Self {
        Self { sigma: [0.0; W], state: [[0.0; W]; N], plastic: [0.0; W], known: [0; W] }
    }

    /// Returns the result of cell `i`.
    #[inline(always)]
    fn of(&self, i: usize) -> Response<N> {
        let mut state = [0.0; N];
        for (value, column) in state.iter_mut().zip(&self.state) {
            *value = column[i];
        }
        Response { sigma: self.sigma[i], state, plastic: self.plastic[i] }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, response: &Response<N>) {
        (self.sigma[i], self.plastic[i]) = (response.sigma, response.plastic);
        for (column, value) in self.state.iter_mut().zip(response.state) {
            column[i] = value;
        }
    }
}

/// Slow deformation of a cell before t = 0.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Deformed {
    /// E times the signed plastic strain, Pa.
    pub plastic: f64,
    /// E times the accumulated plastic strain, Pa, >= |`plastic`|.
    pub accumulated: f64,
    /// Temperature above the reference temperature, K, >= 0.
    pub temperature_rise: f64,
}

/// A material law with `N` state numbers per cell, as pure functions. `predictor` is `base + E d_eps`.
pub trait CellLaw<const N: usize>: Send + Sync + Sized {
    /// Returns the quantity to which the strain increment is added: the stress, or the total E eps.
    fn base(&self, sigma: f64, state: [f64; N]) -> f64;

    /// Returns the cell at the end of a step that began at stress `sigma`.
    fn respond(&self, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N>;

    /// Returns a negative number if the plastic work of a step is not that of its mean stress, but [`Self::turned_work`]: if the cell crosses its
    /// elastic range from the other side (see [`Response::onset`]), or flows in both senses.
    #[inline(always)]
    fn onset(&self, sigma: f64, state: [f64; N], after: &Response<N>) -> f64 {
        after.onset(sigma, self.back_stress(state))
    }

    /// Returns the plastic work of such a step times 2 E per volume, Pa^2.
    #[inline(always)]
    fn turned_work(&self, _state: [f64; N], after: &Response<N>) -> f64 {
        2.0 * after.sigma * after.plastic
    }

    /// Whether the law reads a table that is faster to read for many cells at once. `respond` then equals `table_abscissa`, `interpolate` and
    /// `return_map` in turn.
    const READS_TABLE: bool = false;

    /// Returns the abscissa at which the law reads its table, Pa, >= 0.
    #[inline(always)]
    fn table_abscissa(&self, _predictor: f64, _state: [f64; N]) -> f64 {
        0.0
    }

    /// Reads the table for neighbouring cells, given their [`Self::table_abscissa`] and predictors. Writes the stresses into `table`, Pa.
    #[inline(always)]
    fn interpolate(&self, _reach: &[f64], _predictor: &[f64], _table: &mut [f64]) {}

    /// Returns [`Self::respond`], given the stress of the table at [`Self::table_abscissa`]. Only for laws with [`Self::READS_TABLE`].
    #[inline(always)]
    fn return_map(&self, predictor: f64, state: [f64; N], _table: f64) -> Response<N> {
        self.respond(predictor, predictor, state)
    }

    /// Whether the law implements [`Self::is_elastic_up_to`]. Neighbouring cells that all stay elastic are then advanced by a shorter kernel.
    const BOUNDS_ELASTICITY: bool = false;

    /// Returns true if every cell with |predictor| <= `size` (Pa) and [`Self::accumulated`] >= `accumulated` (Pa) stays elastic.
    /// Returns false if this is not certain.
    #[inline(always)]
    fn is_elastic_up_to(&self, _size: f64, _accumulated: f64) -> bool {
        false
    }

    /// Returns the stress magnitude (Pa) up to which all of these cells stay elastic in either sense with their states unchanged; 0 if it is not
    /// known. No cell yields below `yield_stress`.
    fn elastic_up_to(&self, _yield_stress: f64, _cells: impl Iterator<Item = [f64; N]>) -> f64 {
        0.0
    }

    /// Lets a cell under stress `sigma`, which has just flowed, flow by about `plastic` more (E times plastic strain, Pa, not 0) and then takes back
    /// the strain that this needed. Returns the cell after that, and the work of the plastic strain times 2 E per volume, Pa^2. Returns `None` if the
    /// cell does not unload elastically, if it flows without a strain increment (rate-dependent laws), or if the curve is very nearly as steep as the
    /// elastic line.
    fn complete_flow(&self, sigma: f64, plastic: f64, state: [f64; N]) -> Option<(Response<N>, f64)> {
        let strained = |sigma: f64, state: [f64; N], increment: f64| {
            self.respond(sigma, self.base(sigma, state) + increment, state)
        };
        let in_time = if Self::TAKES_TIME { strained(sigma, state, 0.0).plastic / plastic } else { 0.0 };
        let part = strained(sigma, state, plastic).plastic / plastic;
        if part.is_nan() || part < LEAST_FLOW || in_time.abs() > LEAST_FLOW {
            return None;
        }
        let flowed = strained(sigma, state, plastic / part);
        let after = strained(flowed.sigma, flowed.state, -plastic / part);
        if after.plastic.abs() > LEAST_FLOW * flowed.plastic.abs() {
            return None;
        }
        let work = (sigma + flowed.sigma) * flowed.plastic + (flowed.sigma + after.sigma) * after.plastic;
        Some((Response { plastic: flowed.plastic + after.plastic, ..after }, work))
    }

    /// Returns E times the signed plastic strain, Pa.
    fn plastic_strain(&self, state: [f64; N]) -> f64;

    /// Returns the state after slow loading and unloading. The default is the state after first loading to the signed plastic strain; a law whose
    /// hardening has a sense needs no more. The temperature of `Deformed` is not used.
    fn deformed(&self, Deformed { plastic, .. }: &Deformed) -> [f64; N] {
        let plastic = *plastic;
        if plastic == 0.0 {
            return [0.0; N];
        }
        let loaded = |size: f64| self.respond(0.0, size.copysign(plastic), [0.0; N]).state;
        let falls_short = |size: f64| self.plastic_strain(loaded(size)).abs() < plastic.abs();
        let (mut low, mut high) = (plastic.abs(), 2.0 * plastic.abs());
        while falls_short(high) && high < f64::MAX {
            (low, high) = (high, 2.0 * high);
        }
        loaded(bisect([low, high], 0.0, falls_short))
    }

    /// Returns E times the accumulated plastic strain, Pa, >= 0.
    fn accumulated(&self, state: [f64; N]) -> f64;

    /// Returns E times the plastic strain of first loading to the point at which the law reads its table, Pa, >= 0.
    fn along_table(&self, state: [f64; N]) -> f64 {
        self.accumulated(state)
    }

    /// Returns the back stress, Pa: the middle of the elastic range as far as hardening moves it.
    fn back_stress(&self, _state: [f64; N]) -> f64 {
        0.0
    }

    /// Returns the reversals that the cell remembers. Most laws remember none.
    fn reversals(&self, _state: [f64; N]) -> Reversals {
        Reversals::default()
    }

    /// Returns the sense in which the cell flows, if it flows.
    fn sense(&self, sigma: f64, state: [f64; N]) -> Sense {
        Sense::of(sigma - self.back_stress(state))
    }

    /// Returns true if the cell is flowing rather than elastic.
    fn yields(&self, sigma: f64, state: [f64; N]) -> bool {
        data_end::yields(self, sigma, state)
    }

    /// Whether plastic strain takes time (viscoplastic laws). Only then do the functions below have a meaning.
    const TAKES_TIME: bool = false;

    /// Computes [`Self::respond`] for neighbouring cells by a closed formula that holds for most of them, and sets `known` for these.
    #[inline(always)]
    fn respond_batch<const W: usize>(
        &self,
        _sigma: &[f64; W],
        _predictor: &[f64; W],
        _state: [&[f64; W]; N],
        _after: &mut Steps<N, W>,
    ) {
    }

    /// Computes [`Self::respond`] for a cell for which [`Self::respond_batch`] has no result.
    #[inline(always)]
    fn respond_scalar(&self, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N> {
        self.respond(sigma, predictor, state)
    }

    /// Returns E times the work of the overstress above the static curve since the start, per volume, Pa^2.
    fn overstress_work(&self, _state: [f64; N]) -> f64 {
        0.0
    }

    /// With [`Self::TAKES_TIME`]: returns true if the plastic strain is growing.
    fn flows(&self, _state: [f64; N]) -> bool {
        false
    }

    /// Returns true if the cell came to its static curve in its latest step, or nearly.
    fn is_relaxed(&self, _state: [f64; N]) -> bool {
        true
    }

    /// Returns the temperature, K; NaN for laws without a temperature.
    fn temperature(&self, _state: [f64; N]) -> f64 {
        f64::NAN
    }

    /// Returns the fraction of the plastic work that turns into heat.
    fn heat_fraction(&self) -> f64 {
        0.0
    }
}

/// Computes [`CellLaw::respond`] for a law with [`CellLaw::respond_batch`], by the operations that the cell would see among others. The bits
/// therefore do not depend on how many cells are advanced at once.
#[inline]
fn respond_alone<L: CellLaw<N>, const N: usize>(law: &L, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N> {
    let mut alone = Steps::<N, 1>::unknown();
    law.respond_batch(&[sigma], &[predictor], state.each_ref().map(std::array::from_ref), &mut alone);
    if alone.known[0] == 0 { law.respond_scalar(sigma, predictor, state) } else { alone.of(0) }
}

/// Interface of a law to the solvers: operates on whole rows of cells and is chosen once per run.
///
/// `state` holds `state_len()` numbers per cell, one state variable after the other.
pub trait RowLaw: Send + Sync {
    /// Returns the number of state variables per cell.
    fn state_len(&self) -> usize;

    /// Advances the row by one step.
    fn advance(&self, row: Row<'_>, state: &mut [f64]) -> Advanced;

    /// Applies [`CellLaw::complete_flow`] to cell `i` of a row. Returns E times the plastic strain, Pa, and its work times 2 E per volume, Pa^2. Both are 0
    /// if the cell is left unchanged.
    fn complete_flow(&self, plastic: f64, i: usize, sigma: &mut [f64], state: &mut [f64]) -> [f64; 2];

    /// Advances the row as [`RowLaw::advance`] does, with E times the strain increment of every cell (Pa) given; `work` is as in [`Row`].
    fn strain(&self, increment: &[f64], sigma: &mut [f64], state: &mut [f64], work: &mut [f64]);

    /// Returns [`CellLaw::elastic_up_to`] for all cells of a row, Pa.
    fn elastic_up_to(&self, yield_stress: f64, state: &[f64]) -> f64;

    /// Returns true if another step without strain would change no bit of these cells of the row.
    fn rests(&self, sigma: &[f64], state: &[f64], cells: Range<usize>) -> bool;

    /// Records the cells of a row that have reached a limit of the law.
    fn note_limits(&self, end: &DataEnd, row: &StrainedRow<'_>, passed: &mut FirstPassed);

    /// Returns E times the signed plastic strain of cell `i` of a row, Pa.
    fn plastic_strain(&self, state: &[f64], i: usize) -> f64;

    /// Returns E times the accumulated plastic strain of cell `i` of a row, Pa.
    fn accumulated(&self, state: &[f64], i: usize) -> f64;

    /// Returns the back stress of cell `i` of a row, Pa.
    fn back_stress(&self, state: &[f64], i: usize) -> f64;

    /// Returns the reversals that cell `i` of a row remembers. `state` is empty for a row that has never yielded.
    fn reversals(&self, state: &[f64], i: usize) -> Reversals;

    /// Returns E times the work of the overstress of all cells of a row since the start, per volume, Pa^2; 0 for laws without overstress.
    fn overstress_work(&self, state: &[f64]) -> f64;

    /// Clears `flow` in cells whose relaxation is resolved by the steps, i.e. cells for which [`CellLaw::is_relaxed`] is false.
    fn clear_resolved(&self, state: &[f64], flow: &mut [f32]);

    /// Returns the state of a cell after slow loading and unloading.
    fn deformed(&self, deformed: &Deformed) -> Vec<f64>;

    /// Returns the temperature of cell `i` of a row, K; NaN for laws without a temperature. `state` is empty for a row that has never yielded.
    fn temperature(&self, state: &[f64], i: usize) -> f64;

    /// Returns the fraction of the plastic work that turns into heat.
    fn heat_fraction(&self) -> f64;

    /// Returns true if cell `i` of a row flows by a rate-dependent law; false for other laws.
    fn flows(&self, state: &[f64], i: usize) -> bool;

    /// Returns E times the largest tensile strain of a row, Pa; 0 if all cells are in compression.
    fn largest_strain(&self, sigma: &[f64], state: &[f64]) -> f64;
}

/// Adapter that makes a [`RowLaw`] of a [`CellLaw`].
#[derive(Debug, Clone)]
pub struct Rows<L, const N: usize> {
    law: L,
    /// Temperature of a law that runs on adiabatic tables, else `None`.
    adiabatic: Option<AdiabaticTemperature>,
}

impl<L: CellLaw<N>, const N: usize> Rows<L, N> {
    /// Wraps a law that computes its temperature itself, or has none.
    pub fn new(law: L) -> Self {
        Self { law, adiabatic: None }
    }

    /// Wraps a law that runs on the adiabatic tables of a material with this elastic modulus, Pa.
    pub fn adiabatic(law: L, heating: &Heating, modulus: f64) -> Self {
        Self { law, adiabatic: Some(AdiabaticTemperature { heating: heating.clone(), modulus }) }
    }
}

impl<L: CellLaw<N>, const N: usize> RowLaw for Rows<L, N> {
    fn state_len(&self) -> usize {
        N
    }

    fn advance(&self, row: Row<'_>, state: &mut [f64]) -> Advanced {
        row::advance(&self.law, row, state)
    }

    fn complete_flow(&self, plastic: f64, i: usize, sigma: &mut [f64], state: &mut [f64]) -> [f64; 2] {
        let Some((after, work)) = self.law.complete_flow(sigma[i], plastic, cell_state(state, i)) else {
            return [0.0; 2];
        };
        sigma[i] = after.sigma;
        set_cell_state(state, i, after.state);
        [after.plastic, work]
    }

    fn strain(&self, increment: &[f64], sigma: &mut [f64], state: &mut [f64], work: &mut [f64]) {
        row::strain(&self.law, increment, sigma, state, work);
    }

    fn elastic_up_to(&self, yield_stress: f64, state: &[f64]) -> f64 {
        self.law.elastic_up_to(yield_stress, (0..state.len() / N).map(|i| cell_state(state, i)))
    }

    fn rests(&self, sigma: &[f64], state: &[f64], mut cells: Range<usize>) -> bool {
        cells.all(|i| {
            let before = cell_state(state, i);
            let after = self.law.respond(sigma[i], self.law.base(sigma[i], before), before);
            after.plastic == 0.0 && after.sigma == sigma[i] && after.state == before
        })
    }

    fn note_limits(&self, end: &DataEnd, row: &StrainedRow<'_>, passed: &mut FirstPassed) {
        data_end::note_limits(&self.law, end, row, passed);
    }

    fn plastic_strain(&self, state: &[f64], i: usize) -> f64 {
        self.law.plastic_strain(cell_state(state, i))
    }

    fn accumulated(&self, state: &[f64], i: usize) -> f64 {
        self.law.accumulated(cell_state(state, i))
    }

    fn back_stress(&self, state: &[f64], i: usize) -> f64 {
        self.law.back_stress(cell_state(state, i))
    }

    fn reversals(&self, state: &[f64], i: usize) -> Reversals {
        self.law.reversals(if state.is_empty() { [0.0; N] } else { cell_state(state, i) })
    }

    fn overstress_work(&self, state: &[f64]) -> f64 {
        if !L::TAKES_TIME {
            return 0.0;
        }
        (0..state.len() / N).map(|i| self.law.overstress_work(cell_state(state, i))).sum()
    }

    fn deformed(&self, deformed: &Deformed) -> Vec<f64> {
        self.law.deformed(deformed).to_vec()
    }

    fn clear_resolved(&self, state: &[f64], flow: &mut [f32]) {
        if !L::TAKES_TIME {
            return;
        }
        for (i, flow) in flow.iter_mut().enumerate().filter(|(_, flow)| **flow != 0.0) {
            if !self.law.is_relaxed(cell_state(state, i)) {
                *flow = 0.0;
            }
        }
    }

    fn temperature(&self, state: &[f64], i: usize) -> f64 {
        let state = if state.is_empty() { [0.0; N] } else { cell_state(state, i) };
        match &self.adiabatic {
            Some(adiabatic) => adiabatic.at(self.law.plastic_strain(state), self.law.accumulated(state)),
            None => self.law.temperature(state),
        }
    }

    fn heat_fraction(&self) -> f64 {
        self.adiabatic.as_ref().map_or_else(|| self.law.heat_fraction(), |adiabatic| adiabatic.heating.fraction)
    }

    fn flows(&self, state: &[f64], i: usize) -> bool {
        L::TAKES_TIME && self.law.flows(cell_state(state, i))
    }

    fn largest_strain(&self, sigma: &[f64], state: &[f64]) -> f64 {
        let strain = |(i, sigma): (usize, &f64)| sigma + self.law.plastic_strain(cell_state(state, i));
        sigma.iter().enumerate().map(strain).fold(0.0, f64::max)
    }
}

fn cell_state<const N: usize>(state: &[f64], i: usize) -> [f64; N] {
    let cells = state.len() / N;
    std::array::from_fn(|k| state[k * cells + i])
}

fn set_cell_state<const N: usize>(state: &mut [f64], i: usize, values: [f64; N]) {
    let cells = state.len() / N;
    for (k, value) in values.into_iter().enumerate() {
        state[k * cells + i] = value;
    }
}

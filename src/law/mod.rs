//! Material laws for the solvers: state and strain increment in, stress out.
//!
//! All laws work in stress units. A cell's strain enters as E times strain, so that the elastic step is
//! `sigma + E d_eps` with no division, and so that a law reduces to the elastic one **bit for bit** until the
//! cell first yields. Solvers use this: rows of cells that have never yielded run the elastic kernel and carry
//! no plastic state at all.
//!
//! A law is pure: it takes the elastic predictor and the state at the start of a step and returns those at its
//! end. State is exactly what the law needs, `N` numbers a cell of a [`CellLaw`].

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

/// Cells that sums run over side by side. Sums over cells keep one partial sum a lane, so that their bits do
/// not depend on how wide the processor's registers are.
pub const LANES: usize = 8;

/// Cells of a row that are stepped together.
pub const CHUNK: usize = 64;

/// Distance from yield, relative to the stress, within which a cell's own return mapping decides. The difference between a stress and that on
/// the curve, which the mapping compares, is this times 1 less the slope of the curve: above rounding up to a slope of 1 - 1e-6.
const CLOSE_TO_YIELD: f64 = 1e-9;

/// Least part of a strain that is plastic in a cell that flows on; else its curve is elastic there. Likewise, most of its plastic strain of a step by which a
/// cell goes on flowing in time.
const LEAST_FLOW: f64 = 1e-3;

/// Largest stress in either sense within an elastic range, Pa, but for what is [`CLOSE_TO_YIELD`]; 0 of a range that has moved beyond 0.
fn within([low, high]: [f64; 2]) -> f64 {
    let margin = 2.0 * CLOSE_TO_YIELD * (high.abs() + low.abs());
    (high - margin).min(-low - margin).max(0.0)
}

/// One step of one cell.
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
    /// Effective stress at the start of the step, which began at stress `sigma`, times `plastic`, Pa^2. It is negative where the cell
    /// comes from the other side of its elastic range: such a cell flows at the stress of the end of the step, since the mean stress of
    /// the step may be of the other sign. All others flow at the mean stress.
    #[inline(always)]
    pub fn onset(&self, sigma: f64, back_stress: f64) -> f64 {
        (sigma - back_stress) * self.plastic
    }
}

/// One step of neighbouring cells.
#[derive(Debug)]
pub struct Steps<const N: usize, const W: usize = CHUNK> {
    /// As in [`Response`], cell by cell.
    pub sigma: [f64; W],
    /// As in [`Response`], variable by variable.
    pub state: [[f64; W]; N],
    /// As in [`Response`], cell by cell.
    pub plastic: [f64; W],
    /// 1 in cells whose step is known, else 0.
    pub known: [u64; W],
}

impl<const N: usize, const W: usize> Steps<N, W> {
    /// Of none of the cells.
    #[inline(always)]
    fn unknown() -> Self {
        Self { sigma: [0.0; W], state: [[0.0; W]; N], plastic: [0.0; W], known: [0; W] }
    }

    /// Of cell `i`.
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

/// What a cell went through before t = 0, slowly.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Deformed {
    /// E times the signed plastic strain, Pa.
    pub plastic: f64,
    /// E times the accumulated plastic strain, Pa, >= the size of `plastic`.
    pub accumulated: f64,
    /// Temperature above the reference temperature, K, >= 0.
    pub temperature_rise: f64,
}

/// A law with `N` state numbers a cell. Pure; `predictor` is `base + E d_eps`.
pub trait CellLaw<const N: usize>: Send + Sync + Sized {
    /// What the strain increment is added to: the stress, or the total E eps.
    fn base(&self, sigma: f64, state: [f64; N]) -> f64;

    /// The cell at the end of a step that began at stress `sigma`.
    fn respond(&self, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N>;

    /// Negative where the plastic work of a step is not that of its mean stress, but [`Self::turned_work`]: where the cell comes from the
    /// other side of its elastic range, see [`Response::onset`], or flows in both senses.
    #[inline(always)]
    fn onset(&self, sigma: f64, state: [f64; N], after: &Response<N>) -> f64 {
        after.onset(sigma, self.back_stress(state))
    }

    /// The plastic work of such a step times 2 E per volume, Pa^2.
    #[inline(always)]
    fn turned_work(&self, _state: [f64; N], after: &Response<N>) -> f64 {
        2.0 * after.sigma * after.plastic
    }

    /// The law reads a table that is read faster for many cells at once: `respond` is then `table_abscissa`, `interpolate`, `return_map`.
    const READS_TABLE: bool = false;

    /// Where the law reads its table, Pa, >= 0.
    #[inline(always)]
    fn table_abscissa(&self, _predictor: f64, _state: [f64; N]) -> f64 {
        0.0
    }

    /// Reads the table for neighbouring cells: what they [`Self::table_abscissa`] and their predictors to the stresses there, Pa.
    #[inline(always)]
    fn interpolate(&self, _reach: &[f64], _predictor: &[f64], _table: &mut [f64]) {}

    /// [`Self::respond`], given the table's stress where the law asked for it; for laws that do.
    #[inline(always)]
    fn return_map(&self, predictor: f64, state: [f64; N], _table: f64) -> Response<N> {
        self.respond(predictor, predictor, state)
    }

    /// [`Self::is_elastic_up_to`] is known: neighbouring cells that all stay elastic take a short way.
    const BOUNDS_ELASTICITY: bool = false;

    /// True where all cells stay elastic whose predictors are at most of this `size` and whose [`Self::accumulated`] is at least this, Pa.
    /// False also where they may or may not.
    #[inline(always)]
    fn is_elastic_up_to(&self, _size: f64, _accumulated: f64) -> bool {
        false
    }

    /// Stress up to which all of these cells stay elastic in either sense, and their states as they are, Pa; 0 where that is not known.
    /// None of them yields below `yield_stress`.
    fn elastic_up_to(&self, _yield_stress: f64, _cells: impl Iterator<Item = [f64; N]>) -> f64 {
        0.0
    }

    /// A cell under stress `sigma`, which has just flowed, after it flowed on by about E times this plastic strain (Pa, not 0) and the strain that this takes
    /// was taken back. Also the work of the plastic strain times 2 E per volume, Pa^2. None where the cell does not unload
    /// elastically, where it goes on flowing by itself, in time, and where the curve is very nearly as steep as the elastic line.
    fn flow_on(&self, sigma: f64, plastic: f64, state: [f64; N]) -> Option<(Response<N>, f64)> {
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

    /// E times the signed plastic strain, Pa.
    fn plastic_strain(&self, state: [f64; N]) -> f64;

    /// The state after slow loading and unloading. This one is that of first loading to the signed plastic strain, which is all that a law
    /// needs whose hardening has a sense; the temperature is that of its start.
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

    /// E times the accumulated plastic strain, Pa, >= 0.
    fn accumulated(&self, state: [f64; N]) -> f64;

    /// E times the plastic strain of first loading to where the law reads its table, Pa, >= 0.
    fn along_table(&self, state: [f64; N]) -> f64 {
        self.accumulated(state)
    }

    /// Middle of the elastic range, as far as hardening moves it, Pa.
    fn back_stress(&self, _state: [f64; N]) -> f64 {
        0.0
    }

    /// What the cell remembers of reversals; nothing in most laws.
    fn reversals(&self, _state: [f64; N]) -> Reversals {
        Reversals::default()
    }

    /// The sense in which the cell flows if it flows.
    fn sense(&self, sigma: f64, state: [f64; N]) -> Sense {
        Sense::of(sigma - self.back_stress(state))
    }

    /// The cell flows, it is not elastic.
    fn yields(&self, sigma: f64, state: [f64; N]) -> bool {
        data_end::yields(self, sigma, state)
    }

    /// Plastic strain takes time: those below mean something.
    const TAKES_TIME: bool = false;

    /// [`Self::respond`] for neighbouring cells, `known` being set in those that it was done for: a plain formula that holds for most of them.
    #[inline(always)]
    fn respond_to_most<const W: usize>(
        &self,
        _sigma: &[f64; W],
        _predictor: &[f64; W],
        _state: [&[f64; W]; N],
        _after: &mut Steps<N, W>,
    ) {
    }

    /// [`Self::respond`] for a cell of which [`Self::respond_to_most`] does not know.
    #[inline(always)]
    fn respond_to_other(&self, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N> {
        self.respond(sigma, predictor, state)
    }

    /// E times the work of the overstress over the static curve since the start, per volume, Pa^2.
    fn overstress_work(&self, _state: [f64; N]) -> f64 {
        0.0
    }

    /// With [`Self::TAKES_TIME`]: plastic strain is growing.
    fn flows(&self, _state: [f64; N]) -> bool {
        false
    }

    /// In its latest step the cell came to its static curve, or nearly.
    fn keeps_up(&self, _state: [f64; N]) -> bool {
        true
    }

    /// Temperature, K; not a number for laws that know none.
    fn temperature(&self, _state: [f64; N]) -> f64 {
        f64::NAN
    }

    /// Fraction of the plastic work that turns into heat.
    fn heat_fraction(&self) -> f64 {
        0.0
    }
}

/// [`CellLaw::respond`] of a law that knows most cells at once: a cell alone takes the way that it takes among others.
#[inline]
fn respond_alone<L: CellLaw<N>, const N: usize>(law: &L, sigma: f64, predictor: f64, state: [f64; N]) -> Response<N> {
    let mut alone = Steps::<N, 1>::unknown();
    law.respond_to_most(&[sigma], &[predictor], state.each_ref().map(std::array::from_ref), &mut alone);
    if alone.known[0] == 0 { law.respond_to_other(sigma, predictor, state) } else { alone.of(0) }
}

/// A law as a solver holds it: whole rows at a time, chosen once a run.
///
/// `state` holds `state_len()` numbers a cell, one state variable after the other.
pub trait RowLaw: Send + Sync {
    /// State numbers a cell.
    fn state_len(&self) -> usize;

    /// One step of the row.
    fn advance(&self, row: Row<'_>, state: &mut [f64]) -> Advanced;

    /// As [`CellLaw::flow_on`], for cell `i` of a row. Returns E times the plastic strain, Pa, and its work times 2 E per volume, Pa^2: both 0 where nothing
    /// is done.
    fn flow_on(&self, plastic: f64, i: usize, sigma: &mut [f64], state: &mut [f64]) -> [f64; 2];

    /// As [`RowLaw::advance`], with E times the strain increment of every cell (Pa) given; `work` is as in [`Row`].
    fn strain(&self, increment: &[f64], sigma: &mut [f64], state: &mut [f64], work: &mut [f64]);

    /// As in [`CellLaw::elastic_up_to`], for all cells of a row.
    fn elastic_up_to(&self, yield_stress: f64, state: &[f64]) -> f64;

    /// True where another step without strain would change no bit of these cells of the row.
    fn rests(&self, sigma: &[f64], state: &[f64], cells: Range<usize>) -> bool;

    /// Notes the cells of a row that have come to a limit of what the law knows.
    fn note_limits(&self, end: &DataEnd, row: &StrainedRow<'_>, passed: &mut FirstPassed);

    /// E times the signed plastic strain of cell `i` of a row, Pa.
    fn plastic_strain(&self, state: &[f64], i: usize) -> f64;

    /// E times the accumulated plastic strain of cell `i` of a row, Pa.
    fn accumulated(&self, state: &[f64], i: usize) -> f64;

    /// Middle of the elastic range of cell `i` of a row, as far as hardening moves it, Pa.
    fn back_stress(&self, state: &[f64], i: usize) -> f64;

    /// What cell `i` of a row remembers of reversals (`state` is empty in a row that never yielded).
    fn reversals(&self, state: &[f64], i: usize) -> Reversals;

    /// E times the work of the overstress of all cells of a row since the start, per volume, Pa^2; 0 for laws without.
    fn overstress_work(&self, state: &[f64]) -> f64;

    /// Clears `flow` in cells that flow by a rate which the steps resolve.
    fn clear_resolved(&self, state: &[f64], flow: &mut [f32]);

    /// The state of a cell after slow loading and unloading.
    fn deformed(&self, deformed: &Deformed) -> Vec<f64>;

    /// Temperature of cell `i` of a row, K (`state` is empty in a row that never yielded); not a number for laws that know
    /// none.
    fn temperature(&self, state: &[f64], i: usize) -> f64;

    /// Fraction of the plastic work that turns into heat.
    fn heat_fraction(&self) -> f64;

    /// Cell `i` of a row flows by a rate; false for laws without.
    fn flows(&self, state: &[f64], i: usize) -> bool;

    /// E times the largest strain of a row, Pa; 0 where all is in compression.
    fn largest_strain(&self, sigma: &[f64], state: &[f64]) -> f64;
}

/// Makes a [`RowLaw`] of a [`CellLaw`].
#[derive(Debug, Clone)]
pub struct Rows<L, const N: usize> {
    law: L,
    /// Where the law runs on adiabatic tables.
    adiabatic: Option<AdiabaticTemperature>,
}

impl<L: CellLaw<N>, const N: usize> Rows<L, N> {
    /// Of a law that knows its temperature itself, or knows none.
    pub fn new(law: L) -> Self {
        Self { law, adiabatic: None }
    }

    /// Of a law that runs on the adiabatic tables of a material of this modulus, Pa.
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

    fn flow_on(&self, plastic: f64, i: usize, sigma: &mut [f64], state: &mut [f64]) -> [f64; 2] {
        let Some((after, work)) = self.law.flow_on(sigma[i], plastic, cell_state(state, i)) else { return [0.0; 2] };
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
            if !self.law.keeps_up(cell_state(state, i)) {
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

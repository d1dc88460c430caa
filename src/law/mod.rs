//! Material laws for the solvers: state and strain increment in, stress out.
//!
//! All laws work in stress units. A cell's strain enters as E times strain, so that the elastic step is
//! `sigma + E d_eps` with no division, and so that a law reduces to the elastic one **bit for bit** until the
//! cell first yields. Solvers use this: rows of cells that have never yielded run the elastic kernel and carry
//! no plastic state at all.
//!
//! A law is pure: it takes the elastic predictor and the state at the start of a step and returns those at its
//! end. State is exactly what the law needs, [`CellLaw::STATE`] numbers a cell.

mod backbone;
mod elastic;
mod path_independent;
mod plastic;

pub use backbone::{Backbone, Envelope, Indexed, Searched, Table, TwoSided};
pub use elastic::elastic_row;
pub use path_independent::PathIndependent;
pub use plastic::{Isotropic, Mixed};

use multiversion::multiversion;

/// Cells that a kernel treats side by side. Sums over cells keep one partial sum a lane, so that their bits do
/// not depend on how wide the processor's registers are.
pub const LANES: usize = 8;

/// One step of one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<const N: usize> {
    /// Stress at the end of the step, Pa.
    pub sigma: f64,
    /// State at the end of the step.
    pub state: [f64; N],
    /// E times the plastic strain increment, Pa, signed; exactly 0 in an elastic step.
    pub plastic: f64,
    /// How far along the loading table the cell has come: E times the equivalent strain, Pa, >= 0.
    pub reach: f64,
}

/// A law with `N` state numbers a cell. Pure; `predictor` is `base + E d_eps`.
pub trait CellLaw<const N: usize>: Send + Sync {
    /// What the strain increment is added to: the stress, or the total E eps.
    fn base(&self, sigma: f64, state: [f64; N]) -> f64;

    /// The cell at the end of a step.
    fn respond(&self, predictor: f64, state: [f64; N]) -> Response<N>;

    /// E times the signed plastic strain, Pa.
    fn plastic_strain(&self, state: [f64; N]) -> f64;

    /// E times the accumulated plastic strain, Pa, >= 0.
    fn accumulated(&self, state: [f64; N]) -> f64;
}

/// What a row of cells did in one step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RowReport {
    /// Sum of (sigma_before + sigma_after) * E d_eps_plastic, Pa^2: plastic work times 2 E per volume.
    pub plastic: f64,
    /// Largest [`Response::reach`] of the row, Pa (for an elastic row: the largest |stress|).
    pub reach: f64,
}

/// A law as a solver holds it: whole rows at a time, chosen once a run.
///
/// `v` has one entry more than the row has cells (the nodes on both sides); `gain` is E dt/dx, Pa s/m. `state`
/// holds `state_len()` numbers a cell, one state variable after the other.
pub trait RowLaw: Send + Sync {
    /// State numbers a cell.
    fn state_len(&self) -> usize;

    /// One step of the whole row. `flow` is set to 1 in cells that flow plastically in the step, to 0 in others.
    fn advance(&self, gain: f64, v: &[f64], sigma: &mut [f64], state: &mut [f64], flow: &mut [f64]) -> RowReport;

    /// The step in which a row that was elastic so far first yields: `sigma` holds the elastic predictor, `state`
    /// is zero; both are made right.
    fn first_yield(&self, gain: f64, v: &[f64], sigma: &mut [f64], state: &mut [f64], flow: &mut [f64]) -> RowReport;

    /// E times the signed plastic strain of cell `i` of a row, Pa.
    fn plastic_strain(&self, state: &[f64], i: usize) -> f64;

    /// E times the accumulated plastic strain of cell `i` of a row, Pa.
    fn accumulated(&self, state: &[f64], i: usize) -> f64;
}

/// Makes a [`RowLaw`] of a [`CellLaw`].
#[derive(Debug, Clone)]
pub struct Rows<L, const N: usize>(pub L);

impl<L: CellLaw<N>, const N: usize> RowLaw for Rows<L, N> {
    fn state_len(&self) -> usize {
        N
    }

    fn advance(&self, gain: f64, v: &[f64], sigma: &mut [f64], state: &mut [f64], flow: &mut [f64]) -> RowReport {
        row::<L, N, false>(&self.0, gain, v, sigma, state, flow)
    }

    fn first_yield(&self, gain: f64, v: &[f64], sigma: &mut [f64], state: &mut [f64], flow: &mut [f64]) -> RowReport {
        row::<L, N, true>(&self.0, gain, v, sigma, state, flow)
    }

    fn plastic_strain(&self, state: &[f64], i: usize) -> f64 {
        self.0.plastic_strain(cell_state(state, i))
    }

    fn accumulated(&self, state: &[f64], i: usize) -> f64 {
        self.0.accumulated(cell_state(state, i))
    }
}

fn cell_state<const N: usize>(state: &[f64], i: usize) -> [f64; N] {
    let cells = state.len() / N;
    std::array::from_fn(|k| state[k * cells + i])
}

/// One step of a row. With `FIRST`, `sigma` holds the predictor of a row that was elastic until now.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn row<L: CellLaw<N>, const N: usize, const FIRST: bool>(
    law: &L,
    gain: f64,
    v: &[f64],
    sigma: &mut [f64],
    state: &mut [f64],
    flow: &mut [f64],
) -> RowReport {
    let cells = sigma.len();
    let whole = cells - cells % LANES;
    let mut work = [0.0; LANES];
    let mut reach = [0.0; LANES];
    let mut columns = split_columns::<N>(state, cells);
    let mut start = 0;
    while start < cells {
        // A short last group runs on copies, so that every cell goes through the same arithmetic.
        let width = if start < whole { LANES } else { cells - start };
        let mut s = [0.0; LANES];
        let mut q = [[0.0; LANES]; N];
        let mut left = [0.0; LANES];
        let mut right = [0.0; LANES];
        let mut flows = [0.0; LANES];
        copy(&mut s, &sigma[start..], width);
        copy(&mut left, &v[start..], width);
        copy(&mut right, &v[start + 1..], width);
        for (k, column) in columns.iter().enumerate() {
            copy(&mut q[k], &column[start..], width);
        }
        for lane in 0..LANES {
            let increment = gain * (right[lane] - left[lane]);
            let before: [f64; N] = std::array::from_fn(|k| q[k][lane]);
            let (sigma_before, predictor) =
                if FIRST { (s[lane] - increment, s[lane]) } else { (s[lane], law.base(s[lane], before) + increment) };
            let after = law.respond(predictor, before);
            work[lane] += (sigma_before + after.sigma) * after.plastic;
            reach[lane] = after.reach.max(reach[lane]);
            s[lane] = after.sigma;
            flows[lane] = if after.plastic == 0.0 { 0.0 } else { 1.0 };
            for k in 0..N {
                q[k][lane] = after.state[k];
            }
        }
        sigma[start..start + width].copy_from_slice(&s[..width]);
        flow[start..start + width].copy_from_slice(&flows[..width]);
        for (k, column) in columns.iter_mut().enumerate() {
            column[start..start + width].copy_from_slice(&q[k][..width]);
        }
        start += width;
    }
    RowReport { plastic: work.iter().sum(), reach: reach.iter().fold(0.0, |m, &r| m.max(r)) }
}

#[inline(always)]
fn copy(to: &mut [f64; LANES], from: &[f64], width: usize) {
    if width == LANES {
        *to = from[..LANES].try_into().unwrap_or([0.0; LANES]);
    } else {
        to[..width].copy_from_slice(&from[..width]);
    }
}

#[inline(always)]
fn split_columns<const N: usize>(state: &mut [f64], cells: usize) -> [&mut [f64]; N] {
    let mut columns = state.chunks_exact_mut(cells);
    std::array::from_fn(|_| columns.next().unwrap_or_default())
}

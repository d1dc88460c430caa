//! Flow up to the moment at which a sharp unloading wave stops it.
//!
//! Cells flow for whole steps. An unloading wave reaches the middle of a cell halfway through a step, and the scheme takes the whole step
//! as elastic: half a step of flow is missing. Along a wave that travels to the right, with R = sigma - rho c0 v, the stress behind it
//! changes by (d sigma + rho c0 dv)/2, where sigma and v are those ahead of it; the scheme changes it by rho c0 dv, which is -dR/2 more.
//! Where the bar flows ahead of the wave, dR is -E times the plastic strain of a step. Summed over the cells of a plastic front, this is
//! half of the front's jump, at any resolution: uncorrected, the wave overshot by 30 to 55 % and left stresses that alternate from cell to
//! cell.
//!
//! The cell therefore first flows by half of the plastic strain of the step before, and then unloads, provided that it unloads by more than
//! that: a smaller unloading is no sharp wave, and the sign of a difference within rounding must not matter. The difference between this
//! correction and half of dR is, from cell to cell along the wave, the difference of quantities that vanish ahead of and behind the plastic
//! front. The filter's viscosity acts on a flowing cell in the same way, so that its share is missing, too ([`Filter::missing_flow`]).
//!
//! [`Filter::missing_flow`]: super::grid_filter::Filter::missing_flow

use std::ops::Range;

use multiversion::multiversion;

use super::block::{Block, BlockLaw, StoppedCell};
use super::sizes::MOST_CELLS;
use crate::law::{CHUNK, RowLaw, piece_flows};

impl Block {
    /// Continues the flow of cells that flowed in the step before and unload in this one, by more than the missing flow. `stopped` is set
    /// to these cells.
    pub fn complete_flow(&mut self, law: BlockLaw<'_>, stopped: &mut Vec<StoppedCell>) {
        stopped.clear();
        let missing_flow = law.filter.missing_flow();
        if missing_flow == 0.0 || !self.flows() {
            return;
        }
        let Range { start, end } = self.active;
        let found = find_stopping(law.stress_gain, missing_flow, &self.flow[start..end], &self.v[start..=end]);
        for (piece, mut cells) in found.into_iter().enumerate() {
            while cells != 0 {
                let cell = start + piece * CHUNK + cells.trailing_zeros() as usize;
                cells &= cells - 1;
                let (before, missing) = (self.sigma[cell], missing_flow * f64::from(self.flow[cell]));
                let [plastic, work] = law.law.complete_flow(missing, cell, &mut self.sigma, &mut self.state);
                let plastic_after = law.law.plastic_strain(&self.state, cell);
                stopped.push(StoppedCell { cell, sigma: [before, self.sigma[cell]], plastic, plastic_after, work });
            }
        }
    }

    /// Records their plastic work, after the step.
    pub fn record_stopped(&mut self, law: &dyn RowLaw, stopped: &[StoppedCell]) {
        for &StoppedCell { cell, sigma: [before, after], plastic, plastic_after, work } in stopped {
            // The mean stress of the step is formed with the stress before this flow, also if the cell flows in the other sense at the end
            // of the step.
            let later = law.plastic_strain(&self.state, cell) - plastic_after;
            let of_mean_stress = (before + self.sigma[cell]) * plastic + (before - after) * later;
            let area = self.area(cell);
            self.plastic += area * work;
            self.onset_correction += area * (work - of_mean_stress);
            if self.keeps_work {
                self.absorbed[cell] += work;
            }
        }
    }
}

/// Returns the cells that stop flowing, as the bits of one number for each piece of [`CHUNK`] cells. `gain` is E dt/dx.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn find_stopping(gain: f64, missing_flow: f64, flow: &[f32], v: &[f64]) -> [u64; MOST_CELLS / CHUNK] {
    let mut found = [0; MOST_CELLS / CHUNK];
    let (left, right) = (&v[..flow.len()], &v[1..]);
    for (((found, flow), left), right) in
        found.iter_mut().zip(flow.chunks(CHUNK)).zip(left.chunks(CHUNK)).zip(right.chunks(CHUNK))
    {
        if !piece_flows(flow) {
            continue;
        }
        let cells = flow.len();
        let (left, right) = (&left[..cells], &right[..cells]);
        for i in 0..cells {
            let flow = f64::from(flow[i]);
            // Strained in the other sense, by more than the missing flow.
            let stops = flow * (missing_flow * flow + gain * (right[i] - left[i])) < 0.0;
            *found |= u64::from(stops) << i;
        }
    }
    found
}

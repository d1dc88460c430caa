//! Flow up to the moment at which a sharp unloading wave stops it.
//!
//! Cells flow for whole steps. An unloading wave comes to the middle of a cell halfway through a step, all of which the scheme
//! takes as elastic: half a step of flow is missing. Along a wave that runs to the right, with R = sigma - rho c0 v, the stress
//! behind it changes by (d sigma + rho c0 dv)/2, where sigma and v are those ahead of it; the scheme changed it by rho c0 dv,
//! which is -dR/2 more. Where the bar flows ahead of the wave, dR is -E times the plastic strain of a step. Summed over the
//! cells of a plastic front, that is half of the front's jump, at any resolution: the wave overshot by 30 to 55 % and left
//! stresses that alternate from cell to cell.
//!
//! The cell therefore flows on by half of the plastic strain of the step before, and then unloads. What this differs from half
//! of dR is, from cell to cell along the wave, the difference of numbers that vanish before and behind the plastic front. The
//! filter's viscosity acts on a flowing cell in the same way, so that its share is missing, too ([`Filter::missing_flow`]).
//!
//! [`Filter::missing_flow`]: super::grid_filter::Filter::missing_flow

use std::ops::Range;

use multiversion::multiversion;

use super::block::{Block, BlockLaw, Stopped};
use super::grid_filter::flows;
use crate::elementary::lesser;
use crate::law::CHUNK;

impl Block {
    /// Lets cells flow on that flowed in the step before and unload in this one. `stopped` is set to them.
    pub fn flow_on(&mut self, law: BlockLaw<'_>, stopped: &mut Vec<Stopped>) {
        stopped.clear();
        if law.missing_flow == 0.0 || !flows(&self.flow) {
            return;
        }
        let end = self.active.end;
        for from in self.active.clone().step_by(CHUNK) {
            let piece = from..end.min(from + CHUNK);
            if any_stops(&self.flow[piece.clone()], &self.v[piece.start..=piece.end]) {
                self.flow_on_in(piece, law, stopped);
            }
        }
    }

    fn flow_on_in(&mut self, cells: Range<usize>, law: BlockLaw<'_>, stopped: &mut Vec<Stopped>) {
        let v = &self.v;
        for cell in cells.filter(|&cell| stops(self.flow[cell], v[cell], v[cell + 1])) {
            let (before, flowed) = (self.sigma[cell], self.flowed[cell]);
            // By no more than it unloads: else it would matter what sign a rounded difference of 0 has.
            let unloads = law.stress_gain * (v[cell + 1] - v[cell]).abs();
            let missing = lesser(law.missing_flow * flowed.abs(), unloads).copysign(flowed);
            let [plastic, work] = law.law.flow_on(missing, cell, &mut self.sigma, &mut self.state);
            stopped.push(Stopped { cell, sigma: [before, self.sigma[cell]], plastic, work });
        }
    }

    /// Books their plastic work, after the step.
    pub fn book_stopped(&mut self, stopped: &[Stopped]) {
        for &Stopped { cell, sigma: [before, after], plastic, work } in stopped {
            // The step began at the stress before: that is what its mean stress is made of, also where the cell flows in the other sense at its end.
            let later = if self.flow[cell] == 0 { 0.0 } else { self.flowed[cell] };
            let of_mean_stress = (before + self.sigma[cell]) * plastic + (before - after) * later;
            let area = self.area(cell);
            self.plastic += area * work;
            self.turned += area * (work - of_mean_stress);
            if self.keeps_work {
                self.absorbed[cell] += work;
            }
        }
    }
}

/// A cell between these nodes is strained in the other sense than it flowed in.
#[inline(always)]
fn stops(flow: i8, left: f64, right: f64) -> bool {
    f64::from(flow) * (right - left) < 0.0
}

/// Any of these cells is.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn any_stops(flow: &[i8], v: &[f64]) -> bool {
    let cells = flow.len();
    let (left, right) = (&v[..cells], &v[1..=cells]);
    let mut any = 0_u64;
    for i in 0..cells {
        any |= u64::from(stops(flow[i], left[i], right[i]));
    }
    any != 0
}

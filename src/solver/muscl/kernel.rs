//! One step of a block, elastic or yielded.

mod fluxes;
mod reconstruction;

use std::ops::Range;

use multiversion::multiversion;

use super::block::{Block, GHOSTS, ROW, Stage};
use super::history::{History, stay_elastic};
use super::part::Part;
use super::slope::limited;
use crate::law::{LANES, RowLaw};
use crate::wave::riemann::{Faces, FlowingRow, Flux};
use fluxes::{correct_curve, correct_history};
use reconstruction::{carry_curve, carry_history};

/// Data of a segment for the elastic kernel.
#[derive(Debug, Clone, Copy)]
struct Elastic {
    /// E dt/dx and dt/(rho dx).
    gain: f64,
    velocity_gain: f64,
    /// rho c0/2 and 1/(2 rho c0).
    halves: [f64; 2],
}

impl Elastic {
    fn of(part: &Part) -> Self {
        Self { gain: part.gain, velocity_gain: part.velocity_gain, halves: part.faces.halves() }
    }
}

/// Working memory. Everything that is read in a step has been written in that step.
#[derive(Clone)]
pub(super) struct Scratch {
    carried: Reconstructed,
    through: FaceFlux,
    ahead: Ahead,
    increment: [f64; ROW],
    /// Stresses before or after a step.
    stress: [f64; ROW],
    slope: [f64; ROW],
    lost: [f64; ROW],
    /// Stress that cells gain along the curve in half a step, Pa, >= 0.
    gained: [f64; ROW],
    flowing: FlowingRow<ROW>,
    /// Whether the cell lies inside a shock of a stiffening curve, or next to one.
    in_shock: [bool; ROW],
    /// Whether the cell has no slopes.
    flat: [bool; ROW],
    /// Whether a stiffening knot of the curve lies between the cell and the next one.
    changes: [bool; ROW],
    /// E times the strain, and its slopes where the curve is followed both ways, Pa.
    e_equivalent_strain: [f64; ROW],
    strain_slope: [f64; ROW],
}

impl Scratch {
    /// Allocates scratch for laws with at most this many state variables per cell.
    pub fn new(state_len: usize) -> Self {
        // A curve that is followed both ways has a state at both faces of a cell.
        let state = vec![0.0; state_len.max(2) * ROW];
        Self {
            carried: Reconstructed { left: [[0.0; ROW]; 2], right: [[0.0; ROW]; 2] },
            through: FaceFlux { stress: [0.0; ROW + 1], velocity: [0.0; ROW + 1] },
            ahead: Ahead { sigma: [0.0; ROW], state, work: [0.0; ROW] },
            increment: [0.0; ROW],
            stress: [0.0; ROW],
            slope: [0.0; ROW],
            lost: [0.0; ROW],
            gained: [0.0; ROW],
            flowing: FlowingRow::resting(),
            in_shock: [false; ROW],
            flat: [false; ROW],
            changes: [false; ROW],
            e_equivalent_strain: [0.0; ROW],
            strain_slope: [0.0; ROW],
        }
    }
}

/// States of the cells of a row at their left and right faces, half a step ahead: stresses and velocities.
#[derive(Clone)]
struct Reconstructed {
    left: [[f64; ROW]; 2],
    right: [[f64; ROW]; 2],
}

/// Stress and velocity at the faces of a row; face i is that between cells i - 1 and i.
#[derive(Clone)]
struct FaceFlux {
    stress: [f64; ROW + 1],
    velocity: [f64; ROW + 1],
}

impl FaceFlux {
    fn set(&mut self, face: usize, flux: Flux) {
        (self.stress[face], self.velocity[face]) = (flux.stress, flux.velocity);
    }

    /// Sets the fluxes of ends, joints and known fans.
    fn set_known(&mut self, block: &Block) {
        let last = block.sigma.len() - GHOSTS;
        for (side, face) in [(0, GHOSTS), (1, last)] {
            if let Some(flux) = block.outer[side] {
                self.set(face, flux);
            }
        }
        for &(face, flux) in &block.inside_fan {
            self.set(face, flux);
        }
    }
}

/// A row after half a step with the cells' own law.
#[derive(Clone)]
struct Ahead {
    sigma: [f64; ROW],
    /// State variables, as many per cell as the law of the bar with the most.
    state: Vec<f64>,
    /// Plastic work; not 0 in cells that flow.
    work: [f64; ROW],
}

impl Block {
    /// Advances the block by one step. All ghost cells must be up to date.
    pub fn advance(&mut self, part: &Part, scratch: &mut Scratch) {
        if self.stage == Stage::Quiet {
            if self.at_rest() {
                return;
            }
            self.stage = Stage::Elastic;
        }
        if self.stage == Stage::Elastic {
            if elastic(self, part, scratch) {
                return;
            }
            self.make_plastic(part);
        }
        plastic(self, part, scratch);
    }
}

/// Advances a block by one elastic step. Returns false and changes nothing if a stress exceeds the elastic limit.
fn elastic(block: &mut Block, part: &Part, scratch: &mut Scratch) -> bool {
    let elastic = Elastic::of(part);
    let Scratch { carried, through, stress, lost, .. } = scratch;
    let at_faces = carry(elastic, block.carried(), &block.sigma, &block.v, carried);
    acoustic(elastic, block.sigma.len(), carried, through);
    through.set_known(block);
    let row = block.sigma.len();
    let peak = strain_elastic(elastic, &block.sigma, through, &mut stress[..row]);
    if at_faces > part.limit || peak > part.limit {
        return false;
    }
    let own = GHOSTS..row - GHOSTS;
    block.lost += push(elastic.velocity_gain, &mut block.v, &block.sigma, &stress[..row], through, lost);
    block.sigma[own.clone()].copy_from_slice(&stress[own]);
    true
}

/// Computes the states at the faces of an elastic row. Returns the largest magnitude of their stresses.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn carry(elastic: Elastic, cells: Range<usize>, sigma: &[f64], v: &[f64], carried: &mut Reconstructed) -> f64 {
    let (half_gain, half_kick) = (0.5 * elastic.gain, 0.5 * elastic.velocity_gain);
    let (from, count) = (cells.start, cells.len());
    let Reconstructed { left: [left_s, left_v], right: [right_s, right_v] } = carried;
    let (left_s, left_v) = (&mut left_s[from..from + count], &mut left_v[from..from + count]);
    let (right_s, right_v) = (&mut right_s[from..from + count], &mut right_v[from..from + count]);
    let (sigma, v) = (&sigma[from - 1..=from + count], &v[from - 1..=from + count]);
    for i in 0..count {
        let ds = limited(sigma[i + 1] - sigma[i], sigma[i + 2] - sigma[i + 1]);
        let dv = limited(v[i + 1] - v[i], v[i + 2] - v[i + 1]);
        let (s, w) = (sigma[i + 1] + half_gain * dv, v[i + 1] + half_kick * ds);
        left_s[i] = s - 0.5 * ds;
        right_s[i] = s + 0.5 * ds;
        left_v[i] = w - 0.5 * dv;
        right_v[i] = w + 0.5 * dv;
    }
    largest(left_s, right_s)
}

/// Largest magnitude in two rows of equal length.
#[inline(always)]
fn largest(a: &[f64], b: &[f64]) -> f64 {
    let mut peak = [0.0_f64; LANES];
    let ((groups_a, rest_a), (groups_b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in groups_a.iter().zip(groups_b) {
        for lane in 0..LANES {
            let (a, b) = (a[lane].abs(), b[lane].abs());
            let larger = if a > b { a } else { b };
            peak[lane] = if larger > peak[lane] { larger } else { peak[lane] };
        }
    }
    let rest = rest_a.iter().chain(rest_b).fold(0.0_f64, |m, s| m.max(s.abs()));
    peak.iter().fold(rest, |m, &p| m.max(p))
}

/// Computes the fluxes through the faces of an elastic row.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn acoustic(elastic: Elastic, row: usize, carried: &Reconstructed, through: &mut FaceFlux) {
    let last = row - GHOSTS;
    let Reconstructed { left: [left_s, left_v], right: [right_s, right_v] } = carried;
    let (stress, velocity) = (&mut through.stress[..=last], &mut through.velocity[..=last]);
    let (left_s, left_v) = (&left_s[..=last], &left_v[..=last]);
    let (right_s, right_v) = (&right_s[..=last], &right_v[..=last]);
    let [half_impedance, half_compliance] = elastic.halves;
    for i in GHOSTS..=last {
        let flux = Faces::acoustic(
            half_impedance,
            half_compliance,
            Flux { stress: right_s[i - 1], velocity: right_v[i - 1] },
            Flux { stress: left_s[i], velocity: left_v[i] },
        );
        stress[i] = flux.stress;
        velocity[i] = flux.velocity;
    }
}

/// Writes the stresses of the own cells after an elastic step to `after`. Returns the largest magnitude of these and of the stresses at the faces.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn strain_elastic(elastic: Elastic, sigma: &[f64], through: &FaceFlux, after: &mut [f64]) -> f64 {
    let cells = sigma.len() - 2 * GHOSTS;
    let sigma = &sigma[GHOSTS..GHOSTS + cells];
    let after = &mut after[GHOSTS..GHOSTS + cells];
    let velocity = &through.velocity[GHOSTS..=GHOSTS + cells];
    let stress = &through.stress[GHOSTS..=GHOSTS + cells];
    for i in 0..cells {
        after[i] = sigma[i] + elastic.gain * (velocity[i + 1] - velocity[i]);
    }
    largest(after, &stress[..cells]).max(stress[cells].abs())
}

/// Updates the velocities of the own cells. Returns the energy that the scheme dissipates in them per area and time, W/m^2: the sum of
/// `(stress - s)(velocity - w)` over right faces minus that over left faces, with s and w the cell's means over the step.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn push(
    velocity_gain: f64,
    v: &mut [f64],
    before: &[f64],
    after: &[f64],
    through: &FaceFlux,
    lost: &mut [f64; ROW],
) -> f64 {
    let cells = before.len() - 2 * GHOSTS;
    let v = &mut v[GHOSTS..GHOSTS + cells];
    let (before, after) = (&before[GHOSTS..GHOSTS + cells], &after[GHOSTS..GHOSTS + cells]);
    let velocity = &through.velocity[GHOSTS..=GHOSTS + cells];
    let stress = &through.stress[GHOSTS..=GHOSTS + cells];
    let lost = &mut lost[..cells];
    for i in 0..cells {
        let old = v[i];
        let new = old + velocity_gain * (stress[i + 1] - stress[i]);
        let (s, w) = (0.5 * (before[i] + after[i]), 0.5 * (old + new));
        let (out, into) = ((stress[i + 1] - s) * (velocity[i + 1] - w), (stress[i] - s) * (velocity[i] - w));
        lost[i] = out - into;
        v[i] = new;
    }
    sum(lost)
}

/// Adds values in [`LANES`] partial sums: the result is the same to the last bit for every register width of the processor.
#[inline(always)]
fn sum(values: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (groups, rest) = values.as_chunks::<LANES>();
    for group in groups {
        for lane in 0..LANES {
            sums[lane] += group[lane];
        }
    }
    sums.iter().sum::<f64>() + rest.iter().sum::<f64>()
}

/// Advances a block by one step in which some cell may flow.
fn plastic(block: &mut Block, part: &Part, scratch: &mut Scratch) {
    let row = block.sigma.len();
    let law = part.law.law.as_ref();
    if part.path_independent {
        carry_curve(block, part, scratch);
    } else {
        block.update_histories(part);
        carry_history(block, part, scratch);
    }
    acoustic(Elastic::of(part), row, &scratch.carried, &mut scratch.through);
    if part.path_independent {
        correct_curve(block, part, scratch);
    } else {
        correct_history(block, part, scratch);
    }
    scratch.through.set_known(block);
    let Scratch { through, ahead, increment, stress, lost, slope: onset_correction, in_shock, .. } = scratch;
    increment[..row].fill(0.0);
    let faces = through.velocity[GHOSTS..=row - GHOSTS].windows(2);
    for (increment, face) in increment[GHOSTS..row - GHOSTS].iter_mut().zip(faces) {
        *increment = part.gain * (face[1] - face[0]);
    }
    stress[..row].copy_from_slice(&block.sigma);
    let work = &mut ahead.work[..row];
    strain(law, &block.histories, &increment[..row], &mut block.sigma, &mut block.state, work);
    block.note_flow(work);
    block.plastic += sum(&work[GHOSTS..row - GHOSTS]);
    block.lost += push(part.velocity_gain, &mut block.v, &stress[..row], &block.sigma, through, lost);
    let own = GHOSTS..row - GHOSTS;
    let [increment, stress, sigma, work] =
        [&increment[..], &stress[..], &block.sigma, work].map(|cells| &cells[own.clone()]);
    block.lost -= turned_work(part.gain, increment, [stress, sigma], work, onset_correction);
    if part.keeps_shocks() {
        let losses = in_shock[own].iter().zip(lost.iter().zip(onset_correction.iter()));
        block
            .shock_loss
            .note(losses.filter(|(in_shock, _)| **in_shock).map(|(_, (lost, correction))| lost - correction).sum());
    }
    block.record_dissipation(&lost[..row - 2 * GHOSTS]);
}

/// Calls [`RowLaw::strain`], or adds the increments directly if the histories show that no cell flows.
fn strain(
    law: &dyn RowLaw,
    histories: &[History],
    increment: &[f64],
    sigma: &mut [f64],
    state: &mut [f64],
    work: &mut [f64],
) {
    if stay_elastic(histories, sigma, increment) {
        sigma.iter_mut().zip(increment).for_each(|(sigma, increment)| *sigma += increment);
        work.fill(0.0);
    } else {
        law.strain(increment, sigma, state, work);
    }
}

/// Writes to `onset_correction` the plastic work of cells that exceeds the work of the mean stresses of the step, per area and time, W/m^2. Returns its sum.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn turned_work(
    gain: f64,
    increment: &[f64],
    [before, after]: [&[f64]; 2],
    work: &[f64],
    onset_correction: &mut [f64; ROW],
) -> f64 {
    let cells = increment.len();
    let (before, after, work, onset_correction) =
        (&before[..cells], &after[..cells], &work[..cells], &mut onset_correction[..cells]);
    for i in 0..cells {
        let of_mean = (before[i] + after[i]) * (increment[i] - (after[i] - before[i]));
        onset_correction[i] = 0.5 * (work[i] - of_mean) / gain;
    }
    sum(onset_correction)
}

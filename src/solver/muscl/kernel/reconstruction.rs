//! States at the faces of a yielded row, half a step ahead.

use multiversion::multiversion;

use super::{Elastic, Scratch, strain};
use crate::law::flows;
use crate::solver::muscl::block::Block;
use crate::solver::muscl::front;
use crate::solver::muscl::part::Part;
use crate::solver::muscl::slope::{cap, capped, limited};

/// Computes slopes of stress, strain increments of half a step, and velocities at the faces.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn carry_motion(elastic: Elastic, sigma: &[f64], v: &[f64], scratch: &mut Scratch) {
    let row = sigma.len();
    let v = &v[..row];
    let Scratch { carried, increment, slope, .. } = scratch;
    let (left, right) = (&mut carried.left[1][..row], &mut carried.right[1][..row]);
    let (increment, slope) = (&mut increment[..row], &mut slope[..row]);
    (increment[0], increment[row - 1]) = (0.0, 0.0);
    (slope[0], slope[row - 1]) = (0.0, 0.0);
    for i in 1..row - 1 {
        let ds = limited(sigma[i] - sigma[i - 1], sigma[i + 1] - sigma[i]);
        let dv = limited(v[i] - v[i - 1], v[i + 1] - v[i]);
        let w = v[i] + 0.5 * elastic.velocity_gain * ds;
        (slope[i], increment[i]) = (ds, 0.5 * elastic.gain * dv);
        left[i] = w - 0.5 * dv;
        right[i] = w + 0.5 * dv;
    }
}

/// Sets the slopes of some cells to zero:
///
/// - Inside shocks of a stiffening curve, and shocks that reverse the strain where the curve is followed both ways. With slopes the scheme may keep a
///   shock together that should split, with a wrong speed at any resolution; without them its flux, that of the hull, decides.
/// - If the curve has a level part, in cells to which slopes have given energy, and next to them, until the scheme has dissipated it. Without slopes
///   it dissipates energy in every cell.
fn flatten(block: &Block, part: &Part, scratch: &mut Scratch) {
    let row = block.sigma.len();
    scratch.in_shock[..row].fill(false);
    scratch.flat[..row].fill(false);
    if !part.may_be_first_order() {
        return;
    }
    let Scratch { carried, increment, slope, strain_slope, in_shock, flat, changes, .. } = scratch;
    block.find_first_order(part, changes, in_shock, flat);
    for i in (2..row - 2).filter(|&i| flat[i]) {
        (slope[i], strain_slope[i], increment[i]) = (0.0, 0.0, 0.0);
        (carried.left[1][i], carried.right[1][i]) = (block.v[i], block.v[i]);
    }
}

/// Sets steeper slopes for cells inside fronts along a line of the curve.
fn sharpen(block: &Block, part: &Part, scratch: &mut Scratch) {
    let Scratch { carried, increment, slope, strain_slope, flat, stress: sizes, lost: may_be_inside, .. } = scratch;
    front::find(&block.sigma, part.limit, sizes, may_be_inside);
    for i in block.surrounded().filter(|&i| may_be_inside[i] != 0.0) {
        let unloads = !part.path_independent && increment[i] * block.sigma[i] < 0.0;
        if flat[i] || unloads {
            continue;
        }
        let Some(found) = front::slopes(block, part, i) else { continue };
        let w = block.v[i] + 0.5 * part.velocity_gain * found.stress;
        (slope[i], strain_slope[i], increment[i]) =
            (found.stress, found.e_equivalent_strain, 0.5 * part.gain * found.velocity);
        (carried.left[1][i], carried.right[1][i]) = (w - 0.5 * found.velocity, w + 0.5 * found.velocity);
    }
}

/// Computes E times the strains of a row, from stresses and E times plastic strains, and their slopes, where the curve is followed both ways.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn slopes_of_strain(sigma: &[f64], plastic: &[f64], scratch: &mut Scratch) {
    let row = sigma.len();
    let (plastic, z) = (&plastic[..row], &mut scratch.e_equivalent_strain[..row]);
    let slope = &mut scratch.strain_slope[..row];
    for i in 0..row {
        z[i] = sigma[i] + plastic[i];
    }
    (slope[0], slope[row - 1]) = (0.0, 0.0);
    for i in 1..row - 1 {
        slope[i] = limited(z[i] - z[i - 1], z[i + 1] - z[i]);
    }
}

/// Computes E times the strains at the faces, half a step ahead, in place of stresses.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn carry_strain(row: usize, scratch: &mut Scratch) {
    let Scratch { carried, e_equivalent_strain, increment, strain_slope, .. } = scratch;
    let (left, right) = (&mut carried.left[0][..row], &mut carried.right[0][..row]);
    let (z, increment, slope) = (&e_equivalent_strain[..row], &increment[..row], &strain_slope[..row]);
    for i in 0..row {
        let middle = z[i] + increment[i];
        left[i] = middle - 0.5 * slope[i];
        right[i] = middle + 0.5 * slope[i];
    }
}

/// Computes the states at the faces from slopes of strain, where the curve is followed both ways.
pub(super) fn carry_curve(block: &Block, part: &Part, scratch: &mut Scratch) {
    let row = block.sigma.len();
    carry_motion(Elastic::of(part), &block.sigma, &block.v, scratch);
    slopes_of_strain(&block.sigma, &block.state, scratch);
    flatten(block, part, scratch);
    sharpen(block, part, scratch);
    carry_strain(row, scratch);
    let Scratch { carried, ahead, increment, .. } = scratch;
    // Applied to a zero state, the strain gives the stress of the curve and the remaining (plastic) strain.
    let (of_left, of_right) = ahead.state[..2 * row].split_at_mut(row);
    for (at_face, plastic) in [(&mut carried.left[0], of_left), (&mut carried.right[0], of_right)] {
        increment[..row].copy_from_slice(&at_face[..row]);
        at_face[..row].fill(0.0);
        plastic.fill(0.0);
        part.law.law.strain(&increment[..row], &mut at_face[..row], plastic, &mut ahead.work[..row]);
    }
}

/// Computes the states at the faces from slopes of stress, advanced by half a step with the law, where cells have histories.
pub(super) fn carry_history(block: &Block, part: &Part, scratch: &mut Scratch) {
    let row = block.sigma.len();
    let law = part.law.law.as_ref();
    carry_motion(Elastic::of(part), &block.sigma, &block.v, scratch);
    flatten(block, part, scratch);
    sharpen(block, part, scratch);
    let Scratch { carried, ahead, increment, slope, .. } = scratch;
    ahead.sigma[..row].copy_from_slice(&block.sigma);
    let state = &mut ahead.state[..law.state_len() * row];
    state.copy_from_slice(&block.state);
    let (sigma, work) = (&mut ahead.sigma[..row], &mut ahead.work[..row]);
    strain(law, &block.histories, &increment[..row], sigma, state, work);
    // A cell that just reaches its yield stress does not flow, whatever rounding says.
    for (work, &sigma) in ahead.work[..row].iter_mut().zip(&ahead.sigma[..row]) {
        *work = if flows(*work, sigma) { *work } else { 0.0 };
    }
    let faces = carried.left[0].iter_mut().zip(&mut carried.right[0]);
    for ((left, right), (sigma, slope)) in faces.zip(ahead.sigma.iter().zip(slope)).take(row) {
        (*left, *right) = (sigma - 0.5 * *slope, sigma + 0.5 * *slope);
    }
    if part.most_energy_defect.is_none() {
        return;
    }
    for i in (1..row - 1).filter(|&i| ahead.work[i] != 0.0) {
        let cap = cap(ahead.sigma[i], &block.sigma, i);
        for at_face in [&mut carried.left[0][i], &mut carried.right[0][i]] {
            *at_face = capped(*at_face, cap);
        }
    }
}

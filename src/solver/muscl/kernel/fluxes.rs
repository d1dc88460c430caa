//! Fluxes through those faces of a yielded row for which the acoustic solution does not hold.

use std::ops::Range;

use super::{Reconstructed, Scratch};
use crate::solver::muscl::block::{Block, ROW};
use crate::solver::muscl::history::WITHIN;
use crate::solver::muscl::part::Part;
use crate::wave::riemann::{FaceState, Point, Workspace};

/// Solves the faces between cells that lie on one line of a curve, or flow along it. Returns 1 for these faces and 0 for all others. Stresses up to
/// `limit` (Pa) are elastic.
fn correct_flowing(part: &Part, limit: f64, cells: Range<usize>, scratch: &mut Scratch) -> [f64; ROW] {
    let Scratch { carried: Reconstructed { left, right }, through, flowing, .. } = scratch;
    let mut solved = [0.0; ROW];
    if flowing.any(cells.clone()) {
        let (of_left, of_right) = (cells.start..cells.end - 1, cells.start + 1..cells.end);
        let through = [&mut through.stress[of_right.clone()], &mut through.velocity[of_right.clone()]];
        let [a, b] = [right.each_ref().map(|at| &at[of_left.clone()]), left.each_ref().map(|at| &at[of_right.clone()])];
        flowing.solve(&part.faces, limit, of_right.start, [a, b], through, &mut solved[of_right]);
    }
    solved
}

/// Corrects the faces of a row to which the acoustic solution does not apply, where the curve is followed both ways.
pub(super) fn correct_curve(block: &mut Block, part: &Part, scratch: &mut Scratch) {
    let (row, limit) = (block.sigma.len(), part.limit * (1.0 + WITHIN));
    let cells = block.carried();
    for i in cells.clone() {
        let z = scratch.e_equivalent_strain[i];
        if z.abs() > limit {
            scratch.flowing.lie_at(i, &part.faces, z);
        } else {
            scratch.flowing.rest(i);
        }
    }
    let solved = correct_flowing(part, limit, cells.clone(), scratch);
    let Scratch { carried: Reconstructed { left, right }, through, ahead, .. } = scratch;
    // Within the limit, stress and strain are equivalent.
    let inside = |near: &FaceState| near.point.stress.abs() <= limit && near.point.plastic.abs() <= WITHIN * limit;
    let near = |stress: f64, velocity: f64, plastic: f64| FaceState {
        point: Point { stress, velocity, plastic, ..Point::default() },
        ..FaceState::default()
    };
    for face in (cells.start + 1..cells.end).filter(|&face| solved[face] == 0.0) {
        let (i, j) = (face - 1, face);
        let a = near(right[0][i], right[1][i], ahead.state[row + i]);
        let b = near(left[0][j], left[1][j], ahead.state[j]);
        if through.stress[face].abs() > limit || !inside(&a) || !inside(&b) {
            through.set(face, part.faces.solve(&a, &b, &mut block.work));
        }
    }
}

/// Computes the stress that flowing cells gain along the curve in half a step. It is only predicted: a wave from a neighbour may take it back, and
/// then along the curve, as if it had never been gained. If it were taken back elastically, fronts would leave ripples.
fn gain(block: &Block, part: &Part, cells: Range<usize>, scratch: &mut Scratch) {
    let Scratch { ahead, gained, flowing, .. } = scratch;
    let isotropic = part.isotropic();
    for i in cells {
        gained[i] = 0.0;
        flowing.rest(i);
        if ahead.work[i] != 0.0 {
            let back = if isotropic { 0.0 } else { part.law.law.back_stress(&block.state, i) };
            let sense = if ahead.sigma[i] < back { -1.0 } else { 1.0 };
            let (stress, (limit, line)) = (sense * ahead.sigma[i], block.histories[i].limit(sense));
            gained[i] = (stress - limit).max(0.0);
            if isotropic {
                flowing.flow(i, &part.faces, sense, gained[i], (stress, line));
            }
        }
    }
}

/// Corrects the faces of a row to which the acoustic solution does not apply, where cells have histories.
pub(super) fn correct_history(block: &mut Block, part: &Part, scratch: &mut Scratch) {
    let (row, limit) = (block.sigma.len(), part.limit * (1.0 + WITHIN));
    let isotropic = part.isotropic();
    let law = part.law.law.as_ref();
    let cells = block.carried();
    gain(block, part, cells.clone(), scratch);
    let solved = correct_flowing(part, limit, cells.clone(), scratch);
    let Scratch { carried: Reconstructed { left, right }, through, ahead, gained, .. } = scratch;
    let state = &ahead.state[..law.state_len() * row];
    let within = |stress: f64, i: usize| ahead.work[i] == 0.0 && block.histories[i].contains(stress);
    let near = |i: usize, outward: f64, stress: f64, velocity: f64, back: f64, work: &mut Workspace| {
        let point = Point { stress, velocity, accumulated: law.accumulated(state, i), back, ..Point::default() };
        let reversals = law.reversals(&block.state, i);
        if ahead.work[i] == 0.0 {
            return FaceState { point, flowing: 0.0, reversals };
        }
        let flowing = if ahead.sigma[i] < back { -1.0 } else { 1.0 };
        part.faces.before(FaceState { point, flowing, reversals }, gained[i], outward, work)
    };
    for face in (cells.start + 1..cells.end).filter(|&face| solved[face] == 0.0) {
        let (i, j) = (face - 1, face);
        let stress = through.stress[face];
        if isotropic && stress.abs() <= limit || within(stress, i) && within(stress, j) {
            continue;
        }
        let middle = |i: usize| if isotropic { 0.0 } else { law.back_stress(state, i) };
        let backs = [middle(i), middle(j)];
        let a = near(i, 1.0, right[0][i], right[1][i], backs[0], &mut block.work);
        let b = near(j, -1.0, left[0][j], left[1][j], backs[1], &mut block.work);
        through.set(face, part.faces.solve(&a, &b, &mut block.work));
    }
}

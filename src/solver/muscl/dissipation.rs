//! What second-order fluxes may return of the energy of cells that have yielded, face by face.
//!
//! With s and w the means of a cell's stress and velocity over the step, what the scheme takes is the sum over faces of
//!
//! ```text
//! D = (sigma* - s_L)(v* - w_L) - (sigma* - s_R)(v* - w_R)
//! ```
//!
//! (Tadmor 1987). Godunov's flux has D >= 0, second-order fluxes have D of either sign. A flux whose states lie between those of
//! both cells returns no more than `Z dw^2 + ds^2/Z`, with the elastic impedance Z = rho c0, the largest there is, and dw and ds
//! the differences of both cells. Where a second-order flux returns more, its states have left those bounds, and the
//! face has the Godunov flux of the unreconstructed states in its place. Without this rule the foreseen flow of half a step
//! drove velocity into cells whose curve is level or nearly so, and so cannot answer with a stress.
//!
//! The rule bounds what second-order fluxes return; it does not make every D positive, see `mod.rs`.
//!
//! s and w are those of a trial step with the second-order fluxes. It costs one more evaluation of the law a step, in blocks
//! that have yielded, and one Riemann problem at each such face.

use super::block::{Block, GHOSTS};
use super::kernel::Scratch;
use super::stepping::Part;
use crate::wave::riemann::{Flux, Near, Point};

/// Replaces such fluxes of the own faces between cells of which one has yielded before this step.
pub(super) fn ensure(block: &mut Block, part: &Part, scratch: &mut Scratch) {
    try_step(block, part, scratch);
    let row = block.sigma.len();
    let [left, right] = block.outer.map(|outer| usize::from(outer.is_some()));
    for face in GHOSTS + left..=row - GHOSTS - right {
        if block.has_flowed(part, face - 1) || block.has_flowed(part, face) {
            limit(block, part, scratch, face);
        }
    }
}

/// Means over the step of all cells between known fluxes.
fn try_step(block: &Block, part: &Part, scratch: &mut Scratch) {
    let (row, law) = (block.sigma.len(), part.law.law.as_ref());
    let Scratch { through, ahead, middle, increment, .. } = scratch;
    let cells = block.carried();
    let [left, right] = block.outer.map(|outer| usize::from(outer.is_none()));
    let cells = cells.start + left..cells.end - right;
    increment[..row].fill(0.0);
    for i in cells.clone() {
        increment[i] = part.gain * (through.velocity[i + 1] - through.velocity[i]);
    }
    ahead.sigma[..row].copy_from_slice(&block.sigma);
    let state = &mut ahead.state[..law.state_len() * row];
    state.copy_from_slice(&block.state);
    law.strain(&increment[..row], &mut ahead.sigma[..row], state, &mut ahead.work[..row]);
    for i in cells {
        middle.stress[i] = 0.5 * (block.sigma[i] + ahead.sigma[i]);
        middle.velocity[i] = block.v[i] + 0.5 * part.kick * (through.stress[i + 1] - through.stress[i]);
    }
}

/// The flux of one face.
fn limit(block: &mut Block, part: &Part, scratch: &mut Scratch, face: usize) {
    let (i, j) = (face - 1, face);
    let (s, w) = (&scratch.middle.stress, &scratch.middle.velocity);
    let (rise, change) = (s[j] - s[i], w[j] - w[i]);
    let flux = Flux { stress: scratch.through.stress[face], velocity: scratch.through.velocity[face] };
    let taken = (flux.stress - 0.5 * (s[i] + s[j])) * change + (flux.velocity - 0.5 * (w[i] + w[j])) * rise;
    let impedance = part.faces.medium.impedance();
    if taken < -(impedance * change * change + rise * rise / impedance) {
        let (a, b) = (unreconstructed(block, part, i), unreconstructed(block, part, j));
        scratch.through.set(face, part.faces.solve(&a, &b, &mut block.work));
    }
}

/// A cell as it is before the step.
fn unreconstructed(block: &Block, part: &Part, i: usize) -> Near {
    let (law, state) = (part.law.law.as_ref(), &block.state);
    let point = Point { stress: block.sigma[i], velocity: block.v[i], ..Point::default() };
    let point = if part.path_independent {
        Point { plastic: law.plastic_strain(state, i), ..point }
    } else {
        Point { accumulated: law.accumulated(state, i), back: law.back_stress(state, i), ..point }
    };
    Near { point, flowing: 0.0 }
}

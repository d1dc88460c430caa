//! One step of a block, while it is elastic and after.

use std::ops::Range;

use multiversion::multiversion;

use super::block::{Block, GHOSTS, ROW, Stage};
use super::slope::limited;
use super::stepping::Part;
use crate::law::LANES;
use crate::wave::riemann::{Faces, Flux, Near, Point};

/// Numbers of the law state that a cell can have.
const MOST_STATE: usize = 4;

/// What the elastic kernel must know of a segment.
#[derive(Debug, Clone, Copy)]
struct Elastic {
    /// E dt/dx and dt/(rho dx).
    gain: f64,
    kick: f64,
    /// rho c0/2 and 1/(2 rho c0).
    halves: [f64; 2],
}

impl Elastic {
    fn of(part: &Part) -> Self {
        Self { gain: part.gain, kick: part.kick, halves: part.faces.halves() }
    }
}

/// States of a row's cells at their left and right faces, half a step on.
struct Carried {
    left: [[f64; ROW]; 2],
    right: [[f64; ROW]; 2],
}

impl Carried {
    const ZERO: Self = Self { left: [[0.0; ROW]; 2], right: [[0.0; ROW]; 2] };
}

/// What goes through the faces of a row: stress and velocity; face i is that between cells i - 1 and i.
struct Through {
    stress: [f64; ROW + 1],
    velocity: [f64; ROW + 1],
}

impl Through {
    const ZERO: Self = Self { stress: [0.0; ROW + 1], velocity: [0.0; ROW + 1] };

    fn set(&mut self, face: usize, flux: Flux) {
        (self.stress[face], self.velocity[face]) = (flux.stress, flux.velocity);
    }

    /// Puts in what ends and joints let through. Copies beyond them are not strained.
    fn set_outer(&mut self, block: &Block) {
        let last = block.sigma.len() - GHOSTS;
        for (side, face) in [(0, GHOSTS), (1, last)] {
            if let Some(flux) = block.outer[side] {
                self.set(face, flux);
            }
        }
    }
}

/// One elastic step of a block; false, and nothing is changed, where a stress comes past the elastic limit.
pub(super) fn elastic(block: &mut Block, part: &Part) -> bool {
    let elastic = Elastic::of(part);
    let (mut carried, mut through) = (Carried::ZERO, Through::ZERO);
    let at_faces = carry(elastic, block.carried(), &block.sigma, &block.v, &mut carried);
    acoustic(elastic, block.sigma.len(), &carried, &mut through);
    through.set_outer(block);
    let mut stress = [0.0; ROW];
    let row = block.sigma.len();
    let peak = strain_elastic(elastic, &block.sigma, &through, &mut stress[..row]);
    if at_faces > part.limit || peak > part.limit {
        return false;
    }
    let own = GHOSTS..row - GHOSTS;
    block.lost += push(elastic.kick, &mut block.v, &block.sigma, &stress[..row], &through);
    block.sigma[own.clone()].copy_from_slice(&stress[own]);
    true
}

/// States at the faces of an elastic row. Returns the largest stress among them.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn carry(elastic: Elastic, cells: Range<usize>, sigma: &[f64], v: &[f64], carried: &mut Carried) -> f64 {
    let row = sigma.len();
    let v = &v[..row];
    let (half_gain, half_kick) = (0.5 * elastic.gain, 0.5 * elastic.kick);
    let Carried { left: [left_s, left_v], right: [right_s, right_v] } = carried;
    let (left_s, left_v) = (&mut left_s[..row], &mut left_v[..row]);
    let (right_s, right_v) = (&mut right_s[..row], &mut right_v[..row]);
    for i in cells.start.max(1)..cells.end.min(row - 1) {
        let ds = limited(sigma[i] - sigma[i - 1], sigma[i + 1] - sigma[i]);
        let dv = limited(v[i] - v[i - 1], v[i + 1] - v[i]);
        let (s, w) = (sigma[i] + half_gain * dv, v[i] + half_kick * ds);
        left_s[i] = s - 0.5 * ds;
        right_s[i] = s + 0.5 * ds;
        left_v[i] = w - 0.5 * dv;
        right_v[i] = w + 0.5 * dv;
    }
    let mut peak = [0.0_f64; LANES];
    for (left, right) in left_s.as_chunks::<LANES>().0.iter().zip(right_s.as_chunks::<LANES>().0) {
        for lane in 0..LANES {
            let (a, b) = (left[lane].abs(), right[lane].abs());
            let larger = if a > b { a } else { b };
            peak[lane] = if larger > peak[lane] { larger } else { peak[lane] };
        }
    }
    let whole = row - row % LANES;
    let rest = left_s[whole..].iter().chain(&right_s[whole..]).fold(0.0_f64, |m, s| m.max(s.abs()));
    peak.iter().fold(rest, |m, &p| m.max(p))
}

/// What goes through the own faces of an elastic row.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn acoustic(elastic: Elastic, row: usize, carried: &Carried, through: &mut Through) {
    let last = row - GHOSTS;
    let Carried { left: [left_s, left_v], right: [right_s, right_v] } = carried;
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

/// Stresses of the own cells after an elastic step, into `after`. Returns the largest of them and of those at their faces.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn strain_elastic(elastic: Elastic, sigma: &[f64], through: &Through, after: &mut [f64]) -> f64 {
    let cells = sigma.len() - 2 * GHOSTS;
    let sigma = &sigma[GHOSTS..GHOSTS + cells];
    let after = &mut after[GHOSTS..GHOSTS + cells];
    let velocity = &through.velocity[GHOSTS..=GHOSTS + cells];
    let stress = &through.stress[GHOSTS..=GHOSTS + cells];
    for i in 0..cells {
        after[i] = sigma[i] + elastic.gain * (velocity[i + 1] - velocity[i]);
    }
    let mut peak = [stress[cells].abs(); LANES];
    let whole = cells - cells % LANES;
    for start in (0..whole).step_by(LANES) {
        for lane in 0..LANES {
            let (a, b) = (after[start + lane].abs(), stress[start + lane].abs());
            let larger = if a > b { a } else { b };
            peak[lane] = if larger > peak[lane] { larger } else { peak[lane] };
        }
    }
    let rest = after[whole..].iter().chain(&stress[whole..cells]).fold(0.0_f64, |m, s| m.max(s.abs()));
    peak.iter().fold(rest, |m, &p| m.max(p))
}

/// New velocities of the own cells. Returns what the scheme takes from their energy, W/m^2 times the step's part: the sum of
/// `(stress - s)(velocity - w)` over right faces less that over left ones, s and w the cell's means over the step.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn push(kick: f64, v: &mut [f64], before: &[f64], after: &[f64], through: &Through) -> f64 {
    let cells = before.len() - 2 * GHOSTS;
    let v = &mut v[GHOSTS..GHOSTS + cells];
    let (before, after) = (&before[GHOSTS..GHOSTS + cells], &after[GHOSTS..GHOSTS + cells]);
    let velocity = &through.velocity[GHOSTS..=GHOSTS + cells];
    let stress = &through.stress[GHOSTS..=GHOSTS + cells];
    let mut lost = [0.0; ROW];
    let lost = &mut lost[..cells];
    for i in 0..cells {
        let old = v[i];
        let new = old + kick * (stress[i + 1] - stress[i]);
        let (s, w) = (0.5 * (before[i] + after[i]), 0.5 * (old + new));
        let (out, into) = ((stress[i + 1] - s) * (velocity[i + 1] - w), (stress[i] - s) * (velocity[i] - w));
        lost[i] = out - into;
        v[i] = new;
    }
    let mut sums = [0.0; LANES];
    let (groups, rest) = lost.as_chunks::<LANES>();
    for group in groups {
        for lane in 0..LANES {
            sums[lane] += group[lane];
        }
    }
    sums.iter().sum::<f64>() + rest.iter().sum::<f64>()
}

/// A row half a step on, by the cells' own law.
struct Ahead {
    sigma: [f64; ROW],
    state: [f64; MOST_STATE * ROW],
    /// Not 0 in cells that flow.
    work: [f64; ROW],
}

/// One step of a block in which some cell may flow.
pub(super) fn plastic(block: &mut Block, part: &Part) {
    let row = block.sigma.len();
    let law = part.law.law.as_ref();
    let mut carried = Carried::ZERO;
    let mut ahead = Ahead { sigma: [0.0; ROW], state: [0.0; MOST_STATE * ROW], work: [0.0; ROW] };
    carry_plastic(block, part, &mut carried, &mut ahead);
    let mut through = Through::ZERO;
    acoustic(Elastic::of(part), row, &carried, &mut through);
    correct(block, part, &carried, &ahead, &mut through);
    through.set_outer(block);
    let mut increment = [0.0; ROW];
    for i in GHOSTS..row - GHOSTS {
        increment[i] = part.gain * (through.velocity[i + 1] - through.velocity[i]);
    }
    ahead.sigma[..row].copy_from_slice(&block.sigma);
    let work = &mut ahead.work[..row];
    law.strain(&increment[..row], &mut block.sigma, &mut block.state, work);
    block.plastic += work[GHOSTS..row - GHOSTS].iter().sum::<f64>();
    block.lost += push(part.kick, &mut block.v, &ahead.sigma[..row], &block.sigma, &through);
}

/// States at the faces of a row in which some cells may flow.
fn carry_plastic(block: &Block, part: &Part, carried: &mut Carried, ahead: &mut Ahead) {
    let row = block.sigma.len();
    let law = part.law.law.as_ref();
    let (mut ds, mut dz, mut increment) = ([0.0; ROW], [0.0; ROW], [0.0; ROW]);
    let Carried { left, right } = carried;
    let (sigma, v) = (&block.sigma[..row], &block.v[..row]);
    for i in 1..row - 1 {
        ds[i] = limited(sigma[i] - sigma[i - 1], sigma[i + 1] - sigma[i]);
        let dv = limited(v[i] - v[i - 1], v[i + 1] - v[i]);
        increment[i] = 0.5 * part.gain * dv;
        let w = v[i] + 0.5 * part.kick * ds[i];
        left[1][i] = w - 0.5 * dv;
        right[1][i] = w + 0.5 * dv;
    }
    if part.path_independent {
        let plastic = &block.state[..row];
        let z = |i: usize| sigma[i] + plastic[i];
        for i in 1..row - 1 {
            dz[i] = limited(z(i) - z(i - 1), z(i + 1) - z(i));
            let middle = z(i) + increment[i];
            left[0][i] = middle - 0.5 * dz[i];
            right[0][i] = middle + 0.5 * dz[i];
        }
        // Strain, from a state of nothing at all, gives the stress of the curve and what is left of the strain.
        let [of_left, of_right] = split_two(&mut ahead.state, row);
        for (reach, plastic) in [(&mut left[0], of_left), (&mut right[0], of_right)] {
            increment[..row].copy_from_slice(&reach[..row]);
            reach[..row].fill(0.0);
            plastic.fill(0.0);
            law.strain(&increment[..row], &mut reach[..row], plastic, &mut ahead.work[..row]);
        }
        return;
    }
    ahead.sigma[..row].copy_from_slice(sigma);
    let numbers = law.state_len() * row;
    let state = &mut ahead.state[..numbers];
    state.copy_from_slice(&block.state);
    law.strain(&increment[..row], &mut ahead.sigma[..row], state, &mut ahead.work[..row]);
    for i in 1..row - 1 {
        left[0][i] = ahead.sigma[i] - 0.5 * ds[i];
        right[0][i] = ahead.sigma[i] + 0.5 * ds[i];
    }
}

fn split_two(state: &mut [f64], row: usize) -> [&mut [f64]; 2] {
    let (first, second) = state[..2 * row].split_at_mut(row);
    [first, second]
}

/// The faces of a row whose answer is not the acoustic one.
fn correct(block: &mut Block, part: &Part, carried: &Carried, ahead: &Ahead, through: &mut Through) {
    let row = block.sigma.len();
    let limit = part.limit;
    let cells = block.carried();
    for face in cells.start + 1..cells.end {
        let (i, j) = (face - 1, face);
        let stress = through.stress[face];
        if part.path_independent {
            // Where no strain is beyond the limit stress and strain are one.
            let inside = |s: f64, plastic: f64| s.abs() <= limit && plastic == 0.0;
            let plastic = [ahead.state[row + i], ahead.state[j]];
            if stress.abs() <= limit && inside(carried.right[0][i], plastic[0]) && inside(carried.left[0][j], plastic[1]) {
                continue;
            }
            let near = |s: f64, v: f64, plastic: f64| Near {
                point: Point { stress: s, velocity: v, plastic, ..Point::default() },
                flowing: 0.0,
            };
            let left = near(carried.right[0][i], carried.right[1][i], plastic[0]);
            let right = near(carried.left[0][j], carried.left[1][j], plastic[1]);
            through.set(face, part.faces.solve(&left, &right, &mut block.work));
            continue;
        }
        if part.isotropic() && stress.abs() <= limit {
            continue;
        }
        let left = flowing_near(part, row, ahead, i, carried.right[0][i], carried.right[1][i]);
        let right = flowing_near(part, row, ahead, j, carried.left[0][j], carried.left[1][j]);
        through.set(face, part.faces.solve(&left, &right, &mut block.work));
    }
}

/// A cell with a history at one of its faces.
fn flowing_near(part: &Part, row: usize, ahead: &Ahead, i: usize, stress: f64, velocity: f64) -> Near {
    let law = part.law.law.as_ref();
    let state = &ahead.state[..law.state_len() * row];
    let back = law.back_stress(state, i);
    let point = Point { stress, velocity, accumulated: law.accumulated(state, i), back, ..Point::default() };
    let sense = if ahead.sigma[i] < back { -1.0 } else { 1.0 };
    Near { point, flowing: if ahead.work[i] == 0.0 { 0.0 } else { sense } }
}

/// The first or the last cell of a block at its outer face, half a step on.
pub(super) fn near(block: &Block, part: &Part, side: usize) -> Near {
    let i = block.inside(side, 0);
    let (s, v) = (&block.sigma, &block.v);
    let outward = if side == 0 { -0.5 } else { 0.5 };
    let ds = limited(s[i] - s[i - 1], s[i + 1] - s[i]);
    let dv = limited(v[i] - v[i - 1], v[i + 1] - v[i]);
    let half_strain = 0.5 * part.gain * dv;
    let velocity = v[i] + 0.5 * part.kick * ds + outward * dv;
    if block.stage != Stage::Plastic {
        let point = Point { stress: s[i] + half_strain + outward * ds, velocity, ..Point::default() };
        return Near { point, flowing: 0.0 };
    }
    let law = part.law.law.as_ref();
    let (mut stress, mut work, mut state) = ([s[i]], [0.0], [0.0; MOST_STATE]);
    let numbers = law.state_len();
    if part.path_independent {
        let z = |i: usize| block.reach(part, i);
        let dz = limited(z(i) - z(i - 1), z(i + 1) - z(i));
        stress = [0.0];
        law.strain(&[z(i) + half_strain + outward * dz], &mut stress, &mut state[..numbers], &mut work);
        let point = Point { stress: stress[0], velocity, plastic: state[0], ..Point::default() };
        return Near { point, flowing: 0.0 };
    }
    for (number, value) in state[..numbers].iter_mut().enumerate() {
        *value = block.state_at(number, i);
    }
    law.strain(&[half_strain], &mut stress, &mut state[..numbers], &mut work);
    let state = &state[..numbers];
    let back = law.back_stress(state, 0);
    let accumulated = law.accumulated(state, 0);
    let sense = if stress[0] < back { -1.0 } else { 1.0 };
    let point = Point { stress: stress[0] + outward * ds, velocity, accumulated, back, ..Point::default() };
    Near { point, flowing: if work[0] == 0.0 { 0.0 } else { sense } }
}

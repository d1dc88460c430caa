//! Steeper slopes for fronts along straight segments of the curve.
//!
//! Along a line all waves have one speed: a front is carried along as it is, and whatever smears it stays. Van Leer's slopes
//! smear it ever further, over `dx^(2/3)`; steeper ones keep it within a few cells. So cells inside such fronts get those.
//! Elsewhere they would do harm: they make steps of smooth waves, and keep ripples alive.

use multiversion::multiversion;

use super::block::{Block, NEARBY};
use super::part::Part;
use super::slope::{limited, steep};
use crate::elementary::{larger, lesser};
use crate::wave::riemann::Straight;

/// In a front the largest difference between neighbours near a cell is this many times the least. Where a wave is
/// resolved, they are more alike than that.
const UNEVEN: f64 = 4.0;

/// Part of a difference that may be off the line.
const OFF_LINE: f64 = 1e-3;

/// Part of a front that may be waves in the other direction: ripples of either direction stay ripples.
const OTHER_WAY: f64 = 0.1;

/// Part of the elastic limit below which a difference is no front.
const FAINT: f64 = 1e-6;

/// Part of a stress by which rounding may take it off its line.
const ROUNDING: f64 = 1e-9;

/// Slopes of a cell inside a front, as differences.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slopes {
    /// Pa.
    pub stress: f64,
    /// m/s.
    pub velocity: f64,
    /// E times strain, Pa.
    pub e_equivalent_strain: f64,
}

/// Cells of a row that may lie inside a front: where stress rises or falls through them, beyond the elastic limit and not evenly, `found` is 1. The
/// [`NEARBY`] cells at each end of the row are none. `sizes` is room for as many.
pub(super) fn find(sigma: &[f64], limit: f64, sizes: &mut [f64], found: &mut [f64]) {
    let row = sigma.len();
    found[..NEARBY].fill(0.0);
    found[row - NEARBY..row].fill(0.0);
    find_inside(sigma, limit, &mut sizes[..row], &mut found[NEARBY..row - NEARBY]);
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn find_inside(sigma: &[f64], limit: f64, sizes: &mut [f64], found: &mut [f64]) {
    let (cells, faint) = (found.len(), FAINT * limit);
    let between = cells + 2 * NEARBY - 1;
    let (left, right, sizes) = (&sigma[..between], &sigma[1..=between], &mut sizes[..between]);
    for i in 0..between {
        sizes[i] = (right[i] - left[i]).abs();
    }
    let [before, here, after] = [NEARBY - 1, NEARBY, NEARBY + 1].map(|from| &sigma[from..][..cells]);
    // Sizes of the differences near a cell; the middle two are those to its neighbours.
    let near: [&[f64]; 2 * NEARBY] = std::array::from_fn(|k| &sizes[k..][..cells]);
    for i in 0..cells {
        let (mut least, mut largest) = (near[0][i], near[0][i]);
        for sizes in &near[1..] {
            (least, largest) = (lesser(least, sizes[i]), larger(largest, sizes[i]));
        }
        let rises = (here[i] - before[i]) * (after[i] - here[i]) > 0.0;
        let greater = larger(near[NEARBY - 1][i], near[NEARBY][i]);
        let may_be = rises && greater > faint && here[i].abs() > limit && largest > UNEVEN * least;
        found[i] = if may_be { 1.0 } else { 0.0 };
    }
}

/// The slopes of a cell inside a front of one direction along one line of the curve, other than the elastic one; none
/// elsewhere. It is one of those that [`find`] has found.
pub(super) fn slopes(block: &Block, part: &Part, i: usize) -> Option<Slopes> {
    let sigma = &block.sigma;
    let greater = (sigma[i] - sigma[i - 1]).abs().max((sigma[i + 1] - sigma[i]).abs());
    along(&line(block, part, i, greater)?, block, i)
}

/// The line on which a cell and its neighbours lie.
fn line(block: &Block, part: &Part, i: usize, greater: f64) -> Option<Straight> {
    let sigma = &block.sigma;
    let sense = if sigma[i] < 0.0 { -1.0 } else { 1.0 };
    let e_equivalent_strain = |i: usize| sigma[i].abs() + part.law.law.accumulated(&block.state, i);
    let line = part.faces.line(sense, e_equivalent_strain(i));
    if line.slope >= 1.0 || line.slope == 0.0 {
        return None;
    }
    let off = OFF_LINE * greater + ROUNDING * sigma[i].abs();
    let (start, end) = (line.start - off / line.slope, line.end + off / line.slope);
    let lies_on = |i: usize| {
        let z = e_equivalent_strain(i);
        (start..=end).contains(&z) && (sense * sigma[i] - line.offset - line.slope * z).abs() <= off
    };
    [i - 1, i, i + 1].into_iter().all(lies_on).then_some(line)
}

/// The slopes, if waves of one direction prevail: theirs the steep ones, the others' as everywhere.
fn along(line: &Straight, block: &Block, i: usize) -> Option<Slopes> {
    let (sigma, v) = (&block.sigma, &block.v);
    // Velocity changes by waves in +x and in -x.
    let waves = |i: usize| {
        let (rise, change) = (line.compliance * (sigma[i + 1] - sigma[i]), v[i + 1] - v[i]);
        [0.5 * (change - rise), 0.5 * (change + rise)]
    };
    let (a, b) = (waves(i - 1), waves(i));
    let size = |k: usize| a[k].abs() + b[k].abs();
    let (ahead, back) = if size(1) <= OTHER_WAY * size(0) {
        (steep(a[0], b[0]), limited(a[1], b[1]))
    } else if size(0) <= OTHER_WAY * size(1) {
        (limited(a[0], b[0]), steep(a[1], b[1]))
    } else {
        return None;
    };
    let stress = (back - ahead) / line.compliance;
    Some(Slopes { stress, velocity: ahead + back, e_equivalent_strain: stress / line.slope })
}

//! Steeper slopes for fronts along straight segments of the curve.
//!
//! Along a line all waves have the same speed: a front is advected unchanged, and its smearing accumulates. Van Leer's slopes smear it further and
//! further, over `dx^(2/3)`; steeper slopes keep it within a few cells. Cells inside such fronts therefore get steeper slopes. Elsewhere these would
//! do harm: they turn smooth waves into steps and sustain ripples.

use multiversion::multiversion;

use super::block::{Block, NEARBY};
use super::part::Part;
use super::slope::{limited, steep};
use crate::elementary::{larger, lesser};
use crate::wave::riemann::Straight;

/// Least ratio of the largest to the smallest difference between neighbours near a cell inside a front. In a resolved wave the differences are more
/// alike.
const UNEVEN: f64 = 4.0;

/// Fraction of a difference by which stresses may be off the line.
const OFF_LINE: f64 = 1e-3;

/// Largest ratio of waves in the other direction to the front: ripples of either direction must stay ripples.
const OTHER_WAY: f64 = 0.1;

/// Fraction of the elastic limit below which a difference does not count as a front.
const FAINT: f64 = 1e-6;

/// Relative rounding of a stress that may take it off its line.
const ROUNDING: f64 = 1e-9;

/// Slopes of a cell inside a front, as differences.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slopes {
    /// Slope of the stress, Pa.
    pub stress: f64,
    /// Slope of the velocity, m/s.
    pub velocity: f64,
    /// Slope of E times the strain, Pa.
    pub e_equivalent_strain: f64,
}

/// Marks with 1 in `found` the cells of a row that may lie inside a front: stress rises or falls through them, lies beyond the elastic limit, and
/// varies unevenly. The [`NEARBY`] cells at each end of the row are never marked. `sizes` is scratch of the same length.
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
    // Magnitudes of the differences near a cell; the middle two are those to its neighbours.
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

/// Returns the slopes of a cell inside a front of one direction along one line of the curve other than the elastic one; `None` elsewhere. The cell
/// must be one that [`find`] has marked.
pub(super) fn slopes(block: &Block, part: &Part, i: usize) -> Option<Slopes> {
    let sigma = &block.sigma;
    let greater = (sigma[i] - sigma[i - 1]).abs().max((sigma[i + 1] - sigma[i]).abs());
    along(&line(block, part, i, greater)?, block, i)
}

/// Returns the line on which a cell and its neighbours lie, if they lie on one.
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

/// Returns the slopes if waves of one direction prevail: steep ones for these waves, limited ones for the others.
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

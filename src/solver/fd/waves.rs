//! The two elastic waves in a row of cells at Courant number 1.
//!
//! The scheme carries elastic waves exactly, one cell per step. With f travelling to the right and g to the left,
//!
//! ```text
//! sigma_i = f_i + g_i,    rho c0 v_i = g_i - f_(i-1)
//! ```
//!
//! where node i is to the left of cell i: d'Alembert's solution on the staggered grid. A step moves f and g by one cell. Only the values
//! that enter at the two edges are new: f from the left node, g from the right one.

use serde::{Deserialize, Serialize};

use crate::elementary::{larger, lesser};

/// Waves in a block, both as rho c0 times a velocity, Pa.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Waves {
    /// f from left to right, starting at index `cells - turn` and wrapping around.
    right: Vec<f64>,
    /// g likewise, starting at index `turn`.
    left: Vec<f64>,
    /// Number of steps modulo the number of cells.
    turn: usize,
    /// Ranges of f and g, over all values that have been in the block since the turn before the latest one began.
    spans: [Span; 2],
    /// Ranges of the values that entered since the latest turn began.
    latest: [Span; 2],
}

/// Smallest and largest value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Span {
    low: f64,
    high: f64,
}

impl Span {
    const NOTHING: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };

    fn of(values: &[f64]) -> Self {
        values.iter().fold(Self::NOTHING, |span, &value| span.with(value))
    }

    #[inline(always)]
    fn with(self, value: f64) -> Self {
        Self { low: lesser(self.low, value), high: larger(self.high, value) }
    }

    #[inline(always)]
    fn has(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

impl Waves {
    /// Decomposes these stresses, and these velocities of nodes of `impedance` rho c0 (Pa s/m), into waves; the two outer nodes are not
    /// read. Both waves are computed from either side and averaged, so that a bar and its mirror image have the same bits.
    pub fn of(impedance: f64, sigma: &[f64], v: &[f64]) -> Self {
        let last = sigma.len() - 1;
        let from_left = without_alternating_part(last + 1, |i| sigma[i] - impedance * v[i]);
        let mut from_right = without_alternating_part(last + 1, |i| sigma[last - i] + impedance * v[last + 1 - i]);
        from_right.reverse();
        let mean = |of: &[f64], other: &[f64]| {
            let all = sigma.iter().zip(of).zip(other);
            all.map(|((sigma, own), other)| 0.5 * (own + (sigma - other))).collect::<Vec<f64>>()
        };
        let (right, left) = (mean(&from_left, &from_right), mean(&from_right, &from_left));
        let spans = [Span::of(&right), Span::of(&left)];
        Self { right, left, turn: 0, spans, latest: [Span::NOTHING; 2] }
    }

    pub fn cells(&self) -> usize {
        self.right.len()
    }

    /// Returns f and g of cell i.
    #[inline(always)]
    fn at(&self, i: usize) -> [f64; 2] {
        let cells = self.cells();
        let wrapped = |entry: usize| if entry < cells { entry } else { entry - cells };
        [self.right[wrapped(i + cells - self.turn)], self.left[wrapped(i + self.turn)]]
    }

    /// Returns the stress of cell i, Pa.
    #[inline(always)]
    pub fn stress(&self, i: usize) -> f64 {
        let [f, g] = self.at(i);
        f + g
    }

    /// Returns the velocity of the node to the left of cell i, inside the block, m/s; `gain` is 1/(rho c0).
    pub fn velocity(&self, i: usize, gain: f64) -> f64 {
        gain * (self.at(i)[1] - self.at(i - 1)[0])
    }

    /// Returns the values that enter at both edges in a step, f at the left and g at the right; the arguments are rho c0 times the
    /// velocities of the nodes there.
    #[inline(always)]
    pub fn incoming(&self, [first, last]: [f64; 2]) -> [f64; 2] {
        [self.left[self.turn] - first, self.right[self.cells() - 1 - self.turn] + last]
    }

    /// Moves the waves by one step, with these incoming values.
    #[inline(always)]
    pub fn take(&mut self, [f, g]: [f64; 2]) {
        let cells = self.cells();
        self.right[cells - 1 - self.turn] = f;
        self.left[self.turn] = g;
        self.spans = [self.spans[0].with(f), self.spans[1].with(g)];
        self.latest = [self.latest[0].with(f), self.latest[1].with(g)];
        self.turn += 1;
        if self.turn == cells {
            self.turn = 0;
            self.spans = std::mem::replace(&mut self.latest, [Span::NOTHING; 2]);
        }
    }

    /// Computes the stresses, and the velocities of the nodes inside the block; `gain` is 1/(rho c0).
    pub fn show(&self, gain: f64, sigma: &mut [f64], v: &mut [f64]) {
        let (cells, outer) = (self.cells(), v[0]);
        sigma.copy_from_slice(&self.right);
        sigma.rotate_right(self.turn);
        let (later, first) = self.left.split_at(self.turn);
        v[..first.len()].copy_from_slice(first);
        v[first.len()..cells].copy_from_slice(later);
        for i in (1..cells).rev() {
            let g = v[i];
            v[i] = gain * (g - sigma[i - 1]);
            sigma[i] += g;
        }
        sigma[0] += v[0];
        v[0] = outer;
    }

    /// Returns the outermost values of both waves with the incoming ones, from the edge inwards.
    pub fn entering(&self, incoming: [f64; 2]) -> [[f64; 4]; 2] {
        let last = self.cells() - 1;
        let right = [0, 1, 2].map(|i| self.at(i)[0]);
        let left = [0, 1, 2].map(|i| self.at(last - i)[1]);
        [[incoming[0], right[0], right[1], right[2]], [incoming[1], left[0], left[1], left[2]]]
    }

    /// Returns whether `four` is true of any four neighbouring values of either wave.
    pub fn have(&self, four: impl Fn(&[f64]) -> bool) -> bool {
        self.right.windows(4).any(&four) || self.left.windows(4).any(&four)
    }

    /// Returns whether the incoming values lie within the ranges of the waves, so that [`Self::peak`] does not change.
    #[inline(always)]
    pub fn span(&self, incoming: [f64; 2]) -> bool {
        self.spans[0].has(incoming[0]) && self.spans[1].has(incoming[1])
    }

    /// Returns the largest absolute stress to which the two waves can add up, Pa.
    pub fn peak(&self) -> f64 {
        largest_sum(self.spans)
    }

    /// As [`Self::peak`], including the incoming values.
    pub fn peak_with(&self, incoming: [f64; 2]) -> f64 {
        largest_sum([0, 1].map(|wave| self.spans[wave].with(incoming[wave])))
    }
}

/// Returns the largest absolute value of the sum of two values within these ranges.
fn largest_sum([a, b]: [Span; 2]) -> f64 {
    larger(a.high + b.high, -(a.low + b.low))
}

/// Returns a wave of this many cells in which each value and the one before it add up to `pair`. These sums do not determine the part that
/// alternates from cell to cell; it is removed.
fn without_alternating_part(cells: usize, pair: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut before = 0.0;
    let rest = (1..cells).map(|i| {
        before = pair(i) - before;
        before
    });
    let mut wave: Vec<f64> = std::iter::once(0.0).chain(rest).collect();
    let part = alternating_part(&wave);
    wave.iter_mut().zip([part, -part].into_iter().cycle()).for_each(|(own, part)| *own -= part);
    wave
}

/// Returns the part of a wave that alternates from cell to cell everywhere: the median of a quarter of its second differences, each with
/// the sign of its cell. The median ignores sharp waves, which have large second differences in a few cells.
fn alternating_part(wave: &[f64]) -> f64 {
    let sense = |i: usize| if i.is_multiple_of(2) { 0.25 } else { -0.25 };
    let own = |(i, w): (usize, &[f64])| sense(i) * (w[0] - 2.0 * w[1] + w[2]);
    let mut own: Vec<f64> = wave.windows(3).enumerate().map(own).collect();
    let middle = own.len() / 2;
    *own.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_that_alternates_is_found_beside_sharp_waves() {
        let wave = |i: usize| if (100..140).contains(&i) { 3.0 } else { 1.0 };
        let ripple = |i: usize| if i.is_multiple_of(2) { 0.25 } else { -0.25 };
        let wave: Vec<f64> = (0..256).map(|i| wave(i) + ripple(i)).collect();
        assert_eq!(alternating_part(&wave), 0.25);
    }
}

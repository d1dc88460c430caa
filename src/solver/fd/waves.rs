//! The two elastic waves in a row of cells at Courant number 1.
//!
//! The scheme carries elastic waves exactly, a cell in a step. With f that runs to the right and g to the left,
//!
//! ```text
//! sigma_i = f_i + g_i,    rho c0 v_i = g_i - f_(i-1)
//! ```
//!
//! where node i is to the left of cell i: d'Alembert's solution on the staggered grid. A step moves f and g on by a cell, and only what
//! comes in at the two edges is new: f from the left node, g from the right one.

use serde::{Deserialize, Serialize};

use crate::elementary::{larger, lesser};

/// The waves in a block, both as rho c0 times a velocity, Pa.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Waves {
    /// f from left to right, from entry `cells - turn` on and then from the first one.
    right: Vec<f64>,
    /// g likewise, from entry `turn` on.
    left: Vec<f64>,
    /// Steps taken, less all whole turns.
    turn: usize,
    /// Of f and g, all that has been in the block since the latest turn but one began.
    spans: [Span; 2],
    /// Of those, what came in since the latest turn began.
    latest: [Span; 2],
}

/// Least and largest value.
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
    /// Those under these stresses, between these nodes of `impedance` rho c0 (Pa s/m); the two outer nodes are not read. Both are found from
    /// either side, so that a bar and its mirror image have the same bits.
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

    /// f and g of cell i.
    #[inline(always)]
    fn at(&self, i: usize) -> [f64; 2] {
        let cells = self.cells();
        let wrapped = |entry: usize| if entry < cells { entry } else { entry - cells };
        [self.right[wrapped(i + cells - self.turn)], self.left[wrapped(i + self.turn)]]
    }

    /// Stress of cell i, Pa.
    #[inline(always)]
    pub fn stress(&self, i: usize) -> f64 {
        let [f, g] = self.at(i);
        f + g
    }

    /// Velocity of the node to the left of cell i, inside the block, m/s; `gain` is 1/(rho c0).
    pub fn velocity(&self, i: usize, gain: f64) -> f64 {
        gain * (self.at(i)[1] - self.at(i - 1)[0])
    }

    /// What comes in at both edges in a step, at the left f and at the right g, where these nodes move at rho c0 times their velocity.
    #[inline(always)]
    pub fn incoming(&self, [first, last]: [f64; 2]) -> [f64; 2] {
        [self.left[self.turn] - first, self.right[self.cells() - 1 - self.turn] + last]
    }

    /// Moves on by a step.
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

    /// The stresses, and the velocities of the nodes inside the block; `gain` is 1/(rho c0).
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

    /// The outermost values of both with what comes in, outside first.
    pub fn entering(&self, incoming: [f64; 2]) -> [[f64; 4]; 2] {
        let last = self.cells() - 1;
        let right = [0, 1, 2].map(|i| self.at(i)[0]);
        let left = [0, 1, 2].map(|i| self.at(last - i)[1]);
        [[incoming[0], right[0], right[1], right[2]], [incoming[1], left[0], left[1], left[2]]]
    }

    /// Whether this is so of any four values side by side in one of them.
    pub fn have(&self, four: impl Fn(&[f64]) -> bool) -> bool {
        self.right.windows(4).any(&four) || self.left.windows(4).any(&four)
    }

    /// What comes in is between values that are there: [`Self::peak`] stays.
    #[inline(always)]
    pub fn span(&self, incoming: [f64; 2]) -> bool {
        self.spans[0].has(incoming[0]) && self.spans[1].has(incoming[1])
    }

    /// Largest stress that both can have together, Pa.
    pub fn peak(&self) -> f64 {
        largest_sum(self.spans)
    }

    /// The same with what comes in.
    pub fn peak_with(&self, incoming: [f64; 2]) -> f64 {
        largest_sum([0, 1].map(|wave| self.spans[wave].with(incoming[wave])))
    }
}

/// Largest size of the sum of two values within these spans.
fn largest_sum([a, b]: [Span; 2]) -> f64 {
    larger(a.high + b.high, -(a.low + b.low))
}

/// A wave of so many cells, each of which has with the one before the sum `pair`. That leaves open a part that alternates from cell to cell.
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

/// What of a wave alternates from cell to cell everywhere: the median of the fourth part of its second differences, each taken with the sense of
/// its cell, as sharp waves have large ones in a few cells.
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

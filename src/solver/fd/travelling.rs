//! Blocks that have not yielded as two waves that travel unchanged.
//!
//! At Courant number 1 the scheme carries elastic waves exactly, a cell in a step. With f that runs to the right and g to the left,
//!
//! ```text
//! sigma_i = f_i + g_i,    rho c0 v_i = g_i - f_(i-1)
//! ```
//!
//! where node i is to the left of cell i: d'Alembert's solution on the staggered grid. A step moves f and g on by a cell, and only what
//! comes in at the two edges is new: f from the left node, g from the right one. So it costs the same for any number of cells, until
//! both waves together could reach the elastic limit somewhere in the block. A block begins with it when the nodes at both its
//! edges have changed their velocity in as many steps as it has cells: where sharp waves pass, cells rest in between, which costs even less.

use serde::{Deserialize, Serialize};

use super::block::{Block, BlockLaw};
use crate::elementary::{larger, lesser};

/// Fewest cells of a block that are carried as waves: a few are as quickly stepped.
const FEWEST_CELLS: usize = 16;

/// Oscillations from cell to cell that the grid filter need not see, in terms of the yield stress.
const NEGLIGIBLE: f64 = 1e-6;

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
    fn of(impedance: f64, sigma: &[f64], v: &[f64]) -> Self {
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

    fn cells(&self) -> usize {
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
    fn incoming(&self, [first, last]: [f64; 2]) -> [f64; 2] {
        [self.left[self.turn] - first, self.right[self.cells() - 1 - self.turn] + last]
    }

    /// Moves on by a step.
    #[inline(always)]
    fn take(&mut self, [f, g]: [f64; 2]) {
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

    /// Largest stress that both can have together.
    fn peak(&self) -> f64 {
        let [f, g] = self.spans;
        larger(f.high + g.high, -(f.low + g.low))
    }

    /// The stresses, and the velocities of the nodes inside the block; `gain` is 1/(rho c0).
    fn show(&self, gain: f64, sigma: &mut [f64], v: &mut [f64]) {
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

    /// One of the waves oscillates from cell to cell as it comes in.
    fn oscillate(&self, incoming: [f64; 2], law: BlockLaw<'_>) -> bool {
        let last = self.cells() - 1;
        let right = [incoming[0], self.at(0)[0], self.at(1)[0], self.at(2)[0]];
        let left = [incoming[1], self.at(last)[1], self.at(last - 1)[1], self.at(last - 2)[1]];
        oscillates(&right, law) || oscillates(&left, law)
    }
}

/// Four values of a wave, side by side, go up and down by more than [`NEGLIGIBLE`].
fn oscillates(wave: &[f64], law: BlockLaw<'_>) -> bool {
    let [first, middle, last] = [0, 1, 2].map(|i| wave[i + 1] - wave[i]);
    middle.abs() > NEGLIGIBLE * law.yield_stress
        && law.filter.oscillates([first, middle, last].map(|difference| law.velocity_gain * difference))
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

impl BlockLaw<'_> {
    /// Stresses up to `peak` (Pa) neither make a cell flow nor are near a limit of what the law knows.
    fn stays_below(self, peak: f64) -> bool {
        peak <= self.yield_stress && self.end.is_far_below_yield(peak, self.yield_stress)
    }
}

impl Block {
    /// Takes the step of a block that is carried as waves, or can be from now on. False where it cannot, and nothing is done.
    pub fn travel(&mut self, law: BlockLaw<'_>) -> bool {
        if self.waves.is_none() && !self.starts_to_travel(law) {
            return false;
        }
        let Some(waves) = &mut self.waves else { return false };
        let (cells, damped) = (waves.cells(), self.damps_from <= law.step);
        let incoming = waves.incoming([law.stress_gain * self.v[0], law.stress_gain * self.v[cells]]);
        let as_before = waves.spans[0].has(incoming[0]) && waves.spans[1].has(incoming[1]) && !damped;
        if !as_before && !self.go_on_travelling(incoming, law) {
            self.stop_travelling(law.velocity_gain);
            self.travels_from = law.step + cells;
            return false;
        }
        if let Some(waves) = &mut self.waves {
            waves.take(incoming);
            (self.sigma[0], self.sigma[cells - 1]) = (waves.stress(0), waves.stress(cells - 1));
            if !self.watched.is_empty() {
                self.show_watched(law.velocity_gain);
            }
        }
        true
    }

    /// Whether the block can still be carried as waves with what comes in.
    fn go_on_travelling(&self, incoming: [f64; 2], law: BlockLaw<'_>) -> bool {
        let Some(waves) = &self.waves else { return false };
        let [f, g] = [0, 1].map(|wave| waves.spans[wave].with(incoming[wave]));
        let damped = self.damps_from <= law.step;
        !self.needs_cells(law)
            && law.stays_below(larger(f.high + g.high, -(f.low + g.low)))
            && !(damped && waves.oscillate(incoming, law))
    }

    fn starts_to_travel(&mut self, law: BlockLaw<'_>) -> bool {
        let cells = self.sigma.len();
        let edges = [self.v[0], self.v[cells]];
        let before = std::mem::replace(&mut self.latest_edges, edges);
        if edges[0] == before[0] || edges[1] == before[1] {
            self.travels_from = law.step + cells;
        }
        if !law.travels || self.is_plastic() || law.step < self.travels_from || self.needs_cells(law) {
            return false;
        }
        let waves = Waves::of(law.stress_gain, &self.sigma, &self.v);
        let damped = self.damps_from <= law.step;
        let oscillates = |wave: &[f64]| damped && wave.windows(4).any(|four| oscillates(four, law));
        let travels = law.stays_below(waves.peak()) && !oscillates(&waves.right) && !oscillates(&waves.left);
        if travels {
            self.wake();
            self.impulses_at_edges = [0.0; 2];
            self.waves = Some(Box::new(waves));
        } else {
            self.travels_from = law.step + cells;
        }
        travels
    }

    /// Every cell must be stepped: few cells, of various sections, or such that the filter takes shocks in them.
    fn needs_cells(&self, law: BlockLaw<'_>) -> bool {
        let takes_shocks = self.damps_from <= law.step && law.filter.takes_shocks();
        takes_shocks || self.sigma.len() < FEWEST_CELLS || self.taper.is_some()
    }

    /// Goes on in cells; `gain` is 1/(rho c0).
    pub fn stop_travelling(&mut self, gain: f64) {
        self.show_waves(gain);
        if self.waves.take().is_some() {
            self.note_undamped();
            self.wake();
        }
    }

    /// Brings stresses and velocities of a block that is carried as waves up to date.
    pub fn show_waves(&mut self, gain: f64) {
        if let Some(waves) = &self.waves {
            waves.show(gain, &mut self.sigma, &mut self.v);
        }
    }

    /// Brings the watched cells up to date, with what their velocities depend on.
    fn show_watched(&mut self, gain: f64) {
        let Some(waves) = &self.waves else { return };
        for &cell in &self.watched {
            let shown = cell.saturating_sub(1)..=(waves.cells() - 1).min(cell + 1);
            shown.clone().for_each(|i| self.sigma[i] = waves.stress(i));
            shown.skip(1).for_each(|i| self.v[i] = waves.velocity(i, gain));
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::bar::{Bar, EndCondition, History, Segment};
    use crate::law::{DataEnd, Indexed, Isotropic, Rows, Table};
    use crate::material::{Beyond, Curve, Material, Sense};
    use crate::solver::fd::{Grid, Leapfrog, SegmentLaw, Shocks};
    use std::sync::Arc;

    const YIELD: f64 = 200e6;

    /// A bar of segments with these lengths (m) and initial velocities (m/s), of a metal that yields at [`YIELD`].
    fn bar(segments: &[(f64, f64)], ends: [EndCondition; 2]) -> Leapfrog {
        let curve = Curve::new(&[(1e-3, YIELD), (1e-2, 1.5 * YIELD)], Beyond::Extend).expect("rows rise");
        let material = Arc::new(Material::from_curve("steel", 7800.0, curve));
        let table = Table::new(material.branch(Sense::Tension), material.modulus);
        let law = SegmentLaw {
            law: Arc::new(Rows::new(Isotropic(Indexed::new(&table).expect("fits")))),
            yield_stress: YIELD,
            end: DataEnd::of(&material),
            shocks: Shocks::NONE,
            stiffenings: Default::default(),
        };
        let piece =
            |&(length, velocity): &(f64, f64)| Segment::new(length, 1e-4, material.clone()).with_velocity(velocity);
        let bar = Bar { segments: segments.iter().map(piece).collect(), area_given: true };
        let laws = vec![law; segments.len()];
        Leapfrog::new(&bar, Grid::new(&bar, 1000, 1.0), laws, ends)
    }

    fn carried(bar: &Leapfrog) -> usize {
        bar.blocks.iter().filter(|block| block.waves.is_some()).count()
    }

    /// Largest difference of stresses and of velocities (times rho c0) of two bars, Pa.
    fn difference(a: &Leapfrog, b: &Leapfrog) -> f64 {
        let impedance = a.constants[0].stress_gain;
        let most = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let pairs = a.blocks.iter().zip(&b.blocks);
        pairs.map(|(a, b)| most(&a.sigma, &b.sigma).max(impedance * most(&a.v, &b.v))).fold(0.0, f64::max)
    }

    fn sine(velocity: f64) -> EndCondition {
        let row = |k: u32| (1e-6 * f64::from(k), velocity * (0.05 * f64::from(k)).sin());
        let rows: Vec<(f64, f64)> = (0..400).map(row).collect();
        EndCondition::Velocity { history: History::new(&rows).expect("times rise"), release: None }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Elastic bars with any ends move as their cells do.
        #[test]
        fn waves_are_what_the_cells_do(
            segments in prop::collection::vec((0.2_f64..1.0, prop::sample::select(vec![0.0, 0.0, 0.1])), 1..3),
            left in 0..5_usize,
            velocity in 0.05_f64..0.2,
        ) {
            let left = || match left {
                0 => sine(velocity),
                1 => EndCondition::Striker { mass: 0.1, velocity },
                2 => EndCondition::Spring { stiffness: 1e8 },
                3 => EndCondition::Velocity { history: History::constant(velocity), release: Some(3e-5) },
                _ => EndCondition::Absorbing,
            };
            let mut waves = bar(&segments, [left(), EndCondition::Fixed]);
            let mut cells = bar(&segments, [left(), EndCondition::Fixed]).in_cells();
            for _ in 0..40 {
                waves.advance_by(157);
                cells.advance_by(157);
                prop_assert!(difference(&waves, &cells) < 1e-11 * YIELD, "{} Pa", difference(&waves, &cells));
            }
            prop_assert!(waves.stayed_elastic());
        }
    }

    #[test]
    fn smooth_waves_are_carried_and_those_that_could_yield_are_not() {
        let mut weak = bar(&[(1.0, 0.0)], [sine(2.0), EndCondition::Free]);
        weak.advance_by(1800);
        assert_eq!(carried(&weak), weak.blocks.len());
        // Each wave has more than half of the yield stress: they add up where they cross.
        let strong = || bar(&[(1.0, 0.0)], [sine(3.9), EndCondition::Fixed]);
        let (mut waves, mut cells) = (strong(), strong().in_cells());
        for _ in 0..30 {
            waves.advance_by(100);
            cells.advance_by(100);
            // Once a cell has yielded, the filter takes some of what alternates where waves cross, and nothing of a wave by itself.
            let bound = if cells.stayed_elastic() { 1e-11 } else { 1e-3 };
            assert!(difference(&waves, &cells) < bound * YIELD, "{} Pa", difference(&waves, &cells));
        }
        assert!(!waves.stayed_elastic() && !cells.stayed_elastic());
    }

    #[test]
    fn a_bar_that_a_sharp_wave_passes_stays_in_cells() {
        let ends = [EndCondition::Velocity { history: History::constant(1.0), release: None }, EndCondition::Free];
        let mut bar = bar(&[(1.0, 0.0)], ends);
        for _ in 0..9 {
            bar.advance_by(100);
            assert_eq!(carried(&bar), 0);
        }
    }

    #[test]
    fn the_part_that_alternates_is_found_beside_sharp_waves() {
        let wave = |i: usize| if (100..140).contains(&i) { 3.0 } else { 1.0 };
        let ripple = |i: usize| if i.is_multiple_of(2) { 0.25 } else { -0.25 };
        let wave: Vec<f64> = (0..256).map(|i| wave(i) + ripple(i)).collect();
        assert_eq!(alternating_part(&wave), 0.25);
    }
}

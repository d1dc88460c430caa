//! Blocks that are elastic, or elastic again, are carried as two waves, see [`super::waves`].
//!
//! A step then costs the same for any number of cells, until both waves together could reach the elastic limit somewhere in the block. A
//! block starts to be carried as waves when the nodes at both its edges have changed their velocity in as many steps as it has cells. If
//! only sharp waves pass, cells are at rest in between, which costs even less; and blocks that have yielded come to rest when the remaining
//! changes are negligible.

use super::block::{Block, BlockLaw};
use super::waves::Waves;

/// Smallest number of cells of a block that is carried as waves; fewer cells are stepped as fast.
const FEWEST_CELLS: usize = 16;

/// Size of the oscillations from cell to cell that the grid filter may ignore, relative to the elastic limit, in blocks that have not
/// yielded and in those that have: a released copper bar keeps oscillations of 1e-6 to 1e-4 for thousands of steps.
const NEGLIGIBLE: [f64; 2] = [1e-6, 1e-3];

/// Changes from step to step at the edges of a block that has yielded, relative to the yield stress, up to which the block is coming to
/// rest.
const COMING_TO_REST: f64 = 1e-6;

/// Largest stress at which a block that has yielded starts to be carried, relative to its elastic limit: behind a front, cells stay at
/// their limit.
const UNLOADED: f64 = 0.9;

/// Stresses that decide whether a block is carried as waves, Pa.
struct Bounds {
    /// Stress up to which its cells are known to be elastic; 0 if unknown.
    elastic: f64,
    /// Stress up to which it starts to be carried.
    unloaded: f64,
    /// Size of oscillations that are negligible.
    oscillation: f64,
    /// Changes at its edges up to which it is coming to rest.
    rest: f64,
}

/// Returns whether four neighbouring values of a wave alternate from cell to cell by more than `negligible` (Pa).
fn oscillates(wave: &[f64], negligible: f64, law: BlockLaw<'_>) -> bool {
    let [first, middle, last] = [0, 1, 2].map(|i| wave[i + 1] - wave[i]);
    middle.abs() > negligible
        && law.filter.oscillates([first, middle, last].map(|difference| law.velocity_gain * difference))
}

impl Block {
    /// Advances a block that is carried as waves, or can be from now on. Returns false without advancing it if it cannot be carried.
    pub fn travel(&mut self, law: BlockLaw<'_>) -> bool {
        if self.waves.is_none() && !self.starts_to_travel(law) {
            return false;
        }
        let Some(mut waves) = self.waves.take() else { return false };
        let (cells, damped) = (waves.cells(), self.filter_from_step <= law.step);
        let incoming = waves.incoming([law.stress_gain * self.v[0], law.stress_gain * self.v[cells]]);
        let goes_on = !damped && waves.span(incoming) || self.goes_on_travelling(&waves, incoming, law);
        if goes_on {
            waves.take(incoming);
            (self.sigma[0], self.sigma[cells - 1]) = (waves.stress(0), waves.stress(cells - 1));
            self.show_watched(&waves, law.velocity_gain);
        }
        self.waves = Some(waves);
        if !goes_on {
            self.stop_travelling(law.velocity_gain);
            self.travels_from = law.step + cells;
        }
        goes_on
    }

    /// Returns whether the block can still be carried as these waves, with the incoming values.
    fn goes_on_travelling(&self, waves: &Waves, incoming: [f64; 2], law: BlockLaw<'_>) -> bool {
        let (damped, bounds) = (self.filter_from_step <= law.step, self.bounds(law));
        !self.needs_cells(law)
            && self.stays_within(bounds.elastic, waves.peak_with(incoming), law)
            && !(damped && waves.entering(incoming).iter().any(|wave| oscillates(wave, bounds.oscillation, law)))
    }

    fn starts_to_travel(&mut self, law: BlockLaw<'_>) -> bool {
        let cells = self.sigma.len();
        let edges = [self.v[0], self.v[cells]];
        let before = std::mem::replace(&mut self.latest_edges, edges);
        let bounds = self.bounds(law);
        let rests = |side: usize| law.stress_gain * (edges[side] - before[side]).abs() <= bounds.rest;
        if rests(0) || rests(1) || bounds.elastic == 0.0 {
            self.travels_from = law.step + cells;
        }
        if !law.travels || law.step < self.travels_from || self.needs_cells(law) {
            return false;
        }
        let waves = Waves::of(law.stress_gain, &self.sigma, &self.v);
        let damped = self.filter_from_step <= law.step;
        let travels = self.stays_within(bounds.unloaded, waves.peak(), law)
            && !(damped && waves.have(|four| oscillates(four, bounds.oscillation, law)));
        if travels {
            self.wake();
            self.impulses_at_edges = [0.0; 2];
            self.waves = Some(Box::new(waves));
        } else {
            self.travels_from = law.step + cells;
        }
        travels
    }

    fn bounds(&self, law: BlockLaw<'_>) -> Bounds {
        if self.is_plastic() {
            let elastic = self.elastic_up_to;
            let [unloaded, oscillation] = [UNLOADED * elastic, NEGLIGIBLE[1] * elastic];
            return Bounds { elastic, unloaded, oscillation, rest: COMING_TO_REST * law.yield_stress };
        }
        let elastic = law.yield_stress;
        Bounds { elastic, unloaded: elastic, oscillation: NEGLIGIBLE[0] * elastic, rest: 0.0 }
    }

    /// Returns whether stresses up to `peak` (Pa) stay within `bound` and are not near a limit of the law's data. For blocks that have
    /// yielded, the bound takes account of the latter.
    fn stays_within(&self, bound: f64, peak: f64, law: BlockLaw<'_>) -> bool {
        peak <= bound && (self.is_plastic() || law.end.is_far_below_yield(peak, law.yield_stress))
    }

    /// Returns whether every cell must be stepped: if the cells are few or of varying section, or if the filter treats shocks in them.
    fn needs_cells(&self, law: BlockLaw<'_>) -> bool {
        let takes_shocks = self.filter_from_step <= law.step && law.filter.takes_shocks();
        takes_shocks || self.sigma.len() < FEWEST_CELLS || self.taper.is_some()
    }

    /// Ends the treatment as waves, so that the cells are stepped again; `gain` is 1/(rho c0).
    pub fn stop_travelling(&mut self, gain: f64) {
        self.show_waves(gain);
        if self.waves.take().is_some() {
            self.note_undamped();
            self.wake();
        }
    }

    /// Updates the stresses and velocities of a block that is carried as waves.
    pub fn show_waves(&mut self, gain: f64) {
        if let Some(waves) = &self.waves {
            waves.show(gain, &mut self.sigma, &mut self.v);
        }
    }

    /// Updates the watched cells, and the values on which their velocities depend.
    fn show_watched(&mut self, waves: &Waves, gain: f64) {
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

    use crate::bar::{Bar, EndCondition, History, Segment};
    use crate::law::{DataEnd, Indexed, Isotropic, Rows, Table};
    use crate::material::{Beyond, Curve, Material, Sense};
    use crate::solver::fd::{Grid, Leapfrog, SegmentLaw, Shocks};
    use std::sync::Arc;

    const YIELD: f64 = 200e6;

    /// A bar of segments with these lengths (m) and initial velocities (m/s), of a metal that yields at [`YIELD`].
    fn bar(segments: &[(f64, f64)], ends: [EndCondition; 2]) -> Leapfrog {
        let curve = Curve::new(&[(1e-3, YIELD), (1e-2, 1.5 * YIELD)], Beyond::Extend).expect("rows rise");
        let material = Arc::new(Material::from_curve("steel", 7800.0, curve).expect("a material"));
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
    fn blocks_that_have_yielded_are_carried_once_they_are_elastic_again() {
        // A wave makes the bar yield, and others that do not follow it.
        let driven = || {
            let angle = |k: u32| std::f64::consts::PI / 100.0 * f64::from(k);
            let velocity = |k: u32| if k <= 100 { 8.0 * angle(k).sin().powi(2) } else { angle(3 * k).sin() };
            let rows: Vec<(f64, f64)> = (0..=400).map(|k| (1e-6 * f64::from(k), velocity(k))).collect();
            let history = History::new(&rows).expect("times rise");
            bar(&[(1.0, 0.0)], [EndCondition::Velocity { history, release: None }, EndCondition::Absorbing])
        };
        let (mut waves, mut cells) = (driven(), driven().in_cells());
        for _ in 0..19 {
            waves.advance_by(100);
            cells.advance_by(100);
            let difference = difference(&waves, &cells);
            assert!(difference < 1e-3 * YIELD, "{difference} Pa after {} steps", waves.step());
        }
        let yielded = waves.blocks.iter().filter(|block| block.is_plastic());
        assert!(yielded.clone().any(|block| block.waves.is_some()), "{} blocks have yielded", yielded.count());
        let plastic = |bar: &Leapfrog| bar.blocks.iter().map(|block| block.plastic).sum::<f64>();
        assert!((plastic(&waves) / plastic(&cells) - 1.0).abs() < 1e-6, "{:e} {:e}", plastic(&waves), plastic(&cells));
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
}

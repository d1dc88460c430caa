//! Active and quiescent cells of a block.
//!
//! A piece of [`CHUNK`] cells is at rest if another step would change no bit of it: its nodes have equal velocities, their forces do not
//! change these, and the law returns the same state. This is checked exactly, so that skipping the piece changes nothing.

use std::ops::Range;

use super::block::{Block, BlockLaw, Stage};
use super::signals::{Signals, inner_nodes};
use crate::law::CHUNK;

impl Block {
    /// Returns true if nothing needs to be computed until a node at the edges changes its velocity.
    pub fn at_rest(&self) -> bool {
        self.active.is_empty()
    }

    /// Returns true if the cells at the left (0) or right (1) edge are at rest.
    pub fn rests_at(&self, side: usize) -> bool {
        self.at_rest() || if side == 0 { self.active.start > 0 } else { self.active.end < self.sigma.len() }
    }

    /// Activates all cells.
    pub fn wake(&mut self) {
        self.active = 0..self.sigma.len();
    }

    /// Sets the velocity of the node at the left (0) or right (1) edge, and activates the cells there if it changes.
    pub fn set_edge(&mut self, side: usize, velocity: f64) {
        let cells = self.sigma.len();
        let node = side * cells;
        if self.v[node] == velocity {
            return;
        }
        self.v[node] = velocity;
        let piece = if side == 0 { 0..CHUNK.min(cells) } else { (cells - 1) / CHUNK * CHUNK..cells };
        self.active =
            if self.at_rest() { piece } else { self.active.start.min(piece.start)..self.active.end.max(piece.end) };
    }

    /// Finds the cells that the next step has to compute, depending on how far signals travel. Returns false if there are none. Every step
    /// of a block's stresses starts with this.
    pub fn find_active(&mut self, law: BlockLaw<'_>, signals: Signals) -> bool {
        #[cfg(test)]
        if self.always_active {
            self.wake();
            return true;
        }
        match signals {
            Signals::ThroughCells => self.widen(),
            Signals::ThroughNodes if self.wake_if_strained() => return true,
            Signals::ThroughNodes => {}
        }
        self.narrow(law);
        !self.at_rest()
    }

    /// Activates all cells if the velocities of the nodes differ anywhere. Returns whether they do.
    pub fn wake_if_strained(&mut self) -> bool {
        let strained = self.v.iter().any(|v| *v != self.v[0]);
        if strained {
            self.wake();
        }
        strained
    }

    /// Activates the pieces next to the active ones if the nodes at their border move differently; a signal travels no farther in a step.
    pub fn widen(&mut self) {
        let (Range { start, end }, cells) = (self.active.clone(), self.sigma.len());
        if start > 0 && self.v[start] != self.v[start - 1] {
            self.active.start -= CHUNK;
        }
        if end < cells && self.v[end] != self.v[end + 1] {
            self.active.end = cells.min(end + CHUNK);
        }
    }

    /// Deactivates the outer active pieces that have come to rest.
    fn narrow(&mut self, law: BlockLaw<'_>) {
        while !self.at_rest() {
            let Range { start, end } = self.active;
            let (after_first, before_last) = (end.min(start + CHUNK), (end - 1) / CHUNK * CHUNK);
            if self.settles(start..after_first, law) {
                self.active.start = after_first;
            } else if self.settles(before_last..end, law) {
                self.active.end = before_last;
            } else {
                return;
            }
        }
        self.note_undamped();
        self.impulses_at_edges = [0.0; 2];
    }

    /// Returns whether these cells have come to rest: their nodes have equal velocities, and another step changes neither these nor the
    /// law's state.
    fn settles(&mut self, cells: Range<usize>, law: BlockLaw<'_>) -> bool {
        let nodes = &self.v[cells.start..=cells.end];
        let v = nodes[0];
        if v != nodes[1] || v != nodes[cells.len()] || nodes.iter().any(|other| *other != v) {
            return false;
        }
        let moves = |i: usize| v + self.velocity_increment(law.velocity_gain, i) != v;
        let plastic = self.stage == Stage::Plastic;
        if inner_nodes(&cells, self.sigma.len()).any(moves)
            || plastic && !law.law.rests(&self.sigma, &self.state, cells.clone())
        {
            return false;
        }
        if plastic {
            self.flow[cells].fill(0.0);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use proptest::prelude::*;

    use super::*;
    use crate::bar::{Bar, EndCondition, History, Segment};
    use crate::law::{DataEnd, Envelope, Indexed, Isotropic, Mixed, RowLaw, Rows, Searched, Table};
    use crate::material::{Beyond, Curve, Material, Sense};
    use crate::solver::fd::block::Scratch;
    use crate::solver::fd::segment::Constants;
    use crate::solver::fd::{DistributedForces, Grid, Leapfrog, SegmentLaw, Shocks};

    const YIELD: f64 = 200e6;

    fn material(rows: u32) -> Material {
        let strain = |k: u32| 1e-3 * 50.0_f64.powf(f64::from(k) / f64::from(rows - 1));
        let rows: Vec<(f64, f64)> = (0..rows).map(|k| (strain(k), YIELD * (strain(k) / 1e-3).powf(0.2))).collect();
        Material::from_curve("steel", 7800.0, Curve::new(&rows, Beyond::Extend).expect("rows rise"))
            .expect("a material")
    }

    /// A bar that is struck, released, and vibrates between a free end and a wall.
    fn bar(material: Material, law: Arc<dyn RowLaw>) -> Leapfrog {
        let end = DataEnd::of(&material);
        let bar = Bar { segments: vec![Segment::new(1.0, 1.0, material)], area_given: true };
        let law = SegmentLaw { law, yield_stress: YIELD, end, shocks: Shocks::NONE, stiffenings: Default::default() };
        let struck = EndCondition::Velocity { history: History::constant(20.0), release: Some(5e-5) };
        Leapfrog::new(&bar, Grid::new(&bar, 1301, 1.0), vec![law], [struck, EndCondition::Fixed]).in_cells()
    }

    fn law_of<'a>(law: &'a SegmentLaw, constants: &'a Constants) -> BlockLaw<'a> {
        let Constants { stress_gain, velocity_gain, .. } = *constants;
        BlockLaw {
            law: law.law.as_ref(),
            stress_gain,
            velocity_gain,
            yield_stress: law.yield_stress,
            end: &law.end,
            filter: constants.filter(false),
            travels: false,
            step: 0,
        }
    }

    /// In every step, also advances the cells at rest, block by block: this must change none of them.
    fn assert_rest(mut bar: Leapfrog) {
        let (mut resting, mut yielded) = (0, 0);
        for step in 0..4000 {
            for block in bar.blocks.iter().filter(|block| !block.at_rest()) {
                let law = law_of(&bar.laws[0], &bar.constants[0]);
                let (mut before, cells) = (block.clone(), block.sigma.len());
                before.widen();
                let mut after = before.clone();
                after.wake();
                Scratch::lend(|scratch| after.advance_stresses(law, scratch));
                for i in (0..cells).filter(|i| !before.active.contains(i)) {
                    assert_eq!(before.sigma[i], after.sigma[i], "stress of cell {i}, step {step}");
                    for (a, b) in before.state.chunks_exact(cells).zip(after.state.chunks_exact(cells)) {
                        assert_eq!(a[i], b[i], "state of cell {i}, step {step}");
                    }
                    assert_eq!(before.flow.get(i).copied().unwrap_or(0.0), 0.0, "flow of cell {i}, step {step}");
                    if i > 0 && !before.active.contains(&(i - 1)) {
                        assert_eq!(
                            before.v[i] + after.velocity_increment(law.velocity_gain, i),
                            before.v[i],
                            "node {i}, step {step}"
                        );
                    }
                    resting += 1;
                    yielded += usize::from(block.stage == Stage::Plastic);
                }
            }
            bar.advance();
        }
        assert!(
            resting > 10_000 && yielded > 10_000,
            "{resting} cells rested beside others, {yielded} of them yielded"
        );
    }

    #[test]
    fn cells_at_rest_miss_nothing() {
        let table = |material: &Material| Table::new(material.branch(Sense::Tension), material.modulus);
        let of = |rows: u32, law: &dyn Fn(&Table) -> Arc<dyn RowLaw>| {
            let material = material(rows);
            let law = law(&table(&material));
            assert_rest(bar(material, law));
        };
        let mixed = |backbone: Indexed| Mixed { backbone, yield_stress: YIELD, kinematic: 0.4 };
        of(2, &|table| Arc::new(Rows::new(Isotropic(Envelope::<4>::new(table).expect("few lines")))));
        of(60, &|table| Arc::new(Rows::new(Isotropic(Indexed::new(table).expect("fits")))));
        of(60, &|table| Arc::new(Rows::new(mixed(Indexed::new(table).expect("fits")))));
    }

    /// Advances a bar together with another one that takes all steps by the law: all bits must be the same.
    fn assert_elastic_again(skipping: &mut Leapfrog, whole: &mut Leapfrog) {
        whole.blocks.iter_mut().for_each(|block| block.always_active = true);
        let (mut elastic, mut flows_again) = (0, 0);
        for step in 0..4000 {
            let known: Vec<bool> = skipping.blocks.iter().map(|block| block.elastic_up_to > 0.0).collect();
            skipping.advance();
            whole.advance();
            for ((a, b), known) in skipping.blocks.iter().zip(&whole.blocks).zip(known) {
                assert!(a.sigma == b.sigma && a.v == b.v, "cells {:?}, step {step}", a.cells);
                assert!(a.state == b.state && a.flow == b.flow, "states of cells {:?}, step {step}", a.cells);
                elastic += usize::from(known && !a.at_rest());
                flows_again += usize::from(known && a.flow.iter().any(|&flow| flow != 0.0));
            }
        }
        assert!(elastic > 1000 && flows_again > 0, "{elastic} steps taken as elastic, {flows_again} flows after them");
    }

    #[test]
    fn yielded_blocks_that_stay_elastic_step_as_their_law_does() {
        let table = |material: &Material| Table::new(material.branch(Sense::Tension), material.modulus);
        let of = |law: &dyn Fn(&Table) -> Arc<dyn RowLaw>| {
            let material = material(60);
            let law = law(&table(&material));
            assert_elastic_again(&mut bar(material.clone(), law.clone()), &mut bar(material, law));
        };
        of(&|table| Arc::new(Rows::new(Isotropic(Indexed::new(table).expect("fits")))));
        let mixed = |backbone: Indexed| Mixed { backbone, yield_stress: YIELD, kinematic: 0.4 };
        of(&|table| Arc::new(Rows::new(mixed(Indexed::new(table).expect("fits")))));
    }

    #[test]
    fn nodes_under_uneven_stress_do_not_rest() {
        let material = material(2);
        let table = Table::new(material.branch(Sense::Tension), material.modulus);
        let bar = bar(material, Arc::new(Rows::new(Isotropic(Searched(table)))));
        let law = law_of(&bar.laws[0], &bar.constants[0]);
        let at_work = |stressed: Range<usize>| {
            let mut block = bar.blocks[1].clone();
            block.wake();
            block.sigma[stressed].fill(1e6);
            block.narrow(law);
            block.active
        };
        assert!(at_work(0..0).is_empty());
        assert!(at_work(0..256).is_empty(), "level");
        assert_eq!(at_work(70..71), 64..128);
        // The nodes between two pieces are those of both.
        assert_eq!(at_work(64..128), 0..192);
    }

    /// One segment of a random bar: cells, initial velocity, kind of law.
    type RandomSegment = (usize, f64, bool);

    fn random_bar(segments: &[RandomSegment], ends: [usize; 2], along: [f64; 4]) -> Leapfrog {
        let material = Arc::new(material(5));
        let table = Table::new(material.branch(Sense::Tension), material.modulus);
        let law = |moves: bool| -> Arc<dyn RowLaw> {
            let backbone = Indexed::new(&table).expect("fits");
            if moves {
                Arc::new(Rows::new(Mixed { backbone, yield_stress: YIELD, kinematic: 0.7 }))
            } else {
                Arc::new(Rows::new(Isotropic(backbone)))
            }
        };
        let laws = segments.iter().map(|&(_, _, moves)| SegmentLaw {
            law: law(moves),
            yield_stress: YIELD,
            shocks: Shocks::NONE,
            stiffenings: Default::default(),
            end: DataEnd::of(&material),
        });
        let laws = laws.collect();
        let piece = |&(cells, velocity, _): &RandomSegment| {
            Segment::new(1e-3 * cells as f64, 1e-4, material.clone()).with_velocity(velocity)
        };
        let bar = Bar { segments: segments.iter().map(piece).collect(), area_given: true };
        let end = |kind: usize| match kind {
            0 => EndCondition::Free,
            1 => EndCondition::Fixed,
            2 => EndCondition::Velocity { history: History::constant(9.0), release: Some(2e-5) },
            3 => EndCondition::Striker { mass: 0.01, velocity: 12.0 },
            4 => EndCondition::Spring { stiffness: 1e8 },
            _ => EndCondition::Absorbing,
        };
        let [internal, external, foundation, lateral] = along;
        let lateral = vec![lateral; segments.len()];
        let along = DistributedForces { internal, external, foundation, lateral, ..DistributedForces::default() };
        let cells = segments.iter().map(|segment| segment.0).sum();
        Leapfrog::with_along(&bar, Grid::new(&bar, cells, 1.0), laws, ends.map(end), &along).in_cells()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Leaving cells out must change no bit, whatever acts on the bar and however it starts to move.
        #[test]
        fn active_cells_are_all_that_matters(
            segments in prop::collection::vec((1_usize..400, prop::sample::select(vec![0.0, 0.0, -20.0, 5.0]), any::<bool>()), 1..4),
            ends in [0_usize..6, 0..6],
            internal in prop::sample::select(vec![0.0, 0.0, 1e-6, 2e4]),
            external in prop::sample::select(vec![0.0, 0.0, 1e-6, 3e3]),
            foundation in prop::sample::select(vec![0.0, 0.0, 1e9]),
            lateral in prop::sample::select(vec![0.0, 0.0, 1e-6]),
        ) {
            prop_assume!(segments.iter().map(|segment| segment.0).sum::<usize>() > 2);
            let mut skipping = random_bar(&segments, ends, [internal, external, foundation, lateral]);
            let mut whole = random_bar(&segments, ends, [internal, external, foundation, lateral]);
            whole.blocks.iter_mut().for_each(|block| block.always_active = true);
            for step in 0..300 {
                skipping.advance();
                whole.advance();
                for (a, b) in skipping.blocks.iter().zip(&whole.blocks) {
                    prop_assert!(a.sigma[..] == b.sigma[..], "stresses of cells {:?}, step {step}", a.cells);
                    prop_assert!(a.v[..] == b.v[..], "velocities of cells {:?}, step {step}", a.cells);
                }
            }
        }
    }
}

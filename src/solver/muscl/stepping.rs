//! The bar and its step.

use rayon::prelude::*;

use super::block::{BLOCK, Block, Stage};
use super::end::End;
use super::face;
use super::joint::Joint;
use super::kernel::Scratch;
use super::part::Part;
use crate::bar::{Bar, EndCondition, Initial, SuddenLoads};
use crate::law::FirstPassed;
use crate::solver::EndState;
use crate::solver::fd::{Grid, SegmentLaw};
use crate::wave::riemann::{Medium, Workspace};

/// Bars with fewer cells than this are stepped on one thread: below it, waking a second thread costs more than it saves.
const PARALLEL_FROM: usize = 16_384;

/// Blocks that share room to work in, and that one thread steps in turn.
const GROUP: usize = 16;

/// A bar being stepped: everything lives at `time()`.
pub struct Muscl {
    pub(super) grid: Grid,
    pub(super) parts: Vec<Part>,
    pub(super) blocks: Vec<Block>,
    pub(super) ends: [End; 2],
    /// Just after t = 0.
    pub(super) start: [EndState; 2],
    pub(super) joints: Vec<Joint>,
    /// Exact states of suddenly loaded ends and joints.
    sudden: SuddenLoads,
    pub(super) step: usize,
    pub(super) passed: FirstPassed,
    parallel: bool,
    /// One for every group of blocks.
    scratch: Vec<Scratch>,
    work: Workspace,
    /// Room for the law state of a cell at an end or a joint.
    state: Vec<f64>,
}

impl Muscl {
    /// A bar at t = 0 in the state of its segments. `laws` and `media` have one entry a segment, and mean the
    /// same law, without the effect of rate; heat is that of an adiabatic curve. Tapers are taken by their means, a ball at an
    /// end as a free end: neither is simulated.
    pub fn new(bar: &Bar, grid: Grid, laws: Vec<SegmentLaw>, media: Vec<Medium>, ends: [EndCondition; 2]) -> Self {
        let dt = grid.dt;
        let segments = bar.segments.iter().zip(&grid.segments).zip(laws.into_iter().zip(media));
        let parts: Vec<Part> = segments.map(|((s, g), (law, medium))| Part::new(s, g, dt, law, medium)).collect();
        let blocks = blocks(bar, &grid, &parts);
        let joints = blocks.windows(2).enumerate().filter(|(_, pair)| pair[0].part != pair[1].part);
        let joints = joints.map(|(k, pair)| Joint::new(bar.segments[pair[0].part].joint, k)).collect();
        let last = bar.segments.len() - 1;
        let [left, right] = ends;
        let left = End::new(&left, 1.0, &parts[0], bar.segments[0].end_velocities()[0]);
        let right = End::new(&right, -1.0, &parts[last], bar.segments[last].end_velocities()[1]);
        let state_len = parts.iter().map(|part| part.law.law.state_len()).max().unwrap_or(0);
        let parallel = grid.cells() >= PARALLEL_FROM;
        let scratch = vec![Scratch::new(state_len); blocks.len().div_ceil(GROUP)];
        let (ends, work, state, passed) =
            ([left, right], Workspace::default(), vec![0.0; state_len], FirstPassed::default());
        let start = [EndState::default(); 2];
        let mut muscl = Self {
            grid,
            parts,
            blocks,
            ends,
            start,
            joints,
            sudden: SuddenLoads::default(),
            step: 0,
            passed,
            parallel,
            scratch,
            work,
            state,
        };
        muscl.start_ends();
        muscl
    }

    /// The same bar at t = 0, whose ends and joints are loaded like this.
    #[must_use]
    pub fn under_sudden_loads(mut self, loads: SuddenLoads) -> Self {
        for &(k, load, force) in &loads.joints {
            self.joints[k].load(load, force);
        }
        self.sudden = loads;
        self
    }

    /// Exact states of suddenly loaded ends and joints.
    pub fn sudden_loads(&self) -> &SuddenLoads {
        &self.sudden
    }

    fn start_ends(&mut self) {
        self.share();
        let last = self.blocks.len() - 1;
        for (side, k) in [(0, 0), (1, last)] {
            let part = &self.parts[self.blocks[k].part];
            let near = face::near(&self.blocks[k], part, side, &mut self.state, &mut self.work);
            self.start[side] = self.ends[side].start(self.grid.dt, part, &near, &mut self.work);
        }
    }

    /// One step. Allocates nothing, but for the plastic state of a block in the step in which it first yields.
    pub fn advance(&mut self) {
        self.share();
        self.update_ends();
        self.update_joints();
        self.step += 1;
        let parts = &self.parts;
        let advance = |(blocks, scratch): (&mut [Block], &mut Scratch)| {
            for block in blocks {
                block.advance(&parts[block.part], scratch);
            }
        };
        if self.parallel {
            self.blocks.par_chunks_mut(GROUP).zip(&mut self.scratch).for_each(advance);
        } else {
            self.blocks.chunks_mut(GROUP).zip(&mut self.scratch).for_each(advance);
        }
        self.note_limits();
    }

    /// Gives every block what lies beyond it.
    fn share(&mut self) {
        for k in 1..self.blocks.len() {
            let (before, after) = self.blocks.split_at_mut(k);
            let (left, right) = (&mut before[k - 1], &mut after[0]);
            if left.part == right.part {
                let part = &self.parts[left.part];
                left.copy_from(1, right, part);
                right.copy_from(0, left, part);
            }
        }
        let (time, dt) = (self.time(), self.grid.dt);
        let last = self.blocks.len() - 1;
        for (side, k) in [(0, 0), (1, last)] {
            let block = &mut self.blocks[k];
            let part = &self.parts[block.part];
            let beyond = self.ends[side].beyond(time, dt, block, part);
            block.fill_ghost_cells(side, part, beyond);
        }
        for joint in &self.joints {
            let (before, after) = self.blocks.split_at_mut(joint.edge + 1);
            joint.share(dt, &mut before[joint.edge], &mut after[0], &self.parts);
        }
    }

    fn update_ends(&mut self) {
        let (time, dt) = (self.time(), self.grid.dt);
        let last = self.blocks.len() - 1;
        for (side, k) in [(0, 0), (1, last)] {
            let part = &self.parts[self.blocks[k].part];
            let near = face::near(&self.blocks[k], part, side, &mut self.state, &mut self.work);
            self.blocks[k].outer[side] = Some(self.ends[side].step_flux(time, dt, part, &near, &mut self.work));
        }
    }

    fn update_joints(&mut self) {
        let dt = self.grid.dt;
        for joint in &mut self.joints {
            let (left, right) = (&self.blocks[joint.edge], &self.blocks[joint.edge + 1]);
            let parts = [&self.parts[left.part], &self.parts[right.part]];
            let near = [(left, parts[0], 1), (right, parts[1], 0)]
                .map(|(block, part, side)| face::near(block, part, side, &mut self.state, &mut self.work));
            let [from_left, from_right] = joint.step_flux(dt, parts, &near, &mut self.work);
            self.blocks[joint.edge].outer[1] = Some(from_left);
            self.blocks[joint.edge + 1].outer[0] = Some(from_right);
        }
    }

    /// Steps taken.
    pub fn step(&self) -> usize {
        self.step
    }

    /// s.
    pub fn time(&self) -> f64 {
        self.step as f64 * self.grid.dt
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// True while no cell has yielded: only the elastic kernel has run.
    pub fn stayed_elastic(&self) -> bool {
        self.blocks.iter().all(|b| b.stage != Stage::Plastic || b.state.iter().all(|&number| number == 0.0))
    }
}

/// Every segment in blocks of nearly equal size.
fn blocks(bar: &Bar, grid: &Grid, parts: &[Part]) -> Vec<Block> {
    let mut blocks = Vec::new();
    for (k, (of, segment)) in grid.segments.iter().zip(&bar.segments).enumerate() {
        let (cells, count) = (of.cells.len(), of.cells.len().div_ceil(BLOCK));
        for b in 0..count {
            let (start, end) = (of.cells.start + b * cells / count, of.cells.start + (b + 1) * cells / count);
            let mut block = Block::new(start..end, k, segment.velocity);
            if segment.profile.is_some() || segment.initial != Initial::default() {
                block.set_initial(segment, of, &parts[k]);
            }
            blocks.push(block);
        }
    }
    blocks
}

//! The bar and its time stepping.

use std::ops::Range;

use rayon::prelude::*;

use super::block::{BLOCK, Block, GHOSTS, Stage};
use super::end::End;
use super::face;
use super::joint::Joint;
use super::kernel::Scratch;
use super::part::Part;
use crate::bar::{Bar, EndCondition, Initial, InitialFan, SuddenLoads};
use crate::law::FirstPassed;
use crate::solver::fd::{Grid, SegmentLaw};
use crate::solver::{EndState, Resolution, StartingFan};
use crate::wave::riemann::{FaceState, Flux, Medium, Workspace};

/// Smallest number of cells for which steps run on several threads: with fewer cells, waking a second thread costs more than it saves.
const PARALLEL_FROM: usize = 16_384;

/// Number of cells over which plastic fronts of a fan are spread at the start, unless the slowest is a shock, which stays sharp. In a foam at half
/// the Courant number, a spread shock leaves 0.7 % too much strain in the first cells and a force up to 10 % too large behind it; a sharp one 0.5 and
/// 6 %.
const RAMP: f64 = 7.0;

/// Number of blocks that share a scratch and are stepped by one thread in turn.
const GROUP: usize = 16;

/// A bar advanced in time: all quantities hold at `time()`.
pub struct Muscl {
    pub(super) grid: Grid,
    pub(super) parts: Vec<Part>,
    pub(super) blocks: Vec<Block>,
    pub(super) ends: [End; 2],
    /// States of the ends just after t = 0.
    pub(super) start: [EndState; 2],
    pub(super) joints: Vec<Joint>,
    /// Exact states of suddenly loaded ends and joints.
    sudden: SuddenLoads,
    /// Fans with which suddenly loaded ends and joints start.
    pub(super) fans: Vec<StartingFan>,
    pub(super) step: usize,
    pub(super) passed: FirstPassed,
    parallel: bool,
    /// Scratch, one for every group of blocks.
    scratch: Vec<Scratch>,
    work: Workspace,
    /// Scratch for the state variables of a cell at an end or joint.
    state: Vec<f64>,
}

impl Muscl {
    /// Creates a bar at t = 0 in the state of its segments. `laws` and `media` have one entry per segment, and both represent the same law, without
    /// rate effect; heat is that of an adiabatic curve. Tapers are replaced by their means and a ball at an end by a free end: the method does not
    /// simulate them.
    pub fn new(bar: &Bar, grid: Grid, laws: Vec<SegmentLaw>, media: Vec<Medium>, ends: [EndCondition; 2]) -> Self {
        let dt = grid.dt;
        let segments = bar.segments.iter().zip(&grid.segments).zip(laws.into_iter().zip(media));
        let parts: Vec<Part> = segments.map(|((s, g), (law, medium))| Part::new(s, g, dt, law, medium)).collect();
        let blocks = blocks(bar, &grid, &parts);
        let joints = blocks.windows(2).enumerate().filter(|(_, pair)| pair[0].part != pair[1].part);
        let joints = joints.map(|(k, pair)| Joint::new(bar.segments[pair[0].part].joint, k)).collect();
        let last = bar.segments.len() - 1;
        let [left, right] = ends;
        let [at_left, at_right] = bar.end_velocities();
        let left = End::new(&left, 1.0, &parts[0], at_left);
        let right = End::new(&right, -1.0, &parts[last], at_right);
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
            fans: Vec::new(),
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

    /// Adds the sudden loads of ends and joints to a bar at t = 0.
    #[must_use]
    pub fn under_sudden_loads(mut self, loads: SuddenLoads) -> Self {
        for &(k, load, force) in &loads.joints {
            self.joints[k].load(load, force);
        }
        self.sudden = loads;
        self
    }

    /// Makes the ends and joints of a bar at t = 0 start with these fans. The laws must follow the curves of the fans.
    #[must_use]
    pub fn starting_with(mut self, initial_fans: &[InitialFan]) -> Self {
        let starting = |fan: &InitialFan| {
            let (part, cells, dt) =
                (&self.parts[fan.segment], self.grid.segments[fan.segment].cells.len(), self.grid.dt);
            let grid = Resolution { dx: part.dx, cells, dt, wave_speed: (part.modulus / part.density).sqrt() };
            StartingFan::new(fan, part.density, &grid, if fan.shock { 0.0 } else { RAMP })
        };
        let mut fans: Vec<StartingFan> = initial_fans.iter().filter_map(starting).collect();
        StartingFan::keep_whole_joints(&mut fans, self.parts.len());
        self.fans = fans;
        self
    }

    /// Returns the exact states of suddenly loaded ends and joints.
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

    /// Advances the bar by one step. Allocates only the plastic state of a block in the step in which it first yields.
    pub fn advance(&mut self) {
        self.share();
        self.update_ends();
        self.update_joints();
        self.fill_fans();
        self.step += 1;
        let parts = &self.parts;
        let advance = |(blocks, scratch): (&mut [Block], &mut Scratch)| {
            for block in blocks {
                block.advance(&parts[block.part], scratch);
                block.inside_fan.clear();
            }
        };
        if self.parallel {
            self.blocks.par_chunks_mut(GROUP).zip(&mut self.scratch).for_each(advance);
        } else {
            self.blocks.chunks_mut(GROUP).zip(&mut self.scratch).for_each(advance);
        }
        self.note_limits();
    }

    /// Fills the ghost cells of every block.
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
            let beyond = self.ends[side].beyond(time, dt, block, part, &mut self.work);
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
            let step = self.step;
            let here = |fan: &&mut StartingFan| !fan.at_joint && fan.side == side && fan.is_imposed_at(step);
            let fan = self.fans.iter_mut().find(here);
            let known = |fan: &&mut StartingFan| {
                let grows = || fan.grows_at(time - fan.from).then(|| fan.means(0.0, time - fan.from, dt));
                fan.starts_within(step, dt).or_else(grows)
            };
            let flux = if let Some([velocity, stress]) = fan.as_ref().and_then(known) {
                self.ends[side].step_with(time, dt, Flux { stress, velocity })
            } else if let Some(fan) = fan {
                let flux = self.ends[side].step_behind(time, dt, fan);
                fan.record_velocity(self.step, time - fan.from + 0.5 * dt, flux.velocity);
                flux
            } else {
                let near = face::near(&self.blocks[k], part, side, &mut self.state, &mut self.work);
                self.ends[side].step_flux(time, dt, part, &near, &mut self.work)
            };
            self.blocks[k].outer[side] = Some(flux);
        }
    }

    fn update_joints(&mut self) {
        let dt = self.grid.dt;
        for (k, joint) in self.joints.iter_mut().enumerate() {
            let (left, right) = (&self.blocks[joint.edge], &self.blocks[joint.edge + 1]);
            let parts = [&self.parts[left.part], &self.parts[right.part]];
            let near = [(left, parts[0], 1), (right, parts[1], 0)]
                .map(|(block, part, side)| face::near(block, part, side, &mut self.state, &mut self.work));
            let fans = fans_of_joint(&mut self.fans, k, self.step);
            let known = fans.map(|fans| behind_fans(fans, self.step, dt, (parts, &near), joint.is_apart()));
            let [from_left, from_right] = joint.step_flux(dt, parts, &near, known, &mut self.work);
            self.blocks[joint.edge].outer[1] = Some(from_left);
            self.blocks[joint.edge + 1].outer[0] = Some(from_right);
        }
    }

    /// Sets the fluxes through the faces inside fans.
    fn fill_fans(&mut self) {
        let dt = self.grid.dt;
        for fan in self.fans.iter().filter(|fan| fan.is_imposed_at(self.step) && fan.is_imposed_inside()) {
            let (part, time) = (&self.grid.segments[fan.segment], self.step as f64 * dt - fan.from);
            let origin = if fan.side == 0 { part.cells.start } else { part.cells.end };
            let faces = ((fan.reach(time + dt) / part.dx).ceil() as usize).min(fan.nodes).min(part.cells.len() - 1);
            for block in self.blocks.iter_mut().filter(|block| block.part == fan.segment) {
                let Range { start, end } = block.cells;
                let inside = if fan.side == 0 {
                    start.max(origin + 1)..(end + 1).min(origin + faces + 1)
                } else {
                    start.max(origin - faces)..(end + 1).min(origin)
                };
                for face in inside {
                    let distance = part.dx * face.abs_diff(origin) as f64;
                    let [velocity, stress] = fan.means(distance, time, dt);
                    block.inside_fan.push((GHOSTS + face - start, Flux { stress, velocity }));
                }
            }
        }
    }

    /// Number of steps taken.
    pub fn step(&self) -> usize {
        self.step
    }

    /// Present time, s.
    pub fn time(&self) -> f64 {
        self.step as f64 * self.grid.dt
    }

    /// Returns the grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns whether no cell has yielded so far, so that only the elastic kernel has run.
    pub fn stayed_elastic(&self) -> bool {
        self.blocks.iter().all(|b| b.stage != Stage::Plastic || b.state.iter().all(|&number| number == 0.0))
    }
}

/// Divides every segment into blocks of nearly equal size.
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

/// Returns the two fans of the joint to the right of a segment that are imposed in this step, left side first.
fn fans_of_joint(fans: &mut [StartingFan], segment: usize, step: usize) -> Option<[&mut StartingFan; 2]> {
    let sides = [(segment, 1), (segment + 1, 0)];
    let here =
        |fan: &&mut StartingFan| fan.at_joint && fan.is_imposed_at(step) && sides.contains(&(fan.segment, fan.side));
    let mut found = fans.iter_mut().filter(here);
    Some([found.next()?, found.next()?])
}

/// Returns the fluxes through a joint behind its fans; its sides may be `apart` before this step.
fn behind_fans(
    fans: [&mut StartingFan; 2],
    step: usize,
    dt: f64,
    (parts, near): ([&Part; 2], &[FaceState; 2]),
    apart: bool,
) -> [Flux; 2] {
    let [left, right] = fans;
    let time = step as f64 * dt - left.from;
    if left.follows_wave() && !left.begins_at(step) {
        let states = near.each_ref().map(|near| [near.point.stress, near.point.velocity]);
        StartingFan::follow_wave([&mut *left, &mut *right], step, [time, dt], states, parts.map(|part| part.area));
    }
    let fans = [&*left, &*right];
    let mut fluxes = fans.map(|fan| {
        // On the grid the faces may already have met within the previous step.
        let starts = fan.starts_within(step, dt).filter(|_| apart);
        let [velocity, stress] = starts.unwrap_or_else(|| fan.means(0.0, time.max(0.0), dt));
        Flux { stress, velocity }
    });
    // The fan of the side through which the wave arrives does not determine the stress there; both sides carry the same force.
    if let Some(side) = fans.iter().position(|fan| fan.follows_wave() && fan.stays_elastic()) {
        fluxes[side].stress = fluxes[1 - side].stress * parts[1 - side].area / parts[side].area;
    }
    fluxes
}

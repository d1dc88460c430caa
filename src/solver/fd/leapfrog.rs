//! The leapfrog scheme: velocities at nodes and half steps, stresses in cells and whole steps. At Courant number 1
//! elastic waves are exact.

use std::sync::Arc;

use rayon::prelude::*;

use super::block::{BLOCK, Block, BlockLaw, Scratch, Stage};
use super::contact::{Contact, ContactState};
use super::device::{Device, EndGrid};
use super::grid::Grid;
use super::implicit::{Along, Implicit};
use super::ripple;
use super::rupture::Breaking;
use super::taper::BlockTaper;
use crate::bar::{Bar, EndCondition};
use crate::law::RowLaw;

/// Bars with fewer cells than this are stepped on one thread: below it, waking a second thread costs more than it saves.
const PARALLEL_FROM: usize = 65_536;

/// The law of one segment, as assembled from its material and the effects.
#[derive(Clone)]
pub struct SegmentLaw {
    /// Stepping law.
    pub law: Arc<dyn RowLaw>,
    /// Stress below which the law is elastic in both senses, Pa.
    pub yield_stress: f64,
    /// Reach (E times equivalent strain, Pa) at which the data end, in tension and in compression; infinite where they
    /// do not.
    pub end: [f64; 2],
}

/// The node between two blocks: inside a segment, or at a bonded joint. In the place of a joint that can open it is an
/// empty one, without mass and unmoved, beside a [`Contact`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub before: f64,
    pub after: f64,
    /// dt A/m of the cells on both sides, m/s per Pa.
    pub gain_left: f64,
    pub gain_right: f64,
    /// Node mass, kg.
    pub mass: f64,
}

/// Constants of a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Constants {
    pub modulus: f64,
    pub stress_gain: f64,
    pub velocity_gain: f64,
    /// rho A dx, kg; of a tapered segment with its mean area.
    pub cell_mass: f64,
    /// A dx, m^3; likewise.
    pub cell_volume: f64,
    /// A, m^2; likewise.
    pub area: f64,
    /// Cells that an elastic wave passes in a step.
    pub courant: f64,
    /// Product of neighbouring velocity differences that is rounding, (m/s)^2.
    pub rounding: f64,
}

/// A bar being stepped. Between steps: stresses at `time()`, velocities half a step later.
pub struct Leapfrog {
    pub(super) grid: Grid,
    pub(super) laws: Vec<SegmentLaw>,
    pub(super) constants: Vec<Constants>,
    pub(super) blocks: Vec<Block>,
    pub(super) edges: Vec<Edge>,
    pub(super) contacts: Vec<Contact>,
    pub(super) left: Device,
    pub(super) right: Device,
    pub(super) step: usize,
    pub(super) parallel: bool,
    /// Some cell has yielded.
    pub(super) yielded: bool,
    /// Energy that the ripple damping took from the nodes between blocks, J.
    pub(super) damped_at_edges: f64,
    /// Where and when the bar breaks; none where it never does.
    pub(super) rupture: Option<Box<Breaking>>,
    /// The nodes, where something acts along the bar.
    pub(super) implicit: Option<Box<Implicit>>,
}

impl Leapfrog {
    /// A bar at t = 0, unstressed, moving as its segments say. `laws` has one entry a segment.
    pub fn new(bar: &Bar, grid: Grid, laws: Vec<SegmentLaw>, ends: [EndCondition; 2]) -> Self {
        let mut bar = Self::before_start(bar, grid, laws, ends);
        bar.share_edges();
        bar.advance_edges();
        bar
    }

    /// The same with what acts along the bar; without joints that can open. A bar along which nothing acts is the plain one.
    pub fn with_along(bar: &Bar, grid: Grid, laws: Vec<SegmentLaw>, ends: [EndCondition; 2], along: &Along) -> Self {
        if along.is_nothing() {
            return Self::new(bar, grid, laws, ends);
        }
        let mut bar = Self::before_start(bar, grid, laws, ends);
        debug_assert!(bar.contacts.is_empty());
        bar.share_edges();
        let mut velocities = vec![0.0; bar.grid.cells() + 1];
        for block in &bar.blocks {
            velocities[block.cells.start..=block.cells.end].copy_from_slice(&block.v);
        }
        let mut nodes = Implicit::new(along, &bar.grid, &bar.constants, velocities);
        nodes.start(along, &bar.grid, &bar.constants, &bar.blocks, [&mut bar.left, &mut bar.right]);
        bar.implicit = Some(Box::new(nodes));
        bar.share_nodes();
        bar
    }

    fn before_start(bar: &Bar, grid: Grid, laws: Vec<SegmentLaw>, ends: [EndCondition; 2]) -> Self {
        let constants = constants(bar, &grid);
        let blocks = blocks(bar, &grid);
        let mut edges = edges(&blocks, &constants);
        let contacts = contacts(bar, &blocks, &constants, &mut edges);
        let end_grid = |k: usize, side: usize| {
            let (segment, part) = (&bar.segments[k], &grid.segments[k]);
            let block = if side == 0 { &blocks[0] } else { &blocks[blocks.len() - 1] };
            let cell = if side == 0 { 0 } else { block.sigma.len() - 1 };
            EndGrid {
                dt: grid.dt,
                dx: part.dx,
                density: segment.material.density,
                impedance: segment.material.impedance(),
                area: segment.end_areas()[side],
                cell_area: segment.area * block.area(cell),
                velocity: segment.velocity,
            }
        };
        let [left, right] = ends;
        let left = Device::new(left, -1.0, end_grid(0, 0));
        let right = Device::new(right, 1.0, end_grid(bar.segments.len() - 1, 1));
        let parallel = grid.cells() >= PARALLEL_FROM;
        Self {
            grid,
            laws,
            constants,
            blocks,
            edges,
            contacts,
            left,
            right,
            step: 0,
            parallel,
            yielded: false,
            damped_at_edges: 0.0,
            rupture: None,
            implicit: None,
        }
    }

    /// One step: stresses from velocities, then velocities from stresses. Allocates nothing, but for the plastic
    /// state of a block in the step in which it first yields.
    pub fn advance(&mut self) {
        self.step += 1;
        let (laws, constants) = (&self.laws, &self.constants);
        let advance_block = if self.implicit.is_some() { Block::advance_stresses } else { Block::advance };
        let advance = |block: &mut Block, scratch: &mut Scratch| {
            let (law, constants) = (&laws[block.segment], &constants[block.segment]);
            let law = BlockLaw {
                law: law.law.as_ref(),
                stress_gain: constants.stress_gain,
                velocity_gain: constants.velocity_gain,
                yield_stress: law.yield_stress,
            };
            advance_block(block, law, scratch);
        };
        for_each(&mut self.blocks, self.parallel, advance);
        if self.implicit.is_some() {
            self.advance_nodes();
        } else {
            self.advance_edges();
        }
        if self.rupture.is_some() {
            self.break_where_due();
        }
        if self.yielded || self.note_yield() {
            self.damp_ripples();
        }
    }

    /// True from the step in which the first cell of the bar yields.
    fn note_yield(&mut self) -> bool {
        self.yielded = !self.stayed_elastic();
        self.yielded
    }

    /// Takes grid-scale ripples out of the velocities, see [`super::ripple`].
    fn damp_ripples(&mut self) {
        for k in 0..self.blocks.len() {
            self.blocks[k].outside = [self.node_outside(k, k.wrapping_sub(1)), self.node_outside(k, k + 1)];
        }
        let constants = &self.constants;
        let damp = |block: &mut Block, scratch: &mut Scratch| {
            let c = &constants[block.segment];
            block.damp_ripples(c.velocity_gain, c.rounding, scratch);
        };
        for_each(&mut self.blocks, self.parallel, damp);
        for (k, edge) in self.edges.iter_mut().enumerate() {
            let (left, right) = (&self.blocks[k], &self.blocks[k + 1]);
            let change = edge.handed(left.handed_at_edges[1], right.handed_at_edges[0]);
            let g = edge.kick(last(&left.sigma), right.sigma[0]);
            self.damped_at_edges += 0.5 * edge.mass * ripple::node(g, change, &mut edge.after);
            // So that after - before stays what the stresses gave the node, as for the nodes inside a block.
            edge.before += change;
        }
        self.damp_ends();
        self.share_edges();
        if let Some(nodes) = &mut self.implicit {
            nodes.take_ripples(&self.blocks);
        }
    }

    /// The end nodes' part of the damping: half the mass, so twice the velocity change.
    fn damp_ends(&mut self) {
        let (first, last_block) = (&self.blocks[0], &self.blocks[self.blocks.len() - 1]);
        let (left, right) = (2.0 * first.handed_at_edges[0], -2.0 * last_block.handed_at_edges[1]);
        if left != 0.0 && !self.left.is_held() {
            self.damped_at_edges += self.left.damp(left, first.sigma[0]);
        }
        if right != 0.0 && !self.right.is_held() {
            self.damped_at_edges += self.right.damp(right, last(&last_block.sigma));
        }
    }

    /// Velocity of the node next to block `k` inside block `neighbour`, where both are of one segment. At an end that
    /// is not held the bar goes on as in a mirror.
    fn node_outside(&self, k: usize, neighbour: usize) -> Option<f64> {
        let block = &self.blocks[k];
        let Some(other) = self.blocks.get(neighbour) else {
            // A short bar has one block, which has both ends.
            let at_right = neighbour == k + 1;
            let (end, mirrored) =
                if at_right { (&self.right, block.v[block.v.len() - 2]) } else { (&self.left, block.v[1]) };
            return (!end.is_held()).then_some(mirrored);
        };
        let inner = if neighbour < k { other.v[other.v.len() - 2] } else { other.v[1] };
        let parted = || self.contacts.iter().any(|contact| contact.edge == k.min(neighbour));
        (other.segment == block.segment && !parted()).then_some(inner)
    }

    /// The nodes between blocks and at the ends, from the stresses on both sides.
    fn advance_edges(&mut self) {
        let time = self.time();
        for (k, edge) in self.edges.iter_mut().enumerate() {
            let sigma_left = last(&self.blocks[k].sigma);
            let sigma_right = self.blocks[k + 1].sigma[0];
            edge.before = edge.after;
            edge.after += edge.kick(sigma_left, sigma_right);
        }
        for contact in &mut self.contacts {
            let sigma = [last(&self.blocks[contact.edge].sigma), self.blocks[contact.edge + 1].sigma[0]];
            contact.advance(sigma, self.grid.dt);
        }
        self.left.advance(time, self.blocks[0].sigma[0]);
        self.right.advance(time, last(&self.blocks[self.blocks.len() - 1].sigma));
        self.share_edges();
    }

    /// All nodes at once, where something acts along the bar.
    fn advance_nodes(&mut self) {
        let time = self.time();
        if let Some(nodes) = &mut self.implicit {
            nodes.advance(time, &self.blocks, [&mut self.left, &mut self.right]);
        }
        self.share_nodes();
    }

    /// Gives blocks and the nodes between them their velocities.
    fn share_nodes(&mut self) {
        let Some(nodes) = &self.implicit else { return };
        for block in &mut self.blocks {
            nodes.share(block);
        }
        for (edge, block) in self.edges.iter_mut().zip(&self.blocks) {
            [edge.before, edge.after] = nodes.velocities(block.cells.end);
        }
    }

    /// Gives both neighbours of every edge its velocity.
    pub(super) fn share_edges(&mut self) {
        for (k, edge) in self.edges.iter().enumerate() {
            set_last(&mut self.blocks[k].v, edge.after);
            self.blocks[k + 1].v[0] = edge.after;
        }
        for contact in &self.contacts {
            set_last(&mut self.blocks[contact.edge].v, contact.left.after);
            self.blocks[contact.edge + 1].v[0] = contact.right.after;
        }
        let right_end = self.blocks.len() - 1;
        self.blocks[0].v[0] = self.left.velocity_after();
        set_last(&mut self.blocks[right_end].v, self.right.velocity_after());
    }

    /// Steps taken.
    pub fn step(&self) -> usize {
        self.step
    }

    /// Time of the stresses, s.
    pub fn time(&self) -> f64 {
        self.step as f64 * self.grid.dt
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The left end.
    pub fn left(&self) -> &Device {
        &self.left
    }

    /// The right end.
    pub fn right(&self) -> &Device {
        &self.right
    }

    /// The joints that can open, from left to right.
    pub fn contacts(&self) -> impl Iterator<Item = ContactState> {
        self.contacts.iter().map(|contact| contact.state(self.grid.dt))
    }

    /// True while no cell has yielded: only the elastic kernel has run.
    pub fn stayed_elastic(&self) -> bool {
        self.blocks.iter().all(|b| b.stage != Stage::Plastic)
    }
}

impl Edge {
    /// The node in whose place there is a contact.
    pub const EMPTY: Self = Self { before: 0.0, after: 0.0, gain_left: 0.0, gain_right: 0.0, mass: 0.0 };

    /// Velocity change from what the ripple damping hands over in the cells on both sides, each an impulse of its own mass.
    fn handed(&self, left: f64, right: f64) -> f64 {
        if self.gain_left == self.gain_right {
            return right - left;
        }
        2.0 * (self.gain_right * right - self.gain_left * left) / (self.gain_left + self.gain_right)
    }

    /// Velocity change in a step, m/s, from the stresses on both sides. Inside a segment it has the bits that a node
    /// inside a block would have, so that results do not depend on where blocks meet.
    pub fn kick(&self, sigma_left: f64, sigma_right: f64) -> f64 {
        if self.gain_left == self.gain_right {
            self.gain_left * (sigma_right - sigma_left)
        } else {
            self.gain_right * sigma_right - self.gain_left * sigma_left
        }
    }
}

fn for_each(blocks: &mut [Block], parallel: bool, act: impl Fn(&mut Block, &mut Scratch) + Send + Sync) {
    let scratch = || [0.0; BLOCK];
    if parallel {
        blocks.par_iter_mut().with_min_len(16).for_each_init(scratch, |scratch, block| act(block, scratch));
    } else {
        let mut scratch = scratch();
        for block in blocks {
            act(block, &mut scratch);
        }
    }
}

pub(super) fn last(values: &[f64]) -> f64 {
    values[values.len() - 1]
}

fn set_last(values: &mut [f64], value: f64) {
    let end = values.len() - 1;
    values[end] = value;
}

fn constants(bar: &Bar, grid: &Grid) -> Vec<Constants> {
    let of = |(segment, part): (&crate::bar::Segment, &super::SegmentGrid)| Constants {
        modulus: segment.material.modulus,
        stress_gain: segment.material.modulus * grid.dt / part.dx,
        velocity_gain: grid.dt / (segment.material.density * part.dx),
        cell_mass: segment.material.density * segment.area * part.dx,
        cell_volume: segment.area * part.dx,
        area: segment.area,
        courant: segment.material.c0() * grid.dt / part.dx,
        rounding: (ripple::ROUNDING * segment.material.c0()).powi(2),
    };
    bar.segments.iter().zip(&grid.segments).map(of).collect()
}

fn blocks(bar: &Bar, grid: &Grid) -> Vec<Block> {
    let mut blocks = Vec::new();
    for (k, part) in grid.segments.iter().enumerate() {
        for start in part.cells.clone().step_by(BLOCK) {
            let end = (start + BLOCK).min(part.cells.end);
            let mut block = Block::new(start..end, k, bar.segments[k].velocity);
            block.taper = BlockTaper::of(&bar.segments[k], part, &block.cells);
            blocks.push(block);
        }
    }
    blocks
}

/// Areas of the cells on both sides of the node between two blocks, over the mean of their segments.
fn relative_areas(pair: &[Block]) -> [f64; 2] {
    [pair[0].area(pair[0].sigma.len() - 1), pair[1].area(0)]
}

/// Masses of these cells, kg.
pub(super) fn cell_masses(pair: &[Block], constants: &[Constants]) -> [f64; 2] {
    let areas = relative_areas(pair);
    [0, 1].map(|k| constants[pair[k].segment].cell_mass * areas[k])
}

/// Sections of these cells, m^2.
pub(super) fn cell_areas(pair: &[Block], constants: &[Constants]) -> [f64; 2] {
    let areas = relative_areas(pair);
    [0, 1].map(|k| constants[pair[k].segment].area * areas[k])
}

/// The nodes between blocks. At a joint of segments that move differently the node starts with their common momentum.
fn edges(blocks: &[Block], constants: &[Constants]) -> Vec<Edge> {
    let edge = |pair: &[Block]| {
        let (left, right) = (&constants[pair[0].segment], &constants[pair[1].segment]);
        let [left_mass, right_mass] = cell_masses(pair, constants);
        let velocity = if pair[0].v[0] == pair[1].v[0] {
            pair[0].v[0]
        } else {
            (left_mass * pair[0].v[0] + right_mass * pair[1].v[0]) / (left_mass + right_mass)
        };
        let mass = 0.5 * (left_mass + right_mass);
        let (gain_left, gain_right) = if pair[0].segment == pair[1].segment && pair[0].taper.is_none() {
            (left.velocity_gain, left.velocity_gain)
        } else {
            // dt A/m, written with the segment's own gain dt/(rho dx) = dt A/(cell mass).
            (left.velocity_gain * left_mass / mass, right.velocity_gain * right_mass / mass)
        };
        Edge { before: velocity, after: velocity, gain_left, gain_right, mass }
    };
    blocks.windows(2).map(edge).collect()
}

/// The joints that can open; their edges become empty.
fn contacts(bar: &Bar, blocks: &[Block], constants: &[Constants], edges: &mut [Edge]) -> Vec<Contact> {
    let mut contacts = Vec::new();
    for (k, pair) in blocks.windows(2).enumerate() {
        let (left, right) = (pair[0].segment, pair[1].segment);
        if left == right {
            continue;
        }
        let masses = cell_masses(pair, constants).map(|mass| 0.5 * mass);
        let areas = cell_areas(pair, constants);
        if let Some(contact) = Contact::new(bar, [left, k, pair[1].cells.start], masses, areas) {
            edges[k] = Edge::EMPTY;
            contacts.push(contact);
        }
    }
    contacts
}

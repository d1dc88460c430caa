//! The leapfrog scheme: velocities at nodes and half steps, stresses in cells and whole steps. At Courant number 1
//! elastic waves are exact.

use super::block::{Block, Scratch, Stage, WATCHED};
use super::breaking::Breaking;
use super::contact::{Contact, ContactState};
use super::edge::{Edge, contacts, edges};
use super::end_node::{EndGrid, EndNode};
use super::grid::Grid;
use super::grid_filter::Shocks;
use super::implicit::{DistributedForces, Implicit};
use super::segment::{Constants, SegmentLaw};
use super::sizes::block_sizes;
use super::subdomain::{Common, Subdomain};
use super::sweep::division;
use super::taper::BlockTaper;
use crate::bar::{Bar, EndCondition, SuddenLoads};
use crate::solver::{EndSample, Energies, StartingFan};

/// Log of a bar, step by step.
pub struct Log<'a> {
    /// The watched cells.
    pub cells: Vec<LoggedCell<'a>>,
    /// The left and the right end.
    pub ends: [&'a [EndSample]; 2],
}

/// Log of a cell.
#[derive(Clone, Copy)]
pub struct LoggedCell<'a> {
    /// Rows from the cell's first one on; rows of one step follow each other.
    rows: &'a [[f64; WATCHED.len()]],
    cells: usize,
}

impl LoggedCell<'_> {
    /// Returns stress (Pa), strain, velocity (m/s) and temperature (K) after the logged step number `steps`, counted from 0.
    #[inline]
    pub fn after(&self, steps: usize) -> &[f64; WATCHED.len()] {
        &self.rows[steps * self.cells]
    }
}

/// Bar on the staggered grid. Between steps it has the stresses at `time()` and the velocities half a step later.
pub struct Leapfrog {
    pub(super) grid: Grid,
    pub(super) laws: Vec<SegmentLaw>,
    pub(super) constants: Vec<Constants>,
    pub(super) blocks: Vec<Block>,
    pub(super) edges: Vec<Edge>,
    pub(super) contacts: Vec<Contact>,
    pub(super) left: EndNode,
    pub(super) right: EndNode,
    pub(super) step: usize,
    /// Number of threads on which the bar may be stepped.
    threads: usize,
    /// Whether elastic blocks may be carried as waves; otherwise every cell is stepped.
    travels: bool,
    /// Blocks of which something is logged in every step, if anything is.
    watched: Option<Vec<usize>>,
    /// Fracture criteria and fractures; `None` for a bar that never fractures.
    pub(super) rupture: Option<Box<Breaking>>,
    /// The nodes, if distributed forces act along the bar.
    pub(super) implicit: Option<Box<Implicit>>,
    /// Fans with which suddenly loaded ends and joints start.
    pub(super) fans: Vec<StartingFan>,
    /// Energy that ends gave for these fans, or the bar had, and that the nodes did not receive, J; without the share of shocks.
    pub(super) lost_to_fans: f64,
    /// Exact states of suddenly loaded ends and joints.
    pub(super) sudden: SuddenLoads,
    /// Energies at t = 0 of a bar with an initial state.
    pub(super) initial_energy: Option<Energies>,
}

impl Leapfrog {
    /// Creates a bar at t = 0 with the initial velocities of its segments and, if there are any, their initial stresses. `laws` has one
    /// entry per segment.
    pub fn new(bar: &Bar, grid: Grid, laws: Vec<SegmentLaw>, ends: [EndCondition; 2]) -> Self {
        let mut leapfrog = Self::before_start(bar, grid, laws, ends);
        let stressed = bar.has_initial_state();
        if stressed {
            leapfrog.set_initial(bar);
            leapfrog.apply_half_initial_stress();
        }
        leapfrog.share_edges();
        leapfrog.whole().update_all_interfaces();
        if stressed {
            leapfrog.restore_initial_stress(bar);
        }
        leapfrog
    }

    /// As [`Self::new`], with distributed forces along the bar and without joints that can open. If no force acts, it is the plain bar.
    /// There is no artificial viscosity, as the ends account only for the impulses of the nodes.
    pub fn with_along(
        bar: &Bar,
        grid: Grid,
        mut laws: Vec<SegmentLaw>,
        ends: [EndCondition; 2],
        along: &DistributedForces,
    ) -> Self {
        if along.is_nothing() {
            return Self::new(bar, grid, laws, ends);
        }
        for law in &mut laws {
            law.shocks = Shocks::NONE;
        }
        let mut leapfrog = Self::before_start(bar, grid, laws, ends);
        debug_assert!(leapfrog.contacts.is_empty());
        let segments = leapfrog.constants.iter_mut().zip(&along.lateral).zip(&leapfrog.grid.segments);
        segments.for_each(|((constants, &lateral), part)| *constants = constants.with_lateral(lateral, part.dx));
        leapfrog.share_edges();
        let mut velocities = vec![0.0; leapfrog.grid.cells() + 1];
        for block in &leapfrog.blocks {
            velocities[block.cells.start..=block.cells.end].copy_from_slice(&block.v);
        }
        let stressed = bar.has_initial_state();
        if stressed {
            leapfrog.set_initial(bar);
        }
        let mut nodes = Implicit::new(along, &leapfrog.grid, &leapfrog.constants, velocities);
        let Self { grid, constants, blocks, left, right, .. } = &mut leapfrog;
        if stressed {
            nodes.start_under(along, grid, constants, blocks, [left, right]);
        } else {
            nodes.start(along, grid, constants, blocks, [left, right]);
        }
        leapfrog.implicit = Some(Box::new(nodes));
        leapfrog.share_nodes();
        if stressed {
            leapfrog.initial_energy = Some(leapfrog.energies());
        }
        leapfrog
    }

    fn before_start(bar: &Bar, grid: Grid, laws: Vec<SegmentLaw>, ends: [EndCondition; 2]) -> Self {
        let segments = bar.segments.iter().zip(&grid.segments).zip(&laws);
        let constants: Vec<_> =
            segments.map(|((segment, part), law)| Constants::new(segment, part, grid.dt, law.shocks)).collect();
        let blocks = blocks(bar, &grid);
        let mut edges = edges(&blocks, &constants);
        let contacts = contacts(bar, grid.dt, &blocks, &constants, &laws, &mut edges);
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
                velocity: block.v[if side == 0 { 0 } else { cell + 1 }],
                end_velocity: segment.end_velocities()[side],
                yield_stress: laws[k].yield_stress,
            }
        };
        let [left, right] = ends;
        let left = EndNode::new(&left, -1.0, end_grid(0, 0));
        let right = EndNode::new(&right, 1.0, end_grid(bar.segments.len() - 1, 1));
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
            threads: rayon::current_num_threads(),
            travels: true,
            watched: None,
            rupture: None,
            implicit: None,
            fans: Vec::new(),
            lost_to_fans: 0.0,
            sudden: SuddenLoads::default(),
            initial_energy: None,
        }
    }

    /// Returns the bar with every cell stepped and none of it carried as waves. This is slower, and differs by rounding only.
    #[must_use]
    pub fn in_cells(self) -> Self {
        Self { travels: false, ..self }
    }

    /// Returns the number of parts that are swept in parallel, and the number of steps in one sweep.
    fn division(&self) -> (usize, usize) {
        let at_work = if self.threads == 1 { 0 } else { self.blocks.iter().filter(|block| !block.at_rest()).count() };
        division(at_work, self.threads)
    }

    /// Advances by one step: stresses from velocities, then velocities from stresses. Allocates no memory, except for the plastic state of
    /// a block in the step in which it first yields, and for the waves of a block that starts to be carried as waves.
    pub fn advance(&mut self) {
        self.advance_by(1);
    }

    /// Advances by `steps` steps. The bits are those of single steps; many at once are faster, see `sweep.rs`.
    pub fn advance_by(&mut self, steps: usize) {
        if !self.sweeps() {
            return (0..steps).for_each(|_| self.advance_together());
        }
        let end = self.step + steps;
        while self.step < end {
            let next = self.step + 1;
            let imposed = StartingFan::next_step(&self.fans, next);
            if imposed == Some(next) {
                self.advance_together();
                continue;
            }
            let undisturbed = imposed.map_or(end, |imposed| end.min(imposed - 1));
            let (parts, depth) = self.division();
            let now = depth.min(undisturbed - self.step);
            self.whole().sweep(now, parts);
            self.step += now;
        }
        self.show_waves();
    }

    /// Updates the cells of blocks that are carried as waves, for reading.
    fn show_waves(&mut self) {
        for block in &mut self.blocks {
            block.show_waves(self.constants[block.segment].velocity_gain);
        }
    }

    /// Takes a step in which every block waits for all others.
    fn advance_together(&mut self) {
        Scratch::lend(|scratch| self.step_with(scratch));
    }

    fn step_with(&mut self, scratch: &mut Scratch) {
        let step = self.step + 1;
        if self.implicit.is_some() {
            self.whole().advance_stresses(step, scratch);
            self.step = step;
            self.advance_nodes();
        } else {
            self.whole().advance_all(step, scratch);
            self.step = step;
        }
        if self.rupture.is_some() {
            self.break_where_due();
        }
        self.whole().damp_all(step, scratch);
        if let Some(nodes) = &mut self.implicit {
            nodes.adopt_filtered_velocities(&self.blocks);
        }
        if StartingFan::next_step(&self.fans, self.step) == Some(self.step) {
            self.impose_fans();
        }
        self.whole().note_all();
    }

    /// Returns the bar with each node starting at the velocity (m/s) at its position (m). For a bar at t = 0 with free ends and without
    /// joints that can open.
    #[must_use]
    pub fn moving(mut self, velocity: impl Fn(f64) -> f64) -> Self {
        let at = |node: usize| velocity(self.grid.node(node));
        for block in &mut self.blocks {
            block.start_with(at);
        }
        for (edge, block) in self.edges.iter_mut().zip(&self.blocks) {
            edge.after = at(block.cells.end);
        }
        self.left.start_with(at(0));
        self.right.start_with(at(self.grid.cells()));
        self
    }

    /// Returns the whole bar as a subdomain.
    fn whole(&mut self) -> Subdomain<'_> {
        Subdomain {
            common: Common {
                laws: &self.laws,
                constants: &self.constants,
                dt: self.grid.dt,
                blocks: self.blocks.len(),
                step: self.step,
                travels: self.travels && self.sweeps(),
                watched: self.watched.as_deref(),
            },
            first: 0,
            blocks: &mut self.blocks,
            edges: &mut self.edges,
            contacts: &mut self.contacts,
            ends: [Some(&mut self.left), Some(&mut self.right)],
        }
    }

    /// Returns true if several steps can be taken in one sweep.
    pub fn sweeps(&self) -> bool {
        self.rupture.is_none() && self.implicit.is_none()
    }

    /// Logs these cells (in increasing order), and the ends, in every step from now on. Only for a bar that [`Self::sweeps`].
    pub fn watch(&mut self, cells: &[usize]) {
        for &cell in cells {
            let k = self.blocks.partition_point(|b| b.cells.end <= cell);
            let block = &mut self.blocks[k];
            block.watched.push(cell - block.cells.start);
        }
        let watched = |k: &usize| !self.blocks[*k].watched.is_empty();
        self.watched = Some((0..self.blocks.len()).filter(watched).collect());
        for end in [&mut self.left, &mut self.right] {
            end.watch();
        }
    }

    /// Returns what was logged since [`Self::clear_log`].
    pub fn log(&self) -> Log<'_> {
        let mut logged = Vec::new();
        for block in &self.blocks {
            let cells = block.watched.len();
            logged.extend((0..cells).map(|k| LoggedCell { rows: block.log.get(k..).unwrap_or_default(), cells }));
        }
        Log { cells: logged, ends: [self.left.log(), self.right.log()] }
    }

    /// Clears the log, and keeps its memory.
    pub fn clear_log(&mut self) {
        self.blocks.iter_mut().for_each(|block| block.log.clear());
        self.left.clear_log();
        self.right.clear_log();
    }

    /// Advances all nodes together, if distributed forces act along the bar.
    fn advance_nodes(&mut self) {
        let time = self.time();
        if let Some(nodes) = &mut self.implicit {
            nodes.advance(time, &self.blocks, [&mut self.left, &mut self.right]);
        }
        self.share_nodes();
    }

    /// Copies the velocities of the nodes to the blocks and to the edges between them.
    fn share_nodes(&mut self) {
        let Some(nodes) = &self.implicit else { return };
        for block in &mut self.blocks {
            nodes.share(block);
            block.wake_if_strained();
            block.note_undamped();
        }
        for (edge, block) in self.edges.iter_mut().zip(&self.blocks) {
            let [before, after] = nodes.velocities(block.cells.end);
            (edge.after, edge.velocity_increment) = (after, after - before);
        }
    }

    /// Copies the velocity of every edge to both neighbours.
    pub(super) fn share_edges(&mut self) {
        for (k, edge) in self.edges.iter().enumerate() {
            self.blocks[k].set_edge(1, edge.after);
            self.blocks[k + 1].set_edge(0, edge.after);
        }
        for contact in &self.contacts {
            let [[_, left], [_, right]] = [0, 1].map(|side| contact.velocities(side));
            self.blocks[contact.edge].set_edge(1, left);
            self.blocks[contact.edge + 1].set_edge(0, right);
        }
        let right_end = self.blocks.len() - 1;
        self.blocks[0].set_edge(0, self.left.velocity_after());
        self.blocks[right_end].set_edge(1, self.right.velocity_after());
    }

    /// Returns the number of steps taken.
    pub fn step(&self) -> usize {
        self.step
    }

    /// Returns the time of the stresses, s.
    pub fn time(&self) -> f64 {
        self.step as f64 * self.grid.dt
    }

    /// Returns the grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns the left end.
    pub fn left(&self) -> &EndNode {
        &self.left
    }

    /// Returns the right end.
    pub fn right(&self) -> &EndNode {
        &self.right
    }

    /// Returns samples of the left and the right end after the latest step.
    pub fn end_samples(&self) -> [EndSample; 2] {
        let elastic = [&self.blocks[0], &self.blocks[self.blocks.len() - 1]].map(Block::is_elastic);
        [self.left.sample(elastic[0]), self.right.sample(elastic[1])]
    }

    /// Returns the joints that can open, from left to right.
    pub fn contacts(&self) -> impl Iterator<Item = ContactState> {
        self.contacts.iter().map(Contact::state)
    }

    /// Returns true while no cell has yielded: only the elastic kernel has run.
    pub fn stayed_elastic(&self) -> bool {
        self.blocks.iter().all(|b| b.stage != Stage::Plastic)
    }
}

fn blocks(bar: &Bar, grid: &Grid) -> Vec<Block> {
    let mut blocks = Vec::new();
    for (k, part) in grid.segments.iter().enumerate() {
        let mut start = part.cells.start;
        for cells in block_sizes(part.cells.len()) {
            let mut block = Block::new(start..start + cells, k, bar.segments[k].velocity);
            block.taper = BlockTaper::of(&bar.segments[k], part, &block.cells);
            if bar.segments[k].profile.is_some() {
                block.start_with(|node| part.initial_velocity(&bar.segments[k], node));
            }
            start += cells;
            blocks.push(block);
        }
    }
    blocks
}

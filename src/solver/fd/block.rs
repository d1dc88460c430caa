//! Block of cells that is advanced as a unit: small enough for the first-level cache, and large enough that selecting its kernel costs
//! nothing.

use std::cell::RefCell;
use std::ops::Range;

use multiversion::multiversion;
use serde::{Deserialize, Serialize};

use super::grid_filter::{self, Filter, Neighbour, VelocityDifferences};
use super::quantity::Quantity;
use super::segment::{Constants, SegmentLaw};
use super::signals::{Signals, inner_nodes};
use super::sizes::MOST_CELLS;
use super::taper::BlockTaper;
use super::waves::Waves;
use crate::law::{
    Aligned, AlignedRow, DataEnd, FirstPassed, Row, RowLaw, StrainedRow, aligned_row, any_flows, elastic_row, split_off,
};
use crate::solver::energies::ShockLoss;

/// Cell that flowed further before it unloaded, see [`super::stopping_flow`].
#[derive(Debug, Clone, Copy)]
pub(super) struct StoppedCell {
    pub cell: usize,
    /// Stress before and after that flow, Pa.
    pub sigma: [f64; 2],
    /// E times the plastic strain of that flow, Pa.
    pub plastic: f64,
    /// E times the plastic strain of the cell after it, Pa.
    pub plastic_after: f64,
    /// Work of that flow times 2 E per volume, Pa^2.
    pub work: f64,
}

/// Work arrays for the cells of a block during a step; their contents are meaningless between steps.
#[derive(Debug)]
pub(super) struct Scratch {
    work: Aligned<[f64; MOST_CELLS]>,
    onset_correction: Aligned<[f64; MOST_CELLS]>,
    differences: VelocityDifferences,
    stopped: Vec<StoppedCell>,
}

impl Scratch {
    const fn new() -> Self {
        let cells = [0.0; MOST_CELLS];
        Self {
            work: Aligned(cells),
            onset_correction: Aligned(cells),
            differences: VelocityDifferences::new(),
            stopped: Vec::new(),
        }
    }

    /// Runs `steps` with the instance of this thread, which is filled with zeros once, not in every step.
    pub fn lend<T>(steps: impl FnOnce(&mut Self) -> T) -> T {
        thread_local! { static OWN: RefCell<Scratch> = const { RefCell::new(Scratch::new()) }; }
        OWN.with_borrow_mut(|own| steps(own))
    }
}

/// Quantities logged of a watched cell.
pub(super) const WATCHED: [Quantity; 4] =
    [Quantity::Stress, Quantity::Strain, Quantity::Velocity, Quantity::Temperature];

/// Number of steps without flow after which a yielded block is treated as elastic, until a cell may flow again.
pub(super) const STEPS_WITHOUT_FLOW: u32 = 16;

/// State of a block's cells; determines the kernel that they need.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Stage {
    /// No cell has yielded: elastic kernel, and no plastic state in memory.
    Elastic,
    /// Some cells have yielded: kernel of the law.
    Plastic,
}

/// Cells with their nodes. Neighbouring blocks each hold a copy of the node between them. The fields that tell whether there is anything to
/// compute come first, on one cache line.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[repr(C, align(64))]
pub(super) struct Block {
    /// Active cells, in whole pieces of [`CHUNK`]. A step changes no bit of the other cells as long as the nodes around them keep their
    /// velocities, so that nothing is computed there until these change.
    pub active: Range<usize>,
    /// First step in which the grid filter acts: from then on, oscillations may have arrived from a place that yielded. A signal takes at
    /// least one step to pass through a block.
    pub filter_from_step: usize,
    /// Impulses of the grid filter (as velocity differences) in the first and in the last cell.
    pub impulses_at_edges: [f64; 2],
    /// Velocities of the first and the last inner node before the damping of the latest step, for the filter of the neighbours.
    inner: [f64; 2],
    pub stage: Stage,
    /// Whether waves can be shocks, here or in a neighbour.
    pub meets_shocks: bool,
    /// Number of steps in which no cell of the yielded block flowed; and the stress up to which its cells are then known to stay elastic,
    /// Pa, 0 if unknown.
    pub steps_without_flow: u32,
    pub elastic_up_to: f64,
    /// Waves of a block that is carried as waves. Its stresses and velocities are then those of the latest [`Self::show_waves`], except at
    /// the edges.
    pub waves: Option<Box<Waves>>,
    /// First step in which the block may (again) be carried as waves; and the velocities of the nodes at both edges in the step before.
    pub travels_from: usize,
    pub latest_edges: [f64; 2],
    /// Whether every step computes all cells, by their law once they have yielded: the reference for skipping some of them.
    #[cfg(test)]
    #[serde(skip)]
    pub always_active: bool,
    /// Whether the block was at rest when it was last logged.
    logged_at_rest: bool,
    /// Whether the work of every cell is kept.
    pub keeps_work: bool,
    pub sigma: AlignedRow,
    /// Velocities of the nodes, one more than cells.
    pub v: AlignedRow,
    /// State of the law, empty until the block yields.
    pub state: AlignedRow,
    /// E times the plastic strain of the latest step, Pa; 0 in cells that did not flow, or whose rate of flow the steps resolve. Empty
    /// until the block yields.
    pub flow: Vec<f32>,
    /// Flow history of the cells, see [`grid_filter::note_flow`]; empty until the block yields, and if there can be no shocks.
    have_flowed: Vec<i8>,
    pub cells: Range<usize>,
    pub segment: usize,
    /// Running sum over cells and steps of the plastic work as returned by [`RowLaw::advance`], times the cells' relative areas.
    pub plastic: f64,
    /// Likewise, running sum of [`Row::onset_correction`].
    pub onset_correction: f64,
    /// Running sum of the energy that the filter took from the block's inner nodes, see [`grid_filter::apply_impulses`].
    pub damped: f64,
    /// Energy that the filter took in cells inside shocks, divided by the mass of a mean cell, (m/s)^2.
    pub shock_loss: ShockLoss,
    /// Largest accumulated plastic strain of a cell so far, times E, Pa.
    pub reached: f64,
    /// Cells that are logged in every step, and the log: one row per cell, step by step.
    pub watched: Vec<usize>,
    #[serde(skip)]
    pub log: Vec<[f64; WATCHED.len()]>,
    /// 2E times the plastic work of every cell per volume, Pa^2; empty until the block yields, and if it is not kept.
    pub absorbed: Vec<f64>,
    /// Cells that have reached a limit of their law's data.
    pub passed: FirstPassed,
    /// Areas of the cells; `None` in a uniform segment.
    pub taper: Option<Box<BlockTaper>>,
}

/// Data of the segment and the step that a block needs to advance.
#[derive(Clone, Copy)]
pub(super) struct BlockLaw<'a> {
    pub law: &'a dyn RowLaw,
    /// E dt/dx.
    pub stress_gain: f64,
    /// dt/(rho dx).
    pub velocity_gain: f64,
    pub yield_stress: f64,
    /// Where the data of the law end.
    pub end: &'a DataEnd,
    pub filter: &'a Filter,
    /// Whether elastic blocks may be carried as waves.
    pub travels: bool,
    /// Number of the current step.
    pub step: usize,
}

impl Block {
    pub fn new(cells: Range<usize>, segment: usize, velocity: f64) -> Self {
        let n = cells.len();
        Self {
            cells,
            segment,
            stage: Stage::Elastic,
            meets_shocks: false,
            steps_without_flow: 0,
            elastic_up_to: 0.0,
            waves: None,
            travels_from: 0,
            latest_edges: [0.0; 2],
            #[cfg(test)]
            always_active: false,
            active: 0..0,
            sigma: aligned_row(n, 0.0),
            v: aligned_row(n + 1, velocity),
            state: aligned_row(0, 0.0),
            flow: Vec::new(),
            have_flowed: Vec::new(),
            plastic: 0.0,
            onset_correction: 0.0,
            impulses_at_edges: [0.0; 2],
            inner: [velocity; 2],
            filter_from_step: usize::MAX,
            watched: Vec::new(),
            log: Vec::new(),
            logged_at_rest: false,
            damped: 0.0,
            shock_loss: ShockLoss::default(),
            reached: 0.0,
            keeps_work: false,
            absorbed: Vec::new(),
            passed: FirstPassed::default(),
            taper: None,
        }
    }

    /// Returns true if no cell has yielded.
    pub fn is_elastic(&self) -> bool {
        self.stage != Stage::Plastic
    }

    /// Returns true if some cells flowed in the latest step.
    pub fn flows(&self) -> bool {
        self.is_plastic() && self.steps_without_flow == 0
    }

    /// Returns true if some cells have flowed in the latest steps, fewer than [`STEPS_WITHOUT_FLOW`].
    pub fn flowed_lately(&self) -> bool {
        self.is_plastic() && self.steps_without_flow + 1 < STEPS_WITHOUT_FLOW
    }

    /// Returns true if a local cell reaches a stress (Pa) elastically.
    pub fn carries(&self, law: &SegmentLaw, cell: usize, stress: f64) -> bool {
        if self.state.is_empty() {
            return stress.abs() <= law.yield_stress;
        }
        let mut state: Vec<f64> = self.state.chunks_exact(self.sigma.len()).map(|column| column[cell]).collect();
        let (mut reached, mut work) = ([self.sigma[cell]], [0.0]);
        law.law.strain(&[stress - self.sigma[cell]], &mut reached, &mut state, &mut work);
        work[0] == 0.0
    }

    /// Sets the velocity of every node at t = 0, m/s, as a function of the node's number in the bar.
    pub fn start_with(&mut self, velocity: impl Fn(usize) -> f64) {
        let nodes = self.cells.start..=self.cells.end;
        self.v.iter_mut().zip(nodes).for_each(|(v, node)| *v = velocity(node));
        self.note_undamped();
        self.wake();
    }

    /// Moves the cells from local cell `at` on (0 < at < cells) into a new block; both blocks keep the node between them. Running sums stay
    /// in this block.
    pub fn split_off(&mut self, at: usize) -> Self {
        let (cells, state) = (self.sigma.len(), self.split_state(at));
        let v = split_off(&mut self.v, at);
        self.v.push(v[0]);
        let middle = self.cells.start + at;
        let mut right = Self {
            cells: middle..self.cells.end,
            segment: self.segment,
            stage: self.stage,
            meets_shocks: self.meets_shocks,
            steps_without_flow: self.steps_without_flow,
            elastic_up_to: self.elastic_up_to,
            waves: None,
            travels_from: 0,
            latest_edges: [0.0; 2],
            #[cfg(test)]
            always_active: self.always_active,
            active: 0..cells - at,
            sigma: split_off(&mut self.sigma, at),
            v,
            state,
            flow: if self.flow.is_empty() { Vec::new() } else { self.flow.split_off(at) },
            have_flowed: if self.have_flowed.is_empty() { Vec::new() } else { self.have_flowed.split_off(at) },
            plastic: 0.0,
            onset_correction: 0.0,
            impulses_at_edges: [0.0; 2],
            inner: [0.0; 2],
            filter_from_step: self.filter_from_step,
            watched: self.watched.extract_if(.., |cell| *cell >= at).map(|cell| cell - at).collect(),
            log: Vec::new(),
            logged_at_rest: false,
            damped: 0.0,
            shock_loss: ShockLoss::default(),
            reached: self.reached,
            keeps_work: self.keeps_work,
            absorbed: if self.absorbed.is_empty() { Vec::new() } else { self.absorbed.split_off(at) },
            passed: FirstPassed::default(),
            taper: self.taper.as_mut().map(|taper| Box::new(taper.split_off(at))),
        };
        self.cells.end = middle;
        if !self.at_rest() {
            self.wake();
        }
        self.note_undamped();
        right.note_undamped();
        right
    }

    fn split_state(&mut self, at: usize) -> AlignedRow {
        let (mut kept, mut state) = (aligned_row(0, 0.0), aligned_row(0, 0.0));
        for column in self.state.chunks_exact(self.sigma.len()) {
            kept.extend_from_slice(&column[..at]);
            state.extend_from_slice(&column[at..]);
        }
        self.state = kept;
        state
    }

    /// Starts the grid filter with this step if cells have flowed in the latest steps.
    pub fn note_yield(&mut self, step: usize) {
        if self.flowed_lately() {
            self.filter_from_step = self.filter_from_step.min(step);
        }
    }

    /// Marks the block as one in which waves can be shocks.
    pub fn start_meeting_shocks(&mut self, law: &dyn RowLaw) {
        self.meets_shocks = true;
        if self.is_plastic() {
            let flowed = |i: usize| i8::from(law.accumulated(&self.state, i) > 0.0);
            self.have_flowed = (0..self.sigma.len()).map(flowed).collect();
        }
    }

    /// Records the active cells that have reached a limit of their law's data.
    fn note_limits(&mut self, law: BlockLaw<'_>) {
        let (first, segment, cells) = (self.cells.start + self.active.start, self.segment, self.active.clone());
        let row = StrainedRow { sigma: &self.sigma, state: &self.state, cells, first, segment, step: law.step };
        law.law.note_limits(law.end, &row, &mut self.passed);
    }

    /// Repeats the latest rows of the log if the block was at rest then and still is; otherwise returns false.
    pub fn repeat_log(&mut self) -> bool {
        let rests = self.at_rest();
        let rested = std::mem::replace(&mut self.logged_at_rest, rests);
        let from = self.log.len().checked_sub(self.watched.len()).filter(|_| rested && rests);
        if let Some(from) = from {
            self.log.extend_from_within(from..);
        }
        from.is_some()
    }

    /// Returns the velocity of the first (side 0) or last (side 1) inner node before the damping of the latest step, m/s. In a block of one
    /// cell it is that of the node at the other edge, which must not have been damped yet. `gain` is dt/(rho dx).
    pub fn undamped(&self, side: usize, gain: f64) -> f64 {
        match &self.waves {
            Some(waves) => waves.velocity(if side == 0 { 1 } else { self.sigma.len() - 1 }, gain),
            None if self.sigma.len() == 1 => self.v[1 - side],
            None => self.inner[side],
        }
    }

    /// Returns the stress of local cell `i`, Pa, also while the block is carried as waves.
    pub fn stress(&self, i: usize) -> f64 {
        self.waves.as_ref().map_or(self.sigma[i], |waves| waves.stress(i))
    }

    /// Returns the flow of the first (side 0) or last (side 1) cell in the latest step, see [`Self::flow`].
    pub fn flow_at_edge(&self, side: usize) -> f64 {
        let flow = if side == 0 { self.flow.first() } else { self.flow.last() };
        flow.map_or(0.0, |&flow| f64::from(flow))
    }

    /// Stores the velocities that [`Self::undamped`] returns.
    pub fn note_undamped(&mut self) {
        self.inner = [self.v[1], self.v[self.sigma.len() - 1]];
    }

    /// Applies the grid filter to the block's inner nodes. `outside` describes the neighbours on both sides; `outer` are the velocities
    /// (m/s) of the nodes at its two edges at the time of the stresses, used only where waves can be shocks. The edge nodes belong to the
    /// caller, which finds their impulses in `impulses_at_edges`. Returns the impulses of the cells, `None` if all are 0.
    pub fn apply_grid_filter<'a>(
        &mut self,
        law: &SegmentLaw,
        constants: &Constants,
        outside: [Neighbour; 2],
        outer: [f64; 2],
        scratch: &'a mut Scratch,
    ) -> Option<&'a [f64]> {
        self.widen();
        let flows = self.flows();
        let Scratch { work, onset_correction, differences, .. } = scratch;
        let (cells, active, v) = (self.sigma.len(), self.active.clone(), &self.v);
        let (at_left, at_right) = (active.start == 0, active.end == cells);
        let outside = [
            if at_left { outside[0] } else { Neighbour::Node(v[active.start - 1]) },
            if at_right { outside[1] } else { Neighbour::Node(v[active.end + 1]) },
        ];
        differences.read(&v[active.start..=active.end], outside, constants.rounding());
        if !self.meets_shocks && law.has_shocks(self.reached, differences.largest()) {
            self.start_meeting_shocks(law.law.as_ref());
        }
        let filter = constants.filter(self.meets_shocks);
        if filter.takes_shocks() && !self.flow.is_empty() {
            self.have_flowed.resize(cells, 0);
            let cells = active.clone();
            grid_filter::note_flow(
                flows,
                &self.flow[cells.clone()],
                &self.sigma[cells.clone()],
                &mut self.have_flowed[cells],
            );
        }
        self.impulses_at_edges = [0.0; 2];
        if differences.are_smooth(flows, *filter) {
            return None;
        }
        // Cells at rest have no impulse: their nodes have equal velocities.
        let impulses = &mut work.0[..cells];
        if !at_left {
            impulses[active.start - 1] = 0.0;
        }
        if !at_right {
            impulses[active.end] = 0.0;
        }
        let have_flowed = self.have_flowed.get(active.clone()).unwrap_or_default();
        let flow = self.flow.get(active.clone()).unwrap_or_default();
        let mean: &[f64] = if have_flowed.is_empty() {
            &[]
        } else {
            self.mean_differences(constants.velocity_gain, outer, &mut onset_correction.0)
        };
        let row = grid_filter::Cells { flows, flow, have_flowed, sigma: &self.sigma[active.clone()], mean };
        let anything = differences.find(&row, *filter, &mut impulses[active.clone()]);
        self.impulses_at_edges =
            [if at_left { impulses[0] } else { 0.0 }, if at_right { impulses[cells - 1] } else { 0.0 }];
        if !anything {
            return None;
        }
        let (gain, nodes) = (constants.velocity_gain, inner_nodes(&active, cells));
        self.damped += match &self.taper {
            None => grid_filter::apply_impulses(gain, &self.sigma, impulses, &mut self.v, nodes),
            Some(taper) => taper.apply_impulses(gain, &self.sigma, impulses, &mut self.v, nodes),
        };
        Some(impulses)
    }

    /// Returns the velocity of a node at the time of the stresses, in the middle of its step, m/s. Half of the change that the filter has
    /// made since (`filtered`) is counted. `outer` are the velocities of the nodes at both edges.
    pub fn velocity_at_stresses(&self, node: usize, gain: f64, outer: [f64; 2], filtered: f64) -> f64 {
        match node {
            0 => outer[0],
            node if node == self.sigma.len() => outer[1],
            node => self.v[node] - 0.5 * (filtered + self.velocity_increment(gain, node)),
        }
    }

    /// Computes the velocity differences of the active cells at the time of the stresses, m/s; `outer` are the velocities of the nodes at
    /// both edges.
    fn mean_differences<'a>(&self, gain: f64, outer: [f64; 2], into: &'a mut [f64]) -> &'a [f64] {
        let (cells, Range { start, end }) = (self.sigma.len(), self.active.clone());
        let velocity = |node: usize| self.velocity_at_stresses(node, gain, outer, 0.0);
        let into = &mut into[..end - start];
        let inner = start.max(1)..end.min(cells - 1);
        let in_rows = self.taper.is_none() && !inner.is_empty();
        if in_rows {
            let (sigma, v) = (&self.sigma[inner.start - 1..=inner.end], &self.v[inner.start..=inner.end]);
            mean_differences_inside(gain, sigma, v, &mut into[inner.start - start..inner.end - start]);
        }
        for cell in (start..end).filter(|cell| !in_rows || !inner.contains(cell)) {
            into[cell - start] = velocity(cell + 1) - velocity(cell);
        }
        into
    }

    /// Advances the stresses of a block that is not at rest, then the nodes inside it. The nodes at its two edges belong to the caller.
    ///
    /// `scratch` stays in the first-level cache from block to block.
    pub fn advance(&mut self, law: BlockLaw<'_>, scratch: &mut Scratch) {
        if self.travel(law) || !self.find_active(law, Signals::ThroughCells) {
            return;
        }
        self.advance_stress(law, scratch);
        let nodes = inner_nodes(&self.active, self.sigma.len());
        match &self.taper {
            None => advance_velocity(law.velocity_gain, &self.sigma, &mut self.v, nodes),
            Some(taper) => taper.advance_velocity(law.velocity_gain, &self.sigma, &mut self.v, nodes),
        }
        self.note_undamped();
    }

    /// Returns the velocity change in a step of the node to the left of local cell `i` (0 < i < cells), m/s.
    #[inline]
    pub fn velocity_increment(&self, velocity_gain: f64, i: usize) -> f64 {
        match &self.taper {
            None => velocity_gain * (self.sigma[i] - self.sigma[i - 1]),
            Some(taper) => taper.velocity_increment(velocity_gain, &self.sigma, i),
        }
    }

    /// Returns the area of local cell `i` divided by the mean area of the segment.
    pub fn area(&self, i: usize) -> f64 {
        self.taper.as_ref().map_or(1.0, |taper| taper.area[i])
    }

    /// Returns the volume of the block divided by that of a mean cell of the segment.
    pub fn volume(&self) -> f64 {
        self.taper.as_ref().map_or(self.sigma.len() as f64, |taper| taper.area.iter().sum())
    }

    /// Advances the stresses of the block only; all its nodes belong to the caller.
    pub fn advance_stresses(&mut self, law: BlockLaw<'_>, scratch: &mut Scratch) {
        if self.find_active(law, Signals::ThroughNodes) {
            self.advance_stress(law, scratch);
        }
    }

    fn advance_stress(&mut self, law: BlockLaw<'_>, scratch: &mut Scratch) {
        if self.is_elastic() && self.stays_elastic(law) || self.is_elastic_again(law, scratch) {
            return;
        }
        let (cells, active) = (self.sigma.len(), self.active.clone());
        self.complete_flow(law, &mut scratch.stopped);
        let [work, onset_correction] = [&mut scratch.work, &mut scratch.onset_correction].map(|of| &mut of.0[..cells]);
        let row = Row {
            gain: law.stress_gain,
            v: &self.v,
            sigma: &mut self.sigma,
            // The work of each cell is needed to weight it with the cell's area; in a uniform segment the sum is sufficient.
            work: (self.keeps_work || self.taper.is_some()).then_some(&mut *work),
            onset_correction: self.taper.is_some().then_some(&mut *onset_correction),
            flow: &mut self.flow,
            cells: active.clone(),
        };
        let state = &mut self.state;
        let advanced = law.law.advance(row, state);
        let (work, onset_correction) = (&work[active.clone()], &onset_correction[active.clone()]);
        if self.keeps_work {
            self.absorbed.resize(cells, 0.0);
            for (sum, work) in self.absorbed[active.clone()].iter_mut().zip(work) {
                *sum += *work;
            }
        }
        let [plastic, onset_correction] = match &self.taper {
            None => [advanced.work, advanced.onset_correction],
            Some(taper) => {
                [work, onset_correction].map(|of| of.iter().zip(&taper.area[active.clone()]).map(|(w, a)| w * a).sum())
            }
        };
        self.plastic += plastic;
        self.onset_correction += onset_correction;
        self.record_stopped(law.law, &scratch.stopped);
        self.reached = self.reached.max(advanced.accumulated);
        law.law.clear_resolved(&self.state, &mut self.flow);
        if !law.end.is_far(advanced.accumulated, 0.0) {
            self.note_limits(law);
        }
        self.look_for_flow(law);
    }

    /// Records whether a cell flowed in the latest step and, after some steps without flow, up to which stress none will.
    fn look_for_flow(&mut self, law: BlockLaw<'_>) {
        if any_flows(&self.flow) {
            self.steps_without_flow = 0;
            return;
        }
        self.steps_without_flow = self.steps_without_flow.saturating_add(1);
        if self.steps_without_flow.is_multiple_of(STEPS_WITHOUT_FLOW) {
            let up_to = law.law.elastic_up_to(law.yield_stress, &self.state);
            let accumulated = (0..self.sigma.len()).map(|i| law.law.accumulated(&self.state, i)).fold(0.0, f64::max);
            self.elastic_up_to = if law.end.is_far(accumulated, -up_to) { up_to } else { 0.0 };
        }
    }

    /// Advances a yielded block whose cells are known to stay elastic, with the same bits as the law. Returns false, with unchanged
    /// stresses, if a cell may flow.
    fn is_elastic_again(&mut self, law: BlockLaw<'_>, scratch: &mut Scratch) -> bool {
        #[cfg(test)]
        if self.always_active {
            return false;
        }
        if self.elastic_up_to == 0.0 {
            return false;
        }
        let Range { start, end } = self.active;
        let (before, sigma) = (&mut scratch.work.0[start..end], &mut self.sigma[start..end]);
        before.copy_from_slice(sigma);
        let is_elastic = elastic_row(law.stress_gain, &self.v[start..=end], sigma) <= self.elastic_up_to;
        if !is_elastic {
            sigma.copy_from_slice(before);
            self.elastic_up_to = 0.0;
        }
        is_elastic
    }

    /// Advances the stresses elastically. If the block yields in the step, takes the step back, allocates the plastic state, and returns
    /// false.
    fn stays_elastic(&mut self, law: BlockLaw<'_>) -> bool {
        let Range { start, end } = self.active;
        let peak = elastic_row(law.stress_gain, &self.v[start..=end], &mut self.sigma[start..end]);
        if peak <= law.yield_stress {
            if !law.end.is_far_below_yield(peak, law.yield_stress) {
                self.note_limits(law);
            }
            return true;
        }
        elastic_row(-law.stress_gain, &self.v[start..=end], &mut self.sigma[start..end]);
        self.start_plastic(law.law.state_len());
        self.wake();
        false
    }

    /// Allocates the plastic state, with this many numbers per cell.
    pub fn start_plastic(&mut self, numbers: usize) {
        let cells = self.sigma.len();
        self.stage = Stage::Plastic;
        self.state = aligned_row(numbers * cells, 0.0);
        self.flow = vec![0.0; cells];
    }

    /// Returns true if cells have yielded.
    pub fn is_plastic(&self) -> bool {
        self.stage == Stage::Plastic
    }

    /// Returns E times the signed plastic strain of local cell `i`, Pa.
    pub fn plastic_strain(&self, law: &dyn RowLaw, i: usize) -> f64 {
        if self.stage == Stage::Plastic { law.plastic_strain(&self.state, i) } else { 0.0 }
    }

    /// Returns E times the accumulated plastic strain of local cell `i`, Pa.
    pub fn accumulated(&self, law: &dyn RowLaw, i: usize) -> f64 {
        if self.stage == Stage::Plastic { law.accumulated(&self.state, i) } else { 0.0 }
    }
}

/// Sums over the block, weighted with the relative areas of cells and the masses of nodes (divided by that of a mean cell).
impl Block {
    /// Returns the sum of the squared stresses, Pa^2.
    pub fn sum_of_squares(&self) -> f64 {
        match &self.taper {
            None => self.sigma.iter().map(|s| s * s).sum(),
            Some(taper) => self.sigma.iter().zip(&taper.area).map(|(s, area)| area * (s * s)).sum(),
        }
    }

    /// Returns the sum of the work of the overstress, see [`RowLaw::overstress_work`].
    pub fn overstress_work(&self, law: &dyn RowLaw) -> f64 {
        let Some(taper) = &self.taper else { return law.overstress_work(&self.state) };
        let cells = self.sigma.len();
        let own = |i: usize| self.state.iter().skip(i).step_by(cells).copied().collect::<Vec<f64>>();
        taper.area.iter().enumerate().map(|(i, area)| area * law.overstress_work(&own(i))).sum()
    }

    /// Returns the mass of the node to the left of local cell `i` (0 < i < cells) divided by the mean mass of a cell of the segment.
    pub fn node_mass(&self, i: usize) -> f64 {
        self.taper.as_ref().map_or(1.0, |taper| taper.node_mass(i))
    }

    /// Returns the sums over the nodes inside the block.
    pub fn inner_nodes(&self, velocity_gain: f64) -> NodeMotion {
        self.nodes(|i| self.v[i] - self.velocity_increment(velocity_gain, i))
    }

    /// As [`Self::inner_nodes`], before anything acts on the nodes.
    pub fn inner_nodes_at_start(&self) -> NodeMotion {
        self.nodes(|i| self.v[i])
    }

    #[inline(always)]
    fn nodes(&self, before: impl Fn(usize) -> f64) -> NodeMotion {
        let mut all = NodeMotion::default();
        for i in 1..self.sigma.len() {
            all.add(self.node_mass(i), NodeMotion::of(before(i), self.v[i]));
        }
        all
    }
}

/// Sums over nodes, formed from their velocities half a step before and after the time of the stresses.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct NodeMotion {
    /// Sum of the products of both velocities.
    pub products: f64,
    /// Sum of the sums of both velocities, and sum of the squares of these.
    pub sums: f64,
    pub squares: f64,
}

impl NodeMotion {
    /// Returns the terms of one node.
    #[inline(always)]
    pub fn of(before: f64, after: f64) -> Self {
        let sum = before + after;
        Self { products: after * before, sums: sum, squares: sum * sum }
    }

    #[inline(always)]
    fn add(&mut self, mass: f64, node: Self) {
        self.products += mass * node.products;
        self.sums += mass * node.sums;
        self.squares += mass * node.squares;
    }
}

/// Computes the velocity differences at the time of the stresses of cells with neighbours on both sides; `sigma` has one more entry on
/// either side.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn mean_differences_inside(gain: f64, sigma: &[f64], v: &[f64], into: &mut [f64]) {
    let cells = into.len();
    let (before, own, after) = (&sigma[..cells], &sigma[1..=cells], &sigma[2..cells + 2]);
    let (left, right) = (&v[..cells], &v[1..=cells]);
    for i in 0..cells {
        let right = right[i] - 0.5 * (gain * (after[i] - own[i]));
        into[i] = right - (left[i] - 0.5 * (gain * (own[i] - before[i])));
    }
}

/// Adds `gain (sigma[i] - sigma[i-1])` to `v[i]` for these nodes inside a block.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn advance_velocity(gain: f64, sigma: &[f64], v: &mut [f64], nodes: Range<usize>) {
    let (sigma, v) = (&sigma[nodes.start - 1..], &mut v[nodes]);
    let nodes = v.len();
    let (left, right) = (&sigma[..nodes], &sigma[1..=nodes]);
    for i in 0..nodes {
        v[i] += gain * (right[i] - left[i]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The neighbour beyond reads the last inner node of the part that is split off.
    #[test]
    fn both_parts_of_a_split_block_show_their_inner_nodes() {
        let mut left = Block::new(0..300, 0, 0.0);
        left.start_with(|node| node as f64);
        let right = left.split_off(100);
        assert_eq!([0, 1].map(|side| left.undamped(side, 1.0)), [1.0, 99.0]);
        assert_eq!([0, 1].map(|side| right.undamped(side, 1.0)), [101.0, 299.0]);
    }
}

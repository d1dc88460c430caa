//! A block of cells that is advanced as a unit, with ghost cells on either side.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::history::History;
use super::part::Part;
use crate::bar::Segment;
use crate::solver::energies::ShockLoss;
use crate::solver::fd::SegmentGrid;
use crate::wave::riemann::{Flux, Workspace};

/// Largest number of cells in a block: its row and scratch stay in the first-level cache.
pub(super) const BLOCK: usize = 256;

/// Number of cells on either side that the slopes of a cell inside a front may depend on.
pub(super) const NEARBY: usize = 3;

/// Number of ghost cells on either side: the nearest has a state at its face, which depends on [`NEARBY`] more.
pub(super) const GHOSTS: usize = 1 + NEARBY;

/// Number of cells in the longest row.
pub(super) const ROW: usize = BLOCK + 2 * GHOSTS;

/// Stage of a block, according to what its cells have met so far; decides which kernel they need.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Stage {
    /// Nothing has arrived: every stress is 0 and all cells have the same velocity. Nothing is computed.
    Quiet,
    /// No cell has yielded: the elastic kernel runs, and no plastic state is stored.
    Elastic,
    /// A cell may have yielded: the kernel of the law runs.
    Plastic,
}

/// Cells, with ghost copies of the neighbours' cells at both ends of every row.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Block {
    pub cells: Range<usize>,
    pub part: usize,
    pub stage: Stage,
    pub sigma: Vec<f64>,
    pub v: Vec<f64>,
    /// State variables of the law, empty until the block yields.
    pub state: Vec<f64>,
    /// Energy that slopes gave to every cell and that has not been dissipated since, W/m^2, <= 0; empty until the block yields, and along curves
    /// without a level part.
    pub energy_defect: Vec<f64>,
    /// Derived histories, if the law depends on the past of a cell.
    #[serde(skip)]
    pub histories: Vec<History>,
    /// Flux through the first and the last face, if that is an end or joint.
    pub outer: [Option<Flux>; 2],
    /// Faces of the row inside a fan at the start, and the fluxes through them, in the next step.
    #[serde(skip)]
    pub inside_fan: Vec<(usize, Flux)>,
    /// Sum over cells and steps of the plastic work that the law returns, Pa^2.
    pub plastic: f64,
    /// Sum over cells and steps of the dissipation by the scheme, W/m^2.
    pub lost: f64,
    /// Same in cells inside shocks.
    pub shock_loss: ShockLoss,
    /// Workspace for Riemann problems that are not elastic.
    #[serde(skip)]
    pub work: Workspace,
}

impl Block {
    pub fn new(cells: Range<usize>, part: usize, velocity: f64) -> Self {
        let row = cells.len() + 2 * GHOSTS;
        Self {
            cells,
            part,
            stage: Stage::Quiet,
            sigma: vec![0.0; row],
            v: vec![velocity; row],
            state: Vec::new(),
            energy_defect: Vec::new(),
            histories: Vec::new(),
            outer: [None, None],
            inside_fan: Vec::new(),
            plastic: 0.0,
            lost: 0.0,
            shock_loss: ShockLoss::default(),
            work: Workspace::default(),
        }
    }

    /// Sets the state of the block at t = 0: means of the segment's state over the cells, whose positions are in `grid`.
    pub fn set_initial(&mut self, segment: &Segment, grid: &SegmentGrid, part: &Part) {
        for (i, cell) in self.cells.clone().enumerate().map(|(i, cell)| (GHOSTS + i, cell)) {
            let [from, to] = grid.cell(cell);
            let (initial, velocity) = (segment.initial_between(from, to), segment.velocity_between(from, to));
            if self.stage == Stage::Quiet && (initial.stress != 0.0 || velocity != self.v[0]) {
                self.stage = Stage::Elastic;
            }
            (self.sigma[i], self.v[i]) = (initial.stress, velocity);
            if initial.is_of_a_law() {
                self.make_plastic(part);
                let rows = self.sigma.len();
                let state = part.law.law.deformed(&initial.deformed(part.modulus));
                self.state.chunks_exact_mut(rows).zip(state).for_each(|(column, number)| column[i] = number);
            }
        }
    }

    /// Row index of the cell that is `depth` cells inside the block from its left (0) or right (1) end.
    pub fn inside(&self, side: usize, depth: usize) -> usize {
        if side == 0 { GHOSTS + depth } else { self.sigma.len() - 1 - GHOSTS - depth }
    }

    /// Row index of the ghost cell that is `depth` cells outside.
    pub fn outside(&self, side: usize, depth: usize) -> usize {
        if side == 0 { GHOSTS - 1 - depth } else { self.sigma.len() - GHOSTS + depth }
    }

    /// Returns one state variable of a cell; 0 if nothing has yielded.
    pub fn state_at(&self, number: usize, i: usize) -> f64 {
        if self.state.is_empty() { 0.0 } else { self.state[number * self.sigma.len() + i] }
    }

    /// E times the strain of a cell, Pa.
    pub fn e_equivalent_strain(&self, part: &Part, i: usize) -> f64 {
        let plastic = if self.stage == Stage::Plastic { part.law.law.plastic_strain(&self.state, i) } else { 0.0 };
        self.sigma[i] + plastic
    }

    pub fn has_energy_defect_near(&self, part: &Part, i: usize) -> bool {
        [i - 1, i, i + 1].into_iter().any(|i| self.has_energy_defect(part, i))
    }

    /// Returns whether slopes gave a cell more energy than allowed.
    fn has_energy_defect(&self, part: &Part, i: usize) -> bool {
        self.energy_defect
            .get(i)
            .zip(part.most_energy_defect)
            .is_some_and(|(&energy_defect, most)| energy_defect < -most)
    }

    /// Adds the energy that the scheme dissipated in the cells in a step to their defects.
    pub fn record_dissipation(&mut self, lost: &[f64]) {
        for (energy_defect, lost) in self.energy_defect.iter_mut().skip(GHOSTS).zip(lost) {
            *energy_defect = (*energy_defect + lost).min(0.0);
        }
    }

    /// Makes the block plastic and allocates its state variables.
    pub fn make_plastic(&mut self, part: &Part) {
        if self.stage != Stage::Plastic {
            self.stage = Stage::Plastic;
            self.state = vec![0.0; part.law.law.state_len() * self.sigma.len()];
            self.energy_defect = vec![0.0; if part.most_energy_defect.is_some() { self.sigma.len() } else { 0 }];
        }
    }

    /// Updates the derived histories of a yielded block, if the law depends on the past of a cell.
    pub fn update_histories(&mut self, part: &Part) {
        self.histories.resize(self.sigma.len(), History::UNKNOWN);
        for (i, history) in self.histories.iter_mut().enumerate() {
            if history.is_unknown() {
                *history = History::of(part, &self.state, i);
            }
        }
    }

    /// Marks the derived history of a cell as unknown, because its state variables have changed.
    fn forget(&mut self, i: usize) {
        if let Some(history) = self.histories.get_mut(i) {
            *history = History::UNKNOWN;
        }
    }

    /// Marks the derived histories of cells that have done plastic work as unknown.
    pub fn note_flow(&mut self, work: &[f64]) {
        for (history, &work) in self.histories.iter_mut().zip(work) {
            if work != 0.0 {
                *history = History::UNKNOWN;
            }
        }
    }

    /// Copies the nearest cells of a neighbour of the same segment, which lies on `side`, to the ghost cells there.
    pub fn copy_from(&mut self, side: usize, other: &Self, part: &Part) {
        let numbers = if other.stage == Stage::Plastic { part.law.law.state_len() } else { 0 };
        for depth in 0..GHOSTS {
            let (to, from) = (self.outside(side, depth), other.inside(1 - side, depth));
            (self.sigma[to], self.v[to]) = (other.sigma[from], other.v[from]);
            // Both blocks must use the same slopes beside the face between them.
            if other.has_energy_defect(part, from) || (0..numbers).any(|number| other.state_at(number, from) != 0.0) {
                self.make_plastic(part);
            }
            if self.stage == Stage::Plastic {
                for number in 0..part.law.law.state_len() {
                    let at = number * self.sigma.len() + to;
                    self.state[at] = other.state_at(number, from);
                }
                self.forget(to);
                if let Some(energy_defect) = self.energy_defect.get_mut(to) {
                    *energy_defect = other.energy_defect.get(from).copied().unwrap_or(0.0);
                }
            }
        }
    }

    /// Sets the ghost cells beyond an end or joint: stress, velocity, and E times strain (Pa).
    pub fn fill_ghost_cells(&mut self, side: usize, part: &Part, [stress, velocity, e_equivalent_strain]: [f64; 3]) {
        for to in std::array::from_fn::<usize, GHOSTS, _>(|depth| self.outside(side, depth)) {
            (self.sigma[to], self.v[to]) = (stress, velocity);
            if self.stage == Stage::Plastic {
                let rows = self.sigma.len();
                let cell = self.inside(side, 0);
                for number in 0..part.law.law.state_len() {
                    self.state[number * rows + to] = self.state[number * rows + cell];
                }
                self.forget(to);
                if part.path_independent {
                    self.state[to] = e_equivalent_strain - stress;
                }
            }
        }
    }

    /// Returns the cells of the row whose face states are needed: the own cells, and one ghost cell on each side where the segment continues.
    pub fn carried(&self) -> Range<usize> {
        let last = self.sigma.len() - GHOSTS;
        GHOSTS - usize::from(self.outer[0].is_none())..last + usize::from(self.outer[1].is_none())
    }

    /// Returns the cells of the row whose [`NEARBY`] neighbours are all cells of the bar.
    pub fn surrounded(&self) -> Range<usize> {
        let cells = self.carried();
        let [left, right] = self.outer.map(|outer| if outer.is_some() { NEARBY } else { 0 });
        cells.start + left..(cells.end - right).max(cells.start + left)
    }

    /// Returns whether nothing enters the block from outside.
    pub fn at_rest(&self) -> bool {
        if !self.inside_fan.is_empty() {
            return false;
        }
        let velocity = self.v[GHOSTS];
        let quiet = |side: usize| match self.outer[side] {
            Some(flux) => flux.stress == 0.0 && flux.velocity == velocity,
            None => (0..GHOSTS).all(|depth| {
                let i = self.outside(side, depth);
                self.sigma[i] == 0.0 && self.v[i] == velocity
            }),
        };
        quiet(0) && quiet(1)
    }
}

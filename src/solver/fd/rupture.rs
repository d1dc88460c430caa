//! Fracture on the staggered grid: the node next to a cell that meets the criterion is split into two free faces.
//!
//! A bar separates at one of the two nodes of the first cell that meets the criterion: at a joint, or an end that pulls it, if the cell has
//! one, otherwise towards the neighbour that is nearer to fracture. The tension drops at once, so that fracture takes no energy and changes
//! no momentum. The faces are those of a joint that carries no tension, and can come into contact again.
//!
//! On a grid, tension builds up over whole cells and is released with the same delay: the tension that has fractured a place travels on as
//! a pulse some cells long. Such a pulse would fracture the bar again wherever it goes, as would the pulses from faces that meet or
//! separate. A place that has not yielded therefore fractures only if its neighbours have reached the threshold, too. A place that flows
//! needs no such condition, since no pulse can have made it flow.

use std::cmp::Ordering;

use super::block::{Block, Stage};
use super::breaking::{Breaking, Unresolved};
use super::contact::Contact;
use super::edge::{Edge, adjacent_cell_data, last};
use super::leapfrog::Leapfrog;
use crate::bar::joint;
use crate::law::LANES;
use crate::law::rupture::{Cause, Criteria, Criterion, Rupture, Site, Strained};
use crate::solver::StartingFan;

/// The wave that releases a fractured place follows the wave that would fracture the next cell too, where both travel at the elastic speed.
/// No cell fractures within these distances behind and ahead of the releasing wave, in cells.
const BEHIND: f64 = 2.0;
const AHEAD: f64 = 4.0;

/// Number of cells at an end that pulls which must exceed a threshold of strain or energy by the factor [`OVERSHOOT`]. Next to a suddenly
/// moved end that does not start with its fan, cells keep too much plastic strain: 12 % in the first cell of a bilinear bar, 0.5 % in the
/// third.
pub const NEAR_END: usize = 2;
/// Factor by which the cells of [`NEAR_END`] must exceed the threshold.
pub const OVERSHOOT: f64 = 1.2;

/// Smallest number of cells of a piece.
const SHORTEST: f64 = 4.0;

/// Number of cells on either side of a cell that has not yielded which must have reached the threshold with it. The pulse that travels on
/// from a fracture is half as long as the tension that was required, plus one cell: 4 cells if 5 are required.
const SUSTAINED: usize = 2;

/// Number of neighbouring cells that must have reached the threshold together to fracture a bar that has not yielded there.
pub const CELLS_TO_BREAK: usize = 2 * SUSTAINED + 1;

/// Relative difference of stresses and strains up to which they count as equal.
const EQUAL: f64 = 1e-9;

/// Cell that meets its criterion, and by which factor it exceeds it.
#[derive(Debug, Clone, Copy)]
struct Due {
    block: usize,
    cell: usize,
    share: f64,
}

impl Leapfrog {
    /// Returns the bar with fracture where it meets one of these criteria. For a bar at t = 0; `above_critical` tells whether strain grows
    /// without bound at the left and right end.
    #[must_use]
    pub fn that_breaks(mut self, criteria: Criteria, above_critical: [bool; 2]) -> Self {
        for block in &mut self.blocks {
            block.keeps_work = true;
        }
        let starts_exactly = |side| self.fans.iter().any(|fan| !fan.at_joint && fan.side == side);
        let overshoots = [0, 1].map(|side| !above_critical[side] && !starts_exactly(side));
        self.rupture = Some(Box::new(Breaking::new(criteria, overshoots)));
        self
    }

    /// Returns the fractures so far, in order of time.
    pub fn ruptures(&self) -> &[Rupture] {
        self.rupture.as_ref().map_or(&[], |breaking| &breaking.found)
    }

    /// Returns the largest tension above the threshold that acted over too few cells of this grid to fracture the bar. `None` if the bar
    /// fractured near there. Only tension before the first fracture counts, since the pulses from a fracture are as short.
    pub fn unresolved_tension(&self) -> Option<Unresolved> {
        let breaking = self.rupture.as_ref()?;
        breaking.unresolved.filter(|place| {
            let dx =
                |r: &Rupture| self.grid.segments.iter().rfind(|part| part.x0 <= r.x).map_or(0.0, |part| part.spacing);
            breaking.found.iter().all(|r| (r.x - place.x).abs() > CELLS_TO_BREAK as f64 * dx(r))
        })
    }

    /// Fractures the bar wherever a criterion is met after this step.
    pub(super) fn break_where_due(&mut self) {
        let Some(mut breaking) = self.rupture.take() else { return };
        while let Some(due) = self.most_overdue(&mut breaking) {
            self.break_at(&mut breaking, due);
        }
        self.rupture = Some(breaking);
    }

    /// Records a cell that meets its criterion but may not fracture.
    fn note_unresolved(&self, breaking: &mut Breaking, due: &Due) {
        let largest = breaking.unresolved.map_or(0.0, |place| place.share);
        if breaking.found.is_empty() && due.share > largest {
            let cell = self.blocks[due.block].cells.start + due.cell;
            let x = 0.5 * (self.grid.node(cell) + self.grid.node(cell + 1));
            breaking.unresolved = Some(Unresolved { time: self.time(), x, share: due.share });
        }
    }

    /// Returns the cell that exceeds its criterion by the largest factor, if any does.
    fn most_overdue(&self, breaking: &mut Breaking) -> Option<Due> {
        let (mut free, mut held): (Vec<Due>, Option<Due>) = (Vec::new(), None);
        for (k, block) in self.blocks.iter().enumerate() {
            let (criterion, notch) = (breaking.criteria.segments[block.segment], self.edge_notch(breaking, k));
            if !self.can_break(block, &criterion, notch) {
                continue;
            }
            for i in 0..block.sigma.len() {
                let notch = notch.at(i, block.sigma.len());
                let share = notch * self.share(k, i, &criterion);
                let due = Due { block: k, cell: i, share };
                if !Criterion::is_met(share, 1.0) {
                    continue;
                }
                if self.may_break(breaking, &due) {
                    free.push(due);
                } else if held.is_none_or(|held| share > held.share) {
                    held = Some(due);
                }
            }
        }
        let first = self.first_to_break(breaking, free);
        if let Some(held) = held.filter(|held| first.is_none_or(|first| held.share > first.share)) {
            self.note_unresolved(breaking, &held);
        }
        first
    }

    /// Returns which of the cells that are due fractures first: the one that exceeds its criterion most; of equal ones, as on a level part
    /// of the curve, the one that has flowed most, then the one nearest to the middle of the bar, then the one on whose side the bar is
    /// nearer to fracture. The order in memory never decides, since the mirrored bar must fracture at the mirrored place. Each rule
    /// compares with the largest value of all: in a chain of values that are equal to rounding pair by pair, the two ends of the bar may
    /// still differ.
    fn first_to_break(&self, breaking: &Breaking, mut due: Vec<Due>) -> Option<Due> {
        let flowed = |due: &Due| {
            let block = &self.blocks[due.block];
            block.accumulated(self.laws[block.segment].law.as_ref(), due.cell) / self.constants[block.segment].modulus
        };
        let cell = |due: &Due| self.blocks[due.block].cells.start + due.cell;
        let off_centre = |due: &Due| (2 * cell(due) + 1).abs_diff(self.grid.cells());
        keep_largest(&mut due, |due| due.share);
        keep_largest(&mut due, flowed);
        keep_largest(&mut due, |due| -(off_centre(due) as f64));
        let (&left, &right) = (due.first()?, due.last()?);
        Some(if self.right_is_nearer(breaking, cell(&left), cell(&right)) { right } else { left })
    }

    /// Returns whether, going from cell `left` to the left and from cell `right` to the right through equally loaded places, the first
    /// place that differs is nearer to fracture on the right side.
    fn right_is_nearer(&self, breaking: &Breaking, left: usize, right: usize) -> bool {
        let share = |cell: usize| {
            let (k, i) = self.block_of(cell);
            self.share(k, i, &breaking.criteria.segments[self.blocks[k].segment])
        };
        let pairs = (0..=left).rev().zip(right..self.grid.cells());
        pairs.into_iter().find_map(|(left, right)| larger(share(right), share(left))).unwrap_or(false)
    }

    /// Returns false if a quick check of the whole block shows that no cell can fracture.
    fn can_break(&self, block: &Block, criterion: &Criterion, notch: Notch) -> bool {
        let ease = notch.largest() * (1.0 + 1e-9);
        if block.stage == Stage::Elastic {
            return largest(&block.sigma) * ease >= criterion.elastic_limit();
        }
        let law = self.laws[block.segment].law.as_ref();
        match criterion.strain_threshold() {
            Some(threshold) => law.largest_strain(&block.sigma, &block.state) * ease >= threshold,
            None if block.absorbed.is_empty() => true,
            None => {
                let (sigma, work) = (&block.sigma[..], &block.absorbed[..block.sigma.len()]);
                let share = |i: usize| criterion.share(&Strained { stress: sigma[i], plastic: 0.0, work: work[i] });
                largest_of(sigma.len(), share) * ease >= 1.0
            }
        }
    }

    fn place(&self, k: usize, i: usize) -> Strained {
        let block = &self.blocks[k];
        let law = self.laws[block.segment].law.as_ref();
        Strained {
            stress: block.sigma[i],
            plastic: block.plastic_strain(law, i),
            work: block.absorbed.get(i).copied().unwrap_or(0.0),
        }
    }

    fn share(&self, k: usize, i: usize, criterion: &Criterion) -> f64 {
        criterion.share(&self.place(k, i))
    }

    /// Returns the notch factors of the joints at both edges of block `k`, 1 if there is no joint.
    fn edge_notch(&self, breaking: &Breaking, k: usize) -> Notch {
        let segment = self.blocks[k].segment;
        let joints = &breaking.criteria.joints;
        let at_left = k > 0 && self.blocks[k - 1].segment != segment;
        let at_right = self.blocks.get(k + 1).is_some_and(|next| next.segment != segment);
        Notch([if at_left { joints[segment - 1] } else { 1.0 }, if at_right { joints[segment] } else { 1.0 }])
    }

    /// Returns whether a cell that meets its criterion may fracture. A cell that has yielded fractures by strain or energy only while it
    /// flows; any other cell only if its tension is not a mere pulse. No cell fractures next to a wave that is about to release it.
    fn may_break(&self, breaking: &Breaking, due: &Due) -> bool {
        let block = &self.blocks[due.block];
        let law = self.laws[block.segment].law.as_ref();
        let flows = block.flow.get(due.cell).is_some_and(|&flow| flow != 0.0)
            || block.stage == Stage::Plastic && law.flows(&block.state, due.cell);
        let criterion = &breaking.criteria.segments[block.segment];
        let fresh = criterion.cause() == Cause::Spall || block.accumulated(law, due.cell) == 0.0;
        if !(if fresh { self.is_sustained(breaking, due) } else { flows && due.share >= self.overshoot(breaking, due) })
        {
            return false;
        }
        let node = block.cells.start + due.cell;
        if self.is_parted(breaking, node) && self.is_parted(breaking, node + 1) {
            return false;
        }
        let place = (block.cells.start + due.cell) as f64 + 0.5;
        let pace = self.constants[block.segment].courant;
        breaking.nodes.iter().all(|&(node, step)| {
            let distance = (place - node as f64).abs();
            let ahead = distance - pace * (self.step - step) as f64;
            distance > SHORTEST && !(-BEHIND..=AHEAD).contains(&ahead)
        })
    }

    /// Returns the factor by which the scheme may have overestimated the strain or work of a cell; 1 if the steps resolve the rate of flow.
    fn overshoot(&self, breaking: &Breaking, due: &Due) -> f64 {
        if self.blocks[due.block].flow[due.cell] == 0.0 {
            return 1.0;
        }
        let cell = self.blocks[due.block].cells.start + due.cell;
        let [left, right] = breaking.overshoots;
        let near = left && cell < NEAR_END && self.left.pulls()
            || right && cell + NEAR_END >= self.grid.cells() && self.right.pulls();
        if near { OVERSHOOT } else { 1.0 }
    }

    /// Returns whether the neighbours of a cell on both sides, [`SUSTAINED`] each, have reached the threshold, too. The nodes between them
    /// must be intact; at an end that pulls, the cells on the bar's side are sufficient. Beyond a joint the forces are compared, as
    /// sections and materials differ there.
    fn is_sustained(&self, breaking: &Breaking, due: &Due) -> bool {
        let block = &self.blocks[due.block];
        let criterion = &breaking.criteria.segments[block.segment];
        let (cell, own) = (block.cells.start + due.cell, self.share(due.block, due.cell, criterion));
        let holds = |node: usize, beyond: Option<usize>| {
            let cell = beyond.filter(|&cell| cell < self.grid.cells())?;
            let (k, i) = self.block_of(cell);
            let part = if self.blocks[k].segment == block.segment {
                self.share(k, i, criterion) / own
            } else {
                (self.force(k, i) / self.force(due.block, due.cell)).max(0.0).powi(criterion.power_of_stress())
            };
            let met = Criterion::is_met(due.share * part, 1.0);
            Some(met && !self.is_parted(breaking, node))
        };
        let to_left = (1..=SUSTAINED).map_while(|k| holds((cell + 1).saturating_sub(k), cell.checked_sub(k)));
        let to_right = (1..=SUSTAINED).map_while(|k| holds(cell + k, Some(cell + k)));
        let reaches_end = cell < SUSTAINED && self.is_parted(breaking, 0)
            || cell + SUSTAINED >= self.grid.cells() && self.is_parted(breaking, self.grid.cells());
        !reaches_end && to_left.chain(to_right).all(|met| met)
    }

    /// Returns the force in a cell, N, tension positive.
    fn force(&self, k: usize, i: usize) -> f64 {
        let block = &self.blocks[k];
        block.sigma[i] * block.area(i) * self.constants[block.segment].area
    }

    /// Returns the block of a cell, and the position of the cell in it.
    fn block_of(&self, cell: usize) -> (usize, usize) {
        let k = self.blocks.partition_point(|b| b.cells.end <= cell);
        (k, cell - self.blocks[k].cells.start)
    }

    fn break_at(&mut self, breaking: &mut Breaking, due: Due) {
        let place = self.place(due.block, due.cell);
        let segment = self.blocks[due.block].segment;
        let node = self.node_to_part(breaking, due);
        let now = self.energies();
        let criterion = &breaking.criteria.segments[segment];
        let cells = self.grid.cells();
        let site = match node {
            0 => Site::Left,
            n if n == cells => Site::Right,
            n => self
                .grid
                .segments
                .iter()
                .position(|part| part.cells.end == n)
                .map_or(Site::Inside(segment), Site::Joint),
        };
        breaking.found.push(Rupture {
            time: self.time(),
            x: self.grid.node(node),
            site,
            segment,
            cause: criterion.cause(),
            stress: place.stress,
            strain: criterion.strain(&place),
            absorbed: criterion.absorbed(&place),
            bar_absorbed: now.elastic + now.plastic + now.heat,
        });
        breaking.nodes.push((node, self.step));
        match site {
            Site::Left => {
                breaking.ends_gone[0] = true;
                self.left.release();
            }
            Site::Right => {
                breaking.ends_gone[1] = true;
                self.right.release();
            }
            _ => self.part(node),
        }
        self.end_fans(segment, site);
    }

    /// Ends the fans that a fracture in their segment, or at its end or joint, invalidates. Those of a joint are imposed once more, and its
    /// sides then give back the impulse that they owe. What those of an end owe is recorded as an impulse of the end.
    fn end_fans(&mut self, segment: usize, site: Site) {
        let is_adjacent = |fan: &StartingFan| match site {
            Site::Joint(k) => fan.segment == k || fan.segment == k + 1,
            _ => fan.segment == segment,
        };
        let joint_of = |fan: &StartingFan| fan.segment + fan.side;
        let joints: Vec<usize> =
            self.fans.iter().filter(|fan| fan.at_joint && is_adjacent(fan)).map(joint_of).collect();
        for fan in self.fans.iter_mut().filter(|fan| fan.at_joint && joints.contains(&joint_of(fan))) {
            fan.end_after(self.step);
        }
        let (left, right) = (&mut self.left, &mut self.right);
        self.fans.retain(|fan| {
            let stays = fan.at_joint || !is_adjacent(fan);
            if !stays {
                let end = if fan.side == 0 { &mut *left } else { &mut *right };
                end.record_impulse(fan.unbalanced_impulse);
            }
            stays
        });
    }

    /// Returns the node at which the bar separates. A node has the number of the cell to its right.
    fn node_to_part(&self, breaking: &Breaking, due: Due) -> usize {
        let block = &self.blocks[due.block];
        let cell = block.cells.start + due.cell;
        let nodes = [cell, cell + 1];
        let whole = nodes.map(|node| !self.is_parted(breaking, node));
        let weak = nodes.map(|node| node == 0 || node == self.grid.cells() || self.is_joint(node));
        let sides = [0, 1].map(|k| {
            let neighbour =
                if k == 0 { cell.checked_sub(1) } else { Some(cell + 1).filter(|&c| c < self.grid.cells()) };
            let share = neighbour.map_or(0.0, |c| {
                let (k, i) = self.block_of(c);
                self.share(k, i, &breaking.criteria.segments[self.blocks[k].segment])
            });
            if !whole[k] {
                -1.0
            } else if weak[k] {
                f64::INFINITY
            } else {
                share
            }
        });
        let off_centre = nodes.map(|node| (2 * node).abs_diff(self.grid.cells()));
        let right = larger(sides[1], sides[0]).unwrap_or_else(|| match off_centre[1].cmp(&off_centre[0]) {
            Ordering::Equal => self.right_is_nearer(breaking, cell, cell),
            order => order == Ordering::Less,
        });
        nodes[usize::from(right)]
    }

    fn is_joint(&self, node: usize) -> bool {
        self.grid.segments.iter().any(|part| part.cells.end == node)
    }

    /// Returns whether nothing holds the bar together at a node: two faces, or an end that does not pull.
    fn is_parted(&self, breaking: &Breaking, node: usize) -> bool {
        if node == 0 {
            return breaking.ends_gone[0] || !self.left.pulls();
        }
        if node == self.grid.cells() {
            return breaking.ends_gone[1] || !self.right.pulls();
        }
        self.contacts.iter().any(|contact| contact.cell == node)
    }

    /// Splits a node into two faces that start with its velocity half a step before the current time.
    fn part(&mut self, node: usize) {
        let mut k = self.blocks.partition_point(|b| b.cells.end < node);
        let at = node - self.blocks[k].cells.start;
        let velocity = if at < self.blocks[k].sigma.len() { self.split_block(k, at) } else { self.edges[k].before() };
        k = self.blocks.partition_point(|b| b.cells.end < node);
        self.edges[k].part();
        let pair = &self.blocks[k..=k + 1];
        let (place, cells) = ([k, pair[0].segment, node], adjacent_cell_data(pair, &self.constants, self.grid.dt));
        let yields = [pair[0].segment, pair[1].segment].map(|k| self.laws[k].yield_stress);
        let mut contact = Contact::new(place, joint::Contact::broken(), [velocity; 2], cells, yields, self.grid.dt);
        contact.part([last(&pair[0].sigma), pair[1].sigma[0]], self.grid.dt);
        let place = self.contacts.partition_point(|other| other.edge < k);
        self.contacts.insert(place, contact);
        self.share_edges();
    }

    /// Splits block `k` in two, with an edge between them. Returns the velocity of that node half a step before the current time, m/s.
    fn split_block(&mut self, k: usize, at: usize) -> f64 {
        let block = &mut self.blocks[k];
        let gain = self.constants[block.segment].velocity_gain;
        let velocity = block.v[at] - block.velocity_increment(gain, at);
        let right = block.split_off(at);
        self.blocks.insert(k + 1, right);
        self.edges.insert(k, Edge::EMPTY);
        for contact in &mut self.contacts {
            contact.edge += usize::from(contact.edge >= k);
        }
        velocity
    }
}

/// Returns whether `a` is larger than `b`; `None` if both are equal to rounding.
fn larger(a: f64, b: f64) -> Option<bool> {
    let rounding = (EQUAL * a.abs().max(b.abs())).min(f64::MAX);
    let equal = a == b || (a - b).abs() <= rounding;
    (!equal).then_some(a > b)
}

/// Keeps the cells with the largest `value`, to rounding, in their order.
fn keep_largest(due: &mut Vec<Due>, value: impl Fn(&Due) -> f64) {
    let largest = due.iter().map(&value).fold(f64::NEG_INFINITY, f64::max);
    due.retain(|due| larger(largest, value(due)).is_none());
}

/// Notch factors at the left and right edge of a block.
#[derive(Debug, Clone, Copy)]
struct Notch([f64; 2]);

impl Notch {
    fn at(self, i: usize, cells: usize) -> f64 {
        let left = if i == 0 { self.0[0] } else { 1.0 };
        let right = if i + 1 == cells { self.0[1] } else { 1.0 };
        left.max(right)
    }

    fn largest(self) -> f64 {
        self.0[0].max(self.0[1])
    }
}

fn largest(values: &[f64]) -> f64 {
    largest_of(values.len(), |i| values[i])
}

/// Returns the largest value, at least 0, with lanes that the processor evaluates in parallel.
#[inline(always)]
fn largest_of(count: usize, value: impl Fn(usize) -> f64) -> f64 {
    let mut top = [0.0_f64; LANES];
    let whole = count - count % LANES;
    for start in (0..whole).step_by(LANES) {
        for (lane, top) in top.iter_mut().enumerate() {
            let v = value(start + lane);
            *top = if v > *top { v } else { *top };
        }
    }
    (whole..count).map(value).chain(top).fold(0.0, f64::max)
}

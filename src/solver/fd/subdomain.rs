//! Stages of a step on the blocks of a bar and the nodes between them; see [`super::sweep`] for their order.

use std::ops::Range;

use super::block::{Block, BlockLaw, Scratch, WATCHED};
use super::cell_value::cell_value;
use super::contact::Contact;
use super::edge::{Edge, last};
use super::end_node::EndNode;
use super::grid_filter::Neighbour;
use super::nodes::Nodes;
use super::segment::{Constants, SegmentLaw};

/// Data that all blocks share and that do not change during a sweep.
#[derive(Clone, Copy)]
pub(super) struct Common<'a> {
    pub laws: &'a [SegmentLaw],
    pub constants: &'a [Constants],
    pub dt: f64,
    /// Number of blocks of the whole bar.
    pub blocks: usize,
    /// Number of steps before this sweep.
    pub step: usize,
    /// Whether elastic blocks may be carried as waves, see [`super::travelling`].
    pub travels: bool,
    /// Blocks of which something is logged in every step, in order; `None` if nothing is logged, not even the ends.
    pub watched: Option<&'a [usize]>,
}

/// Neighbouring blocks, the edges between them, and the ends of the bar if the blocks include them.
pub(super) struct Subdomain<'a> {
    pub common: Common<'a>,
    /// Number of the first block.
    pub first: usize,
    pub blocks: &'a mut [Block],
    /// Edges between the blocks, one fewer than blocks.
    pub edges: &'a mut [Edge],
    /// Joints that can open between the blocks, in order.
    pub contacts: &'a mut [Contact],
    pub ends: [Option<&'a mut EndNode>; 2],
}

impl Subdomain<'_> {
    /// Advances only the stresses of all blocks in a step.
    pub fn advance_stresses(&mut self, step: usize, scratch: &mut Scratch) {
        let common = self.common;
        for block in &mut *self.blocks {
            block.advance_stresses(common.law(block, step), scratch);
            block.note_yield(step);
        }
    }

    /// Advances the stresses and the inner nodes of these blocks in a step.
    pub fn advance(&mut self, blocks: Range<i64>, step: usize, scratch: &mut Scratch) {
        let (common, blocks) = (self.common, self.local(blocks));
        for block in self.blocks[blocks].iter_mut().filter(|block| !block.at_rest()) {
            block.advance(common.law(block, step), scratch);
            block.note_yield(step);
        }
    }

    /// Updates the nodes of these edges in a step, from the stresses on both sides.
    pub fn update_interfaces(&mut self, edges: Range<i64>, step: usize) {
        if edges.is_empty() {
            return;
        }
        let time = step as f64 * self.common.dt;
        if edges.start == 0
            && let Some(left) = &mut self.ends[0]
        {
            left.advance(time, self.blocks[0].sigma[0], self.blocks[0].flowed_lately());
            self.blocks[0].set_edge(0, left.velocity_after());
        }
        for k in self.inner(&edges) {
            let (edge, [left, right]) = (&mut self.edges[k], pair(self.blocks, k));
            if edge.still && left.rests_at(1) && right.rests_at(0) {
                continue;
            }
            edge.advance(last(&left.sigma), right.sigma[0]);
            left.set_edge(1, edge.after);
            right.set_edge(0, edge.after);
        }
        for contact in &mut *self.contacts {
            if edges.contains(&(contact.edge as i64 + 1)) {
                let [left, right] = pair(self.blocks, contact.edge - self.first);
                let flows = left.flowed_lately() || right.flowed_lately();
                contact.advance([last(&left.sigma), right.sigma[0]], flows, self.common.dt);
                left.set_edge(1, contact.velocities(0)[1]);
                right.set_edge(0, contact.velocities(1)[1]);
            }
        }
        if edges.end > self.common.blocks as i64
            && let (Some(right), Some(block)) = (&mut self.ends[1], self.blocks.last_mut())
        {
            right.advance(time, last(&block.sigma), block.flowed_lately());
            block.set_edge(1, right.velocity_after());
        }
    }

    /// Damps grid-scale oscillations of the velocities, see [`super::grid_filter`].
    pub fn damp(&mut self, blocks: Range<i64>, step: usize, scratch: &mut Scratch) {
        for k in self.local(blocks) {
            self.note_reach_of_filter(k, step);
            if self.blocks[k].at_rest() || self.blocks[k].filter_from_step > step {
                continue;
            }
            let shocks_beside = self.shocks_beside(k);
            let outside = self.nodes_outside(k);
            let segment = self.blocks[k].segment;
            let (law, c) = (&self.common.laws[segment], &self.common.constants[segment]);
            let outer = c.filter(true).takes_shocks().then(|| self.velocities_damped(k, [0.0; 2]));
            let block = &mut self.blocks[k];
            if shocks_beside {
                block.start_meeting_shocks(law.law.as_ref());
            }
            if block.waves.is_some() {
                continue;
            }
            let impulses = block.apply_grid_filter(law, c, outside, outer.unwrap_or_default(), scratch);
            if let Some(impulses) = impulses.filter(|_| c.filter(self.blocks[k].meets_shocks).takes_shocks()) {
                self.note_shocks(k, impulses);
            }
        }
    }

    /// Returns whether block `k` meets shocks from this step on, as it or a neighbour has come near the part of its curve that stiffens.
    fn shocks_beside(&self, k: usize) -> bool {
        let Block { segment, meets_shocks, .. } = self.blocks[k];
        let law = &self.common.laws[segment];
        let near = &self.blocks[k.saturating_sub(1)..self.blocks.len().min(k + 2)];
        !meets_shocks && near.iter().any(|block| block.segment == segment && law.has_shocks(block.reached, 0.0))
    }

    /// Records the energy that these impulses of the filter took in cells of block `k` inside shocks.
    fn note_shocks(&mut self, k: usize, impulses: &[f64]) {
        let segment = self.blocks[k].segment;
        let (law, c) = (&self.common.laws[segment], &self.common.constants[segment]);
        if let Some(shocks) = self.blocks[k].find_shocks(law, self.stiffenings_beside(k, law)) {
            let outer = self.velocities_damped(k, [impulses[0], -impulses[impulses.len() - 1]]);
            self.blocks[k].note_shocks(&shocks, c.velocity_gain, outer, impulses);
        }
    }

    /// Returns the velocities (m/s) of the nodes at both edges of block `k` which, times the impulses of the filter in its cells, are the
    /// energy that the nodes lose. The filter changes the velocities by `changes`.
    fn velocities_damped(&self, k: usize, changes: [f64; 2]) -> [f64; 2] {
        let block = &self.blocks[k];
        let last = block.sigma.len() - 1;
        let ends = self.ends.each_ref().map(Option::as_deref);
        let inner = Nodes { first: self.first, edges: self.edges, contacts: self.contacts, ends }.edge_velocities(k);
        let outer = [(k == 0, 0, 0), (k + 1 == self.blocks.len(), 1, last)];
        outer.map(|(is_outer, side, cell)| match ends[side].filter(|_| is_outer) {
            Some(end) => end.velocity_damped(2.0 * changes[side], block.sigma[cell]),
            None => inner[side] + 0.5 * changes[side],
        })
    }

    /// Starts the filter of block `k` with the next step if a neighbour's acts in this step. The delay allows blocks to be visited in any
    /// order.
    fn note_reach_of_filter(&mut self, k: usize, step: usize) {
        let damped =
            |k: Option<usize>| k.and_then(|k| self.blocks.get(k)).is_some_and(|block| block.filter_from_step <= step);
        if self.blocks[k].filter_from_step > step && (damped(k.checked_sub(1)) || damped(Some(k + 1))) {
            self.blocks[k].filter_from_step = step + 1;
        }
    }

    /// Applies the damping of the nodes between blocks, and of those at the ends. The latter have half the mass, and therefore twice the
    /// velocity change.
    pub fn finish(&mut self, edges: Range<i64>) {
        if edges.is_empty() {
            return;
        }
        for k in self.inner(&edges) {
            let (edge, [left, right]) = (&mut self.edges[k], pair(self.blocks, k));
            let impulses = [left.impulses_at_edges[1], right.impulses_at_edges[0]];
            if impulses == [0.0; 2] {
                continue;
            }
            if let Some(contact) = self.contacts.iter_mut().find(|contact| contact.edge == self.first + k) {
                contact.damp(impulses, self.common.dt);
                left.set_edge(1, contact.velocities(0)[1]);
                right.set_edge(0, contact.velocities(1)[1]);
            } else if edge.damp(impulses) {
                left.set_edge(1, edge.after);
                right.set_edge(0, edge.after);
            }
        }
        if edges.start == 0
            && let Some(end) = &mut self.ends[0]
        {
            let block = &mut self.blocks[0];
            end.damp(2.0 * block.impulses_at_edges[0], block.sigma[0]);
            block.set_edge(0, end.velocity_after());
        }
        if edges.end > self.common.blocks as i64
            && let (Some(end), Some(block)) = (&mut self.ends[1], self.blocks.last_mut())
        {
            end.damp(-2.0 * block.impulses_at_edges[1], last(&block.sigma));
            block.set_edge(1, end.velocity_after());
        }
    }

    /// Logs what is watched in these blocks and at the ends.
    pub fn note(&mut self, blocks: Range<i64>) {
        let Some(watched) = self.common.watched.filter(|_| !blocks.is_empty()) else { return };
        for &k in watched.iter().filter(|&&k| blocks.contains(&(k as i64))) {
            self.note_block(k - self.first);
        }
        let due = [blocks.start == 0, blocks.end == self.common.blocks as i64];
        let beside = [self.blocks.first(), self.blocks.last()];
        for ((end, due), block) in self.ends.iter_mut().zip(due).zip(beside) {
            if let (Some(end), Some(block)) = (end.as_mut().filter(|_| due), block) {
                end.note(!block.flowed_lately());
            }
        }
    }

    fn note_block(&mut self, k: usize) {
        if self.blocks[k].repeat_log() {
            return;
        }
        let (block, last) = (&self.blocks[k], self.blocks[k].sigma.len() - 1);
        let outer = if block.watched.iter().any(|&i| i == 0 || i == last) {
            let ends = self.ends.each_ref().map(Option::as_deref);
            Nodes { first: self.first, edges: self.edges, contacts: self.contacts, ends }.edge_velocities(k)
        } else {
            // Not read: no watched cell is at an edge of the block.
            [f64::NAN; 2]
        };
        let block = &mut self.blocks[k];
        let law = self.common.laws[block.segment].law.as_ref();
        let constants = &self.common.constants[block.segment];
        for at in 0..block.watched.len() {
            let i = block.watched[at];
            let now = WATCHED.map(|quantity| cell_value(quantity, block, law, constants, outer, i));
            block.log.push(now);
        }
    }

    /// Returns the neighbours of block `k` on both sides: the inner nodes of the neighbouring blocks before these are damped, if they
    /// belong to the same segment. At an end that is not held the bar is continued by its mirror image.
    fn nodes_outside(&self, k: usize) -> [Neighbour; 2] {
        let block = &self.blocks[k];
        let gain = self.common.constants[block.segment].velocity_gain;
        let flow = |side: usize| if block.flows() { block.flow_at_edge(side) } else { 0.0 };
        let end = |side: usize| match &self.ends[side] {
            Some(end_node) if end_node.is_held() => Neighbour::Held,
            Some(end_node) => end_node.supported_by_load(flow(side)).map_or(Neighbour::Mirror, Neighbour::Loaded),
            None => Neighbour::Joint,
        };
        let parted = |edge: usize| self.contacts.iter().any(|contact| contact.edge == self.first + edge);
        let inside = |other: &Block, edge: usize, side: usize| {
            let whole = other.segment == block.segment && !parted(edge);
            if whole { Neighbour::Node(other.undamped(side, gain)) } else { Neighbour::Joint }
        };
        let left = match k.checked_sub(1) {
            None => end(0),
            Some(other) => inside(&self.blocks[other], other, 1),
        };
        let right = match self.blocks.get(k + 1) {
            None => end(1),
            Some(other) => inside(other, k, 0),
        };
        [left, right]
    }

    /// Returns how many stiffening knots of the curve the cells on both sides of block `k` have passed; where the segment ends, its own
    /// outermost cell is used.
    fn stiffenings_beside(&self, k: usize, law: &SegmentLaw) -> [usize; 2] {
        [(k.checked_sub(1), 1), (Some(k + 1), 0)].map(|(other, side)| {
            let other =
                other.and_then(|other| self.blocks.get(other)).filter(|other| other.segment == self.blocks[k].segment);
            other.map_or_else(
                || self.blocks[k].stiffenings_at_edge(law, 1 - side),
                |other| other.stiffenings_inside(law, side),
            )
        })
    }

    /// Converts block numbers to indices in the subdomain.
    fn local(&self, blocks: Range<i64>) -> Range<usize> {
        let at = |k: i64| (k as usize).saturating_sub(self.first);
        if blocks.is_empty() { 0..0 } else { at(blocks.start)..at(blocks.end) }
    }

    /// Returns the edges among these that lie between two blocks, as indices in the subdomain.
    fn inner(&self, edges: &Range<i64>) -> Range<usize> {
        let first = self.first as i64;
        let from = (edges.start - first - 1).max(0) as usize;
        let to = (edges.end - first - 1).clamp(0, self.edges.len() as i64) as usize;
        from.min(to)..to
    }
}

impl<'a> Common<'a> {
    /// Returns the data that a block needs in a step.
    fn law(self, block: &Block, step: usize) -> BlockLaw<'a> {
        let (law, constants) = (&self.laws[block.segment], &self.constants[block.segment]);
        BlockLaw {
            law: law.law.as_ref(),
            stress_gain: constants.stress_gain,
            velocity_gain: constants.velocity_gain,
            yield_stress: law.yield_stress,
            end: &law.end,
            filter: constants.filter(block.meets_shocks),
            travels: self.travels && constants.travels,
            step,
        }
    }
}

/// Returns the blocks on both sides of edge `k`.
fn pair(blocks: &mut [Block], k: usize) -> [&mut Block; 2] {
    let (left, right) = blocks.split_at_mut(k + 1);
    [&mut left[k], &mut right[0]]
}

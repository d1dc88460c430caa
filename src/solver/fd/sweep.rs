//! The order in which the blocks of a bar take their steps.
//!
//! A step is five acts, each on a block or on the edge to its left (edges 0 and B of B blocks are the bar's ends):
//!
//! | act | of | needs, of the same step |
//! |---|---|---|
//! | advance | a block: its stresses, then its inner nodes | the step before finished on both its edges |
//! | meet | an edge: its node, from the stresses on both sides | both neighbours advanced |
//! | damp | a block: the ripples of its inner nodes | both its edges met, both neighbours advanced |
//! | finish | an edge: its node's share of the damping | both neighbours damped |
//! | note | a block: what is logged of its cells | both its edges finished |
//!
//! So a bar need not take one step after the other: a few blocks that stay in the first-level cache take a step, then their
//! neighbours two blocks to the left the next one, and so on, step after step; then the same for the blocks to the right,
//! and a long bar comes through the cache once for many steps. On several threads each has a part of the bar, on which it
//! steps inwards from what it does not know of its neighbours; the triangles that are left between two parts are then
//! filled. Every act is the same in any order, and so is every bit of the result.

use std::ops::Range;

use super::block::{Block, BlockLaw, Scratch, WATCHED};
use super::contact::Contact;
use super::device::Device;
use super::edge::Edge;
use super::leapfrog::{Constants, SegmentLaw, last};
use super::readings::reading;

/// Most steps in one go. Twice as many blocks pass through the second-level cache in that time.
const DEPTH: usize = 32;

/// Blocks that take a step before those to their left take the next one: as many as the first-level cache holds.
const TILE: i64 = 8;

/// Blocks that an act of the next step stays behind this one's.
const LAG: i64 = 2;

/// Fewest blocks for a thread of its own: fewer cost less than to wake it.
const PART: usize = 64;

/// Blocks of a part for every step of a sweep: parts shrink by two blocks a step on either side, and the triangles between
/// them, which fewer threads fill, are to be a small share.
const PART_PER_STEP: usize = 16;

/// How many parts of a bar of so many blocks are swept side by side on so many threads, and for how many steps in one go.
pub(super) fn division(blocks: usize, threads: usize) -> (usize, usize) {
    match threads.min(blocks / PART) {
        0 | 1 => (1, DEPTH),
        parts => (parts, DEPTH.min(blocks / parts / PART_PER_STEP)),
    }
}

/// Acts to be done, by numbers of blocks and edges.
#[derive(Debug, Clone)]
struct Acts {
    advance: Range<i64>,
    meet: Range<i64>,
    damp: Range<i64>,
    finish: Range<i64>,
    note: Range<i64>,
}

impl Acts {
    /// Of blocks `a..z` where all to the left is done in this step, and nothing to the right.
    fn following(a: i64, z: i64) -> Self {
        Self { advance: a..z, meet: a..z, damp: a - 1..z - 1, finish: a - 1..z - 1, note: a - 2..z - 2 }
    }

    /// Of a bar of `blocks` blocks, all.
    fn all(blocks: i64) -> Self {
        Self { advance: 0..blocks, meet: 0..blocks + 1, damp: 0..blocks, finish: 0..blocks + 1, note: 0..blocks }
    }

    /// What can be done from block `a` on, where nothing is known of those to its left.
    fn right_of(a: i64) -> Self {
        let end = i64::MAX;
        Self { advance: a..end, meet: a + 1..end, damp: a + 1..end, finish: a + 2..end, note: a + 2..end }
    }

    /// What can be done up to block `z`, not included, where nothing is known of it.
    fn left_of(z: i64) -> Self {
        let start = i64::MIN;
        Self { advance: start..z, meet: start..z, damp: start..z - 1, finish: start..z - 1, note: start..z - 2 }
    }

    /// What is left between [`Self::left_of`] block `a` and [`Self::right_of`] block `z`.
    fn between(a: i64, z: i64) -> Self {
        Self { advance: a..z, meet: a..z + 1, damp: a - 1..z + 1, finish: a - 1..z + 2, note: a - 2..z + 2 }
    }

    fn and(&self, other: &Self) -> Self {
        let common = |a: &Range<i64>, b: &Range<i64>| a.start.max(b.start)..a.end.min(b.end);
        Self {
            advance: common(&self.advance, &other.advance),
            meet: common(&self.meet, &other.meet),
            damp: common(&self.damp, &other.damp),
            finish: common(&self.finish, &other.finish),
            note: common(&self.note, &other.note),
        }
    }
}

/// What all blocks share and none changes.
#[derive(Clone, Copy)]
pub(super) struct Common<'a> {
    pub laws: &'a [SegmentLaw],
    pub constants: &'a [Constants],
    pub dt: f64,
    /// Blocks of the whole bar.
    pub blocks: usize,
    /// Steps taken before this sweep.
    pub step: usize,
    /// Something is logged.
    pub watched: bool,
}

/// Neighbouring blocks, the edges between them and what is at the bar's ends, as far as they have them.
pub(super) struct Stretch<'a> {
    pub common: Common<'a>,
    /// Number of the first block.
    pub first: usize,
    pub blocks: &'a mut [Block],
    /// Edges between the blocks: one fewer.
    pub edges: &'a mut [Edge],
    /// Joints that can open, in order, those between the blocks.
    pub contacts: &'a mut [Contact],
    pub ends: [Option<&'a mut Device>; 2],
}

impl Stretch<'_> {
    /// Takes the bar `steps` steps on in so many parts, as [`division`] allows.
    pub fn sweep(&mut self, steps: usize, parts: usize) {
        if parts == 1 {
            return self.sweep_tiles(steps);
        }
        let at = self.blocks.len() * (parts / 2) / parts;
        let middle = (self.first + at) as i64;
        let [mut left, mut right] = self.split(at);
        rayon::join(|| left.sweep(steps, parts / 2), || right.sweep(steps, parts - parts / 2));
        let mut scratch = Scratch::new();
        for s in 0..steps {
            let lag = LAG * s as i64;
            self.act(s, &Acts::between(middle - lag, middle + lag), &mut scratch);
        }
    }

    /// Two stretches, without the edge between them.
    fn split(&mut self, at: usize) -> [Stretch<'_>; 2] {
        let (blocks, more_blocks) = self.blocks.split_at_mut(at);
        let (edges, more_edges) = self.edges.split_at_mut(at - 1);
        let border = self.first + at;
        let (contacts, more_contacts) = {
            let k = self.contacts.partition_point(|contact| contact.edge + 1 < border);
            let (here, beyond) = self.contacts.split_at_mut(k);
            let skipped = usize::from(beyond.first().is_some_and(|contact| contact.edge + 1 == border));
            (here, &mut beyond[skipped..])
        };
        let [left, right] = self.ends.each_mut().map(Option::as_deref_mut);
        let common = self.common;
        let first = self.first;
        [
            Stretch { common, first, blocks, edges, contacts, ends: [left, None] },
            Stretch {
                common,
                first: border,
                blocks: more_blocks,
                edges: &mut more_edges[1..],
                contacts: more_contacts,
                ends: [None, right],
            },
        ]
    }

    /// All that can be done of these steps without knowing what is beyond the stretch.
    fn sweep_tiles(&mut self, steps: usize) {
        let (from, to) = (self.first as i64, (self.first + self.blocks.len()) as i64);
        let at_start = self.ends[0].is_some();
        let at_end = self.ends[1].is_some();
        let mut scratch = Scratch::new();
        let mut tile = from;
        while tile - LAG * (steps as i64 - 1) <= to + LAG {
            for s in 0..steps {
                let lag = LAG * s as i64;
                let mut acts = Acts::following(tile - lag, tile - lag + TILE);
                if !at_start {
                    acts = acts.and(&Acts::right_of(from + lag));
                }
                if !at_end {
                    acts = acts.and(&Acts::left_of(to - lag));
                }
                self.act(s, &acts, &mut scratch);
            }
            tile += TILE;
        }
    }

    /// Acts of step number `s` of this sweep, as far as the bar has them.
    fn act(&mut self, s: usize, acts: &Acts, scratch: &mut Scratch) {
        let acts = acts.and(&Acts::all(self.common.blocks as i64));
        let step = self.common.step + s + 1;
        self.advance(acts.advance, step, scratch);
        self.meet(acts.meet, step);
        self.damp(acts.damp, step, scratch);
        self.finish(acts.finish);
        self.note(acts.note);
    }

    /// The stresses and inner nodes of all blocks in a step, and the nodes between them.
    pub fn advance_and_meet(&mut self, step: usize, scratch: &mut Scratch) {
        let Acts { advance, meet, .. } = Acts::all(self.common.blocks as i64);
        self.advance(advance, step, scratch);
        self.meet(meet, step);
    }

    /// The edges of all blocks at t = 0.
    pub fn meet_all(&mut self) {
        self.meet(Acts::all(self.common.blocks as i64).meet, 0);
    }

    /// The stresses alone of all blocks in a step.
    pub fn advance_stresses(&mut self, step: usize, scratch: &mut Scratch) {
        let common = self.common;
        for block in &mut *self.blocks {
            block.advance_stresses(common.law(block.segment), scratch);
            block.note_yield(step);
        }
    }

    /// The ripple damping of the whole bar in a step.
    pub fn damp_and_finish(&mut self, step: usize, scratch: &mut Scratch) {
        let Acts { damp, finish, note, .. } = Acts::all(self.common.blocks as i64);
        self.damp(damp, step, scratch);
        self.finish(finish);
        self.note(note);
    }

    fn advance(&mut self, blocks: Range<i64>, step: usize, scratch: &mut Scratch) {
        let (common, blocks) = (self.common, self.local(blocks));
        for block in &mut self.blocks[blocks] {
            block.advance(common.law(block.segment), scratch);
            block.note_yield(step);
        }
    }

    fn meet(&mut self, edges: Range<i64>, step: usize) {
        if edges.is_empty() {
            return;
        }
        let time = step as f64 * self.common.dt;
        if edges.start == 0
            && let Some(left) = &mut self.ends[0]
        {
            left.advance(time, self.blocks[0].sigma[0]);
            self.blocks[0].set_edge(0, left.velocity_after());
        }
        for k in self.inner(&edges) {
            let (edge, [left, right]) = (&mut self.edges[k], pair(self.blocks, k));
            if edge.still && left.at_rest && right.at_rest {
                continue;
            }
            edge.advance(last(&left.sigma), right.sigma[0]);
            left.set_edge(1, edge.after);
            right.set_edge(0, edge.after);
        }
        for contact in &mut *self.contacts {
            if edges.contains(&(contact.edge as i64 + 1)) {
                let [left, right] = pair(self.blocks, contact.edge - self.first);
                contact.advance([last(&left.sigma), right.sigma[0]], self.common.dt);
                left.set_edge(1, contact.left.after);
                right.set_edge(0, contact.right.after);
            }
        }
        if edges.end > self.common.blocks as i64
            && let (Some(right), Some(block)) = (&mut self.ends[1], self.blocks.last_mut())
        {
            right.advance(time, last(&block.sigma));
            block.set_edge(1, right.velocity_after());
        }
    }

    /// Takes grid-scale ripples out of the velocities, see [`super::ripple`].
    fn damp(&mut self, blocks: Range<i64>, step: usize, scratch: &mut Scratch) {
        for k in self.local(blocks) {
            if self.blocks[k].damps_from > step {
                let near = [k.checked_sub(1), Some(k + 1)].map(|k| Some(self.blocks.get(k?)?.damps_from));
                self.blocks[k].note_ripples(near);
            }
            if self.blocks[k].at_rest || self.blocks[k].damps_from > step {
                continue;
            }
            let outside = self.nodes_outside(k);
            let block = &mut self.blocks[k];
            let c = &self.common.constants[block.segment];
            block.damp_ripples(c.velocity_gain, c.rounding, outside, scratch);
        }
    }

    /// The part of the damping of the nodes between blocks, and of those at the ends: these have half the mass, and so
    /// twice the velocity change.
    fn finish(&mut self, edges: Range<i64>) {
        if edges.is_empty() {
            return;
        }
        for k in self.inner(&edges) {
            let (edge, [left, right]) = (&mut self.edges[k], pair(self.blocks, k));
            if edge.damp(left.handed_at_edges[1], right.handed_at_edges[0]) {
                left.set_edge(1, edge.after);
                right.set_edge(0, edge.after);
            }
        }
        if edges.start == 0
            && let Some(end) = &mut self.ends[0]
        {
            let block = &mut self.blocks[0];
            end.damp(2.0 * block.handed_at_edges[0], block.sigma[0]);
            block.set_edge(0, end.velocity_after());
        }
        if edges.end > self.common.blocks as i64
            && let (Some(end), Some(block)) = (&mut self.ends[1], self.blocks.last_mut())
        {
            end.damp(-2.0 * block.handed_at_edges[1], last(&block.sigma));
            block.set_edge(1, end.velocity_after());
        }
    }

    /// Logs what is watched.
    fn note(&mut self, blocks: Range<i64>) {
        if blocks.is_empty() || !self.common.watched {
            return;
        }
        let (first_block, last_block) = (blocks.start == 0, blocks.end == self.common.blocks as i64);
        for k in self.local(blocks) {
            if !self.blocks[k].watched.is_empty() {
                self.note_block(k);
            }
        }
        let due = [first_block, last_block];
        for (end, due) in self.ends.iter_mut().zip(due) {
            if let Some(end) = end.as_mut().filter(|_| due) {
                end.note();
            }
        }
    }

    fn note_block(&mut self, k: usize) {
        let outer = [self.outer_velocity(k, 0), self.outer_velocity(k, 1)];
        let block = &mut self.blocks[k];
        let law = self.common.laws[block.segment].law.as_ref();
        let constants = &self.common.constants[block.segment];
        let mut log = std::mem::take(&mut block.log);
        log.extend(
            block.watched.iter().map(|&i| WATCHED.map(|quantity| reading(quantity, block, law, constants, outer, i))),
        );
        block.log = log;
    }

    /// Velocity at the time of the stresses of the node at the left (0) or right (1) edge of block `k`.
    fn outer_velocity(&self, k: usize, side: usize) -> f64 {
        let edge = k + side;
        if let Some(contact) = self.contacts.iter().find(|contact| contact.edge + 1 == self.first + edge) {
            return contact.velocity(1 - side);
        }
        let end = usize::from(edge > 0);
        match &self.ends[end] {
            Some(device) if self.first + edge == end * self.common.blocks => device.velocity(),
            _ => self.edges[edge - 1].velocity(),
        }
    }

    /// Velocities, before they are damped, of the nodes next to block `k` inside its neighbours, where these are of its own
    /// segment. At an end that is not held the bar goes on as in a mirror.
    fn nodes_outside(&self, k: usize) -> [Option<f64>; 2] {
        let block = &self.blocks[k];
        let cells = block.sigma.len();
        let mirrored = |end: usize, node: usize| {
            let device = self.ends[end].as_ref()?;
            (!device.is_held()).then_some(block.v[node])
        };
        let parted = |edge: usize| self.contacts.iter().any(|contact| contact.edge == self.first + edge);
        let inside = |other: &Block, edge: usize, side: usize| {
            (other.segment == block.segment && !parted(edge)).then(|| other.undamped(side))
        };
        let left = match k.checked_sub(1) {
            None => mirrored(0, 1),
            Some(other) => inside(&self.blocks[other], other, 1),
        };
        let right = match self.blocks.get(k + 1) {
            None => mirrored(1, cells - 1),
            Some(other) => inside(other, k, 0),
        };
        [left, right]
    }

    /// Blocks by their place in the stretch.
    fn local(&self, blocks: Range<i64>) -> Range<usize> {
        let at = |k: i64| (k as usize).saturating_sub(self.first);
        if blocks.is_empty() { 0..0 } else { at(blocks.start)..at(blocks.end) }
    }

    /// The edges among these that lie between two blocks, by their place in the stretch.
    fn inner(&self, edges: &Range<i64>) -> Range<usize> {
        let first = self.first as i64;
        let from = (edges.start - first - 1).max(0) as usize;
        let to = (edges.end - first - 1).clamp(0, self.edges.len() as i64) as usize;
        from.min(to)..to
    }
}

impl<'a> Common<'a> {
    fn law(self, segment: usize) -> BlockLaw<'a> {
        let (law, constants) = (&self.laws[segment], &self.constants[segment]);
        BlockLaw {
            law: law.law.as_ref(),
            stress_gain: constants.stress_gain,
            velocity_gain: constants.velocity_gain,
            yield_stress: law.yield_stress,
        }
    }
}

/// The blocks on both sides of edge `k`.
fn pair(blocks: &mut [Block], k: usize) -> [&mut Block; 2] {
    let (left, right) = blocks.split_at_mut(k + 1);
    [&mut left[k], &mut right[0]]
}

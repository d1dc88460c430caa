//! The order in which the blocks of a bar are advanced.
//!
//! A step has five stages, each on a block or on the edge to its left (edges 0 and B of B blocks are the bar's ends):
//!
//! | stage | acts on | requires, of the same step |
//! |---|---|---|
//! | advance | a block: its stresses, then its inner nodes | the step before finished on both its edges |
//! | `update_interfaces` | an edge: its node, from the stresses on both sides | both neighbours advanced |
//! | damp | a block: the oscillations of its inner nodes | both its edges updated, both neighbours advanced |
//! | finish | an edge: its node's share of the damping | both neighbours damped |
//! | note | a block: what is logged of its cells | both its edges finished |
//!
//! The bar therefore need not complete one step before the next begins. A few blocks that stay in the first-level cache are advanced by one
//! step, then their neighbours two blocks to the left by the next one, and so on, step after step; then the same is done for the blocks to
//! the right. A long bar passes through the cache once for many steps. With several threads, each has a part of the bar, and advances a
//! region that shrinks from step to step, as nothing is known of its neighbours; the triangles that remain between two parts are filled
//! afterwards. Every stage gives the same result in any order, so that every bit of the result is the same.

use std::ops::Range;

use super::block::{Block, Scratch};
use super::subdomain::Subdomain;

/// Largest number of steps in one sweep. Twice as many blocks pass through the second-level cache in that time.
const DEPTH: usize = 32;

/// Number of blocks that take a step before those to their left take the next one: as many as the first-level cache holds.
const TILE: i64 = 8;

/// Number of blocks by which a stage of the next step lags behind that of this step.
const LAG: i64 = 2;

/// Smallest number of active blocks for a thread of its own; with fewer, waking the thread costs more than it saves.
const PART: usize = 64;

/// Smallest number of active blocks of a part per step of a sweep. Parts shrink by two blocks per step on either side, and the triangles
/// between them, which fewer threads fill, are to be a small fraction.
const PART_PER_STEP: usize = 16;

/// Smallest number of blocks of a part per step of a sweep, active or not, so that the triangles on both sides do not meet.
const LEAST_PER_STEP: usize = 8;

/// Returns the number of parts in which a bar with this many active blocks is swept in parallel, and the number of steps in one sweep.
pub(super) fn division(at_work: usize, threads: usize) -> (usize, usize) {
    match threads.min(at_work / PART) {
        0 | 1 => (1, DEPTH),
        parts => (parts, DEPTH.min(at_work / parts / PART_PER_STEP)),
    }
}

/// Returns the cost of a step of a block, relative to one that is carried as waves.
fn work(block: &Block) -> usize {
    match (block.at_rest(), block.waves.is_some(), block.is_elastic()) {
        (true, ..) => 0,
        (_, true, _) => 1,
        (.., true) => 4,
        (.., false) => 16,
    }
}

/// Stages of a step to be computed, as ranges of block and edge numbers.
#[derive(Debug, Clone)]
pub(super) struct StageRanges {
    pub advance: Range<i64>,
    pub update_interfaces: Range<i64>,
    pub damp: Range<i64>,
    pub finish: Range<i64>,
    pub note: Range<i64>,
}

impl StageRanges {
    /// Returns the stages for blocks `a..z` if everything to the left is done in this step, and nothing to the right.
    fn following(a: i64, z: i64) -> Self {
        Self { advance: a..z, update_interfaces: a..z, damp: a - 1..z - 1, finish: a - 1..z - 1, note: a - 2..z - 2 }
    }

    /// Returns all stages of a bar of `blocks` blocks.
    pub fn all(blocks: i64) -> Self {
        Self {
            advance: 0..blocks,
            update_interfaces: 0..blocks + 1,
            damp: 0..blocks,
            finish: 0..blocks + 1,
            note: 0..blocks,
        }
    }

    /// Returns the stages that can be computed from block `a` on if nothing is known of the blocks to its left.
    fn right_of(a: i64) -> Self {
        let end = i64::MAX;
        Self { advance: a..end, update_interfaces: a + 1..end, damp: a + 1..end, finish: a + 2..end, note: a + 2..end }
    }

    /// Returns the stages that can be computed up to block `z`, not included, if nothing is known of it.
    fn left_of(z: i64) -> Self {
        let start = i64::MIN;
        Self {
            advance: start..z,
            update_interfaces: start..z,
            damp: start..z - 1,
            finish: start..z - 1,
            note: start..z - 2,
        }
    }

    /// Returns the stages that remain between [`Self::left_of`] block `a` and [`Self::right_of`] block `z`.
    fn between(a: i64, z: i64) -> Self {
        Self {
            advance: a..z,
            update_interfaces: a..z + 1,
            damp: a - 1..z + 1,
            finish: a - 1..z + 2,
            note: a - 2..z + 2,
        }
    }

    fn and(&self, other: &Self) -> Self {
        let common = |a: &Range<i64>, b: &Range<i64>| a.start.max(b.start)..a.end.min(b.end);
        Self {
            advance: common(&self.advance, &other.advance),
            update_interfaces: common(&self.update_interfaces, &other.update_interfaces),
            damp: common(&self.damp, &other.damp),
            finish: common(&self.finish, &other.finish),
            note: common(&self.note, &other.note),
        }
    }
}

/// Stages on the whole bar.
impl Subdomain<'_> {
    /// Advances the stresses and inner nodes of all blocks in a step, and the nodes between them.
    pub fn advance_all(&mut self, step: usize, scratch: &mut Scratch) {
        let StageRanges { advance, update_interfaces, .. } = StageRanges::all(self.common.blocks as i64);
        self.advance(advance, step, scratch);
        self.update_interfaces(update_interfaces, step);
    }

    /// Updates the edges of all blocks at t = 0.
    pub fn update_all_interfaces(&mut self) {
        self.update_interfaces(StageRanges::all(self.common.blocks as i64).update_interfaces, 0);
    }

    /// Applies the grid filter to the whole bar in a step.
    pub fn damp_all(&mut self, step: usize, scratch: &mut Scratch) {
        let StageRanges { damp, finish, .. } = StageRanges::all(self.common.blocks as i64);
        self.damp(damp, step, scratch);
        self.finish(finish);
    }

    /// Logs what is watched in the whole bar.
    pub fn note_all(&mut self) {
        self.note(StageRanges::all(self.common.blocks as i64).note);
    }
}

impl Subdomain<'_> {
    /// Advances the subdomain by `steps` steps in `parts` parts, as [`division`] allows.
    pub fn sweep(&mut self, steps: usize, parts: usize) {
        if parts == 1 {
            return Scratch::lend(|scratch| self.sweep_tiles(steps, scratch));
        }
        let at = self.fair_cut(steps, parts);
        let middle = (self.first + at) as i64;
        let [mut left, mut right] = self.split(at);
        rayon::join(|| left.sweep(steps, parts / 2), || right.sweep(steps, parts - parts / 2));
        Scratch::lend(|scratch| {
            for s in 0..steps {
                let lag = LAG * s as i64;
                self.compute(s, &StageRanges::between(middle - lag, middle + lag), scratch);
            }
        });
    }

    /// Returns the number of blocks in the first half of the parts for which all parts have the same work.
    fn fair_cut(&self, steps: usize, parts: usize) -> usize {
        let all: usize = self.blocks.iter().map(work).sum();
        let (share, mut done) = (all * (parts / 2) / parts, 0);
        let at = self.blocks.iter().position(|block| {
            done += work(block);
            done > share
        });
        let (blocks, least) = (self.blocks.len(), LEAST_PER_STEP * steps);
        at.unwrap_or(blocks).clamp(least * (parts / 2), blocks - least * (parts - parts / 2))
    }

    /// Splits the subdomain in two, without the edge between them.
    fn split(&mut self, at: usize) -> [Subdomain<'_>; 2] {
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
            Subdomain { common, first, blocks, edges, contacts, ends: [left, None] },
            Subdomain {
                common,
                first: border,
                blocks: more_blocks,
                edges: &mut more_edges[1..],
                contacts: more_contacts,
                ends: [None, right],
            },
        ]
    }

    /// Computes everything of these steps that does not depend on what is beyond the subdomain.
    fn sweep_tiles(&mut self, steps: usize, scratch: &mut Scratch) {
        let (from, to) = (self.first as i64, (self.first + self.blocks.len()) as i64);
        let at_start = self.ends[0].is_some();
        let at_end = self.ends[1].is_some();
        let mut tile = from;
        while tile - LAG * (steps as i64 - 1) <= to + LAG {
            // The first and the last step in which the tile is on the subdomain.
            let first = (tile - LAG - to).max(0) / LAG;
            let last = ((tile + TILE + LAG - from) / LAG).min(steps as i64 - 1);
            for s in first..=last {
                let mut stages = StageRanges::following(tile - LAG * s, tile - LAG * s + TILE);
                if !at_start {
                    stages = stages.and(&StageRanges::right_of(from + LAG * s));
                }
                if !at_end {
                    stages = stages.and(&StageRanges::left_of(to - LAG * s));
                }
                self.compute(s as usize, &stages, scratch);
            }
            tile += TILE;
        }
    }

    /// Computes the stages of step number `s` of this sweep, as far as the bar has them.
    fn compute(&mut self, s: usize, stages: &StageRanges, scratch: &mut Scratch) {
        let stages = stages.and(&StageRanges::all(self.common.blocks as i64));
        let step = self.common.step + s + 1;
        self.advance(stages.advance, step, scratch);
        self.update_interfaces(stages.update_interfaces, step);
        self.damp(stages.damp, step, scratch);
        self.finish(stages.finish);
        self.note(stages.note);
    }
}

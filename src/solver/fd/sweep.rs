//! The order in which the blocks of a bar take their steps.
//!
//! A step has five stages, each of a block or on the edge to its left (edges 0 and B of B blocks are the bar's ends):
//!
//! | stage | of | needs, of the same step |
//! |---|---|---|
//! | advance | a block: its stresses, then its inner nodes | the step before finished on both its edges |
//! | `update_interfaces` | an edge: its node, from the stresses on both sides | both neighbours advanced |
//! | damp | a block: the ripples of its inner nodes | both its edges met, both neighbours advanced |
//! | finish | an edge: its node's share of the damping | both neighbours damped |
//! | note | a block: what is logged of its cells | both its edges finished |
//!
//! So a bar need not take one step after the other: a few blocks that stay in the first-level cache take a step, then their
//! neighbours two blocks to the left the next one, and so on, step after step; then the same for the blocks to the right,
//! and a long bar comes through the cache once for many steps. On several threads each has a part of the bar, on which it
//! steps inwards from what it does not know of its neighbours; the triangles that are left between two parts are then
//! filled. Every stage gives the same in any order, and so is every bit of the result.

use std::ops::Range;

use super::block::{Block, Scratch};
use super::subdomain::Subdomain;

/// Most steps in one go. Twice as many blocks pass through the second-level cache in that time.
const DEPTH: usize = 32;

/// Blocks that take a step before those to their left take the next one: as many as the first-level cache holds.
const TILE: i64 = 8;

/// Blocks that a stage of the next step stays behind this one's.
const LAG: i64 = 2;

/// Fewest blocks at work for a thread of its own: fewer cost less than to wake it.
const PART: usize = 64;

/// Blocks at work of a part for every step of a sweep: parts shrink by two blocks a step on either side, and the triangles between
/// them, which fewer threads fill, are to be a small share.
const PART_PER_STEP: usize = 16;

/// Fewest blocks of a part for every step of a sweep, at rest or not: the triangles on both sides do not meet.
const LEAST_PER_STEP: usize = 8;

/// How many parts of a bar with so many blocks at work are swept side by side on so many threads, and for how many steps in one go.
pub(super) fn division(at_work: usize, threads: usize) -> (usize, usize) {
    match threads.min(at_work / PART) {
        0 | 1 => (1, DEPTH),
        parts => (parts, DEPTH.min(at_work / parts / PART_PER_STEP)),
    }
}

/// Time of a step of a block, in that of one that is carried as waves.
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
    /// Of blocks `a..z` where all to the left is done in this step, and nothing to the right.
    fn following(a: i64, z: i64) -> Self {
        Self { advance: a..z, update_interfaces: a..z, damp: a - 1..z - 1, finish: a - 1..z - 1, note: a - 2..z - 2 }
    }

    /// Of a bar of `blocks` blocks, all.
    pub fn all(blocks: i64) -> Self {
        Self {
            advance: 0..blocks,
            update_interfaces: 0..blocks + 1,
            damp: 0..blocks,
            finish: 0..blocks + 1,
            note: 0..blocks,
        }
    }

    /// What can be done from block `a` on, where nothing is known of those to its left.
    fn right_of(a: i64) -> Self {
        let end = i64::MAX;
        Self { advance: a..end, update_interfaces: a + 1..end, damp: a + 1..end, finish: a + 2..end, note: a + 2..end }
    }

    /// What can be done up to block `z`, not included, where nothing is known of it.
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

    /// What is left between [`Self::left_of`] block `a` and [`Self::right_of`] block `z`.
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

/// The whole bar, stage by stage.
impl Subdomain<'_> {
    /// The stresses and inner nodes of all blocks in a step, and the nodes between them.
    pub fn advance_all(&mut self, step: usize, scratch: &mut Scratch) {
        let StageRanges { advance, update_interfaces, .. } = StageRanges::all(self.common.blocks as i64);
        self.advance(advance, step, scratch);
        self.update_interfaces(update_interfaces, step);
    }

    /// The edges of all blocks at t = 0.
    pub fn update_all_interfaces(&mut self) {
        self.update_interfaces(StageRanges::all(self.common.blocks as i64).update_interfaces, 0);
    }

    /// The grid filter of the whole bar in a step.
    pub fn damp_all(&mut self, step: usize, scratch: &mut Scratch) {
        let StageRanges { damp, finish, .. } = StageRanges::all(self.common.blocks as i64);
        self.damp(damp, step, scratch);
        self.finish(finish);
    }

    /// Logs what is watched of the whole bar.
    pub fn note_all(&mut self) {
        self.note(StageRanges::all(self.common.blocks as i64).note);
    }
}

impl Subdomain<'_> {
    /// Takes the bar `steps` steps on in so many parts, as [`division`] allows.
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

    /// Where the first half of the parts ends, so that all have the same work: the number of blocks before it.
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

    /// Two subdomains, without the edge between them.
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

    /// All that can be done of these steps without knowing what is beyond the subdomain.
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

    /// The stages of step number `s` of this sweep, as far as the bar has them.
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

//! Which cells of a block are at work, and which rest until a node beside them moves.
//!
//! A piece of [`CHUNK`] cells rests where another step would change no bit of it: its nodes move alike, their forces move
//! none of them, and the law gives back what it has. That is looked at exactly, so that leaving the piece out changes nothing.

use std::ops::Range;

use super::block::{Block, BlockLaw, Stage};
use crate::law::CHUNK;

impl Block {
    /// Nothing is computed until a node at the edges moves.
    pub fn at_rest(&self) -> bool {
        self.busy.is_empty()
    }

    /// The cells at the left (0) or right (1) edge are at rest.
    pub fn rests_at(&self, side: usize) -> bool {
        self.at_rest() || if side == 0 { self.busy.start > 0 } else { self.busy.end < self.sigma.len() }
    }

    /// Sets all cells to work.
    pub fn wake(&mut self) {
        self.busy = 0..self.sigma.len();
    }

    /// Gives the node at the left (0) or right (1) edge its velocity.
    pub fn set_edge(&mut self, side: usize, velocity: f64) {
        let cells = self.sigma.len();
        let node = side * cells;
        if self.v[node] == velocity {
            return;
        }
        self.v[node] = velocity;
        let piece = if side == 0 { 0..CHUNK.min(cells) } else { (cells - 1) / CHUNK * CHUNK..cells };
        self.busy = if self.at_rest() { piece } else { self.busy.start.min(piece.start)..self.busy.end.max(piece.end) };
    }

    /// Sets the pieces next to those at work to work if the node between has moved: a signal comes no farther in a step.
    pub fn widen(&mut self) {
        let (Range { start, end }, cells) = (self.busy.clone(), self.sigma.len());
        if start > 0 && self.v[start] != self.v[start - 1] {
            self.busy.start -= CHUNK;
        }
        if end < cells && self.v[end] != self.v[end + 1] {
            self.busy.end = cells.min(end + CHUNK);
        }
    }

    /// Lets the outer pieces at work come to rest where they have.
    pub fn narrow(&mut self, law: BlockLaw<'_>) {
        while !self.at_rest() {
            let Range { start, end } = self.busy;
            let (after_first, before_last) = (end.min(start + CHUNK), (end - 1) / CHUNK * CHUNK);
            if self.settles(start..after_first, law) {
                self.busy.start = after_first;
            } else if self.settles(before_last..end, law) {
                self.busy.end = before_last;
            } else {
                return;
            }
        }
        self.note_undamped();
        self.handed_at_edges = [0.0; 2];
    }

    /// Whether these cells have come to rest: their nodes move alike, and neither these velocities nor the law change anything
    /// in another step.
    fn settles(&mut self, cells: Range<usize>, law: BlockLaw<'_>) -> bool {
        let nodes = &self.v[cells.start..=cells.end];
        let v = nodes[0];
        if v != nodes[1] || v != nodes[cells.len()] || nodes.iter().any(|other| *other != v) {
            return false;
        }
        let moves = |i: usize| v + self.kick(law.velocity_gain, i) != v;
        let plastic = self.stage == Stage::Plastic;
        if inner_nodes(&cells, self.sigma.len()).any(moves)
            || plastic && !law.law.rests(&self.sigma, &self.state, cells.clone())
        {
            return false;
        }
        if plastic {
            self.flow[cells].fill(0);
        }
        true
    }
}

/// The nodes of these cells of a block, without those at its own edges.
pub(super) fn inner_nodes(cells: &Range<usize>, all: usize) -> Range<usize> {
    cells.start.max(1)..all.min(cells.end + 1)
}

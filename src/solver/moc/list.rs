//! Fronts in order along the bar: a doubly linked list in one vector with reused slots.

use serde::{Deserialize, Serialize};

use crate::wave::riemann::Point;

/// Index that stands for no node.
pub const NONE: u32 = u32::MAX;

/// Kind of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// A moving front.
    Front,
    /// A stationary position where histories (or velocities, or back stresses) differ.
    Contact,
    /// A joint between two segments.
    Joint,
    /// An end of the bar.
    End,
}

/// A front or stationary position, and the constant state between it and the next node.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Node {
    pub kind: Kind,
    /// Position and time of its start; speed in +x.
    pub x: f64,
    pub t: f64,
    pub speed: f64,
    /// State to its right, and the segment of that state (without meaning at the right end).
    pub right: Point,
    pub segment: u32,
    pub prev: u32,
    pub next: u32,
    /// Distinguishes this node from an earlier one in the same slot; 0 while the slot is free.
    pub stamp: u64,
}

impl Node {
    /// Creates a node that is not yet in a list.
    pub fn new(kind: Kind, x: f64, t: f64, speed: f64, right: Point, segment: u32) -> Self {
        Self { kind, x, t, speed, right, segment, prev: NONE, next: NONE, stamp: 0 }
    }

    /// Returns whether the node is an end or joint, which never moves.
    pub fn is_fixed(&self) -> bool {
        matches!(self.kind, Kind::End | Kind::Joint)
    }

    /// Position at t, m.
    pub fn at(&self, t: f64) -> f64 {
        if self.speed == 0.0 { self.x } else { self.x + self.speed * (t - self.t) }
    }
}

/// The list.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct List {
    nodes: Vec<Node>,
    free: Vec<u32>,
    stamps: u64,
}

impl List {
    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len() - self.free.len()
    }

    /// Returns the node in a slot.
    pub fn get(&self, id: u32) -> &Node {
        &self.nodes[id as usize]
    }

    /// Returns the node in a slot for modification.
    pub fn get_mut(&mut self, id: u32) -> &mut Node {
        &mut self.nodes[id as usize]
    }

    /// Inserts a node after `after` (`NONE`: at the left end of the list) and returns its slot. Links and stamp of the given node are ignored.
    pub fn insert(&mut self, after: u32, mut node: Node) -> u32 {
        self.stamps += 1;
        node.stamp = self.stamps;
        node.prev = after;
        node.next = if after == NONE { NONE } else { self.get(after).next };
        let id = self.free.pop().unwrap_or(self.nodes.len() as u32);
        if id as usize == self.nodes.len() {
            self.nodes.push(node);
        } else {
            self.nodes[id as usize] = node;
        }
        if node.prev != NONE {
            self.get_mut(node.prev).next = id;
        }
        if node.next != NONE {
            self.get_mut(node.next).prev = id;
        }
        id
    }

    /// Removes a node.
    pub fn remove(&mut self, id: u32) {
        let Node { prev, next, .. } = *self.get(id);
        if prev != NONE {
            self.get_mut(prev).next = next;
        }
        if next != NONE {
            self.get_mut(next).prev = prev;
        }
        self.get_mut(id).stamp = 0;
        self.free.push(id);
    }

    /// Iterates over all nodes from left to right; the first one is the left end, in slot 0.
    pub fn iter(&self) -> impl Iterator<Item = &Node> {
        let mut id = if self.nodes.is_empty() { NONE } else { 0 };
        std::iter::from_fn(move || {
            let node = self.nodes.get(id as usize)?;
            id = node.next;
            Some(node)
        })
    }
}

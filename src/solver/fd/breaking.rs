//! Fracture data of a bar on the staggered grid.

use serde::{Deserialize, Serialize};

use crate::law::rupture::{Criteria, Rupture};

/// What is known of a bar that can break.
#[derive(Debug)]
pub(super) struct Breaking {
    pub criteria: Criteria,
    /// The first cells at the left and the right end keep too much plastic strain when that end is suddenly moved.
    pub overshoots: [bool; 2],
    pub found: Vec<Rupture>,
    /// For each rupture: the node's number (that of the cell to its right), and its step.
    pub nodes: Vec<(usize, usize)>,
    pub ends_gone: [bool; 2],
    /// The place that went farthest beyond the threshold, while too few cells did to break it, before anything had broken.
    pub unresolved: Option<Unresolved>,
}

/// A tension beyond the threshold that was shorter than a rupture takes on the grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Unresolved {
    /// s.
    pub time: f64,
    /// m.
    pub x: f64,
    /// How far beyond the threshold, as a factor.
    pub share: f64,
}

/// Of [`Breaking`], what changes: ruptures, their nodes and steps, and the ends that are gone.
pub(super) type Broken = (Vec<Rupture>, Vec<(usize, usize)>, [bool; 2], Option<Unresolved>);

impl Breaking {
    pub fn new(criteria: Criteria, overshoots: [bool; 2]) -> Self {
        Self { criteria, overshoots, found: Vec::new(), nodes: Vec::new(), ends_gone: [false; 2], unresolved: None }
    }

    pub fn state(&self) -> Broken {
        (self.found.clone(), self.nodes.clone(), self.ends_gone, self.unresolved)
    }

    pub fn restore(&mut self, state: Broken) {
        (self.found, self.nodes, self.ends_gone, self.unresolved) = state;
    }

    pub fn ends_gone(&self) -> [bool; 2] {
        self.ends_gone
    }
}

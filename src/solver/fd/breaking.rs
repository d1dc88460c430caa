//! Fracture data of a bar on the staggered grid.

use serde::{Deserialize, Serialize};

use crate::law::rupture::{Criteria, Rupture};

/// Fracture criteria of a bar and the fractures so far.
#[derive(Debug)]
pub(super) struct Breaking {
    pub criteria: Criteria,
    /// Whether the first cells at the left and the right end keep too much plastic strain when that end is suddenly moved.
    pub overshoots: [bool; 2],
    pub found: Vec<Rupture>,
    /// For each fracture: number of the node (that of the cell to its right), and step.
    pub nodes: Vec<(usize, usize)>,
    pub ends_gone: [bool; 2],
    /// Place that exceeded the threshold by the largest factor while too few cells did so to fracture it, before any fracture.
    pub unresolved: Option<Unresolved>,
}

/// Tension above the threshold over fewer cells than a fracture needs on the grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Unresolved {
    /// Time, s.
    pub time: f64,
    /// Position, m.
    pub x: f64,
    /// Ratio of the tension measure to the threshold.
    pub share: f64,
}

/// State of [`Breaking`] that changes: fractures, their nodes and steps, the ends that have broken off, and the unresolved tension.
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

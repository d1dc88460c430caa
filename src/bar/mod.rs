//! The bar itself: segments, joints, ends and their histories; plain data, the same for every solver.

mod end;
mod hertz;
mod history;
mod launch;

use std::sync::Arc;

pub use end::EndCondition;
pub use hertz::Hertz;
pub use history::History;
pub use launch::{Launch, Origin, launches};

use crate::material::Material;

/// A bar: segments from left to right.
#[derive(Debug, Clone)]
pub struct Bar {
    /// At least one segment.
    pub segments: Vec<Segment>,
    /// False where the scene gave no area: every segment then has 1 m^2, and forces and energies are per m^2.
    pub area_given: bool,
}

/// A uniform piece of the bar.
#[derive(Debug, Clone)]
pub struct Segment {
    /// Length, m, > 0.
    pub length: f64,
    /// Cross-section, m^2, > 0.
    pub area: f64,
    /// What it is made of.
    pub material: Arc<Material>,
    /// Initial velocity, m/s, positive in +x.
    pub velocity: f64,
    /// How it is joined to the next segment (meaningless on the last).
    pub joint: Joint,
}

/// How two segments meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joint {
    /// Welded: force and velocity are continuous.
    Bonded,
    /// Touching, carries no tension; `gap` is the initial opening, m, >= 0.
    Contact {
        /// Initial opening, m.
        gap: f64,
    },
}

impl Bar {
    /// Total length, m.
    pub fn length(&self) -> f64 {
        self.segments.iter().map(|s| s.length).sum()
    }

    /// Time that an elastic wave takes from end to end, s.
    pub fn transit_time(&self) -> f64 {
        self.segments.iter().map(|s| s.length / s.material.c0()).sum()
    }
}

//! Limits of the material data, and the first points of the bar that reached them.

use serde::{Deserialize, Serialize};

use super::Stopped;
use crate::bar::Bar;
use crate::law::{DataEnd, Reached};

/// A point of the bar at a limit of the data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PointAtLimit {
    /// Index of its segment.
    pub segment: usize,
    /// Time, s.
    pub time: f64,
    /// Position, m.
    pub x: f64,
    /// Limit that it has reached.
    pub reached: Reached,
}

/// Limits of every segment, and the first point to reach each kind.
#[derive(Debug, Clone)]
pub(super) struct Limits {
    pub ends: Vec<DataEnd>,
    pub passed: Vec<PointAtLimit>,
    /// Whether the run ends where the data of a material end.
    pub stops: bool,
    pub stop: Option<PointAtLimit>,
}

impl Limits {
    pub fn new(bar: &Bar, stops: bool) -> Self {
        let ends = bar.segments.iter().map(|segment| DataEnd::of(&segment.material)).collect();
        Self { ends, passed: Vec::new(), stops, stop: None }
    }

    /// Returns an error with the point that stops the run before this time (s), if there is one.
    pub fn check(&self, until: f64) -> Result<(), Stopped> {
        self.stop.filter(|stop| stop.time < until).map_or(Ok(()), |stop| Err(Stopped::AtLimit(stop)))
    }
}

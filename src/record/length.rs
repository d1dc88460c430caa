//! Lengths of the segments of a bar at the end of a run.

use serde::Serialize;

/// Length of a segment, without the openings of joints and fractures. For a bar against a wall this is the length measured in a Taylor test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LengthSummary {
    /// Undeformed length, m.
    #[serde(rename = "initial_m")]
    pub initial: f64,
    /// Length at the end time, m.
    #[serde(rename = "final_m")]
    pub at_end: f64,
    /// Length after elastic unloading of every section from its state at the end time, m: the integral of 1 + plastic strain.
    #[serde(rename = "unloaded_m")]
    pub unloaded: f64,
}

//! Front segments: straight lines in (x, t), for x-t diagrams and gauges.

use serde::{Deserialize, Serialize};

use crate::wave::riemann::Point;

/// Straight path of a front, from where it was emitted to where it met something (or to the present), with the constant states on both sides.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrontSegment {
    /// Positions of its start and end, m.
    pub x: [f64; 2],
    /// Times of its start and end, s.
    pub t: [f64; 2],
    /// Speed, m/s, positive in +x.
    pub speed: f64,
    /// Index of the segment in which it runs.
    pub segment: usize,
    /// State ahead of it.
    pub ahead: Point,
    /// State behind it.
    pub behind: Point,
}

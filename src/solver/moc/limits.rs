//! Where a tracked bar comes to a limit of what its materials know.
//!
//! Every state of the bar first exists behind the waves of a Riemann problem, so that only those states need a look.

use super::{FrontTracking, Stopped};
use crate::bar::Bar;
use crate::law::{DataEnd, Flowing, Limit, Reached};
use crate::material::Sense;
use crate::wave::riemann::{Flow, Medium, Path, Point};

/// A point of the bar at such a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointAtLimit {
    /// Index of its segment.
    pub segment: usize,
    /// s.
    pub time: f64,
    /// m.
    pub x: f64,
    /// What it has reached.
    pub reached: Reached,
}

/// The limits of every segment, and the first point to reach each kind.
#[derive(Debug, Clone)]
pub(super) struct Limits {
    ends: Vec<DataEnd>,
    passed: Vec<PointAtLimit>,
    /// The run ends where nothing is known of a material any more.
    stops: bool,
    stop: Option<PointAtLimit>,
}

impl Limits {
    pub fn new(bar: &Bar, stops: bool) -> Self {
        let ends = bar.segments.iter().map(|segment| DataEnd::of(&segment.material)).collect();
        Self { ends, passed: Vec::new(), stops, stop: None }
    }

    /// The point that stops the run before this time (s), if there is one.
    pub fn check(&self, until: f64) -> Result<(), Stopped> {
        self.stop.filter(|stop| stop.time < until).map_or(Ok(()), |stop| Err(Stopped::AtLimit(stop)))
    }
}

impl FrontTracking {
    /// The first points that reached each limit, in the order of time.
    pub fn passed(&self) -> &[PointAtLimit] {
        &self.limits.passed
    }

    /// Looks at the state `behind` the waves that a side (0 left, 1 right) of a Riemann problem at x sends into `ahead`.
    pub(super) fn note_limit(&mut self, side: usize, segment: u32, [ahead, behind]: [&Point; 2], x: f64) {
        if ahead == behind {
            return;
        }
        let segment = segment as usize;
        let medium = &self.media[segment];
        let path = if side == 0 { &self.scratch.work.left } else { &self.scratch.work.right };
        let (sense, accumulated) = match medium.flow {
            Flow::Plastic { .. } | Flow::Overlay => (Sense::of(path.sense()), behind.accumulated),
            Flow::PathIndependent => (Sense::of(medium.strain(behind)), behind.plastic.abs()),
        };
        let point = Flowing { sense, accumulated, strain: behind.stress + behind.plastic };
        let passed = &self.limits.passed;
        let is_news =
            |limit: Limit| passed.iter().all(|known| known.segment != segment || known.reached.limit != limit);
        let flows = |limit| is_news(limit) && (ahead.plastic != behind.plastic || is_held(medium, path, behind));
        let Some(reached) = self.limits.ends[segment].reached(&point, flows).filter(|r| is_news(r.limit)) else {
            return;
        };
        let found = PointAtLimit { segment, time: self.now, x, reached };
        self.limits.passed.push(found);
        if self.limits.stops && reached.limit.stops(&self.materials[segment]) {
            self.limits.stop.get_or_insert(found);
        }
    }
}

/// The point is at the largest stress that waves can bring about: a level line holds it.
fn is_held(medium: &Medium, path: &Path, point: &Point) -> bool {
    path.sense() * point.stress >= path.cap() - medium.round_off
}

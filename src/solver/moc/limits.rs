//! Points at which a front-tracking bar reaches the limits of the material data.
//!
//! Every state of the bar first exists behind the waves of a Riemann problem, so that only those states have to be checked.

use super::FrontTracking;
use super::known_limits::PointAtLimit;
use crate::law::{Flowing, Limit};
use crate::material::Sense;
use crate::wave::riemann::{Flow, Medium, Path, Point};

impl FrontTracking {
    /// Returns the first points that reached each limit, ordered by time.
    pub fn limits_reached(&self) -> &[PointAtLimit] {
        &self.limits.passed
    }

    /// Checks the state `behind` the waves that a side (0 left, 1 right) of a Riemann problem at x emits into the state `ahead`. Behind `elastic`
    /// waves nothing flows, and there is no path.
    pub(super) fn note_limit(
        &mut self,
        side: usize,
        segment: u32,
        [ahead, behind]: [&Point; 2],
        x: f64,
        elastic: bool,
    ) {
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
        let held = !elastic && is_held(medium, path, behind);
        let point = Flowing { sense, accumulated, strain: behind.stress + behind.plastic, held };
        let passed = &self.limits.passed;
        let is_news =
            |limit: Limit| passed.iter().all(|known| known.segment != segment || known.reached.limit != limit);
        let flows = |limit| !elastic && is_news(limit) && (ahead.plastic != behind.plastic || held);
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

/// Returns whether the point is at the largest stress that waves can produce, held by a level line.
fn is_held(medium: &Medium, path: &Path, point: &Point) -> bool {
    path.sense() * point.stress >= path.cap() - medium.round_off
}

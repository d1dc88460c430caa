//! Detects first yield, the end of the material data and failure of a front-tracking bar.

use serde::{Deserialize, Serialize};

use super::limits::AtLimit;
use crate::material::Sense;
use crate::record::{self, AuditRow};
use crate::scene::Scene;
use crate::solver::moc::{FrontSegment, FrontTracking};

/// Fraction of the largest stress of its curve from which a stress counts as equal to it: a level part of the curve limits the stress, so that any
/// difference is due to rounding.
const AT_THE_END: f64 = 1.0 - 1e-12;

/// Detector, which reads the front segments, since they contain every state of the bar, and the bar itself.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct FailureDetector {
    /// First point inside the bar where strain gathers: segment and stress (Pa), time since which it gathers (s), and position (m).
    localization: Option<((usize, f64), f64, f64)>,
    yielded: bool,
}

impl FailureDetector {
    /// Records whether anything has yielded.
    pub fn look_at(&mut self, bar: &FrontTracking, front_segments: &[FrontSegment]) {
        self.yielded |= front_segments.iter().any(|t| t.behind.plastic.abs() > bar.medium(t.segment).round_off);
    }

    /// Records the first point where the stress is the largest one of its curve and the two sides continue to separate or approach. Strain gathers
    /// there without bound, so the bar fails.
    pub fn detect_localization(&mut self, scene: &Scene, bar: &FrontTracking) {
        if self.localization.is_some() {
            return;
        }
        let full = |(segment, stress): &(usize, f64)| {
            let curve = scene.bar.segments[*segment].material.branch(Sense::of(*stress));
            curve.ultimate().is_some_and(|u| stress.abs() >= AT_THE_END * u.stress)
        };
        self.localization = bar.openings().find_map(|opening| {
            let full = opening.sides.into_iter().find(full)?;
            Some((full, opening.since, opening.x))
        });
    }

    /// Returns whether nothing has yielded so far.
    pub fn stayed_elastic(&self, bar: &FrontTracking) -> bool {
        !self.yielded && !end_broke(bar)
    }

    /// Returns whether the bar has failed anywhere.
    pub fn ruptured(&self, scene: &Scene, bar: &FrontTracking) -> bool {
        at_limits(bar).any(|limit| limit.broken(scene).is_some()) || self.localization.is_some() || end_broke(bar)
    }

    /// Returns the notes for the audit. If the theory predicted failure at t = 0 (`told`), that of the ends at t = 0 is left out.
    pub fn audit(&self, scene: &Scene, bar: &FrontTracking, told: bool) -> Vec<AuditRow> {
        let segments = &scene.bar.segments;
        let mut rows = Vec::new();
        for (end, (name, segment)) in bar.ends().iter().zip([("left", 0), ("right", segments.len() - 1)]) {
            if let Some(from) = end.above_critical.filter(|from| from.time > 0.0 || !told) {
                rows.push(record::broken_end(name, from.time, &segments[segment].material, Sense::of(from.stress)));
            }
        }
        if let Some(((segment, stress), time, x)) = self.localization {
            rows.push(record::broken_inside(time, x, &segments[segment].material, Sense::of(stress)));
        }
        rows.extend(at_limits(bar).filter_map(|limit| limit.broken(scene)));
        rows
    }
}

fn at_limits(bar: &FrontTracking) -> impl Iterator<Item = AtLimit> {
    bar.limits_reached().iter().map(AtLimit::from)
}

fn end_broke(bar: &FrontTracking) -> bool {
    bar.ends().iter().any(|end| end.above_critical.is_some())
}

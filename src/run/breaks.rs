//! Limits of a front-tracking bar: first yield, end of the data, fracture.

use serde::{Deserialize, Serialize};

use super::limits::AtLimit;
use crate::material::Sense;
use crate::record::{self, AuditRow};
use crate::scene::Scene;
use crate::solver::moc::{FrontSegment, FrontTracking};

/// A stress counts as the largest one of its curve from this part of it on: a level line holds it there, so all that it lacks
/// is rounding.
const AT_THE_END: f64 = 1.0 - 1e-12;

/// Looks for that in the front segments of the fronts, which know every state that the bar was ever in, and in the bar itself.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Breaks {
    /// Where strain gathers inside the bar: segment and stress (Pa) there, since when (s), and place (m).
    gathers: Option<((usize, f64), f64, f64)>,
    yielded: bool,
}

impl Breaks {
    /// Whether anything has yielded.
    pub fn look_at(&mut self, bar: &FrontTracking, front_segments: &[FrontSegment]) {
        self.yielded |= front_segments.iter().any(|t| t.behind.plastic.abs() > bar.medium(t.segment).round_off);
    }

    /// Where the curve can carry no more and the two sides of a place go on moving apart (or together), strain gathers
    /// there without bound: the bar breaks.
    pub fn look_for_gathering_strain(&mut self, scene: &Scene, bar: &FrontTracking) {
        if self.gathers.is_some() {
            return;
        }
        let full = |(segment, stress): &(usize, f64)| {
            let curve = scene.bar.segments[*segment].material.branch(Sense::of(*stress));
            curve.ultimate().is_some_and(|u| stress.abs() >= AT_THE_END * u.stress)
        };
        self.gathers = bar.openings().find_map(|opening| {
            let full = opening.sides.into_iter().find(full)?;
            Some((full, opening.since, opening.x))
        });
    }

    /// Nothing has yielded so far.
    pub fn stayed_elastic(&self, bar: &FrontTracking) -> bool {
        !self.yielded && !end_broke(bar)
    }

    /// The bar broke somewhere.
    pub fn ruptured(&self, scene: &Scene, bar: &FrontTracking) -> bool {
        at_limits(bar).any(|limit| limit.broken(scene).is_some()) || self.gathers.is_some() || end_broke(bar)
    }

    /// Notes for the audit. What happened at t = 0 is left out where theory `told` of it.
    pub fn audit(&self, scene: &Scene, bar: &FrontTracking, told: bool) -> Vec<AuditRow> {
        let segments = &scene.bar.segments;
        let mut rows = Vec::new();
        for (end, (name, segment)) in bar.ends().iter().zip([("left", 0), ("right", segments.len() - 1)]) {
            if let Some(from) = end.above_critical.filter(|from| from.time > 0.0 || !told) {
                rows.push(record::broken_end(name, from.time, &segments[segment].material, Sense::of(from.stress)));
            }
        }
        if let Some(((segment, stress), time, x)) = self.gathers {
            rows.push(record::broken_inside(time, x, &segments[segment].material, Sense::of(stress)));
        }
        rows.extend(at_limits(bar).filter_map(|limit| limit.broken(scene)));
        rows
    }
}

fn at_limits(bar: &FrontTracking) -> impl Iterator<Item = AtLimit> {
    bar.passed().iter().map(AtLimit::from)
}

fn end_broke(bar: &FrontTracking) -> bool {
    bar.ends().iter().any(|end| end.above_critical.is_some())
}

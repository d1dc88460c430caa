//! Where a tracked bar comes to the end of what its curve says: it yields, passes its data, or breaks.

use crate::assemble;
use crate::error::{Result, RunError};
use crate::material::{Beyond, Material, Sense};
use crate::record::{self, AuditRow};
use crate::scene::Scene;
use crate::solver::moc::{FrontTracking, Trail};

/// A state counts as having reached the end of its material's data from this share of it on: it is held there by a level
/// line, so all that it lacks is rounding.
const AT_THE_END: f64 = 1.0 - 1e-12;

/// Looks for all of that in the trails of the fronts, which know every state that the bar was ever in.
#[derive(Debug)]
pub(super) struct Breaks {
    /// E times the last strain of each segment's data in tension and in compression, Pa.
    data_ends: Vec<[f64; 2]>,
    passed: Option<Passed>,
    /// Where strain gathers inside the bar: segment, since when (s), and place (m).
    gathers: Option<(usize, f64, f64)>,
    yielded: bool,
}

/// A state at the end of its material's data.
#[derive(Debug, Clone, Copy)]
struct Passed {
    segment: usize,
    strain: f64,
    time: f64,
    x: f64,
}

impl Breaks {
    pub fn new(scene: &Scene) -> Self {
        let end = |segment| assemble::segment_law(segment, &scene.effects).end;
        let data_ends = scene.bar.segments.iter().map(end).collect();
        Self { data_ends, passed: None, gathers: None, yielded: false }
    }

    /// Whether anything has yielded, or come to the end of its data.
    pub fn look_at(&mut self, bar: &FrontTracking, trails: &[Trail]) {
        for trail in trails {
            let (medium, point) = (bar.medium(trail.segment), &trail.behind);
            self.yielded |= point.plastic.abs() > medium.round_off;
            let end = self.data_ends[trail.segment][usize::from(point.stress < 0.0)];
            let reach = point.stress.abs() + point.accumulated.max(point.plastic.abs());
            if self.passed.is_none() && reach >= AT_THE_END * end {
                let strain = medium.strain(point);
                self.passed = Some(Passed { segment: trail.segment, strain, time: trail.t[0], x: trail.x[0] });
            }
        }
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
            let (segment, _) = opening.sides.into_iter().find(full)?;
            Some((segment, opening.since, opening.x))
        });
    }

    /// Past the last knot the material file decides: stop, or note the rupture and go on under the largest stress.
    ///
    /// # Errors
    /// The reason to stop.
    pub fn stop_past_data(&self, scene: &Scene) -> Result<()> {
        let Some(passed) = self.passed else { return Ok(()) };
        let material = &scene.bar.segments[passed.segment].material;
        if goes_on(material, passed.strain) {
            return Ok(());
        }
        let (reason, help) = record::end_of_data(passed.strain, material);
        Err(RunError { reason, time: passed.time, x: Some(passed.x), help: help.to_owned() }.into())
    }

    /// Nothing has yielded so far.
    pub fn stayed_elastic(&self, bar: &FrontTracking) -> bool {
        !self.yielded && !end_broke(bar)
    }

    /// The bar broke somewhere.
    pub fn ruptured(&self, scene: &Scene, bar: &FrontTracking) -> bool {
        let past_data = |p: Passed| goes_on(&scene.bar.segments[p.segment].material, p.strain);
        self.passed.is_some_and(past_data) || self.gathers.is_some() || end_broke(bar)
    }

    /// Notes for the audit. What happened at t = 0 is left out where theory `told` of it.
    pub fn audit(&self, scene: &Scene, bar: &FrontTracking, told: bool) -> Vec<AuditRow> {
        let segments = &scene.bar.segments;
        let mut rows = Vec::new();
        for (end, (name, segment)) in bar.ends().iter().zip([("left", 0), ("right", segments.len() - 1)]) {
            if let Some(time) = end.above_critical.filter(|&t| t > 0.0 || !told) {
                rows.push(record::broken_end(name, time, &segments[segment].material));
            }
        }
        if let Some((segment, time, x)) = self.gathers {
            rows.push(record::broken_inside(time, x, &segments[segment].material));
        }
        if let Some(Passed { segment, strain, time, x }) = self.passed {
            rows.push(record::past_data(strain, time, x, &segments[segment].material));
        }
        rows
    }
}

/// A bar whose strain is past its data goes on under the largest stress: the material says so, or that stress lies inside
/// the data, and the bar carries no more than that.
fn goes_on(material: &Material, strain: f64) -> bool {
    let curve = material.branch(Sense::of(strain));
    curve.beyond() != Beyond::Error || curve.ultimate().is_some()
}

fn end_broke(bar: &FrontTracking) -> bool {
    bar.ends().iter().any(|end| end.above_critical.is_some())
}

//! What errors are measured against, and how far that itself can be trusted.

use super::ladder::Halt;
use super::measure::{self, Pass, Watch};
use super::rivals::{self, Rival, Run};
use super::shape::Shape;
use super::source::{Family, Resolution, Source};
use crate::bar::{Launch, launches};
use crate::error::Result;
use crate::record;
use crate::scene::{Effects, Scene};
use crate::solver::moc::FrontTracking;

/// Rounding of an exact solution: sums over some thousand steps of double precision.
pub(super) const ROUNDING: f64 = 1e-12;

/// The reference.
pub(super) struct Reference {
    /// In words.
    pub name: String,
    /// What the difference of the two finest runs leaves, or rounding; relative L1.
    pub uncertainty: f64,
    /// Where a run of the scheme itself is the reference: the family and its cells.
    pub grid: Option<(usize, usize)>,
    kind: Kind,
    gauges: Vec<Shape>,
}

enum Kind {
    Similar(Box<Launch>, f64),
    Tracked(Box<FrontTracking>),
    Grid(Vec<(f64, Shape)>),
}

impl Reference {
    /// Stress over the bar at a time at or just after the end time.
    pub fn shape(&self, time: f64) -> Shape {
        match &self.kind {
            Kind::Similar(launch, length) => similar_profile(launch, *length, time),
            Kind::Tracked(bar) => {
                let mut bar = bar.clone();
                // A bar that cannot go on stays where it is, at most one coarse step before that time.
                let _ = bar.advance_to(time);
                measure::shape_of(&bar)
            }
            Kind::Grid(shapes) => {
                let near = shapes.iter().min_by(|a, b| (a.0 - time).abs().total_cmp(&(b.0 - time).abs()));
                near.map_or_else(|| Shape::Points(Vec::new()), |found| found.1.clone())
            }
        }
    }

    /// Relative L1 of stress over the bar of a run, and the largest one over time of its gauges.
    pub fn errors(&self, pass: &Pass) -> (Option<f64>, Option<f64>) {
        let gauges = pass.gauges.iter().zip(&self.gauges).filter_map(|(found, exact)| found.distance(exact));
        (pass.shape.distance(&self.shape(pass.time)), gauges.reduce(f64::max))
    }
}

/// Finds the reference within the watch's time: the self-similar solution, front tracking that keeps every wave, or the surer
/// of the rivals.
pub(super) fn find(
    scene: &Scene,
    source: &Source<'_>,
    families: &[Family],
    ends: &[f64],
    watch: &mut Watch<'_>,
) -> Result<std::result::Result<Reference, Halt>> {
    if let Some(reference) = similar(scene, ends) {
        return Ok(Ok(reference));
    }
    let mut rivals = Vec::new();
    // A taper's staircase is no exact bar, however well its waves are kept.
    let tracking = families.iter().find(|f| matches!(f.rungs[0], Resolution::FrontTolerance(_)) && !tapers(scene));
    if let Some(family) = tracking {
        let scene = source.at(family.way, Resolution::FrontTolerance(0.0))?;
        match rivals::every_wave(&scene, watch) {
            Ok(Some(pass)) if pass.tracked.as_ref().is_some_and(|bar| bar.is_exact()) => {
                let name = "front tracking that keeps every wave, exact for the curve's table";
                return Ok(Ok(tracked_reference(pass, ROUNDING, name.into())));
            }
            Ok(kept) => rivals.push(Rival::of_fronts(scene, kept)),
            Err(halt) => return Ok(Err(halt)),
        }
    }
    if let Some((index, family)) = grid_family(scene, families) {
        rivals.push(Rival::of_grid(index, family));
    }
    if let Some(halt) = rivals::race(&mut rivals, source, ends, watch)? {
        return Ok(Err(halt));
    }
    let known = rivals.into_iter().filter(|r| r.uncertainty().is_some());
    let best = known.min_by(|a, b| a.uncertainty().unwrap_or(0.0).total_cmp(&b.uncertainty().unwrap_or(0.0)));
    Ok(best.and_then(of_rival).ok_or(Halt::OutOfTime))
}

/// The finest run of a rival.
fn of_rival(mut rival: Rival<'_>) -> Option<Reference> {
    let uncertainty = rival.uncertainty()?.max(ROUNDING);
    let Run { fineness, pass } = rival.runs.pop()?;
    let tolerance = 1.0 / fineness;
    Some(match rival.kind {
        rivals::Kind::Fronts { keeps: true, .. } => {
            let steps = format!("ramps in steps of {tolerance:.0e} of the largest stress");
            tracked_reference(pass, uncertainty, format!("front tracking that keeps every wave, {steps}"))
        }
        rivals::Kind::Fronts { keeps: false, .. } => {
            tracked_reference(pass, uncertainty, format!("front tracking with front-tolerance {tolerance:.0e}"))
        }
        rivals::Kind::Grid { index, family } => grid_reference(pass, uncertainty, index, family.names[1]),
    })
}

/// The net where there is one, else leapfrog, else what there is.
fn grid_family<'a>(scene: &Scene, families: &'a [Family]) -> Option<(usize, &'a Family)> {
    let grids = || families.iter().enumerate().filter(|(_, f)| matches!(f.rungs[0], Resolution::Cells(_)));
    let named = |name: &str| grids().find(|(_, f)| f.names[1] == name);
    let net = named("characteristic-net").filter(|_| !tapers(scene));
    net.or_else(|| named("leapfrog")).or_else(|| grids().next())
}

/// The section changes along the bar: methods by characteristics make a staircase of it.
fn tapers(scene: &Scene) -> bool {
    scene.bar.segments.iter().any(|segment| segment.taper.is_some())
}

/// The self-similar solution, where the scene has one up to the last of the end times.
fn similar(scene: &Scene, ends: &[f64]) -> Option<Reference> {
    let last = ends.iter().copied().fold(scene.solve.until, f64::max);
    // It knows unloading, which it does not need, and nothing else.
    let known = Effects { unloading: scene.effects.unloading, ..Effects::default() };
    if scene.effects != known {
        return None;
    }
    let all = launches(&scene.bar, &scene.left, &scene.right);
    let launch = record::alone(&scene.bar, &all, last)?;
    let length = scene.bar.length();
    let gauges = scene.record.gauges.iter().map(|(_, x)| similar_history(launch, *x, last)).collect();
    Some(Reference {
        name: "self-similar solution, exact for the curve's table".into(),
        uncertainty: ROUNDING,
        grid: None,
        kind: Kind::Similar(Box::new(launch.clone()), length),
        gauges,
    })
}

fn similar_profile(launch: &Launch, length: f64, time: f64) -> Shape {
    let mut edges: Vec<f64> = launch.fan.edges.iter().map(|e| launch.x + launch.direction * e.speed * time).collect();
    edges.retain(|x| (0.0..length).contains(x));
    edges.sort_by(f64::total_cmp);
    let borders = std::iter::once(0.0).chain(edges.iter().copied());
    let middles = borders.zip(edges.iter().copied().chain([length])).map(|(a, b)| 0.5 * (a + b));
    let values = middles.map(|x| record::similar_stress(launch, x, time)).collect();
    Shape::Steps { edges, values, ends: [0.0, length] }
}

fn similar_history(launch: &Launch, x: f64, until: f64) -> Shape {
    let distance = (x - launch.x).abs();
    let passing = launch.fan.edges.iter().filter(|e| e.speed > 0.0 && distance <= e.speed * until);
    let (mut edges, mut values) = (Vec::new(), vec![0.0]);
    for edge in passing {
        edges.push(distance / edge.speed);
        values.push(launch.sense.sign() * edge.stress_behind);
    }
    Shape::Steps { edges, values, ends: [0.0, until] }
}

fn tracked_reference(pass: Pass, uncertainty: f64, name: String) -> Reference {
    let kind = match pass.tracked {
        Some(bar) => Kind::Tracked(bar),
        None => Kind::Grid(vec![(pass.time, pass.shape)]),
    };
    Reference { name, uncertainty, grid: None, kind, gauges: pass.gauges }
}

fn grid_reference(pass: Pass, uncertainty: f64, index: usize, scheme: &str) -> Reference {
    let mut shapes = pass.snapshots;
    shapes.push((pass.time, pass.shape));
    let cells = pass.cells;
    Reference {
        name: format!("{scheme} with {cells} cells, a finer run of the same scheme: errors are estimates"),
        uncertainty,
        grid: Some((index, cells)),
        kind: Kind::Grid(shapes),
        gauges: pass.gauges,
    }
}

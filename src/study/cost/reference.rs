//! What errors are measured against, and how far that itself can be trusted.

use super::ladder::Halt;
use super::measure::{self, Pass, Wanted, Watch};
use super::shape::Shape;
use super::source::{Family, Resolution, Source};
use crate::bar::{Launch, launches};
use crate::error::Result;
use crate::record;
use crate::scene::{Effects, Scene};
use crate::solver::moc::{FrontTracking, Settings};

/// Rounding of an exact solution: sums over some thousand steps of double precision.
const ROUNDING: f64 = 1e-12;

/// Share of the time that front tracking may take where a grid is there too.
const TRACKING_SHARE: f64 = 0.5;
/// A reference that is uncertain by more than this is compared with a grid, and the surer of both is taken: where waves
/// are elastic, or fronts meet by the million, that is the grid.
const SURE: f64 = 1e-4;
/// Share of that that it may take for the attempt to keep every wave.
const EXACT_SHARE: f64 = 0.15;
/// Tolerances of references that thin waves, and steps of ramps in those that do not.
const TOLERANCES: [f64; 9] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6];
/// A finer one is expected to take so many times longer.
const GROWTH: f64 = 3.5;
/// Cells of the first grid that may be a reference.
const FIRST_CELLS: usize = 400;

/// The reference.
pub(super) struct Reference {
    /// In words.
    pub name: String,
    /// Difference of the two finest references, or rounding; relative L1.
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

/// Finds the reference within the watch's time.
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
    let (from, until) = (watch.now(), watch.until);
    let has_grid = families.iter().any(|f| matches!(f.rungs[0], Resolution::Cells(_)));
    // A taper's staircase is no exact bar, however well its waves are kept.
    let tracking = families.iter().find(|f| matches!(f.rungs[0], Resolution::FrontTolerance(_)) && !tapers(scene));
    let mut found = Err(Halt::OutOfTime);
    if let Some(family) = tracking {
        let scene = source.at(family.way, Resolution::FrontTolerance(0.0))?;
        watch.until = if has_grid { from + TRACKING_SHARE * (until - from) } else { until };
        found = tracked(&scene, watch);
        watch.until = until;
    }
    if found.as_ref().is_ok_and(|r| r.uncertainty <= SURE) || found.as_ref().is_err_and(|h| *h == Halt::Interrupted) {
        return Ok(found);
    }
    let on_grid = grid(scene, source, families, ends, watch)?;
    Ok(match (found, on_grid) {
        (Ok(tracked), Ok(grid)) => Ok(if grid.uncertainty < tracked.uncertainty { grid } else { tracked }),
        (_, Err(Halt::Interrupted)) => Err(Halt::Interrupted),
        (Ok(tracked), Err(_)) => Ok(tracked),
        (Err(_), grid) => grid,
    })
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

/// Front tracking: every wave, or as many as the time allows.
fn tracked(scene: &Scene, watch: &mut Watch<'_>) -> std::result::Result<Reference, Halt> {
    let (from, until) = (watch.now(), watch.until);
    let settings = |front_tolerance, ramp_step| Settings {
        front_tolerance,
        ramp_step,
        event_budget: u64::MAX,
        ..Settings::default()
    };
    let run = |settings: Settings, watch: &mut Watch<'_>| {
        measure::pass(scene, Wanted { gauges: true, snapshots: &[], settings: Some(settings) }, watch)
    };
    watch.what = "reference: front tracking, every wave".into();
    watch.until = from + EXACT_SHARE * (until - from);
    let every_wave = run(settings(0.0, None), watch);
    watch.until = until;
    let all_kept = match every_wave {
        Ok(pass) if pass.tracked.as_ref().is_some_and(|bar| bar.is_exact()) => {
            let name = "front tracking that keeps every wave, exact for the curve's table";
            return Ok(tracked_reference(pass, ROUNDING, name.into()));
        }
        Ok(pass) => Some(pass),
        Err(Halt::OutOfTime | Halt::Failed(_)) => None,
        Err(halt) => return Err(halt),
    };
    let keeps = all_kept.is_some();
    let mut runs: Vec<(f64, Pass)> = all_kept.into_iter().map(|pass| (1e-3, pass)).collect();
    for tolerance in TOLERANCES {
        // Where every wave can be kept, only the steps that ramps are made into get finer.
        if runs.last().is_some_and(|(coarser, pass)| {
            *coarser <= tolerance || watch.now() + GROWTH * pass.seconds > until && runs.len() > 1
        }) {
            continue;
        }
        watch.what = format!("reference: front tracking, tolerance {tolerance:.0e}");
        let one = settings(if keeps { 0.0 } else { tolerance }, Some(tolerance));
        match run(one, watch) {
            Ok(pass) => runs.push((tolerance, pass)),
            Err(Halt::OutOfTime | Halt::Failed(_)) => break,
            Err(halt) => return Err(halt),
        }
        if runs.len() > 2 {
            runs.remove(0);
        }
    }
    let Some((tolerance, finest)) = runs.pop() else { return Err(Halt::OutOfTime) };
    let Some((_, coarser)) = runs.pop() else { return Err(Halt::OutOfTime) };
    let uncertainty = coarser.shape.distance(&finest.shape).unwrap_or(f64::INFINITY);
    let name = if keeps {
        format!("front tracking that keeps every wave, ramps in steps of {tolerance:.0e} of the largest stress")
    } else {
        format!("front tracking with front-tolerance {tolerance:.0e}")
    };
    Ok(tracked_reference(finest, uncertainty.max(ROUNDING), name))
}

fn tracked_reference(pass: Pass, uncertainty: f64, name: String) -> Reference {
    let kind = match pass.tracked {
        Some(bar) => Kind::Tracked(bar),
        None => Kind::Grid(vec![(pass.time, pass.shape)]),
    };
    Reference { name, uncertainty, grid: None, kind, gauges: pass.gauges }
}

/// The finest grid that the time allows: the net where there is one, else leapfrog, else what there is.
fn grid(
    scene: &Scene,
    source: &Source<'_>,
    families: &[Family],
    ends: &[f64],
    watch: &mut Watch<'_>,
) -> Result<std::result::Result<Reference, Halt>> {
    let grids = || families.iter().enumerate().filter(|(_, f)| matches!(f.rungs[0], Resolution::Cells(_)));
    let named = |name: &str| grids().find(|(_, f)| f.names[1] == name);
    let net = named("characteristic-net").filter(|_| !tapers(scene));
    let Some((index, family)) = net.or_else(|| named("leapfrog")).or_else(|| grids().next()) else {
        return Ok(Err(Halt::OutOfTime));
    };
    let mut runs: Vec<Pass> = Vec::new();
    let mut cells = FIRST_CELLS;
    loop {
        if runs.len() > 1 && runs.last().is_some_and(|r| watch.now() + 4.5 * r.seconds > watch.until) {
            break;
        }
        watch.what = format!("reference: {}, {cells} cells", family.names[1]);
        let scene = source.at(family.way, Resolution::Cells(cells))?;
        match measure::pass(&scene, Wanted { gauges: true, snapshots: ends, settings: None }, watch) {
            Ok(pass) => runs.push(pass),
            Err(Halt::OutOfTime) if runs.len() > 1 => break,
            Err(halt) => return Ok(Err(halt)),
        }
        if runs.len() > 2 {
            runs.remove(0);
        }
        cells *= 2;
    }
    let (Some(finest), Some(coarser)) = (runs.pop(), runs.pop()) else { return Ok(Err(Halt::OutOfTime)) };
    let mut shapes = finest.snapshots;
    shapes.push((finest.time, finest.shape));
    let mut reference = Reference {
        name: format!(
            "{} with {} cells, a finer run of the same scheme: errors are estimates",
            family.names[1], finest.cells
        ),
        uncertainty: 0.0,
        grid: Some((index, finest.cells)),
        kind: Kind::Grid(shapes),
        gauges: finest.gauges,
    };
    let apart = coarser.shape.distance(&reference.shape(coarser.time));
    reference.uncertainty = apart.unwrap_or(f64::INFINITY).max(ROUNDING);
    Ok(Ok(reference))
}

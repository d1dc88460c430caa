//! Measures how long the solver takes for a run on this machine, from the start of the run and from coarse runs of the same scene.

use super::history_places;
use super::limits::{check_start, limits};
use crate::assemble;
use crate::record::{Stepped, Traces};
use crate::scene::{Method, Scene};
use crate::simulate::{Interval, Simulation, Solver, simulate};
use crate::snapshot::Snapshot;
use crate::solver::fd::Sampling;
use crate::solver::moc::{FrontTracking, Settings};
use serde::Serialize;
use std::time::Instant;

/// Time limit of the start of the run, and of each coarse run, s.
const LIMIT: f64 = 0.2;

/// Number of clock readings during a run on a grid; a full run makes about as many between its steps.
const SAMPLES: usize = 400;

/// Events between two clock readings.
const EVENTS: u64 = 500;

/// Largest number of cells that is tried. The time of a larger grid is extrapolated with the square of the cells.
const MOST_CELLS: usize = 1 << 20;
/// Smallest number of cells of a coarse run, which still shows where the work is.
const LEAST_CELLS: usize = 50;

/// Uncertainty factors of the time: of a run that was tried completely, which differs from one time to the next, and of an extrapolated run.
const WHOLE: f64 = 1.4;
const EXTRAPOLATED: f64 = 2.0;

/// Result of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Trial {
    /// Shortest and longest expected time of the solver, s.
    #[serde(rename = "expected_s")]
    pub seconds: [f64; 2],
    /// Number of events, if front tracking is used and the whole run was tried.
    #[serde(rename = "expected_events", skip_serializing_if = "Option::is_none")]
    pub events: Option<u64>,
    /// Fraction of the end time up to which the run was tried; 1 for the whole run.
    #[serde(rename = "tried_share")]
    pub share: f64,
}

/// Tries a scene for some tenths of a second. A scene that requires discretization into pieces must already be discretized, see [`Scene::in_pieces`].
pub fn trial(scene: &Scene) -> Trial {
    let method = scene.solve.method;
    let tried = method.with_cells(method.cells().unwrap_or_default().min(MOST_CELLS));
    let start = follow(scene, tried);
    let whole = if start.ended { start.seconds() } else { extrapolated(scene, tried, &start) };
    let larger = method.cells().unwrap_or_default() as f64 / tried.cells().unwrap_or_default().max(1) as f64;
    let mut seconds = larger.max(1.0).powi(2) * whole;
    if let Method::FrontTracking { event_budget, .. } = method {
        seconds = seconds.min(event_budget as f64 * start.seconds() / start.events.max(1) as f64);
    }
    let events = (start.ended && tried.cells().is_none()).then_some(start.events);
    let factor = if start.ended && larger <= 1.0 { WHOLE } else { EXTRAPOLATED };
    Trial { seconds: [seconds / factor, seconds * factor], events, share: start.share() }
}

/// Largest number of coarse runs that are tried until one of them reaches its end within [`LIMIT`].
const COARSE_RUNS: usize = 4;

/// Returns the expected time of a run of which only the start was tried, s.
fn extrapolated(scene: &Scene, tried: Method, start: &CostCurve) -> f64 {
    let Some((method, coarse)) = coarse_run(scene, tried, start) else { return start.seconds() / start.share() };
    let by_start = start.seconds() / coarse.part(start.share());
    let (Some(cells), Some(fewer)) = (tried.cells(), method.cells()) else { return by_start };
    // The work on a grid is proportional to the square of the cells. The start, when most cells are quiescent, is a poor measure of the time once
    // waves are everywhere; the further it reaches, the larger its weight.
    let by_cells = coarse.whole() * (cells as f64 / fewer as f64).powi(2);
    by_start.powf(start.share()) * by_cells.powf(1.0 - start.share())
}

/// Runs coarser versions of a scene. Returns the first one that reaches its end, or the last one tried.
fn coarse_run(scene: &Scene, tried: Method, start: &CostCurve) -> Option<(Method, CostCurve)> {
    let mut method = coarser(tried, start)?;
    let mut course = follow(scene, method);
    for _ in 1..COARSE_RUNS {
        let Some(next) = (if course.ended { None } else { coarser(method, &course) }) else { break };
        (method, course) = (next, follow(scene, next));
    }
    Some((method, course))
}

/// Returns a method whose run takes about half of [`LIMIT`], given the course of `start`; `None` if no coarser method exists.
fn coarser(method: Method, start: &CostCurve) -> Option<Method> {
    let less = (0.5 * LIMIT * start.share() / start.seconds()).sqrt();
    if let Method::FrontTracking { front_tolerance, event_budget } = method {
        let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
        let coarser = settings.coarser().front_tolerance.max(front_tolerance / less);
        return (coarser > 0.0).then(|| method.with_front_tolerance(coarser));
    }
    let cells = (less * method.cells()? as f64) as usize;
    Some(method.with_cells(cells.max(LEAST_CELLS))).filter(|coarse| coarse.cells() < method.cells())
}

/// Computing time of a run as a function of its progress.
#[derive(Debug, Default)]
struct CostCurve {
    /// Fraction of the end time, and solver time up to then, s.
    points: Vec<[f64; 2]>,
    /// Number of events up to the last point.
    events: u64,
    /// Whether the run reached its end, or cannot continue.
    ended: bool,
}

impl CostCurve {
    fn seconds(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point[1])
    }

    /// Returns the fraction of the end time that was reached; at least `f64::EPSILON`, because it is used as a divisor.
    fn share(&self) -> f64 {
        if self.ended { 1.0 } else { self.points.last().map_or(0.0, |point| point[0]).max(f64::EPSILON) }
    }

    /// Returns the time of the whole run, s: an extrapolation at the average rate if the run did not reach its end.
    fn whole(&self) -> f64 {
        self.seconds() / self.share()
    }

    /// Returns the fraction of the total time that is spent when this fraction of the end time is reached. A run that did not reach its end is
    /// assumed to continue at its average rate.
    fn part(&self, share: f64) -> f64 {
        let next = self.points.partition_point(|point| point[0] < share);
        let [before, after] = [next.wrapping_sub(1), next].map(|k| self.points.get(k));
        let whole = self.whole();
        let at = match (before, after) {
            (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (share - a[0]) / (b[0] - a[0]),
            (None, Some(b)) => b[1] * share / b[0],
            (_, None) => whole * share,
        };
        if at > 0.0 { at / whole } else { share }
    }
}

/// Runs a scene by a method for at most [`LIMIT`] and returns its course.
fn follow(scene: &Scene, method: Method) -> CostCurve {
    let scene = &scene.by(method);
    assemble::solve(scene, Task { scene })
}

struct Task<'a> {
    scene: &'a Scene,
}

impl assemble::Task for Task<'_> {
    type Output = CostCurve;

    fn on_grid(self, mut bar: impl Stepped + Snapshot) -> CostCurve {
        let scene = self.scene;
        let places = Sampling::at(bar.grid(), history_places(scene));
        let mut log = Traces::new(places, scene.effects.heat.is_some(), bar.sudden_loads().ends);
        bar.watch(&log);
        bar.add_to(&mut log);
        let steps = bar.grid().steps_to(scene.solve.until);
        let next = move |bar: &_| (Stepped::step(bar) + (steps / SAMPLES).max(1)).min(steps);
        let at = move |bar: &_| (Stepped::step(bar) as f64 / steps as f64, 0);
        let stops = |bar: &_| limits(bar).iter().any(|limit| limit.stops(scene));
        let course = CostCurve { ended: check_start(scene).is_err(), ..CostCurve::default() };
        Tried { bar, log, next, at, stops, work: u64::MAX, course }.course()
    }

    fn by_fronts(self, settings: Settings) -> CostCurve {
        let (scene, until) = (self.scene, self.scene.solve.until);
        let before = Instant::now();
        let bar = assemble::front_tracking(scene, Settings { front_segments: true, stop_at_limits: true, ..settings });
        let course = CostCurve { points: vec![[0.0, before.elapsed().as_secs_f64()]], ..CostCurve::default() };
        let at = move |bar: &FrontTracking| (bar.time() / until, bar.events());
        Tried { bar, log: Vec::new(), next: move |_: &_| until, at, stops: |_: &_| false, work: EVENTS, course }
            .course()
    }
}

/// Bar that is simulated for a limited time.
struct Tried<S: Solver, N, A, E> {
    bar: S,
    log: S::Log,
    /// Returns the next mark at which the bar is read.
    next: N,
    /// Returns the fraction of the end time, and the number of events.
    at: A,
    /// Returns whether the bar has reached a limit beyond which its material has no data.
    stops: E,
    /// Largest work between two looks.
    work: u64,
    course: CostCurve,
}

impl<S, N, A, E> Tried<S, N, A, E>
where
    S: Solver,
    N: Fn(&S) -> S::Mark,
    A: Fn(&S) -> (f64, u64),
    E: Fn(&S) -> bool,
{
    fn course(mut self) -> CostCurve {
        let work = self.work;
        // If the simulation ends early, the course covers the time up to then.
        let _: Result<(), Early> = simulate(&mut self, work);
        self.course
    }
}

/// Marker that the trial ended before the end time.
struct Early;

impl<S, N, A, E> Simulation for Tried<S, N, A, E>
where
    S: Solver,
    N: Fn(&S) -> S::Mark,
    A: Fn(&S) -> (f64, u64),
    E: Fn(&S) -> bool,
{
    type Solver = S;
    type Error = Early;

    fn next(&self) -> Option<S::Mark> {
        (!self.course.ended).then(|| (self.next)(&self.bar))
    }

    fn bar(&mut self) -> (&mut S, Option<&mut S::Log>) {
        (&mut self.bar, Some(&mut self.log))
    }

    fn look(&mut self, interval: Interval) -> Result<(), Early> {
        let (share, events) = (self.at)(&self.bar);
        let seconds = self.course.seconds() + interval.seconds;
        self.course.points.push([share, seconds]);
        self.course.events = events;
        self.course.ended = share >= 1.0 || interval.arrived.is_err() || (self.stops)(&self.bar);
        if seconds > LIMIT { Err(Early) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_of_a_course_is_read_between_its_points() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a}, not {b}");
        let course = |points: &[[f64; 2]], ended| CostCurve { points: points.to_vec(), events: 0, ended };
        let whole = course(&[[0.5, 1.0], [1.0, 4.0]], true);
        near(whole.part(0.25), 0.125);
        near(whole.part(0.75), 0.625);
        let begun = course(&[[0.25, 1.0], [0.5, 3.0]], false);
        near(begun.part(0.5), 0.5);
        near(begun.part(0.25), 1.0 / 6.0);
        near(begun.part(0.75), 0.75);
        // A course without points contains no information.
        near(course(&[], false).part(0.3), 0.3);
    }
}

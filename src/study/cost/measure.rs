//! One way to solve the scene, run without any recording: what it gives, and how long its steps take.

use std::time::Instant;

use super::ladder::Halt;
use super::shape::Shape;
use crate::assemble;
use crate::record::{StepGauges, Stepped, Trace, Traces};
use crate::run::{self, Wish};
use crate::scene::{Method, Scene};
use crate::solver::fd::{Quantity, Sampling};
use crate::solver::moc::{FrontTracking, Settings, Stopped};

/// Work between two looks at the clock: some milliseconds.
const CELL_STEPS: usize = 4_000_000;
const EVENTS: u64 = 5_000;

/// A run that takes longer than this is timed once, s; shorter ones are repeated for about `REPEAT_FOR`.
const LONG: f64 = 1.0;
const REPEAT_FOR: f64 = 0.15;
const MOST_REPEATS: f64 = 41.0;

/// The study's clock, its end, and the one who may ask it to stop.
pub(super) struct Watch<'a> {
    pub started: Instant,
    /// Time at which the part of the study under way has to end, s.
    pub until: f64,
    /// What is under way, for the progress line.
    pub what: String,
    /// Told what is under way and how much time has gone, s.
    pub progress: &'a mut dyn FnMut(&str, f64) -> Wish,
}

impl Watch<'_> {
    /// Time since the study started, s.
    pub fn now(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Shows progress; an error where the run under way has to end.
    pub fn look(&mut self) -> Result<(), Halt> {
        let now = self.now();
        if (self.progress)(&self.what, now) == Wish::Stop {
            return Err(Halt::Interrupted);
        }
        if now > self.until { Err(Halt::OutOfTime) } else { Ok(()) }
    }
}

/// What one run gave.
#[derive(Debug)]
pub(super) struct Pass {
    /// Stepping time, s.
    pub seconds: f64,
    /// End time, s.
    pub time: f64,
    /// Stress over the bar at the end time.
    pub shape: Shape,
    /// Stress over time at the gauges.
    pub gauges: Vec<Shape>,
    /// Stress over the bar at the times asked for, as far as steps come near them, with their own times.
    pub snapshots: Vec<(f64, Shape)>,
    /// Cells; 0 where there are none.
    pub cells: usize,
    /// Cell-steps or events.
    pub work: u64,
    /// The bar at the end, where fronts are tracked.
    pub tracked: Option<Box<FrontTracking>>,
}

/// What is wanted of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted<'a> {
    /// Gauge histories.
    pub gauges: bool,
    /// Shapes at these times too, s, increasing; on grids only.
    pub snapshots: &'a [f64],
    /// Settings of front tracking other than those that the scene's method says.
    pub settings: Option<Settings>,
}

impl Wanted<'_> {
    /// The stepping time alone.
    pub const TIME: Self = Self { gauges: false, snapshots: &[], settings: None };
    /// What a point of the study is judged by.
    pub const RESULT: Self = Self { gauges: true, snapshots: &[], settings: None };
}

/// Runs the scene's bar once. This is the one place in which the study chooses solvers.
pub(super) fn pass(scene: &Scene, wanted: Wanted<'_>, watch: &mut Watch<'_>) -> Result<Pass, Halt> {
    let cut = scene.in_pieces();
    let scene = cut.as_ref().unwrap_or(scene);
    match scene.solve.method {
        Method::Leapfrog { cells, cfl } => stepped(scene, assemble::leapfrog(scene, cells, cfl), wanted, watch),
        Method::Muscl { cells, cfl } => stepped(scene, assemble::muscl(scene, cells, cfl), wanted, watch),
        Method::CharacteristicNet { cells } => {
            stepped(scene, assemble::characteristic_net(scene, cells), wanted, watch)
        }
        Method::FrontTracking { front_tolerance, event_budget } => {
            let own = Settings { front_tolerance, event_budget, ..Settings::default() };
            tracked(scene, wanted.settings.unwrap_or(own), wanted, watch)
        }
    }
}

/// Stepping times of a scene's bar: the median, and the distance between the quartiles over the median.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Timing {
    pub median: f64,
    pub shortest: f64,
    pub spread: f64,
    pub repetitions: usize,
}

/// Repeats a run whose first pass took `first`, s.
pub(super) fn repeated(scene: &Scene, first: f64, watch: &mut Watch<'_>) -> Result<Timing, Halt> {
    if first >= LONG {
        return Ok(Timing { median: first, shortest: first, spread: 0.0, repetitions: 1 });
    }
    let mut times = Vec::new();
    for _ in 0..repeats(first) {
        times.push(pass(scene, Wanted::TIME, watch)?.seconds);
    }
    Ok(timing(times))
}

/// Repetitions of a run that takes so long, beside its first pass: an odd number, so that the median is one of them.
fn repeats(seconds: f64) -> usize {
    let count = (REPEAT_FOR / seconds).clamp(3.0, MOST_REPEATS) as usize;
    count | 1
}

/// All passes of a run that takes so long.
pub(super) fn passes(seconds: f64) -> f64 {
    if seconds >= LONG { 1.0 } else { 1.0 + repeats(seconds) as f64 }
}

/// Median and relative distance of the quartiles.
pub(super) fn timing(mut times: Vec<f64>) -> Timing {
    times.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let place = part * (times.len() - 1) as f64;
        let below = place.floor() as usize;
        let above = (below + 1).min(times.len() - 1);
        times[below] + (place - below as f64) * (times[above] - times[below])
    };
    let median = at(0.5);
    let spread = if median > 0.0 { (at(0.75) - at(0.25)) / median } else { 0.0 };
    Timing { median, shortest: times[0], spread, repetitions: times.len() }
}

/// A grid, step by step.
fn stepped<S: Stepped>(scene: &Scene, mut bar: S, wanted: Wanted<'_>, watch: &mut Watch<'_>) -> Result<Pass, Halt> {
    let (cells, dt) = (bar.grid().cells(), bar.grid().dt);
    let centres = bar.grid().centres();
    let places: Vec<f64> = scene.record.gauges.iter().map(|g| g.1).collect();
    let places = Sampling::at(bar.grid(), if wanted.gauges { places } else { Vec::new() });
    let mut traces = (!places.x().is_empty()).then(|| Traces::new(places, false));
    if let Some(traces) = &traces {
        bar.watch(traces);
    }
    let shape = |bar: &S| {
        let mut stress = vec![0.0; cells];
        bar.profile(Quantity::Stress, &mut stress);
        Shape::Points(centres.iter().copied().zip(stress).collect())
    };
    let (end, mut seconds, mut result) = (run::steps(scene, dt), 0.0, None);
    let last = wanted.snapshots.last().map_or(end, |&t| end.max((t / dt).round() as usize));
    let due: Vec<usize> = wanted.snapshots.iter().map(|t| (t / dt).round() as usize).collect();
    let mut snapshots = Vec::new();
    let burst = (CELL_STEPS / cells).max(1);
    while bar.step() < last {
        let next = due.iter().copied().chain([end, last]).filter(|&s| s > bar.step()).min().unwrap_or(last);
        let stop = next.min(bar.step() + burst);
        let before = Instant::now();
        match &mut traces {
            Some(traces) => bar.advance_logging(stop - bar.step(), traces),
            None => bar.advance_by(stop - bar.step()),
        }
        if bar.step() <= end {
            seconds += before.elapsed().as_secs_f64();
        }
        if bar.step() == end {
            result = Some((bar.time(), shape(&bar)));
        }
        if due.contains(&bar.step()) {
            snapshots.push((bar.time(), shape(&bar)));
        }
        watch.look()?;
    }
    if bar.not_finite().is_some() {
        return Err(Halt::Failed("a stress is not a finite number".into()));
    }
    let (time, shape) = result.unwrap_or_else(|| (bar.time(), shape(&bar)));
    let points = |trace: Trace| Shape::Points(trace.time.into_iter().zip(trace.stress).collect());
    let gauges = traces.map_or_else(Vec::new, |mut traces| traces.take().0.into_iter().map(points).collect());
    Ok(Pass { seconds, time, shape, gauges, snapshots, cells, work: (cells * end) as u64, tracked: None })
}

/// Fronts, burst by burst. That the bar is laid out, with its first Riemann problems, is part of the time.
fn tracked(scene: &Scene, settings: Settings, wanted: Wanted<'_>, watch: &mut Watch<'_>) -> Result<Pass, Halt> {
    let places: Vec<f64> = if wanted.gauges { scene.record.gauges.iter().map(|g| g.1).collect() } else { Vec::new() };
    let trails = !places.is_empty();
    let until = scene.solve.until;
    let mut gauges = StepGauges::new(&scene.bar, &places, until);
    let before = Instant::now();
    let mut bar = assemble::front_tracking(scene, Settings { trails, ..settings });
    let mut seconds = before.elapsed().as_secs_f64();
    loop {
        bar.set_event_budget((bar.events() + EVENTS).min(settings.event_budget));
        let before = Instant::now();
        let ended = bar.advance_to(until);
        seconds += before.elapsed().as_secs_f64();
        if trails {
            let trails = bar.take_trails();
            gauges.collect(&bar, &trails);
        }
        match ended {
            Ok(()) => break,
            Err(Stopped::EventBudget { events, .. }) if events < settings.event_budget => {}
            Err(why) => return Err(Halt::Failed(why.to_string())),
        }
        watch.look()?;
    }
    if trails {
        gauges.close(&bar, &[]);
    }
    let gauges = gauges.take().iter().map(|trace| Shape::from_rows(&trace.time, &trace.stress)).collect();
    let shape = shape_of(&bar);
    bar.set_event_budget(u64::MAX);
    let work = bar.events();
    let tracked = Some(Box::new(bar));
    Ok(Pass { seconds, time: until, shape, gauges, snapshots: Vec::new(), cells: 0, work, tracked })
}

/// Stress over a tracked bar now.
pub(super) fn shape_of(bar: &FrontTracking) -> Shape {
    let (mut edges, mut values, mut length) = (Vec::new(), Vec::new(), 0.0);
    for piece in bar.pieces() {
        if values.last() == Some(&piece.point.stress) {
            length = piece.to;
            continue;
        }
        if !values.is_empty() {
            edges.push(piece.from);
        }
        values.push(piece.point.stress);
        length = piece.to;
    }
    if values.is_empty() {
        values.push(0.0);
    }
    Shape::Steps { edges, values, ends: [0.0, length] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_runs_are_repeated_an_odd_number_of_times_and_long_ones_once() {
        assert_eq!(repeats(1e-6), 41);
        assert_eq!(repeats(0.05), 3);
        assert_eq!(repeats(0.02), 7);
        assert_eq!(passes(2.0), 1.0);
        assert_eq!(passes(0.05), 4.0);
    }

    #[test]
    fn the_median_and_the_quartiles_do_not_mind_one_hiccup() {
        let found = timing(vec![1.0, 2.0, 3.0, 4.0, 1000.0]);
        assert_eq!(found, Timing { median: 3.0, shortest: 1.0, spread: 2.0 / 3.0, repetitions: 5 });
        assert_eq!(timing(vec![0.5]).median, 0.5);
    }
}

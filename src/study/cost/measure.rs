//! One solution of the scene without recording: its response and its stepping time.

use std::ops::ControlFlow;
use std::time::Instant;

use super::refinement::Halt;
use crate::accuracy::{Ended, Respond, Response, ResponseRequest, respond};
use crate::assemble;
use crate::record::Stepped;
use crate::scene::{Method, Scene};
use crate::snapshot::Snapshot;
use crate::solver::moc::Settings;
use crate::solver::net;

/// Work between two readings of the clock, corresponding to some milliseconds.
const CELL_STEPS: u64 = 4_000_000;
const EVENTS: u64 = 5_000;

/// Runs longer than `LONG` (s) are timed once; shorter runs are repeated for about `REPEAT_FOR` (s), at most `MOST_REPEATS` times.
const LONG: f64 = 1.0;
const REPEAT_FOR: f64 = 0.15;
const MOST_REPEATS: f64 = 41.0;

/// Clock of the study, its deadline, and the progress callback, which can stop it.
pub(super) struct Watch<'a> {
    pub started: Instant,
    /// Time at which the current part of the study has to end, s.
    pub until: f64,
    /// Current activity, for the progress line.
    pub what: String,
    /// Called with the current activity and the elapsed time, s; `Break` stops the study.
    pub progress: &'a mut dyn FnMut(&str, f64) -> ControlFlow<()>,
}

impl Watch<'_> {
    /// Returns the time since the study started, s.
    pub fn now(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Reports progress. Returns an error if the current run has to end.
    pub fn look(&mut self) -> Result<(), Halt> {
        let now = self.now();
        if (self.progress)(&self.what, now).is_break() {
            return Err(Halt::Interrupted);
        }
        if now > self.until { Err(Halt::OutOfTime) } else { Ok(()) }
    }
}

/// Result of one run.
#[derive(Debug)]
pub(super) struct Pass {
    /// Stepping time, s.
    pub seconds: f64,
    /// Response of the bar, with fields at those of the requested instants that are close to a step; empty if no instants were requested.
    pub response: Response,
    /// Number of cells; 0 without a grid.
    pub cells: usize,
    /// Number of cell-steps or events.
    pub work: u64,
    /// Further results of front tracking.
    pub tracked: Option<Tracked>,
}

/// Results of a run by front tracking.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tracked {
    /// See [`crate::solver::moc::FrontTracking::is_exact`].
    pub exact: bool,
    /// Constant pieces of the bar at the end.
    pub pieces: usize,
}

/// Quantities that a run has to provide.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted<'a> {
    /// Instants of the fields of the response, s, increasing; if empty, only the stepping time is determined.
    pub instants: &'a [f64],
    /// Settings of front tracking that replace those of the scene's method.
    pub settings: Option<Settings>,
}

impl<'a> Wanted<'a> {
    /// Only the stepping time.
    pub const TIME: Self = Self { instants: &[], settings: None };

    /// Requests the response by which a point of the study is judged.
    pub fn response(instants: &'a [f64]) -> Self {
        Self { instants, settings: None }
    }
}

/// Returns the time step of a scene's grid, s, or `None` without a grid.
pub(super) fn time_step(scene: &Scene) -> Option<f64> {
    let cut = scene.in_pieces();
    let scene = cut.as_ref().unwrap_or(scene);
    match scene.solve.method {
        Method::Leapfrog { cells, cfl } | Method::Muscl { cells, cfl } => Some(assemble::grid(scene, cells, cfl).dt),
        Method::CharacteristicNet { cells } => Some(net::grid(&scene.bar, cells).dt),
        Method::FrontTracking { .. } => None,
    }
}

/// Runs the bar of the scene once.
pub(super) fn pass(scene: &Scene, wanted: Wanted<'_>, watch: &mut Watch<'_>) -> Result<Pass, Halt> {
    let cut = scene.in_pieces();
    let scene = cut.as_ref().unwrap_or(scene);
    assemble::solve(scene, Task { scene, wanted, watch })
}

/// Stepping times of repeated runs, s: the median, the shortest, and the interquartile range relative to the median.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Timing {
    pub median: f64,
    pub shortest: f64,
    pub spread: f64,
    pub repetitions: usize,
}

/// Times a run by repetition. `first` is the stepping time of its first pass, s; long runs are not repeated.
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

/// Returns the number of repetitions after the first pass of a run of this length (s). The number is odd, so that the median is one of the times.
fn repeats(seconds: f64) -> usize {
    let count = (REPEAT_FOR / seconds).clamp(3.0, MOST_REPEATS) as usize;
    count | 1
}

/// Returns the total number of passes of a run of this length (s).
pub(super) fn passes(seconds: f64) -> f64 {
    if seconds >= LONG { 1.0 } else { 1.0 + repeats(seconds) as f64 }
}

/// Returns the statistics of stepping times.
pub(super) fn timing(mut times: Vec<f64>) -> Timing {
    times.sort_by(f64::total_cmp);
    let median = quantile(&times, 0.5);
    let spread = if median > 0.0 { interquartile_range(&times) / median } else { 0.0 };
    Timing { median, shortest: times[0], spread, repetitions: times.len() }
}

/// Returns the interquartile range of increasing values.
pub(super) fn interquartile_range(sorted: &[f64]) -> f64 {
    quantile(sorted, 0.75) - quantile(sorted, 0.25)
}

/// Returns the value below which this part of increasing values lies, linearly interpolated.
fn quantile(sorted: &[f64], part: f64) -> f64 {
    let place = part * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// A single run of a bar.
struct Task<'a, 'w> {
    scene: &'a Scene,
    wanted: Wanted<'a>,
    watch: &'a mut Watch<'w>,
}

impl assemble::Task for Task<'_, '_> {
    type Output = Result<Pass, Halt>;

    fn on_grid(self, mut bar: impl Stepped + Snapshot) -> Result<Pass, Halt> {
        let (response, seconds) = self.respond(&mut bar, CELL_STEPS)?;
        if bar.not_finite().is_some() {
            return Err(Halt::Failed("a stress is not a finite number".into()));
        }
        let cells = bar.grid().cells();
        Ok(Pass { seconds, response, cells, work: (cells * bar.step()) as u64, tracked: None })
    }

    /// The time includes the construction of the bar with its first Riemann problems.
    fn by_fronts(self, settings: Settings) -> Result<Pass, Halt> {
        let read = !self.scene.record.gauges.is_empty() || !self.scene.joints().is_empty();
        let listens = read && !self.wanted.instants.is_empty();
        let settings = Settings { front_segments: listens, ..self.wanted.settings.unwrap_or(settings) };
        let before = Instant::now();
        let mut bar = assemble::front_tracking(self.scene, settings);
        let laid_out = before.elapsed().as_secs_f64();
        let (response, seconds) = self.respond(&mut bar, EVENTS)?;
        let tracked = Tracked { exact: bar.is_exact(), pieces: bar.pieces().count() };
        Ok(Pass { seconds: laid_out + seconds, response, cells: 0, work: bar.events(), tracked: Some(tracked) })
    }
}

impl Task<'_, '_> {
    /// Returns the response of a bar and the time spent in the solver, s.
    fn respond<S: Respond>(self, bar: &mut S, work: u64) -> Result<(Response, f64), Halt> {
        let Self { scene, wanted, watch } = self;
        let (gauges, joints) = (scene.record.gauge_places(), scene.joints());
        let (instants, until) = (wanted.instants, scene.solve.until);
        let course = ResponseRequest { instants, gauges: &gauges, joints: &joints, until, work };
        respond(&scene.bar, bar, course, |_, _| watch.look()).map_err(|ended| match ended {
            Ended::Stopped(why) => Halt::Failed(why.to_string()),
            Ended::Caller(halt) => halt,
        })
    }
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

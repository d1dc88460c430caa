//! Simulation of a bar for its response only, without recorders.

use super::joint_forces::joint_places;
use super::recorders::{FrontRecorder, GridRecorder};
use super::response::Response;
use crate::bar::Bar;
use crate::record::{JointRows, StepGauges, Stepped, Traces};
use crate::simulate::{Interval, Simulation, Solver, simulate};
use crate::solver::fd::Sampling;
use crate::solver::moc::{FrontSegment, FrontTracking, Stopped};

/// Quantities requested from the simulation of a bar.
#[derive(Debug, Clone, Copy)]
pub struct ResponseRequest<'a> {
    /// Instants of the fields, s, increasing; if empty, no response is recorded.
    pub instants: &'a [f64],
    /// Positions of the gauges, m.
    pub gauges: &'a [f64],
    /// Joints whose forces are recorded, given by the segments to their left.
    pub joints: &'a [usize],
    /// Time up to which the bar is simulated at least, s.
    pub until: f64,
    /// Work between two calls of `pause`: cell-steps, or events.
    pub work: u64,
}

/// Reason for which a simulation ended early.
#[derive(Debug, Clone, PartialEq)]
pub enum Ended<E> {
    /// The solver stopped.
    Stopped(Stopped),
    /// The caller stopped the simulation.
    Caller(E),
}

/// Solver whose response can be recorded.
pub trait Respond: Solver + Sized {
    /// Recorder of the response.
    type Recorder: RecordResponse<Self>;
}

impl<S: Stepped> Respond for S {
    type Recorder = OnGrid;
}

impl Respond for FrontTracking {
    type Recorder = OfFronts;
}

/// Recorder of the response of a bar at the places and instants of a [`ResponseRequest`].
pub trait RecordResponse<S: Solver>: Sized {
    /// Creates the recorder of a bar before its start, and the log that the solver fills during the simulation.
    fn start(scene: &Bar, bar: &mut S, request: ResponseRequest<'_>) -> (Self, Option<S::Log>);

    /// Returns the next mark at which the bar must be read; `None` at the end.
    fn next(&self, bar: &S) -> Option<S::Mark>;

    /// Returns the mark at the end of the simulation.
    fn last(&self) -> S::Mark;

    /// Adds what happened since the last call; `arrived` is true if the bar has reached the mark.
    fn record_interval(&mut self, bar: &S, log: Option<&mut S::Log>, arrived: bool);

    /// Returns the recorded response.
    fn response(self, bar: &S) -> Response;
}

/// Simulates a bar; returns its response and the time spent in the solver, s. `pause` is called at intervals with the
/// bar and its last mark, and can end the simulation.
///
/// # Errors
/// [`Ended`] if the solver stops or `pause` returns an error.
pub fn respond<S: Respond, E>(
    scene: &Bar,
    bar: &mut S,
    request: ResponseRequest<'_>,
    pause: impl FnMut(&S, S::Mark) -> Result<(), E>,
) -> Result<(Response, f64), Ended<E>> {
    let (recorder, log) = S::Recorder::start(scene, bar, request);
    let mut responding = Responding { bar, log, recorder, pause, seconds: 0.0 };
    simulate(&mut responding, request.work)?;
    Ok((responding.recorder.response(responding.bar), responding.seconds))
}

struct Responding<'a, S: Respond, P> {
    bar: &'a mut S,
    log: Option<S::Log>,
    recorder: S::Recorder,
    pause: P,
    /// Time spent in the solver, s.
    seconds: f64,
}

impl<S: Respond, E, P: FnMut(&S, S::Mark) -> Result<(), E>> Simulation for Responding<'_, S, P> {
    type Solver = S;
    type Error = Ended<E>;

    fn next(&self) -> Option<S::Mark> {
        self.recorder.next(self.bar)
    }

    fn bar(&mut self) -> (&mut S, Option<&mut S::Log>) {
        (self.bar, self.log.as_mut())
    }

    fn look(&mut self, interval: Interval) -> Result<(), Ended<E>> {
        self.seconds += interval.seconds;
        self.recorder.record_interval(self.bar, self.log.as_mut(), interval.arrived == Ok(true));
        interval.arrived.map_err(Ended::Stopped)?;
        (self.pause)(self.bar, self.recorder.last()).map_err(Ended::Caller)
    }
}

/// Recorder of a bar on a grid.
#[derive(Debug)]
pub struct OnGrid {
    /// Recorder; `None` if no response is recorded.
    recorder: Option<GridRecorder>,
    joints: JointRows,
    steps: usize,
}

impl<S: Stepped> RecordResponse<S> for OnGrid {
    fn start(scene: &Bar, bar: &mut S, request: ResponseRequest<'_>) -> (Self, Option<Traces>) {
        let steps = bar.grid().steps_to(request.until);
        let joints = JointRows::new(scene, bar.grid(), request.joints);
        if request.instants.is_empty() {
            return (Self { recorder: None, joints, steps }, None);
        }
        let places = request.gauges.iter().copied().chain(joints.places()).collect();
        let mut traces = Traces::new(Sampling::at(bar.grid(), places), false, bar.sudden_loads().ends);
        let mut recorder = GridRecorder::new(scene, bar, request.instants, request.gauges.len(), request.joints);
        bar.watch(&traces);
        bar.add_to(&mut traces);
        recorder.read_fields(bar);
        let steps = steps.max(recorder.last());
        (Self { recorder: Some(recorder), joints, steps }, Some(traces))
    }

    fn next(&self, bar: &S) -> Option<usize> {
        let due = || self.recorder.as_ref().and_then(|recorder| recorder.next(bar.step()));
        (bar.step() < self.steps).then(|| due().unwrap_or(self.steps).min(self.steps))
    }

    fn last(&self) -> usize {
        self.steps
    }

    fn record_interval(&mut self, bar: &S, log: Option<&mut Traces>, _: bool) {
        let (Some(recorder), Some(traces)) = (&mut self.recorder, log) else { return };
        recorder.read_fields(bar);
        let last = bar.step() == self.steps;
        if last {
            traces.close();
        }
        if traces.is_full() || last {
            let (mut gauges, ends) = traces.take();
            self.joints.join(&mut gauges);
            recorder.add_rows(&gauges, &ends, bar.ruptures());
        }
    }

    fn response(self, _: &S) -> Response {
        self.recorder.map_or_else(Response::default, |recorder| recorder.response())
    }
}

/// Recorder of a front-tracking bar. Gauges and joints need its front segments, see [`crate::solver::moc::Settings::front_segments`].
#[derive(Debug)]
pub struct OfFronts {
    /// Recorder; `None` if no response is recorded.
    recorder: Option<FrontRecorder>,
    gauges: StepGauges,
    /// Instants of the remaining fields, s, the next one last; an end time without a field comes first.
    due: Vec<f64>,
    until: f64,
}

impl RecordResponse<FrontTracking> for OfFronts {
    fn start(scene: &Bar, _: &mut FrontTracking, request: ResponseRequest<'_>) -> (Self, Option<Vec<FrontSegment>>) {
        let until = request.instants.last().copied().unwrap_or(0.0).max(request.until);
        let mut due: Vec<f64> = request.instants.iter().rev().copied().collect();
        if due.first() != Some(&until) {
            due.insert(0, until);
        }
        let recorder =
            (!request.instants.is_empty()).then(|| FrontRecorder::new(scene, request.gauges.len(), request.joints));
        let places = [request.gauges, &joint_places(scene, request.joints)].concat();
        let front_segments = (recorder.is_some() && !places.is_empty()).then(Vec::new);
        (Self { recorder, gauges: StepGauges::new(scene, &places, until), due, until }, front_segments)
    }

    fn next(&self, _: &FrontTracking) -> Option<f64> {
        self.due.last().copied()
    }

    fn last(&self) -> f64 {
        self.until
    }

    fn record_interval(&mut self, bar: &FrontTracking, log: Option<&mut Vec<FrontSegment>>, arrived: bool) {
        let passed = if arrived { self.due.pop() } else { None };
        let Some(recorder) = &mut self.recorder else { return };
        if let Some(front_segments) = log {
            self.gauges.collect(bar, front_segments);
            front_segments.clear();
            recorder.add_rows(&self.gauges.take(), bar.ruptures());
        }
        if passed.is_some() {
            recorder.read_fields(bar);
        }
    }

    fn response(mut self, bar: &FrontTracking) -> Response {
        let Some(mut recorder) = self.recorder else { return Response::default() };
        self.gauges.close(bar, &[]);
        recorder.add_rows(&self.gauges.take(), bar.ruptures());
        recorder.response(bar)
    }
}

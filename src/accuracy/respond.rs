//! Simulation of a bar for its response only, without recorders.

use super::joint_forces::joint_places;
use super::listen::{FrontListener, GridListener};
use super::response::Response;
use crate::bar::Bar;
use crate::record::{JointRows, StepGauges, Stepped, Traces};
use crate::simulate::{Interval, Simulation, Solver, simulate};
use crate::solver::fd::Sampling;
use crate::solver::moc::{FrontSegment, FrontTracking, Stopped};

/// Quantities requested from the simulation of a bar.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
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
    Asked(E),
}

/// Solver whose response can be recorded.
pub trait Respond: Solver + Sized {
    /// Recorder of the response.
    type Listener: Listen<Self>;
}

impl<S: Stepped> Respond for S {
    type Listener = OnGrid;
}

impl Respond for FrontTracking {
    type Listener = OfFronts;
}

/// Recorder of the response of a bar at the places and instants of a [`Course`].
pub trait Listen<S: Solver>: Sized {
    /// Creates the recorder of a bar before its start, and the log that the solver fills during the simulation.
    fn start(scene: &Bar, bar: &mut S, course: Course<'_>) -> (Self, Option<S::Log>);

    /// Returns the next mark at which the bar must be read; `None` at the end.
    fn next(&self, bar: &S) -> Option<S::Mark>;

    /// Returns the mark at the end of the simulation.
    fn last(&self) -> S::Mark;

    /// Adds what happened since the last call; `arrived` is true if the bar has reached the mark.
    fn look(&mut self, bar: &S, log: Option<&mut S::Log>, arrived: bool);

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
    course: Course<'_>,
    pause: impl FnMut(&S, S::Mark) -> Result<(), E>,
) -> Result<(Response, f64), Ended<E>> {
    let (listener, log) = S::Listener::start(scene, bar, course);
    let mut responding = Responding { bar, log, listener, pause, seconds: 0.0 };
    simulate(&mut responding, course.work)?;
    Ok((responding.listener.response(responding.bar), responding.seconds))
}

struct Responding<'a, S: Respond, P> {
    bar: &'a mut S,
    log: Option<S::Log>,
    listener: S::Listener,
    pause: P,
    /// Time spent in the solver, s.
    seconds: f64,
}

impl<S: Respond, E, P: FnMut(&S, S::Mark) -> Result<(), E>> Simulation for Responding<'_, S, P> {
    type Solver = S;
    type Error = Ended<E>;

    fn next(&self) -> Option<S::Mark> {
        self.listener.next(self.bar)
    }

    fn bar(&mut self) -> (&mut S, Option<&mut S::Log>) {
        (self.bar, self.log.as_mut())
    }

    fn look(&mut self, interval: Interval) -> Result<(), Ended<E>> {
        self.seconds += interval.seconds;
        self.listener.look(self.bar, self.log.as_mut(), interval.arrived == Ok(true));
        interval.arrived.map_err(Ended::Stopped)?;
        (self.pause)(self.bar, self.listener.last()).map_err(Ended::Asked)
    }
}

/// Recorder of a bar on a grid.
#[derive(Debug)]
pub struct OnGrid {
    /// Recorder; `None` if no response is recorded.
    listener: Option<GridListener>,
    joints: JointRows,
    steps: usize,
}

impl<S: Stepped> Listen<S> for OnGrid {
    fn start(scene: &Bar, bar: &mut S, course: Course<'_>) -> (Self, Option<Traces>) {
        let steps = bar.grid().steps_to(course.until);
        let joints = JointRows::new(scene, bar.grid(), course.joints);
        if course.instants.is_empty() {
            return (Self { listener: None, joints, steps }, None);
        }
        let places = course.gauges.iter().copied().chain(joints.places()).collect();
        let mut traces = Traces::new(Sampling::at(bar.grid(), places), false, bar.sudden_loads().ends);
        let mut listener = GridListener::new(scene, bar, course.instants, course.gauges.len(), course.joints);
        bar.watch(&traces);
        bar.add_to(&mut traces);
        listener.look(bar);
        let steps = steps.max(listener.last());
        (Self { listener: Some(listener), joints, steps }, Some(traces))
    }

    fn next(&self, bar: &S) -> Option<usize> {
        let due = || self.listener.as_ref().and_then(|listener| listener.next(bar.step()));
        (bar.step() < self.steps).then(|| due().unwrap_or(self.steps).min(self.steps))
    }

    fn last(&self) -> usize {
        self.steps
    }

    fn look(&mut self, bar: &S, log: Option<&mut Traces>, _: bool) {
        let (Some(listener), Some(traces)) = (&mut self.listener, log) else { return };
        listener.look(bar);
        let last = bar.step() == self.steps;
        if last {
            traces.close();
        }
        if traces.is_full() || last {
            let (mut gauges, ends) = traces.take();
            self.joints.join(&mut gauges);
            listener.hear(&gauges, &ends, bar.ruptures());
        }
    }

    fn response(self, _: &S) -> Response {
        self.listener.map_or_else(Response::default, |listener| listener.response())
    }
}

/// Recorder of a front-tracking bar. Gauges and joints need its front segments, see [`crate::solver::moc::Settings::front_segments`].
#[derive(Debug)]
pub struct OfFronts {
    /// Recorder; `None` if no response is recorded.
    listener: Option<FrontListener>,
    gauges: StepGauges,
    /// Instants of the remaining fields, s, the next one last; an end time without a field comes first.
    due: Vec<f64>,
    until: f64,
}

impl Listen<FrontTracking> for OfFronts {
    fn start(scene: &Bar, _: &mut FrontTracking, course: Course<'_>) -> (Self, Option<Vec<FrontSegment>>) {
        let until = course.instants.last().copied().unwrap_or(0.0).max(course.until);
        let mut due: Vec<f64> = course.instants.iter().rev().copied().collect();
        if due.first() != Some(&until) {
            due.insert(0, until);
        }
        let listener =
            (!course.instants.is_empty()).then(|| FrontListener::new(scene, course.gauges.len(), course.joints));
        let places = [course.gauges, &joint_places(scene, course.joints)].concat();
        let front_segments = (listener.is_some() && !places.is_empty()).then(Vec::new);
        (Self { listener, gauges: StepGauges::new(scene, &places, until), due, until }, front_segments)
    }

    fn next(&self, _: &FrontTracking) -> Option<f64> {
        self.due.last().copied()
    }

    fn last(&self) -> f64 {
        self.until
    }

    fn look(&mut self, bar: &FrontTracking, log: Option<&mut Vec<FrontSegment>>, arrived: bool) {
        let passed = if arrived { self.due.pop() } else { None };
        let Some(listener) = &mut self.listener else { return };
        if let Some(front_segments) = log {
            self.gauges.collect(bar, front_segments);
            front_segments.clear();
            listener.hear(&self.gauges.take(), bar.ruptures());
        }
        if passed.is_some() {
            listener.look(bar);
        }
    }

    fn response(mut self, bar: &FrontTracking) -> Response {
        let Some(mut listener) = self.listener else { return Response::default() };
        self.gauges.close(bar, &[]);
        listener.hear(&self.gauges.take(), bar.ruptures());
        listener.response(bar)
    }
}

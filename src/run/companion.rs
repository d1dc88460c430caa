//! Companion runs of a front-tracking bar: those with other tolerances for the error estimate, and the search for a tolerance with
//! which the run stays within the event limit.

use super::{Progress, accuracy};
use crate::accuracy::{Companions, Course, Ended, INSTANTS, Response, SAFETY_OF_TRACKING, respond};
use crate::assemble;
use crate::error::{Error, Result};
use crate::record::{ErrorFigure, ErrorTable};
use crate::scene::{Scene, TaperDiscretization};
use crate::solver::moc::{COMPANION_RATIO, FrontTracking, Settings};
use std::ops::ControlFlow;

/// The largest tolerance that is tried when a run used up its events: stresses are off by about this part, and a larger one is no advice.
pub(super) const LARGEST_TRIED: f64 = 0.1;
/// Powers of one over the tolerance with which events are taken to grow: at least, and at most.
const GROWTH: [f64; 2] = [1.0, 3.0];
/// Part of the events that are left which the last try is expected to take.
const SAFE: f64 = 0.7;
/// A try is worth its events where it is finer by this.
const WORTHWHILE: f64 = 1.2;

/// What a step of a companion's staircase may reflect at the most.
const COARSEST: f64 = 0.5;

/// A run is exact as long as rounding of places has moved no larger part of its energy than this.
const ROUNDING: f64 = 1e-9;

/// Events between two calls of the progress function.
const BURST: u64 = 20_000;

/// Instants at which the responses of tracked bars are compared, s.
pub(super) fn instants(until: f64) -> Vec<f64> {
    (1..=INSTANTS).map(|k| until * k as f64 / INSTANTS as f64).collect()
}

/// A tracked bar at the last of some instants (s, increasing) and its response there, followed without recorders; none where it used up
/// its events, or came to an end of its own.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` requests a stop.
pub(super) fn tracked(
    scene: &Scene,
    settings: Settings,
    instants: &[f64],
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Option<(FrontTracking, Response)>> {
    let (gauges, joints) = (scene.record.gauge_places(), scene.joints());
    let front_segments = !gauges.is_empty() || !joints.is_empty();
    let mut bar = assemble::front_tracking(scene, Settings { front_segments, ..settings });
    let course = Course { instants, gauges: &gauges, joints: &joints, until: 0.0, work: BURST };
    let found = respond(&scene.bar, &mut bar, course, |bar, until| {
        let at = Progress::Fronts { time: bar.time(), until, events: bar.events(), fronts: bar.front_count() };
        if progress(at).is_break() { Err(Error::Interrupted) } else { Ok(()) }
    });
    match found {
        Ok((response, _)) => Ok(Some((bar, response))),
        Err(Ended::Stopped(_)) => Ok(None),
        Err(Ended::Asked(interrupted)) => Err(interrupted),
    }
}

/// How far a finished run may be off that gave `response`. None where the companion does not get to the end.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` requests a stop.
pub(super) fn error_figure(
    scene: &Scene,
    settings: Settings,
    run: &FrontTracking,
    response: &Response,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Option<ErrorFigure>> {
    if run.is_exact() && scene.discretized.is_none() {
        return Ok(Some(exact(run.unresolved())));
    }
    let Some(companions) = companions(scene, settings, (run, response), progress)? else { return Ok(None) };
    let pieces = if staircase(scene).is_some() { " and coarser uniform pieces" } else { "" };
    let with = steps(companions.finer().unwrap_or(settings.coarser()));
    let reference = format!("run with {with}{pieces}, safety factor {SAFETY_OF_TRACKING} (estimate)");
    Ok(Some(accuracy::figure(companions.errors(run, response), reference)))
}

/// How finely the fronts of a companion are kept apart, in words.
fn steps(settings: Settings) -> String {
    if settings.front_tolerance > 0.0 {
        format!("front-tolerance {:.1e}", settings.front_tolerance)
    } else {
        format!("ramps in steps of {:.1e}", settings.step())
    }
}

/// Companions of a finished run that gave `response`. None where the coarser one does not get to the end.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` requests a stop.
pub(super) fn companions(
    scene: &Scene,
    settings: Settings,
    (run, response): (&FrontTracking, &Response),
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Option<Companions>> {
    let instants = response.instants();
    // The error of a staircase goes with its steps.
    let coarser_pieces =
        |cut: &TaperDiscretization| cut.original.discretized_finer_than((COMPANION_RATIO * cut.share).min(COARSEST));
    let staircase = staircase(scene).map(coarser_pieces);
    let coarser = tracked(staircase.as_ref().unwrap_or(scene), settings.coarser(), &instants, progress)?;
    let Some((bar, coarser)) = coarser else { return Ok(None) };
    let companions = Companions::coarser(response, &coarser);
    if staircase.is_some() {
        return Ok(Some(companions));
    }
    let follow = |settings| tracked(scene, settings, &instants, progress);
    companions.with_finer((run, response), bar.events(), settings, follow).map(Some)
}

/// How a scene's tapers and initial states were cut into pieces. None without steps, as of a taper so slight that it is one piece.
fn staircase(scene: &Scene) -> Option<&TaperDiscretization> {
    scene.discretized.as_deref().filter(|cut| cut.of.len() > cut.original.bar.segments.len() || cut.steps > 0)
}

/// Of a run whose fronts were all kept; `unresolved` is what part of its energy rounding moved.
fn exact(unresolved: f64) -> ErrorFigure {
    let (value, reference) = if unresolved > ROUNDING {
        (unresolved, "fraction of the energy in waves too short for the rounding of positions (estimate)")
    } else {
        (0.0, "exact solution for the tabulated curve: no fronts were merged")
    };
    accuracy::figure(ErrorTable::of(|_| Some(value)), reference.into())
}

/// A front tolerance with which a run was seen to reach its end within its events; none where none of those tried does. They are tried
/// from the coarsest one on, which is the cheapest, and all of them together take no more events than the run may.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` requests a stop.
pub(super) fn tolerance_that_carries(
    scene: &Scene,
    settings: Settings,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Option<f64>> {
    let (mut left, mut tolerance) = (settings.event_budget, LARGEST_TRIED);
    let mut carries: Option<(f64, f64)> = None;
    while tolerance > settings.front_tolerance {
        let tried = Settings { front_tolerance: tolerance, event_budget: left, ..settings };
        let Some((bar, _)) = tracked(scene, tried, &[scene.solve.until], progress)? else { break };
        let events = bar.events().max(1) as f64;
        left = left.saturating_sub(bar.events());
        let next = next_tried((tolerance, events), carries, SAFE * left as f64);
        carries = Some((tolerance, events));
        if next * WORTHWHILE > tolerance {
            break;
        }
        tolerance = next;
    }
    Ok(carries.map(|(tolerance, _)| tolerance))
}

/// The next tolerance to try after one with its events, and the one before: finer by the ratio of companions, or as fine as so many events are
/// expected to carry. Rounded up to two digits, so that the one that is advised is the one that was tried.
fn next_tried((tolerance, events): (f64, f64), before: Option<(f64, f64)>, most: f64) -> f64 {
    let seen = before.map(|(coarser, fewer)| (events / fewer).ln() / (coarser / tolerance).ln());
    let growth = seen.map_or(GROWTH[1], |seen| seen.clamp(GROWTH[0], GROWTH[1]));
    let finer = (most / events).powf(1.0 / growth).min(COMPANION_RATIO);
    let next = tolerance / finer;
    let digit = 10_f64.powi(next.log10().floor() as i32 - 1);
    (next / digit).ceil() * digit
}

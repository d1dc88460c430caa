//! Companion runs of a front-tracking run: runs with other tolerances for the error estimate, and the search for a tolerance with which the run stays
//! within the event limit.

use super::{Progress, accuracy};
use crate::accuracy::{Companions, Ended, INSTANTS, Response, ResponseRequest, SAFETY_OF_TRACKING, respond};
use crate::assemble;
use crate::error::{Error, Result};
use crate::record::{ErrorFigure, ErrorTable};
use crate::scene::{Scene, TaperDiscretization};
use crate::solver::moc::{COMPANION_RATIO, FrontTracking, Settings};
use std::ops::ControlFlow;

/// Largest tolerance that is tried after a run has reached its event limit. Stress errors are of about this relative size; a larger tolerance is not
/// worth recommending.
pub(super) const LARGEST_TRIED: f64 = 0.1;
/// Smallest and largest exponent of 1/tolerance assumed for the growth of the number of events.
const GROWTH: [f64; 2] = [1.0, 3.0];
/// Fraction of the remaining events that the last try is expected to need.
const SAFE: f64 = 0.7;
/// Smallest refinement for which a further try is worth its events.
const WORTHWHILE: f64 = 1.2;

/// Upper bound of the fraction of a wave that a step of a companion's staircase may reflect.
const COARSEST: f64 = 0.5;

/// Largest fraction of its energy that rounding of positions may move in a run that counts as exact.
const ROUNDING: f64 = 1e-9;

/// Events between two calls of the progress function.
const BURST: u64 = 20_000;

/// Returns the instants at which the responses of front-tracking runs are compared, s.
pub(super) fn instants(until: f64) -> Vec<f64> {
    (1..=INSTANTS).map(|k| until * k as f64 / INSTANTS as f64).collect()
}

/// Simulates a bar by front tracking up to the last of some instants (s, increasing), without recorders. Returns the bar and its response, or `None`
/// if the solver stopped early, for example at its event limit.
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
    let request = ResponseRequest { instants, gauges: &gauges, joints: &joints, until: 0.0, work: BURST };
    let found = respond(&scene.bar, &mut bar, request, |bar, until| {
        let at = Progress::Fronts { time: bar.time(), until, events: bar.events(), fronts: bar.front_count() };
        if progress(at).is_break() { Err(Error::Interrupted) } else { Ok(()) }
    });
    match found {
        Ok((response, _)) => Ok(Some((bar, response))),
        Err(Ended::Stopped(_)) => Ok(None),
        Err(Ended::Caller(interrupted)) => Err(interrupted),
    }
}

/// Returns the error estimate of a finished run with this `response`; `None` if its companion does not reach the end.
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

/// Returns the resolution of a companion, in words.
fn steps(settings: Settings) -> String {
    if settings.front_tolerance > 0.0 {
        format!("front-tolerance {:.1e}", settings.front_tolerance)
    } else {
        format!("ramps in steps of {:.1e}", settings.step())
    }
}

/// Simulates the companions of a finished run with this `response`. Returns `None` if the coarser one does not reach the end.
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
    // The error of a staircase is proportional to its steps.
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

/// Returns the discretization of a scene's tapers and initial states into pieces; `None` if it has no steps, for example for a taper so slight that
/// it is one piece.
fn staircase(scene: &Scene) -> Option<&TaperDiscretization> {
    scene.discretized.as_deref().filter(|cut| cut.of.len() > cut.original.bar.segments.len() || cut.steps > 0)
}

/// Returns the error of a run in which no fronts were merged; `unresolved` is the fraction of its energy that rounding moved.
fn exact(unresolved: f64) -> ErrorFigure {
    let (value, reference) = if unresolved > ROUNDING {
        (unresolved, "fraction of the energy in waves too short for the rounding of positions (estimate)")
    } else {
        (0.0, "exact solution for the tabulated curve: no fronts were merged")
    };
    accuracy::figure(ErrorTable::of(|_| Some(value)), reference.into())
}

/// Returns a front tolerance with which a run was found to reach its end within its event limit; `None` if no tried tolerance does. Tolerances are
/// tried from the coarsest (cheapest) one on, and together need no more events than the run may take.
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

/// Returns the next tolerance to try, from the last tolerance with its events and the one `before`. It is finer by the ratio of companions, or as
/// fine as the events `most` are expected to allow, whichever is coarser. It is rounded up to two digits, so that the recommended tolerance is
/// exactly the one that was tried.
fn next_tried((tolerance, events): (f64, f64), before: Option<(f64, f64)>, most: f64) -> f64 {
    let seen = before.map(|(coarser, fewer)| (events / fewer).ln() / (coarser / tolerance).ln());
    let growth = seen.map_or(GROWTH[1], |seen| seen.clamp(GROWTH[0], GROWTH[1]));
    let finer = (most / events).powf(1.0 / growth).min(COMPANION_RATIO);
    let next = tolerance / finer;
    let digit = 10_f64.powi(next.log10().floor() as i32 - 1);
    (next / digit).ceil() * digit
}

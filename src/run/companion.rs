//! Companion runs of a tracked bar: one with a coarser tolerance, from which the error figure comes, and the search for a
//! tolerance that stays within a budget of events.

use super::{Progress, Wish};
use crate::assemble;
use crate::error::{Error, Result};
use crate::record::ErrorFigure;
use crate::scene::Scene;
use crate::solver::moc::{COARSER, FrontTracking, SAFETY, Settings, Stopped};

/// Tolerances that are tried when a run used up its events: the largest, and the smallest.
const LARGEST_TRIED: f64 = 0.5;
const SMALLEST_TRIED: f64 = 1e-3;

/// What a step of a companion's staircase may reflect at the most.
const COARSEST: f64 = 0.5;

/// A run is exact as long as rounding of places has moved no larger part of its energy than this.
const ROUNDING: f64 = 1e-9;

pub(super) const MEASURE: &str = "relative L1 of stress over the bar at the end time";

/// What the error of a tracked run covers.
const TRACKED: &str = "larger of the relative L1 errors of stress and of plastic strain over the bar at the end time";

/// Events between two calls of the progress function.
const BURST: u64 = 20_000;

/// A tracked bar at a time, s, followed without recorders; none where it took more than `most` events, or came to an end of its own.
///
/// # Errors
/// [`Error::Interrupted`] where `progress` asked to stop.
pub(super) fn tracked(
    scene: &Scene,
    settings: Settings,
    most: u64,
    until: f64,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Result<Option<FrontTracking>> {
    let mut bar = assemble::front_tracking(scene, settings);
    loop {
        let at = Progress::Fronts { time: bar.time(), until, events: bar.events(), fronts: bar.front_count() };
        if progress(at) == Wish::Stop {
            return Err(Error::Interrupted);
        }
        bar.set_event_budget((bar.events() + BURST).min(most));
        match bar.advance_to(until) {
            Ok(()) => return Ok(Some(bar)),
            Err(Stopped::EventBudget { events, .. }) if events < most => {}
            Err(_) => return Ok(None),
        }
    }
}

/// How far stresses and plastic strains of a finished run may be off. None where the companion does not get to the end.
///
/// # Errors
/// [`Error::Interrupted`] where `progress` asked to stop.
pub(super) fn error_figure(
    scene: &Scene,
    settings: Settings,
    run: &FrontTracking,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Result<Option<ErrorFigure>> {
    if run.is_exact() && scene.cut.is_none() {
        return Ok(Some(exact(run.unresolved())));
    }
    let coarser = coarser(settings);
    let staircase = coarser_staircase(scene);
    let staircase_or_scene = staircase.as_ref().unwrap_or(scene);
    let companion = tracked(staircase_or_scene, coarser, settings.event_budget, run.time(), progress)?;
    let Some(companion) = companion else { return Ok(None) };
    let value = run.error_figure(&companion).max(run.unresolved());
    let pieces = if staircase.is_some() { " and a coarser staircase" } else { "" };
    let reference = if coarser.front_tolerance > 0.0 {
        format!("run with front-tolerance {:.1e}{pieces}, times {SAFETY}: an estimate", coarser.front_tolerance)
    } else {
        format!("run with ramps in steps of {:.1e}{pieces}, times {SAFETY}: an estimate", coarser.step())
    };
    Ok(Some(ErrorFigure { value, measure: TRACKED.into(), reference }))
}

/// The scene with its tapers in coarser pieces than the run's: the error of a staircase goes with what its steps reflect. None
/// without steps, as of a taper so slight that it is one piece.
fn coarser_staircase(scene: &Scene) -> Option<Scene> {
    let cut = scene.cut.as_ref().filter(|cut| cut.reflects > 0.0)?;
    Some(cut.asked.cut_finer_than((COARSER * cut.reflects).min(COARSEST)))
}

/// Of a run whose fronts were all kept; `unresolved` is what part of its energy rounding moved.
fn exact(unresolved: f64) -> ErrorFigure {
    let (value, reference) = if unresolved > ROUNDING {
        (unresolved, "part of the energy in waves so short that places are rounded: an estimate")
    } else {
        (0.0, "exact solution for the curve's table: nothing was merged")
    };
    ErrorFigure { value, measure: TRACKED.into(), reference: reference.into() }
}

/// The settings of a companion: three times the error. That of thinned waves goes with the tolerance; that of ramps with the
/// square of their steps, which are larger than tolerances below [`crate::solver::moc::RAMP_STEP`].
pub(super) fn coarser(settings: Settings) -> Settings {
    let front_tolerance = COARSER * settings.front_tolerance;
    let ramps = if settings.front_tolerance < settings.step() { COARSER.sqrt() } else { COARSER };
    Settings {
        front_tolerance,
        ramp_step: Some(front_tolerance.max(ramps * settings.step())),
        trails: false,
        ..settings
    }
}

/// A front tolerance with which a run was seen to reach its end within its events; none where none of those tried does. They are tried
/// from the coarsest one on, which is the cheapest, and all of them together take no more events than the run may.
///
/// # Errors
/// [`Error::Interrupted`] where `progress` asked to stop.
pub(super) fn tolerance_that_carries(
    scene: &Scene,
    settings: Settings,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Result<Option<f64>> {
    let (mut left, mut tolerance, mut carries) = (settings.event_budget, LARGEST_TRIED, None);
    while tolerance >= SMALLEST_TRIED.max(COARSER * settings.front_tolerance) {
        let tried = Settings { front_tolerance: tolerance, trails: false, ..settings };
        let Some(bar) = tracked(scene, tried, left, scene.solve.until, progress)? else { break };
        carries = Some(tolerance);
        left = left.saturating_sub(bar.events());
        tolerance /= COARSER;
    }
    Ok(carries)
}

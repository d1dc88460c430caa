//! Companion runs of a tracked bar: one with a coarser tolerance, from which the error figure comes, and the search for a
//! tolerance that stays within a budget of events.

use crate::assemble;
use crate::record::ErrorFigure;
use crate::scene::Scene;
use crate::solver::moc::{COARSER, FrontTracking, SAFETY, Settings};

/// Tolerances that are tried when a run used up its events: the first one, and the factor to the next.
const FIRST_TRIED: f64 = 1e-3;
const LARGEST_TRIED: f64 = 0.5;

pub(super) const MEASURE: &str = "relative L1 of stress over the bar at the end time";

/// How far the stresses of a finished run may be off. None where the companion does not get to the end.
pub(super) fn error_figure(scene: &Scene, settings: Settings, run: &FrontTracking) -> Option<ErrorFigure> {
    if run.is_exact() {
        let reference = "exact solution for the curve's table: nothing was merged";
        return Some(ErrorFigure { value: 0.0, measure: MEASURE.into(), reference: reference.into() });
    }
    let coarser = coarser(settings);
    let mut companion = assemble::front_tracking(scene, coarser);
    companion.advance_to(run.time()).ok()?;
    let value = run.error_figure(&companion);
    let reference = format!("run with front-tolerance {:.1e}, times {SAFETY}: an estimate", coarser.front_tolerance);
    Some(ErrorFigure { value, measure: MEASURE.into(), reference })
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

/// The smallest of a row of tolerances with which a run was seen to reach its end within its events; none where none of
/// them does.
pub(super) fn tolerance_that_carries(scene: &Scene, settings: Settings) -> Option<f64> {
    let mut tolerance = FIRST_TRIED.max(COARSER * settings.front_tolerance);
    while tolerance <= LARGEST_TRIED {
        let tried = Settings { front_tolerance: tolerance, trails: false, ..settings };
        if assemble::front_tracking(scene, tried).advance_to(scene.solve.until).is_ok() {
            return Some(tolerance);
        }
        tolerance *= COARSER;
    }
    None
}

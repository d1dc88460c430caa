//! Pilots: coarse runs without recorders, each with an estimate of its error, and the comparison of two methods.

use super::super::accuracy::{self, Coarse};
use super::super::{Progress, companion};
use super::candidate::{
    Candidate, FEW_EVENTS, FIRST_CELLS, FRONT_ORDER, FRONT_ORDERS, LEAST_TOLERANCE, MAX_COST_RATIO, MOST_CELLS, Pilot,
    UNRIVALLED_EVENTS, nominal,
};
use crate::accuracy::{INSTANTS, Response, evenly, extrapolate};
use crate::bar::initial_fans;
use crate::error::{Error, Result};
use crate::record::ErrorTable;
use crate::scene::{Method, Scene};
use crate::solver::moc::{COMPANION_RATIO, FrontTracking, Settings};
use std::ops::ControlFlow;

/// Largest ratio of the error estimate of front tracking to that of a grid for which front tracking can check the grid.
const CHECK_RATIO: f64 = 0.3;

/// Runs the next pilot on a grid and its companions, reusing runs of earlier pilots.
pub(super) fn grid_pilot(
    scene: &Scene,
    candidate: &mut Candidate,
    tolerance: f64,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<()> {
    let method = candidate.next();
    let cells = method.cells().unwrap_or(FIRST_CELLS);
    if cells as f64 > MOST_CELLS {
        candidate.out = Some(format!("it would need more than {MOST_CELLS:.0} cells"));
        return Ok(());
    }
    let instants = instants(scene);
    let grids = accuracy::with_companions(scene, method);
    for &(method, cells) in grids.iter().rev() {
        if candidate.runs.iter().all(|known| known.cells != cells) {
            let run = accuracy::coarse(scene, method, &instants, progress);
            candidate.runs.push(run.ok_or(Error::Interrupted)?);
        }
    }
    let with = |&(_, cells): &(Method, usize)| candidate.runs.iter().find(|run| run.cells == cells);
    let all: Vec<&Coarse> = grids.iter().filter_map(with).collect();
    let responses: Vec<(usize, &Response)> = all.iter().map(|run| (run.cells, &run.response)).collect();
    let (elastic, work) = all.first().map_or((true, 0), |finest| (finest.elastic, finest.work));
    let (table, found) = extrapolate(accuracy::rules(scene, method, elastic), &responses);
    // A single run gives no error estimate.
    let (estimate, worst) = if all.len() > 1 { (found.value, table.worst()) } else { (f64::INFINITY, None) };
    let cells = grids[0].1;
    candidate.add(Pilot { method, cells, estimate, worst, order: found.expected_order, work }, tolerance);
    Ok(())
}

/// Returns the instants at which all grids of a candidate are compared, s: steps of the coarsest grid up to the end.
fn instants(scene: &Scene) -> Vec<f64> {
    let coarsest = scene.bar.transit_time() / (FIRST_CELLS / 8) as f64;
    let steps = (scene.solve.until / coarsest).floor().max(1.0) as usize;
    let all: Vec<f64> = (1..=steps).map(|k| k as f64 * coarsest).collect();
    evenly(&all, 2 * INSTANTS)
}

/// Runs the next pilot of front tracking; stops it if it costs much more than the best other candidate, whose expected time is `rival` (s).
pub(super) fn front_pilot(
    scene: &Scene,
    candidate: &mut Candidate,
    rival: f64,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<()> {
    let method = candidate.next();
    let Method::FrontTracking { front_tolerance, event_budget } = method else { return Ok(()) };
    if front_tolerance < LEAST_TOLERANCE {
        candidate.out = Some(format!("it would need a front tolerance below {LEAST_TOLERANCE:e}"));
        return Ok(());
    }
    let expected = candidate.next_pilot(scene) / nominal(scene, method);
    if rival.is_finite() && expected > event_budget as f64 {
        let why = format!(
            "about {expected:.0e} front interactions are expected with a front tolerance of {front_tolerance:.1e}, and \
             max-events is {event_budget}"
        );
        candidate.out = Some(why);
        return Ok(());
    }
    let worth = match rival.is_finite() {
        true => MAX_COST_RATIO * rival / nominal(scene, method),
        false if candidate.pilots.is_empty() => UNRIVALLED_EVENTS as f64,
        false => event_budget as f64,
    };
    let most = worth.max(4.0 * FEW_EVENTS as f64).min(event_budget as f64) as u64;
    let settings = Settings { front_tolerance, event_budget: most, ..Settings::default() };
    // If the limit does not depend on a rival, the candidate is rejected; otherwise it is only too expensive for now.
    let limited = rival.is_finite() && most < event_budget;
    candidate.too_expensive = None;
    let instants = companion::instants(scene.solve.until);
    let Some((bar, response)) = companion::tracked(scene, settings, &instants, progress)? else {
        let why =
            || format!("there are more than {most} front interactions with a front tolerance of {front_tolerance:.1e}");
        (candidate.too_expensive, candidate.out) = (limited.then_some(most), (!limited).then(why));
        return Ok(());
    };
    let Some(table) = front_estimate(scene, settings, (&bar, &response), progress)? else {
        let coarser = COMPANION_RATIO * front_tolerance;
        let why = || format!("a run with a front tolerance of {coarser:.1e} has more front interactions");
        (candidate.too_expensive, candidate.out) = (limited.then_some(most), (!limited).then(why));
        return Ok(());
    };
    let (estimate, worst) = (table.largest().map_or(0.0, |largest| largest.1), table.worst());
    let before = candidate.pilots.last().filter(|pilot| pilot.is_conclusive()).map(|pilot| pilot.estimate);
    let order = before.map_or(FRONT_ORDER, |before| {
        ((before / estimate).ln() / COMPANION_RATIO.ln()).clamp(FRONT_ORDERS[0], FRONT_ORDERS[1])
    });
    candidate.pilots.push(Pilot { method, cells: 0, estimate, worst, order, work: bar.events() });
    Ok(())
}

/// Compares a finished run on a grid with front tracking. Returns the reason for rejecting the grid if the two differ by more than the sum of their
/// estimates. If a curve has more knots than the grids can resolve, refined grids approach each other faster than the true solution. Returns `None`
/// if both agree, or if front tracking cannot be as accurate for about the work of that run.
pub(super) fn contradiction(
    scene: &Scene,
    run: Pilot,
    tracking: &mut Candidate,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Option<String>> {
    let time = nominal(scene, run.method) * run.work as f64;
    let limit = CHECK_RATIO * run.estimate;
    let is_conclusive = |p: &Pilot| p.estimate <= limit;
    while tracking.out.is_none() && !tracking.pilots.last().is_some_and(is_conclusive) {
        // The time is infinite if a pilot was stopped because of a rival that was expected to cost less.
        let expected = tracking.predicted(scene, limit).map(|(_, time)| time).filter(|time| time.is_finite());
        if expected.unwrap_or(0.0).max(tracking.next_pilot(scene)) > MAX_COST_RATIO * time {
            return Ok(None);
        }
        front_pilot(scene, tracking, time, progress)?;
    }
    let last = tracking.pilots.last().copied().filter(is_conclusive);
    let Some(Pilot { method: Method::FrontTracking { front_tolerance, event_budget }, estimate, .. }) = last else {
        return Ok(None);
    };
    let grid = accuracy::coarse(scene, run.method, &instants(scene), progress).ok_or(Error::Interrupted)?.response;
    let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
    let Some((_, fronts)) = companion::tracked(scene, settings, &grid.instants(), progress)? else {
        return Ok(None);
    };
    let apart = grid.errors(&fronts).largest().map_or(0.0, |largest| largest.1);
    let against = || {
        let cells = run.method.cells().unwrap_or(0);
        format!(
            "with {cells} cells it differs by {apart:.1e} from front tracking with a tolerance of {front_tolerance:.1e}, more \
             than the error estimates of both allow"
        )
    };
    Ok((apart > estimate + run.estimate).then(against))
}

/// Returns the error estimate that the run itself would report.
fn front_estimate(
    scene: &Scene,
    settings: Settings,
    (bar, response): (&FrontTracking, &Response),
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Option<ErrorTable>> {
    if bar.is_exact() {
        return Ok(Some(ErrorTable::of(|_| Some(0.0))));
    }
    let all = initial_fans(&scene.bar, &scene.left, &scene.right);
    let similar = || accuracy::similar(scene, &all, response);
    let table = if let Some(exact) = bar.ruptures().is_empty().then(similar).flatten() {
        response.errors(&exact)
    } else {
        let companions = companion::companions(scene, settings, (bar, response), progress)?;
        let Some(companions) = companions else { return Ok(None) };
        companions.errors(bar, response)
    };
    Ok(Some(table))
}

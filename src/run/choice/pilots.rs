//! Pilots: coarse runs without recorders, each with an estimate of its error, and the comparison of two methods.

use super::super::accuracy::{self, Profile};
use super::super::{Progress, Wish, companion};
use super::racer::{
    FEW_EVENTS, FIRST_CELLS, FRONT_ORDER, FRONT_ORDERS, LEAST_TOLERANCE, MOST_CELLS, PATIENCE, Pilot, Racer, nominal,
};
use crate::bar::launches;
use crate::error::{Error, Result};
use crate::record;
use crate::scene::{Method, Scene};
use crate::solver::moc::{COARSER, FrontTracking, Settings};

/// Front tracking tells something of a grid where its estimate is no more than this part of that one's.
const TELLING: f64 = 0.3;

/// The next pilot of a grid: profiles of the cells, half and a quarter of them, those before from earlier pilots.
pub(super) fn grid_pilot(scene: &Scene, racer: &mut Racer, progress: &mut dyn FnMut(Progress) -> Wish) -> Result<()> {
    let method = racer.next();
    let cells = method.cells().unwrap_or(FIRST_CELLS);
    if cells as f64 > MOST_CELLS {
        racer.out = Some(format!("it would take more than {MOST_CELLS:.0} cells"));
        return Ok(());
    }
    // All grids of the racer are compared at one time: the last step of the coarsest one before the end.
    let coarsest = scene.bar.transit_time() / (FIRST_CELLS / 8) as f64;
    let time = ((scene.solve.until / coarsest).floor().max(1.0) * coarsest).min(scene.solve.until.max(coarsest));
    for cells in [cells / 8, cells / 4, cells / 2, cells] {
        if racer.profiles.iter().all(|(known, _)| *known != cells) {
            let profile = accuracy::profile(scene, method.with_cells(cells), time, progress);
            racer.profiles.push((cells, profile.ok_or(Error::Interrupted)?));
        }
    }
    let with = |cells: usize| racer.profiles.iter().find(move |p| p.0 == cells).map(|p| &p.1);
    let all: Vec<&Profile> = [cells, cells / 2, cells / 4, cells / 8].into_iter().filter_map(with).collect();
    let (found, work) = (accuracy::extrapolate(scene, method, &all), all.first().map_or(0, |fine| fine.work));
    racer.pilots.push(Pilot { method, estimate: found.value, order: found.hope, work });
    Ok(())
}

/// The next pilot of front tracking, given up where it costs much more than the `rival` (s).
pub(super) fn front_pilot(
    scene: &Scene,
    racer: &mut Racer,
    rival: f64,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Result<()> {
    let method = racer.next();
    let Method::FrontTracking { front_tolerance, event_budget } = method else { return Ok(()) };
    if front_tolerance < LEAST_TOLERANCE {
        racer.out = Some(format!("it would take a front tolerance below {LEAST_TOLERANCE:e}"));
        return Ok(());
    }
    let most = (PATIENCE * rival / nominal(scene, method)).max(4.0 * FEW_EVENTS as f64).min(event_budget as f64) as u64;
    let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
    // What would be worth more to nobody is out; else it may come to that yet.
    let limited = most < event_budget;
    racer.dear = None;
    let Some(bar) = companion::tracked(scene, settings, most, scene.solve.until, progress)? else {
        let why = || format!("fronts meet more than {most} times with a front tolerance of {front_tolerance:.1e}");
        (racer.dear, racer.out) = (limited.then_some(most), (!limited).then(why));
        return Ok(());
    };
    let Some(estimate) = front_estimate(scene, settings, &bar, most, progress)? else {
        let coarser = COARSER * front_tolerance;
        let why = || format!("a run with a front tolerance of {coarser:.1e} meets more fronts still");
        (racer.dear, racer.out) = (limited.then_some(most), (!limited).then(why));
        return Ok(());
    };
    let before = racer.pilots.last().map(|p| p.estimate);
    let order = before.map_or(FRONT_ORDER, |before| {
        ((before / estimate).ln() / COARSER.ln()).clamp(FRONT_ORDERS[0], FRONT_ORDERS[1])
    });
    racer.pilots.push(Pilot { method, estimate, order, work: bar.events() });
    Ok(())
}

/// Whether front tracking has something against a finished run on a grid: that they are farther apart than both estimates
/// allow. Grids that are refined come nearer to each other than to the truth where a curve has more knots than they can tell
/// apart. None where fronts cannot be followed so well for about the work of that run, or where
/// both agree.
pub(super) fn contradiction(
    scene: &Scene,
    run: Pilot,
    tracking: &mut Racer,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Result<Option<String>> {
    let time = nominal(scene, run.method) * run.work as f64;
    let tells = |p: &Pilot| p.estimate <= TELLING * run.estimate;
    while tracking.out.is_none() && !tracking.pilots.last().is_some_and(tells) {
        if tracking.next_pilot(scene) > PATIENCE * time {
            return Ok(None);
        }
        front_pilot(scene, tracking, time, progress)?;
    }
    let last = tracking.pilots.last().copied().filter(tells);
    let Some(Pilot { method: Method::FrontTracking { front_tolerance, event_budget }, estimate, .. }) = last else {
        return Ok(None);
    };
    let grid = accuracy::profile(scene, run.method, scene.solve.until, progress).ok_or(Error::Interrupted)?;
    let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
    let fronts = companion::tracked(scene, settings, event_budget, grid.time, progress)?;
    let Some(fronts) = fronts else { return Ok(None) };
    let apart = grid.apart_from_fronts(&fronts);
    let against = || {
        let cells = run.method.cells().unwrap_or(0);
        format!(
            "with {cells} cells it is {apart:.1e} off front tracking with a tolerance of {front_tolerance:.1e}, more than their \
             estimates allow"
        )
    };
    Ok((apart > estimate + run.estimate).then(against))
}

/// The estimate that the run itself would state.
fn front_estimate(
    scene: &Scene,
    settings: Settings,
    bar: &FrontTracking,
    most: u64,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Result<Option<f64>> {
    if bar.is_exact() {
        return Ok(Some(0.0));
    }
    let all = launches(&scene.bar, &scene.left, &scene.right);
    let similar = || record::tracked_against_similarity(&scene.bar, bar, &all);
    if let Some(figure) = bar.ruptures().is_empty().then(similar).flatten() {
        return Ok(Some(figure.value));
    }
    let companion = companion::tracked(scene, companion::coarser(settings), most, scene.solve.until, progress)?;
    Ok(companion.map(|companion| bar.error_figure(&companion)))
}

//! `tolerance`: which method solves a scene cheapest to within a given error, and how finely it has to work.
//!
//! All methods that can do the scene start from their coarsest resolution and are refined in turn, always the one that is
//! expected to be done soonest, until one of them is so near to the tolerance that its last step is safe to foretell. Those
//! pilots hold no recorders. The run itself comes then; where its own estimate misses the tolerance it is refined and
//! repeated. Costs are counted in work, not in measured time, so that a scene is solved alike on every machine.

use std::path::Path;

use super::accuracy::{self, Profile};
use super::{Progress, Wish, companion, once};
use crate::assemble;
use crate::bar::launches;
use crate::error::{Error, Result, RunError};
use crate::record::{self, ChoiceSummary, Summary, Tried};
use crate::scene::{Method, Rate, Scene, Solve};
use crate::solver::moc::{COARSER, FrontTracking, Settings, Stopped};

/// Cells of the first pilot on a grid, with companions of half and a quarter.
const FIRST_CELLS: usize = 128;
/// Front tolerance of the first pilot.
const FIRST_TOLERANCE: f64 = 0.1;

/// Finest that is tried.
const MOST_CELLS: f64 = 5e6;
const LEAST_TOLERANCE: f64 = 1e-8;

/// The run may be finer than its method's last pilot by these factors: estimates that are carried farther miss too often.
const LEAP_CELLS: f64 = 2.5;
const LEAP_TOLERANCE: f64 = 3.5;
/// It is so much finer than foretold, so that it seldom has to be repeated.
const MARGIN: f64 = 1.15;

/// Order in the front tolerance that is assumed until two pilots tell, and those that are believed.
const FRONT_ORDER: f64 = 1.0;
const FRONT_ORDERS: [f64; 2] = [0.5, 1.2];
/// Events grow with this power of one over the tolerance.
const EVENT_GROWTH: f64 = 1.0;

/// Pilots of front tracking with fewer events than this are cheaper than any grid's.
const FEW_EVENTS: u64 = 300;
/// A pilot of front tracking is given up when it costs so many times more than the best grid is expected to.
const PATIENCE: f64 = 2.0;

/// Runs that are repeated because they missed.
const MOST_REPEATS: usize = 6;

/// Nominal time of a cell-step or an event, s: what `barwave plan` and the benches say, flowing cells for the most part.
/// Only the ratios count.
fn nominal(scene: &Scene, method: Method) -> f64 {
    let malvern = matches!(scene.effects.rate, Some(Rate::Malvern { .. }));
    match (method, scene.effects.rate) {
        (Method::FrontTracking { .. }, _) => 0.5e-6,
        (Method::Muscl { .. }, _) => 60e-9,
        (Method::Leapfrog { .. }, None) => 4e-9,
        (Method::Leapfrog { .. }, Some(_)) => {
            if malvern {
                40e-9
            } else {
                150e-9
            }
        }
        (Method::CharacteristicNet { .. }, _) => {
            if malvern {
                20e-9
            } else {
                180e-9
            }
        }
    }
}

/// One method on its way.
struct Racer {
    method: Method,
    pilots: Vec<Pilot>,
    /// Profiles of grids, by cells.
    profiles: Vec<(usize, Profile)>,
    /// It cannot go on, and why.
    out: Option<String>,
}

/// A pilot run.
#[derive(Debug, Clone, Copy)]
struct Pilot {
    method: Method,
    estimate: f64,
    order: f64,
    work: u64,
}

impl Racer {
    fn new(method: Method) -> Self {
        Self { method, pilots: Vec::new(), profiles: Vec::new(), out: None }
    }

    /// What comes after the last pilot.
    fn next(&self) -> Method {
        match (self.pilots.last().map(|p| p.method), self.method) {
            (None, Method::FrontTracking { .. }) => self.method.with_front_tolerance(FIRST_TOLERANCE),
            (None, _) => self.method.with_cells(FIRST_CELLS),
            (Some(last @ Method::FrontTracking { front_tolerance, .. }), _) => {
                last.with_front_tolerance(front_tolerance / COARSER)
            }
            (Some(last), _) => last.with_cells(2 * last.cells().unwrap_or(FIRST_CELLS)),
        }
    }

    /// How many times finer than its last pilot it has to be, and the expected time of that, s; none before the first
    /// pilot, infinite where it is out.
    fn foretold(&self, scene: &Scene, tolerance: f64) -> Option<(f64, f64)> {
        if self.out.is_some() {
            return Some((f64::INFINITY, f64::INFINITY));
        }
        let last = self.pilots.last()?;
        let finer =
            if last.estimate <= tolerance { 1.0 } else { MARGIN * (last.estimate / tolerance).powf(1.0 / last.order) };
        let growth = if last.method.tracks_fronts() { EVENT_GROWTH } else { 2.0 };
        Some((finer, nominal(scene, last.method) * last.work as f64 * finer.powf(growth)))
    }

    /// The method so many times finer than its last pilot.
    fn finer(&self, by: f64) -> Method {
        let last = self.pilots.last().map_or(self.method, |p| p.method);
        refined(last, by)
    }
}

/// A method made finer by a factor; cells are a multiple of four, so that companions fit.
fn refined(method: Method, by: f64) -> Method {
    match (method, method.cells()) {
        (Method::FrontTracking { front_tolerance, .. }, _) => method.with_front_tolerance(front_tolerance / by),
        (_, Some(cells)) => method.with_cells(4 * (cells as f64 * by / 4.0).ceil() as usize),
        _ => method,
    }
}

/// Runs a scene to within its tolerance.
pub(super) fn run(scene: &Scene, output: Option<&Path>, progress: &mut dyn FnMut(Progress) -> Wish) -> Result<Summary> {
    let Some(asked) = &scene.solve.tolerance else { return once(scene, output, progress) };
    let tolerance = asked.value;
    let mut racers: Vec<Racer> = methods(scene, &asked.methods).into_iter().map(Racer::new).collect();
    for _ in 0..=MOST_REPEATS {
        let (winner, finer) = race(scene, tolerance, &mut racers, progress)?;
        let method = racers[winner].finer(finer);
        let why = why(scene, tolerance, &racers, winner);
        let mut chosen = scene.clone();
        chosen.solve.method = method;
        chosen.solve.estimate_error = true;
        let summary = once(&chosen, output, progress)?;
        let work = if summary.events > 0 { summary.events } else { (summary.cells * summary.steps) as u64 };
        let estimate = summary.error.as_ref().map(|e| e.value);
        // Without an estimate the bar came to an end of its own, such as a rupture that no companion follows.
        let Some(missed) = estimate.filter(|e| *e > tolerance) else {
            let mut tried = tried(&racers);
            tried.push(tried_of(method, estimate.unwrap_or(f64::NAN), work));
            return Ok(Summary { choice: Some(ChoiceSummary { tolerance, why, tried }), ..summary });
        };
        let order = racers[winner].pilots.last().map_or(1.0, |p| p.order);
        racers[winner].pilots.push(Pilot { method, estimate: missed, order, work });
    }
    Err(not_reached(scene, tolerance, &tried(&racers)))
}

/// The method and resolution that a run of a scene with a tolerance starts from, and why: the coarse runs are made, but not
/// the run itself. None where the scene names its method, or no method gets there.
pub fn foretell(scene: &Scene) -> Option<(Method, String)> {
    let asked = scene.solve.tolerance.as_ref()?;
    let mut racers: Vec<Racer> = methods(scene, &asked.methods).into_iter().map(Racer::new).collect();
    let (winner, finer) = race(scene, asked.value, &mut racers, &mut |_| Wish::GoOn).ok()?;
    Some((racers[winner].finer(finer), why(scene, asked.value, &racers, winner)))
}

/// Methods whose estimates hold: those that make a staircase of a taper are left out where another one does not need to.
fn methods(scene: &Scene, asked: &[Method]) -> Vec<Method> {
    let whole = |method: &Method| {
        let solve = Solve { method: *method, ..scene.solve.clone() };
        Scene { solve, ..scene.clone() }.in_pieces().is_none()
    };
    let kept: Vec<Method> = asked.iter().copied().filter(whole).collect();
    if kept.is_empty() { asked.to_vec() } else { kept }
}

/// Refines the racers until one is near: its index, and how many times finer than its last pilot it has to be.
fn race(
    scene: &Scene,
    tolerance: f64,
    racers: &mut [Racer],
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Result<(usize, f64)> {
    loop {
        let foretold = |r: &Racer| r.foretold(scene, tolerance);
        let time = |r: &Racer| foretold(r).map_or(0.0, |f| f.1);
        let best = (0..racers.len()).min_by(|&a, &b| time(&racers[a]).total_cmp(&time(&racers[b])));
        let Some(best) = best.filter(|&k| racers[k].out.is_none()) else {
            return Err(not_reached(scene, tolerance, &tried(racers)));
        };
        let tracks = racers[best].method.tracks_fronts();
        let leap = if tracks { LEAP_TOLERANCE } else { LEAP_CELLS };
        if let Some((finer, _)) = foretold(&racers[best]).filter(|f| f.0 <= leap) {
            return Ok((best, finer));
        }
        let others = racers.iter().enumerate().filter(|(k, r)| *k != best && r.out.is_none());
        let rival = others.filter_map(|(_, r)| foretold(r)).map(|f| f.1).fold(f64::INFINITY, f64::min);
        if tracks {
            front_pilot(scene, &mut racers[best], rival, progress)?;
        } else {
            grid_pilot(scene, &mut racers[best], progress)?;
        }
        // Where a handful of events is enough there is nothing to compare.
        let pilot = racers[best].pilots.last();
        if tracks && pilot.is_some_and(|p| p.estimate <= tolerance && p.work <= FEW_EVENTS) {
            return Ok((best, 1.0));
        }
    }
}

/// The next pilot of a grid: profiles of the cells, half and a quarter of them, those before from earlier pilots.
fn grid_pilot(scene: &Scene, racer: &mut Racer, progress: &mut dyn FnMut(Progress) -> Wish) -> Result<()> {
    let method = racer.next();
    let cells = method.cells().unwrap_or(FIRST_CELLS);
    if cells as f64 > MOST_CELLS {
        racer.out = Some(format!("it would take more than {MOST_CELLS:.0} cells"));
        return Ok(());
    }
    // All grids of the racer are compared at one time: the last step of the coarsest one before the end.
    let coarsest = scene.bar.transit_time() / (FIRST_CELLS / 4) as f64;
    let time = ((scene.solve.until / coarsest).floor().max(1.0) * coarsest).min(scene.solve.until.max(coarsest));
    for cells in [cells / 4, cells / 2, cells] {
        if racer.profiles.iter().all(|(known, _)| *known != cells) {
            let profile = accuracy::profile(scene, method.with_cells(cells), time, progress);
            racer.profiles.push((cells, profile.ok_or(Error::Interrupted)?));
        }
    }
    let [quarter, half, fine] = [cells / 4, cells / 2, cells].map(|n| racer.profiles.iter().find(|p| p.0 == n));
    if let (Some((_, quarter)), Some((_, half)), Some((_, fine))) = (quarter, half, fine) {
        let found = accuracy::extrapolate(scene, method, [fine, half, quarter]);
        racer.pilots.push(Pilot { method, estimate: found.value, order: found.order, work: fine.work });
    }
    Ok(())
}

/// The next pilot of front tracking, given up where it costs much more than the `rival` (s).
fn front_pilot(scene: &Scene, racer: &mut Racer, rival: f64, progress: &mut dyn FnMut(Progress) -> Wish) -> Result<()> {
    let method = racer.next();
    let Method::FrontTracking { front_tolerance, event_budget } = method else { return Ok(()) };
    if front_tolerance < LEAST_TOLERANCE {
        racer.out = Some(format!("it would take a front tolerance below {LEAST_TOLERANCE:e}"));
        return Ok(());
    }
    let most = (PATIENCE * rival / nominal(scene, method)).max(4.0 * FEW_EVENTS as f64).min(event_budget as f64) as u64;
    let settings = Settings { front_tolerance, event_budget, ..Settings::default() };
    let Some(bar) = tracked(scene, settings, most, progress)? else {
        racer.out = Some(format!("fronts meet more than {most} times with a front tolerance of {front_tolerance:.1e}"));
        return Ok(());
    };
    let Some(estimate) = front_estimate(scene, settings, &bar, most, progress)? else {
        racer.out =
            Some(format!("a run with a front tolerance of {:.1e} meets more fronts still", COARSER * front_tolerance));
        return Ok(());
    };
    let before = racer.pilots.last().map(|p| p.estimate);
    let order = before.map_or(FRONT_ORDER, |before| {
        ((before / estimate).ln() / COARSER.ln()).clamp(FRONT_ORDERS[0], FRONT_ORDERS[1])
    });
    racer.pilots.push(Pilot { method, estimate, order, work: bar.events() });
    Ok(())
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
    let companion = tracked(scene, companion::coarser(settings), most, progress)?;
    Ok(companion.map(|companion| bar.error_figure(&companion)))
}

/// A tracked bar at the end time; none where it took more than `most` events.
fn tracked(
    scene: &Scene,
    settings: Settings,
    most: u64,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Result<Option<FrontTracking>> {
    const BURST: u64 = 20_000;
    let until = scene.solve.until;
    let mut bar = assemble::front_tracking(scene, settings);
    loop {
        bar.set_event_budget((bar.events() + BURST).min(most));
        match bar.advance_to(until) {
            Ok(()) => return Ok(Some(bar)),
            Err(Stopped::EventBudget { events, .. }) if events < most => {}
            Err(_) => return Ok(None),
        }
        let at = Progress::Fronts { time: bar.time(), until, events: bar.events(), fronts: bar.front_count() };
        if progress(at) == Wish::Stop {
            return Err(Error::Interrupted);
        }
    }
}

/// What was run so far, method by method.
fn tried(racers: &[Racer]) -> Vec<Tried> {
    racers.iter().flat_map(|r| &r.pilots).map(|p| tried_of(p.method, p.estimate, p.work)).collect()
}

fn tried_of(method: Method, estimate: f64, work: u64) -> Tried {
    let [method_name, scheme] = method.names();
    let front_tolerance = match method {
        Method::FrontTracking { front_tolerance, .. } => Some(front_tolerance),
        _ => None,
    };
    Tried {
        method: method_name.into(),
        scheme: scheme.into(),
        cells: method.cells(),
        front_tolerance,
        estimate: estimate.is_finite().then_some(estimate),
        work,
    }
}

/// One sentence.
fn why(scene: &Scene, tolerance: f64, racers: &[Racer], winner: usize) -> String {
    let name = |r: &Racer| r.method.names()[1];
    let others: Vec<String> = racers
        .iter()
        .enumerate()
        .filter(|(k, _)| *k != winner)
        .map(|(_, r)| match (&r.out, r.foretold(scene, tolerance)) {
            (Some(why), _) => format!("{} is out: {why}", name(r)),
            (None, Some((_, time))) => format!("{} would take about {time:.1e} s", name(r)),
            (None, None) => format!("{} was not needed", name(r)),
        })
        .collect();
    let time = racers[winner].foretold(scene, tolerance).map_or(0.0, |f| f.1);
    let best =
        format!("{} is expected to reach {tolerance:e} soonest, in nominally {time:.1e} s", name(&racers[winner]));
    if others.is_empty() {
        return format!("{} is the only method that can do the scene", name(&racers[winner]));
    }
    format!("{best}; {}", others.join("; "))
}

fn not_reached(scene: &Scene, tolerance: f64, tried: &[Tried]) -> Error {
    let best = tried.iter().filter_map(|t| t.estimate).fold(f64::INFINITY, f64::min);
    let reason = format!("no method reached the tolerance {tolerance:e}: the best estimate was {best:.1e}");
    let help = "ask for less, or name a method and its resolution in [solve]; `barwave cost` shows what each one gives";
    RunError { reason, time: scene.solve.until, x: None, help: help.into() }.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn racer(method: Method, pilots: &[(f64, u64)]) -> Racer {
        let mut racer = Racer::new(method);
        for &(estimate, work) in pilots {
            let method = racer.next();
            racer.pilots.push(Pilot { method, estimate, order: 1.0, work });
        }
        racer
    }

    #[test]
    fn pilots_are_refined_step_by_step() {
        let grid = Method::Leapfrog { cells: 1000, cfl: 1.0 };
        assert_eq!(racer(grid, &[]).next().cells(), Some(128));
        assert_eq!(racer(grid, &[(0.1, 1), (0.1, 1)]).next().cells(), Some(512));
        let fronts = Method::FrontTracking { front_tolerance: 1e-3, event_budget: 9 };
        let next = racer(fronts, &[(0.1, 1)]).next();
        assert!(matches!(next, Method::FrontTracking { front_tolerance, event_budget: 9 }
            if (front_tolerance - 0.1 / 3.0).abs() < 1e-15));
    }

    #[test]
    fn cells_are_refined_to_multiples_of_four() {
        assert_eq!(refined(Method::CharacteristicNet { cells: 128 }, 1.3).cells(), Some(168));
        assert_eq!(refined(Method::CharacteristicNet { cells: 128 }, 1.0).cells(), Some(128));
    }
}

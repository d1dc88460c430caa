//! `tolerance`: selection of the cheapest method and resolution for a given error.
//!
//! All methods that support the scene start from their coarsest resolution. The one that is expected to finish first is refined, until one of them is
//! so close to the tolerance that its last refinement can be predicted safely. These pilot runs have no recorders. The run itself follows; if its own
//! error estimate exceeds the tolerance, it is refined and repeated. Costs are counted in work, not in measured time, so that a scene is solved
//! identically on every machine. The search ends if every method would take longer than an hour by this count.

mod candidate;
mod pilots;

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use self::candidate::{Candidate, FEW_EVENTS, LEAP_CELLS, LEAP_TOLERANCE, MOST_TIME, Pilot};
use self::pilots::{contradiction, front_pilot, grid_pilot};
use super::limits::check_start;
use super::tracked::OUT_OF_EVENTS;
use super::{Progress, Target, run_method};
use crate::error::{Error, Result, RunError};
use crate::record::{ChoiceSummary, SolvedBy, Summary, Tried};
use crate::scene::{Method, Scene, Tolerance};

/// Fraction of the expected time of the best method below which the next pilot of any other method is always run.
const NEGLIGIBLE_COST_FRACTION: f64 = 0.1;

/// Largest number of repetitions of a run that misses its tolerance.
const MOST_REPEATS: usize = 24;

/// Run to within a tolerance, with the pilots and runs before it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Attempt {
    candidates: Vec<Candidate>,
    /// Index of the candidate that is run.
    winner: usize,
    method: Method,
    why: String,
    /// Number of the attempt, counted from 0.
    number: usize,
}

/// Runs a scene to within its tolerance.
pub(super) fn run(
    scene: &Scene,
    mut target: Target<'_>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Summary> {
    let Some(requested) = &scene.solve.tolerance else { return run_method(scene, &target, progress) };
    let mut attempt = if let Some(resumed) = target.chosen.attempt.take() {
        resumed
    } else {
        check_start(scene)?;
        Attempt::new(scene, requested.value, candidates(scene, requested), 0, progress)?
    };
    loop {
        let next = target.for_repeat();
        // The attempt can be large and is needed for checkpoints only.
        target.chosen.attempt = target.every.map(|_| attempt.clone());
        if let Some(summary) = attempt.run(scene, requested.value, &target, progress)? {
            return Ok(summary);
        }
        if attempt.number == MOST_REPEATS {
            return Err(not_reached(scene, requested.value, &attempt.candidates));
        }
        attempt = Attempt::new(scene, requested.value, attempt.candidates, attempt.number + 1, progress)?;
        target = next;
    }
}

impl Attempt {
    /// Selects the method that is expected to reach the tolerance first.
    fn new(
        scene: &Scene,
        tolerance: f64,
        mut candidates: Vec<Candidate>,
        number: usize,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Self> {
        let (winner, finer) = select_candidate(scene, tolerance, &mut candidates, progress)?;
        let (method, why) = (candidates[winner].finer(finer), why(scene, tolerance, &candidates, winner));
        Ok(Self { candidates, winner, method, why, number })
    }

    /// Returns the scene that is run.
    pub fn scene(&self, scene: &Scene) -> Scene {
        scene.by(self.method).with_error_estimate()
    }

    /// Performs the run. Returns `None` if it ran out of events, missed the tolerance, or was contradicted by front tracking; the candidates then
    /// contain this result.
    fn run(
        &mut self,
        scene: &Scene,
        tolerance: f64,
        target: &Target<'_>,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Option<Summary>> {
        let ended = run_method(&self.scene(scene), target, progress);
        let Self { ref mut candidates, winner, method, .. } = *self;
        let summary = match ended {
            Err(Error::Run(error)) if error.reason.starts_with(OUT_OF_EVENTS) => {
                candidates[winner].out = Some(error.reason);
                return Ok(None);
            }
            other => other?,
        };
        let work = if summary.events > 0 { summary.events } else { (summary.cells * summary.steps) as u64 };
        let estimate = summary.error.as_ref().map(|e| e.value);
        let order = candidates[winner].pilots.last().map_or(1.0, |p| p.order);
        // A run without an estimate ended early, for example by a fracture, which companion runs do not simulate.
        let worst = summary.errors.and_then(|table| table.worst());
        let done = Pilot { method, cells: summary.cells, estimate: estimate.unwrap_or(f64::NAN), worst, order, work };
        let missed = done.estimate > tolerance;
        let stands = estimate.is_none() || !missed && confirmed(scene, candidates, winner, done, progress)?;
        if stands {
            let mut tried = tried(candidates);
            tried.push(tried_of(method, done.estimate, work));
            let choice = ChoiceSummary { tolerance, why: self.why.clone(), tried };
            return Ok(Some(Summary { choice: Some(choice), ..summary }));
        }
        candidates[winner].add(done, tolerance);
        candidates[winner].missed = missed;
        Ok(None)
    }
}

/// Returns the method and resolution from which the run of a scene with a tolerance starts, and the reason. The coarse runs are performed, the run
/// itself is not. Returns `None` if the scene has no tolerance.
///
/// # Errors
/// A [`RunError`] if no method reaches the tolerance or the run stops at t = 0; [`Error::Interrupted`] if `progress` requests a stop.
pub fn predict(
    scene: &Scene,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Option<(Method, String)>> {
    let Some(requested) = &scene.solve.tolerance else { return Ok(None) };
    check_start(scene)?;
    let mut candidates = candidates(scene, requested);
    let (winner, finer) = select_candidate(scene, requested.value, &mut candidates, progress)?;
    Ok(Some((candidates[winner].finer(finer), why(scene, requested.value, &candidates, winner))))
}

fn candidates(scene: &Scene, requested: &Tolerance) -> Vec<Candidate> {
    methods(scene, &requested.methods).into_iter().map(Candidate::new).collect()
}

/// Returns the methods with reliable estimates: methods that discretize a taper into steps are left out if any other method does not need to.
fn methods(scene: &Scene, requested: &[Method]) -> Vec<Method> {
    let whole = |method: &Method| scene.by(*method).in_pieces().is_none();
    let kept: Vec<Method> = requested.iter().copied().filter(whole).collect();
    if kept.is_empty() { requested.to_vec() } else { kept }
}

/// Refines the candidates until one of them is close. Returns its index and the factor by which it has to be finer than its last pilot.
fn select_candidate(
    scene: &Scene,
    tolerance: f64,
    candidates: &mut [Candidate],
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(usize, f64)> {
    loop {
        for candidate in candidates.iter_mut() {
            candidate.check_reach(scene, tolerance);
        }
        let predicted = |r: &Candidate| r.predicted(scene, tolerance);
        let time = |r: &Candidate| predicted(r).map_or(0.0, |f| f.1);
        let best = candidates.iter().enumerate().filter(|(_, r)| r.out.is_none());
        let best = best.min_by(|a, b| time(a.1).total_cmp(&time(b.1))).map(|best| best.0);
        let Some(best) = best else {
            return Err(not_reached(scene, tolerance, candidates));
        };
        let tracks = candidates[best].method.tracks_fronts();
        let leap = if tracks { LEAP_TOLERANCE } else { LEAP_CELLS };
        let near = predicted(&candidates[best]).filter(|f| f.0 <= leap);
        // A pilot of negligible cost is run, the cheapest first, rather than trusting the prediction from two pilots.
        let misses = |r: &Candidate| r.out.is_none() && predicted(r).is_some_and(|f| f.0 > 1.0);
        let cheap = (0..candidates.len()).filter(|&k| (k != best || near.is_none()) && misses(&candidates[k]));
        let cost = |k: usize| candidates[k].next_pilot(scene);
        let cheap = cheap.min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        let cheap = cheap.filter(|&k| cost(k) < NEGLIGIBLE_COST_FRACTION * time(&candidates[best]).min(MOST_TIME));
        if let (None, Some((finer, _))) = (cheap, near) {
            return Ok((best, finer));
        }
        let next = cheap.unwrap_or(best);
        pilot(scene, candidates, next, tolerance, progress)?;
        tell(tolerance, &candidates[next], progress)?;
        // If a few hundred events are sufficient, no comparison is needed.
        let last = candidates[next].pilots.last();
        if candidates[next].method.tracks_fronts()
            && last.is_some_and(|p| p.estimate <= tolerance && p.work <= FEW_EVENTS)
        {
            return Ok((next, 1.0));
        }
    }
}

/// Reports the result of a candidate's last pilot.
fn tell(tolerance: f64, candidate: &Candidate, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<()> {
    let Some(last) = candidate.pilots.last() else { return Ok(()) };
    let tried = tried_of(last.method, last.estimate, last.work);
    if progress(Progress::Tried { tried, tolerance }).is_break() { Err(Error::Interrupted) } else { Ok(()) }
}

/// Runs the next pilot of one candidate.
fn pilot(
    scene: &Scene,
    candidates: &mut [Candidate],
    next: usize,
    tolerance: f64,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<()> {
    let others = candidates.iter().enumerate().filter(|(k, r)| *k != next && r.out.is_none());
    let rival = others.filter_map(|(_, r)| r.predicted(scene, tolerance)).map(|f| f.1).fold(f64::INFINITY, f64::min);
    if candidates[next].method.tracks_fronts() {
        front_pilot(scene, &mut candidates[next], rival, progress)
    } else {
        grid_pilot(scene, &mut candidates[next], tolerance, progress)
    }
}

/// Compares a run on a grid with front tracking, if this takes about the same work; a grid that disagrees is rejected. Returns false in that case.
fn confirmed(
    scene: &Scene,
    candidates: &mut [Candidate],
    winner: usize,
    run: Pilot,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<bool> {
    let tracking = candidates.iter().position(|r| r.method.tracks_fronts()).filter(|&k| k != winner);
    let yields = candidates[winner].runs.last().is_some_and(|run| !run.elastic);
    let Some(tracking) = tracking.filter(|_| yields) else { return Ok(true) };
    let why = contradiction(scene, run, &mut candidates[tracking], progress)?;
    candidates[winner].out = why;
    Ok(candidates[winner].out.is_none())
}

/// Returns all runs so far, method by method.
fn tried(candidates: &[Candidate]) -> Vec<Tried> {
    candidates.iter().flat_map(|r| &r.pilots).map(|p| tried_of(p.method, p.estimate, p.work)).collect()
}

fn tried_of(method: Method, estimate: f64, work: u64) -> Tried {
    Tried { by: method.into(), estimate: estimate.is_finite().then_some(estimate), work }
}

/// Returns the reason for the selection, as one sentence.
fn why(scene: &Scene, tolerance: f64, candidates: &[Candidate], winner: usize) -> String {
    let name = |r: &Candidate| r.method.names()[1];
    let others: Vec<String> = candidates
        .iter()
        .enumerate()
        .filter(|(k, _)| *k != winner)
        .map(|(_, r)| match (&r.out, r.predicted(scene, tolerance)) {
            (Some(why), _) => format!("{} was rejected: {why}", name(r)),
            _ if r.too_expensive.is_some() => format!("{} needs more work than that", name(r)),
            (None, Some((_, time))) => format!("{} would need about {time:.1e} s", name(r)),
            (None, None) => format!("{} was not tried", name(r)),
        })
        .collect();
    let time = candidates[winner].predicted(scene, tolerance).map(|f| f.1).filter(|time| *time > 0.0);
    let time = time.map_or_else(String::new, |time| format!(", nominally {time:.1e} s"));
    let best = format!("{} is expected to reach {tolerance:e} in the shortest time{time}", name(&candidates[winner]));
    if others.is_empty() {
        return format!("{} is the only method that `tolerance` can choose for this scene", name(&candidates[winner]));
    }
    format!("{best}; {}", others.join("; "))
}

fn not_reached(scene: &Scene, tolerance: f64, candidates: &[Candidate]) -> Error {
    let pilots = candidates.iter().flat_map(|r| &r.pilots).filter(|p| p.estimate.is_finite());
    let best = pilots.min_by(|a, b| a.estimate.total_cmp(&b.estimate));
    let best = best.map_or_else(String::new, |pilot| {
        let estimate = pilot.worst.map_or_else(|| format!("{:.1e}", pilot.estimate), |worst| worst.to_string());
        format!(": the best estimate was that of {}, {estimate}", SolvedBy::from(pilot.method))
    });
    let whys = candidates.iter().filter_map(|r| Some(format!("; {}: {}", r.method.names()[1], r.out.as_ref()?)));
    let reason = format!("no method reached the tolerance {tolerance:e}{best}{}", whys.collect::<String>());
    let least = candidates.iter().filter_map(|candidate| candidate.within_reach(scene)).reduce(f64::min);
    let least = least.map_or_else(String::new, |least| {
        format!(" (about {:.0e} is expected to be the least within {MOST_TIME:.0} s)", least.max(tolerance))
    });
    let help = format!(
        "increase `tolerance`{least}, or set a method and its resolution in [solve]; `barwave cost` shows the error of each"
    );
    RunError { reason, time: scene.solve.until, x: None, help }.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_that_ends_names_the_run_that_came_nearest() {
        let scene = Scene::pulled();
        let mut grid = Candidate::new(Method::Leapfrog { cells: 1000, cfl: 1.0 });
        for (cells, estimate) in [(128, 0.1), (256, 0.05)] {
            let method = grid.method.with_cells(cells);
            grid.pilots.push(Pilot { method, cells, estimate, worst: None, order: 1.0, work: 1 });
        }
        let text = not_reached(&scene, 1e-6, &[grid]).to_string();
        assert!(text.contains("1e-6: the best estimate was that of leapfrog with 256 cells, 5.0e-2"), "{text}");
    }
}

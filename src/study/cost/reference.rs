//! The reference solution for errors, and its uncertainty.

use super::candidates::{self, Candidate, ROUNDING, Run};
use super::measure::{Pass, Watch};
use super::refinement::Halt;
use super::source::{Family, Resolution, Source};
use super::{CostPoint, Instants, judge};
use crate::accuracy::{Response, similar_response};
use crate::bar::{InitialFan, initial_fans};
use crate::error::Result;
use crate::record::{self, ErrorTable};
use crate::scene::{Effects, Scene};

/// Reference solution of a study.
pub(super) struct Reference {
    /// Description in words.
    pub name: String,
    /// Uncertainty estimated from the two or three finest runs of the reference, at least rounding, in the measure of the study.
    pub own: f64,
    /// Uncertainty when the reference was chosen: `own`, or the difference from another method that contradicts it.
    pub uncertainty: f64,
    /// Index of the family and its number of cells, if the reference is a run on a grid.
    pub grid: Option<(usize, usize)>,
    kind: Kind,
}

enum Kind {
    Similar(Box<Scene>, Box<InitialFan>),
    /// Response with a field at every instant at which a run may be compared.
    Run(Box<Response>),
}

impl Reference {
    /// Returns the errors of a run.
    pub fn errors(&self, pass: &Pass) -> ErrorTable {
        match &self.kind {
            Kind::Similar(scene, initial_fan) => {
                let (times, gauges) = (pass.response.instants(), scene.record.gauge_places());
                pass.response.errors(&similar_response(&scene.bar, initial_fan, &times, &gauges))
            }
            Kind::Run(response) => pass.response.errors(response),
        }
    }

    /// Returns the uncertainty given the points of all families.
    pub fn uncertainty_beside(&self, points: &[Vec<CostPoint>]) -> f64 {
        let of_grid = |(family, _)| judge::uncertainty(points, family, [self.own, self.uncertainty]);
        self.grid.map_or(self.uncertainty, of_grid)
    }
}

/// Finds the reference within the time of `watch`: the self-similar solution, front tracking that keeps every wave, or the least uncertain candidate.
pub(super) fn find(
    scene: &Scene,
    source: &Source<'_>,
    families: &[Family],
    instants: &Instants,
    watch: &mut Watch<'_>,
) -> Result<std::result::Result<Reference, Halt>> {
    if let Some(reference) = similar(scene, instants) {
        return Ok(Ok(reference));
    }
    let mut candidates = Vec::new();
    // Front tracking approximates a taper by a staircase, so it is not exact even if every wave is kept.
    let tracking = families.iter().find(|f| matches!(f.levels[0], Resolution::FrontTolerance(_)) && !tapers(scene));
    if let Some(family) = tracking {
        let scene = source.at(family.choice, Resolution::FrontTolerance(0.0))?;
        match candidates::every_wave(&scene, instants, watch) {
            Ok(Some(pass)) if pass.tracked.is_some_and(|bar| bar.exact) => {
                let name = "front tracking of all waves, exact for the tabulated curve";
                return Ok(Ok(run_reference(pass, ROUNDING, name.into())));
            }
            Ok(kept) => candidates.push(Candidate::of_fronts(scene, kept, instants.measure)),
            Err(halt) => return Ok(Err(halt)),
        }
    }
    // At least two methods are compared, since one of them may converge to a wrong solution.
    let grids = grid_families(scene, families).take(if candidates.is_empty() { 2 } else { 1 });
    candidates.extend(grids.map(|(index, family)| Candidate::of_grid(index, family, instants.measure)));
    if let Some(halt) = candidates::race(&mut candidates, source, instants, watch)? {
        return Ok(Err(halt));
    }
    let best = candidates::surest(&candidates);
    let best = best.and_then(|(k, uncertainty)| of_rival(candidates.swap_remove(k), uncertainty));
    Ok(best.ok_or(Halt::OutOfTime))
}

/// Creates the reference from the finest run of a candidate, or returns `None` if the candidate has no uncertainty or no run.
fn of_rival(mut candidate: Candidate<'_>, uncertainty: f64) -> Option<Reference> {
    let [own, uncertainty] = [candidate.uncertainty()?, uncertainty].map(|uncertainty| uncertainty.max(ROUNDING));
    let Run { fineness, pass } = candidate.runs.pop()?;
    let tolerance = 1.0 / fineness;
    let reference = match candidate.kind {
        candidates::Kind::Fronts { keeps: true, .. } => {
            let steps = format!("ramps in steps of {tolerance:.0e} of the largest stress");
            run_reference(pass, own, format!("front tracking of all waves, {steps}"))
        }
        candidates::Kind::Fronts { keeps: false, .. } => {
            run_reference(pass, own, format!("front tracking with front-tolerance {tolerance:.0e}"))
        }
        candidates::Kind::Grid { index, family } => grid_reference(pass, own, index, family.names[1]),
    };
    Some(Reference { uncertainty, ..reference })
}

/// Returns the grids in order of preference: the characteristic net (last for tapered bars), leapfrog, then the others.
fn grid_families<'a>(scene: &Scene, families: &'a [Family]) -> impl Iterator<Item = (usize, &'a Family)> {
    let rank = |family: &Family| match family.names[1] {
        "characteristic-net" if tapers(scene) => 3,
        "characteristic-net" => 0,
        "leapfrog" => 1,
        _ => 2,
    };
    let grids = families.iter().enumerate().filter(|(_, f)| matches!(f.levels[0], Resolution::Cells(_)));
    let mut grids: Vec<_> = grids.collect();
    grids.sort_by_key(|(_, family)| rank(family));
    grids.into_iter()
}

/// Returns whether the section varies along the bar. Methods of characteristics then approximate it by a staircase.
fn tapers(scene: &Scene) -> bool {
    scene.bar.segments.iter().any(|segment| segment.taper.is_some())
}

/// Returns the self-similar solution, if it is valid up to the last of the instants.
fn similar(scene: &Scene, instants: &Instants) -> Option<Reference> {
    let last = instants.own.iter().copied().fold(scene.solve.until, f64::max);
    // The solution has no unloading, so hardening does not matter; it includes no other effect.
    let known = Effects { hardening: scene.effects.hardening, ..Effects::default() };
    if scene.effects != known {
        return None;
    }
    let all = initial_fans(&scene.bar, &scene.left, &scene.right);
    let initial_fan = record::alone(&scene.bar, &all, last)?;
    Some(Reference {
        name: "self-similar solution, exact for the tabulated curve".into(),
        own: ROUNDING,
        uncertainty: ROUNDING,
        grid: None,
        kind: Kind::Similar(Box::new(scene.clone()), Box::new(initial_fan.clone())),
    })
}

fn run_reference(pass: Pass, own: f64, name: String) -> Reference {
    Reference { name, own, uncertainty: own, grid: None, kind: Kind::Run(Box::new(pass.response)) }
}

fn grid_reference(pass: Pass, own: f64, index: usize, scheme: &str) -> Reference {
    let cells = pass.cells;
    let name = format!("{scheme} with {cells} cells, a finer run of the same scheme: errors are estimates");
    Reference { grid: Some((index, cells)), ..run_reference(pass, own, name) }
}

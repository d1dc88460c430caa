//! Candidates for the reference if no exact solution exists: front tracking and grids, refined in turns. The candidate with the smallest expected
//! uncertainty after the remaining time is refined next. The uncertainty that a candidate estimates from its own runs is checked against the other
//! candidates.

use super::Instants;
use super::measure::{self, Pass, Wanted, Watch};
use super::refinement::Halt;
use super::source::{Family, Resolution, Source};
use crate::error::Result;
use crate::record::Measure;
use crate::scene::Scene;
use crate::solver::moc::{RAMP_STEP, Settings};

/// Uncertainty below which a reference is not refined further: a tenth of the finest tolerance that is evaluated.
const SURE: f64 = 1e-5;
/// Fractions of the remaining time: for the attempt to keep every wave, and for any single run of front tracking.
const EXACT_SHARE: f64 = 0.1;
const RUN_SHARE: f64 = 0.5;
/// Front tolerances of reference runs that merge waves, and step heights of ramps in reference runs that keep every wave.
const TOLERANCES: [f64; 9] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6];
/// Cells of the coarsest grid of a reference.
const FIRST_CELLS: usize = 400;
/// Expected growth of the computing time from one run to the next: of a grid whose cells double, and of front tracking, for which the growth between
/// the last two runs is used if it is known, limited to `FRONT_GROWTH` to `MOST_GROWTH`.
const GRID_GROWTH: f64 = 4.3;
const FRONT_GROWTH: f64 = 4.0;
const MOST_GROWTH: f64 = 15.0;
/// Rounding error of an exact solution: sums over some thousand steps in double precision.
pub(super) const ROUNDING: f64 = 1e-12;
/// Range of the convergence order that is used for the uncertainty of a reference. Elastic or smooth waves converge faster; the reference is then
/// more certain than stated.
const ORDERS: [f64; 2] = [0.5, 1.0];
/// Highest order that is attributed to convergence. A difference that decreased faster did so by chance: two grids can have the same error.
const HIGHEST_ORDER: f64 = 2.0;
/// Range of observed orders that demonstrates convergence. Differences that increase or vanish demonstrate nothing: all grids can have the same
/// error.
pub(super) const SHOWN_ORDERS: [f64; 2] = [0.25, 3.0];
/// Number of runs of each candidate before one of them is preferred. A grid has one more run, so that it shows an order, if that run takes at most
/// the fraction `THIRD_SHARE` of the remaining time.
const FIRST_RUNS: usize = 2;
const THIRD_SHARE: f64 = 0.1;

/// Method of a candidate.
pub(super) enum Kind<'a> {
    /// Front tracking. If `keeps`, every wave is kept and only the steps of ramps are refined.
    Fronts { scene: Box<Scene>, keeps: bool },
    /// A grid, with its index among the families.
    Grid { index: usize, family: &'a Family },
}

/// A finished run.
pub(super) struct Run {
    /// Number of cells, or the reciprocal of the tolerance.
    pub fineness: f64,
    pub pass: Pass,
}

/// A method that may give the reference, with its finest runs (at most three), coarse to fine.
pub(super) struct Candidate<'a> {
    pub kind: Kind<'a>,
    pub runs: Vec<Run>,
    measure: Measure,
    out: bool,
}

impl<'a> Candidate<'a> {
    /// Creates a candidate that uses front tracking. `kept` is a run that kept every wave, with ramps in their coarsest steps.
    pub fn of_fronts(scene: Scene, kept: Option<Pass>, measure: Measure) -> Self {
        let keeps = kept.is_some();
        let runs = kept.into_iter().map(|pass| Run { fineness: 1.0 / RAMP_STEP, pass }).collect();
        Self { kind: Kind::Fronts { scene: Box::new(scene), keeps }, runs, measure, out: false }
    }

    pub fn of_grid(index: usize, family: &'a Family, measure: Measure) -> Self {
        Self { kind: Kind::Grid { index, family }, runs: Vec::new(), measure, out: false }
    }

    /// Returns the uncertainty of the finest run, estimated from this candidate's runs alone: the last difference extrapolated with the observed
    /// order of three runs, or with the lowest order of [`ORDERS`] for two runs. Returns 0 for an exact run, and `None` for fewer than two runs
    /// otherwise.
    pub fn uncertainty(&self) -> Option<f64> {
        if self.runs.last().and_then(|run| run.pass.tracked).is_some_and(|bar| bar.exact) {
            return Some(0.0);
        }
        let [.., before, last] = &self.runs[..] else { return None };
        let ratio = last.fineness / before.fineness;
        let far = if let [first, _, _] = &self.runs[..] { self.apart(first, before)? } else { 0.0 };
        let near = self.apart(before, last)?.max(far / ratio.powf(HIGHEST_ORDER));
        Some(near / (ratio.powf(self.order()) - 1.0))
    }

    /// Returns the uncertainty with respect to the other candidates. Front tracking that converges needs no confirmation, because it solves the
    /// tabulated curve itself. A grid may converge to a different solution. If the difference from another candidate exceeds the sum of both
    /// estimates, or if the grid shows no convergence, the difference counts as the uncertainty.
    fn stated(&self, others: &[Candidate<'_>]) -> Option<f64> {
        let own = self.uncertainty()?;
        let shown = self.seen_order();
        if self.tracks() && (own == 0.0 || shown.is_some_and(|order| order >= ORDERS[0])) {
            return Some(own);
        }
        let shows = own > ROUNDING && shown.is_some_and(|order| (SHOWN_ORDERS[0]..=SHOWN_ORDERS[1]).contains(&order));
        let against = others.iter().filter(|other| !std::ptr::eq(*other, self)).filter_map(|other| {
            let (apart, theirs) = (self.apart_from(other)?, other.uncertainty());
            let explained = shows && theirs.is_some_and(|theirs| apart <= own + theirs);
            (!explained).then_some(apart)
        });
        Some(against.fold(own, f64::max))
    }

    fn tracks(&self) -> bool {
        matches!(self.kind, Kind::Fronts { .. })
    }

    /// Returns the difference between the finest runs of two candidates. Front tracking is always the reference of the pair, because its instants
    /// include the steps of the grids.
    fn apart_from(&self, other: &Candidate<'_>) -> Option<f64> {
        let (pass, reference) = if self.tracks() { (other, self) } else { (self, other) };
        let [pass, reference] = [pass.runs.last()?, reference.runs.last()?];
        self.apart(pass, reference)
    }

    fn apart(&self, coarser: &Run, finer: &Run) -> Option<f64> {
        coarser.pass.response.errors(&finer.pass.response)[self.measure]
    }

    fn order(&self) -> f64 {
        self.seen_order().unwrap_or(ORDERS[0]).clamp(ORDERS[0], ORDERS[1])
    }

    /// Returns the order of convergence observed in three runs; infinite if only the last difference is 0.
    fn seen_order(&self) -> Option<f64> {
        let [first, before, last] = &self.runs[..] else { return None };
        let (far, near) = (self.apart(first, before)?, self.apart(before, last)?);
        let seen = (far / near).ln() / (last.fineness / before.fineness).ln();
        (!seen.is_nan()).then_some(seen)
    }

    /// Returns the fineness of the next run, or `None` if there is no finer one.
    fn next(&self) -> Option<f64> {
        let last = self.runs.last().map(|run| run.fineness);
        match self.kind {
            Kind::Grid { .. } => Some(last.map_or(FIRST_CELLS as f64, |cells| 2.0 * cells)),
            Kind::Fronts { .. } => {
                TOLERANCES.into_iter().map(|t| 1.0 / t).find(|finer| last.is_none_or(|last| *finer > 1.5 * last))
            }
        }
    }

    /// Returns the expected computing time of the next run relative to that of the last one.
    fn growth(&self) -> f64 {
        match (&self.kind, &self.runs[..]) {
            (Kind::Grid { .. }, _) => GRID_GROWTH,
            (_, [.., before, last]) => (last.pass.seconds / before.pass.seconds).clamp(FRONT_GROWTH, MOST_GROWTH),
            _ => FRONT_GROWTH,
        }
    }

    /// Returns whether the candidate has too few runs to be judged. `left` is the remaining time, s.
    fn is_young(&self, left: f64) -> bool {
        let third = |last: &Run| self.growth() * last.pass.seconds <= THIRD_SHARE * left;
        let enough = match self.runs.len() {
            FIRST_RUNS => self.tracks() || !self.runs.last().is_some_and(third),
            runs => runs > FIRST_RUNS,
        };
        !self.out && !enough
    }

    /// Returns the uncertainty that the candidate is expected to reach within `time` (s); infinite if no further run fits.
    fn promise(&self, mut time: f64) -> f64 {
        let (Some(mut uncertainty), Some(last), Some(next)) = (self.uncertainty(), self.runs.last(), self.next())
        else {
            return f64::INFINITY;
        };
        let (growth, better) = (self.growth(), (next / last.fineness).powf(self.order()));
        let (mut seconds, mut fits) = (growth * last.pass.seconds, false);
        while seconds <= time && uncertainty > SURE {
            time -= seconds;
            seconds *= growth;
            uncertainty /= better;
            fits = true;
        }
        if fits { uncertainty } else { f64::INFINITY }
    }

    fn run_next(
        &mut self,
        source: &Source<'_>,
        instants: &Instants,
        watch: &mut Watch<'_>,
    ) -> Result<std::result::Result<(), Halt>> {
        let Some(fineness) = self.next() else {
            self.out = true;
            return Ok(Ok(()));
        };
        let found = match &self.kind {
            Kind::Fronts { scene, keeps } => {
                let tolerance = 1.0 / fineness;
                watch.what = format!("reference: front tracking, tolerance {tolerance:.0e}");
                let until = watch.until;
                watch.until = watch.now() + RUN_SHARE * (until - watch.now()).max(0.0);
                let pass = fronts(scene, if *keeps { 0.0 } else { tolerance }, Some(tolerance), instants, watch);
                watch.until = until;
                pass
            }
            Kind::Grid { family, .. } => {
                let cells = fineness as usize;
                watch.what = format!("reference: {}, {cells} cells", family.names[1]);
                let scene = source.at(family.choice, Resolution::Cells(cells))?;
                measure::pass(&scene, Wanted::response(&instants.common), watch)
            }
        };
        Ok(match found {
            Ok(pass) => {
                self.runs.push(Run { fineness, pass });
                if self.runs.len() > 3 {
                    self.runs.remove(0);
                }
                Ok(())
            }
            Err(Halt::Interrupted) => Err(Halt::Interrupted),
            Err(Halt::OutOfTime | Halt::Failed(_)) => {
                self.out = true;
                Ok(())
            }
        })
    }
}

/// Runs front tracking with every wave kept and ramps in their coarsest steps. Returns `None` if the time is not sufficient or the run fails.
pub(super) fn every_wave(
    scene: &Scene,
    instants: &Instants,
    watch: &mut Watch<'_>,
) -> std::result::Result<Option<Pass>, Halt> {
    watch.what = "reference: front tracking, all waves".into();
    let until = watch.until;
    watch.until = watch.now() + EXACT_SHARE * (until - watch.now());
    let found = fronts(scene, 0.0, None, instants, watch);
    watch.until = until;
    match found {
        Ok(pass) => Ok(Some(pass)),
        Err(Halt::Interrupted) => Err(Halt::Interrupted),
        Err(Halt::OutOfTime | Halt::Failed(_)) => Ok(None),
    }
}

fn fronts(
    scene: &Scene,
    front_tolerance: f64,
    ramp_step: Option<f64>,
    instants: &Instants,
    watch: &mut Watch<'_>,
) -> std::result::Result<Pass, Halt> {
    let settings = Settings { front_tolerance, ramp_step, event_budget: u64::MAX, ..Settings::default() };
    measure::pass(scene, Wanted { instants: &instants.own, settings: Some(settings) }, watch)
}

/// Returns the index and the uncertainty of the candidate that is least uncertain with respect to the others.
pub(super) fn surest(candidates: &[Candidate<'_>]) -> Option<(usize, f64)> {
    let known = candidates.iter().enumerate().filter_map(|(k, c)| Some((k, c.stated(candidates)?, c.uncertainty()?)));
    // Two candidates that contradict each other have the same uncertainty; their own estimates decide.
    let best = known.min_by(|a, b| a.1.total_cmp(&b.1).then(a.2.total_cmp(&b.2)));
    best.map(|(k, stated, _)| (k, stated))
}

/// Refines the candidates until the time of `watch` is used up or no refinement is worthwhile. Returns the reason if the user stopped it.
pub(super) fn race(
    candidates: &mut [Candidate<'_>],
    source: &Source<'_>,
    instants: &Instants,
    watch: &mut Watch<'_>,
) -> Result<Option<Halt>> {
    loop {
        let best = surest(candidates).map_or(f64::INFINITY, |(_, uncertainty)| uncertainty);
        let left = watch.until - watch.now();
        if left <= 0.0 {
            return Ok(None);
        }
        // The first runs of every candidate have priority, those of grids before those of front tracking, which may not finish.
        let young = candidates.iter_mut().rev().filter(|candidate| candidate.is_young(left));
        let next = if let Some(young) = young.min_by_key(|candidate| candidate.runs.len()) {
            Some(young)
        } else {
            let promise = |r: &Candidate<'_>| if r.out { f64::INFINITY } else { r.promise(left) };
            let next = candidates.iter_mut().min_by(|a, b| promise(a).total_cmp(&promise(b)));
            next.filter(|r| best > SURE && promise(r) < best)
        };
        let Some(next) = next else { return Ok(None) };
        if let Err(halt) = next.run_next(source, instants, watch)? {
            return Ok(Some(halt));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::{Response, Shape};

    fn run(fineness: f64, error: f64, seconds: f64) -> Run {
        let shape = Shape::Points(vec![(0.5, 1.0 + error)]);
        let response = Response { fields: vec![(1.0, shape)], lengths: vec![1.0], modulus: 1.0, ..Response::default() };
        let pass = Pass { seconds, response, cells: fineness as usize, work: 1, tracked: None };
        Run { fineness, pass }
    }

    fn grid(family: &Family, order: f64, times: [f64; 3]) -> Candidate<'_> {
        let mut candidate = Candidate::of_grid(0, family, Measure::Field);
        let cells = [400.0, 800.0, 1600.0];
        candidate.runs =
            cells.iter().zip(times).map(|(n, t)| run(*n, 1e-3 * (n / 400.0_f64).powf(-order), t)).collect();
        candidate
    }

    #[test]
    fn the_uncertainty_is_what_the_order_leaves_and_no_less_than_the_last_difference() {
        let family =
            Family { choice: crate::scene::MethodChoice::ALL[2], names: ["fd", "leapfrog"], levels: Vec::new() };
        // Differences are taken over the finer value, 1 + error.
        let uncertainty = |order| grid(&family, order, [1.0; 3]).uncertainty().expect("three runs");
        let slow = 1e-3 * 4_f64.powf(-0.7);
        assert!((uncertainty(0.7) / slow - 1.0).abs() < 2e-3, "{} {slow}", uncertainty(0.7));
        let last = 1e-3 * (0.25 - 0.0625);
        assert!((uncertainty(2.0) / last - 1.0).abs() < 2e-3, "{} {last}", uncertainty(2.0));
    }

    /// Runs of a method that converges to `limit` with these errors.
    fn fronts(limit: f64, errors: &[f64]) -> Candidate<'static> {
        let scene = Scene::pulled();
        let mut candidate = Candidate::of_fronts(scene, None, Measure::Field);
        candidate.runs =
            errors.iter().zip([1e2, 3e2, 9e2]).map(|(error, fineness)| run(fineness, limit + error, 1.0)).collect();
        candidate
    }

    #[test]
    fn grids_that_are_all_off_by_the_same_are_no_reference_beside_another_method() {
        let family =
            Family { choice: crate::scene::MethodChoice::ALL[2], names: ["fd", "leapfrog"], levels: Vec::new() };
        // All grids overshoot by the same 4 %, so their differences vanish. Even a coarse run of another method contradicts them.
        let mut blind = grid(&family, 1.0, [1.0; 3]);
        blind.runs = [400.0, 800.0, 1600.0].map(|cells| run(cells, 0.04, 1.0)).into();
        let coarse = [fronts(0.0, &[0.1, 0.05]), blind];
        let (_, uncertainty) = surest(&coarse).expect("two runs of each");
        assert!(uncertainty > 9e-3, "{uncertainty}");
        // Front tracking that converges is accepted without confirmation.
        let [_, blind] = coarse;
        let (index, uncertainty) = surest(&[blind, fronts(0.0, &[9e-4, 3e-4, 1e-4])]).expect("three runs of each");
        assert!(index == 1 && uncertainty < 3e-4, "{index}: {uncertainty}");
    }

    #[test]
    fn what_the_estimates_of_two_methods_do_not_explain_is_uncertain() {
        let family =
            Family { choice: crate::scene::MethodChoice::ALL[2], names: ["fd", "leapfrog"], levels: Vec::new() };
        // Two grids of first order with limits that are 1 % apart, and with the same limit.
        let near = grid(&family, 1.0, [1.0; 3]);
        let mut far = grid(&family, 1.0, [1.0; 3]);
        far.runs = [1.0, 2.0, 4.0].map(|finer| run(400.0 * finer, 0.01 + 2e-3 / finer, 1.0)).into();
        let (_, uncertainty) = surest(&[near, far]).expect("three runs of each");
        assert!((uncertainty / 0.01 - 1.0).abs() < 0.1, "{uncertainty}");
        let [near, mut far] = [grid(&family, 1.0, [1.0; 3]), grid(&family, 1.0, [1.0; 3])];
        far.runs = [1.0, 2.0, 4.0].map(|finer| run(400.0 * finer, 2e-3 / finer, 1.0)).into();
        let own = near.uncertainty();
        assert_eq!(surest(&[far, near]), own.map(|own| (1, own)));
    }

    #[test]
    fn two_grids_that_agree_by_chance_are_as_uncertain_as_the_one_before_leaves() {
        let family =
            Family { choice: crate::scene::MethodChoice::ALL[2], names: ["fd", "leapfrog"], levels: Vec::new() };
        let mut chance = grid(&family, 1.0, [1.0; 3]);
        chance.runs = vec![run(400.0, 4e-3, 1.0), run(800.0, 1e-3, 1.0), run(1600.0, 1e-3, 1.0)];
        let uncertainty = chance.uncertainty().expect("three runs");
        assert!((uncertainty / (3e-3 / 4.0) - 1.0).abs() < 1e-2, "{uncertainty}");
    }

    #[test]
    fn a_rival_promises_what_fits_into_the_time() {
        let family =
            Family { choice: crate::scene::MethodChoice::ALL[2], names: ["fd", "leapfrog"], levels: Vec::new() };
        let candidate = grid(&family, 1.0, [0.1, 0.4, 1.6]);
        let now = candidate.uncertainty().expect("three runs");
        assert_eq!(candidate.promise(6.0), f64::INFINITY);
        assert!((candidate.promise(7.0) - now / 2.0_f64.powf(candidate.order())).abs() < 1e-12);
        assert!(candidate.promise(40.0) < candidate.promise(7.0));
    }
}

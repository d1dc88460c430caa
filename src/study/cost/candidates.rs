//! Candidates for a reference where none is exact: front tracking and the finest grid, refined in turn. The next refinement is that
//! with the smallest expected uncertainty in the remaining time.

use super::Instants;
use super::measure::{self, Pass, Wanted, Watch};
use super::refinement::Halt;
use super::source::{Family, Resolution, Source};
use crate::error::Result;
use crate::record::Measure;
use crate::scene::Scene;
use crate::solver::moc::{RAMP_STEP, Settings};

/// A reference that is uncertain by no more than this need not be surer: a tenth of the finest tolerance that is asked after.
const SURE: f64 = 1e-5;
/// Share of the time that the attempt to keep every wave may take, and that any one run of front tracking may.
const EXACT_SHARE: f64 = 0.1;
const RUN_SHARE: f64 = 0.5;
/// Tolerances of references that thin waves, and steps of ramps in those that do not.
const TOLERANCES: [f64; 9] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6];
/// Cells of the first grid that may be a reference.
const FIRST_CELLS: usize = 400;
/// Growth of the time from one run to the next that is expected of a grid, and of fronts until two runs tell.
const GRID_GROWTH: f64 = 4.3;
const FRONT_GROWTH: f64 = 4.0;
const MOST_GROWTH: f64 = 15.0;
/// Orders that are believed of a reference: where waves are elastic or smooth they are higher, and it is surer than it says.
const ORDERS: [f64; 2] = [0.5, 1.0];

/// What a candidate is.
pub(super) enum Kind<'a> {
    /// Front tracking; `keeps` every wave, so that only the steps of ramps get finer.
    Fronts { scene: Box<Scene>, keeps: bool },
    /// A grid, and which of the families it is.
    Grid { index: usize, family: &'a Family },
}

/// A finished run.
pub(super) struct Run {
    /// Cells, or one over the tolerance.
    pub fineness: f64,
    pub pass: Pass,
}

/// One way, with its finest runs (at most three), coarse to fine.
pub(super) struct Candidate<'a> {
    pub kind: Kind<'a>,
    pub runs: Vec<Run>,
    measure: Measure,
    out: bool,
}

impl<'a> Candidate<'a> {
    /// Front tracking of a scene; `kept` is a run that kept every wave, with ramps in their coarsest steps.
    pub fn of_fronts(scene: Scene, kept: Option<Pass>, measure: Measure) -> Self {
        let keeps = kept.is_some();
        let runs = kept.into_iter().map(|pass| Run { fineness: 1.0 / RAMP_STEP, pass }).collect();
        Self { kind: Kind::Fronts { scene: Box::new(scene), keeps }, runs, measure, out: false }
    }

    pub fn of_grid(index: usize, family: &'a Family, measure: Measure) -> Self {
        Self { kind: Kind::Grid { index, family }, runs: Vec::new(), measure, out: false }
    }

    /// How far the finest run may be off, relative L1: what the last difference leaves, by the order seen in three runs or the
    /// lowest one. None for fewer than two runs.
    pub fn uncertainty(&self) -> Option<f64> {
        let [.., before, last] = &self.runs[..] else { return None };
        let near = self.apart(before, last)?;
        let ratio = last.fineness / before.fineness;
        Some(near / (ratio.powf(self.order()) - 1.0))
    }

    fn apart(&self, coarser: &Run, finer: &Run) -> Option<f64> {
        coarser.pass.response.errors(&finer.pass.response)[self.measure]
    }

    fn order(&self) -> f64 {
        let [first, before, last] = &self.runs[..] else { return ORDERS[0] };
        let (Some(far), Some(near)) = (self.apart(first, before), self.apart(before, last)) else { return ORDERS[0] };
        let seen = (far / near).ln() / (last.fineness / before.fineness).ln();
        if seen.is_nan() { ORDERS[0] } else { seen.clamp(ORDERS[0], ORDERS[1]) }
    }

    /// How finely the next run works; none where there is no finer one.
    fn next(&self) -> Option<f64> {
        let last = self.runs.last().map(|run| run.fineness);
        match self.kind {
            Kind::Grid { .. } => Some(last.map_or(FIRST_CELLS as f64, |cells| 2.0 * cells)),
            Kind::Fronts { .. } => {
                TOLERANCES.into_iter().map(|t| 1.0 / t).find(|finer| last.is_none_or(|last| *finer > 1.5 * last))
            }
        }
    }

    /// Time of the next run over that of the last.
    fn growth(&self) -> f64 {
        match (&self.kind, &self.runs[..]) {
            (Kind::Grid { .. }, _) => GRID_GROWTH,
            (_, [.., before, last]) => (last.pass.seconds / before.pass.seconds).clamp(FRONT_GROWTH, MOST_GROWTH),
            _ => FRONT_GROWTH,
        }
    }

    /// The uncertainty to which it is expected to get in this time, s; infinite where nothing more fits into it.
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

/// A run that keeps every wave, with ramps in their coarsest steps, if the time allows it.
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

/// Refines the candidates in the watch's time; what stopped them, where the user did.
pub(super) fn race(
    candidates: &mut [Candidate<'_>],
    source: &Source<'_>,
    instants: &Instants,
    watch: &mut Watch<'_>,
) -> Result<Option<Halt>> {
    loop {
        let best = candidates.iter().filter_map(Candidate::uncertainty).fold(f64::INFINITY, f64::min);
        let left = watch.until - watch.now();
        if best <= SURE || left <= 0.0 {
            return Ok(None);
        }
        // Two runs of each come first, those of grids before those of fronts, which may not end.
        let young = |r: &&mut Candidate<'_>| !r.out && r.runs.len() < 2;
        let next = if let Some(young) = candidates.iter_mut().rev().find(young) {
            Some(young)
        } else {
            let promise = |r: &Candidate<'_>| if r.out { f64::INFINITY } else { r.promise(left) };
            let next = candidates.iter_mut().min_by(|a, b| promise(a).total_cmp(&promise(b)));
            next.filter(|r| promise(r) < best)
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

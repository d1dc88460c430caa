//! One point of a refinement: its error, its stepping time and the time of a whole process.

use super::measure::{self, Pass, Wanted, Watch};
use super::points::CostPoint;
use super::reference::Reference;
use super::refinement::{Halt, Ran, Runner, Spent};
use super::source::{Family, Resolution, Source};
use super::{Instants, Whole, WholeRun};
use crate::scene::Scene;
use crate::solver::moc::FrontTracking;
use crate::study::plan;

/// Runs the points of the refinements.
pub(super) struct Bench<'a> {
    pub source: &'a Source<'a>,
    pub families: &'a [Family],
    pub reference: &'a Reference,
    pub instants: &'a Instants,
    pub whole: Option<WholeRun<'a>>,
    pub watch: Watch<'a>,
    pub points: Vec<Vec<CostPoint>>,
}

/// Whole runs shorter than this are repeated up to `WHOLE_REPEATS` times, s.
const SHORT_WHOLE: f64 = 0.2;
const WHOLE_REPEATS: usize = 3;

impl Runner for Bench<'_> {
    fn run(&mut self, family: usize, resolution: Resolution) -> Result<Ran, Halt> {
        let from = self.watch.now();
        let Family { choice, names, .. } = self.families[family];
        self.watch.what = match resolution {
            Resolution::Cells(cells) => format!("{}, {cells} cells", names[1]),
            Resolution::FrontTolerance(tolerance) => format!("{}, front-tolerance {tolerance}", names[1]),
        };
        let scene = self.source.at(choice, resolution).map_err(|e| Halt::Failed(e.to_string()))?;
        let pass = measure::pass(&scene, Wanted::response(&self.instants.common), &mut self.watch)?;
        let errors = self.reference.errors(&pass);
        let error = errors[self.instants.measure].ok_or_else(|| Halt::Failed("there is nothing to compare".into()))?;
        let timing = measure::repeated(&scene, pass.seconds, &mut self.watch)?;
        let whole_wall_s = self.whole(&self.source.overrides(choice, Some(resolution)))?;
        let whole = scene.in_pieces().is_none();
        let exact = pass.tracked.map(|bar| whole && bar.exact);
        let by = match resolution {
            Resolution::Cells(_) => Resolution::Cells(pass.cells),
            tolerance @ Resolution::FrontTolerance(_) => tolerance,
        };
        let by = by.solved_by(names);
        // Finer points of other methods may later show that the reference is more certain than it was when it was chosen.
        let below_reference = error <= self.reference.own;
        self.points[family].push(CostPoint {
            by,
            error,
            errors,
            step_wall_s: timing.median,
            shortest_s: timing.shortest,
            spread: timing.spread,
            repetitions: timing.repetitions,
            whole_wall_s,
            work: pass.work,
            work_unit: if pass.cells > 0 { "cell-steps" } else { "events" },
            memory_bytes: memory(&scene, &pass),
            pareto: false,
            below_reference,
            exact,
        });
        let passes = measure::passes(pass.seconds);
        let spent = Spent { step: timing.median, passes, total: self.watch.now() - from };
        let bound = error.max(self.reference.own);
        Ok(Ran { spent, bound, exact: exact == Some(true), below_reference })
    }

    fn now(&self) -> f64 {
        self.watch.now()
    }
}

impl Bench<'_> {
    /// Returns the median time of the whole process, s, or `None` if whole runs are not requested or the run failed or exceeded its time.
    fn whole(&mut self, overrides: &[String]) -> Result<Option<f64>, Halt> {
        let Some(run) = &mut self.whole else { return Ok(None) };
        let mut times: Vec<f64> = Vec::new();
        while times.len() < WHOLE_REPEATS && times.iter().all(|t| *t < SHORT_WHOLE) {
            self.watch.look()?;
            match run(overrides, self.watch.until - self.watch.now()) {
                Whole::Took(seconds) => times.push(seconds),
                Whole::Interrupted => return Err(Halt::Interrupted),
                Whole::OutOfTime | Whole::Failed(_) => break,
            }
        }
        Ok((!times.is_empty()).then(|| measure::timing(times).median))
    }
}

/// Returns the solver memory of a finished run, bytes.
pub(super) fn memory(scene: &Scene, pass: &Pass) -> u64 {
    match &pass.tracked {
        Some(bar) => (bar.pieces * FrontTracking::BYTES_PER_FRONT) as u64,
        None => plan::memory(scene) as u64,
    }
}

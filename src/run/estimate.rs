//! Estimates the influence of the neglected effects of a scene before the run, by the audit of a run on a coarse grid, which takes some milliseconds.

use super::limits::limits;
use super::{Progress, above_critical_rows, case};
use crate::assemble;
use crate::bar::initial_fans;
use crate::record::{AUDIT_SAMPLES, Audit, AuditRow, Traces, View};
use crate::scene::{Method, Scene};
use crate::simulate::{Interval, Simulation, simulate};
use crate::solver::fd::{Leapfrog, Sampling};
use std::ops::ControlFlow;

/// Cells of the coarse grid; at most half of the run's own cells.
const CELLS: usize = 200;

/// Work between two calls of the progress function, cell-steps.
const WORK_BETWEEN_CALLS: u64 = 1_000_000;

/// Returns the audit of a scene before it is run, with its current effects, and the time up to which the scene was simulated, s. This is less than
/// the end time if the bar reaches the end of its data or `progress` requests a stop.
pub fn estimate(scene: &Scene, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> (Vec<AuditRow>, f64) {
    let cells = match scene.solve.method {
        Method::Leapfrog { cells, .. } | Method::Muscl { cells, .. } | Method::CharacteristicNet { cells } => {
            CELLS.min(cells / 2).max(2)
        }
        Method::FrontTracking { .. } => CELLS,
    };
    let bar = assemble::leapfrog(scene, cells, 1.0);
    let steps = bar.grid().steps_to(scene.solve.until);
    let audit = Audit::new(&case(scene, Some(bar.grid().cells())));
    let watched = Sampling::at(bar.grid(), audit.places().to_vec());
    let mut run = Estimate { scene, bar, steps, audit, watched, progress };
    // If the simulation ends early, the audit covers the time up to then.
    let _: Result<(), Early> = simulate(&mut run, WORK_BETWEEN_CALLS);
    let (audit, bar) = (run.audit, run.bar);
    let parted = !View::ruptures(&bar).is_empty();
    let [left, right] = scene.ends_in_run();
    let all = initial_fans(&scene.bar, &left, &right);
    let mut broken = above_critical_rows(scene, &all, parted);
    if !parted {
        broken.extend(limits(&bar).iter().filter_map(|limit| limit.broken(scene)));
    }
    (audit.rows(broken), bar.time())
}

/// State of the coarse run.
struct Estimate<'a> {
    scene: &'a Scene,
    bar: Leapfrog,
    steps: usize,
    audit: Audit,
    /// Positions that the audit reads.
    watched: Sampling,
    progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
}

/// Marker that the estimate ended before the end time.
struct Early;

impl Simulation for Estimate<'_> {
    type Solver = Leapfrog;
    type Error = Early;

    fn next(&self) -> Option<usize> {
        let every = (self.steps / AUDIT_SAMPLES).max(1);
        (self.bar.step() < self.steps).then(|| (self.bar.step() + every).min(self.steps))
    }

    fn bar(&mut self) -> (&mut Leapfrog, Option<&mut Traces>) {
        (&mut self.bar, None)
    }

    fn look(&mut self, _: Interval) -> Result<(), Early> {
        if self.bar.not_finite().is_some() || limits(&self.bar).iter().any(|limit| limit.stops(self.scene)) {
            return Err(Early);
        }
        if !self.bar.stayed_elastic() {
            self.audit.sample(&self.bar, &self.watched);
        }
        let (step, steps, cells) = (self.bar.step(), self.steps, self.bar.grid().cells());
        match (self.progress)(Progress::Steps { step, steps, cells }) {
            ControlFlow::Break(()) => Err(Early),
            ControlFlow::Continue(()) => Ok(()),
        }
    }
}

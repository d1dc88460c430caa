//! What a scene's neglected effects would change, before it is run: the audit of a run on a coarse grid. Its first waves,
//! their reflections, and what the ends do until the end time are then in the estimate; it takes some milliseconds.

use super::limits::AtLimit;
use super::{Progress, Wish, case, steps, struck_too_hard};
use crate::assemble;
use crate::bar::launches;
use crate::record::{Audit, AuditRow, LOOKS, Stepped, View};
use crate::scene::{Method, Scene};
use crate::solver::fd::Sampling;

/// Cells of the coarse grid; never more than half of the run's own.
const CELLS: usize = 200;

/// Work between two calls of the progress function, cell-steps.
const WORK_BETWEEN_CALLS: usize = 1_000_000;

/// The audit of a scene before it is run, with the effects that it has, and the time up to which it looked at the scene, s: less than
/// the end time where the bar comes to the end of its data, or `progress` asked to stop.
pub fn estimate(scene: &Scene, progress: &mut dyn FnMut(Progress) -> Wish) -> (Vec<AuditRow>, f64) {
    let cells = match scene.solve.method {
        Method::Leapfrog { cells, .. } | Method::Muscl { cells, .. } | Method::CharacteristicNet { cells } => {
            CELLS.min(cells / 2).max(2)
        }
        Method::FrontTracking { .. } => CELLS,
    };
    let mut bar = assemble::leapfrog(scene, cells, 1.0);
    let steps = steps(scene, bar.grid().dt);
    let mut audit = Audit::new(&case(scene, Some(bar.grid().cells())));
    let watched = Sampling::at(bar.grid(), audit.places().to_vec());
    let cells = bar.grid().cells();
    let every = (steps / LOOKS).clamp(1, (WORK_BETWEEN_CALLS / cells).max(1));
    while bar.step() < steps {
        bar.advance_by(every.min(steps - bar.step()));
        if bar.not_finite().is_some() || limits(&bar).iter().any(|limit| limit.stops(scene)) {
            break;
        }
        if !bar.stayed_elastic() {
            audit.look(&bar, &watched);
        }
        if progress(Progress::Steps { step: bar.step(), steps, cells }) == Wish::Stop {
            break;
        }
    }
    let parted = !View::ruptures(&bar).is_empty();
    let all = launches(&scene.bar, &scene.left, &scene.right);
    let mut broken = struck_too_hard(scene, &all, parted);
    let limits = limits(&bar);
    if !parted {
        broken.extend(limits.iter().filter_map(|limit| limit.broken(scene)));
    }
    (audit.rows(broken), bar.time())
}

fn limits(bar: &impl Stepped) -> Vec<AtLimit> {
    let (centres, dt) = (bar.grid().centres(), bar.grid().dt);
    bar.passed().in_order().map(|passed| AtLimit::on_grid(&passed, &centres, dt)).collect()
}

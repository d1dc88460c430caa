//! Error estimate of a run on a grid, from runs of the same bar with about a half, a quarter and an eighth of the cells. They take a third of the
//! run's stepping time, or somewhat more if the lengths of several segments restrict the number of cells.

use serde::{Deserialize, Serialize};

use super::Progress;
use crate::accuracy::{
    INSTANTS, Response, ResponseRequest, Rules, SAFETY, SAFETY_OF_FRONTS, evenly, extrapolate, respond,
    similar_response,
};
use crate::assemble;
use crate::bar::InitialFan;
use crate::error::{Error, Result};
use crate::record::{self, ErrorFigure, ErrorTable, Stepped};
use crate::scene::{Method, Scene};
use crate::snapshot::Snapshot;
use crate::solver::moc::Settings;
use std::f64::consts::SQRT_2;
use std::ops::ControlFlow;

/// Number of steps of the fine grid per step with an eighth of the cells: runs are compared after multiples of this number.
const COMMON: usize = 8;

/// Smallest number of cells for which an error is estimated.
const LEAST_CELLS: usize = 8;
/// Smallest number of cells for which a run with an eighth of them is added.
const LEAST_TO_CONFIRM: usize = 32;
/// Smallest number of cells requested for a companion.
const FEWEST_CELLS: usize = 2;
/// Smallest ratio of the cells of two runs that are compared; at this ratio the remaining error is four times the difference.
const LEAST_RATIO: f64 = SQRT_2;

/// Work between two calls of the progress function, cell-steps.
const WORK_BETWEEN_CALLS: u64 = 4_000_000;

/// Name of the reference for bars with a single fan.
pub(super) const SIMILAR: &str = "self-similar solution";

/// Reason for which a peak force has no error estimate.
const NO_LIMIT: &str = "; the peak force of a sudden load of a rate-dependent bar is not compared: it grows as the time step \
                        falls, by most rate laws with the logarithm of 1/dt, up to that of an elastic bar";

/// Results of a run on a grid, without recorders.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Coarse {
    pub response: Response,
    /// Whether nothing has yielded.
    pub elastic: bool,
    pub cells: usize,
    /// Number of steps times number of cells.
    pub work: u64,
}

/// Returns the instants of a run of `steps` steps that are also steps of the coarser runs, s.
pub(super) fn common_instants(steps: usize, dt: f64) -> Vec<f64> {
    if steps < COMMON {
        return vec![steps as f64 * dt];
    }
    let all: Vec<f64> = (1..=steps / COMMON).map(|k| (k * COMMON) as f64 * dt).collect();
    evenly(&all, 2 * INSTANTS)
}

/// Returns the error whose value is the largest entry of a table.
pub(super) fn figure(table: ErrorTable, reference: String) -> ErrorFigure {
    let largest = table.largest();
    let measure =
        largest.map_or_else(String::new, |(measure, _)| format!("{}, the largest of all", measure.describe()));
    ErrorFigure { value: largest.map_or(0.0, |largest| largest.1), measure, reference, table: Some(table) }
}

/// Returns the response of the self-similar solution at the instants of another response; `None` if the scene has no such solution up to the last of
/// them.
pub(super) fn similar(scene: &Scene, initial_fans: &[InitialFan], like: &Response) -> Option<Response> {
    let initial_fan = record::alone(&scene.bar, initial_fans, like.time())?;
    Some(similar_response(&scene.bar, initial_fan, &like.instants(), &scene.record.gauge_places()))
}

/// Simulates a bar on a grid without recorders; the fields are read near `instants` (s, increasing). Returns `None` if `progress` requests a stop, or
/// if the method has no grid.
pub(super) fn coarse(
    scene: &Scene,
    method: Method,
    instants: &[f64],
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Option<Coarse> {
    let scene = scene.by(method);
    let scene = &scene.in_pieces().unwrap_or(scene);
    assemble::solve(scene, Task { scene, instants, progress })
}

/// Coarse run of a scene.
struct Task<'a> {
    scene: &'a Scene,
    instants: &'a [f64],
    progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
}

impl assemble::Task for Task<'_> {
    type Output = Option<Coarse>;

    fn on_grid(self, mut bar: impl Stepped + Snapshot) -> Option<Coarse> {
        let cells = bar.grid().cells();
        let (gauges, joints) = (self.scene.record.gauge_places(), self.scene.joints());
        let (instants, work) = (self.instants, WORK_BETWEEN_CALLS);
        let request = ResponseRequest { instants, gauges: &gauges, joints: &joints, until: 0.0, work };
        let found = respond(&self.scene.bar, &mut bar, request, |bar, steps| {
            let flow = (self.progress)(Progress::Steps { step: bar.step(), steps, cells });
            if flow.is_break() { Err(()) } else { Ok(()) }
        });
        let (response, _) = found.ok()?;
        Some(Coarse { response, elastic: bar.stayed_elastic(), cells, work: (bar.step() * cells) as u64 })
    }

    fn by_fronts(self, _: Settings) -> Option<Coarse> {
        None
    }
}

/// Returns the method of a run on a grid and those of its companions, the finest first, with their actual numbers of cells. Each companion requests
/// half the cells of the previous one. If the segments require other numbers of cells, two requests can result in nearly the same grid; the coarser
/// one is then left out.
pub(super) fn with_companions(scene: &Scene, method: Method) -> Vec<(Method, usize)> {
    let asked = method.cells().unwrap_or(0);
    let most = if asked < LEAST_TO_CONFIRM { 3 } else { 4 };
    let mut grids = vec![(method, cells(scene, method))];
    let halves = std::iter::successors(Some(asked / 2), |cells| Some(cells / 2));
    for asked in halves.take_while(|&asked| asked >= FEWEST_CELLS) {
        if grids.len() == most {
            break;
        }
        let (coarser, finest_yet) = (method.with_cells(asked), grids[grids.len() - 1].1);
        let cells = cells(scene, coarser);
        if finest_yet as f64 >= LEAST_RATIO * cells as f64 {
            grids.push((coarser, cells));
        }
    }
    grids
}

/// Returns the number of cells of a scene's grid for a method.
fn cells(scene: &Scene, method: Method) -> usize {
    let scene = scene.by(method);
    let cut = scene.in_pieces();
    assemble::grid_by_method(cut.as_ref().unwrap_or(&scene)).map_or(0, |grid| grid.cells())
}

/// Returns the orders that can be expected of runs by a method; `elastic` tells whether the finest run stayed elastic.
pub(super) fn rules(scene: &Scene, method: Method, elastic: bool) -> Rules {
    match scene.effects.rate {
        _ if elastic || matches!(method, Method::CharacteristicNet { .. }) => Rules::Smooth,
        Some(_) => Rules::Rate,
        None => Rules::Fronts,
    }
}

/// Returns the error estimate of the run with the response `fine`; `None` if the run has too few cells.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` requests a stop.
pub(super) fn error_figure(
    scene: &Scene,
    fine: &Response,
    elastic: bool,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Option<ErrorFigure>> {
    let method = scene.solve.method;
    if method.cells().is_none_or(|cells| cells < LEAST_CELLS) {
        return Ok(None);
    }
    let instants = fine.instants();
    let grids = with_companions(scene, method);
    let mut coarser = Vec::new();
    for &(method, _) in &grids[1..] {
        coarser.push(coarse(scene, method, &instants, progress).ok_or(Error::Interrupted)?);
    }
    if coarser.is_empty() {
        return Ok(None);
    }
    let others = coarser.iter().map(|run| (run.cells, &run.response));
    let all: Vec<(usize, &Response)> = std::iter::once((grids[0].1, fine)).chain(others).collect();
    let (table, found) = extrapolate(rules(scene, method, elastic), &all);
    let (how, safety) = if found.observed { ("seen between them", SAFETY) } else { ("of fronts", SAFETY_OF_FRONTS) };
    let cells: Vec<String> = coarser.iter().map(|run| run.cells.to_string()).collect();
    let cells = match &cells[..] {
        [others @ .., last] if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        cells => cells.concat(),
    };
    let fading = if fine.peaks.iter().any(|peak| peak.has_no_limit) { NO_LIMIT } else { "" };
    let reference = format!(
        "runs with {cells} cells: Richardson's extrapolation with the order {:.2} {how}, times {safety}: an estimate{fading}",
        found.order
    );
    Ok(Some(figure(table, reference)))
}

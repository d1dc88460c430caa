//! Cost of accuracy of an impact without waves in a bar: error as a function of the number of modes and of the time steps.

use std::ops::ControlFlow;
use std::time::Instant;

use serde::Serialize;

use crate::error::{Error, InputError, Result};
use crate::impact::{Numerics, Problem, Solution};
use crate::scene::ImpactScene;

/// Numbers of modes that are tested, and that of their reference.
const MODES: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];
const REFERENCE_MODES: usize = 256;
/// Number of modes in the runs with different steps.
const MODES_OF_STEPS: usize = 64;
/// Step tolerances that are tested.
const TOLERANCES: [f64; 8] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
/// Step tolerance of their reference, and of all runs with different numbers of modes.
const REFERENCE_TOLERANCE: f64 = 1e-11;
/// Figures that are compared: the restitution by its difference, the others by their relative difference.
const COMPARED: [&str; 4] = ["peak_force", "contact_duration", "impulse", "restitution"];
/// Errors below this value are those of the reference and are not fitted.
const FLOOR: f64 = 1e-9;

/// Cost study of an impact.
#[derive(Debug, Clone, Serialize)]
pub struct ImpactCost {
    /// Scene title.
    pub scene: String,
    /// Reference of the errors.
    pub reference: String,
    /// Quantities that are compared.
    pub measure: String,
    /// One point for each run.
    pub points: Vec<ImpactPoint>,
    /// Slopes of log error over log modes and log steps.
    pub orders: Vec<ImpactOrder>,
    /// Whether the study was stopped before all points were finished.
    pub interrupted: bool,
}

/// A run.
#[derive(Debug, Clone, Serialize)]
pub struct ImpactPoint {
    /// Parameter that varies: "modes" or "steps".
    pub varied: &'static str,
    /// Modes of the struck body; null if it has none.
    pub modes: Option<usize>,
    /// Largest residual of Hertz's law in a step, relative to the largest force.
    pub tolerance: f64,
    /// Number of time steps in contact.
    pub steps: usize,
    /// Largest difference of the compared figures.
    pub error: f64,
    /// Computing time.
    pub wall_s: f64,
}

/// A fitted order of convergence.
#[derive(Debug, Clone, Serialize)]
pub struct ImpactOrder {
    /// Parameter that varies: "modes" or "steps".
    pub varied: &'static str,
    /// Order: the negative slope.
    pub order: f64,
    /// Number of fitted points.
    pub points: usize,
}

/// Runs the study. `progress` receives the parameter that varies and the completed fraction, and can stop the study.
///
/// # Errors
/// An [`InputError`] for a scene that is solved in closed form; [`Error::Interrupted`] if the study is stopped before its first point.
pub fn impact_cost(scene: &ImpactScene, progress: &mut dyn FnMut(&str, f64) -> ControlFlow<()>) -> Result<ImpactCost> {
    let Some(given) = scene.problem.numerics() else {
        let message = "this scene is solved in closed form: it has no numerical parameter and no error";
        return Err(InputError::new(message).help("use `barwave run`").into());
    };
    let has_modes =
        scene.problem.with(Numerics { modes: Some(1), ..given }).numerics().is_some_and(|n| n.modes.is_some());
    let study = |varied, modes: usize, tried: Vec<Numerics>| {
        (varied, Numerics { modes: has_modes.then_some(modes), tolerance: REFERENCE_TOLERANCE }, tried)
    };
    let of_modes = |modes: usize| Numerics { modes: Some(modes), tolerance: REFERENCE_TOLERANCE };
    let of_steps = |tolerance: f64| Numerics { modes: has_modes.then_some(MODES_OF_STEPS), tolerance };
    let mut studies = vec![study("steps", MODES_OF_STEPS, TOLERANCES.map(of_steps).to_vec())];
    if has_modes {
        studies.insert(0, study("modes", REFERENCE_MODES, MODES.map(of_modes).to_vec()));
    }
    let all: usize = studies.iter().map(|(.., tried)| tried.len() + 1).sum();
    let mut points = Vec::new();
    let (mut begun, mut interrupted) = (0_usize, false);
    'studies: for (varied, finest, tried) in studies {
        let mut reference = None;
        for numerics in std::iter::once(finest).chain(tried) {
            let Some((solution, wall_s)) =
                timed(&*scene.problem.with(numerics), progress, varied, begun as f64 / all as f64)
            else {
                interrupted = true;
                break 'studies;
            };
            begun += 1;
            let Some(reference) = &reference else {
                reference = Some(solution);
                continue;
            };
            points.push(ImpactPoint {
                varied,
                modes: numerics.modes,
                tolerance: numerics.tolerance,
                steps: solution.figure("contact_steps").unwrap_or_default() as usize,
                error: difference(&solution, reference),
                wall_s,
            });
        }
    }
    if points.is_empty() {
        return Err(Error::Interrupted);
    }
    let modes = if has_modes { format!("{REFERENCE_MODES} modes (for modes) and with ") } else { String::new() };
    Ok(ImpactCost {
        scene: scene.title.clone(),
        reference: format!("the same with {modes}a tolerance of {REFERENCE_TOLERANCE:e}"),
        measure:
            "largest relative difference of peak force, contact time and impulse, and difference of the restitution"
                .into(),
        interrupted,
        orders: ["modes", "steps"].iter().filter_map(|varied| order(varied, &points)).collect(),
        points,
    })
}

/// Returns a solution and its computing time, s, or `None` if it was interrupted.
fn timed(
    problem: &dyn Problem,
    progress: &mut dyn FnMut(&str, f64) -> ControlFlow<()>,
    what: &str,
    done: f64,
) -> Option<(Solution, f64)> {
    let started = Instant::now();
    let solution = problem.solved(&mut |_| progress(what, done));
    (!solution.is_interrupted()).then(|| (solution, started.elapsed().as_secs_f64()))
}

fn difference(solution: &Solution, reference: &Solution) -> f64 {
    let one = |name: &&str| {
        let (value, exact) = solution.figure(name).zip(reference.figure(name))?;
        let scale = if *name == "restitution" { 1.0 } else { exact };
        Some(((value - exact) / scale).abs())
    };
    COMPARED.iter().filter_map(one).filter(|difference| difference.is_finite()).fold(0.0, f64::max)
}

/// Fits the slope of log error over log modes or steps by least squares, using points with errors between [`FLOOR`] and 0.1, where the error
/// decreases.
fn order(varied: &'static str, points: &[ImpactPoint]) -> Option<ImpactOrder> {
    let of = |p: &&ImpactPoint| p.varied == varied && p.error > FLOOR && p.error < 0.1;
    let logs = |p: &ImpactPoint| {
        let count = if varied == "modes" { p.modes.unwrap_or(1) } else { p.steps };
        [(count as f64).ln(), p.error.ln()]
    };
    let logs: Vec<[f64; 2]> = points.iter().filter(of).map(logs).collect();
    if logs.len() < 2 {
        return None;
    }
    let n = logs.len() as f64;
    let mean = |k: usize| logs.iter().map(|p| p[k]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let spread: f64 = logs.iter().map(|p| (p[0] - x).powi(2)).sum();
    let slope = logs.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>() / spread;
    (spread > 0.0).then_some(ImpactOrder { varied, order: -slope, points: logs.len() })
}

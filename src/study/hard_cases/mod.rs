//! The hard cases: extreme scenes by every method that accepts them.
//!
//! Of every run the fields, the ends and the ledger are read back from its result file and checked, see `checks.rs`.

mod checks;
mod convergence;
mod scenes;
mod variation;

use std::ops::ControlFlow;
use std::path::Path;

use serde::Serialize;

pub use scenes::{Bound, CASES, HardCase};

use crate::error::{Error, Result};
use crate::record::Summary;
use crate::record::store::ResultFile;
use crate::run::{self, Progress};
use crate::scene::Scene;

/// Meetings of fronts after which front tracking gives up on a case.
const MOST_EVENTS: &str = "solve.max-events=1000000";

/// A method of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Finite differences, staggered in space and time.
    Leapfrog,
    /// Finite volumes with limited slopes and the exact Riemann problem.
    #[serde(rename = "muscl")]
    Godunov,
    /// Front tracking; with a rate law the characteristic net.
    #[serde(rename = "moc")]
    Characteristics,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Leapfrog, Self::Godunov, Self::Characteristics];

    /// As in `[solve]` and in headings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Leapfrog => "leapfrog",
            Self::Godunov => "muscl",
            Self::Characteristics => "moc",
        }
    }

    fn overrides(self, with_rate: bool) -> Vec<String> {
        let keys: &[&str] = match self {
            Self::Leapfrog => &["solve.method=\"fd\"", "solve.scheme=\"leapfrog\""],
            Self::Godunov => &["solve.method=\"fd\"", "solve.scheme=\"muscl\""],
            Self::Characteristics if with_rate => &["solve.method=\"moc\""],
            Self::Characteristics => &["solve.method=\"moc\"", "solve.cells=", MOST_EVENTS],
        };
        keys.iter().map(|&key| key.to_owned()).collect()
    }
}

/// Result of a case by one method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// The case.
    pub case: &'static str,
    /// The method.
    pub method: Method,
    /// "done", "rupture"; "refused" if the method does not support the scene; "stopped" if the run ended with an error.
    pub outcome: String,
    /// Why it was refused or stopped; empty otherwise.
    pub reason: String,
    /// Largest energy residual of the ledger, relative; none without a run.
    pub energy_residual: Option<f64>,
    /// Largest stress of all frames and ends, Pa.
    #[serde(rename = "largest_stress_Pa")]
    pub largest_stress: Option<f64>,
    /// Largest strain of all frames.
    pub largest_strain: Option<f64>,
    /// Largest total variation of stress or velocity along the bar, over the jump that the data impose; none where no bound is known.
    pub variation: Option<f64>,
    /// Mean differences in stress at the end time between runs on N and 2N, and 2N and 4N cells (or with front tolerances t, t/2, t/4),
    /// over the largest stress; 0: rounding.
    pub differences: Option<[f64; 2]>,
    /// Checks that do not hold for a reason that the case states, a sentence each.
    pub stated: Vec<String>,
    /// Checks that failed, a sentence each.
    pub failed: Vec<String>,
}

impl Tried {
    /// Before the scene has been read.
    fn refused(case: &HardCase, method: Method) -> Self {
        Self {
            case: case.name,
            method,
            outcome: "refused".to_owned(),
            reason: String::new(),
            energy_residual: None,
            largest_stress: None,
            largest_strain: None,
            variation: None,
            differences: None,
            stated: Vec::new(),
            failed: Vec::new(),
        }
    }

    /// Takes in how a run ended.
    fn ended(&mut self, ended: Result<Summary>) -> Result<()> {
        match ended {
            Ok(summary) => {
                self.outcome = summary.outcome;
                let residual = summary.ledger.energy_residual;
                self.energy_residual = Some(residual);
                if residual.is_nan() || residual > checks::MOST_RESIDUAL {
                    self.failed.push(format!("the energy residual is {residual:.1e}"));
                }
                Ok(())
            }
            Err(Error::Run(error)) => {
                (self.outcome, self.reason) = ("stopped".to_owned(), error.reason);
                Ok(())
            }
            Err(error) => Err(error),
        }
    }

    /// A check that does not hold fails, unless the case states why it cannot; one that does hold in spite of that fails too.
    fn judge(&mut self, fault: Option<String>, stated: Option<String>) {
        match (fault, stated) {
            (Some(_), Some(reason)) => self.stated.push(reason),
            (Some(fault), None) => self.failed.push(fault),
            (None, Some(reason)) => self.failed.push(format!("the check holds, although the case states: {reason}")),
            (None, None) => {}
        }
    }
}

/// Runs a case by a method, and again on other grids for its convergence; result files are written to `folder` and removed again.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` requests a stop, a file error where a result cannot be written or read.
pub fn run_case(
    case: &HardCase,
    method: Method,
    folder: &Path,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Tried> {
    let mut tried = Tried::refused(case, method);
    let text = case.text();
    let overrides = method.overrides(text.contains("rate ="));
    let scene = match Scene::parse(case.name, &text, folder, &overrides) {
        Ok(scene) => scene,
        Err(Error::Input(error)) => return Ok(Tried { reason: error.message, ..tried }),
        Err(error) => return Err(error),
    };
    let output = folder.join(format!("{}.h5", case.name));
    tried.ended(run::run(&scene, Some(&output), progress))?;
    let Ok(file) = ResultFile::open(&output) else { return Ok(tried) };
    let scale = check(&mut tried, case, &scene, &file)?;
    drop(file);
    // What cannot be removed goes with its folder.
    let _ = std::fs::remove_file(&output);
    if tried.outcome != "stopped" {
        let convergence = convergence::study(case, &scene, &overrides, scale, folder, progress)?;
        tried.differences = convergence.differences();
        let stated = case.why_no_convergence(method).map(|reason| format!("no convergence: {reason}"));
        tried.judge(convergence.fault(), stated);
    }
    Ok(tried)
}

/// Checks a result file; returns the largest stress that the bar has or can get from its motion, Pa.
fn check(tried: &mut Tried, case: &HardCase, scene: &Scene, file: &ResultFile) -> Result<f64> {
    let found = checks::check(file, &case.bounds())?;
    (tried.largest_stress, tried.largest_strain) = (Some(found.largest_stress), Some(found.largest_strain));
    tried.failed.extend(found.failed);
    // Leapfrog is not monotone: it rings behind fronts.
    let imposed = variation::imposed(scene).filter(|_| tried.method != Method::Leapfrog && tried.outcome != "stopped");
    if let Some(imposed) = imposed {
        let variation = checks::variation(file, imposed)?;
        tried.variation = Some(variation);
        let stated = case.growth_of_variation(tried.method);
        let exceeds = |most: f64| variation.is_nan() || variation > most;
        let fault = || format!("the total variation reaches {variation:.3} times the imposed jump");
        // Beyond what is stated no reason counts.
        let reason = stated.filter(|(most, _)| !exceeds(*most)).map(|(most, reason)| {
            format!("the total variation grows to at most {most} times the imposed jump: {reason}")
        });
        tried.judge(exceeds(variation::MOST_VARIATION).then(fault), reason);
    }
    let impedance = scene.bar.segments.iter().map(|s| s.material.impedance()).fold(0.0, f64::max);
    Ok(found.largest_stress.max(impedance * found.largest_velocity))
}

//! The hard cases: extreme scenes, each solved by every method that supports it.
//!
//! The fields, the end histories and the energy balance of every run are read back from its result file and checked, see `checks.rs`.

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

/// Override that limits front tracking to 10^6 interactions of fronts per case.
const MOST_EVENTS: &str = "solve.max-events=1000000";

/// A method of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Finite differences, staggered in space and time.
    Leapfrog,
    /// Finite volumes with slope limiting and an exact Riemann solver.
    #[serde(rename = "muscl")]
    Godunov,
    /// Front tracking, or the characteristic net if the scene has a rate law.
    #[serde(rename = "moc")]
    Characteristics,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 3] = [Self::Leapfrog, Self::Godunov, Self::Characteristics];

    /// Returns the name as it is written in `[solve]` and in headings.
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

/// Result of one case solved by one method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// Name of the case.
    pub case: &'static str,
    /// Method that solved the case.
    pub method: Method,
    /// "done" or "rupture"; "refused" if the method does not support the scene; "stopped" if the run ended with an error.
    pub outcome: String,
    /// Reason why the run was refused or stopped; empty otherwise.
    pub reason: String,
    /// Largest relative energy residual of the energy balance; `None` if no run was completed.
    pub energy_residual: Option<f64>,
    /// Largest stress of all frames and ends, Pa.
    #[serde(rename = "largest_stress_Pa")]
    pub largest_stress: Option<f64>,
    /// Largest strain of all frames.
    pub largest_strain: Option<f64>,
    /// Largest total variation of stress or velocity along the bar, relative to the jump that the data impose; `None` if no bound is known.
    pub variation: Option<f64>,
    /// Mean differences in stress at the end time, relative to the largest stress, between the runs with N and 2N cells and with 2N and 4N cells (or
    /// with front tolerances t, t/2 and t/4). 0: rounding.
    pub differences: Option<[f64; 2]>,
    /// One sentence for each check that does not hold for a reason that the case states.
    pub stated: Vec<String>,
    /// One sentence for each check that failed.
    pub failed: Vec<String>,
}

impl Tried {
    /// Returns the result of a case before its scene has been read.
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

    /// Records how a run ended, and the energy residual of a completed run.
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

    /// Records a check. A check that does not hold is a failure, unless the case states why it cannot hold. A check that holds although the case
    /// states that it cannot is also a failure.
    fn judge(&mut self, fault: Option<String>, stated: Option<String>) {
        match (fault, stated) {
            (Some(_), Some(reason)) => self.stated.push(reason),
            (Some(fault), None) => self.failed.push(fault),
            (None, Some(reason)) => self.failed.push(format!("the check holds, although the case states: {reason}")),
            (None, None) => {}
        }
    }
}

/// Runs a case by one method, and again at other resolutions for its convergence. Result files are written to `folder` and removed afterwards.
///
/// # Errors
/// [`Error::Interrupted`] if `progress` requests a stop; a file error if a result cannot be written or read.
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
    // A file that cannot be removed here is removed with its folder.
    let _ = std::fs::remove_file(&output);
    if tried.outcome != "stopped" {
        let convergence = convergence::study(case, &scene, &overrides, scale, folder, progress)?;
        tried.differences = convergence.differences();
        let stated = case.why_no_convergence(method).map(|reason| format!("no convergence: {reason}"));
        tried.judge(convergence.fault(), stated);
    }
    Ok(tried)
}

/// Checks a result file. Returns the stress scale of the case, Pa: the larger of the largest stress and the largest impedance times the largest
/// velocity.
fn check(tried: &mut Tried, case: &HardCase, scene: &Scene, file: &ResultFile) -> Result<f64> {
    let found = checks::check(file, &case.bounds())?;
    (tried.largest_stress, tried.largest_strain) = (Some(found.largest_stress), Some(found.largest_strain));
    tried.failed.extend(found.failed);
    // The leapfrog scheme is not monotone: it oscillates behind fronts.
    let imposed = variation::imposed(scene).filter(|_| tried.method != Method::Leapfrog && tried.outcome != "stopped");
    if let Some(imposed) = imposed {
        let variation = checks::variation(file, imposed)?;
        tried.variation = Some(variation);
        let stated = case.growth_of_variation(tried.method);
        let exceeds = |most: f64| variation.is_nan() || variation > most;
        let fault = || format!("the total variation reaches {variation:.3} times the imposed jump");
        // A stated reason counts only up to the stated bound.
        let reason = stated.filter(|(most, _)| !exceeds(*most)).map(|(most, reason)| {
            format!("the total variation grows to at most {most} times the imposed jump: {reason}")
        });
        tried.judge(exceeds(variation::MOST_VARIATION).then(fault), reason);
    }
    let impedance = scene.bar.segments.iter().map(|s| s.material.impedance()).fold(0.0, f64::max);
    Ok(found.largest_stress.max(impedance * found.largest_velocity))
}

//! The hard cases: scenes in which numerical methods break down, by every method that accepts them.
//!
//! Of every run the fields, the ends and the ledger are read back from its result file and checked, see [`checks`].

mod checks;
mod scenes;

use std::path::Path;

use serde::Serialize;

pub use scenes::{Bound, CASES, HardCase};

use crate::error::{Error, Result};
use crate::record::store::ResultFile;
use crate::run::{self, Progress, Wish};
use crate::scene::Scene;

/// Meetings of fronts after which front tracking gives up on a case.
const MOST_EVENTS: &str = "solve.event-budget=1000000";

/// A method of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Finite differences, staggered in space and time.
    Leapfrog,
    /// Finite volumes with limited slopes and the exact Riemann problem.
    Godunov,
    /// Front tracking; with a rate law the characteristic net.
    Characteristics,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Leapfrog, Self::Godunov, Self::Characteristics];

    /// As headings show it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Leapfrog => "leapfrog",
            Self::Godunov => "Godunov",
            Self::Characteristics => "characteristics",
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

/// What became of a case by a method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// The case.
    pub case: &'static str,
    /// The method.
    pub method: Method,
    /// "done", "rupture"; "refused" where the method does not take the scene; "stopped" where the run could not go on.
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
    /// Checks that failed, a sentence each.
    pub failed: Vec<String>,
}

/// Runs a case by a method; its result file is written to `folder` and removed again.
///
/// # Errors
/// [`Error::Interrupted`] where `progress` asked to stop, a file error where the result cannot be written or read.
pub fn run_case(
    case: &HardCase,
    method: Method,
    folder: &Path,
    progress: &mut dyn FnMut(Progress) -> Wish,
) -> Result<Tried> {
    let mut tried = Tried {
        case: case.name,
        method,
        outcome: "refused".to_owned(),
        reason: String::new(),
        energy_residual: None,
        largest_stress: None,
        largest_strain: None,
        failed: Vec::new(),
    };
    let text = case.text();
    let overrides = method.overrides(text.contains("rate ="));
    let scene = match Scene::parse(case.name, &text, folder, &overrides) {
        Ok(scene) => scene,
        Err(Error::Input(error)) => return Ok(Tried { reason: error.message, ..tried }),
        Err(error) => return Err(error),
    };
    let output = folder.join(format!("{}.h5", case.name));
    match run::run(&scene, Some(&output), progress) {
        Ok(summary) => {
            tried.outcome = summary.outcome;
            let residual = summary.ledger.energy_residual;
            tried.energy_residual = Some(residual);
            if residual.is_nan() || residual > checks::MOST_RESIDUAL {
                tried.failed.push(format!("the energy residual is {residual:.1e}"));
            }
        }
        Err(Error::Run(error)) => (tried.outcome, tried.reason) = ("stopped".to_owned(), error.reason),
        Err(error) => return Err(error),
    }
    if let Ok(file) = ResultFile::open(&output) {
        let found = checks::check(&file, &case.bounds())?;
        (tried.largest_stress, tried.largest_strain) = (Some(found.largest_stress), Some(found.largest_strain));
        tried.failed.extend(found.failed);
    }
    // What cannot be removed goes with its folder.
    let _ = std::fs::remove_file(&output);
    Ok(tried)
}

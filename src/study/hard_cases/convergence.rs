//! Convergence of a case, from three runs with N, 2N and 4N cells or with the front tolerances t, t/2 and t/4.

use std::ops::ControlFlow;
use std::path::Path;

use super::HardCase;
use crate::error::{Error, Result};
use crate::record::Field;
use crate::record::store::ResultFile;
use crate::run::{self, Progress};
use crate::scene::{Method, Scene};

/// Override for the number of samples along the bar at which runs are compared.
const SAMPLES: &str = "record.cells=400";

/// Differences below this value, relative to the largest stress, count as rounding.
const ROUNDING: f64 = 1e-9;

/// Fewest cells of the coarsest grid if the case does not state its cells. The coarsest grid has a quarter of the scene's cells, or all of them if a
/// quarter is fewer than this.
const LEAST_CELLS: usize = 5;

/// Result of the three runs.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// Mean over x of the stress differences between successive runs at the end time, relative to the largest stress.
    Differences([f64; 2]),
    /// A run did not reach the end time; the text gives the reason.
    Stopped(String),
}

impl Outcome {
    /// Returns a message if the results do not converge, otherwise `None`.
    pub(super) fn fault(&self) -> Option<String> {
        match self {
            Self::Stopped(why) => Some(format!("no convergence: {why}")),
            Self::Differences([first, second]) if second < first || first.max(*second) < ROUNDING => None,
            Self::Differences([first, second]) => {
                Some(format!("no convergence: the difference in stress changes from {first:.1e} to {second:.1e}"))
            }
        }
    }

    /// Returns the differences, with those that are rounding set to 0.
    pub(super) fn differences(&self) -> Option<[f64; 2]> {
        let Self::Differences(differences) = self else { return None };
        Some(differences.map(|difference| if difference < ROUNDING { 0.0 } else { difference }))
    }
}

/// Returns the overrides of the three runs, the coarsest first.
fn levels(case: &HardCase, method: &Method) -> [String; 3] {
    let on = |cells: usize| {
        let quarter = if cells / 4 >= LEAST_CELLS { cells / 4 } else { cells };
        let coarsest = case.coarsest().unwrap_or(quarter);
        [1, 2, 4].map(|k| format!("solve.cells={}", k * coarsest))
    };
    match *method {
        Method::Leapfrog { cells, .. } | Method::Muscl { cells, .. } | Method::CharacteristicNet { cells } => on(cells),
        Method::FrontTracking { front_tolerance, .. } => {
            [4.0, 2.0, 1.0].map(|k| format!("solve.front-tolerance={}", k * front_tolerance))
        }
    }
}

/// Runs a case at three resolutions and compares the stresses. `overrides` select the method; `scale` is the largest stress, Pa.
pub(super) fn study(
    case: &HardCase,
    scene: &Scene,
    overrides: &[String],
    scale: f64,
    folder: &Path,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Outcome> {
    let mut stresses: Vec<Vec<f64>> = Vec::new();
    for level in levels(case, &scene.solve.method) {
        let keys = [level.as_str(), SAMPLES, "record.frames=2", "record.fields=[\"stress\"]"].map(str::to_owned);
        match last_stress(case, &[overrides, &keys].concat(), folder, progress) {
            Ok(stress) => stresses.push(stress),
            Err(Error::Input(error)) => return Ok(Outcome::Stopped(format!("with {level} {}", error.message))),
            Err(Error::Run(error)) => return Ok(Outcome::Stopped(format!("with {level} {}", error.reason))),
            Err(error) => return Err(error),
        }
    }
    Ok(Outcome::Differences([0, 1].map(|k| difference(&stresses[k], &stresses[k + 1], scale))))
}

/// Runs a case and returns the stress along the bar at the end time, Pa.
fn last_stress(
    case: &HardCase,
    overrides: &[String],
    folder: &Path,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<f64>> {
    let scene = Scene::parse(case.name, &case.text(), folder, overrides)?;
    let output = folder.join(format!("{}-level.h5", case.name));
    let ran = run::run(&scene, Some(&output), progress).and_then(|_| {
        let file = ResultFile::open(&output)?;
        let frames = file.time()?.len();
        Ok(file.field(Field::Stress, frames - 1..frames)?.into_iter().collect())
    });
    // A file that cannot be removed here is removed with its folder.
    let _ = std::fs::remove_file(&output);
    ran
}

/// Returns the mean of |a - b| divided by the scale, or the sum of |a - b| if the scale is 0.
fn difference(a: &[f64], b: &[f64], scale: f64) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
    if scale > 0.0 { sum / (a.len() as f64 * scale) } else { sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_that_fall_or_are_rounding_are_convergence() {
        let fault = |first, second| Outcome::Differences([first, second]).fault();
        assert_eq!(fault(0.1, 0.05), None);
        assert_eq!(fault(0.0, 1e-12), None);
        assert!(fault(0.1, 0.1).is_some_and(|why| why.contains("from 1.0e-1 to 1.0e-1")));
        assert!(fault(1e-12, 1e-3).is_some() && fault(0.1, f64::NAN).is_some());
        assert!(Outcome::Stopped("with 25 cells it stopped".into()).fault().is_some());
        assert_eq!(difference(&[1.0, 2.0], &[2.0, 4.0], 3.0), 0.5);
    }
}

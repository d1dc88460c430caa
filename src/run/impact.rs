//! Runs impacts without waves in a bar, which are solved at once and written as a whole.

use std::path::Path;
use std::time::Instant;

use super::distinct;
use crate::error::{Error, Result};
use crate::impact::Watch;
use crate::record::store::{Header, check_output, write_impact};
use crate::record::{ImpactPlan, ImpactSummary};
use crate::scene::ImpactScene;

/// Solves the impact and, if requested, writes a result file, creating missing folders. As with [`super::run`], only an existing result is replaced.
/// `watch` receives the completed fraction.
///
/// # Errors
/// [`Error::Interrupted`] if `watch` requests a stop; the file then contains the result so far. A file error if the result cannot be written. An
/// [`InputError`](crate::error::InputError) if `output` is a file that a result must not replace.
pub fn run_impact(scene: &ImpactScene, output: Option<&Path>, watch: Watch<'_>) -> Result<ImpactSummary> {
    output.map_or(Ok(()), |path| check_output(path, false))?;
    impact_to_checked_file(scene, output, watch)
}

/// Solves the impact as [`run_impact`] does, to a file that the caller has checked.
pub(crate) fn impact_to_checked_file(
    scene: &ImpactScene,
    output: Option<&Path>,
    watch: Watch<'_>,
) -> Result<ImpactSummary> {
    let started = Instant::now();
    let mut solution = scene.problem.solve(watch)?;
    solution.warnings.extend(scene.notes());
    let (title, method) = (scene.title.clone(), scene.problem.method());
    let mut summary = ImpactSummary { scene: title, method, solution, wall_s: 0.0, output: String::new() };
    if let Some(path) = output {
        let header = Header {
            title: scene.title.clone(),
            scene: scene.text.clone(),
            scene_resolved: scene.resolved_json().to_string(),
            overrides: scene.overrides.clone(),
            method: summary.method.to_owned(),
            scheme: summary.solution.scheme.to_owned(),
            notes: summary.solution.warnings.clone(),
            ..Header::default()
        };
        let materials = distinct(scene.materials.iter().map(AsRef::as_ref));
        let result = (scene.problem.kind(), &summary.solution);
        write_impact(path, &header, &materials, result, started.elapsed().as_secs_f64())?;
        summary.output = path.display().to_string();
    }
    if summary.solution.is_interrupted() {
        return Err(Error::Interrupted);
    }
    summary.wall_s = started.elapsed().as_secs_f64();
    Ok(summary)
}

/// Returns the results of the impact that are available without an integration.
pub fn plan_impact(scene: &ImpactScene) -> ImpactPlan {
    let mut solution = scene.problem.planned();
    solution.warnings.extend(scene.notes());
    ImpactPlan { scene: scene.title.clone(), method: scene.problem.method(), solution }
}

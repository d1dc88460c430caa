//! Runs with checkpoints, and their resumption from the result file alone.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use super::chosen::Chosen;
use super::{Progress, Target, begin, to_checked_file};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::record::Summary;
use crate::record::store::{
    Checkpoint, Metadata, ResultFile, check_output, checkpoint_path, checksum, remove_checkpoint,
};
use crate::scene::Scene;
use crate::snapshot::unpack;
use crate::text_file;

/// Simulates a scene as [`super::run`] does, and writes a checkpoint next to the result file whenever the wall time `every` has passed, and when
/// `progress` requests a stop.
///
/// # Errors
/// As for [`super::run`].
pub fn run_with_checkpoints(
    scene: &Scene,
    output: &Path,
    every: Duration,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Summary> {
    check_output(output, false)?;
    to_checked_file(scene, output, Some(every), progress)
}

/// Resumes the run of a result file from its checkpoint. The result is bit-identical to that of an uninterrupted run. Without `every`, the checkpoint
/// interval is that of the interrupted run.
///
/// # Errors
/// As for [`super::run`], and an [`InputError`] if the file contains no run that can be resumed.
pub fn resume(
    output: &Path,
    every: Option<Duration>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Summary> {
    let (scene, checkpoint, chosen) = read(output)?;
    let every = every.unwrap_or_else(|| interval(checkpoint.every));
    let target =
        Target { path: Some(output), every: Some(every), checkpoint: Some(checkpoint), chosen, ..Target::default() };
    // The scene is read again if an effect turns out to have been neglected.
    text_file::stored(scene.files.clone(), || begin(&scene, target, progress))
}

/// Returns the interval of a checkpoint; the largest duration if the number of seconds exceeds it.
fn interval(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
}

/// Returns the scene and the checkpoint of an unfinished result, and its selected effects and method.
fn read(output: &Path) -> Result<(Scene, Checkpoint, Chosen)> {
    let file = ResultFile::open(output)?;
    let (metadata, place) = (file.metadata(), destination::resolve(output)?);
    if ["done", "rupture", "stopped"].contains(&metadata.outcome.as_str()) && metadata.steps.is_some() {
        // The checkpoint is left behind if a run is killed just before it would remove it.
        remove_checkpoint(&place);
        let message = format!("the run has ended: its outcome is `{}`", metadata.outcome);
        return Err(wrong(output, &message, "there is nothing to resume; `barwave report` draws the result").into());
    }
    let Some(checkpoint) = Checkpoint::read(&place)? else {
        let name = checkpoint_path(&place).display().to_string();
        let message = format!("there is no checkpoint to resume from (`{name}`)");
        let error = wrong(output, &message, "run its scene again, with checkpoints to be able to resume it");
        return Err(error.key("output").into());
    };
    if checkpoint.run_id != file.run_id() {
        let message = format!("`{}` is the checkpoint of another run", checkpoint_path(&place).display());
        return Err(wrong(output, &message, "put back the checkpoint of this result, or run its scene again").into());
    }
    let chosen: Chosen = unpack(&checkpoint.chosen).map_err(|e| Error::file(&checkpoint_path(&place), e))?;
    let mut scene = scene(&file, metadata, &chosen)?;
    let resolved = chosen.with_method(&scene).resolved_json().to_string();
    if resolved != metadata.scene_resolved || checksum(&resolved) != checkpoint.scene {
        let message = "this program resolves the scene differently from the one that started the run";
        return Err(wrong(output, message, "resume with the program that started it, or run its scene again").into());
    }
    scene.parts.solve.estimate_error = checkpoint.estimate_error;
    Ok((scene, checkpoint, chosen))
}

/// Returns the scene of a result file with its selected effects, using only data stored in the file.
fn scene(file: &ResultFile, metadata: &Metadata, chosen: &Chosen) -> Result<Scene> {
    let files = file.scene_files()?;
    let resolved: serde_json::Value = serde_json::from_str(&metadata.scene_resolved).unwrap_or_default();
    // This file is not opened: its stem is the name of the scene.
    let name = format!("{}.toml", resolved["name"].as_str().unwrap_or("scene"));
    let base = files.base.clone();
    text_file::stored(files, || {
        let scene = Scene::parse(&name, &metadata.scene, Path::new(&base), &metadata.overrides)?;
        chosen.with_effects(scene)
    })
}

fn wrong(path: &Path, message: &str, help: &str) -> InputError {
    InputError::new(format!("{}: {message}", path.display())).help(help)
}

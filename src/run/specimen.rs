//! `[specimen]` scenes: one look at the energies.

use std::path::Path;
use std::time::Instant;

use crate::error::Result;
use crate::record::store::{Header, write_figures};
use crate::record::{EnergySummary, MaterialRecord};
use crate::scene::SpecimenScene;

/// Says whether the specimen breaks, and writes a result file where one is asked for.
///
/// # Errors
/// A file error where the result cannot be written.
pub fn run_specimen(scene: &SpecimenScene, output: Option<&Path>) -> Result<EnergySummary> {
    let started = Instant::now();
    let mut summary = EnergySummary::new(&scene.title, &scene.blow);
    if let Some(path) = output {
        let header = Header {
            title: scene.title.clone(),
            scene: scene.text.clone(),
            scene_resolved: scene.resolved_json().to_string(),
            overrides: scene.overrides.clone(),
            method: summary.method.clone(),
            scheme: summary.scheme.clone(),
            ..Header::default()
        };
        let materials: Vec<MaterialRecord> = scene.material.iter().map(|m| MaterialRecord::from(m.as_ref())).collect();
        let ending = (summary.outcome.as_str(), started.elapsed().as_secs_f64());
        write_figures(path, &header, &materials, ("energy", &summary.figures()), ending)?;
        summary.output = path.display().to_string();
    }
    summary.wall_s = started.elapsed().as_secs_f64();
    Ok(summary)
}

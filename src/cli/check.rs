//! `barwave check`.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::summary::note_lines;
use super::{message, output, settings};
use crate::error::{Error, InputError, Result};
use crate::input::Document;
use crate::material;
use crate::scene::{KINDS, Problem};
use crate::study::sweep::Sweep;
use crate::units::System;

/// Options of `barwave check`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  barwave check scene.toml materials/steel.toml\n  barwave check - < scene.toml")]
pub(crate) struct Args {
    /// Scene, material and sweep files; the kind is determined from the content.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
}

/// Kind of a file.
enum Kind {
    Scene,
    Material,
    Sweep,
}

/// Keys that only a scene has at its top level.
const OF_A_SCENE: [&str; 7] = ["striker", "bar", "left", "right", "effects", "solve", "record"];
/// Keys that only a material has at its top level.
const OF_A_MATERIAL: [&str; 4] = ["density", "curve", "modulus", "source"];

/// Checks every file, even if others have errors. All errors but the last are printed here; the last one is returned and sets the exit code.
pub(crate) fn run(args: &Args) -> Result<()> {
    let mut last: Option<Error> = None;
    for file in &args.files {
        match check(file) {
            Ok((what, notes)) if settings::json() => {
                output::json_line(&json!({ "file": file.display().to_string(), "kind": what, "notes": notes }))?;
            }
            Ok((what, notes)) => {
                let notes: String = note_lines(&notes, System::Si).map(|line| line + "\n").collect();
                output::text(&format!("{}: ok ({what})\n{notes}", file.display()))?;
            }
            Err(error) => {
                if let Some(before) = last.replace(error) {
                    message::show(&before);
                }
            }
        }
    }
    last.map_or(Ok(()), Err)
}

/// Checks a file and returns its kind and notes on it.
fn check(file: &Path) -> Result<(&'static str, Vec<String>)> {
    let document = Document::read_scene(file)?;
    match kind(&document)? {
        Kind::Scene => {
            let notes = match Problem::of_document(&document, file, &[])? {
                Problem::Bar(scene) => scene.notes(),
                Problem::Impact(scene) => scene.notes(),
            };
            Ok(("scene", notes))
        }
        Kind::Sweep => {
            let sweep = Sweep::of_document(&document, file)?;
            sweep.problem(0)?;
            Ok(("sweep", Vec::new()))
        }
        Kind::Material => {
            let material = material::file::of_document(&document, file)?;
            Ok(("material", material.notes()))
        }
    }
}

fn kind(document: &Document) -> Result<Kind> {
    let parsed = document.parsed()?;
    if parsed.has("sweep") {
        return Ok(Kind::Sweep);
    }
    let has = |keys: &[&str]| keys.iter().any(|key| parsed.has(key));
    let impact = KINDS.iter().any(|kind| parsed.has(kind.key));
    match (impact || has(&OF_A_SCENE), has(&OF_A_MATERIAL)) {
        (true, _) => Ok(Kind::Scene),
        (false, true) => Ok(Kind::Material),
        (false, false) => {
            let message = format!("`{}` is neither a scene nor a material", document.file);
            let help = "a scene has [bar], [left], [right] and [solve]; a material has density and [curve]; \
                        `barwave new NAME` writes a template";
            Err(InputError::new(message).help(help).into())
        }
    }
}

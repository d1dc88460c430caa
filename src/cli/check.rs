//! `barwave check`.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::summary::note_lines;
use super::{message, output, settings};
use crate::error::{Error, InputError, Result};
use crate::input::{Document, FileKind};
use crate::material;
use crate::scene::Problem;
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
        FileKind::Scene => {
            let notes = match Problem::of_document(&document, file, &[])? {
                Problem::Bar(scene) => scene.notes(),
                Problem::Impact(scene) => scene.notes(),
            };
            Ok(("scene", notes))
        }
        FileKind::Sweep => {
            let sweep = Sweep::of_document(&document, file)?;
            sweep.problem(0)?;
            Ok(("sweep", Vec::new()))
        }
        FileKind::Material => {
            let material = material::file::of_document(&document, file)?;
            Ok(("material", material.notes()))
        }
    }
}

fn kind(document: &Document) -> Result<FileKind> {
    FileKind::of(&document.parsed()?).ok_or_else(|| {
        let message = format!("`{}` is neither a scene nor a material", document.file);
        let help = "a scene has [bar], [left], [right] and [solve]; a material has density and [curve]; \
                    `barwave new NAME` writes a template";
        InputError::new(message).help(help).into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::KINDS;

    #[test]
    fn every_impact_is_a_scene() {
        for impact in &KINDS {
            let document = Document::new("test.toml", format!("[{}]\n", impact.key));
            assert_eq!(kind(&document).expect("a kind"), FileKind::Scene, "{}", impact.key);
        }
    }
}

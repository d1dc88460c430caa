//! `barwave completions`, `man` and `schema`: descriptions of the program for other tools.

use std::path::PathBuf;

use clap::{CommandFactory, ValueEnum};

use super::{Cli, output, settings};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::material::RawMaterial;
use crate::scene::{KINDS, RawScene};
use crate::study::sweep;
use crate::typed;

/// Options of `barwave completions`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave completions bash > ~/.local/share/bash-completion/completions/barwave\n  barwave \
                  completions zsh > _barwave"
)]
pub(crate) struct CompletionsArgs {
    /// Shell; its completions are written to standard output.
    shell: clap_complete::Shell,
}

/// Options of `barwave man`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  barwave man | man -l -\n  barwave man -o man1")]
pub(crate) struct ManArgs {
    /// Folder for the pages of all commands. Without it, the main page is written to standard output.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Options of `barwave schema`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave schema > scene.schema.json\n  barwave schema material > material.schema.json"
)]
pub(crate) struct SchemaArgs {
    /// Kind of file that the schema describes; the schema is written to standard output.
    #[arg(value_enum, default_value_t = Described::Scene)]
    file: Described,
}

/// Kinds of files that have a schema.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Described {
    /// Scene files.
    Scene,
    /// Scene files of the energy method.
    Specimen,
    /// Scene files of two spheres.
    Spheres,
    /// Scene files of a sphere on a plate.
    Plate,
    /// Scene files of a sphere on a beam.
    Beam,
    /// Material files.
    Material,
    /// Sweep files.
    Sweep,
}

fn not_as_json(command: &str) -> Result<()> {
    if !settings::json() {
        return Ok(());
    }
    let message = format!("`barwave {command}` writes text for other programs");
    Err(InputError::new(message).key("--json").help("remove --json").into())
}

pub(crate) fn completions(args: &CompletionsArgs) -> Result<()> {
    not_as_json("completions")?;
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "barwave", &mut script);
    output::bytes(&script)
}

pub(crate) fn man(args: &ManArgs) -> Result<()> {
    not_as_json("man")?;
    let Some(folder) = &args.output else {
        let mut page = Vec::new();
        let rendered = clap_mangen::Man::new(Cli::command()).render(&mut page);
        rendered.map_err(|e| Error::file("man page".as_ref(), e))?;
        return output::bytes(&page);
    };
    destination::folder_at(folder)?;
    clap_mangen::generate_to(Cli::command(), folder).map_err(|e| Error::file(folder, e))
}

pub(crate) fn schema(args: &SchemaArgs) -> Result<()> {
    let of_kind = |key| KINDS.iter().find(|kind| kind.key == key).map(|kind| (kind.schema)()).unwrap_or_default();
    let schema = match args.file {
        Described::Specimen => of_kind("specimen"),
        Described::Spheres => of_kind("spheres"),
        Described::Plate => of_kind("plate"),
        Described::Beam => of_kind("beam"),
        Described::Scene => typed::schema::<RawScene>(),
        Described::Material => typed::schema::<RawMaterial>(),
        Described::Sweep => typed::schema::<sweep::RawFile>(),
    };
    let mut text = format!("{:#}", schema.as_value());
    text.push('\n');
    output::bytes(text.as_bytes())
}

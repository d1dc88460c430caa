//! `barwave materials import`: a material file for a CSV file.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::critical_line;
use crate::cli::critical::SenseArg;
use crate::cli::output;
use crate::destination;
use crate::error::{InputError, Result};
use crate::input::Document;
use crate::material::{self, RawMaterial, Sense};
use crate::report::plot::write_whole;

/// Options of `barwave materials import`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// CSV file with the columns strain and stress; a header may name units: `strain,stress_MPa`.
    csv: PathBuf,
    /// Mass per volume, e.g. "7.85 g/cm^3".
    #[arg(long)]
    density: String,
    /// Elastic modulus, e.g. "207 GPa" (default: the steepest slope).
    #[arg(long)]
    modulus: Option<String>,
    /// Unit of the stresses where the header names none, e.g. MPa (default: Pa).
    #[arg(long)]
    unit: Option<String>,
    /// Name of the material (default: that of the CSV file).
    #[arg(long)]
    name: Option<String>,
    /// The file holds true strain and true stress (default: engineering).
    #[arg(long = "true")]
    is_true: bool,
    /// Sense of loading in the test.
    #[arg(long, value_enum, default_value = "tension")]
    sense: SenseArg,
    /// Behaviour past the last row.
    #[arg(long, value_enum, default_value = "error")]
    beyond: BeyondArg,
    /// File to write (default: the CSV file's name with .toml, beside it).
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrite an existing file.
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum BeyondArg {
    /// The specimen fractures there.
    Rupture,
    /// The last slope is extrapolated.
    Extend,
    /// A run that reaches it stops.
    Error,
}

pub(super) fn run(args: &Args) -> Result<()> {
    let path = args.output.clone().unwrap_or_else(|| args.csv.with_extension("toml"));
    destination::resolve(&path)?;
    if path.exists() && !args.force {
        return Err(InputError::new(format!("`{}` exists already", path.display()))
            .key("-o")
            .help("name another file with -o, or overwrite it with --force")
            .into());
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let text = file_text(args, folder)?;
    let document = Document::new(path.display().to_string(), text.as_str());
    let raw: RawMaterial = document.parse()?;
    let checked = material::resolve(raw, &document, "", folder)?;
    write_whole(&path, text.as_bytes())?;
    let limit = checked.tension.elastic_limit(checked.modulus).1;
    output::text(&format!(
        "wrote {}\nrows            {}\nmodulus         {:.4} GPa\nelastic limit   {:.4} MPa\ncritical        {}\n\
         Fill in [source] before you rely on it.\n",
        path.display(),
        checked.tension.strain().len(),
        checked.modulus / 1e9,
        limit / 1e6,
        critical_line(&checked, Sense::Tension)
    ))
}

/// The material file. The CSV file is named relative to it where both lie in one folder, otherwise by its full path.
fn file_text(args: &Args, folder: &Path) -> Result<String> {
    let missing = |e: std::io::Error| {
        InputError::new(format!("cannot read `{}`: {e}", args.csv.display())).help("check the spelling and the folder")
    };
    let csv = std::fs::canonicalize(&args.csv).map_err(missing)?;
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let beside = std::fs::canonicalize(here).is_ok_and(|f| csv.parent() == Some(f.as_path()));
    let named = if beside { csv.file_name().map(PathBuf::from).unwrap_or_default() } else { csv };
    let stem = args.csv.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut text = String::new();
    let mut line = |key: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{key} = {value}");
    };
    line("name", quote(args.name.as_deref().unwrap_or(&stem)));
    line("description", quote(""));
    line("density", number(&args.density));
    if let Some(modulus) = &args.modulus {
        line("modulus", number(modulus));
    }
    line("measure", quote(if args.is_true { "true" } else { "engineering" }));
    line("sense", quote(if args.sense == SenseArg::Tension { "tension" } else { "compression" }));
    line("beyond", word(args.beyond));
    text += "\n[curve]\n";
    let _ = writeln!(text, "csv = {}", quote(&named.display().to_string()));
    if let Some(unit) = &args.unit {
        let _ = writeln!(text, "unit = {}", quote(unit));
    }
    text += "\n[source]\ncitation = \"\"\nmeasured = \"\"\nconfidence = \"measured\"\n";
    Ok(text)
}

fn word(beyond: BeyondArg) -> String {
    quote(match beyond {
        BeyondArg::Rupture => "rupture",
        BeyondArg::Extend => "extend",
        BeyondArg::Error => "error",
    })
}

/// A plain number stays one; anything else is text with a unit.
fn number(typed: &str) -> String {
    if typed.trim().parse::<f64>().is_ok_and(f64::is_finite) { typed.trim().to_owned() } else { quote(typed) }
}

fn quote(text: &str) -> String {
    toml_edit::Value::from(text).to_string()
}

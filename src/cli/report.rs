//! `barwave report`.

use std::path::PathBuf;

use super::{output, settings};
use crate::destination;
use crate::error::{Error, Result};
use crate::record::Field;
use crate::record::store::ResultFile;
use crate::report::plot::{Format, PNG_SCALE, png, write_whole};
use crate::report::{Units, draw, page};
use crate::units::System;

/// Options of `barwave report`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave report out.h5 -o out.html\n  barwave report out.h5 --field strain -o - > strain.svg"
)]
pub(crate) struct Args {
    /// Result file that `barwave run` wrote, finished or not.
    #[arg(value_name = "OUT.h5")]
    file: PathBuf,
    /// Output file: .html (figure and tables), .svg or .png (figure); `-` writes SVG to standard output. Default: the name of the result
    /// with .svg.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Field to show over x and t. Default: stress, or else the first that was recorded.
    #[arg(long, value_enum)]
    field: Option<Field>,
    /// Units of the report.
    #[arg(long, value_enum, default_value_t = System::Si)]
    units: System,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let file = ResultFile::open(&args.file)?;
    let path = args.output.clone().unwrap_or_else(|| args.file.with_extension("svg"));
    let format = Format::of(&path)?;
    output::check(settings::json(), [Some(path.as_path())])?;
    let units = match args.units {
        System::Si => Units::Si,
        System::Us => Units::Us,
    };
    let has_figure = file.impact()?.is_none_or(|impact| impact.has_histories());
    // The page of an impact in closed form holds its tables.
    let svg = if has_figure || format != Format::Html { draw(&file, args.field, units)? } else { String::new() };
    match format {
        Format::Svg => write_whole(&path, svg.as_bytes()),
        Format::Png => png(&svg, PNG_SCALE)
            .map_err(|reason| Error::file(&path, reason))
            .and_then(|bytes| write_whole(&path, &bytes)),
        Format::Html => write_whole(&path, page(&file, &svg, units)?.as_bytes()),
    }?;
    if file.facts().is_unfinished() && !settings::json() {
        output::note(&format!("note: {} is unfinished; the figure shows the frames so far\n", args.file.display()));
    }
    if destination::is_stdout(&path) {
        return Ok(());
    }
    output::written(&[&path], &format!("{}\n", path.display()))
}

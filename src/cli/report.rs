//! `barwave report`.

use std::path::PathBuf;

use super::{options, output, settings};
use crate::destination;
use crate::error::Result;
use crate::inputs;
use crate::record::Field;
use crate::record::store::ResultFile;
use crate::report::plot::{Format, save};
use crate::report::{Figure, PanelName, Units, draw, page};
use crate::units::System;

/// Options of `barwave report`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave report out.h5 -o out.html\n  barwave report out.h5 --field strain -o - > strain.svg\n  barwave report out.h5 --panel profiles --size 680x480 -o profiles.png"
)]
pub(crate) struct Args {
    /// Result file that `barwave run` wrote, finished or not.
    #[arg(value_name = "OUT.h5")]
    file: PathBuf,
    /// Output file: .html (page with read-outs, time slider and tables), .svg, .png or .pdf (figure); `-` writes SVG to standard output.
    /// Default: the name of the result with .svg.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Field to show in all panels. Default: stress, or else the first recorded field.
    #[arg(long, value_enum)]
    field: Option<Field>,
    /// Panel to draw; may be repeated. Default: all available panels, under a title.
    #[arg(long = "panel", value_enum, value_name = "NAME")]
    panels: Vec<PanelName>,
    /// Width and height of the figure in px of 1/96 inch, e.g. 680x480. Default: as large as the panels need.
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[f64; 2]>,
    /// Units of the report.
    #[arg(long, value_enum, default_value_t = System::Si)]
    units: System,
    /// Overwrite an existing output file that barwave did not write.
    #[arg(long)]
    force: bool,
}

/// Library arguments that are set by command-line options.
const OPTIONS: &[options::OptionOf<'static>] =
    &[("size", "--size", "e.g. --size 680x480"), ("panels", "--panel", ""), ("field", "--field", "")];

pub(crate) fn run(args: &Args) -> Result<()> {
    write(args).map_err(|error| options::name(error, OPTIONS))
}

fn write(args: &Args) -> Result<()> {
    let file = ResultFile::open(&args.file)?;
    inputs::protect(&args.file);
    let path = args.output.clone().unwrap_or_else(|| args.file.with_extension("svg"));
    let format = options::picture(&path, "-o")?;
    output::check(settings::json(), [Some(path.as_path())])?;
    output::check_replaced(&path, None, args.force)?;
    let units = match args.units {
        System::Si => Units::Si,
        System::Us => Units::Us,
    };
    let figure = Figure { field: args.field, units, panels: args.panels.clone(), size: args.size };
    match format {
        Format::Html => destination::write_whole(&path, page(&file, &figure)?.as_bytes())?,
        Format::Svg | Format::Png | Format::Pdf => save(&path, &file.metadata().title, &draw(&file, &figure)?)?,
    }
    if file.metadata().is_unfinished() && !settings::json() {
        output::note(&format!("note: {} is unfinished; the figure shows the frames so far\n", args.file.display()));
    }
    if destination::is_stdout(&path) {
        return Ok(());
    }
    output::written(&[&path], &format!("{}\n", path.display()))
}

/// Parses a size such as `680x480`.
fn size(text: &str) -> std::result::Result<[f64; 2], String> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let (width, height) = text.split_once(['x', 'X', '\u{d7}']).ok_or("expected width x height in px, e.g. 680x480")?;
    match (number(width), number(height)) {
        (Some(width), Some(height)) => Ok([width, height]),
        _ => Err("width and height must be numbers of px, e.g. 680x480".into()),
    }
}

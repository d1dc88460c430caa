//! `barwave report`.

use std::path::PathBuf;

use clap::ValueEnum;

use crate::error::{Error, Result};
use crate::record::Field;
use crate::record::store::ResultFile;
use crate::report::plot::{Format, PNG_SCALE, png, write_whole};
use crate::report::{Units, draw, page};

/// Options of `barwave report`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Result file that `barwave run` wrote, finished or not.
    #[arg(value_name = "OUT.h5")]
    file: PathBuf,
    /// Where to write: .html (figure and tables), .svg or .png (figure). Default: the result's name with .svg.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Field to show over x and t. Default: stress, or else the first that was recorded.
    #[arg(long, value_enum)]
    field: Option<FieldName>,
    /// Units of the report.
    #[arg(long, value_enum, default_value_t = UnitsName::Si)]
    units: UnitsName,
}

/// Fields as options.
#[derive(Debug, Clone, Copy, ValueEnum)]
#[value(rename_all = "snake_case")]
enum FieldName {
    Stress,
    Strain,
    Velocity,
    Displacement,
    PlasticStrain,
    AccumulatedPlasticStrain,
}

impl From<FieldName> for Field {
    fn from(name: FieldName) -> Self {
        match name {
            FieldName::Stress => Self::Stress,
            FieldName::Strain => Self::Strain,
            FieldName::Velocity => Self::Velocity,
            FieldName::Displacement => Self::Displacement,
            FieldName::PlasticStrain => Self::PlasticStrain,
            FieldName::AccumulatedPlasticStrain => Self::AccumulatedPlasticStrain,
        }
    }
}

/// Systems of units as options.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum UnitsName {
    /// m, MPa, m/s.
    Si,
    /// in, ksi, ft/s.
    Us,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let output = args.output.clone().unwrap_or_else(|| args.file.with_extension("svg"));
    let format = Format::of(&output)?;
    let file = ResultFile::open(&args.file)?;
    let units = match args.units {
        UnitsName::Si => Units::Si,
        UnitsName::Us => Units::Us,
    };
    let svg = draw(&file, args.field.map(Field::from), units)?;
    match format {
        Format::Svg => write_whole(&output, svg.as_bytes()),
        Format::Png => png(&svg, PNG_SCALE)
            .map_err(|reason| Error::file(&output, reason))
            .and_then(|bytes| write_whole(&output, &bytes)),
        Format::Html => write_whole(&output, page(&file, &svg, units)?.as_bytes()),
    }?;
    if file.facts().is_unfinished() {
        eprintln!("note: {} is unfinished; drawn is what it holds so far", args.file.display());
    }
    println!("{}", output.display());
    Ok(())
}

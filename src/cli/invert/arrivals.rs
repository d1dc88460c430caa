//! `barwave invert arrivals`.

use std::path::PathBuf;

use super::shared::{self, Outputs, Random, Waves};
use crate::cli::lines::Lines;
use crate::cli::options::OptionOf;
use crate::cli::quantity;
use crate::cli::result_file::is_result;
use crate::error::{InputError, Result};
use crate::material::Sense;
use crate::study::invert::arrivals::{Inverted, Options, of_records, of_table};
use crate::study::invert::{MaterialText, Recording, from_waves};
use crate::units::Dimension;

const TITLE: &str = "Curve from arrival times";

/// Options of `barwave invert arrivals`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  barwave invert arrivals bar.h5 -o copper.toml --plot copper.png\n  \
    barwave invert arrivals records.csv --at 20mm,40mm,80mm --density \"8960 kg/m^3\" --modulus \"115 GPa\" --length 1m\n  \
    barwave invert arrivals arrivals.csv --density \"8960 kg/m^3\"    # columns x_mm,strain,time_us")]
pub(super) struct Args {
    /// Result file; or strain records, CSV with the time and a column for each gauge, with --at; or arrivals, CSV with the columns x (from
    /// the loaded end), strain and time. Headers name units: `time_us`, `x (mm)`, `strain (%)`.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Distances of the gauges from the loaded end, in the order of the columns, e.g. 20mm,40mm,80mm.
    #[arg(long, value_name = "X,X,...", value_delimiter = ',', value_parser = quantity::not_negative(Dimension::Length))]
    at: Vec<f64>,
    /// Gauges of the result file to use (default: all).
    #[arg(long, value_name = "NAME,NAME,...", value_delimiter = ',')]
    gauges: Vec<String>,
    /// Mass per volume (default: that of the result file).
    #[arg(long, value_parser = quantity::positive(Dimension::Density))]
    density: Option<f64>,
    /// Elastic modulus (default: that of the result file); no wave is faster than the elastic one.
    #[arg(long, value_parser = quantity::positive(Dimension::Stress))]
    modulus: Option<f64>,
    /// Length of the bar (default: that of the result file), for the arrival of reflected waves.
    #[arg(long, value_parser = quantity::positive(Dimension::Length))]
    length: Option<f64>,
    /// Time at which the loading starts.
    #[arg(long, default_value = "0 s", value_parser = quantity::any(Dimension::Time))]
    start: f64,
    /// The loading is sudden: all strains leave the loaded end at --start.
    #[arg(long)]
    centred: bool,
    /// Standard error of the gauge positions.
    #[arg(long, default_value = "0 mm", value_parser = quantity::not_negative(Dimension::Length))]
    position_error: f64,
    /// Standard error of an arrival time in a table of arrivals (default: from their scatter).
    #[arg(long, value_parser = quantity::positive(Dimension::Time))]
    time_error: Option<f64>,
    #[command(flatten)]
    random: Random,
    #[command(flatten)]
    outputs: Outputs,
}

/// Library arguments that are set by command-line options.
pub(super) const OPTIONS: &[OptionOf<'static>] = &[
    ("density", "--density", ""),
    ("modulus", "--modulus", ""),
    ("length", "--length", ""),
    ("start", "--start", ""),
    ("centred", "--centred", ""),
    ("distances", "--at", "e.g. --at 20mm,40mm"),
    ("gauges", "--gauges", ""),
    ("position_error", "--position-error", ""),
    ("replicates", "--replicates", ""),
    ("time_error", "--time-error", "e.g. --time-error \"0.2 us\""),
];

pub(super) fn run(args: &Args) -> Result<()> {
    args.outputs.check()?;
    let recording = recording(args)?;
    let of_file = |own: fn(&Recording) -> Option<f64>| recording.as_ref().and_then(own);
    let options = Options {
        density: shared::needed(args.density.or(of_file(|r| r.density)), "--density", "8960 kg/m^3")?,
        modulus: args.modulus.or(of_file(|r| r.modulus)),
        length: args.length.or(of_file(|r| r.length)),
        start: args.start,
        centred: args.centred,
        position_error: args.position_error,
        time_error: args.time_error,
        replicates: args.random.replicates,
        seed: args.random.seed,
    };
    let inverted = match &recording {
        Some(recording) => of_records(recording, &options)?,
        None => of_table(&args.file, &options)?,
    };
    write(args, &options, recording.as_ref(), &inverted)
}

/// Returns the records of gauges, or `None` if the file is a table of arrivals.
fn recording(args: &Args) -> Result<Option<Recording>> {
    let recording = if is_result(&args.file) {
        Recording::from_result(&shared::result_of_bar(&args.file)?, &args.gauges)?
    } else if args.at.is_empty() {
        return match args.random.noise {
            Some(_) => Err(InputError::new("a table of arrivals has no record to add noise to")
                .key("--noise")
                .help("give --time-error instead")
                .into()),
            None => Ok(None),
        };
    } else {
        Recording::from_csv(&args.file, &args.at)?
    };
    Ok(Some(match args.random.noise {
        Some(part) => recording.with_noise(part, args.random.seed),
        None => recording,
    }))
}

fn write(args: &Args, options: &Options, recording: Option<&Recording>, inverted: &Inverted) -> Result<()> {
    let given = recording.and_then(|r| r.given.as_ref());
    let outputs = &args.outputs;
    let file = args.file.display();
    let material = MaterialText {
        name: &outputs.name(),
        description: "Inverted from the arrival times of strain levels",
        density: options.density,
        modulus: options.modulus,
        sense: recording.map_or(Sense::Tension, |r| r.sense).name(),
        measured: &std::format!("arrival times of strain levels at {} gauges, {file}", inverted.distances.len()),
    };
    let (title, points) = (TITLE, &inverted.points);
    let waves = Waves { title, points, given, warnings: &inverted.warnings };
    let knots = from_waves(points, options.density, options.modulus);
    outputs.write_waves(&waves, &material, &knots, inverted, lines(args, options, inverted))
}

fn lines(args: &Args, options: &Options, inverted: &Inverted) -> Lines {
    let show = |value, dimension| args.outputs.show(value, dimension);
    let mut lines = Lines::under(&std::format!("{TITLE}, {}", args.file.display()));
    let mut places: Vec<f64> = inverted.distances.clone();
    places.dedup();
    let places: Vec<String> = places.iter().map(|x| show(*x, Dimension::Length)).collect();
    lines.add("gauges", std::format!("{} from the loaded end", places.join(", ")));
    lines.add("density", show(options.density, Dimension::Density));
    if let Some(offsets) = inverted.zero_offsets.as_ref().filter(|all| all.iter().any(|&offset| offset != 0.0)) {
        let offsets: Vec<String> = offsets.iter().map(|&offset| shared::micro(offset)).collect();
        lines.add("zero offsets", std::format!("{}, removed", offsets.join(", ")));
    }
    if let (Some(curvature), Some(misfit)) = (inverted.curvature, inverted.misfit) {
        let curvature = 100.0 * curvature;
        lines
            .add("characteristics", std::format!("{curvature:.2} % of the arrival times, {misfit:.2} times the noise"));
    }
    lines
}

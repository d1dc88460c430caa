//! Options and output shared by the inversions.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::cli::lines::Lines;
use crate::cli::{options, output, quantity};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::input::Document;
use crate::inputs;
use crate::material::Curve;
use crate::material::file::of_document;
use crate::record::store::ResultFile;
use crate::report::{self, plot};
use crate::study::invert::{
    Interval, MaterialText, MeasuredKnot, REPLICATES, SEED, WavePoint, against, extended, material_text,
};
use crate::units::{Dimension, Scale, System, format as with_unit, in_units};

/// Outputs of an inversion.
#[derive(Debug, clap::Args)]
pub(super) struct Outputs {
    /// Material file with the curve, for scenes.
    #[arg(short, long, value_name = "MATERIAL.toml")]
    pub(super) output: Option<PathBuf>,
    /// Overwrite an existing material file.
    #[arg(long)]
    force: bool,
    /// Table of the curve.
    #[arg(long, value_name = "FILE.csv")]
    pub(super) csv: Option<PathBuf>,
    /// Figure (.svg, .png, .pdf or .html).
    #[arg(long, value_name = "FILE")]
    pub(super) plot: Option<PathBuf>,
    /// Print a JSON object and nothing else.
    #[arg(long)]
    pub(super) json: bool,
    /// Units of the printed table and the figure; the other files and JSON are in SI units.
    #[arg(long, value_name = "si|us", default_value = "si", hide_possible_values = true)]
    pub(super) units: System,
}

/// Curve determined by wave theory.
pub(super) struct Waves<'a> {
    pub(super) title: &'a str,
    pub(super) points: &'a [WavePoint],
    /// Curve of the material in the simulation, if the file is a result file.
    pub(super) given: Option<&'a Curve>,
    pub(super) warnings: &'a [String],
}

/// Options for bootstrap replicates and noise.
#[derive(Debug, clap::Args)]
pub(super) struct Random {
    /// Bootstrap replicates for the 95 % intervals.
    #[arg(long, value_name = "N", default_value_t = REPLICATES)]
    pub(super) replicates: usize,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = SEED)]
    pub(super) seed: u64,
    /// Add normally distributed noise to the measured strains, with a standard deviation of this fraction of the largest strain of each record, e.g. "1 %", to assess a planned test.
    #[arg(long, value_name = "PART", value_parser = quantity::not_negative(Dimension::None))]
    pub(super) noise: Option<f64>,
}

impl Outputs {
    /// Checks that the outputs can be written, before any work is done.
    pub(super) fn check(&self) -> Result<()> {
        if let Some(path) = &self.plot {
            options::picture(path, "--plot")?;
        }
        for path in [&self.output, &self.csv, &self.plot].into_iter().flatten() {
            destination::resolve(path)?;
        }
        match &self.output {
            Some(path) if path.exists() && !self.force => {
                Err(InputError::new(format!("`{}` exists already", path.display()))
                    .key("-o")
                    .help("name another file with -o, or overwrite it with --force")
                    .into())
            }
            _ => Ok(()),
        }
    }

    /// Writes the material file if requested; refuses a curve that is not valid for a material.
    pub(super) fn write_material(&self, material: &MaterialText<'_>, knots: &[MeasuredKnot]) -> Result<()> {
        let Some(path) = &self.output else { return Ok(()) };
        let text = material_text(material, knots);
        let document = Document::new(path.display().to_string(), text.as_str());
        of_document(&document, path).map_err(no_material)?;
        destination::write_whole(path, text.as_bytes())
    }

    /// Writes the figure and the table if requested.
    pub(super) fn write(
        &self,
        title: &str,
        figure: impl FnOnce() -> report::Picture,
        csv: impl FnOnce() -> String,
    ) -> Result<()> {
        if let Some(path) = &self.plot {
            plot::save(path, title, &figure())?;
        }
        if let Some(path) = &self.csv {
            destination::write_whole(path, csv().as_bytes())?;
        }
        Ok(())
    }

    /// Writes the requested files of an inversion by wave theory, and prints the results as text or JSON.
    pub(super) fn write_waves(
        &self,
        waves: &Waves<'_>,
        material: &MaterialText<'_>,
        knots: &[MeasuredKnot],
        object: &impl Serialize,
        mut lines: Lines,
    ) -> Result<()> {
        self.write_material(material, knots)?;
        let figure = || report::invert::waves(waves.title, waves.points, waves.given, self.units);
        self.write(waves.title, figure, || curve_csv(waves.points))?;
        if self.json {
            return output::json(object);
        }
        if let Some((deviation, strain)) = waves.given.and_then(|curve| against(curve, waves.points)) {
            let percent = 100.0 * deviation;
            lines.add("deviation", format!("at most {percent:+.1} % from the simulated curve, at strain {strain:.4}"));
        }
        lines.extend(self.written(knots));
        output::note(&warnings(waves.warnings, self.units));
        output::text(&(lines.text() + &curve_table(waves.points, self.units)))
    }

    /// Returns a value with its unit, as it is printed.
    pub(super) fn show(&self, value: f64, dimension: Dimension) -> String {
        with_unit(value, dimension, self.units)
    }

    /// Returns lines that name the written files and state whether the curve of the material is extrapolated.
    pub(super) fn written(&self, knots: &[MeasuredKnot]) -> Vec<String> {
        let line = |path: &PathBuf| output::wrote(path);
        let end = extended(knots).map_or_else(String::new, |sentence| format!(" ({sentence})"));
        let material = self.output.as_ref().and_then(line).map(|line| line + &end);
        material.into_iter().chain([&self.csv, &self.plot].into_iter().flatten().filter_map(line)).collect()
    }

    /// Returns the name of the material: the name of its file without the ending.
    pub(super) fn name(&self) -> String {
        let stem = self.output.as_deref().and_then(Path::file_stem).unwrap_or_default();
        stem.to_string_lossy().into_owned()
    }
}

/// Explains the error of a curve that is not valid for a material.
fn no_material(error: Error) -> Error {
    let Error::Input(error) = error else { return error };
    let message = format!("the curve cannot be that of a material, and nothing is written: {}", error.message);
    let help = "check the record, its units and what is known beside it; --csv and --plot show the curve";
    Error::Input(InputError::new(message).key("-o").allowed(error.allowed).help(help))
}

/// Adds the name of the file to an error that has no place in a file.
pub(super) fn in_file(error: Error, path: &Path) -> Error {
    match error {
        Error::Input(error) if error.place.is_none() => {
            let message = format!("{}: {}", path.display(), error.message);
            Error::Input(InputError { message, ..error })
        }
        other => other,
    }
}

/// Opens a result file of a bar, and keeps it from being overwritten by an output.
pub(super) fn result_of_bar(path: &Path) -> Result<ResultFile> {
    let file = ResultFile::open(path)?;
    inputs::protect(path);
    file.needs_bar()?;
    Ok(file)
}

/// Returns a value that an option or the file must provide.
pub(super) fn needed(value: Option<f64>, option: &str, example: &str) -> Result<f64> {
    value.ok_or_else(|| {
        let error = InputError::new(format!("{option} is missing")).key(option);
        Error::Input(error.help(format!("give it, such as {option} \"{example}\"; a result file has it")))
    })
}

/// Returns a strain in microstrain.
pub(super) fn micro(strain: f64) -> String {
    // Adding zero turns -0 into 0.
    format!("{:.1} ue", (1e7 * strain).round() / 10.0 + 0.0)
}

/// Returns the warnings, one line each.
pub(super) fn warnings(all: &[String], units: System) -> String {
    all.iter().flat_map(|warning| ["warning: ".to_owned(), in_units(warning, units), "\n".to_owned()]).collect()
}

/// Largest number of rows in the printed table of a curve; JSON and CSV have all points.
const ROWS: usize = 10;

/// Returns a table of points of the curve with their 95 % intervals.
fn curve_table(points: &[WavePoint], units: System) -> String {
    let [stress, velocity] = [Dimension::Stress, Dimension::Velocity].map(|dimension| units.of_columns(dimension));
    let every = points.len().div_ceil(ROWS).max(1);
    let shown = points.iter().rev().step_by(every).collect::<Vec<_>>().into_iter().rev();
    let of = |Interval { value, low, high }: Interval, unit: Scale, digits: usize| {
        [value, low, high].map(|v| format!("{:.digits$}", unit.of(v)))
    };
    let row = |p: &WavePoint| {
        let [c, s, v] =
            [of(p.wave_speed_m_s, velocity, 1), of(p.stress_pa, stress, 2), of(p.velocity_m_s, velocity, 2)];
        [vec![format!("{:.6}", p.strain)], c.to_vec(), s.to_vec(), v.to_vec()].concat()
    };
    let rows: Vec<Vec<String>> = shown.map(row).collect();
    let [c, v] = ["c", "v"].map(|name| format!("{name} {}", velocity.symbol));
    let s = format!("stress {}", stress.symbol);
    let headings = ["strain", &c, "low", "high", &s, "low", "high", &v, "low", "high"];
    output::table(&headings, &rows, 0, false)
}

/// Returns the points of the curve as CSV.
fn curve_csv(points: &[WavePoint]) -> String {
    let mut text = String::from(
        "strain,wave_speed_m_s,wave_speed_low,wave_speed_high,stress_Pa,stress_low,stress_high,velocity_m_s,velocity_low,velocity_high\n",
    );
    for p in points {
        let all = [p.wave_speed_m_s, p.stress_pa, p.velocity_m_s];
        let cells = all.iter().flat_map(|v| [v.value, v.low, v.high]).map(|v| v.to_string());
        text += &std::iter::once(p.strain.to_string()).chain(cells).collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    text
}

/// Returns a knot of a material file.
pub(super) fn knot(strain: f64, stress: Interval) -> MeasuredKnot {
    MeasuredKnot { strain, stress: stress.value, interval: [stress.low, stress.high] }
}

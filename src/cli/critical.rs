//! `barwave critical`.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use serde::Serialize;

use super::{interrupt, options, output};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::material::{self, Curve, Loading, Material, Scatter, Sense, TestCurve, library, mean_curve, mean_modulus};
use crate::study::bracket::{Apparent, Confirmation, RateAndHeat, apparent, check_length, confirm};
use crate::study::critical::{CriticalRow, critical};
use crate::study::sensitivity::{Interval, sensitivity};
use crate::study::uncertainty::{Bootstrap, Uncertainty, uncertainty};
use crate::units::{Dimension, Quantity, System};

mod tables;

/// Options of `barwave critical`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave critical --all\n  barwave critical copper-annealed --sensitivity --simulate\n  \
                  barwave critical --repeats a.toml b.toml c.toml\n  barwave critical steel-4340-jc --rate --length \"200 mm\""
)]
#[expect(clippy::struct_excessive_bools, reason = "one field per command-line flag")]
pub(crate) struct Args {
    /// Library names, patterns such as 'steel*', or paths of material files; `-` reads one from standard input.
    #[arg(required_unless_present = "all", value_name = "MATERIAL")]
    materials: Vec<String>,
    /// All materials of the library and of the user's folders, sorted by critical velocity.
    #[arg(long, conflicts_with_all = ["materials", "repeats"])]
    all: bool,
    /// The materials are repeats of one test: report their mean and scatter.
    #[arg(long)]
    repeats: bool,
    /// Sense of the loading.
    #[arg(long, value_enum, default_value = "tension")]
    sense: SenseArg,
    /// Bracket the value by simulation: bars below and above, by front tracking and on a grid.
    #[arg(long)]
    simulate: bool,
    /// Contribution of each strain interval, and derivative of the critical velocity with respect to the stress in it, per 1 %: for small
    /// changes.
    #[arg(long)]
    sensitivity: bool,
    /// Apparent critical velocity with the material's own rate law, by simulation.
    #[arg(long)]
    rate: bool,
    /// Apparent critical velocity with adiabatic heating, by simulation.
    #[arg(long)]
    heat: bool,
    /// Length of the bar with --rate or --heat, e.g. "200 mm" (default: 200 mm).
    #[arg(long)]
    length: Option<Quantity>,
    /// Number of random specimens, 100 to 1000000, for materials with a band of one standard deviation.
    #[arg(long, value_name = "N", default_value_t = 2000)]
    bootstrap: usize,
    /// Seed of these specimens.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write the table to a .csv file, with the velocities of --repeats, --simulate, --rate and --heat; `-` is standard output.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print a JSON list and nothing else.
    #[arg(long)]
    json: bool,
    /// Units of the printed table; CSV and JSON are in SI units.
    #[arg(long, value_name = "si|us", default_value = "si", hide_possible_values = true)]
    units: System,
}

/// Sense of loading as given on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum SenseArg {
    /// The bar is pulled.
    Tension,
    /// The bar is compressed.
    Compression,
}

impl From<SenseArg> for Sense {
    fn from(sense: SenseArg) -> Self {
        match sense {
            SenseArg::Tension => Self::Tension,
            SenseArg::Compression => Self::Compression,
        }
    }
}

/// Row of the table with the other results requested for its material.
#[derive(Debug, Serialize)]
struct Studied {
    #[serde(flatten)]
    row: CriticalRow,
    #[serde(skip_serializing_if = "Option::is_none")]
    scatter: Option<Uncertainty>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sensitivity: Option<Vec<Interval>>,
    /// Null if it is requested and there is nothing to simulate.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[expect(clippy::option_option, reason = "absent, without a value, or with a value")]
    simulated: Option<Option<Confirmation>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[expect(clippy::option_option, reason = "absent, without a value, or with a value")]
    apparent: Option<Option<Apparent>>,
}

/// Library arguments that are set by command-line options.
const OPTIONS: &[options::OptionOf<'static>] =
    &[("rate", "--rate", ""), ("heat", "--heat", ""), ("length", "--length", "e.g. --length \"200 mm\"")];

pub(crate) fn run(args: &Args) -> Result<()> {
    let of_options = |error| options::name(error, OPTIONS);
    let how = checked(args).map_err(of_options)?;
    let mut materials = if args.all { all() } else { load(&args.materials)? };
    if args.repeats {
        materials = vec![mean_of(&materials)?];
    }
    if args.simulate || args.rate || args.heat {
        interrupt::nothing_kept();
    }
    let bar = progress_bar(args, materials.len());
    let studied = materials.par_iter().map(|material| {
        let studied = study(args, &how, material);
        bar.inc(1);
        studied
    });
    let mut studied = studied.collect::<Result<Vec<_>>>().map_err(of_options)?;
    bar.finish_and_clear();
    if args.all {
        let velocity = |s: &Studied| s.row.critical_velocity_m_s.unwrap_or(f64::NEG_INFINITY);
        studied.sort_by(|a, b| velocity(b).total_cmp(&velocity(a)));
    }
    if let Some(path) = &args.output {
        destination::write_whole(path, tables::csv(&studied).as_bytes())?;
    }
    if args.json {
        return output::json_list(&studied);
    }
    output::text_beside([args.output.as_deref()], &tables::text(&studied, args.units, args.output.as_deref()))
}

/// Numeric options after their checks.
struct Checked {
    bootstrap: Bootstrap,
    length: f64,
}

/// Default length of the bar, m: the gauge length of 8 in. of the classical tension-impact tests, rounded.
const LENGTH: f64 = 0.2;

fn checked(args: &Args) -> Result<Checked> {
    if !(100..=1_000_000).contains(&args.bootstrap) {
        let error = InputError::new(format!("{} specimens are out of range", args.bootstrap)).key("--bootstrap");
        return Err(error.allowed("100 <= N <= 1000000").help("e.g. --bootstrap 2000").into());
    }
    let wrong = |message: String| Error::from(InputError::new(message).key("length").allowed("a length"));
    let length = args.length.as_ref().map_or(Ok(LENGTH), |length| length.si(Dimension::Length)).map_err(wrong)?;
    check_length(length)?;
    if args.length.is_some() && !args.rate && !args.heat {
        let error = InputError::new("the static critical velocity does not depend on the length").key("--length");
        return Err(error.allowed("with --rate or --heat").help("remove --length, or add --rate or --heat").into());
    }
    if let Some(path) = args.output.as_deref().filter(|path| !output::is_csv(path)) {
        let error = InputError::new(format!("unknown table format `{}`", path.display())).key("-o");
        return Err(error.allowed("a file name ending in .csv").help("`barwave compare` draws figures").into());
    }
    output::check(args.json, [args.output.as_deref()])?;
    Ok(Checked { bootstrap: Bootstrap { resamples: args.bootstrap, seed: args.seed }, length })
}

fn study(args: &Args, how: &Checked, material: &Material) -> Result<Studied> {
    let sense = args.sense.into();
    let with = RateAndHeat { rate: args.rate, heat: args.heat };
    let beyond = args.rate || args.heat;
    Ok(Studied {
        // Computed first, since it may be refused.
        apparent: beyond.then(|| apparent(material, sense, with, how.length)).transpose()?,
        row: critical(material, sense),
        scatter: uncertainty(material, sense, how.bootstrap),
        sensitivity: args.sensitivity.then(|| sensitivity(material, sense)),
        simulated: args.simulate.then(|| confirm(material, sense)).transpose()?,
    })
}

/// Returns a material with the mean curve of several, and their scatter.
fn mean_of(materials: &[Material]) -> Result<Material> {
    if materials.len() < 2 {
        let error =
            InputError::new("repeats need at least two materials").key("--repeats").allowed("two materials or more");
        return Err(error.help("name the files of all tests").into());
    }
    one_density(materials)?;
    one_loading(materials)?;
    let test = |m: &Material| TestCurve {
        record: m.name.clone(),
        modulus: m.modulus,
        density: Some(m.density),
        curve: m.tension.clone(),
    };
    let tests: Vec<TestCurve> = materials.iter().map(test).collect();
    let modulus = mean_modulus(&tests)?;
    let rows = mean_curve(&tests, modulus)?;
    let reach_largest = tests.iter().any(|test| !test.stopped_while_rising());
    let beyond = if reach_largest { material::Beyond::Rupture } else { materials[0].tension.beyond() };
    let curve = Curve::new(&rows, beyond).map_err(|e| InputError::new(format!("the mean curve: {e}")))?;
    let density = materials.iter().map(|m| m.density).sum::<f64>() / materials.len() as f64;
    let mut mean = Material::from_curve(format!("mean of {}", materials.len()), density, curve)?;
    mean.modulus = modulus.max(mean.modulus);
    mean.scatter = Some(Box::new(Scatter { deviation: Vec::new(), tests }));
    Ok(mean)
}

/// Largest relative difference between two densities of the same material.
const ONE_DENSITY: f64 = 0.01;

/// Checks that repeats have the same density, since they are tests of one material.
fn one_density(materials: &[Material]) -> Result<()> {
    let first = &materials[0];
    let differs = |m: &&Material| (m.density - first.density).abs() > ONE_DENSITY * first.density;
    let Some(other) = materials.iter().find(differs) else { return Ok(()) };
    let message = format!(
        "`{}` has a density of {} kg/m^3 and `{}` one of {} kg/m^3: they are not repeats of one test",
        first.name, first.density, other.name, other.density
    );
    let help = "leave out --repeats to see each material with its own density, or give the files the same density";
    Err(InputError::new(message).key("--repeats").allowed("materials of one density, within 1 %").help(help).into())
}

/// Returns the loading of the test of a material, as stated in its file.
fn loading(material: &Material) -> &'static str {
    match (material.loading, material.sense) {
        (Loading::Shear, _) => "shear",
        (Loading::Axial, Sense::Tension) => "tension",
        (Loading::Axial, Sense::Compression) => "compression",
    }
}

/// Checks that repeats have the same loading: the engineering curves of tension, compression and shear differ for the same metal.
fn one_loading(materials: &[Material]) -> Result<()> {
    let first = &materials[0];
    let Some(other) = materials.iter().find(|m| loading(m) != loading(first)) else { return Ok(()) };
    let of = |m: &Material| format!("`{}` ({}) is of a test in {}", m.name, m.provenance.origin, loading(m));
    let message = format!("{} and {}: they are not repeats of one test", of(first), of(other));
    let help = "leave out --repeats to see each material; `sense` and `loading` in the files state what was tested";
    Err(InputError::new(message).key("--repeats").allowed("tests of one loading").help(help).into())
}

fn progress_bar(args: &Args, materials: usize) -> ProgressBar {
    let long = args.simulate || args.rate || args.heat;
    if !long || args.json || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(materials as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos} of {len} materials  {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// Returns the materials with these names, patterns or paths, relative to the working folder; each name once.
pub(super) fn load(names: &[String]) -> Result<Vec<Material>> {
    let mut all: Vec<String> = Vec::new();
    for name in names {
        let found =
            if name.contains(['*', '?']) { library::matching(name, Path::new(""))? } else { vec![name.clone()] };
        all.extend(found.into_iter().filter(|name| !all.contains(name)).collect::<Vec<_>>());
    }
    all.iter().map(|name| find(name)).collect()
}

/// Returns a material of the library or of a file, or for `-` the one on standard input.
pub(super) fn find(name: &str) -> Result<Material> {
    if name == "-" { material::file::read_stdin() } else { library::find(name, Path::new("")) }
}

/// Returns all materials: those of the user first, then the built-in ones of other names. An invalid user file is reported on stderr and
/// skipped, so that it does not hide the others.
pub(super) fn all() -> Vec<Material> {
    let mut names = library::user_names(Path::new(""));
    let built_in: Vec<_> = library::names().filter(|n| !names.iter().any(|user| user == n)).map(String::from).collect();
    names.extend(built_in);
    let mut materials = Vec::new();
    for name in &names {
        match library::find(name, Path::new("")) {
            // A file can state another name, by which it is not found.
            Ok(material) => materials.push(Material { name: name.clone(), ..material }),
            Err(error) => output::note(&format!("skipped `{name}`: {error}\n")),
        }
    }
    materials
}

//! `barwave study tension-impact`.

use std::path::{Path, PathBuf};

use toml::Value;

use crate::cli::{interrupt, options, output, sweep};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::input::Document;
use crate::report::{plot, tension as picture};
use crate::scene::KINDS;
use crate::study::sweep::{Shard, run as run_cases};
use crate::study::tension::{FarEnd, Point, Results, SPECIMEN, Specimen, Test, results, write_csv, write_hdf5};
use crate::units::{Dimension, System, format as with_unit};

/// Options of `barwave study tension-impact`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  barwave study tension-impact copper-annealed\n  \
                  barwave study tension-impact copper-annealed --velocities \"5 m/s\" --to \"120 m/s\" --count 24 -o copper\n  \
                  barwave study tension-impact test.toml --velocities \"50 ft/s, 100 ft/s, 200 ft/s\"")]
pub(crate) struct Args {
    /// Library name or file of a material; or a scene whose left end is pulled until the bar breaks.
    #[arg(value_name = "MATERIAL|SCENE.toml")]
    subject: String,
    /// Impact velocities, separated by commas; with --to and --count the first one of a range [default: 27 from 7.5 % to 137.5 % of the
    /// critical velocity].
    #[arg(long, value_name = "V,...", allow_hyphen_values = true, value_delimiter = ',')]
    velocities: Vec<String>,
    /// Last velocity of a range.
    #[arg(long, value_name = "V", allow_hyphen_values = true, requires = "count", requires = "velocities")]
    to: Option<String>,
    /// Number of velocities of a range.
    #[arg(long, value_name = "N", requires = "to")]
    count: Option<u32>,
    /// Gauge length; for a material [default: 200 mm].
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    length: Option<String>,
    /// Diameter; for a material [default: 8 mm].
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    diameter: Option<String>,
    /// The end that is not struck; for a material [default: fixed].
    #[arg(long, value_enum)]
    far_end: Option<FarEnd>,
    /// Cells of the grid; for a material [default: 200].
    #[arg(long, value_name = "N")]
    cells: Option<usize>,
    /// Folder of the results [default: `tension-impact-<material>`, in `runs/out` if there is a folder `runs`]; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Figure (.svg, .png, .pdf, .html) [default: `tension-impact.svg` in the folder].
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
    /// Continue a study that was stopped or killed: run only the velocities that have no row yet.
    #[arg(long)]
    resume: bool,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    json: bool,
    /// No progress bar and no table.
    #[arg(long)]
    quiet: bool,
    /// Units of the printed table and the figure; the other files and JSON are in SI units.
    #[arg(long, value_name = "si|us", default_value = "si", hide_possible_values = true)]
    units: System,
}

/// Library argument that these options set.
const VELOCITIES: options::OptionOf<'static> = (
    "velocities",
    "--velocities",
    "e.g. --velocities \"10 m/s, 50 m/s\", or --velocities \"5 m/s\" --to \"120 m/s\" --count 24",
);

pub(crate) fn run(args: &Args) -> Result<()> {
    if let Some(path) = &args.figure {
        options::picture(path, "--figure")?;
        destination::resolve(path)?;
    }
    let test = test(args).map_err(|error| options::name(error, &[VELOCITIES]))?;
    let folder = args.output.clone().unwrap_or_else(|| output::default_folder(Path::new("")).join(&test.sweep.name));
    let silent = args.quiet || args.json;
    let bar = sweep::progress_bar(test.velocities.len() as u64, silent);
    let finished = run_cases(&test.sweep, &folder, Shard::WHOLE, args.resume, &|_| bar.inc(1), &interrupt::flag());
    bar.finish_and_clear();
    let finished = finished.map_err(|error| options::name(error, sweep::OPTIONS));
    finished.inspect_err(|error| sweep::explain_interruption(error, &folder))?;
    let results = results(&test, &folder)?;
    let figure = args.figure.clone().unwrap_or_else(|| folder.join("tension-impact.svg"));
    write_csv(&folder.join("tension-impact.csv"), &results)?;
    write_hdf5(&folder.join("tension-impact.h5"), &results)?;
    plot::save(&figure, &format!("Tension impact of {}", results.material), &picture::draw(&results, args.units))?;
    if args.json {
        output::json(&results)?;
    } else if !args.quiet {
        output::text(&text(&results, args.units, &folder, &figure))?;
    }
    results.check()
}

/// Returns the test of a scene file, or of a specimen of a material.
fn test(args: &Args) -> Result<Test> {
    let velocities = velocities(args)?;
    let path = Path::new(&args.subject);
    if path.is_file() {
        let document = Document::read(path)?;
        let scene = |table: toml::Table| {
            ["bar", "left"].into_iter().chain(KINDS.map(|kind| kind.key)).any(|key| table.contains_key(key))
        };
        if document.text.parse().is_ok_and(scene) {
            refuse_specimen(args)?;
            return Test::new(document, path, velocities.as_ref());
        }
    }
    let specimen = Specimen {
        material: &args.subject,
        length: args.length.as_deref().unwrap_or("200 mm"),
        diameter: args.diameter.as_deref().unwrap_or("8 mm"),
        far_end: args.far_end.unwrap_or(FarEnd::Fixed),
        cells: args.cells.unwrap_or(200),
    };
    Test::new(specimen.scene(), Path::new(SPECIMEN), velocities.as_ref()).map_err(of_option)
}

/// Refuses the options of a specimen beside a scene, which states them itself.
fn refuse_specimen(args: &Args) -> Result<()> {
    let options = [
        (args.length.is_some(), "--length", "bar.length"),
        (args.diameter.is_some(), "--diameter", "bar.diameter"),
        (args.far_end.is_some(), "--far-end", "right.kind"),
        (args.cells.is_some(), "--cells", "solve.cells"),
    ];
    let Some((_, option, key)) = options.into_iter().find(|(given, ..)| *given) else { return Ok(()) };
    let error = InputError::new(format!("{} is a scene: this option is for a material", args.subject)).key(option);
    Err(error.help(format!("remove {option}, and set `{key}` in the scene")).into())
}

/// Attributes an error in the scene of the specimen, which the user has not written, to an option.
fn of_option(error: Error) -> Error {
    const OPTIONS: [(&str, &str); 4] = [
        ("bar.length", "--length"),
        ("bar.diameter", "--diameter"),
        ("solve.cells", "--cells"),
        ("bar.material", "MATERIAL"),
    ];
    match error {
        // The specimen breaks by the critical strain.
        Error::Input(e) if e.key == "effects.rupture" => {
            let help = "extend the curve to its largest stress, set beyond = \"rupture\" if the data end in rupture, or give a scene \
                        with rupture = { energy = \"...\" } or { spall = \"...\" } under [effects]";
            InputError { key: "MATERIAL".into(), place: None, help: help.into(), ..e }.into()
        }
        Error::Input(e) if e.place.as_ref().is_some_and(|place| place.file == SPECIMEN) => {
            let option =
                OPTIONS.iter().find(|(key, _)| *key == e.key).map_or(e.key.clone(), |(_, option)| (*option).into());
            InputError { key: option, place: None, ..e }.into()
        }
        other => other,
    }
}

/// Returns the velocities as written on the axis of a sweep file, or `None` if none are given.
fn velocities(args: &Args) -> Result<Option<Value>> {
    let value = |text: &String| {
        let text = text.trim();
        text.parse::<f64>().map_or_else(|_| Value::from(text), Value::from)
    };
    let Some(first) = args.velocities.first() else { return Ok(None) };
    let (Some(to), Some(count)) = (&args.to, args.count) else {
        return Ok(Some(Value::Array(args.velocities.iter().map(value).collect())));
    };
    if args.velocities.len() > 1 {
        let message = "a range needs exactly one start velocity";
        let help = "e.g. --velocities \"5 m/s\" --to \"120 m/s\" --count 24";
        return Err(Error::from(InputError::new(message).key("--velocities").help(help)));
    }
    let entries = [("from", value(first)), ("to", value(to)), ("count", Value::from(i64::from(count)))];
    Ok(Some(Value::Table(entries.map(|(key, value)| (key.to_owned(), value)).into_iter().collect())))
}

/// Returns what happened to the specimen.
fn status(point: &Point) -> String {
    let place = match (point.at_struck_end, point.at_once) {
        (Some(true), Some(true)) => "rupture at struck end at once",
        (Some(true), _) => "rupture at struck end, after reflections",
        _ if point.fracture_time_s.is_some() => "rupture",
        _ => "",
    };
    match (place, point.reason.is_empty()) {
        ("", _) => format!("{} {}", point.status, point.reason).trim().to_owned(),
        (place, true) => place.to_owned(),
        (place, false) => format!("{place}; {} {}", point.status, point.reason),
    }
}

fn text(results: &Results, units: System, folder: &Path, figure: &Path) -> String {
    let [unit, energy, length, time] = [Dimension::Velocity, Dimension::Energy, Dimension::Length, Dimension::Time]
        .map(|dimension| units.of_columns(dimension));
    let v = unit.symbol;
    let energy_heading = format!("energy {}", energy.symbol);
    let headings = [
        v,
        "elongation",
        &energy_heading,
        &format!("fracture at {}", length.symbol),
        &format!("after {}", time.symbol),
        "status",
    ];
    let rows = results.points.iter().map(|point| {
        vec![
            output::fixed(Some(unit.of(point.velocity_m_s)), 2),
            output::fixed(point.elongation, 4),
            output::fixed(point.energy.map(|e| energy.of(e)), 2),
            output::fixed(point.fracture_position_m.map(|x| length.of(x)), if units == System::Si { 1 } else { 3 }),
            output::fixed(point.fracture_time_s.map(|t| time.of(t)), 1),
            status(point),
        ]
    });
    let table = output::table(&headings, &rows.collect::<Vec<_>>(), 0, true);
    let largest = results.largest_elongation.zip(results.velocity_of_largest_elongation_m_s);
    let largest = largest.map_or_else(
        || "no fracture".to_owned(),
        |(elongation, velocity)| {
            format!(
                "{elongation:.4} at {:.2} {v} ({} curve {:.4})",
                unit.of(velocity),
                results.curve,
                results.static_elongation
            )
        },
    );
    let critical = results.critical_between_m_s.map_or_else(
        || "not within these velocities".to_owned(),
        |[low, high]| format!("between {:.2} {v} and {:.2} {v}", unit.of(low), unit.of(high)),
    );
    format!(
        "Tension impact of {}, gauge length {}\n{table}\n  largest elongation    {largest}\n  at struck end at once {critical}\n  \
         critical velocity     {:.2} {v}, from the {} curve\n  results               {}\n  figure                {}\n",
        results.material,
        with_unit(results.length_m, Dimension::Length, units),
        unit.of(results.critical_velocity_m_s),
        results.curve,
        folder.display(),
        figure.display()
    )
}

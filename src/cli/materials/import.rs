//! `barwave materials import`: writes a material file from test records.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::critical_line;
use crate::cli::critical::SenseArg;
use crate::cli::{options, output};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::input::Document;
use crate::material::{self, Beyond, Material, Measure, RawMaterial, Sense, engineering_from_true};
use crate::report::plot::save;
use crate::report::test_record::{Drawn, figure};
use crate::test_record::{self, Kind, MaterialText, Reading, Record, Reduce, Reduction, Repeats};
use crate::units::{Dimension, Quantity};

/// Options of `barwave materials import`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave materials import tensile.csv --density \"7.85 g/cm^3\" --plot tensile.svg\n  \
                  barwave materials import raw.txt --density 7850 --gauge-length \"25 mm\" --diameter \"6 mm\"\n  \
                  barwave materials import a.csv b.csv c.csv --name steel --density 7850 -o steel.toml"
)]
#[expect(clippy::struct_excessive_bools, reason = "one field per command-line flag")]
pub(super) struct Args {
    /// Records of one test, or of several repeats of it: text in columns, strain or extension and stress or force.
    #[arg(required = true, value_name = "RECORD")]
    records: Vec<PathBuf>,
    /// Mass per volume, e.g. "7.85 g/cm^3".
    #[arg(long, allow_hyphen_values = true)]
    density: String,
    /// Column of strain, by heading or number from 1 (default: found by its heading).
    #[arg(long, alias = "strain-col", value_name = "COLUMN", conflicts_with = "extension_column")]
    strain_column: Option<String>,
    /// Column of extension.
    #[arg(long, alias = "extension-col", value_name = "COLUMN")]
    extension_column: Option<String>,
    /// Column of stress.
    #[arg(long, alias = "stress-col", value_name = "COLUMN", conflicts_with = "force_column")]
    stress_column: Option<String>,
    /// Column of force.
    #[arg(long, alias = "force-col", value_name = "COLUMN")]
    force_column: Option<String>,
    /// Unit of the strains or extensions where the record names none, e.g. % or mm (default: 1 or m).
    #[arg(long, value_name = "UNIT")]
    strain_unit: Option<String>,
    /// Unit of the stresses or forces where the record names none, e.g. MPa or kN (default: Pa or N).
    #[arg(long)]
    unit: Option<String>,
    /// Gauge length, which converts extensions to strains, e.g. "25 mm".
    #[arg(long, value_name = "LENGTH")]
    gauge_length: Option<Quantity>,
    /// Initial cross-section, which converts forces to stresses, e.g. "28.3 mm^2".
    #[arg(long, conflicts_with = "diameter")]
    area: Option<Quantity>,
    /// Initial diameter of a round specimen, e.g. "6 mm".
    #[arg(long)]
    diameter: Option<Quantity>,
    /// Elastic modulus, e.g. "207 GPa" (default: that of the record).
    #[arg(long)]
    modulus: Option<Quantity>,
    /// The extensions include those of machine and grips: correct strains so that the elastic line has the modulus of --modulus.
    #[arg(long, requires = "modulus")]
    compliance: bool,
    /// Stresses between which the elastic line is fitted, e.g. "20 MPa..100 MPa" (default: found automatically).
    #[arg(long, value_name = "LOW..HIGH")]
    elastic_range: Option<String>,
    /// Largest distance of the knots from the smoothed curve, over the largest stress, 1e-5 to 0.05.
    #[arg(long, default_value_t = Reduce::TOLERANCE)]
    tolerance: f64,
    /// Width in strain of the window of the smoothing, e.g. 0.005 or "0.5 %" (default: as wide as curve and noise allow).
    #[arg(long, value_name = "STRAIN")]
    smooth: Option<Quantity>,
    /// Toe correction: `on` shifts strains so that the elastic line starts at zero, `off` keeps them as recorded.
    #[arg(long, value_enum, default_value = "on")]
    toe: Switch,
    /// Keep the rows unchanged: no toe correction, no smoothing (always with fewer than 50 rows, unless --elastic-range is given).
    #[arg(long, conflicts_with_all = ["elastic_range", "compliance", "smooth"])]
    keep_rows: bool,
    /// Measure of the strains and stresses of the record (default: that of the headings, as in "true stress"; else engineering).
    #[arg(long, value_enum)]
    measure: Option<MeasureArg>,
    /// Sense of loading in the test.
    #[arg(long, value_enum, default_value = "tension")]
    sense: SenseArg,
    /// Behaviour past the last row (default: rupture if the record ends with a fracture, else error).
    #[arg(long, value_enum)]
    beyond: Option<BeyondArg>,
    /// Name of the material (default: that of the record).
    #[arg(long)]
    name: Option<String>,
    /// Who measured it, where and when: the source of the curve.
    #[arg(long, value_name = "TEXT")]
    citation: Option<String>,
    /// Figure of the records before and after: .svg, .png, .pdf or .html.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// File to write (default: name and folder of the record, with .toml).
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrite an existing file.
    #[arg(long)]
    force: bool,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum BeyondArg {
    /// The specimen fractures there.
    Rupture,
    /// The last slope is extrapolated.
    Extend,
    /// The run stops.
    Error,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Switch {
    On,
    Off,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum MeasureArg {
    /// On the initial length and cross-section.
    Engineering,
    /// On the current ones: logarithmic strain, true stress.
    True,
}

impl Args {
    /// Returns true if the rows of a record are true strains and stresses.
    fn is_true(&self, record: &Record) -> bool {
        self.measure.map(Measure::from).or(record.measure) == Some(Measure::True)
    }

    /// Returns the measure of a record and how it was determined.
    fn measure(&self, record: &Record) -> String {
        let measure = if self.is_true(record) { "true" } else { "engineering" };
        let says = match (self.measure, record.measure) {
            (Some(_), _) => "by --measure",
            (None, Some(_)) => "by the headings",
            (None, None) => "assumed: the headings name none",
        };
        format!("{measure} ({says})")
    }
}

impl From<MeasureArg> for Measure {
    fn from(measure: MeasureArg) -> Self {
        match measure {
            MeasureArg::Engineering => Self::Engineering,
            MeasureArg::True => Self::True,
        }
    }
}

impl From<BeyondArg> for Beyond {
    fn from(beyond: BeyondArg) -> Self {
        match beyond {
            BeyondArg::Rupture => Self::Rupture,
            BeyondArg::Extend => Self::Extend,
            BeyondArg::Error => Self::Error,
        }
    }
}

/// Test record with its reduction.
struct Imported {
    record: Record,
    /// Rows of the record as engineering values, for the figure; magnitudes if there is a reduction.
    shown: Vec<(f64, f64)>,
    /// `None` if the rows are kept unchanged.
    reduction: Option<Reduction>,
}

/// Curve of the material file.
struct Curve {
    modulus: Option<f64>,
    measure: Measure,
    rows: Vec<(f64, f64)>,
    beyond: Beyond,
    repeats: Option<Repeats>,
    /// Changes to the rows of a short table, or notes on the mean of several tests.
    changes: Vec<String>,
}

/// Library arguments that are set by command-line options.
const OPTIONS: &[options::OptionOf<'static>] = &[
    ("record", "", "--keep-rows keeps the rows unchanged"),
    ("modulus", "--modulus", ""),
    ("elastic_range", "--elastic-range", "e.g. --elastic-range \"20 MPa..100 MPa\""),
    ("window", "--smooth", "e.g. --smooth \"0.5 %\" or --smooth 0.005"),
    ("tolerance", "--tolerance", "e.g. --tolerance 1e-3"),
    ("measure", "--measure", "--measure true or --measure engineering states it"),
    ("abscissa_unit", "--strain-unit", "--strain-unit names it"),
    ("ordinate_unit", "--unit", "--unit names it"),
    ("gauge_length", "--gauge-length", "--gauge-length \"25 mm\" gives it"),
    ("area", "--area", "--area \"28.3 mm^2\" or --diameter \"6 mm\" gives it"),
];

pub(super) fn run(args: &Args) -> Result<()> {
    write_material(args).map_err(|error| options::name(error, OPTIONS))
}

fn write_material(args: &Args) -> Result<()> {
    let path = args.output.clone().unwrap_or_else(|| match &args.records[0] {
        stdin if destination::is_stdout(stdin) => stdin.clone(),
        file => file.with_extension("toml"),
    });
    output::check(args.json, [Some(path.as_path()), args.plot.as_deref()])?;
    is_material_file(&path)?;
    refuse_existing(&path, args.force)?;
    if let Some(plot) = &args.plot {
        options::picture(plot, "--plot")?;
        destination::resolve(plot)?;
    }
    si(&args.density.parse().unwrap_or(Quantity::Text(args.density.clone())), Dimension::Density, "--density")?;
    let (reading, how) = (reading(args)?, how(args)?);
    let imported = args.records.iter().map(|file| import(file, args, &reading, &how)).collect::<Result<Vec<_>>>()?;
    let curve = curve(args, &imported, &how)?;
    plausible(&curve, &imported)?;
    let comments = comments(args, &imported, &curve.changes);
    let text = text(args, &curve, &comments);
    let document = Document::new(path.display().to_string(), text.as_str());
    let material = document
        .parse::<RawMaterial>()
        .and_then(|raw| material::resolve(raw, &document, "", Path::new("")))
        .map_err(|error| of_record(error, &imported))?;
    destination::write_whole(&path, text.as_bytes())?;
    if let Some(plot) = &args.plot {
        draw(plot, (&material.name, args.sense.into()), &imported, &curve)?;
    }
    if args.json {
        return output::json(&json(args, &path, &imported, &curve.changes, &material));
    }
    output::text_beside(
        [Some(path.as_path()), args.plot.as_deref()],
        &report(args, &path, &imported, &curve.changes, &material),
    )
}

/// Attributes an error in the material, which is not yet a file, to the record from which the curve was made, or to an option.
fn of_record(error: Error, imported: &[Imported]) -> Error {
    let Error::Input(e) = error else { return error };
    let test = e.key.strip_prefix("band.test.").and_then(|rest| rest.split('.').next()?.parse().ok());
    let record = imported.get(test.unwrap_or(0)).map(|one| &one.record);
    match record {
        Some(record) if ["curve", "band", "modulus"].iter().any(|part| e.key.starts_with(part)) => {
            let error = record.error(0, format!("no curve can be made of {}: {}", record.name, e.message));
            error.allowed(e.allowed).help("check the columns and their units").into()
        }
        _ => InputError { key: format!("--{}", e.key), place: None, ..e }.into(),
    }
}

/// Refuses a file name without the ending .toml, by which other commands recognize material files.
fn is_material_file(path: &Path) -> Result<()> {
    if output::has_ending(path, "toml") {
        return Ok(());
    }
    let error = InputError::new(format!("`{}` is not a name of a material file", path.display())).key("-o");
    let help = format!("e.g. -o \"{}\"", path.with_extension("toml").display());
    Err(error.allowed("a file name ending in .toml, or `-`").help(help).into())
}

fn refuse_existing(path: &Path, force: bool) -> Result<()> {
    if destination::is_stdout(path) {
        return Ok(());
    }
    destination::resolve(path)?;
    if path.exists() && !force {
        return Err(InputError::new(format!("`{}` exists already", path.display()))
            .key("-o")
            .help("name another file with -o, or overwrite it with --force")
            .into());
    }
    Ok(())
}

/// Returns a positive quantity of the command line, in SI units.
fn si(value: &Quantity, dimension: Dimension, key: &str) -> Result<f64> {
    let example = format!("e.g. {key} \"{}\"", dimension.example());
    let wrong = |message: String| InputError::new(message).key(key).allowed("a value above 0").help(example);
    match value.si(dimension) {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        Ok(_) => Err(wrong(format!("{value} is out of range")).into()),
        Err(message) => Err(wrong(message).into()),
    }
}

fn reading(args: &Args) -> Result<Reading> {
    let column = |kind, column: &Option<String>| column.clone().map(|name| (kind, name));
    let of = |value: &Option<Quantity>, dimension, key| value.as_ref().map(|v| si(v, dimension, key)).transpose();
    let sizes = [(&args.gauge_length, "--gauge-length"), (&args.diameter, "--diameter")];
    for (size, key) in sizes {
        meant_in_metres(size.as_ref(), 1.0, Dimension::Length, key)?;
    }
    meant_in_metres(args.area.as_ref(), 0.1, Dimension::Area, "--area")?;
    let diameter = of(&args.diameter, Dimension::Length, "--diameter")?;
    let area = of(&args.area, Dimension::Area, "--area")?;
    Ok(Reading {
        abscissa: column(Kind::Strain, &args.strain_column).or(column(Kind::Extension, &args.extension_column)),
        ordinate: column(Kind::Stress, &args.stress_column).or(column(Kind::Force, &args.force_column)),
        abscissa_unit: args.strain_unit.clone(),
        ordinate_unit: args.unit.clone(),
        gauge_length: of(&args.gauge_length, Dimension::Length, "--gauge-length")?,
        area: area.or(diameter.map(|d| std::f64::consts::FRAC_PI_4 * d * d)),
        measure: args.measure.map(Measure::from),
    })
}

fn how(args: &Args) -> Result<Reduce> {
    let modulus = args.modulus.as_ref().map(modulus_of_option).transpose()?;
    let elastic_range = args.elastic_range.as_deref().map(elastic_range).transpose()?;
    let window = args.smooth.as_ref().map(|width| si(width, Dimension::None, "--smooth")).transpose()?;
    let toe = args.toe == Switch::On;
    let how = Reduce {
        modulus,
        compliance: args.compliance,
        elastic_range,
        toe,
        window,
        tolerance: args.tolerance,
        ..Reduce::default()
    };
    how.check()?;
    Ok(how)
}

/// Refuses a plain number that is too large for a specimen in m (or m^2): it is probably in mm or inches.
fn meant_in_metres(size: Option<&Quantity>, most: f64, dimension: Dimension, key: &str) -> Result<()> {
    let Some(Quantity::Number(value)) = size.filter(|size| size.si(dimension).is_ok_and(|value| value >= most)) else {
        return Ok(());
    };
    let (unit, example) = if dimension == Dimension::Area { ("m^2", "mm^2") } else { ("m", "mm") };
    let error = InputError::new(format!("`{value}` has no unit and would be {value} {unit}")).key(key);
    Err(error
        .allowed(format!("a size with its unit, or below {most} {unit}"))
        .help(format!("e.g. {key} \"{value} {example}\""))
        .into())
}

/// Magnitude below which a stress without a unit is probably in MPa, Pa.
const LEAST_PLAIN_STRESS: f64 = 1e6;

/// Refuses a stress without a unit that is probably not in Pa.
fn meant_in_pascal(quantity: &Quantity, value: f64) -> std::result::Result<(), InputError> {
    if matches!(quantity, Quantity::Number(_)) && value != 0.0 && value.abs() < LEAST_PLAIN_STRESS {
        return Err(InputError::new(format!("`{value}` has no unit and would be {value} Pa")));
    }
    Ok(())
}

/// Returns the modulus of `--modulus`, Pa.
fn modulus_of_option(quantity: &Quantity) -> Result<f64> {
    let value = si(quantity, Dimension::Stress, "--modulus")?;
    let example = |error: InputError| {
        error.key("--modulus").allowed("a stress with its unit").help("e.g. --modulus \"207 GPa\" or \"30 Msi\"")
    };
    meant_in_pascal(quantity, value).map_err(example)?;
    Ok(value)
}

/// Returns the two stresses of a range such as `20 MPa..100 MPa`, Pa.
fn elastic_range(text: &str) -> Result<[f64; 2]> {
    let key = "--elastic-range";
    let help = "e.g. --elastic-range \"20 MPa..100 MPa\"";
    let wrong =
        |message: String| Error::from(InputError::new(message).key(key).allowed("LOW..HIGH, two stresses").help(help));
    let (low, high) = text.split_once("..").ok_or_else(|| wrong(format!("`{text}` is not an interval")))?;
    let stress = |part: &str| {
        let quantity: Quantity = part.trim().parse().unwrap_or(Quantity::Text(part.into()));
        let value = quantity.si(Dimension::Stress).map_err(wrong)?;
        meant_in_pascal(&quantity, value)
            .map_err(|error| error.key(key).allowed("two stresses with units").help(help))?;
        Ok::<f64, Error>(value)
    };
    Ok([stress(low)?, stress(high)?])
}

fn import(file: &Path, args: &Args, reading: &Reading, how: &Reduce) -> Result<Imported> {
    let record = test_record::read(file, reading)?;
    let is_true = args.is_true(&record);
    let rows = if is_true { engineering(&record.rows, args.sense.into()) } else { record.rows.clone() };
    let keep = args.keep_rows || rows.len() < Reduce::FEWEST_ROWS;
    if keep {
        return Ok(Imported { shown: rows, record, reduction: None });
    }
    // Determined before the conversion to engineering values, after which the steps of rounded values differ from row to row.
    let stress_step = test_record::stress_step(record.rows.iter().map(|row| row.1));
    let strain_step = test_record::strain_step(record.rows.iter().map(|row| row.0));
    let mut reduction = test_record::reduce(&rows, &Reduce { stress_step, strain_step, ..*how }).map_err(|mut e| {
        e.message = format!("{}: {}", file.display(), e.message);
        e
    })?;
    if is_true {
        reduction.changes.insert(0, "true strain and true stress converted to engineering values".into());
    }
    let shown = magnitudes(&rows);
    Ok(Imported { record, shown, reduction: Some(reduction) })
}

fn engineering(rows: &[(f64, f64)], sense: Sense) -> Vec<(f64, f64)> {
    let convert = |&(e, s): &(f64, f64)| {
        let (strain, stress) = engineering_from_true(sense, e.abs(), s.abs());
        (strain * e.signum(), stress * s.signum())
    };
    rows.iter().map(convert).collect()
}

fn magnitudes(rows: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let sign = |pick: fn(&(f64, f64)) -> f64| {
        if rows.iter().map(pick).fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a }) < 0.0 {
            -1.0
        } else {
            1.0
        }
    };
    let (strain, stress) = (sign(|row| row.0), sign(|row| row.1));
    rows.iter().map(|row| (strain * row.0, stress * row.1)).collect()
}

/// Returns the curve of the file: the rows of a short table, the reduced record, or the mean of several records.
fn curve(args: &Args, imported: &[Imported], how: &Reduce) -> Result<Curve> {
    let asked: Option<Beyond> = args.beyond.map(Into::into);
    if let [Imported { reduction: Some(reduction), .. }] = imported {
        let fractured = if reduction.fracture.is_some() { Beyond::Rupture } else { Beyond::Error };
        return Ok(Curve {
            modulus: Some(reduction.modulus),
            measure: Measure::Engineering,
            rows: reduction.knots.clone(),
            beyond: asked.unwrap_or(fractured),
            repeats: None,
            changes: Vec::new(),
        });
    }
    if let [Imported { record, reduction: None, .. }] = imported {
        return short_table(args, record, how);
    }
    let reduced = |one: &Imported| {
        one.reduction.clone().map(|reduction| (one.record.name.clone(), reduction)).ok_or_else(|| {
            let message =
                format!("{} has {} rows: repeats are averaged after smoothing", one.record.name, one.record.rows.len());
            InputError::new(message)
                .allowed(format!("at least {} rows each", Reduce::FEWEST_ROWS))
                .help("import the files one by one")
        })
    };
    let tests = imported.iter().map(reduced).collect::<std::result::Result<Vec<_>, _>>()?;
    let repeats = test_record::combine(&tests, how.tolerance)?;
    let (modulus, rows) = (Some(repeats.modulus), repeats.knots.clone());
    let (beyond, changes) = (asked.unwrap_or(repeats.beyond), repeats.notes.clone());
    Ok(Curve { modulus, measure: Measure::Engineering, rows, beyond, repeats: Some(repeats), changes })
}

/// Returns the curve of a short table, with the elastic line if it is requested.
fn short_table(args: &Args, record: &Record, how: &Reduce) -> Result<Curve> {
    let unused = [("--compliance", how.compliance), ("--smooth", how.window.is_some())];
    if let Some((key, _)) = unused.into_iter().find(|(_, set)| *set) {
        let message = format!("{} has {} rows, which are kept as they are", record.name, record.rows.len());
        let allowed = format!("records of at least {} rows", Reduce::FEWEST_ROWS);
        let help = "--elastic-range and --modulus set the elastic line of a short table";
        return Err(InputError::new(message).key(key).allowed(allowed).help(help).into());
    }
    let measure = if args.is_true(record) { Measure::True } else { Measure::Engineering };
    let beyond = args.beyond.map_or(Beyond::Error, Into::into);
    let rows = kept_rows(record)?;
    let Some(range) = how.elastic_range else {
        return Ok(Curve { modulus: how.modulus, measure, rows, beyond, repeats: None, changes: Vec::new() });
    };
    let straight = test_record::straighten(&rows, range, how.modulus, how.toe)?;
    let (modulus, changes) = (Some(straight.modulus), vec![straight.change]);
    Ok(Curve { modulus, measure, rows: straight.rows, beyond, repeats: None, changes })
}

/// Returns the rows of a short table as magnitudes. Rows that form no valid curve are refused, with the line in the record.
fn kept_rows(record: &Record) -> Result<Vec<(f64, f64)>> {
    let rows = magnitudes(&record.rows);
    material::Curve::new(&rows, Beyond::Error).map_err(|e| {
        let help = "rows are strain, stress; the first row is (0, 0) or omitted; longer records may contain unloading";
        record.error(e.row, e.to_string()).allowed(material::CurveError::ALLOWED).help(help)
    })?;
    Ok(rows)
}

/// Returns the comment at the top of the file: records and changes.
fn comments(args: &Args, imported: &[Imported], changes: &[String]) -> Vec<String> {
    let mut lines = vec![format!("Imported by barwave {}.", env!("CARGO_PKG_VERSION"))];
    for one in imported {
        lines.push(format!("{}: {}.", one.record.name, one.record.columns));
        lines.push(format!("- measure of strain and stress: {}", args.measure(&one.record)));
        lines.extend(one.reduction.iter().flat_map(|reduction| &reduction.changes).map(|change| format!("- {change}")));
    }
    lines.extend(changes.iter().map(|change| format!("- {change}")));
    lines
}

fn text(args: &Args, curve: &Curve, comments: &[String]) -> String {
    let stem = match &args.records[0] {
        stdin if destination::is_stdout(stdin) => "material".into(),
        file => file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    let sense: Sense = args.sense.into();
    let names: Vec<_> = args.records.iter().map(|record| test_record::name(record)).collect();
    let measured = format!("slow {} test, {}", sense.name(), names.join(", "));
    MaterialText {
        name: args.name.as_deref().unwrap_or(&stem),
        description: "",
        density: &args.density,
        modulus: curve.modulus,
        measure: curve.measure,
        sense,
        beyond: curve.beyond,
        rows: &curve.rows,
        scatter: curve.repeats.as_ref().map(|repeats| &repeats.scatter),
        comments,
        citation: args.citation.as_deref(),
        measured: &measured,
    }
    .toml()
}

/// Smallest modulus of a record whose stresses have no stated unit, Pa; a smaller one comes from MPa read as Pa, or kN as N.
const LEAST_WITHOUT_UNIT: f64 = 1e7;

/// Largest strain of a record whose strains have no stated unit; a larger one comes from percent read as a plain number.
const MOST_WITHOUT_UNIT: f64 = 2.0;

/// Returns the modulus of a curve, Pa: the stated one, otherwise the steepest slope of its rows.
fn modulus(curve: &Curve) -> f64 {
    let origin = std::iter::once((0.0, 0.0)).chain(curve.rows.iter().copied());
    let slope = |(from, to): ((f64, f64), &(f64, f64))| (to.1 - from.1) / (to.0 - from.0);
    let slopes = origin.zip(&curve.rows).map(slope).filter(|slope| slope.is_finite());
    curve.modulus.unwrap_or_else(|| slopes.fold(0.0, f64::max))
}

/// Refuses a modulus or a strain that indicates a wrong unit.
fn plausible(curve: &Curve, imported: &[Imported]) -> Result<()> {
    let largest = |one: &Imported| one.shown.iter().fold(0.0, |largest: f64, row| largest.max(row.0));
    let unnamed = imported.iter().filter(|one| !one.record.units_named.strain).map(largest).fold(0.0, f64::max);
    if unnamed > MOST_WITHOUT_UNIT {
        let message = format!("the unit of strain is not given, and the largest strain as a plain number is {unnamed}");
        let error = InputError::new(message).key("--strain-unit");
        let error = error.allowed(format!("a largest strain of at most {MOST_WITHOUT_UNIT} if no unit is given"));
        return Err(error.help("give the unit, e.g. --strain-unit %, or in the heading: strain_%").into());
    }
    let modulus = modulus(curve);
    if modulus >= LEAST_WITHOUT_UNIT || imported.iter().all(|one| one.record.units_named.stress) {
        return Ok(());
    }
    let message = format!("the unit of stress or force is not given, and the modulus in Pa is {modulus:.4e}");
    let error = InputError::new(message).key("--unit").allowed("a modulus of at least 10 MPa if no unit is given");
    Err(error.help("give the unit, e.g. --unit MPa, or in the heading: stress_MPa").into())
}

fn draw(path: &Path, (name, sense): (&str, Sense), imported: &[Imported], curve: &Curve) -> Result<()> {
    let drawn: Vec<Drawn<'_>> = imported
        .iter()
        .filter_map(|one| {
            Some(Drawn { name: &one.record.name, record: &one.shown, reduction: one.reduction.as_ref()? })
        })
        .collect();
    if drawn.is_empty() {
        let message = format!(
            "there is no reduction to plot: rows are kept as they are with --keep-rows, and where a record has fewer than {}",
            Reduce::FEWEST_ROWS
        );
        let error = InputError::new(message).key("--plot");
        return Err(error.help("plot the material with `barwave compare FILE.toml -o FILE.svg`").into());
    }
    let mean = curve.repeats.as_ref().map(|repeats| (curve.rows.as_slice(), &repeats.scatter));
    let title = format!("{name}, slow {} test{}", sense.name(), if drawn.len() == 1 { "" } else { "s" });
    save(path, &title, &figure(&title, &drawn, mean))
}

fn json(args: &Args, path: &Path, imported: &[Imported], changes: &[String], material: &Material) -> serde_json::Value {
    let records = imported.iter().map(|one| {
        let measure = if args.is_true(&one.record) { Measure::True } else { Measure::Engineering };
        serde_json::json!({
            "record": one.record.name,
            "columns": one.record.columns,
            "measure": measure,
            "reduction": one.reduction,
        })
    });
    serde_json::json!({
        "written": path.display().to_string(),
        "records": records.collect::<Vec<_>>(),
        "changes": changes,
        "modulus_Pa": material.modulus,
        "elastic_limit_Pa": material.tension.elastic_limit(material.modulus).1,
        "critical": crate::study::critical::critical(material, Sense::Tension),
        "notes": notes(args, imported, material),
    })
}

/// Returns notes on the material, on the sense of the record, and on its headings.
fn notes(args: &Args, imported: &[Imported], material: &Material) -> Vec<String> {
    let negative = imported.iter().any(|one| one.reduction.as_ref().is_some_and(Reduction::had_negative_signs));
    let of_sense = match Sense::from(args.sense) {
        Sense::Compression => Some(
            "the curve is that of a compression test, and holds in tension, too: there the engineering stress of the same metal is lower at \
             the same strain and has a maximum; import a tension test for critical velocities in tension",
        ),
        Sense::Tension if negative => {
            Some("the record has negative signs; if the specimen was compressed, add `--sense compression`")
        }
        Sense::Tension => None,
    };
    let headings = imported.iter().flat_map(|one| of_headings(args, &one.record));
    material.notes().into_iter().chain(of_sense.map(str::to_owned)).chain(headings).collect()
}

/// Returns notes on headings that name the deformation of the machine, or shear.
fn of_headings(args: &Args, record: &Record) -> Vec<String> {
    let machine = record.machine.as_ref().filter(|_| !args.compliance).map(|title| {
        format!(
            "`{title}` holds the deformation of machine and grips, too, and so do modulus and strains; with the modulus of the material, \
             --modulus \"207 GPa\" --compliance takes it out"
        )
    });
    let shear = record.shear.as_ref().map(|title| {
        format!(
            "`{title}` names shear, and the curve is written as that of an axial test; for shear stress and engineering shear strain \
             write loading = \"shear\" in place of `sense` in the file"
        )
    });
    machine.into_iter().chain(shear).collect()
}

/// Returns the report as text.
fn report(args: &Args, path: &Path, imported: &[Imported], changes: &[String], material: &Material) -> String {
    let mut text = output::wrote(path).map_or_else(String::new, |line| line + "\n");
    for one in imported {
        let _ = writeln!(text, "record          {}: {}", one.record.name, one.record.columns);
        let _ = writeln!(text, "  measure       {}", args.measure(&one.record));
        text += &one.reduction.as_ref().map_or_else(String::new, reduced);
    }
    if imported.len() > 1 {
        let _ = writeln!(text, "mean curve      of {} tests, with their scatter in [band]", imported.len());
    }
    let limit = material.tension.elastic_limit(material.modulus).1;
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "rows            {}\nmodulus         {:.4} GPa\nelastic limit   {:.4} MPa\ncritical        {}\n",
        material.tension.strain().len(),
        material.modulus / 1e9,
        limit / 1e6,
        critical_line(material, Sense::Tension)
    );
    for change in changes {
        let _ = writeln!(text, "  - {change}");
    }
    for note in notes(args, imported, material) {
        let _ = writeln!(text, "note: {note}");
    }
    if let Some(plot) = &args.plot {
        let _ = writeln!(text, "figure          {}", plot.display());
    }
    if args.citation.is_none() {
        text += "No source is stated: add [source] to the file, or use --citation.\n";
    }
    text
}

/// Returns the results of the reduction of a record, and the changes made to it.
fn reduced(r: &Reduction) -> String {
    const MPA: f64 = 1e6;
    let line = &r.line;
    let mut text = format!(
        "  elastic line  {:.3} GPa +- {:.3} GPa, least squares between {} and {} MPa, {} rows (ASTM E111)\n",
        line.slope / 1e9,
        line.error / 1e9,
        output::fixed(Some(line.between[0] / MPA), 1),
        output::fixed(Some(line.between[1] / MPA), 1),
        line.rows
    );
    let proof = r.proof_stress.map_or("none: the curve ends before".into(), |s| format!("{:.3} MPa", s / MPA));
    let _ = writeln!(text, "  proof stress  {proof} at 0.2 % offset (ASTM E8/E8M, ISO 6892-1)");
    let at_end = r.knots.last().is_some_and(|last| last.0 <= r.maximum.0);
    let end = if at_end { ", the end of the record" } else { "" };
    let _ = writeln!(text, "  peak stress   {:.3} MPa at strain {:.5}{end}", r.maximum.1 / MPA, r.maximum.0);
    let fracture =
        r.fracture.map_or("none in the record".into(), |(e, s)| format!("{:.3} MPa at strain {e:.5}", s / MPA));
    let _ = writeln!(text, "  fracture      {fracture}");
    for change in &r.changes {
        let _ = writeln!(text, "  - {change}");
    }
    text
}

//! `barwave compare`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::compare_results::{self, Outputs};
use super::critical::SenseArg;
use super::result_file::is_result;
use super::{critical, options, output};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::record::Field;
use crate::report::{self, plot};
use crate::study::compare::{Compared, compare};
use crate::units::{Dimension, System, scale_for};

/// Options of `barwave compare`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave compare copper-annealed mild-steel -o curves.svg\n  barwave compare 'steel*' --sense \
                  compression -o - > steels.csv\n  barwave compare coarse.h5 fine.h5 --field stress"
)]
pub(crate) struct Args {
    /// Library names, patterns such as 'steel*', or paths of material files, `-` for standard input; or result files (.h5), compared with the first of them.
    #[arg(required_unless_present = "all", value_name = "MATERIAL|RESULT.h5")]
    names: Vec<String>,
    /// All materials of the library.
    #[arg(long, conflicts_with = "names")]
    all: bool,
    /// Output file: figure (.svg, .png, .pdf, .html) or table (.csv; `-` writes it to standard output).
    #[arg(short, long, visible_alias = "plot", value_name = "FILE")]
    output: Option<PathBuf>,
    /// Field of results to plot (default: the first common field).
    #[arg(long, value_enum)]
    field: Option<Field>,
    /// Sense of the loading.
    #[arg(long, value_enum, default_value = "tension")]
    sense: SenseArg,
    /// Print a JSON list and nothing else.
    #[arg(long)]
    json: bool,
    /// Overwrite an existing output file that barwave did not write.
    #[arg(long)]
    force: bool,
    /// Units of the printed table and the figure of materials; CSV and JSON are in SI units.
    #[arg(long, value_name = "si|us", default_value = "si", hide_possible_values = true)]
    units: System,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let is_csv = args.output.as_deref().is_some_and(output::is_csv);
    if let Some(path) = args.output.as_deref().filter(|_| !is_csv) {
        options::picture(path, "-o").map_err(|e| match e {
            Error::Input(e) => Error::Input(e.allowed("a file name ending in .svg, .png, .pdf, .html or .csv")),
            other => other,
        })?;
    }
    output::check(args.json, [args.output.as_deref()])?;
    let files = results(&args.names)?;
    if let Some(path) = &args.output {
        let heading = if files.is_some() { compare_results::HEADING } else { HEADING };
        output::check_replaced(path, Some(heading), args.force)?;
    }
    if let Some(files) = files {
        if args.units == System::Us {
            let error = InputError::new("results are compared in SI units").key("--units").allowed("si");
            return Err(error.help("leave it out; `barwave report --units us` shows each result").into());
        }
        return compare_results::run(
            &files,
            &Outputs { file: args.output.as_deref(), json: args.json, field: args.field },
        );
    }
    if let Some(field) = args.field {
        return Err(InputError::new(format!("materials have no field `{}`", field.name()))
            .key("--field")
            .allowed("with result files only")
            .help("leave it out, or compare result files: barwave compare a.h5 b.h5 --field stress")
            .into());
    }
    let every = ["*".to_owned()];
    let materials = critical::load(if args.all { &every } else { &args.names })?;
    let compared = compare(&materials, args.sense.into());
    match args.output.as_deref() {
        Some(path) if is_csv => destination::write_whole(path, csv(&compared).as_bytes())?,
        Some(path) => plot::save(path, "Materials side by side", &report::compare::figure(&compared, args.units))?,
        None => {}
    }
    if args.json {
        return output::json_list(&compared);
    }
    let written = args.output.as_deref().and_then(output::wrote).map_or_else(String::new, |line| format!("\n{line}\n"));
    output::text_beside([args.output.as_deref()], &format!("{}{written}", table(&compared, args.units)))
}

/// Returns the names as paths if all are result files, or `None` if none is.
fn results(names: &[String]) -> Result<Option<Vec<PathBuf>>> {
    let count = names.iter().filter(|name| is_result(Path::new(name))).count();
    if count == 0 {
        return Ok(None);
    }
    if count < names.len() || count < 2 {
        let message = match names.len() {
            1 => "a comparison of results needs at least 2 result files".to_owned(),
            all => {
                let are = if count == 1 { "is a result file" } else { "are result files" };
                format!("only {count} of {all} names {are}")
            }
        };
        let help = "give result files only, the reference first: barwave compare a.h5 b.h5";
        return Err(InputError::new(message).allowed("materials only, or at least 2 result files").help(help).into());
    }
    Ok(Some(names.iter().map(PathBuf::from).collect()))
}

/// Returns a table with one row for each material, including the speeds of the last fronts of bars loaded to strains of 1 % and 10 %.
fn table(compared: &[Compared], units: System) -> String {
    let [density, velocity, stress] =
        [Dimension::Density, Dimension::Velocity, Dimension::Stress].map(|dimension| units.of_columns(dimension));
    let modulus = scale_for(100e9, Dimension::Stress, units);
    let rows: Vec<_> = compared
        .iter()
        .map(|m| {
            let c = &m.critical;
            vec![
                c.material.clone(),
                output::fixed(Some(density.of(c.density_kg_m3)), if units == System::Si { 0 } else { 4 }),
                output::fixed(Some(modulus.of(m.modulus_pa)), 1),
                output::fixed(Some(velocity.of(m.elastic_speed_m_s)), 0),
                output::fixed(Some(velocity.of(c.yield_velocity_m_s)), 2),
                output::fixed(m.speed_at_1_percent.map(|c| velocity.of(c)), 1),
                output::fixed(m.speed_at_10_percent.map(|c| velocity.of(c)), 1),
                output::fixed(c.critical_velocity_m_s.map(|v| velocity.of(v)), 2),
                output::fixed(c.strain_at_max, 4),
                output::fixed(c.stress_at_max_pa.map(|s| stress.of(s)), 1),
                c.reason.clone(),
            ]
        })
        .collect();
    let headings = [
        "material".to_owned(),
        format!("rho {}", density.symbol),
        format!("E {}", modulus.symbol),
        format!("c0 {}", velocity.symbol),
        format!("v_yield {}", velocity.symbol),
        format!("c(1 %) {}", velocity.symbol),
        format!("c(10 %) {}", velocity.symbol),
        format!("v_c {}", velocity.symbol),
        "strain at max".to_owned(),
        format!("max {}", stress.symbol),
        "criterion".to_owned(),
    ];
    let headings = headings.each_ref().map(String::as_str);
    output::table(&headings, &rows, 1, true)
}

/// First line of the table of materials.
const HEADING: &str = "material,strain,stress_Pa,wave_speed_m_s,impact_velocity_m_s\n";

/// Returns the curves as CSV, one row for each knot: material, strain, stress, wave speed, impact velocity; a cell without a value is empty.
fn csv(compared: &[Compared]) -> String {
    let mut text = HEADING.to_owned();
    let cell = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
    for m in compared {
        for p in &m.curve {
            let (speed, velocity) = (cell(p.wave_speed_m_s), cell(p.impact_velocity_m_s));
            let name = &m.critical.material;
            let quoted =
                if name.contains([',', '"']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.clone() };
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{quoted},{},{},{speed},{velocity}", p.strain, p.stress_pa);
        }
    }
    text
}

//! `barwave materials`: the library and the source of each curve.

use std::path::{Path, PathBuf};

use super::{output, settings};
use crate::error::Result;
use crate::material::{Beyond, Curve, Loading, Material, Sense, library};
use crate::study::critical::critical;

mod import;

/// Options of `barwave materials`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave materials\n  barwave materials show copper-annealed\n  barwave materials import record.csv --density \"7850 kg/m^3\" -o steel.toml"
)]
pub(crate) struct Args {
    #[command(subcommand)]
    action: Option<Action>,
}

#[derive(Debug, clap::Subcommand)]
enum Action {
    /// List all available materials (default).
    List(ListArgs),
    /// Show one material: constants, provenance, critical velocity and table.
    Show(ShowArgs),
    /// Write a material file for a CSV file of strain and stress, and check it.
    Import(Box<import::Args>),
    /// Print the folders searched for material files.
    Path(PathArgs),
}

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  barwave materials path\n  barwave materials path --json")]
struct PathArgs {
    /// Print one JSON object and nothing else.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  barwave materials list\n  barwave materials list --json")]
struct ListArgs {
    /// Print a JSON list and nothing else.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  barwave materials show copper-annealed\n  barwave materials show - < steel.toml")]
struct ShowArgs {
    /// Library name or path of a material file; `-` reads standard input.
    material: String,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    match &args.action {
        None => list(settings::json()),
        Some(Action::List(list_args)) => list(list_args.json),
        Some(Action::Show(show_args)) => show(show_args),
        Some(Action::Import(import_args)) => import::run(import_args),
        Some(Action::Path(path_args)) => path(path_args),
    }
}

const MPA: f64 = 1e6;
const GPA: f64 = 1e9;

fn list(json: bool) -> Result<()> {
    let materials = super::critical::all();
    if json {
        return output::json_list(&materials.iter().map(summary).collect::<Vec<_>>());
    }
    let rows: Vec<_> = materials
        .iter()
        .map(|m| {
            let v_c = critical(m, Sense::Tension).critical_velocity_m_s;
            vec![
                m.name.clone(),
                output::fixed(Some(m.density), 0),
                output::fixed(Some(m.modulus / GPA), 1),
                output::fixed(Some(elastic_limit(m) / MPA), 1),
                output::fixed(v_c, 1),
                m.provenance.confidence.clone(),
                m.description.clone(),
            ]
        })
        .collect();
    let headings = ["name", "rho kg/m^3", "E GPa", "elastic limit MPa", "v_c m/s", "confidence", "description"];
    // The last two columns are text; joined into one, they are aligned left, and the numbers right.
    let rows: Vec<_> = rows.into_iter().map(join_last_two).collect();
    let headings: Vec<_> = headings[..5].iter().copied().chain(["confidence  description"]).collect();
    output::text(&output::table(&headings, &rows, 1, true))
}

/// Joins the last two cells of a row, with the confidence padded to the width of its heading.
fn join_last_two(mut row: Vec<String>) -> Vec<String> {
    let description = row.pop().unwrap_or_default();
    let confidence = row.pop().unwrap_or_default();
    row.push(format!("{confidence:<10}  {description}"));
    row
}

fn elastic_limit(material: &Material) -> f64 {
    material.tension.elastic_limit(material.modulus).1
}

fn summary(m: &Material) -> serde_json::Value {
    let c = critical(m, Sense::Tension);
    serde_json::json!({
        "name": m.name,
        "description": m.description,
        "density_kg_m3": m.density,
        "modulus_Pa": m.modulus,
        "elastic_limit_Pa": elastic_limit(m),
        "critical_velocity_m_s": c.critical_velocity_m_s,
        "confidence": m.provenance.confidence,
        "citation": m.provenance.citation,
        "origin": m.provenance.origin,
    })
}

fn show(args: &ShowArgs) -> Result<()> {
    let material = super::critical::find(&args.material)?;
    if args.json {
        return output::json(&serde_json::json!({
            "material": with_units(serde_json::to_value(&material).unwrap_or_default()),
            "critical": critical(&material, Sense::Tension),
            "critical_in_compression": critical(&material, Sense::Compression),
        }));
    }
    output::text(&describe(&material))
}

/// Members of a material with a unit, and their names with it. The constants of rate laws have the names and units of material files.
const UNITS: [(&str, &str); 7] = [
    ("density", "density_kg_m3"),
    ("modulus", "modulus_Pa"),
    ("stress", "stress_Pa"),
    ("table_error", "table_error_Pa"),
    ("specific_heat", "specific_heat_J_kg_K"),
    ("melting_temperature", "melting_temperature_K"),
    ("reference_temperature", "reference_temperature_K"),
];

/// Returns the value with names that end in their units.
fn with_units(value: serde_json::Value) -> serde_json::Value {
    use serde_json::Value;
    let named = |name: String| UNITS.iter().find(|(own, _)| *own == name).map_or(name, |(_, with)| (*with).to_owned());
    match value {
        Value::Object(members) => {
            Value::Object(members.into_iter().map(|(name, value)| (named(name), with_units(value))).collect())
        }
        Value::Array(values) => Value::Array(values.into_iter().map(with_units).collect()),
        other => other,
    }
}

/// Returns the description of a material as text.
fn describe(m: &Material) -> String {
    let mut lines = vec![("name", m.name.clone())];
    let mut add = |name, value: String| {
        if !value.is_empty() {
            lines.push((name, value));
        }
    };
    add("description", m.description.clone());
    add("density", format!("{} kg/m^3", m.density));
    add("modulus", format!("{:.6} GPa", m.modulus / GPA));
    add("poisson", m.poisson.map_or_else(String::new, |nu| nu.to_string()));
    add("c0", format!("{:.2} m/s", m.c0()));
    add("elastic limit", format!("{:.4} MPa", elastic_limit(m) / MPA));
    add("law", m.constants.law.clone().unwrap_or_default());
    if m.table_error > 0.0 {
        add("table error", format!("{:.3e} Pa at most, between table and law", m.table_error));
    }
    add("critical", critical_line(m, Sense::Tension));
    if m.compression.is_some() {
        add("in compression", critical_line(m, Sense::Compression));
    }
    for (name, value) in constants(m) {
        add(name, value);
    }
    add("citation", m.provenance.citation.clone());
    add("measured", m.provenance.measured.clone());
    add("confidence", m.provenance.confidence.clone());
    add("origin", m.provenance.origin.clone());
    let lines: Vec<_> = lines.iter().map(|(name, value)| format!("{name:<15} {value}\n")).collect();
    let mut text = lines.concat();
    text += &branch(if m.loading == Loading::Shear { "shear" } else { "tension" }, &m.tension);
    if let Some(compression) = &m.compression {
        text += &branch("compression", compression);
    }
    text
}

fn critical_line(m: &Material, sense: Sense) -> String {
    let c = critical(m, sense);
    match (c.critical_velocity_m_s, c.strain_at_max, c.stress_at_max_pa) {
        (Some(v), Some(strain), Some(stress)) => {
            format!("{v:.4} m/s, at strain {strain:.6}, stress {:.4} MPa ({})", stress / MPA, c.reason)
        }
        _ => format!("none: {}", c.reason),
    }
}

fn constants(m: &Material) -> Vec<(&'static str, String)> {
    let heat = &m.constants.heat;
    let optional = |value: Option<f64>, unit: &str| value.map_or_else(String::new, |v| format!("{v}{unit}"));
    let rates = m.constants.rate.iter().map(|rate| ("rate", rate.describe()));
    rates
        .chain([
            ("specific heat", optional(heat.specific_heat, " J/(kg K)")),
            ("heat fraction", optional(heat.fraction, "")),
            ("reference temp", optional(heat.reference_temperature, " K")),
            ("melting temp", optional(heat.melting_temperature, " K")),
            ("softening m", optional(heat.exponent, "")),
        ])
        .collect()
}

/// Returns a strain with seven significant digits and without an exponent.
fn strain_digits(strain: f64) -> String {
    let zeros = if strain > 0.0 { (-strain.log10()).floor().max(0.0) as usize } else { 0 };
    format!("{strain:.*}", zeros + 7)
}

fn branch(name: &str, curve: &Curve) -> String {
    let beyond = match curve.beyond() {
        Beyond::Rupture => "fractures at the last row",
        Beyond::Extend => "extrapolated with the last slope",
        Beyond::Error => "no data past the last row",
    };
    let rows: Vec<_> = curve
        .strain()
        .iter()
        .zip(curve.stress())
        .map(|(strain, stress)| vec![strain_digits(*strain), format!("{:.4}", stress / MPA)])
        .collect();
    format!("\n{name}: {} rows; {beyond}\n{}", rows.len(), output::table(&["strain", "stress MPa"], &rows, 0, false))
}

fn path(args: &PathArgs) -> Result<()> {
    let folders = library::folders(Path::new("."));
    if args.json {
        let folder =
            |folder: &PathBuf| serde_json::json!({ "folder": folder.display().to_string(), "exists": folder.is_dir() });
        let variable = std::env::var_os(library::FOLDER_VARIABLE).filter(|v| !v.is_empty());
        return output::json(&serde_json::json!({
            "folders": folders.iter().map(folder).collect::<Vec<_>>(),
            "variable": library::FOLDER_VARIABLE,
            "value": variable.map(|v| v.to_string_lossy().into_owned()),
        }));
    }
    let mut text = String::new();
    for folder in folders {
        let state = if folder.is_dir() { "" } else { "  (does not exist)" };
        text += &[&folder.display().to_string(), state, "\n"].concat();
    }
    let variable = library::FOLDER_VARIABLE;
    if std::env::var_os(variable).is_none_or(|v| v.is_empty()) {
        text += &["$", variable, "  (not set)\n"].concat();
    }
    text += "built-in library\n";
    output::text(&text)
}

//! `barwave critical`.

use std::path::Path;

use super::output;
use crate::error::Result;
use crate::material::{Material, Sense, library};
use crate::study::confirm::{Confirmation, Driven, confirm};
use crate::study::critical::{CriticalRow, critical};

/// Options of `barwave critical`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Library names or paths of material files.
    #[arg(required = true, value_name = "MATERIAL")]
    materials: Vec<String>,
    /// Sense of the loading.
    #[arg(long, value_enum, default_value = "tension")]
    sense: SenseArg,
    /// Confirm the value: simulate a bar 5 % below and 5 % above the critical velocity.
    #[arg(long)]
    simulate: bool,
    /// Print a JSON list and nothing else.
    #[arg(long)]
    json: bool,
}

/// A sense of loading on the command line.
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

pub(crate) fn run(args: &Args) -> Result<()> {
    let materials = load(&args.materials)?;
    let rows: Vec<_> = materials.iter().map(|m| critical(m, args.sense.into())).collect();
    if !args.simulate {
        return if args.json { output::json(&rows) } else { output::text(&table(&rows)) };
    }
    let simulated: Vec<_> = materials.iter().zip(&rows).map(|(m, row)| confirm(m, row)).collect();
    if args.json {
        let both: Vec<_> = rows.iter().zip(simulated).map(|(row, simulated)| Simulated { row, simulated }).collect();
        return output::json(&both);
    }
    let lines: String = rows.iter().zip(&simulated).map(|(row, s)| sentence(row, s.as_ref())).collect();
    output::text(&(table(&rows) + "\n" + &lines))
}

/// A row with what the simulation made of it.
#[derive(serde::Serialize)]
struct Simulated<'a> {
    #[serde(flatten)]
    row: &'a CriticalRow,
    simulated: Option<Confirmation>,
}

fn sentence(row: &CriticalRow, simulated: Option<&Confirmation>) -> String {
    let Some(s) = simulated else {
        return format!("{}: not simulated, no critical velocity within the data\n", row.material);
    };
    let bar = |d: &Driven| {
        let verdict = if d.breaks { "breaks" } else { "holds" };
        format!("at {:.2} m/s the bar {verdict} (strain {:.4} at the struck end)", d.velocity_m_s, d.strain_at_end)
    };
    let verdict = if s.confirmed { "confirmed" } else { "NOT confirmed" };
    format!("{}: {verdict}: {}, {}\n", row.material, bar(&s.below), bar(&s.above))
}

/// Materials by name or path, looked up from the working folder.
pub(super) fn load(names: &[String]) -> Result<Vec<Material>> {
    names.iter().map(|name| library::find(name, Path::new(""))).collect()
}

/// The rows for people.
pub(super) fn table(rows: &[CriticalRow]) -> String {
    const MPA: f64 = 1e6;
    let cells = |r: &CriticalRow| {
        vec![
            r.material.clone(),
            output::fixed(r.critical_velocity_m_s, 2),
            output::fixed(Some(r.yield_velocity_m_s), 2),
            output::fixed(r.strain_at_max, 4),
            output::fixed(r.stress_at_max_pa.map(|s| s / MPA), 1),
            output::fixed(Some(r.density_kg_m3), 0),
            r.reason.clone(),
        ]
    };
    let headings =
        ["material", "v_c m/s", "v_yield m/s", "strain at max", "stress at max MPa", "density kg/m^3", "criterion"];
    output::table(&headings, &rows.iter().map(cells).collect::<Vec<_>>(), 1, true)
}

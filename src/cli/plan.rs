//! `barwave plan`: what a run would do and cost.

use std::path::PathBuf;

use super::output;
use super::run::front_lines;
use crate::error::Result;
use crate::scene::Scene;
use crate::study::plan::{Plan, plan};
use crate::units::{Dimension, System, format};

/// Options of `barwave plan`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    scene: PathBuf,
    /// Change a key of the scene, as for `barwave run`.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Print one JSON object and nothing else.
    #[arg(long)]
    json: bool,
    /// Units of the text.
    #[arg(long, value_name = "si|us", default_value = "si")]
    units: System,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let plan = plan(&Scene::read(&args.scene, &args.overrides)?);
    if args.json { output::json(&plan) } else { output::text(&text(&plan, args.units)) }
}

fn text(plan: &Plan, units: System) -> String {
    let time = |seconds: f64| format(seconds, Dimension::Time, units);
    let mut lines = vec![plan.scene.clone()];
    let mut line = |label: &str, value: String| lines.push(std::format!("  {label:<18}{value}"));
    line("method", std::format!("{} {}", plan.method, plan.scheme));
    for effect in &plan.effects {
        line(if effect.on { "on" } else { "off" }, std::format!("{}: {}", effect.effect, effect.why));
    }
    line("grid", std::format!("{} cells, {} steps of {}", plan.cells, plan.steps, time(plan.dt_s)));
    line(
        "memory",
        std::format!(
            "{} bytes a cell while elastic, {} once yielded: at most {}",
            plan.bytes_per_elastic_cell,
            plan.bytes_per_yielded_cell,
            bytes(plan.memory_bytes)
        ),
    );
    line("fields", std::format!("{} before compression", bytes(plan.field_bytes)));
    let [quick, slow] = plan.expected_s;
    line(
        "expected time",
        std::format!("{} to {} of stepping on one thread, if every cell is at work", time(quick), time(slow)),
    );
    let critical = plan.critical_velocity.map_or_else(
        || "none within the data of the curve".to_owned(),
        |v| {
            let verdict = if plan.above_critical { "exceeded" } else { "not reached" };
            std::format!("{}, {verdict}", format(v, Dimension::Velocity, units))
        },
    );
    line("critical velocity", critical);
    lines.extend(front_lines(&plan.fronts, units));
    lines.join("\n") + "\n"
}

fn bytes(count: usize) -> String {
    const STEP: f64 = 1024.0;
    let mut value = count as f64;
    for unit in ["bytes", "KiB", "MiB"] {
        if value < STEP {
            return std::format!("{value:.1} {unit}").replace(".0 ", " ");
        }
        value /= STEP;
    }
    std::format!("{value:.2} GiB")
}

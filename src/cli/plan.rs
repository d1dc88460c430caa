//! `barwave plan`: method, work and estimates of a run, before it.

use std::path::PathBuf;

use super::lines::Lines;
use super::output;
use super::summary::{add_critical, front_lines, note_lines};
use crate::error::Result;
use crate::run::{Trial, plan_impact};
use crate::scene::Problem;
use crate::study::plan::{InitialSteps, Plan, Staircase, Work, plan};
use crate::units::{Dimension, System, format, in_units};

/// Options of `barwave plan`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  barwave plan scene.toml\n  barwave plan scene.toml --set solve.cells=4000 --json")]
pub(crate) struct Args {
    /// The scene file; `-` reads standard input.
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
    let scene = match Problem::read(&args.scene, &args.overrides)? {
        Problem::Bar(scene) => scene,
        Problem::Impact(scene) => {
            let plan = plan_impact(&scene);
            let text = || super::impact::plan_text(&plan, args.units);
            return if args.json { output::json(&plan) } else { output::text(&text()) };
        }
    };
    let plan = plan(&scene);
    if args.json { output::json(&plan) } else { output::text(&text(&plan, args.units)) }
}

fn text(plan: &Plan, units: System) -> String {
    let mut lines = Lines::under(&plan.scene);
    if let Some(choice) = &plan.choice {
        let schemes = choice.schemes.join(", ");
        lines.add("tolerance", std::format!("{:e}, of {schemes}: {}", choice.tolerance, choice.how));
    }
    lines.add("method", std::format!("{} {}", plan.method, plan.scheme));
    for effect in &plan.effects {
        let size = effect.estimate.map_or_else(String::new, |e| std::format!(" ({:.2} %)", 100.0 * e));
        lines.add(
            if effect.on { "on" } else { "off" },
            std::format!("{}{size}: {}", effect.effect, in_units(&effect.why, units)),
        );
    }
    for (label, value) in work_lines(&plan.work, units).into_iter().chain(trial_lines(&plan.trial, units)) {
        lines.add(label, value);
    }
    if let Some(Staircase { pieces, reflects }) = plan.staircase {
        lines.add(
            "staircase",
            std::format!(
                "tapers become {pieces} uniform pieces; a step reflects at most {:.2} % of a wave",
                100.0 * reflects
            ),
        );
    }
    if let Some(InitialSteps { steps, largest }) = plan.initial_steps {
        lines.add(
            "initial state",
            std::format!("becomes {steps} uniform steps of at most {:.2} % of the largest value", 100.0 * largest),
        );
    }
    lines.add("fields", std::format!("{} before compression", bytes(plan.field_bytes)));
    let critical = plan.critical_velocity.map(|v| {
        let verdict = match (plan.above_critical, plan.initial_state) {
            (true, _) => ", exceeded",
            (false, true) => "",
            (false, false) => ", not reached",
        };
        format(v, Dimension::Velocity, units) + verdict
    });
    add_critical(&mut lines, critical, &plan.fronts);
    lines.extend(front_lines(&plan.fronts, units));
    lines.extend(note_lines(&plan.notes, units));
    lines.text()
}

fn work_lines(work: &Work, units: System) -> Vec<(&'static str, String)> {
    let time = |seconds: f64| format(seconds, Dimension::Time, units);
    match *work {
        Work::Grid {
            cells,
            dt_s,
            steps,
            bytes_per_elastic_cell: elastic,
            bytes_per_yielded_cell: yielded,
            memory_bytes,
            largest_transit_shift: shift,
            net,
        } => {
            let grid = std::format!("{cells} cells, {steps} steps of {}", time(dt_s));
            let most = bytes(memory_bytes);
            let memory = std::format!("{elastic} bytes per elastic cell, {yielded} per yielded cell: at most {most}");
            let rounded = std::format!("rounded by up to {shift:.1e}: waves cross a cell in a step");
            let transits = (shift > 1e-9).then_some(("transit times", rounded));
            let relaxation = net.and_then(|net| net.k_dt).map(relaxation_line);
            [("grid", grid), ("memory", memory)].into_iter().chain(transits).chain(relaxation).collect()
        }
        Work::Fronts { front_tolerance, stress_scale, first_fronts, lines, event_budget, bytes_per_front } => {
            let fronts = std::format!("{first_fronts} after t = 0; the curve has {lines} straight segments");
            let events = std::format!("at most {event_budget}");
            let memory = std::format!("{bytes_per_front} bytes per active front, for any length of bar");
            let stress = format(stress_scale, Dimension::Stress, units);
            let tolerance = ("front tolerance", tolerance_text(front_tolerance, &stress));
            vec![("fronts", fronts), tolerance, ("events", events), ("memory", memory)]
        }
    }
}

/// Rounds to two significant digits; an estimate is not more accurate.
fn rounded(value: f64) -> f64 {
    let last = 10.0_f64.powf(value.log10().floor() - 1.0);
    if value > 0.0 { (value / last).round() * last } else { value }
}

fn trial_lines(trial: &Trial, units: System) -> Vec<(&'static str, String)> {
    let is_whole = trial.share >= 1.0;
    let tried = if is_whole { "the whole run".into() } else { std::format!("{:.2} % of the run", 100.0 * trial.share) };
    let [shortest, longest] = trial.seconds.map(|seconds| format(rounded(seconds), Dimension::Time, units));
    let time = std::format!("{shortest} to {longest} for the solver, from a trial of {tried}");
    let events = trial.events.map(|events| ("expected events", events.to_string()));
    events.into_iter().chain([("expected time", time)]).collect()
}

fn tolerance_text(front_tolerance: f64, stress: &str) -> String {
    if front_tolerance == 0.0 {
        "0: every wave is tracked; the result is exact for the table".into()
    } else {
        std::format!("{front_tolerance} of {stress}: weaker neighbouring waves of one kind are merged")
    }
}

fn relaxation_line(k_dt: f64) -> (&'static str, String) {
    let meaning = if k_dt > 1.0 {
        "plastic fronts are narrower than a cell and are not resolved; use more cells"
    } else {
        "resolved, to second order"
    };
    ("relaxation", std::format!("k dt = {k_dt:.2e}: {meaning}"))
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

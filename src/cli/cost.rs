//! `barwave cost`: error against computing time.

use std::fmt::Write as _;
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::scratch::Scratch;
use super::{interrupt, options, output};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::record::{Measure, SolvedBy};
use crate::report::{self, plot};
use crate::scene::{ImpactScene, Problem};
use crate::study::cost::{
    Cost, CostPoint, CostToTolerance, EffectCost, Growth, Hooks, OrderFit, Whole, check_budget, cost,
};
use crate::study::impact_cost::impact_cost;
use crate::units::{Dimension, Quantity};

/// Options of `barwave cost`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave cost scene.toml --budget 60s\n  barwave cost scene.toml --measure peak-force -o cost.svg"
)]
pub(crate) struct Args {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    scene: PathBuf,
    /// Output file: table (.csv), figure (.svg, .png, .pdf, .html) or complete data (.json); `-` writes the table to
    /// standard output.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Wall-clock time for the whole study, e.g. 60s or "5 min".
    #[arg(long, value_name = "TIME", default_value = "60s")]
    budget: Quantity,
    /// Error measure of waves in a bar: field, field-at-end, ends, gauges, residual-strain or peak-force [default: field].
    #[arg(long, value_name = "NAME")]
    measure: Option<String>,
    /// Change a key of the scene, as for `barwave run`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Print one JSON object on stdout and nothing else.
    #[arg(long)]
    json: bool,
    /// No progress bar and no table.
    #[arg(long)]
    quiet: bool,
}

/// Format of the output file.
enum Kind {
    Csv,
    Json,
    Picture,
}

/// Shortest and longest interval at which a child process is polled. It grows from the first to the second, so that short runs are timed
/// to a fraction of a millisecond.
const FIRST_LOOK: Duration = Duration::from_micros(200);
const LAST_LOOK: Duration = Duration::from_millis(5);

/// Default error measure.
const USUAL_MEASURE: &str = "field";

/// Steps of the progress bar per second of the budget.
const TICKS: f64 = 10.0;

/// Milliseconds per second.
const MILLI: f64 = 1e3;

/// Library arguments that are set by command-line options.
const OPTIONS: &[options::OptionOf<'static>] =
    &[("budget", "--budget", "e.g. --budget 60s or --budget \"5 min\""), ("measure", "--measure", "")];

pub(crate) fn run(args: &Args) -> Result<()> {
    study(args).map_err(|error| options::name(error, OPTIONS))
}

fn study(args: &Args) -> Result<()> {
    let budget = seconds(&args.budget)?;
    let measure = measure(args.measure.as_deref().unwrap_or(USUAL_MEASURE))?;
    let kind = args.output.as_deref().map(kind).transpose()?;
    output::check(args.json, [args.output.as_deref()])?;
    if !args.scene.is_file() && args.scene.exists() || args.scene == Path::new("-") {
        let message = format!("`{}` can be read only once", args.scene.display());
        return Err(InputError::new(message).help("`barwave cost` runs the scene many times; name a file").into());
    }
    let scene = match Problem::read(&args.scene, &args.overrides)? {
        Problem::Bar(scene) => *scene,
        Problem::Impact(scene) => return of_impact(args, &scene, kind.as_ref(), budget),
    };
    let stop = interrupt::flag();
    let bar = progress_bar(args.quiet || args.json, budget);
    let scratch = Scratch::new("cost")?;
    let mut whole = |overrides: &[String], most: f64| time(&scratch, &args.scene, overrides, most, &stop);
    let mut progress = |what: &str, now: f64| {
        bar.set_position((TICKS * now) as u64);
        bar.set_message(what.to_owned());
        if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let found = cost(&scene, &mut Hooks { budget, measure, whole: Some(&mut whole), progress: &mut progress });
    bar.finish_and_clear();
    let found = found.inspect_err(explain_interruption)?;
    if let (Some(path), Some(kind)) = (args.output.as_deref(), kind) {
        write(path, &kind, &found)?;
    }
    if args.json {
        output::json(&found)?;
    } else if !args.quiet {
        output::text_beside([args.output.as_deref()], &text(&found, args.output.as_deref()))?;
    }
    if !found.interrupted {
        return Ok(());
    }
    let kept = args.output.as_ref().map_or_else(|| "shown".to_owned(), |path| format!("in {}", path.display()));
    output::remark(&format!("interrupted: the points measured so far are {kept}\n"));
    Err(Error::Interrupted)
}

/// Remarks that a study which was interrupted before its first point keeps nothing.
fn explain_interruption(error: &Error) {
    if matches!(error, Error::Interrupted) {
        output::remark("interrupted before the first point was measured: nothing is kept\n");
    }
}

/// Runs the study of an impact without waves in a bar.
fn of_impact(args: &Args, scene: &ImpactScene, kind: Option<&Kind>, budget: f64) -> Result<()> {
    if args.measure.is_some() {
        let error =
            InputError::new("the error measures are those of waves in a bar, and this scene has none").key("--measure");
        let help =
            "leave it out: the error of an impact is that of contact force, contact time, impulse and restitution";
        return Err(error.help(help).into());
    }
    let (stop, started) = (interrupt::flag(), Instant::now());
    let bar = progress_bar(args.quiet || args.json, budget);
    let mut progress = |what: &str, done: f64| {
        bar.set_position((TICKS * budget * done) as u64);
        bar.set_message(what.to_owned());
        let over = stop.load(Ordering::Relaxed) || started.elapsed().as_secs_f64() > budget;
        if over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let found = impact_cost(scene, &mut progress);
    bar.finish_and_clear();
    let found = found.inspect_err(explain_interruption)?;
    match (args.output.as_deref(), kind) {
        (Some(path), Some(Kind::Csv)) => destination::write_whole(path, super::impact_cost::csv(&found).as_bytes())?,
        (Some(path), Some(Kind::Json)) => {
            destination::write_whole(path, output::json_text(&found)?.as_bytes())?;
        }
        (Some(path), Some(Kind::Picture)) => plot::save(path, &found.scene, &report::impact_cost::figure(&found))?,
        _ => {}
    }
    if args.json {
        output::json(&found)?;
    } else if !args.quiet {
        output::text_beside([args.output.as_deref()], &super::impact_cost::text(&found))?;
    }
    if stop.load(Ordering::Relaxed) { Err(Error::Interrupted) } else { Ok(()) }
}

fn seconds(budget: &Quantity) -> Result<f64> {
    let wrong = |message: String| InputError::new(message).key("budget").allowed("a time above 0");
    let seconds = budget.si(Dimension::Time).map_err(wrong)?;
    check_budget(seconds)?;
    Ok(seconds)
}

fn measure(name: &str) -> Result<Measure> {
    Measure::of_key(name).ok_or_else(|| {
        let names = Measure::ALL.map(|measure| measure.key().replace('_', "-"));
        let error = InputError::new(format!("unknown error measure `{name}`")).key("--measure");
        error.allowed(names.join(", ")).help("field is the error of stress over the bar and time").into()
    })
}

fn kind(path: &Path) -> Result<Kind> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match extension.as_str() {
        "csv" => Ok(Kind::Csv),
        _ if output::is_csv(path) => Ok(Kind::Csv),
        "json" => Ok(Kind::Json),
        _ => options::picture(path, "-o").map(|_| Kind::Picture).map_err(|e| match e {
            Error::Input(e) => e.allowed("a file name ending in .csv, .svg, .png, .pdf, .html or .json").into(),
            other => other,
        }),
    }
}

fn write(path: &Path, kind: &Kind, cost: &Cost) -> Result<()> {
    match kind {
        Kind::Csv => destination::write_whole(path, csv(&cost.points).as_bytes()),
        Kind::Json => destination::write_whole(path, output::json_text(cost)?.as_bytes()),
        Kind::Picture => plot::save(path, &cost.scene, &report::cost::figure(cost)),
    }
}

fn progress_bar(silent: bool, budget: f64) -> ProgressBar {
    if silent || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new((TICKS * budget) as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} % of the budget  {msg}") {
        bar.set_style(style);
    }
    bar
}

/// Measures the wall time of `barwave run` with these overrides, from the start to the end of its process; stops it after `most` s.
fn time(scratch: &Scratch, scene: &Path, overrides: &[String], most: f64, stop: &AtomicBool) -> Whole {
    let Ok(program) = std::env::current_exe() else {
        return Whole::Failed("the path of the program is unknown".into());
    };
    let mut command = Command::new(program);
    command.arg("run").arg(scene).arg("--quiet").arg("-o").arg(scratch.path().join("whole.h5"));
    for set in overrides {
        command.arg("--set").arg(set);
    }
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let started = Instant::now();
    match command.spawn() {
        Ok(child) => wait(child, started, most, stop),
        Err(error) => Whole::Failed(error.to_string()),
    }
}

fn wait(mut child: Child, started: Instant, most: f64, stop: &AtomicBool) -> Whole {
    let mut pause = FIRST_LOOK;
    loop {
        let ended = child.try_wait();
        let elapsed = started.elapsed().as_secs_f64();
        let end = match ended {
            Ok(Some(status)) if status.success() => return Whole::Took(elapsed),
            Ok(Some(status)) => return Whole::Failed(status.to_string()),
            Err(error) => return Whole::Failed(error.to_string()),
            Ok(None) if stop.load(Ordering::Relaxed) => Whole::Interrupted,
            Ok(None) if elapsed > most => Whole::OutOfTime,
            Ok(None) => {
                std::thread::sleep(pause);
                pause = LAST_LOOK.min(pause + pause / 4);
                continue;
            }
        };
        // The process may have ended meanwhile; an error of `kill` is then harmless.
        let _ = child.kill();
        let _ = child.wait();
        return end;
    }
}

/// Returns the points as CSV, one row each.
fn csv(points: &[CostPoint]) -> String {
    let mut text = String::from(
        "method,scheme,cells,front_tolerance,error,field,field_at_end,ends,gauges,residual_strain,peak_force,step_wall_s,shortest_s,\
         spread,repetitions,whole_wall_s,work,work_unit,memory_bytes,pareto,below_reference\n",
    );
    let number = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
    for p in points {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            p.by.method,
            p.by.scheme,
            p.by.cells.map_or_else(String::new, |c| c.to_string()),
            number(p.by.front_tolerance),
            p.error,
            Measure::ALL.map(|measure| number(p.errors[measure])).join(","),
            p.step_wall_s,
            p.shortest_s,
            p.spread,
            p.repetitions,
            number(p.whole_wall_s),
            p.work,
            p.work_unit,
            p.memory_bytes,
            p.pareto,
            p.below_reference
        );
    }
    text
}

/// Returns all results as text.
fn text(cost: &Cost, written: Option<&Path>) -> String {
    let head = format!(
        "{}\n\nerror: {}, against the\n  {} (uncertainty {:.1e})\n",
        cost.scene, cost.measure, cost.reference, cost.reference_uncertainty
    );
    let marks = "* no other point is both faster and more accurate   ~ below the uncertainty of the reference\n";
    let mut parts = vec![head, points_table(cost), [marks, &orders(cost)].concat(), cheapest_table(cost)];
    if !cost.effects.is_empty() {
        parts.push(effects_table(cost));
    }
    if !cost.growth.is_empty() {
        parts.push(growth_table(&cost.growth));
    }
    parts.push(notes(cost, written));
    parts.join("\n")
}

/// Returns the fitted orders as text, one line for each scheme.
fn orders(cost: &Cost) -> String {
    let line = |fit: &OrderFit| {
        let (scheme, against, points) = (&fit.scheme, fit.against.replace('_', " "), fit.fitted.len());
        let in_time = fit.order_in_time.map_or_else(String::new, |order| format!(", {order:.2} in computing time"));
        format!("order of {scheme}: {:.2} in {against}{in_time}, over {points} points\n", fit.order)
    };
    cost.order_fits.iter().map(line).collect()
}

/// Returns what was not possible or skipped, and the conditions of the measurement.
fn notes(cost: &Cost, written: Option<&Path>) -> String {
    let mut lines = Vec::new();
    for unable in &cost.unable {
        lines.push(format!("not possible: {}: {}", unable.scheme.as_deref().unwrap_or(&unable.method), unable.why));
    }
    for skipped in &cost.skipped {
        let at = resolution(&skipped.by);
        lines.push(format!("skipped: {}, {at}: {}", skipped.by.scheme, skipped.why));
    }
    let load = |value: Option<f64>| value.map_or_else(|| "unknown".into(), |v| format!("{v:.2}"));
    lines.push(format!(
        "times are medians; {:.1} s of {} s used; load average {} before and {} after; {} threads",
        cost.wall_s,
        cost.budget_s,
        load(cost.load[0]),
        load(cost.load[1]),
        cost.threads
    ));
    if cost.interrupted {
        lines.push("interrupted: the results so far".into());
    }
    lines.extend(written.and_then(output::wrote));
    lines.join("\n") + "\n"
}

fn resolution(by: &SolvedBy) -> String {
    match (by.cells, by.front_tolerance) {
        (Some(cells), _) => format!("{cells} cells"),
        (None, tolerance) => format!("tolerance {}", tolerance.unwrap_or(0.0)),
    }
}

fn milliseconds(seconds: Option<f64>) -> String {
    seconds.map_or_else(|| "-".into(), |s| format!("{:.3}", MILLI * s))
}

fn points_table(cost: &Cost) -> String {
    let row = |p: &CostPoint| {
        let marks = format!("{}{}", if p.pareto { "*" } else { "" }, if p.below_reference { "~" } else { "" });
        vec![
            p.by.scheme.clone(),
            resolution(&p.by),
            format!("{:.2e}", p.error),
            p.errors[Measure::Ends].map_or_else(|| "-".into(), |e| format!("{e:.2e}")),
            p.errors[Measure::PeakForce].map_or_else(|| "-".into(), |e| format!("{e:.2e}")),
            milliseconds(Some(p.step_wall_s)),
            milliseconds(Some(p.shortest_s)),
            format!("{:.0} %", 100.0 * p.spread),
            p.repetitions.to_string(),
            milliseconds(p.whole_wall_s),
            format!("{} {}", p.work, p.work_unit),
            bytes(p.memory_bytes as f64),
            marks,
        ]
    };
    let headings = [
        "scheme",
        "resolution",
        "error",
        "ends",
        "peak force",
        "stepping ms",
        "shortest",
        "spread",
        "runs",
        "whole ms",
        "work",
        "memory",
        "",
    ];
    output::table(&headings, &cost.points.iter().map(row).collect::<Vec<_>>(), 2, true)
}

fn bytes(count: f64) -> String {
    match count {
        c if c < 1e3 => format!("{c:.0} B"),
        c if c < 1e6 => format!("{:.1} kB", c / 1e3),
        c => format!("{:.1} MB", c / 1e6),
    }
}

/// Returns a table with the cheapest way to each tolerance, and the time that each scheme needs for it.
fn cheapest_table(cost: &Cost) -> String {
    let schemes: Vec<&str> = cost.schemes().iter().map(|s| s.0).collect();
    let mut headings = vec!["error of", "cheapest"];
    headings.extend(&schemes);
    let how = |r: &CostToTolerance| match (r.how, r.step_wall_s) {
        (how, None) => how.to_owned(),
        ("interpolated", time) => format!("{} ms", milliseconds(time)),
        (_, time) => format!("<= {} ms", milliseconds(time)),
    };
    let row = |best: &CostToTolerance| {
        let at = |r: &CostToTolerance| match (r.cells, r.front_tolerance) {
            (Some(cells), _) => format!("{cells:.0} cells"),
            (None, Some(tolerance)) => format!("tolerance {tolerance:.1e}"),
            (None, None) => String::new(),
        };
        let name = best.scheme.as_deref().map_or_else(|| best.how.into(), |s| format!("{s}, {}", at(best)));
        let mut cells = vec![format!("{} %", 100.0 * best.tolerance), name];
        for scheme in &schemes {
            let own = cost.reach.iter().find(|r| r.tolerance == best.tolerance && r.scheme.as_deref() == Some(scheme));
            cells.push(own.map_or_else(String::new, how));
        }
        cells
    };
    output::table(&headings, &cost.cheapest.iter().map(row).collect::<Vec<_>>(), 2, false)
}

fn effects_table(cost: &Cost) -> String {
    let row = |e: &EffectCost| {
        let within = e.ns_per_cell_step.zip(e.ns_spread).is_some_and(|(added, spread)| added.abs() <= spread);
        let remark = if within { "; not measurable" } else { "" };
        let why = e.why.clone().unwrap_or_else(|| format!("{}, {} cells{remark}", e.scheme, e.cells));
        let [added, spread] = [e.ns_per_cell_step, e.ns_spread].map(|ns| output::fixed(ns, 3));
        vec![e.effect.clone(), added, spread, output::fixed(e.ratio_to_none, 2), why]
    };
    let rows: Vec<_> = cost.effects.iter().map(row).collect();
    output::table(&["effect", "added ns per cell-step", "spread", "ratio to none", "on"], &rows, 1, true)
}

fn growth_table(growth: &[Growth]) -> String {
    let row = |g: &Growth| {
        let (low, high) = (g.values.first().copied(), g.values.last().copied());
        let range = format!("{:.3e} to {:.3e}", low.unwrap_or(0.0), high.unwrap_or(0.0));
        vec![
            g.scheme.clone(),
            g.with.replace('_', " "),
            range,
            output::fixed(g.time_exponent, 2),
            output::fixed(g.memory_exponent, 2),
            g.at.clone(),
        ]
    };
    let rows: Vec<_> = growth.iter().map(row).collect();
    output::table(&["scheme", "growth with", "from", "time exponent", "memory exponent", "at"], &rows, 2, true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_a_time_above_zero() {
        let budget = |text: &str| seconds(&text.parse().unwrap_or(Quantity::Number(-1.0)));
        assert_eq!(budget("60s").expect("a time"), 60.0);
        assert_eq!(budget("2 min").expect("a time"), 120.0);
        assert_eq!(budget("0.5").expect("a time"), 0.5);
        for wrong in ["0", "-3 s", "3 m", "long"] {
            assert_eq!(budget(wrong).expect_err("no time").exit_code(), 2, "{wrong}");
        }
    }

    #[test]
    fn the_file_s_name_says_what_is_written() {
        assert!(matches!(kind(Path::new("a.csv")), Ok(Kind::Csv)));
        assert!(matches!(kind(Path::new("a.JSON")), Ok(Kind::Json)));
        assert!(matches!(kind(Path::new("a.svg")), Ok(Kind::Picture)));
        assert!(kind(Path::new("a.txt")).is_err());
    }
}

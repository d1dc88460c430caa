//! `barwave run`: simulates one scene, shows how far it is, and sums up.

use std::fmt::Write as _;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::{interrupt, output};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::record::store::{self, Existing};
use crate::record::{
    AuditRow, AutoChoice, ChoiceSummary, EndSummary, FrontSummary, LengthSummary, RuptureSummary, Summary,
};
use crate::run::{self, Progress, Wish};
use crate::scene::{Problem, SpecimenScene};
use crate::units::{Dimension, Quantity, System, format};

/// Options of `barwave run`.
#[derive(Debug, clap::Args)]
#[expect(clippy::struct_excessive_bools, reason = "one a flag")]
pub(crate) struct Args {
    /// The scene file; `-` reads standard input.
    #[arg(value_name = "SCENE.toml", required_unless_present = "resume")]
    scene: Option<PathBuf>,
    /// Result file [default: `runs/out/<scene name>.h5`; with --set, `runs/out/<scene name>_KEY=VALUE.h5`]. An earlier result there is
    /// replaced.
    #[arg(short, long, value_name = "OUT.h5")]
    output: Option<PathBuf>,
    /// Replace the output file even if barwave did not write it.
    #[arg(long)]
    force: bool,
    /// Change a key of the scene, e.g. --set solve.cells=2000 --set left.value="-40 m/s"; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Keep a checkpoint, `OUT.h5.checkpoint`, from which the run can be resumed: each time that this much wall time has passed, such
    /// as 60s or "5 min", and when the run is interrupted (Ctrl-C, SIGTERM). It is removed when the run ends.
    #[arg(long, value_name = "INTERVAL")]
    checkpoint: Option<Quantity>,
    /// Resume an interrupted or killed run from its checkpoint. The scene is read from the result file; the result has the same bits as
    /// that of a run without interruption.
    #[arg(long, value_name = "OUT.h5")]
    resume: Option<PathBuf>,
    /// Print one JSON object on stdout and nothing else.
    #[arg(long)]
    json: bool,
    /// Say how far the stresses may be off: on a grid by two coarser runs, which take a third of its time again.
    #[arg(long)]
    estimate_error: bool,
    /// No progress bar and no summary.
    #[arg(long)]
    quiet: bool,
    /// Units of the summary.
    #[arg(long, value_name = "si|us", default_value = "si")]
    units: System,
}

/// Length of the progress bar of a run that has no steps.
const TICKS: u64 = 1000;

/// Segments whose plastic strain is smaller on the mean are listed without a length.
const LEAST_STRAIN: f64 = 1e-6;

/// Fronts that the summary lists one by one; a curve of many knots has as many fronts.
const LISTED_FRONTS: usize = 12;

pub(crate) fn run(args: &Args) -> Result<()> {
    let every = args.checkpoint.as_ref().map(interval).transpose()?;
    if let Some(path) = &args.resume {
        nothing_beside_resume(args)?;
        return show(args, path, true, |progress| run::resume(path, every, progress));
    }
    let file = args.scene.as_deref().unwrap_or(Path::new("-"));
    let mut scene = match Problem::read(file, &args.overrides)? {
        Problem::Bar(scene) => *scene,
        Problem::Specimen(scene) => return run_specimen(args, &scene),
    };
    scene.solve.estimate_error = args.estimate_error;
    let path = output_path(args, &scene.name)?;
    show(args, &path, every.is_some(), |progress| match every {
        Some(every) => run::run_with_checkpoints(&scene, &path, every, progress),
        None => run::run(&scene, Some(&path), progress),
    })
}

/// What a run is told to do while it is under way.
type OnProgress<'a> = &'a mut dyn FnMut(Progress) -> Wish;

/// Shows how far a run is, and sums up.
fn show(
    args: &Args,
    path: &Path,
    resumable: bool,
    simulate: impl FnOnce(OnProgress<'_>) -> Result<Summary>,
) -> Result<()> {
    let stop = interrupt::flag();
    let bar = progress_bar(args.quiet || args.json);
    let summary = simulate(&mut |at: Progress| {
        show_progress(&bar, &at, args.quiet || args.json);
        if stop.load(Ordering::Relaxed) { Wish::Stop } else { Wish::GoOn }
    });
    bar.finish_and_clear();
    let shown = path.display();
    let summary = summary.inspect_err(|error| match error {
        Error::Interrupted if path.exists() => {
            output::note(&std::format!("interrupted: the frames so far are in {shown}\n"));
            if resumable {
                output::note(&std::format!("resume with: barwave run --resume {}\n", quoted(path)));
            }
        }
        Error::Interrupted => output::note("interrupted before the run began\n"),
        Error::Run(_) => output::note(&std::format!("the frames up to the error are in {shown}\n")),
        Error::Input(_) | Error::File { .. } | Error::Checks(_) => {}
    })?;
    if args.json {
        return output::json(&summary);
    }
    if args.quiet { Ok(()) } else { output::text(&text(&summary, args.units)) }
}

/// A path as a shell reads it.
fn quoted(path: &Path) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+=,:@".contains(c);
    let shown = path.display().to_string();
    if shown.chars().all(plain) { shown } else { std::format!("'{}'", shown.replace('\'', "'\\''")) }
}

/// A run that is resumed is that of its file.
fn nothing_beside_resume(args: &Args) -> Result<()> {
    let given = [
        (args.scene.is_some(), "a scene"),
        (args.output.is_some(), "-o"),
        (!args.overrides.is_empty(), "--set"),
        (args.estimate_error, "--estimate-error"),
        (args.force, "--force"),
    ];
    let Some((_, what)) = given.into_iter().find(|(given, _)| *given) else { return Ok(()) };
    let message = std::format!("{what} cannot be given with --resume: the result file says how its run continues");
    let help = "leave it out, or run the scene from the start without --resume";
    Err(InputError::new(message).key("--resume").help(help).into())
}

/// Wall time between two checkpoints.
fn interval(given: &Quantity) -> Result<Duration> {
    let wrong = |message: String| {
        let error = InputError::new(message).key("--checkpoint").allowed("0 s < interval <= 1e9 s");
        Error::from(error.help("e.g. --checkpoint 60s or --checkpoint \"5 min\""))
    };
    match given.si(Dimension::Time) {
        Ok(seconds) if seconds > 0.0 && seconds <= 1e9 => Ok(Duration::from_secs_f64(seconds)),
        Ok(seconds) => Err(wrong(std::format!("the interval {seconds} s is out of range"))),
        Err(reason) => Err(wrong(reason)),
    }
}

/// A specimen, by the energy method.
fn run_specimen(args: &Args, scene: &SpecimenScene) -> Result<()> {
    if args.checkpoint.is_some() {
        let message = "a [specimen] has no steps, and keeps no checkpoints";
        return Err(InputError::new(message).key("--checkpoint").help("leave --checkpoint out").into());
    }
    let summary = run::run_specimen(scene, Some(&output_path(args, &scene.name)?))?;
    if args.json {
        return output::json(&summary);
    }
    if args.quiet { Ok(()) } else { output::text(&super::specimen::text(&summary, args.units, true)) }
}

/// Where the result goes.
fn output_path(args: &Args, name: &str) -> Result<PathBuf> {
    let output = match &args.output {
        Some(path) => path.clone(),
        None => default_output(name, &args.overrides)?,
    };
    check_output(&output, args.force)?;
    Ok(output)
}

/// runs/out is made where it is missing: it is the program's own place.
fn default_output(name: &str, overrides: &[String]) -> Result<PathBuf> {
    let folder = Path::new("runs/out");
    std::fs::create_dir_all(folder).map_err(|e| Error::file(folder, e))?;
    Ok(folder.join(default_name(name, overrides)))
}

/// `a.h5` for the scene a, `a_solve.cells=2000.h5` with an override. Characters that shells or file systems treat apart become `-`; where
/// there are such, or the name is long, a code of the overrides as typed keeps names of different runs apart.
fn default_name(name: &str, overrides: &[String]) -> String {
    const LONGEST: usize = 100;
    let plain = |c: char| c.is_ascii_alphanumeric() || ".+-=".contains(c);
    let readable = |set: &String| set.chars().map(|c| if plain(c) { c } else { '-' }).collect::<String>();
    let mut suffix: String = overrides.iter().flat_map(|set| ["_".to_owned(), readable(set)]).collect();
    if suffix.len() > LONGEST || overrides.iter().any(|set| !set.chars().all(plain)) {
        suffix.truncate(LONGEST);
        // Writing to a String cannot fail.
        let _ = write!(suffix, "_{:08x}", code(overrides));
    }
    std::format!("{name}{suffix}.h5")
}

/// The FNV-1a hash of texts, each ended by a zero byte.
fn code(texts: &[String]) -> u32 {
    let bytes = texts.iter().flat_map(|text| text.bytes().chain(std::iter::once(0)));
    bytes.fold(0x811c_9dc5, |hash: u32, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

/// A result file goes into a folder that exists, in place of nothing but another result.
fn check_output(output: &Path, force: bool) -> Result<()> {
    let folder = output.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if output == Path::new("-") {
        let message = "a result file (HDF5) cannot be written to standard output";
        return Err(InputError::new(message).key("-o").help("give a file name, such as result.h5").into());
    }
    match store::existing(&destination::resolve(output)?) {
        Existing::InUse => {
            let message = std::format!("the output {} is being written by another run", output.display());
            return Err(InputError::new(message)
                .help("choose another name with -o, or wait until that run has ended")
                .into());
        }
        Existing::Other if !force => {
            let message = std::format!("the output {} is there already, and is no result file", output.display());
            return Err(InputError::new(message)
                .help("choose another name with -o, or replace that file with --force")
                .into());
        }
        Existing::Other | Existing::Nothing | Existing::Result => {}
    }
    if !folder.is_dir() {
        let message = std::format!("the output's folder {} does not exist", folder.display());
        return Err(InputError::new(message).help("make it first, or choose another place with -o").into());
    }
    Ok(())
}

/// A bar on stderr where that is a terminal, otherwise a hidden one.
fn progress_bar(silent: bool) -> ProgressBar {
    if silent || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(0);
    let template = "{bar:30} {percent:>3} %  {msg}  {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

fn show_progress(bar: &ProgressBar, at: &Progress, quiet: bool) {
    if let Progress::Chosen(choice) = &at {
        if !quiet {
            bar.suspend(|| output::note(&std::format!("auto: {}\n", choice_text(choice))));
        }
        return;
    }
    if bar.is_hidden() {
        return;
    }
    let seconds = bar.elapsed().as_secs_f64().max(1e-9);
    match *at {
        Progress::Chosen(_) => {}
        Progress::Steps { step, steps, cells } => {
            bar.set_length(steps as u64);
            bar.set_position(step as u64);
            let rate = (step * cells) as f64 / seconds;
            bar.set_message(std::format!("step {step} of {steps}  {:.0} million cell-steps/s", rate / 1e6));
        }
        Progress::Fronts { time, until, events, fronts } => {
            bar.set_length(TICKS);
            bar.set_position((TICKS as f64 * time / until) as u64);
            let time = format(time, Dimension::Time, System::Si);
            bar.set_message(std::format!("t = {time}  {events} events  {fronts} fronts under way"));
        }
    }
}

/// The summary for people.
fn text(s: &Summary, units: System) -> String {
    let show = |value: f64, dimension| format(value, dimension, units);
    let mut lines = vec![s.scene.clone()];
    let mut line = |label: &str, value: String| lines.push(std::format!("  {label:<18}{value}"));
    line("outcome", s.outcome.clone());
    for choice in s.auto.iter().flatten() {
        line("auto", choice_text(choice));
    }
    let end = show(s.end_time_s, Dimension::Time);
    let how = match &s.tracking {
        None => std::format!("{} cells, {} steps to {end}", s.cells, s.steps),
        Some(t) => std::format!("{} events to {end}, {} fronts under way", s.events, t.fronts_under_way),
    };
    line("method", std::format!("{} {}, {how}", s.method, s.scheme));
    line("effects", if s.effects.is_empty() { "none: the run stayed elastic".into() } else { s.effects.join(", ") });
    if let Some(torsion) = &s.torsion {
        let end = |k: usize| {
            let torque = show(torsion.torque[k], Dimension::Torque);
            std::format!("{torque} at {}", show(torsion.angular_velocity_rad_s[k], Dimension::AngularVelocity))
        };
        let radius = show(torsion.radius_m, Dimension::Length);
        line("torsion", std::format!("left {}, right {}; in terms of the surface (radius {radius}):", end(0), end(1)));
    }
    for (label, end) in [("left end", &s.left), ("right end", &s.right)] {
        line(label, end_text(end, units));
        if let Some(velocity) = end.striker {
            line("striker", std::format!("velocity {}", show(velocity, Dimension::Velocity)));
        }
    }
    for (label, value) in length_lines(s, units) {
        line(&label, value);
    }
    if let Some(check) = &s.elastic_check {
        let (found, expected) = (show(check.stress, Dimension::Stress), show(check.expected, Dimension::Stress));
        line("elastic check", std::format!("{found} against rho c0 v = {expected}, relative {:.1e}", check.relative));
    }
    let critical = s.critical_velocity.map_or_else(
        || "none within the data of the curve".to_owned(),
        |v| {
            std::format!(
                "{}{}",
                show(v, Dimension::Velocity),
                if s.above_critical { ", exceeded: the bar breaks where it is struck" } else { "" }
            )
        },
    );
    line("critical velocity", critical);
    if let Some(rise) = s.temperature_rise {
        line("heat", std::format!("the bar warmed by up to {rise:.4} K"));
    }
    for r in s.ruptures.iter().flatten() {
        line("rupture", rupture_text(r, units));
    }
    line(
        "ledger",
        std::format!(
            "energy residual {:.1e}, momentum residual {:.1e}",
            s.ledger.energy_residual,
            s.ledger.momentum_residual
        ),
    );
    if let Some(error) = &s.error {
        line("error", std::format!("{:.2e}, {}, against the {}", error.value, error.measure, error.reference));
        if let Some(table) = &error.table {
            line("errors", table.to_string());
        }
    }
    if let Some(choice) = &s.choice {
        line("chosen", tolerance_text(choice));
    }
    let rate = match &s.tracking {
        None => std::format!("{:.0} million cell-steps/s", s.cell_steps_per_s / 1e6),
        Some(t) => std::format!("{:.2} million events/s", t.events_per_s / 1e6),
    };
    line("time", std::format!("{:.3} s, of it stepping {:.3} s ({rate})", s.wall_s, s.step_wall_s));
    line("result", s.output.clone());
    lines.extend(front_lines(&s.fronts, units));
    lines.extend(note_lines(&s.notes));
    lines.extend(audit_lines(&s.audit));
    lines.join("\n") + "\n"
}

/// Lengths of segments that flowed, with a label each.
fn length_lines(s: &Summary, units: System) -> Vec<(String, String)> {
    let show = |length| format(length, Dimension::Length, units);
    let text = |length: &LengthSummary| {
        let [at_end, unloaded] = [length.at_end, length.unloaded].map(show);
        let share = length.unloaded / length.initial;
        std::format!("{at_end}, unloaded {unloaded} ({share:.4} of {})", show(length.initial))
    };
    let label =
        |k: usize| if s.lengths.len() == 1 { "final length".into() } else { std::format!("segment {} length", k + 1) };
    let flowed = |length: &LengthSummary| (length.unloaded - length.initial).abs() > LEAST_STRAIN * length.initial;
    s.lengths.iter().enumerate().filter(|(_, l)| flowed(l)).map(|(k, l)| (label(k), text(l))).collect()
}

fn tolerance_text(choice: &ChoiceSummary) -> String {
    let runs = choice.tried.len();
    std::format!("{} ({} runs in all, the coarse ones included)", choice.why, runs)
}

/// Why an effect is on or off: "heat on: ...".
pub(super) fn choice_text(choice: &AutoChoice) -> String {
    std::format!("{} {}: {}", choice.effect, if choice.on { "on" } else { "off" }, choice.why)
}

/// Notes on what a scene asks for, below a summary or a plan.
pub(super) fn note_lines(notes: &[String]) -> impl Iterator<Item = String> {
    notes.iter().map(|note| std::format!("  note: {note}"))
}

/// A line for each neglected effect that matters, and one for all others.
fn audit_lines(rows: &[AuditRow]) -> Vec<String> {
    let mut lines: Vec<String> =
        rows.iter().filter(|row| row.matters()).map(|row| std::format!("  note: {}", row.message())).collect();
    let size = |row: &AuditRow| {
        if row.estimate.is_nan() {
            std::format!("{} unknown", row.effect)
        } else {
            std::format!("{} {:.2} %", row.effect, 100.0 * row.estimate)
        }
    };
    let others: Vec<String> = rows.iter().filter(|row| !row.matters()).map(size).collect();
    if !others.is_empty() {
        lines.push(std::format!("  {:<18}{}", "left out", others.join(", ")));
    }
    lines
}

fn rupture_text(r: &RuptureSummary, units: System) -> String {
    std::format!(
        "{} ({}) at t = {}, x = {}: stress {}, strain {}, {} absorbed there",
        r.cause.name(),
        r.site,
        format(r.time_s, Dimension::Time, units),
        format(r.x_m, Dimension::Length, units),
        format(r.stress, Dimension::Stress, units),
        format(r.strain, Dimension::None, units),
        format(r.absorbed, Dimension::EnergyDensity, units)
    )
}

fn end_text(end: &EndSummary, units: System) -> String {
    std::format!(
        "stress {}, strain {}, velocity {}",
        format(end.stress, Dimension::Stress, units),
        format(end.strain, Dimension::None, units),
        format(end.velocity, Dimension::Velocity, units)
    )
}

pub(super) fn front_lines(fronts: &[FrontSummary], units: System) -> Vec<String> {
    if fronts.is_empty() {
        return Vec::new();
    }
    let mut lines = vec![std::format!(
        "  {:<9}{:>13}{:>13}{:>15}{:>15}{:>14}{:>14}",
        "front",
        "strain from",
        "to",
        "stress to",
        "speed",
        "measured",
        "last seen at"
    )];
    let unknown = || "-".to_owned();
    for front in fronts.iter().take(LISTED_FRONTS) {
        lines.push(std::format!(
            "  {:<9}{:>13.6}{:>13.6}{:>15}{:>15}{:>14}{:>14}",
            front.origin,
            // A compression wave into a resting bar starts from 0, not from -0.
            front.strain_ahead + 0.0,
            front.strain_behind + 0.0,
            format(front.stress_behind, Dimension::Stress, units),
            format(front.speed, Dimension::Velocity, units),
            front.speed_measured.map_or_else(unknown, |v| format(v, Dimension::Velocity, units)),
            front.position.map_or_else(unknown, |x| format(x, Dimension::Length, units)),
        ));
    }
    if fronts.len() > LISTED_FRONTS {
        lines.push(std::format!("  ... and {} more, listed by --json", fronts.len() - LISTED_FRONTS));
    }
    lines
}

//! `barwave run`: simulates one scene, shows how far it is, and sums up.

use std::fmt::Write as _;
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::summary::{choice_text, text};
use super::{interrupt, output};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::record::Summary;
use crate::record::store::{self, Existing, ResultFile};
use crate::run::{self, Progress};
use crate::scene::{ImpactScene, Problem};
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
    /// Estimate the error of the run; on a grid from coarser runs, about one third more computing time.
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

pub(crate) fn run(args: &Args) -> Result<()> {
    let every = args.checkpoint.as_ref().map(interval).transpose()?;
    if let Some(path) = &args.resume {
        nothing_beside_resume(args)?;
        return show(args, path, |progress| run::resume(path, every, progress));
    }
    let file = args.scene.as_deref().unwrap_or(Path::new("-"));
    let mut scene = match Problem::read(file, &args.overrides)? {
        Problem::Bar(scene) => *scene,
        Problem::Impact(scene) => return run_impact(args, &scene),
    };
    scene.solve.estimate_error = args.estimate_error;
    let path = output_path(args, &scene.name)?;
    show(args, &path, |progress| match every {
        Some(every) => run::run_with_checkpoints(&scene, &path, every, progress),
        None => run::run(&scene, Some(&path), progress),
    })
}

/// What a run is told to do while it is under way.
type OnProgress<'a> = &'a mut dyn FnMut(Progress) -> ControlFlow<()>;

/// Shows how far a run is, and sums up.
fn show(args: &Args, path: &Path, simulate: impl FnOnce(OnProgress<'_>) -> Result<Summary>) -> Result<()> {
    let stop = interrupt::flag();
    let bar = progress_bar(args.quiet || args.json);
    let before = if args.resume.is_some() { None } else { run_of(path) };
    let summary = simulate(&mut |at: Progress| {
        show_progress(&bar, &at, args.quiet || args.json);
        if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    bar.finish_and_clear();
    let shown = path.display();
    let summary = summary.inspect_err(|error| match error {
        Error::Interrupted => output::note(&interrupted(args, path, run_of(path) != before)),
        Error::Run(_) => output::note(&std::format!("the frames up to the error are in {shown}\n")),
        Error::Input(_) | Error::File { .. } | Error::Checks(_) => {}
    })?;
    if args.json {
        return output::json(&summary);
    }
    if args.quiet { Ok(()) } else { output::text(&text(&summary, args.units)) }
}

/// The run whose result is in a file, if there is one.
fn run_of(path: &Path) -> Option<String> {
    ResultFile::open(path).ok().map(|file| file.run_id())
}

/// What an interrupted run leaves, if it `began`, and how it is resumed.
fn interrupted(args: &Args, path: &Path, began: bool) -> String {
    let left = if began {
        std::format!("interrupted: the frames so far are in {}\n", path.display())
    } else {
        "interrupted before the run began\n".to_owned()
    };
    if args.checkpoint.is_none() && args.resume.is_none() {
        return left;
    }
    // An earlier result in the place of a run that has not begun may have a checkpoint, too.
    let kept = destination::resolve(path).is_ok_and(|place| store::checkpoint_path(&place).exists());
    if began && kept {
        return left + &std::format!("resume with: barwave run --resume {}\n", quoted(path));
    }
    left + "nothing can be resumed: the effects or the method were still being chosen\n"
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

/// An impact that is not waves in a bar.
fn run_impact(args: &Args, scene: &ImpactScene) -> Result<()> {
    let refused = [
        (args.checkpoint.is_some(), "--checkpoint", "is over in seconds, and keeps no checkpoints"),
        (args.estimate_error, "--estimate-error", "states its error by itself where it has one"),
    ];
    if let Some((_, key, why)) = refused.into_iter().find(|(given, ..)| *given) {
        let message = std::format!("a [{}] {why}", scene.problem.kind().replace("energy", "specimen"));
        return Err(InputError::new(message).key(key).help(std::format!("leave {key} out")).into());
    }
    let path = output_path(args, &scene.name)?;
    let (stop, bar) = (interrupt::flag(), progress_bar(args.quiet || args.json));
    bar.set_length(TICKS);
    let summary = run::run_impact(scene, Some(&path), &mut |part| {
        bar.set_position((TICKS as f64 * part) as u64);
        if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    bar.finish_and_clear();
    let summary = summary.inspect_err(|error| {
        if matches!(error, Error::Interrupted) {
            output::note(&std::format!("interrupted: the histories so far are in {}\n", path.display()));
        }
    })?;
    if args.json {
        return output::json(&summary);
    }
    if args.quiet { Ok(()) } else { output::text(&super::impact::text(&summary, args.units)) }
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

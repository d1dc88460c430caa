//! `barwave run`: simulates scenes, shows the progress and prints summaries.

use std::fmt::Write as _;
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, SystemTime};

use indicatif::{ProgressBar, ProgressStyle};

use super::summary::{choice_text, text};
use super::{interrupt, message, options, output};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::input::Document;
use crate::inputs;
use crate::record::store::{self, StoredScene};
use crate::record::{Summary, Tried};
use crate::run::{self, Progress};
use crate::scene::{ImpactScene, Problem};
use crate::text_file;
use crate::units::{Dimension, Quantity, System, format};

/// Options of `barwave run`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave run scene.toml\n  barwave run scene.toml --set solve.cells=4000 --set left.value=\"-40 \
                  m/s\" -o fine.h5\n  barwave run a.toml b.toml --output-dir results\n  barwave run results/a.h5 --set \
                  solve.cfl=0.5    # the scene stored in a result\n  barwave run - --json < scene.toml"
)]
#[expect(clippy::struct_excessive_bools, reason = "one a flag")]
pub(crate) struct Args {
    /// Scene files; `-` reads standard input. For a result file, its scene is run, with the materials and histories stored in the file. Each
    /// scene is run, even if another one fails.
    #[arg(value_name = "SCENE.toml|OUT.h5", required_unless_present = "resume")]
    scenes: Vec<PathBuf>,
    /// Result file of a single scene [default: `<scene name>.h5`, with --set `<scene name>_KEY=VALUE.h5`, in `runs/out` if there is a
    /// folder `runs`, else beside the scene]. Missing folders are created; an earlier result is replaced.
    #[arg(short, long, value_name = "OUT.h5")]
    output: Option<PathBuf>,
    /// Folder of the result files, under their default names.
    #[arg(long, value_name = "DIR", conflicts_with = "output")]
    output_dir: Option<PathBuf>,
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

/// Length of the progress bar of a run without time steps.
const TICKS: u64 = 1000;

/// Runs every scene and returns the largest exit code.
pub(crate) fn run(args: &Args) -> Result<u8> {
    let every = args.checkpoint.as_ref().map(interval).transpose()?;
    if let Some(path) = &args.resume {
        nothing_beside_resume(args)?;
        let ended = show(args, path, |progress| run::resume(path, every, progress)).map(|()| 0);
        return ended.map_err(|error| options::name(error, &[("output", "--checkpoint", "e.g. --checkpoint 60s")]));
    }
    if let [file] = &args.scenes[..] {
        return run_file(args, file, every, &mut Vec::new()).map(|()| 0);
    }
    one_output_each(args)?;
    let (mut code, mut outputs) = (0, Vec::new());
    for (index, file) in args.scenes.iter().enumerate() {
        if index > 0 && !args.json && !args.quiet {
            output::text("\n")?;
        }
        match run_file(args, file, every, &mut outputs) {
            Err(error @ Error::Interrupted) => return Err(error),
            Err(error) => {
                message::show_of(&error, file);
                code = code.max(error.exit_code());
            }
            Ok(()) => {}
        }
    }
    Ok(code)
}

fn one_output_each(args: &Args) -> Result<()> {
    let count = args.scenes.len();
    let refuse = |key: &str, message: String, help: &str| Err(InputError::new(message).key(key).help(help).into());
    if args.output.is_some() {
        let message = std::format!("one result file cannot hold the results of {count} scenes");
        return refuse("-o", message, "name a folder with --output-dir, or run one scene");
    }
    if args.scenes.iter().filter(|file| destination::is_stdout(file)).count() > 1 {
        return refuse("SCENE.toml", "standard input (`-`) can be read only once".into(), "name files");
    }
    Ok(())
}

/// Runs the scene of a file, or the one stored in a result file. `outputs` are the result files of earlier scenes; that of this scene is added.
fn run_file(args: &Args, file: &Path, every: Option<Duration>, outputs: &mut Vec<PathBuf>) -> Result<()> {
    if !text_file::is_hdf5(file) {
        let scene = Problem::read(file, &args.overrides)?;
        // The folder of a pipe cannot be written to, and its name is a number.
        let is_pipe = !destination::is_stdout(file) && !file.is_file();
        let folder = file.parent().filter(|_| !is_pipe).unwrap_or(Path::new(""));
        let stem = is_pipe.then(|| "scene".to_owned());
        return run_scene(args, scene, &default_output(args, folder, stem), every, outputs);
    }
    let stored = StoredScene::read(file)?;
    inputs::protect(file);
    let overrides = [&stored.overrides[..], &args.overrides].concat();
    let document = Document::new(std::format!("{}.toml", stored.name), stored.text);
    let folder = file.parent().unwrap_or(Path::new(""));
    let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let base = PathBuf::from(&stored.files.base).join(&document.file);
    log::info!("scene and {} files stored in {}", stored.files.texts.len(), file.display());
    // The stored files must be available during the run, too: it reads the scene again if it finds that an effect must be added.
    text_file::stored(stored.files, || {
        let scene = Problem::of_document(&document, &base, &overrides)?;
        run_scene(args, scene, &default_output(args, folder, Some(stem + "_rerun")), every, outputs)
    })
}

fn run_scene(
    args: &Args,
    scene: Problem,
    default: &dyn Fn(&str) -> PathBuf,
    every: Option<Duration>,
    outputs: &mut Vec<PathBuf>,
) -> Result<()> {
    let name = match &scene {
        Problem::Bar(scene) => &scene.name,
        Problem::Impact(scene) => &scene.name,
    };
    let path = args.output.clone().unwrap_or_else(|| default(name));
    check_output(&path, args.force)?;
    if outputs.contains(&path) {
        let message = std::format!("an earlier scene of this command has the result file {}", path.display());
        return Err(InputError::new(message).help("rename one of the scenes, or run them one by one with -o").into());
    }
    outputs.push(path.clone());
    let mut scene = match scene {
        Problem::Bar(scene) => *scene,
        Problem::Impact(scene) => return run_impact(args, &scene, &path),
    };
    scene.parts.solve.estimate_error = args.estimate_error;
    show(args, &path, |progress| run::to_checked_file(&scene, &path, every, progress))
}

/// Callback that receives the progress of a run and can stop it.
type OnProgress<'a> = &'a mut dyn FnMut(Progress) -> ControlFlow<()>;

/// Runs a simulation with a progress bar and prints its summary.
fn show(args: &Args, path: &Path, simulate: impl FnOnce(OnProgress<'_>) -> Result<Summary>) -> Result<()> {
    let stop = interrupt::flag();
    let bar = progress_bar(args.quiet || args.json);
    let before = if args.resume.is_some() { None } else { made_at(path) };
    let mut tried = None;
    let summary = simulate(&mut |at: Progress| {
        if let Progress::Tried { tried: now, tolerance } = &at {
            tried = Some(tried_text(now, *tolerance));
        }
        show_progress(&bar, &at, (!args.quiet && !args.json).then_some(args.units));
        if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    bar.finish_and_clear();
    let shown = path.display();
    let summary = summary.inspect_err(|error| match error {
        Error::Interrupted => output::remark(&interrupted(args, path, made_at(path) != before, tried.as_deref())),
        Error::Run(_) if made_at(path) != before => {
            output::remark(&std::format!("the frames up to the error are in {shown}\n"));
        }
        Error::Run(_) | Error::Input(_) | Error::File { .. } | Error::Checks(_) => {}
    })?;
    let (all, steps) = (summary.wall_s, summary.step_wall_s);
    log::info!("time steps {steps:.3} s, other {:.3} s", all - steps);
    if args.json {
        return print_json(args, &summary);
    }
    if args.quiet { Ok(()) } else { output::text(&text(&summary, args.units)) }
}

/// Prints a summary as one JSON object, on one line if there are several scenes.
fn print_json(args: &Args, summary: &impl serde::Serialize) -> Result<()> {
    if args.scenes.len() > 1 { output::json_line(summary) } else { output::json(summary) }
}

/// Returns the creation time of a file, or `None` if it does not exist. A run creates its result file before its first step.
fn made_at(path: &Path) -> Option<SystemTime> {
    let metadata = std::fs::metadata(path).ok()?;
    metadata.created().or_else(|_| metadata.modified()).ok()
}

/// Returns what an interrupted run leaves if it `began`, and how to resume it; `tried` is the last run made to select its method.
fn interrupted(args: &Args, path: &Path, began: bool, tried: Option<&str>) -> String {
    let left = match tried {
        _ if began => std::format!("interrupted: the frames so far are in {}\n", path.display()),
        Some(tried) => std::format!("interrupted while the method for `tolerance` was selected, after {tried}\n"),
        None => "interrupted before the run began\n".to_owned(),
    };
    if args.checkpoint.is_none() && args.resume.is_none() {
        return left;
    }
    // An earlier result at this path, which a run that has not begun leaves in place, may have a checkpoint, too.
    let kept = destination::resolve(path).is_ok_and(|place| store::checkpoint_path(&place).exists());
    if began && kept {
        return left + &std::format!("resume with: barwave run --resume {}\n", output::shell_word(path));
    }
    left + "nothing can be resumed: the effects or the method were still being chosen\n"
}

/// Refuses options that cannot be used with --resume, since the settings are those of the interrupted run.
fn nothing_beside_resume(args: &Args) -> Result<()> {
    let given = [
        (!args.scenes.is_empty(), "a scene"),
        (args.output.is_some(), "-o"),
        (args.output_dir.is_some(), "--output-dir"),
        (!args.overrides.is_empty(), "--set"),
        (args.estimate_error, "--estimate-error"),
        (args.force, "--force"),
    ];
    let Some((_, what)) = given.into_iter().find(|(given, _)| *given) else { return Ok(()) };
    let message = std::format!("{what} cannot be used with --resume: the settings are those of the interrupted run");
    let help = "remove it, or run the scene from the start without --resume";
    Err(InputError::new(message).key("--resume").help(help).into())
}

/// Returns the wall time between two checkpoints.
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

/// Runs an impact problem without waves in a bar.
fn run_impact(args: &Args, scene: &ImpactScene, path: &Path) -> Result<()> {
    let refused = [
        (args.checkpoint.is_some(), "--checkpoint", "scene is solved in seconds and has no checkpoints"),
        (args.estimate_error, "--estimate-error", "scene has no cells whose error could be estimated"),
    ];
    if let Some((_, key, why)) = refused.into_iter().find(|(given, ..)| *given) {
        let message = std::format!("a [{}] {why}", scene.problem.kind().replace("energy", "specimen"));
        return Err(InputError::new(message).key(key).help(std::format!("remove {key}")).into());
    }
    let (stop, bar) = (interrupt::flag(), progress_bar(args.quiet || args.json));
    bar.set_length(TICKS);
    let summary = run::impact_to_checked_file(scene, Some(path), &mut |part| {
        bar.set_position((TICKS as f64 * part) as u64);
        if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    bar.finish_and_clear();
    let summary = summary.inspect_err(|error| {
        if matches!(error, Error::Interrupted) {
            output::remark(&std::format!("interrupted: the histories so far are in {}\n", path.display()));
        }
    })?;
    if args.json {
        return print_json(args, &summary);
    }
    if args.quiet { Ok(()) } else { output::text(&super::impact::text(&summary, args.units)) }
}

/// Returns a function from the name of a scene to its default result file; `stem`, if given, replaces the name.
fn default_output<'a>(args: &'a Args, scene_folder: &'a Path, stem: Option<String>) -> impl Fn(&str) -> PathBuf + 'a {
    let folder = args.output_dir.clone().unwrap_or_else(|| output::default_folder(scene_folder));
    move |name| folder.join(default_name(stem.as_deref().unwrap_or(name), &args.overrides))
}

/// Returns `a.h5` for the scene a, and `a_solve.cells=2000.h5` with an override. Characters with a special meaning in shells or file systems
/// become `-`. If there are any, or if the name is long, a hash of the overrides as typed keeps the names of different runs distinct.
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

/// Returns the FNV-1a hash of texts, each terminated by a zero byte.
fn code(texts: &[String]) -> u32 {
    let bytes = texts.iter().flat_map(|text| text.bytes().chain(std::iter::once(0)));
    bytes.fold(0x811c_9dc5, |hash: u32, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

/// Checks that the output can be written; it replaces an existing file only if that is a result file or with `force`.
fn check_output(output: &Path, force: bool) -> Result<()> {
    if destination::is_stdout(output) {
        let message = "a result file (HDF5) cannot be written to standard output";
        return Err(InputError::new(message).key("-o").help("give a file name, such as result.h5").into());
    }
    destination::resolve(output)?;
    store::check_output(output, force).map_err(|error| {
        let options = "-o names another file, --force replaces one that is not a result";
        let help = std::format!("{}; {options}", error.help);
        error.help(help).into()
    })
}

/// Returns a progress bar on stderr if that is a terminal, otherwise a hidden one.
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

/// Time after which the runs made to select a method are reported, s.
const LONG_SEARCH: f64 = 1.0;

/// Describes a run made to select the method: "leapfrog with 256 cells (estimated error 3.1e-2, tolerance 1e-3)".
fn tried_text(tried: &Tried, tolerance: f64) -> String {
    let estimate = tried.estimate.map_or_else(|| "unknown".to_owned(), |estimate| std::format!("{estimate:.1e}"));
    std::format!("{} (estimated error {estimate}, tolerance {tolerance:e})", tried.by)
}

/// Updates the progress bar, and reports choices in `units`. A quiet run has no `units` and reports no choices.
fn show_progress(bar: &ProgressBar, at: &Progress, units: Option<System>) {
    if let Progress::Chosen(choice) = &at {
        if let Some(units) = units {
            bar.suspend(|| output::note(&std::format!("auto: {}\n", choice_text(choice, units))));
        }
        return;
    }
    if let Progress::Tried { tried, tolerance } = &at {
        if units.is_some() && bar.elapsed().as_secs_f64() > LONG_SEARCH {
            bar.suspend(|| output::note(&std::format!("tolerance: {}\n", tried_text(tried, *tolerance))));
        }
        return;
    }
    if bar.is_hidden() {
        return;
    }
    let seconds = bar.elapsed().as_secs_f64().max(1e-9);
    match *at {
        Progress::Chosen(_) | Progress::Tried { .. } => {}
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
            bar.set_message(std::format!("t = {time}  {events} events  {fronts} active fronts"));
        }
    }
}

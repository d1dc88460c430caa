//! `barwave sweep`: runs a scene along axes of its keys.

use std::fmt::Write as _;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use super::{interrupt, options, output};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::report::{self, plot};
use crate::study::sweep::{self, Finished, Row, Shard, Sweep};

/// Options of `barwave sweep`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave sweep speeds.toml -o speeds --plot speeds.svg\n  barwave sweep speeds.toml -o speeds \
                  --resume\n  \
                        barwave sweep speeds.toml -o speeds --shard 2/4    # then: barwave merge speeds -o speeds.h5"
)]
pub(crate) struct Args {
    /// The sweep file: a scene, and the keys of it that vary; `-` reads standard input.
    #[arg(value_name = "SWEEP.toml")]
    sweep: PathBuf,
    /// Folder of the results [default: the name of the sweep, in `runs/out` if a folder `runs` exists, else beside the sweep file];
    /// created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Run shard I of N of the cases, into the folder `shard-I-of-N` inside DIR [default: from the environment of a Slurm job array or MPI, else all cases].
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Figure of the metrics against the longest axis (.svg, .png, .pdf, .html); default metrics if the sweep file names none.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Continue a sweep that was stopped or killed: run only the cases that have no row yet.
    #[arg(long)]
    resume: bool,
    /// Print every row as a line of JSON as its case ends, and nothing else.
    #[arg(long)]
    json: bool,
    /// No progress bar and no summary.
    #[arg(long)]
    quiet: bool,
}

/// Library arguments that are set by command-line options.
pub(crate) const OPTIONS: &[options::OptionOf<'static>] = &[
    ("folder", "-o", "-o names the folder"),
    ("resume", "--resume", "--resume continues a sweep, -o names the folder"),
    ("shard", "--shard", ""),
];

pub(crate) fn run(args: &Args) -> Result<()> {
    let sweep = Sweep::read(&args.sweep)?;
    if let Some(path) = &args.plot {
        options::picture(path, "--plot")?;
        destination::resolve(path)?;
    }
    let silent = args.quiet || args.json;
    let shard = args.shard.map_or_else(|| shard_of_environment(silent), Ok)?;
    let folder = args
        .output
        .clone()
        .unwrap_or_else(|| output::default_folder(args.sweep.parent().unwrap_or(Path::new(""))).join(&sweep.name));
    if folder == Path::new("-") {
        let help = "give a folder, such as -o speeds";
        return Err(InputError::new("the results of a sweep cannot be written to standard output")
            .key("-o")
            .help(help)
            .into());
    }
    let folder = shard.folder().map_or(folder.clone(), |inside| folder.join(inside));
    let cases = (0..sweep.plan.cases()).filter(|case| shard.has(*case)).count();
    let bar = progress_bar(cases as u64, silent);
    let on_row = |row: &Row| {
        bar.inc(1);
        if args.json {
            // A closed pipe does not end the sweep: the rows are in the folder, too.
            let _ = output::json_line(&row.with_axes(&sweep.plan));
        }
    };
    let finished = sweep::run(&sweep, &folder, shard, args.resume, &on_row, &interrupt::flag());
    bar.finish_and_clear();
    let finished = finished.map_err(|error| options::name(error, OPTIONS));
    let finished = finished.inspect_err(|error| explain_interruption(error, &folder))?;
    let drawn = args.plot.as_ref().map_or(Ok(()), |path| draw(path, &sweep, &folder));
    for name in &finished.without_values {
        output::note(&format!(
            "warning: no case has the metric `{name}`; the names are those of `barwave run --json`\n"
        ));
    }
    if !silent {
        // The table exists even if there are no numbers to draw.
        let figure = args.plot.as_deref().filter(|_| drawn.is_ok());
        let said = summary(&finished, &folder, bar.elapsed().as_secs_f64(), figure);
        output::text_beside([figure], &said)?;
    }
    drawn
}

/// Draws all rows in the folder.
fn draw(path: &Path, sweep: &Sweep, folder: &Path) -> Result<()> {
    let title = format!("Sweep {}", sweep.name);
    let figure = report::sweep::figure(&title, &sweep.plan, &sweep::rows(folder)?).ok_or_else(|| {
        InputError::new("nothing to plot: no metric is numeric in two cases of a numeric axis")
            .key("--plot")
            .help("choose numeric metrics under [sweep] and a numeric axis")
    })?;
    plot::save(path, &title, &figure)
}

/// Remarks where the rows of an interrupted sweep are.
pub(crate) fn explain_interruption(error: &Error, folder: &Path) {
    if matches!(error, Error::Interrupted) {
        output::remark(&format!("interrupted: the rows so far are in {}; continue with --resume\n", folder.display()));
    }
}

fn shard_of_environment(silent: bool) -> Result<Shard> {
    let found = Shard::of_environment(|name| std::env::var(name).ok())
        .map_err(|message| InputError::new(message).help("number them from 1 to N, or give --shard I/N"))?;
    let Some((shard, variables)) = found else { return Ok(Shard::WHOLE) };
    if !silent {
        output::note(&format!("shard {} of {}, from {variables}\n", shard.index, shard.count));
    }
    Ok(shard)
}

pub(crate) fn progress_bar(cases: u64, silent: bool) -> ProgressBar {
    if silent || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(cases);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos} of {len} cases  {rate} cases/s  {eta} left") {
        bar.set_style(style.with_key("rate", |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            let _ = text.write_str(&rate_text(state.per_sec()));
        }));
    }
    bar
}

fn summary(finished: &Finished, folder: &Path, seconds: f64, figure: Option<&Path>) -> String {
    let all: usize = finished.statuses.values().sum();
    let statuses: Vec<String> = finished.statuses.iter().map(|(name, count)| format!("{count} {name}")).collect();
    let mut text = format!("{}: {}\n", output::counted(all, "case"), statuses.join(", "));
    // Writing to a String cannot fail.
    if let Some((reason, count)) = &finished.commonest_reason {
        let _ = writeln!(text, "  reason  of {}: {reason}", output::counted(*count, "case"));
    }
    if finished.run > 0 {
        let rate = finished.run as f64 / seconds.max(1e-9);
        let run = if finished.run == all { String::new() } else { format!(" for {} of them", finished.run) };
        let _ = writeln!(text, "  time    {seconds:.3} s{run} ({} cases/s)", rate_text(rate));
    }
    let _ = writeln!(text, "  table   {}", folder.join("table.csv").display());
    let _ = writeln!(text, "  HDF5    {}", folder.join("sweep.h5").display());
    if let Some(figure) = figure {
        let _ = writeln!(text, "  figure  {}", figure.display());
    }
    text
}

/// Returns the number of cases per second, with decimals if it is below 10.
fn rate_text(rate: f64) -> String {
    if rate < 10.0 { format!("{rate:.2}") } else { format!("{rate:.0}") }
}

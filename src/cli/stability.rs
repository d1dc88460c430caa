//! `barwave stability`: the hard cases by every method.

use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use super::scratch::Scratch;
use super::{interrupt, output};
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::study::hard_cases::{CASES, HardCase, Method, Tried, run_case};

/// Options of `barwave stability`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  barwave stability\n  barwave stability --show\n  barwave stability -o hard-cases.md"
)]
pub(crate) struct Args {
    /// Cases, by the first characters of their names (default: all).
    #[arg(value_name = "CASE")]
    cases: Vec<String>,
    /// Output file: table and explanation of every case as Markdown.
    #[arg(short, long, value_name = "FILE.md")]
    output: Option<PathBuf>,
    /// Print the scene file of the cases and run nothing.
    #[arg(long)]
    show: bool,
    /// Print a JSON list on stdout and nothing else.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<()> {
    let cases = select(&args.cases)?;
    if args.show {
        return cases.iter().try_for_each(|case| output::text(&format!("{}\n", case.text())));
    }
    if let Some(path) = args.output.as_deref().filter(|path| !output::has_ending(path, "md")) {
        let error = InputError::new(format!("`{}` is not the name of a Markdown file", path.display())).key("-o");
        return Err(error.allowed("a file name ending in .md, or `-`").help("e.g. -o hard-cases.md").into());
    }
    output::check(args.json, [args.output.as_deref()])?;
    let tried = try_all(&cases, !args.json && args.output.as_deref() != Some(Path::new("-")))?;
    if let Some(path) = &args.output {
        destination::write_whole(path, markdown(&cases, &tried).as_bytes())?;
    }
    if args.json {
        output::json_list(&tried)?;
    }
    let failed = tried.iter().filter(|tried| !tried.failed.is_empty()).count();
    if failed > 0 {
        return Err(Error::Checks(format!("{failed} of {} runs failed a check", tried.len())));
    }
    Ok(())
}

fn select(names: &[String]) -> Result<Vec<&'static HardCase>> {
    let known = |name: &String| CASES.iter().any(|case| case.name.starts_with(name.as_str()));
    if let Some(wrong) = names.iter().find(|name| !known(name)) {
        let all: Vec<&str> = CASES.iter().map(|case| case.name).collect();
        let error = InputError::new(format!("unknown hard case `{wrong}`")).key("CASE");
        return Err(error.help(format!("the cases are: {}", all.join(", "))).into());
    }
    let wanted = |case: &&HardCase| names.is_empty() || names.iter().any(|name| case.name.starts_with(name.as_str()));
    Ok(CASES.iter().filter(wanted).collect())
}

fn try_all(cases: &[&'static HardCase], shows: bool) -> Result<Vec<Tried>> {
    let stop = interrupt::flag();
    let folder = Scratch::new("stability")?;
    let mut tried = Vec::new();
    for case in cases {
        for method in Method::ALL {
            let mut progress =
                |_| if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
            let one = run_case(case, method, folder.path(), &mut progress).inspect_err(|error| {
                if matches!(error, Error::Interrupted) {
                    output::remark("interrupted: nothing is kept\n");
                }
            })?;
            if shows {
                output::text(&line(&one))?;
            }
            tried.push(one);
        }
    }
    Ok(tried)
}

/// Returns a run as one line, followed by one line for each known deviation and each failed check.
fn line(tried: &Tried) -> String {
    let mut text = format!("{:<44}{:<17}{}", tried.case, tried.method.name(), outcome(tried));
    if !tried.reason.is_empty() {
        let _ = write!(text, ": {}", tried.reason);
    }
    for stated in &tried.stated {
        let _ = write!(text, "\n    {stated}");
    }
    for failed in &tried.failed {
        let _ = write!(text, "\n    failed: {failed}");
    }
    text + "\n"
}

/// Residuals below this are not distinguished: they are rounding errors, which depend on the processor.
const CLOSED: f64 = 1e-9;

/// Returns the outcome, a power of ten above the energy residual, and the differences between the results on three grids.
fn outcome(tried: &Tried) -> String {
    let Some(residual) = tried.energy_residual else { return tried.outcome.clone() };
    let power = residual.max(CLOSED).log10().ceil();
    let mut text = format!("{}, residual < 1e{power}", tried.outcome);
    match tried.differences {
        Some([0.0, 0.0]) => text += ", exact",
        // Writing to a String cannot fail.
        Some([first, second]) if second < first => drop(write!(text, ", differences {first:.0e}, {second:.0e}")),
        _ => text += ", no convergence",
    }
    text
}

const HEADING: &str = "# Hard cases\n\nWritten by `barwave stability`. Every scene is run with every method \
                       that accepts it. `barwave stability CASE --show` prints a scene.";
const CHECKED: &str = "Checks: all numbers are finite; kinetic, elastic and stored energies are not negative; dissipated energies \
                       do not decrease; the energy residual is at most 1e-6; the method adds at most 1 % of the energy to the \
                       bar; fields stay within the bounds stated in the scene.";
const VARIATION: &str = "The total variation does not grow (muscl and moc). Applies to a bar of one uniform \
                         segment with one free end, the other loaded at t = 0 by a constant velocity, a constant stress or a wall: \
                         the sums of the jumps of stress and of velocity along the bar are at most 1.01 times the jumps imposed at \
                         t = 0. Reflections at such ends do not increase them. Leapfrog is not monotone and is exempt.";
const CONVERGENCE: &str = "The results converge. Of three runs, with N, 2N and 4N cells or with the front tolerances t, t/2 and \
                           t/4, the mean difference in stress at the end time, relative to the largest stress (or rho c0 v), is \
                           smaller between the second and the third than between the first and the second. 4N is the number of \
                           cells of the scene unless the scene states otherwise. The table lists both differences; below 1e-9 \
                           the result is exact. Where a check fails, the case states the reason.";
const TABLE: &str = "| case | leapfrog | muscl | moc |\n|---|---|---|---|\n";

/// Returns the page of the documentation.
fn markdown(cases: &[&'static HardCase], tried: &[Tried]) -> String {
    let mut text = format!("{HEADING}\n\n{CHECKED}\n\n{VARIATION}\n\n{CONVERGENCE}\n\n{TABLE}");
    let cell = |tried: &Tried| {
        let failed = if tried.failed.is_empty() { String::new() } else { format!("; **{}**", tried.failed.join("; ")) };
        format!("{}{failed}", outcome(tried))
    };
    let of = |case: &HardCase| tried.iter().filter(|tried| tried.case == case.name).collect::<Vec<_>>();
    for case in cases {
        let cells: Vec<String> = of(case).into_iter().map(cell).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "| [{0}](#{0}) | {1} |", case.name, cells.join(" | "));
    }
    for case in cases {
        let _ = writeln!(text, "\n## {}\n\n{}", case.name, case.explanation());
        for bound in case.bounds() {
            let _ = writeln!(text, "\nBound: {} at most {}.", bound.field, bound.value);
        }
        for tried in of(case).into_iter().filter(|tried| !tried.reason.is_empty()) {
            let _ = writeln!(text, "\n{}: {}: {}.", tried.method.name(), tried.outcome, tried.reason);
        }
        for tried in of(case) {
            for stated in &tried.stated {
                let _ = writeln!(text, "\n{}: {stated}.", tried.method.name());
            }
        }
    }
    text
}

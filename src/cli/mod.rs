//! The command line: one file per command, and the list of commands.

mod check;
mod compare;
mod compare_results;
mod cost;
mod critical;
mod details;
mod file_limit;
mod impact;
mod impact_cost;
mod interrupt;
mod invert;
mod lines;
mod materials;
mod merge;
mod message;
mod new;
mod options;
mod output;
mod plan;
mod quantity;
mod report;
mod result_file;
mod run;
mod scratch;
mod settings;
mod shell;
mod stability;
mod study;
mod summary;
mod sweep;
mod width;

use std::process::ExitCode;

use clap::builder::ValueParser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand, value_parser};

use crate::error::{InputError, Result};
use crate::units::Quantity;

/// Heading of the options of all commands; without it, clap lists them among the options of each command.
const OF_ALL: &str = "Options of all commands";

/// 1D elastic-plastic waves in bars: plastic wave fronts, critical impact velocity, HDF5 fields.
#[derive(Debug, Parser)]
#[command(name = "barwave", version, propagate_version = true)]
#[command(
    after_help = "Examples:\n  barwave new my-bar\n  barwave run my-bar.toml\n  barwave report my-bar.h5 -o my-bar.html\n  \
                  barwave critical copper-annealed"
)]
pub(crate) struct Cli {
    /// Threads to use, 1 to 1024 (default: all; also `RAYON_NUM_THREADS`). Results do not depend on it.
    #[arg(long, global = true, value_name = "N", help_heading = OF_ALL)]
    threads: Option<usize>,
    /// Print results as JSON and nothing else; errors are JSON on stderr.
    #[arg(long, global = true, help_heading = OF_ALL)]
    json: bool,
    /// Colours of messages.
    #[arg(
        long,
        global = true,
        help_heading = OF_ALL,
        value_enum,
        value_name = "WHEN",
        default_value = "auto",
        hide_possible_values = true,
        help = "Colours of messages: auto, always or never [default: auto]",
        hide_default_value = true
    )]
    color: settings::Color,
    /// Print the files read and written, and computing times, on stderr.
    #[arg(short, long, global = true, help_heading = OF_ALL)]
    verbose: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Simulate one scene and write its result file.
    Run(run::Args),
    /// Show what a run would do and what it would cost; writes nothing.
    Plan(plan::Args),
    /// Validate scenes and materials.
    Check(check::Args),
    /// Critical impact velocity from the curve.
    Critical(critical::Args),
    /// Materials side by side: curves, wave speeds, impact velocities; or result files: norms of their differences.
    Compare(compare::Args),
    /// Error against computing time, for every method that can run a scene.
    Cost(cost::Args),
    /// Run the hard cases by every method and check every result.
    Stability(stability::Args),
    /// Run a scene many times along axes of its keys, into one table.
    Sweep(sweep::Args),
    /// Run a classical experiment: impact velocities, table and figure.
    Study(study::Args),
    /// Join the shards of a sweep into one table.
    Merge(merge::Args),
    /// Curves from measurements: arrival times, residual strain, split-Hopkinson gauges.
    Invert(invert::Args),
    /// Draw a result file: x-t diagram, profiles, gauges, fronts, ledger, audit.
    Report(report::Args),
    /// List, show and import materials.
    Materials(materials::Args),
    /// Write a commented scene to start from.
    New(new::Args),
    /// Write shell completions.
    Completions(shell::CompletionsArgs),
    /// Write man pages.
    Man(shell::ManArgs),
    /// Write the JSON schema of scene, material or sweep files.
    Schema(shell::SchemaArgs),
}

/// Runs the command line of this process and returns its exit code.
pub fn main() -> ExitCode {
    settings::read(std::env::args_os());
    file_limit::report_as_error();
    if settings::verbose() {
        details::show();
    }
    let parsed = with_signs(Cli::command()).color(settings::parser_colors()).try_get_matches();
    let cli = match parsed.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => return usage(&with_subcommands(error)),
    };
    match dispatch(&cli) {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            message::show(&error);
            ExitCode::from(error.exit_code())
        }
    }
}

/// Makes numeric options accept a minus sign, so that a negative value is answered with the allowed range.
fn with_signs(command: clap::Command) -> clap::Command {
    let numbers = [ValueParser::from(value_parser!(f64)), ValueParser::from(value_parser!(Quantity))];
    let is_number = |arg: &Arg| {
        arg.get_long().is_some() && numbers.iter().any(|of| of.type_id() == arg.get_value_parser().type_id())
    };
    let command = command.mut_args(|arg| if is_number(&arg) { arg.allow_hyphen_values(true) } else { arg });
    command.mut_subcommands(with_signs)
}

/// Adds the subcommands of the command that was given to the error that it has none of this name.
fn with_subcommands(mut error: clap::Error) -> clap::Error {
    if error.kind() != ErrorKind::InvalidSubcommand || error.get(ContextKind::SuggestedSubcommand).is_some() {
        return error;
    }
    let top = Cli::command();
    let given = std::env::args().find_map(|word| top.find_subcommand(word).filter(|command| command.has_subcommands()));
    if let Some(command) = given {
        let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        let tip = format!("`barwave {}` has the subcommands {}", command.get_name(), names.join(", "));
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

/// Prints help, the version, or a usage error, and returns the exit code.
fn usage(error: &clap::Error) -> ExitCode {
    if error.use_stderr() && settings::json() {
        message::show_usage(error);
    } else {
        // A closed pipe is not an error.
        let _ = error.print();
    }
    u8::try_from(error.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from)
}

/// Largest number of threads, and the stack size that the system reserves for each, bytes.
const MOST_THREADS: usize = 1024;
const STACK: f64 = 2.0 * 1024.0 * 1024.0;

const OPTION: &str = "--threads";

/// Creates the thread pool; `key` is the option or variable that sets the number. In the environment variable, 0 means all processors.
fn use_threads(key: &str, threads: usize) -> Result<()> {
    if threads > MOST_THREADS || threads == 0 && key == OPTION {
        let gib = threads as f64 * STACK / (1024.0 * 1024.0 * 1024.0);
        let error = InputError::new(match threads {
            0 => "0 threads compute nothing".to_owned(),
            _ => format!("{threads} threads would reserve {gib:.0} GiB of memory for their stacks"),
        });
        let allowed = format!("1 <= threads <= {MOST_THREADS}");
        return Err(error.key(key).allowed(allowed).help("use at most one thread per core, or omit the option").into());
    }
    let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    built.map_err(|e| {
        InputError::new(format!("cannot start {threads} threads: {e}")).key(key).help("use fewer threads").into()
    })
}

/// Runs the command. A command that has already printed its message returns a nonzero exit code instead of an error.
fn dispatch(cli: &Cli) -> Result<u8> {
    let variable = || std::env::var("RAYON_NUM_THREADS").ok()?.trim().parse().ok().map(|n| ("RAYON_NUM_THREADS", n));
    if let Some((key, threads)) = cli.threads.map(|n| (OPTION, n)).or_else(variable) {
        use_threads(key, threads)?;
    }
    log::info!("{}, {} threads", output::program(), rayon::current_num_threads());
    if let Command::Run(args) = &cli.command {
        return run::run(args);
    }
    other_commands(&cli.command).map(|()| 0)
}

fn other_commands(command: &Command) -> Result<()> {
    match command {
        Command::Run(args) => run::run(args).map(|_| ()),
        Command::Plan(args) => plan::run(args),
        Command::Check(args) => check::run(args),
        Command::Critical(args) => critical::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Cost(args) => cost::run(args),
        Command::Stability(args) => stability::run(args),
        Command::Sweep(args) => sweep::run(args),
        Command::Study(args) => study::run(args),
        Command::Merge(args) => merge::run(args),
        Command::Invert(args) => invert::run(args),
        Command::Report(args) => report::run(args),
        Command::Materials(args) => materials::run(args),
        Command::New(args) => new::run(args),
        Command::Completions(args) => shell::completions(args),
        Command::Man(args) => shell::man(args),
        Command::Schema(args) => shell::schema(args),
    }
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};

    use super::Cli;

    /// Splits a line into words as a shell does, and omits redirections.
    fn words(line: &str) -> Vec<String> {
        let (mut words, mut quote, mut word) = (Vec::new(), None, String::new());
        for c in line.chars() {
            match c {
                '#' | '<' | '>' | '|' if quote.is_none() => break,
                '"' | '\'' if quote.is_none() => quote = Some(c),
                _ if quote == Some(c) => quote = None,
                ' ' if quote.is_none() => words.extend(Some(std::mem::take(&mut word)).filter(|w| !w.is_empty())),
                _ => word.push(c),
            }
        }
        words.extend(Some(word).filter(|w| !w.is_empty()));
        words
    }

    fn check_examples(command: &clap::Command) -> usize {
        let examples = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        // As in a shell, a line that ends in a backslash continues on the next line.
        let joined = examples.replace("\\\n", "");
        let lines: Vec<&str> = joined.lines().skip(1).collect();
        // Three dots stand for omitted options.
        for line in lines.iter().filter(|line| !line.contains(" ... ")) {
            let parsed = Cli::try_parse_from(words(line));
            let is_help = |e: &clap::Error| e.kind() == clap::error::ErrorKind::DisplayHelp;
            assert!(parsed.as_ref().err().is_none_or(is_help), "{line}: {:?}", parsed.err());
        }
        lines.len() + command.get_subcommands().map(check_examples).sum::<usize>()
    }

    #[test]
    fn examples_of_the_help_are_accepted() {
        Cli::command().debug_assert();
        assert!(check_examples(&Cli::command()) > 40);
    }
}

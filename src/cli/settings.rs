//! Options common to all commands.
//!
//! They are read from the raw command line, since they also apply to usage errors, for which there are no parsed arguments.

use std::ffi::OsString;
use std::io::IsTerminal;
use std::sync::OnceLock;

/// Options given on the command line.
#[derive(Debug, Clone, Copy, Default)]
struct Settings {
    json: bool,
    verbose: bool,
    color: Color,
}

/// When messages have colours.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Color {
    /// On a terminal, unless `NO_COLOR` is set.
    #[default]
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

static SETTINGS: OnceLock<Settings> = OnceLock::new();

/// Stores the options of a command line.
pub(super) fn read(typed: impl Iterator<Item = OsString>) {
    // A process has one command line.
    let _ = SETTINGS.set(of(typed));
}

fn of(typed: impl Iterator<Item = OsString>) -> Settings {
    let typed: Vec<String> =
        typed.map(|one| one.to_string_lossy().into_owned()).take_while(|one| one != "--").collect();
    let after = typed.iter().position(|one| one == "--color").and_then(|at| typed.get(at + 1)).map(String::as_str);
    let color = after.or_else(|| typed.iter().find_map(|one| one.strip_prefix("--color=")));
    Settings {
        json: typed.iter().any(|one| one == "--json"),
        verbose: typed.iter().any(|one| one == "-v" || one == "--verbose"),
        color: match color {
            Some("always") => Color::Always,
            Some("never") => Color::Never,
            _ => Color::Auto,
        },
    }
}

fn settings() -> Settings {
    SETTINGS.get().copied().unwrap_or_default()
}

/// Returns true if results and errors are written as JSON.
pub(super) fn json() -> bool {
    settings().json
}

/// Returns true if details are shown.
pub(super) fn verbose() -> bool {
    settings().verbose
}

/// Returns true if messages on stderr have colours.
pub(super) fn colors() -> bool {
    match settings().color {
        Color::Always => true,
        Color::Never => false,
        Color::Auto => {
            let no_color = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
            let dumb = std::env::var_os("TERM").is_some_and(|v| v == "dumb");
            std::io::stderr().is_terminal() && !no_color && !dumb
        }
    }
}

/// Returns the setting for the help and the usage errors of the parser.
pub(super) fn parser_colors() -> clap::ColorChoice {
    match settings().color {
        Color::Always => clap::ColorChoice::Always,
        Color::Never => clap::ColorChoice::Never,
        Color::Auto => clap::ColorChoice::Auto,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_found_anywhere_but_behind_the_end_of_options() {
        let of = |line: &str| of(line.split(' ').map(OsString::from));
        assert!(of("barwave --json run a.toml").json && of("barwave run a.toml --json").json);
        assert!(!of("barwave run -- --json").json && of("barwave -v run").verbose);
        assert_eq!((of("b --color=always").color, of("b run --color never").color), (Color::Always, Color::Never));
    }
}

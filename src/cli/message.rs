//! Errors on stderr: what, where with the line of the file, the allowed range, and a help line.

use std::fmt::Write as _;
use std::path::Path;

use serde::Serialize;

use super::{output, settings};
use crate::error::{Error, InputError, Place};

/// Writes an error to stderr; with `--json` as an object.
pub(super) fn show(error: &Error) {
    if settings::json() {
        return output::json_note(&Failure { error: error.into() });
    }
    output::note(&render(error, Paint(settings::colors())));
}

/// The same of one of several files: an error without a place of its own gets its name.
pub(super) fn show_of(error: &Error, file: &Path) {
    if settings::json() {
        let error = Details { input: Some(file.display().to_string()), ..error.into() };
        return output::json_note(&Failure { error });
    }
    output::note(&format!("{}: ", file.display()));
    show(error);
}

/// Writes a usage error to stderr as an object.
pub(super) fn show_usage(error: &clap::Error) {
    let text = error.render().to_string();
    // The first paragraph: which arguments are missing stands in lines of their own.
    let lines = text.lines().take_while(|line| !line.trim().is_empty()).map(str::trim);
    let message = lines.collect::<Vec<_>>().join(" ").trim_start_matches("error: ").to_owned();
    let code = u8::try_from(error.exit_code()).unwrap_or(1);
    let help = Some("`barwave --help` lists the commands, `barwave COMMAND --help` their options".to_owned());
    output::json_note(&Failure { error: Details { message, help, ..Details::of_kind("usage", code) } });
}

/// An error as JSON.
#[derive(Debug, Serialize)]
struct Failure {
    error: Details,
}

/// What is known of an error.
#[derive(Debug, Default, Serialize)]
struct Details {
    kind: &'static str,
    exit_code: u8,
    message: String,
    /// Which of several files was being worked on.
    #[serde(skip_serializing_if = "Option::is_none")]
    input: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    key: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    column: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    allowed: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    time_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    x_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    help: Option<String>,
    /// What is left behind, and how to go on.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
}

impl Details {
    fn of_kind(kind: &'static str, exit_code: u8) -> Self {
        Self { kind, exit_code, notes: output::take_remarks(), ..Self::default() }
    }
}

impl From<&Error> for Details {
    fn from(error: &Error) -> Self {
        let some = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        let kind = |kind| Self { message: error.to_string(), ..Self::of_kind(kind, error.exit_code()) };
        match error {
            Error::Input(input) => Self {
                message: input.message.clone(),
                key: some(&input.key),
                file: input.place.as_ref().map(|place| place.file.clone()),
                line: input.place.as_ref().map(|place| place.line()),
                column: input.place.as_ref().map(|place| column(place) + 1),
                allowed: some(&input.allowed),
                help: some(&input.help),
                ..kind("input")
            },
            Error::Run(run) => Self {
                message: run.reason.clone(),
                time_s: Some(run.time),
                x_m: run.x,
                help: some(&run.help),
                ..kind("run")
            },
            Error::File { path, reason } => {
                Self { message: reason.clone(), file: Some(path.display().to_string()), ..kind("file") }
            }
            Error::Checks(_) => kind("checks"),
            Error::Interrupted => kind("interrupted"),
        }
    }
}

/// ANSI colours, or none.
#[derive(Debug, Clone, Copy)]
struct Paint(bool);

impl Paint {
    fn with(self, code: &str, text: &str) -> String {
        if self.0 { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
    }

    fn red(self, text: &str) -> String {
        self.with("1;31", text)
    }

    fn blue(self, text: &str) -> String {
        self.with("1;34", text)
    }

    fn green(self, text: &str) -> String {
        self.with("1;32", text)
    }
}

fn render(error: &Error, paint: Paint) -> String {
    match error {
        Error::Input(input) => render_input(input, paint),
        Error::Run(run) => format!("{}: {run}\n{}", paint.red("error"), help_line(&run.help, paint)),
        // No error: the command that was interrupted has said what it leaves behind.
        Error::Interrupted => String::new(),
        Error::File { .. } | Error::Checks(_) => format!("{}: {error}\n", paint.red("error")),
    }
}

fn render_input(error: &InputError, paint: Paint) -> String {
    let key = if error.key.is_empty() { String::new() } else { format!("`{}`: ", error.key) };
    let mut text = format!("{}: {key}{}\n", paint.red("error"), error.message);
    let gutter = match &error.place {
        Some(place) => snippet(&mut text, place, paint),
        None => 0,
    };
    if !error.allowed.is_empty() {
        let mark = if gutter == 0 { String::new() } else { " ".repeat(gutter) + &paint.blue("= ") };
        let _ = writeln!(text, "{mark}allowed: {}", error.allowed);
    }
    text + &help_line(&error.help, paint)
}

fn help_line(help: &str, paint: Paint) -> String {
    if help.is_empty() { String::new() } else { format!("{}: {help}\n", paint.green("help")) }
}

/// Adds the place, the line, and a mark under the span; returns the width of the gutter.
fn snippet(text: &mut String, place: &Place, paint: Paint) -> usize {
    let (start, end) = line_bounds(place);
    let number = place.line().to_string();
    let column = column(place);
    let width = number.len() + 1;
    let (bar, blank) = (paint.blue("|"), " ".repeat(width));
    let _ = writeln!(text, "{}{} {}:{number}:{}", " ".repeat(number.len()), paint.blue("-->"), place.file, column + 1);
    let _ = writeln!(text, "{blank}{bar}");
    let stop = floor(&place.text, place.span.end.min(end)).max(start);
    let marked = place.text[start..stop].chars().count().saturating_sub(column).max(1);
    let (line, column) = clip(&place.text[start..end], column);
    let _ = writeln!(text, "{} {bar} {line}", paint.blue(&number));
    // Tabs stay tabs, so that the mark stands under what it means.
    let lead: String = line.chars().take(column).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
    let marked = marked.min(line.chars().count().saturating_sub(column).max(1));
    let _ = writeln!(text, "{blank}{bar} {lead}{}", paint.red(&"^".repeat(marked)));
    width
}

/// Characters before the span in its line.
fn column(place: &Place) -> usize {
    place.text[line_bounds(place).0..floor(&place.text, place.span.start)].chars().count()
}

/// The part of a very long line around a column, and that column in it.
fn clip(line: &str, column: usize) -> (String, usize) {
    const WIDEST: usize = 160;
    const BEFORE: usize = 60;
    if line.chars().nth(WIDEST).is_none() {
        return (line.to_owned(), column);
    }
    let first = column.saturating_sub(BEFORE);
    let part: String = line.chars().skip(first).take(WIDEST).collect();
    let lead = if first > 0 { "..." } else { "" };
    let tail = if line.chars().nth(first + WIDEST).is_some() { "..." } else { "" };
    (format!("{lead}{part}{tail}"), column - first + lead.len())
}

/// Bytes of the line in which the span starts.
fn line_bounds(place: &Place) -> (usize, usize) {
    let at = floor(&place.text, place.span.start);
    let start = place.text[..at].rfind('\n').map_or(0, |i| i + 1);
    let end = place.text[at..].find(['\n', '\r']).map_or(place.text.len(), |i| at + i);
    (start, end)
}

/// The nearest character boundary at or before a byte.
fn floor(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(text: &str, span: std::ops::Range<usize>) -> Error {
        let place = Place { file: "a.toml".into(), text: text.into(), span };
        InputError::new("1.5 is out of range")
            .key("solve.cfl")
            .allowed("0 < cfl <= 1")
            .help("lower it")
            .at(place)
            .into()
    }

    #[test]
    fn the_line_is_shown_with_a_mark_under_the_value() {
        let shown = render(&input("[solve]\ncfl = 1.5 # µ\n", 14..17), Paint(false));
        let expected = "error: `solve.cfl`: 1.5 is out of range\n --> a.toml:2:7\n  |\n2 | cfl = 1.5 # µ\n  |       ^^^\n  \
                        = allowed: 0 < cfl <= 1\nhelp: lower it\n";
        assert_eq!(shown, expected);
    }

    #[test]
    fn odd_spans_are_answered() {
        let text = "µµ\tµ\r\nx";
        for start in 0..=text.len() + 2 {
            for end in start..=text.len() + 2 {
                assert!(render(&input(text, start..end), Paint(false)).contains('^'), "{start}..{end}");
            }
        }
        assert!(render(&input("", 0..0), Paint(true)).contains('^'));
    }
}

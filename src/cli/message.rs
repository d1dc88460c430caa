//! Errors on stderr: what, where with the line of the file, the allowed range, and a help line.

use std::fmt::Write as _;
use std::io::IsTerminal;

use super::output;
use crate::error::{Error, InputError, Place};

/// Writes an error to stderr, in colour on a terminal unless `NO_COLOR` is set.
pub(super) fn show(error: &Error) {
    let no_color = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|v| v == "dumb");
    let paint = Paint(std::io::stderr().is_terminal() && !no_color && !dumb);
    output::note(&render(error, paint));
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
    let column = place.text[start..floor(&place.text, place.span.start)].chars().count();
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

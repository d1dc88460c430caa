//! Error messages for people: what is wrong, where (with the line of the file), the allowed range, and a help line.

use std::fmt::Write as _;

use super::{Error, InputError, Place};

/// Whether text is coloured by ANSI escape codes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Paint(pub(crate) bool);

impl Paint {
    fn with(self, code: &str, text: &str) -> String {
        if self.0 { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
    }

    pub(crate) fn red(self, text: &str) -> String {
        self.with("1;31", text)
    }

    fn blue(self, text: &str) -> String {
        self.with("1;34", text)
    }

    fn green(self, text: &str) -> String {
        self.with("1;32", text)
    }
}

/// Returns all lines of an error, each with its line feed. Help for an interruption is left to the caller.
pub(crate) fn lines(error: &Error, paint: Paint) -> String {
    match error {
        Error::Input(input) => lines_of_input(input, paint),
        Error::Run(run) => format!("{run}\n{}", help_line(&run.help, paint)),
        Error::File { help, .. } => format!("{error}\n{}", help_line(help, paint)),
        Error::Checks(_) | Error::Interrupted => format!("{error}\n"),
    }
}

pub(super) fn lines_of_input(error: &InputError, paint: Paint) -> String {
    let key = if error.key.is_empty() { String::new() } else { format!("`{}`: ", error.key) };
    let mut text = format!("{key}{}\n", error.message);
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

/// Appends the position, the line of the file, and a mark under the span; returns the width of the gutter.
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
    // Tabs are kept, so that the mark is under the text that it refers to.
    let lead: String = line.chars().take(column).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
    let marked = marked.min(line.chars().count().saturating_sub(column).max(1));
    let _ = writeln!(text, "{blank}{bar} {lead}{}", paint.red(&"^".repeat(marked)));
    width
}

/// Returns the number of characters before the span on its line.
pub(crate) fn column(place: &Place) -> usize {
    place.text[line_bounds(place).0..floor(&place.text, place.span.start)].chars().count()
}

/// Returns the part of a very long line around a column, and the column within that part.
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

/// Returns the byte range of the line on which the span starts.
fn line_bounds(place: &Place) -> (usize, usize) {
    let at = floor(&place.text, place.span.start);
    let start = place.text[..at].rfind('\n').map_or(0, |i| i + 1);
    let end = place.text[at..].find(['\n', '\r']).map_or(place.text.len(), |i| at + i);
    (start, end)
}

/// Returns the nearest character boundary at or before a byte.
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
        let shown = input("[solve]\ncfl = 1.5 # µ\n", 14..17).text();
        let expected = "`solve.cfl`: 1.5 is out of range\n --> a.toml:2:7\n  |\n2 | cfl = 1.5 # µ\n  |       ^^^\n  \
                        = allowed: 0 < cfl <= 1\nhelp: lower it";
        assert_eq!(shown, expected);
    }

    #[test]
    fn odd_spans_are_answered() {
        let text = "µµ\tµ\r\nx";
        for start in 0..=text.len() + 2 {
            for end in start..=text.len() + 2 {
                assert!(lines(&input(text, start..end), Paint(false)).contains('^'), "{start}..{end}");
            }
        }
        assert!(lines(&input("", 0..0), Paint(true)).contains('^'));
    }
}

//! What commands write to stdout (plain text, aligned tables, JSON) and to stderr.

use std::io::Write;
use std::path::Path;

use crate::error::{Error, Result};

/// Writes text to stdout. A reader that has gone away (`barwave ... | head`) is no error.
pub(crate) fn text(text: &str) -> Result<()> {
    bytes(text.as_bytes())
}

/// Writes bytes to stdout, as [`text`] does.
pub(crate) fn bytes(bytes: &[u8]) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(Error::file(Path::new("stdout"), e)),
        _ => Ok(()),
    }
}

/// Writes lines to stderr. Where nobody can be told, nobody is: the exit code stays what it is.
pub(crate) fn note(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Writes one JSON value and a line end to stdout.
pub(crate) fn json(value: &impl serde::Serialize) -> Result<()> {
    let json = serde_json::to_string_pretty(value).map_err(|e| Error::file(Path::new("stdout"), e))?;
    text(&format!("{json}\n"))
}

/// Whether a file is to be a table, by its name.
pub(crate) fn is_csv(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"))
}

/// Rows under their headings: the first `left` columns and the last one where `last_left` flush left, the others
/// flush right.
pub(crate) fn table(headings: &[&str], rows: &[Vec<String>], left: usize, last_left: bool) -> String {
    let columns = headings.len();
    let width = |c: usize| {
        let cells = rows.iter().filter_map(|row| row.get(c)).map(|cell| cell.chars().count());
        cells.fold(headings[c].chars().count(), usize::max)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |cells: Vec<&str>| {
        let padded = cells.iter().enumerate().map(|(c, cell)| {
            let width = widths[c];
            if c < left || (last_left && c + 1 == columns) {
                format!("{cell:<width$}")
            } else {
                format!("{cell:>width$}")
            }
        });
        let joined = padded.collect::<Vec<_>>().join("  ");
        format!("{}\n", joined.trim_end())
    };
    let mut text = line(headings.to_vec());
    for row in rows {
        text += &line(row.iter().map(String::as_str).collect());
    }
    text
}

/// A number with the given digits after the point, or a dash.
pub(crate) fn fixed(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".into(), |v| format!("{v:.digits$}"))
}

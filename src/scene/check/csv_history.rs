//! A history from a file with two columns, time and value.
//!
//! A first line that holds no number names the columns; a unit in brackets there, `time [us]` or `stress (MPa)`,
//! holds for its column. Without one numbers are SI. Empty lines and lines that start with # are passed over.

use std::ops::Range;
use std::path::Path;

use toml::Spanned;

use super::Checker;
use super::ends::{ROWS, ROWS_HELP};
use crate::bar::History;
use crate::error::{Error, Place, Result};
use crate::input::{Allowed, Document, Number};
use crate::units::{Dimension, Quantity};

impl Checker<'_> {
    pub(super) fn csv_history(&self, path: &Spanned<String>, key: &str, dimension: Dimension) -> Result<History> {
        let file = self.base.join(Path::new(path.get_ref()));
        let document = Document::read(&file).map_err(|e| match e {
            Error::Input(error) => {
                let (file, text) = (self.document.file.clone(), self.document.text.clone());
                let help = "the path is relative to the scene file";
                error.key(key).help(help).at(Place { file, text, span: path.span() }).into()
            }
            other => other,
        })?;
        read(&document, dimension)
    }
}

fn read(document: &Document, dimension: Dimension) -> Result<History> {
    let mut units = [None, None];
    let mut pairs = Vec::new();
    let mut spans = Vec::new();
    for (span, line) in lines(&document.text) {
        let cells = cells(document, span.clone(), line)?;
        if pairs.is_empty() && spans.is_empty() && cells.iter().all(|(_, cell)| is_name(cell)) {
            units = [unit(cells[0].1), unit(cells[1].1)];
            // Marks the header as seen: only one line may be one.
            spans.push(span);
            continue;
        }
        let number = |column: usize, key: &str, dimension, allowed| {
            let (span, cell) = cells[column].clone();
            document.number(&quantity(span, cell, units[column]), key, dimension, allowed)
        };
        let time = number(0, "time", Dimension::Time, Allowed::NotNegative)?;
        pairs.push((time, number(1, "value", dimension, Allowed::Finite)?));
        spans.push(span);
    }
    let header = spans.len() - pairs.len();
    History::new(&pairs).map_err(|(i, why)| {
        let span = spans.get(header + i).cloned().unwrap_or(0..0);
        let what = if pairs.is_empty() { why.to_owned() } else { format!("this row {why}") };
        document.error(span, "time", what).allowed(ROWS).help(ROWS_HELP).into()
    })
}

/// Lines with content, with the bytes they take.
fn lines(text: &str) -> impl Iterator<Item = (Range<usize>, &str)> {
    let mut start = 0;
    text.split_inclusive('\n').filter_map(move |whole| {
        let line = whole.trim_end();
        let span = start..start + line.len();
        start += whole.len();
        let content = line.trim_start();
        (!content.is_empty() && !content.starts_with('#')).then_some((span, line))
    })
}

type Cell<'a> = (Range<usize>, &'a str);

/// The two cells of a line, separated by a comma, a semicolon or a tab.
fn cells<'a>(document: &Document, span: Range<usize>, line: &'a str) -> Result<[Cell<'a>; 2]> {
    let parts: Vec<&str> = line.split([',', ';', '\t']).collect();
    let [first, second] = parts.as_slice() else {
        let error = document.error(span, "", format!("this line has {} columns", parts.len()));
        let help = "write time,value on each line, with a point in decimals";
        return Err(error.allowed("2 columns: time and value").help(help).into());
    };
    let at = |from: usize, part: &'a str| (span.start + from..span.start + from + part.len(), clean(part));
    Ok([at(0, first), at(first.len() + 1, second)])
}

/// Without blanks and the quotes that spreadsheets put around text.
fn clean(cell: &str) -> &str {
    cell.trim().trim_matches('"').trim()
}

fn is_name(cell: &str) -> bool {
    cell.starts_with(char::is_alphabetic)
}

/// The unit in "time [us]" or "time (us)".
fn unit(header: &str) -> Option<&str> {
    let open = header.find(['[', '('])?;
    header[open + 1..].strip_suffix([']', ')']).map(str::trim).filter(|u| !u.is_empty())
}

/// A cell is a number in its column's unit, or has a unit of its own.
fn quantity(span: Range<usize>, cell: &str, unit: Option<&str>) -> Number {
    let quantity = match (cell.parse::<f64>(), unit) {
        (Ok(_), Some(unit)) => Quantity::Text(format!("{cell} {unit}")),
        (Ok(number), None) => Quantity::Number(number),
        (Err(_), _) => Quantity::Text(cell.to_owned()),
    };
    Number::new(span, quantity)
}

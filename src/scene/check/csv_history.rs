//! A history from a file with the columns time, value; see [`crate::columns`] for delimiters and decimal marks.
//!
//! A first line that holds no number names the columns; a unit in brackets there, `time [us]` or `stress (MPa)`,
//! holds for its column. Without one numbers are SI.

use std::path::Path;

use toml::Spanned;

use super::Checker;
use super::ends::{ROWS, ROWS_HELP};
use crate::bar::History;
use crate::columns::{self, Cell};
use crate::error::{Error, Place, Result};
use crate::input::{Allowed, Document, Number};
use crate::units::{Dimension, Quantity};

impl Checker<'_> {
    pub(super) fn csv_history(&self, path: &Spanned<String>, key: &str, dimension: Dimension) -> Result<History> {
        let file = self.base.join(Path::new(path.get_ref()));
        let document = Document::read(&file).map_err(|e| match e {
            Error::Input(error) => {
                let (file, text) = (self.document.file.clone(), self.document.text.clone());
                let relative = "the path is relative to the scene file".to_owned();
                let help = if error.message.contains("no such file") { relative } else { error.help.clone() };
                error.key(key).help(help).at(Place { file, text, span: path.span() }).into()
            }
            other => other,
        })?;
        read(&document, dimension)
    }
}

fn read(document: &Document, dimension: Dimension) -> Result<History> {
    let columns = columns::read(document)?;
    if let Some(header) = columns.header.as_ref().filter(|row| !is_time(&row.cells[0].text)) {
        let [first, second] = header.cells.each_ref().map(|cell| &cell.text);
        let error = document.error(header.span.clone(), "time", format!("the first column is `{first}`, not a time"));
        let help = format!("name the columns, with their units, e.g. `time [us],{second}`; the first one is the time");
        return Err(error.allowed("a header that starts with time, or none").help(help).into());
    }
    let units = columns.header.as_ref().map_or([None, None], |row| row.cells.each_ref().map(|cell| unit(&cell.text)));
    let mut pairs = Vec::with_capacity(columns.rows.len());
    for row in &columns.rows {
        let number = |column: usize, key: &str, dimension, allowed| {
            document.number(&quantity(&row.cells[column], units[column]), key, dimension, allowed)
        };
        let time = number(0, "time", Dimension::Time, Allowed::NotNegative)?;
        pairs.push((time, number(1, "value", dimension, Allowed::Finite)?));
    }
    History::new(&pairs).map_err(|(i, why)| {
        let span = columns.rows.get(i).map_or(0..0, |row| row.span.clone());
        let what = if pairs.is_empty() { why.to_owned() } else { format!("this row {why}") };
        document.error(span, "time", what).allowed(ROWS).help(ROWS_HELP).into()
    })
}

/// A column named `t`, `time`, `Time (us)`, `Zeit`, ..., or in a unit of time.
fn is_time(header: &str) -> bool {
    let name = header.split(['[', '(', '_', ' ', '/']).next().unwrap_or_default().to_lowercase();
    let in_time = unit(header).is_some_and(|unit| Quantity::Text(format!("1 {unit}")).si(Dimension::Time).is_ok());
    in_time || ["t", "time", "times", "zeit", "temps", "tiempo", "tempo"].contains(&name.as_str())
}

/// The unit in "time [us]" or "time (us)".
fn unit(header: &str) -> Option<&str> {
    let open = header.find(['[', '('])?;
    header[open + 1..].strip_suffix([']', ')']).map(str::trim).filter(|u| !u.is_empty())
}

/// A cell is a number in its column's unit, or has a unit of its own.
fn quantity(Cell { text, span }: &Cell, unit: Option<&str>) -> Number {
    let quantity = match (text.parse::<f64>(), unit) {
        (Ok(_), Some(unit)) => Quantity::Text(format!("{text} {unit}")),
        (Ok(number), None) => Quantity::Number(number),
        (Err(_), _) => Quantity::Text(text.clone()),
    };
    Number::new(span.clone(), quantity)
}

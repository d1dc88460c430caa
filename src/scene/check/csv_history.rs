//! Reads rows from a file with two columns: histories in time and initial states along x. See [`crate::columns`] for delimiters and decimal marks.
//!
//! A first line without numbers contains the names of the columns. A unit in brackets, `time [us]` or `stress (MPa)`, or after an underscore,
//! `time_us`, applies to its column. Numbers without a unit are in SI units.

use std::ops::Range;
use std::path::Path;

use super::Checker;
use crate::columns::{self, Cell, unit_of};
use crate::error::{Error, Result};
use crate::input::{Allowed, Document, Number};
use crate::units::{Dimension, Quantity, one, split};

/// Result of converting rows, or the index of the wrong row and the reason.
pub(super) type MadeOfRows<T> = std::result::Result<T, (usize, &'static str)>;

/// Quantity in the first column of a file.
pub(super) struct Abscissa {
    /// Key in messages.
    pub key: &'static str,
    /// Name of the quantity in the message "the first column is `foo`, not ...".
    pub what: &'static str,
    /// Example of a heading.
    pub example: &'static str,
    pub dimension: Dimension,
    /// Names that are accepted in a heading.
    pub names: &'static [&'static str],
    /// Help for a file with more than two columns.
    pub of_more: &'static str,
    /// Help for negative values.
    pub of_negative: &'static str,
}

impl Checker<'_> {
    /// Opens a file that the scene names, by calling `read`; `span` is the position of the path in the scene.
    pub(super) fn open<T>(
        &self,
        path: &str,
        span: Range<usize>,
        key: &str,
        read: impl Fn(&Path) -> Result<T>,
    ) -> Result<T> {
        read(&self.base.join(path)).map_err(|e| match e {
            Error::Input(error) => {
                let relative = "the path is relative to the scene file".to_owned();
                let help = if error.message.contains("no such file") { relative } else { error.help.clone() };
                error.key(key).help(help).at(self.document.place(span)).into()
            }
            other => other,
        })
    }

    /// Reads the rows of a file with two columns. `make` converts them, or returns the index of a wrong row and the reason. `rules` are the
    /// conditions for rows, and the help on how to write them.
    pub(super) fn csv_rows<T>(
        &self,
        (path, span, key): (&str, Range<usize>, &str),
        abscissa: &Abscissa,
        dimension: Dimension,
        make: impl Fn(&[(f64, f64)]) -> MadeOfRows<T>,
        rules: [&'static str; 2],
    ) -> Result<T> {
        let document = self.open(path, span, key, Document::read)?;
        read(&document, abscissa, dimension, make, rules)
    }
}

fn read<T>(
    document: &Document,
    abscissa: &Abscissa,
    dimension: Dimension,
    make: impl Fn(&[(f64, f64)]) -> MadeOfRows<T>,
    [rules, help]: [&'static str; 2],
) -> Result<T> {
    let columns = columns::read(document, abscissa.of_more)?;
    let Abscissa { key, what, example, .. } = abscissa;
    if let Some(header) = columns.header.as_ref().filter(|row| !abscissa.is_named(&row.cells[0].text)) {
        let [first, second] = header.cells.each_ref().map(|cell| &cell.text);
        let error = document.error(header.span.clone(), key, format!("the first column is `{first}`, not {what}"));
        let help = if abscissa.is_named(second) {
            format!("exchange the columns: the first one is the {key}")
        } else {
            format!("name the columns, with their units, e.g. `{example},{second}`; the first one is the {key}")
        };
        return Err(error.allowed(format!("a header that starts with {key}, or none")).help(help).into());
    }
    let unit_of = |column: usize, dimension| {
        let heading = columns.header.as_ref().map(|row| &row.cells[column]);
        heading.map_or(Ok(None), |cell| unit_of(document, cell, dimension))
    };
    let units = [unit_of(0, abscissa.dimension)?, unit_of(1, dimension)?];
    let mut pairs = Vec::with_capacity(columns.rows.len());
    for row in &columns.rows {
        let number = |column: usize, key: &str, dimension, allowed| {
            document.number(&quantity(&row.cells[column], units[column]), key, dimension, allowed)
        };
        let first = number(0, key, abscissa.dimension, Allowed::NotNegative).map_err(|e| match e {
            Error::Input(error) if number(0, key, abscissa.dimension, Allowed::Finite).is_ok() => {
                error.help(abscissa.of_negative).into()
            }
            other => other,
        })?;
        pairs.push((first, number(1, "value", dimension, Allowed::Finite)?));
    }
    make(&pairs).map_err(|(i, why)| {
        let Some(row) = columns.rows.get(i) else {
            let error = document.error(0..0, key, format!("there are no rows: {why}"));
            return error
                .allowed("at least one row of two numbers")
                .help("write one row a line, such as `0, 5`")
                .into();
        };
        document.error(row.span.clone(), key, format!("this row {why}")).allowed(rules).help(help).into()
    })
}

impl Abscissa {
    /// Returns whether a heading has one of the accepted names (`Time (us)`, `x [mm]`, ...) or a unit of the quantity.
    fn is_named(&self, header: &str) -> bool {
        let name = header.split(['[', '(', '_', ' ', '/']).next().unwrap_or_default().to_lowercase();
        let (_, unit) = split(header);
        (!unit.is_empty() && one(unit, self.dimension).is_ok()) || self.names.contains(&name.as_str())
    }
}

/// Returns the quantity in a cell: a number in the unit of its column, or text with a unit of its own.
pub(super) fn quantity(Cell { text, span }: &Cell, unit: Option<&str>) -> Number {
    let quantity = match (text.parse::<f64>(), unit) {
        (Ok(_), Some(unit)) => Quantity::Text(format!("{text} {unit}")),
        (Ok(number), None) => Quantity::Number(number),
        (Err(_), _) => Quantity::Text(text.clone()),
    };
    Number::new(span.clone(), quantity)
}

//! Histories from files with two columns, or from two columns of a record with any number of columns.

use super::super::raw::{Column, HistoryFile, RawHistoryRecord};
use super::Checker;
use super::csv_history::{Abscissa, quantity};
use super::ends::{ROWS, ROWS_HELP};
use crate::bar::History;
use crate::columns::{self, Table, unit_of};
use crate::error::{Error, Result};
use crate::input::{Allowed, Document};
use crate::typed::{Of, Placed};
use crate::units::{Dimension, Measure, System, format, split};

const TIME: Abscissa = Abscissa {
    key: "time",
    what: "a time",
    example: "time [us]",
    dimension: Dimension::Time,
    names: &["t", "time", "times", "zeit", "temps", "tiempo", "tempo"],
    of_more: "or name the column of the values: csv = { file = \"record.csv\", column = 3 }",
    of_negative: "say at which time of the file the run begins: csv = { file = \"record.csv\", start = \"-20 us\" }",
};

impl Checker<'_> {
    /// Reads the history in a file.
    pub(super) fn history_file<D: Measure>(&self, file: &Placed<HistoryFile<D>>, key: &str) -> Result<History> {
        match file.get_ref() {
            HistoryFile::TwoColumns(path) => {
                let history = |rows: &[(f64, f64)]| History::new(rows).map_err(|error| (error.at(), error.rule));
                self.csv_rows((path, file.span(), key), &TIME, self.dimension::<D>(), history, [ROWS, ROWS_HELP])
            }
            HistoryFile::Record(record) => self.history_record(record, key),
        }
    }

    fn history_record<D: Measure>(&self, record: &RawHistoryRecord<D>, key: &str) -> Result<History> {
        let file = &record.file;
        let read = |path: &std::path::Path| Document::read_record(path).map(|(document, _)| document);
        let document = self.open(file.get_ref(), file.span(), &format!("{key}.file"), read)?;
        let mut table = columns::table(&document)?;
        let dimensions = [Dimension::Time, self.dimension::<D>()];
        let columns = [(&record.time_column, "time-column"), (&record.column, "column")];
        let [time, value] = [0, 1].map(|k| {
            let (column, name) = (columns[k].0.as_ref(), format!("{key}.{}", columns[k].1));
            self.column(column, &table, &document, &name).map(|place| place.unwrap_or(k))
        });
        let (places, scale) = ([time?, value?], self.si(&record.scale)?);
        let unit_of = |k: usize| unit_of_column(&document, &table, places[k], dimensions[k]);
        let units = [unit_of(0)?, if scale.is_some() { String::new() } else { unit_of(1)? }];
        table.keep(&document, places)?;
        let mut rows = Vec::with_capacity(table.rows.len());
        for line in &table.rows {
            let number = |k: usize, name: &str, unit: &str, dimension| {
                let unit = Some(unit).filter(|unit| !unit.is_empty());
                document.number(&quantity(&line.cells[k], unit), name, dimension, Allowed::Finite)
            };
            let time = number(0, "time", &units[0], dimensions[0])?;
            rows.push(match scale {
                Some(scale) => (time, scale * number(1, "value", "", Dimension::None)?),
                None => (time, number(1, "value", &units[1], dimensions[1])?),
            });
        }
        let (first, rows) = self.after_start(record, &document, &table, &rows)?;
        History::new(&rows).map_err(|error| {
            let span = table.rows.get(first + error.at()).map_or(0..0, |row| row.span.clone());
            let what = format!("this row {}", error.rule);
            document.error(span, "time", what).allowed(ROWS).help(ROWS_HELP).into()
        })
    }

    /// Returns the index of a column of a record; `None` if the scene does not name one.
    fn column(
        &self,
        column: Option<&Placed<Column>>,
        table: &Table,
        document: &Document,
        key: &str,
    ) -> Result<Option<usize>> {
        let Some(column) = column else { return Ok(None) };
        let name_of = |title: &str| split(title).0.to_owned();
        let found = table.column(document, &column.get_ref().to_string(), key, name_of);
        Ok(Some(found.map_err(|e| e.at(self.document.place(column.span())))?))
    }

    /// Returns the rows from the start on, with the start as t = 0, and the index in the table to which the first of them corresponds. If the start
    /// lies between two rows, the first value is interpolated.
    fn after_start<D: Measure>(
        &self,
        record: &RawHistoryRecord<D>,
        document: &Document,
        table: &Table,
        rows: &[(f64, f64)],
    ) -> Result<(usize, Vec<(f64, f64)>)> {
        let given = self.si(&record.start)?;
        let start = given.unwrap_or(0.0);
        let Some(k) = rows.iter().position(|row| row.0 >= start) else {
            let last = rows.iter().map(|row| row.0).fold(f64::NEG_INFINITY, f64::max);
            let message = format!("the record ends at {}, before the start", format(last, Dimension::Time, System::Si));
            let span = record.start.as_ref().map_or_else(|| record.file.span(), Of::span);
            return Err(self.error(span, "start", message).help("choose an earlier start").into());
        };
        if let (Some(row), None) = (table.rows.first().filter(|_| rows[0].0 < 0.0), given) {
            let message = "the times of the record start below zero";
            let error = document.error(row.span.clone(), "time", message);
            return Err(error.allowed("times >= 0, or a start").help(TIME.of_negative).into());
        }
        let tail = rows[k..].iter().map(|&(t, v)| (t - start, v));
        let Some(&(t0, v0)) = k.checked_sub(1).and_then(|k| rows.get(k)).filter(|_| rows[k].0 > start) else {
            return Ok((k, tail.collect()));
        };
        let (t1, v1) = rows[k];
        let at_start = (0.0, v0 + (v1 - v0) * ((start - t0) / (t1 - t0)));
        Ok((k - 1, std::iter::once(at_start).chain(tail).collect()))
    }
}

/// Returns the unit of a column, from its heading or from the line below it; empty if there is none.
fn unit_of_column(document: &Document, table: &Table, column: usize, dimension: Dimension) -> Result<String> {
    let heading = table.header.as_ref().and_then(|line| line.cells.get(column));
    let in_heading = heading.map_or(Ok(None), |cell| unit_of(document, cell, dimension)).map_err(|e| match e {
        Error::Input(error) if dimension != Dimension::Time => {
            let help =
                format!("{}; or say what a value of 1 stands for: scale = \"{}\"", error.help, dimension.example());
            error.help(help).into()
        }
        other => other,
    })?;
    Ok(in_heading.unwrap_or_else(|| table.unit_below(column)).to_owned())
}

//! The table of a sweep, as CSV and as HDF5.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;

use serde_json::Value;

use super::metrics::Row;
use super::plan::{Combine, Plan};
use crate::destination::{self, write_whole};
use crate::error::{Error, InputError, Result};
use crate::record::dimension_of;
use crate::record::store::{SweepColumn, SweepFile, Values, check_table, write_sweep};

/// Columns of every table besides axes and metrics.
const CASE: &str = "case";
const STATUS: &str = "status";
const REASON: &str = "reason";

/// Returns the names of the metrics of all rows: in the order of the plan, or else in alphabetical order.
fn names(plan: &Plan, rows: &[Row]) -> Vec<String> {
    if !plan.metrics.is_empty() {
        return plan.metrics.clone();
    }
    let mut all: BTreeSet<&String> = BTreeSet::new();
    let mut last: Option<&Row> = None;
    // Most rows have the same names as the previous row.
    for row in rows {
        if last.is_none_or(|last| !last.metrics.keys().eq(row.metrics.keys())) {
            all.extend(row.metrics.keys());
        }
        last = Some(row);
    }
    // A figure that is an object in some rows can be null in others.
    let is_object = |name: &String| {
        let start = format!("{name}.");
        all.range::<String, _>(&start..).next().is_some_and(|next| next.starts_with(&start))
    };
    all.iter().filter(|name| !is_object(name)).map(|name| (*name).clone()).collect()
}

/// Returns the metrics of a row in the order of the names; null for missing ones.
fn values<'a>(row: &'a Row, names: &[String]) -> Vec<&'a Value> {
    if row.metrics.keys().eq(names) {
        return row.metrics.values().collect();
    }
    names.iter().map(|name| row.metrics.get(name).unwrap_or(&Value::Null)).collect()
}

/// Refuses to replace files that are not tables of sweeps. With `force`, any file may be replaced.
///
/// # Errors
/// An error that names the file, or states that another run writes it.
pub fn check_tables(csv: &Path, hdf5: &Path, force: bool) -> std::result::Result<(), InputError> {
    check_table(hdf5, force)?;
    let target = destination::resolve(csv)?;
    if force || is_table(&target) {
        return Ok(());
    }
    let error = InputError::new(format!("the output {} already exists and is not the table of a sweep", csv.display()));
    Err(error.help("choose another name, or move that file away"))
}

/// Longest first line of a table, bytes.
const LONGEST_LINE: u64 = 1 << 20;

/// Returns whether the file does not exist, is empty, or starts like the table of a sweep.
fn is_table(path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return !path.exists() };
    let mut line = Vec::new();
    if BufReader::new(file.take(LONGEST_LINE)).read_until(b'\n', &mut line).is_err() {
        return false;
    }
    let mut table = csv::ReaderBuilder::new().has_headers(false).from_reader(line.as_slice());
    let Some(header) = table.records().next() else { return true };
    header.is_ok_and(|header| {
        let names: Vec<&str> = header.iter().collect();
        names.first() == Some(&CASE) && names.windows(2).any(|pair| pair == [STATUS, REASON])
    })
}

/// Writes the rows, ordered by case, as CSV and as HDF5.
///
/// # Errors
/// A file error.
pub(super) fn write_tables(csv: &Path, hdf5: &Path, plan: &Plan, rows: &[Row]) -> Result<()> {
    let names = names(plan, rows);
    let metrics: Vec<Vec<&Value>> = rows.iter().map(|row| values(row, &names)).collect();
    let (csv, hdf5) = rayon::join(
        || write_csv(csv, plan, rows, (&names, &metrics)),
        || write_hdf5(hdf5, plan, rows, (&names, &metrics)),
    );
    csv.and(hdf5)
}

/// Names of the metrics, and their values row by row.
type Metrics<'a> = (&'a [String], &'a [Vec<&'a Value>]);

/// Writes the CSV table: the names, a comment with the SI units of the axes, and one line per row.
fn write_csv(path: &Path, plan: &Plan, rows: &[Row], (names, metrics): Metrics<'_>) -> Result<()> {
    let failed = |e: csv::Error| Error::file(path, e);
    let mut csv = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    let axes = plan.axes.iter().map(|axis| axis.key.as_str());
    let header = std::iter::once(CASE).chain(axes).chain([STATUS, REASON]);
    csv.write_record(header.chain(names.iter().map(String::as_str))).map_err(failed)?;
    let units =
        plan.axes.iter().filter(|axis| !axis.unit.is_empty()).map(|axis| format!("{} in {}", axis.key, axis.unit));
    let units: Vec<String> = units.collect();
    if !units.is_empty() {
        csv.write_record([format!("# {}", units.join("; "))]).map_err(failed)?;
    }
    for (row, metrics) in rows.iter().zip(metrics) {
        let levels = plan.levels(row.case);
        let values =
            levels.iter().map(|level| level.si.map_or_else(|| level.plain().to_owned(), |si| format!("{si:?}")));
        let metrics = metrics.iter().copied().map(shown);
        let cells = std::iter::once(row.case.to_string()).chain(values);
        let cells = cells.chain([row.status.name().to_owned(), row.reason.clone()]).chain(metrics);
        csv.write_record(cells).map_err(failed)?;
    }
    write_whole(path, &csv.into_inner().map_err(|e| Error::file(path, e.into_error()))?)
}

fn shown(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) => {
            number.as_f64().filter(|_| number.is_f64()).map_or_else(|| number.to_string(), |f| format!("{f:?}"))
        }
        other => other.to_string(),
    }
}

/// Writes the HDF5 table: over the axes if all cases of their product are present, otherwise over the cases.
fn write_hdf5(path: &Path, plan: &Plan, rows: &[Row], (names, metrics): Metrics<'_>) -> Result<()> {
    let gridded = plan.combine == Combine::Product && rows.len() == plan.cases();
    let axis = |k: usize| {
        let axis = &plan.axes[k];
        let levels = if gridded {
            axis.levels.iter().collect()
        } else {
            rows.iter().map(|row| plan.levels(row.case)[k]).collect::<Vec<_>>()
        };
        let numbers: Option<Vec<f64>> = levels.iter().map(|level| level.si).collect();
        let texts = || levels.iter().map(|level| level.plain().to_owned()).collect();
        column(&axis.key, &axis.unit, numbers.map_or_else(|| Values::Texts(texts()), Values::Numbers))
    };
    let axes: Vec<SweepColumn> = (0..plan.axes.len()).map(axis).collect();
    let cases = column(CASE, "", Values::Numbers(rows.iter().map(|row| row.case as f64).collect()));
    let status = column(STATUS, "", Values::Texts(rows.iter().map(|row| row.status.name().to_owned()).collect()));
    let reason = column(REASON, "", Values::Texts(rows.iter().map(|row| row.reason.clone()).collect()));
    let metrics = names.iter().enumerate().map(|(k, name)| {
        let values = metrics.iter().map(|metrics| metrics[k]);
        column(name, &unit_of(name), values_of(values.collect()))
    });
    let metrics: Vec<SweepColumn> = metrics.collect();
    let (scales, mut columns) = if gridded { (axes, vec![cases]) } else { (vec![cases], axes) };
    columns.extend([status, reason]);
    columns.extend(metrics);
    let plan_json = serde_json::to_string(plan).map_err(|e| Error::file(path, e))?;
    write_sweep(path, &SweepFile { title: plan.title.clone(), plan: plan_json, scales, columns })
}

fn column(name: &str, units: &str, values: Values) -> SweepColumn {
    SweepColumn { name: name.to_owned(), units: units.to_owned(), values }
}

/// Returns the unit of a metric as for the attribute `units`.
fn unit_of(metric: &str) -> String {
    dimension_of(metric).spaced_symbol()
}

/// Converts values to numbers (NaN if there is no value), or to texts if one of them is a text.
fn values_of(values: Vec<&Value>) -> Values {
    if values.iter().any(|value| value.is_string()) {
        return Values::Texts(values.into_iter().map(shown).collect());
    }
    let number = |value: &Value| value.as_f64().or_else(|| value.as_bool().map(f64::from)).unwrap_or(f64::NAN);
    Values::Numbers(values.into_iter().map(number).collect())
}

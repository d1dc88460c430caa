//! Reading of stress-strain tables from files with the columns strain, stress; see [`crate::columns`] for delimiters and decimal marks.
//!
//! A header line is allowed and may state units: `strain,stress_MPa`, `strain (%),stress [ksi]`. Without units, strains are plain numbers and
//! stresses are in Pa, unless the caller gives their unit. The signs of compression are accepted (all values negative or zero): the table contains
//! magnitudes.

use std::path::Path;

use crate::columns::{self, Cell, Row};
use crate::error::{InputError, Result};
use crate::input::Document;
use crate::units::{Dimension, in_heading, split};

/// The rows of a CSV file, each with its byte range in the file.
#[derive(Debug, Clone)]
pub(crate) struct CsvTable {
    pub(crate) document: Document,
    /// Rows (strain, stress in Pa), magnitudes.
    pub(crate) rows: Vec<(f64, f64)>,
    spans: Vec<std::ops::Range<usize>>,
}

impl CsvTable {
    /// Creates an error at a row (from 0).
    pub(crate) fn error(&self, row: usize, key: &str, message: impl Into<String>) -> InputError {
        let span = self.spans.get(row).cloned().unwrap_or(0..0);
        self.document.error(span, key, message)
    }
}

/// SI factor of each column.
#[derive(Debug, Clone, Copy)]
struct Factors {
    strain: f64,
    stress: f64,
}

/// Reads a file. `unit` is the unit of the stresses if the header states none.
///
/// # Errors
/// The file is missing, a line does not have two columns, a value is not a number, a unit is unknown, or the unit is given both in the header and
/// by the caller.
pub(crate) fn read(path: &Path, unit: Option<f64>) -> Result<CsvTable> {
    let document = Document::read(path)?;
    let columns = columns::read(&document, "`barwave materials import` reads records with more columns")?;
    let factors = match &columns.header {
        Some(row) => header(&document, row, unit)?,
        None => Factors { strain: 1.0, stress: unit.unwrap_or(1.0) },
    };
    let number = |cell: &Cell, name: &str| {
        let wrong =
            |_| document.error(cell.span.clone(), name, format!("`{}` is not a number", cell.text)).help(COLUMNS);
        cell.text.parse::<f64>().map_err(wrong)
    };
    let (mut rows, mut spans) = (Vec::new(), Vec::new());
    for Row { cells: [strain, stress], span } in &columns.rows {
        rows.push((number(strain, "strain")? * factors.strain, number(stress, "stress")? * factors.stress));
        spans.push(span.clone());
    }
    if rows.iter().all(|r| r.0 <= 0.0 && r.1 <= 0.0) {
        for row in &mut rows {
            *row = (row.0.abs(), row.1.abs());
        }
    }
    Ok(CsvTable { document, rows, spans })
}

const COLUMNS: &str = "the columns are strain, stress; the first line may name them and their units: strain,stress_MPa";

fn header(document: &Document, row: &Row, unit: Option<f64>) -> Result<Factors> {
    let mut factors = Factors { strain: 1.0, stress: unit.unwrap_or(1.0) };
    let [strain, stress] = &row.cells;
    let (strain_name, strain_unit) = name_and_unit(&strain.text);
    let (stress_name, stress_unit) = name_and_unit(&stress.text);
    let wrong = |cell: &Cell, message: String, help: &str| document.error(cell.span.clone(), "", message).help(help);
    if strain_name.starts_with("stress") || stress_name.starts_with("strain") {
        let message = format!("columns `{}`, `{}` are in the wrong order", strain.text, stress.text);
        return Err(wrong(strain, message, COLUMNS).into());
    }
    let known =
        |cell: &Cell, unit: &str, dimension| factor(unit, dimension).map_err(|e| wrong(cell, e.message, &e.help));
    if !strain_unit.is_empty() {
        factors.strain = known(strain, &strain_unit, Dimension::None)?;
    }
    if !stress_unit.is_empty() {
        if unit.is_some() {
            let message = format!("the unit of stress is given twice: `{}` and the key `unit`", stress.text);
            return Err(wrong(stress, message, "remove the key `unit`").into());
        }
        factors.stress = known(stress, &stress_unit, Dimension::Stress)?;
    }
    Ok(factors)
}

/// Returns the SI value of one unit.
pub(super) fn factor(unit: &str, dimension: Dimension) -> std::result::Result<f64, InputError> {
    in_heading(unit, dimension)
        .map_err(|reason| InputError::new(reason).help("write a unit such as MPa, ksi or psi for stress, % for strain"))
}

/// Splits `stress_MPa`, `stress (MPa)` or `Stress [MPa]` into ("stress", "MPa"). As the names are single words, any other word is meant as a unit.
fn name_and_unit(title: &str) -> (String, String) {
    let separators = ['_', '/', ' '];
    let (name, unit) = split(title);
    let (name, unit) =
        if name.contains(separators) { title.split_once(separators).unwrap_or((name, unit)) } else { (name, unit) };
    (name.to_lowercase(), unit.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &str, unit: Option<f64>) -> Result<Vec<(f64, f64)>> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("curve.csv");
        std::fs::write(&path, text).expect("a file");
        read(&path, unit).map(|t| t.rows)
    }

    #[test]
    fn headers_name_units() {
        let expected = vec![(0.001, 200e6), (0.02, 300e6)];
        // The factors 0.01 and 1e6 round once.
        let near = |text: &str, unit| {
            for (a, b) in rows(text, unit).expect("it is right").iter().zip(&expected) {
                assert!((a.0 / b.0 - 1.0).abs() < 1e-15 && (a.1 / b.1 - 1.0).abs() < 1e-15, "{text}");
            }
        };
        near("0.001,200e6\n0.02,300e6\n", None);
        near("0.001,200\n0.02,300\n", Some(1e6));
        near("0.001,200e6,\n0.02,300e6, ,\n", None);
        near("strain,stress\n0.001,200e6\n0.02,300e6\n", None);
        near("strain,stress_MPa\n0.001,200\n0.02,300\n", None);
        near("# measured at 20 degC\nStrain (%), Stress [MPa]\n0.1,200\n2,300\n", None);
        near("strain_percent,stress (MPa)\n-0.1,-200\n-2,-300\n", None);
    }

    #[test]
    fn wrong_lines_are_named() {
        let refused = |text: &str, unit, words: &str| {
            let error = rows(text, unit).expect_err("it is wrong");
            assert!(error.to_string().contains(words), "{error}");
            assert_eq!(error.exit_code(), 2);
        };
        refused("strain,stress\n0.001,2x\n", None, "curve.csv:2: `stress`: `2x` is not a number");
        refused("0.001\n", None, "this line has 1 column");
        refused("0,001,200\n", None, "curve.csv:1: this line has 3 columns");
        refused("strain,stress,width\n0.001,200e6,3\n", None, "this line has 3 columns");
        refused("strain,stress_MPa\n0.001,200\n", Some(1e6), "given twice");
        refused("stress_MPa,strain\n200,0.001\n", None, "wrong order");
        refused("strain,stress_furlong\n0.001,200\n", None, "furlong");
    }
}

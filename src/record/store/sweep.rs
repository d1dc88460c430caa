//! Table of a sweep as an HDF5 file.

use std::path::Path;

use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, File};

use super::attributes::{identify, put_text, text};
use super::claim::in_place;
use super::scales::attach_first;
use crate::error::Result;

type Hdf<T> = hdf5::Result<T>;

/// Value of the root attribute `format` of sweep tables.
pub(super) const SWEEP_FORMAT: &str = "barwave-sweep";

/// Values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers; NaN for missing values.
    Numbers(Vec<f64>),
    /// UTF-8 texts.
    Texts(Vec<String>),
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }
}

/// Column, or scale of a dimension.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepColumn {
    /// Name of the dataset.
    pub name: String,
    /// SI unit; empty for dimensionless numbers and texts.
    pub units: String,
    /// Values in the order of the cases.
    pub values: Values,
}

/// Table over one or more dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepFile {
    /// Title of the sweep.
    pub title: String,
    /// Plan of the sweep, as JSON.
    pub plan: String,
    /// Scales of the dimensions; the last dimension varies fastest.
    pub scales: Vec<SweepColumn>,
    /// Columns; the number of values of each is the product of the lengths of all scales, or of the first ones.
    pub columns: Vec<SweepColumn>,
}

/// Writes the file; it replaces an older one when it is complete.
///
/// # Errors
/// [`crate::error::Error::File`] if it cannot be written.
pub fn write_sweep(path: &Path, sweep: &SweepFile) -> Result<()> {
    in_place(path, |file| -> Hdf<()> {
        identify(file, SWEEP_FORMAT, &sweep.title)?;
        put_text(file, "plan", &sweep.plan)?;
        let shape: Vec<usize> = sweep.scales.iter().map(|scale| scale.values.len()).collect();
        for (scale, length) in sweep.scales.iter().zip(&shape) {
            write(file, scale, &[*length])?;
        }
        let dimensions = |column: &SweepColumn| {
            let fits = |k: &usize| shape[..*k].iter().product::<usize>() == column.values.len();
            // Every table of a sweep also spans the dimensions of length 1.
            (1..=shape.len()).rev().find(fits).unwrap_or(shape.len())
        };
        for column in &sweep.columns {
            write(file, column, &shape[..dimensions(column)])?;
        }
        let scales: Vec<&str> = sweep.scales.iter().map(|scale| scale.name.as_str()).collect();
        let columns: Vec<_> = sweep.columns.iter().map(|c| (c.name.as_str(), dimensions(c))).collect();
        attach_first(file, &scales, &columns)
    })
    .map(|_| ())
}

fn write(file: &File, column: &SweepColumn, shape: &[usize]) -> Hdf<Dataset> {
    let dataset = match &column.values {
        Values::Numbers(values) => {
            let dataset = file.new_dataset::<f64>().shape(shape).create(column.name.as_str())?;
            dataset.write_raw(values)?;
            dataset
        }
        Values::Texts(values) => {
            let values = values.iter().map(|value| text(value)).collect::<Hdf<Vec<VarLenUnicode>>>()?;
            let dataset = file.new_dataset::<VarLenUnicode>().shape(shape).create(column.name.as_str())?;
            dataset.write_raw(&values)?;
            dataset
        }
    };
    if !column.units.is_empty() {
        put_text(&dataset, "units", &column.units)?;
    }
    Ok(dataset)
}

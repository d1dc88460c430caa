//! The table of a sweep as an HDF5 file.

use std::path::Path;

use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, File};

use super::attributes::{identify, put_text, text};
use super::claim::in_place;
use super::scales::attach_first;
use crate::error::Result;

type Hdf<T> = hdf5::Result<T>;

/// Root attribute `format` of such files.
pub(super) const SWEEP_FORMAT: &str = "barwave-sweep";

/// Values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Not a number where there is no value.
    Numbers(Vec<f64>),
    /// UTF-8.
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

/// A column, or the scale of a dimension.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepColumn {
    /// Name of the dataset.
    pub name: String,
    /// SI; empty for plain numbers and texts.
    pub units: String,
    /// In the order of the cases.
    pub values: Values,
}

/// A table over one or more dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepFile {
    /// For people.
    pub title: String,
    /// The plan of the sweep, as JSON.
    pub plan: String,
    /// The dimensions, the last one fastest.
    pub scales: Vec<SweepColumn>,
    /// Each has as many values as the product of the scales, or of the first ones of them.
    pub columns: Vec<SweepColumn>,
}

/// Writes the file, in place of an older one once it is complete.
///
/// # Errors
/// [`crate::error::Error::File`] where it cannot be written.
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
            // A dimension of length 1 belongs to every table of a sweep.
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

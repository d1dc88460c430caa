//! The table of a sweep as an HDF5 file.

use std::path::Path;

use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, File};

use super::attributes::{put, put_text, text};
use super::claim::in_place;
use super::scales::attach;
use super::{FORMAT_VERSION, git_revision};
use crate::error::Result;

type Hdf<T> = hdf5::Result<T>;

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
    /// Each has as many values as the product of the scales.
    pub columns: Vec<SweepColumn>,
}

/// Writes the file, in place of an older one once it is complete.
///
/// # Errors
/// [`crate::error::Error::File`] where it cannot be written.
pub fn write_sweep(path: &Path, sweep: &SweepFile) -> Result<()> {
    in_place(path, |temporary| -> Hdf<()> {
        let file = File::create(temporary)?;
        put_text(&file, "format", "barwave-sweep")?;
        put(&file, "format_version", &FORMAT_VERSION)?;
        put_text(&file, "program_version", env!("CARGO_PKG_VERSION"))?;
        put_text(&file, "git_revision", git_revision().unwrap_or("unknown"))?;
        put_text(&file, "title", &sweep.title)?;
        put_text(&file, "plan", &sweep.plan)?;
        let shape: Vec<usize> = sweep.scales.iter().map(|scale| scale.values.len()).collect();
        for (scale, length) in sweep.scales.iter().zip(&shape) {
            write(&file, scale, &[*length])?;
        }
        for column in &sweep.columns {
            write(&file, column, &shape)?;
        }
        let names = |columns: &[SweepColumn]| columns.iter().map(|column| column.name.clone()).collect::<Vec<_>>();
        let (scales, columns) = (names(&sweep.scales), names(&sweep.columns));
        let [scales, columns] = [&scales, &columns].map(|names| names.iter().map(String::as_str).collect::<Vec<_>>());
        attach(&file, &scales, &columns)?;
        file.close()
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

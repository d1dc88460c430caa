//! Tables: a group with a one-dimensional dataset for each column, and a dimension scale that numbers the rows. Every
//! column has the attributes `units` (except texts) and `long_name`.
//!
//! A compound dataset would hold a table in one piece, but netCDF-4 does not support texts in compound types, and their members have no attributes.

use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, Group};

use super::attributes::{describe, put_text, text};
use super::{bounded, scales};

type Hdf<T> = hdf5::Result<T>;

/// Column of a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub name: String,
    pub long_name: String,
    pub values: Values,
}

/// Values of a column.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    /// UTF-8 texts of variable length.
    Texts(Vec<String>),
    /// Numbers with their unit.
    Numbers(&'static str, Vec<f64>),
}

impl Column {
    pub fn texts(name: &str, long_name: &str, values: Vec<String>) -> Self {
        Self { name: name.into(), long_name: long_name.into(), values: Values::Texts(values) }
    }

    pub fn numbers(name: &str, units: &'static str, long_name: &str, values: Vec<f64>) -> Self {
        Self { name: name.into(), long_name: long_name.into(), values: Values::Numbers(units, values) }
    }

    fn write(&self, group: &Group) -> Hdf<()> {
        match &self.values {
            Values::Texts(texts) => {
                let texts = texts.iter().map(|value| text(value)).collect::<Hdf<Vec<VarLenUnicode>>>()?;
                let dataset = group.new_dataset::<VarLenUnicode>().shape(texts.len()).create(self.name.as_str())?;
                put_text(&dataset, "long_name", &self.long_name)?;
                if texts.is_empty() { Ok(()) } else { dataset.write_raw(&texts) }
            }
            Values::Numbers(units, numbers) => {
                let dataset = group.new_dataset::<f64>().shape(numbers.len()).create(self.name.as_str())?;
                describe(&dataset, units, &self.long_name)?;
                if numbers.is_empty() { Ok(()) } else { dataset.write_raw(numbers) }
            }
        }
    }
}

/// Returns an upper bound of the size of a table without its texts, bytes.
pub(super) fn bytes(columns: usize, rows: usize) -> u64 {
    (columns as u64 + 1) * (2048 + 16 * rows as u64)
}

/// Writes a table of `rows` rows, numbered by the scale `row`; every column has this number of values.
pub(super) fn write(parent: &Group, name: &str, row: &str, columns: &[Column], rows: usize) -> Hdf<Group> {
    let group = parent.create_group(name)?;
    numbering(&group, row, rows)?;
    columns.iter().try_for_each(|column| column.write(&group))?;
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    scales::attach(&group, &[row], &names)?;
    Ok(group)
}

/// Creates a one-dimensional dataset that numbers `rows` rows from 0.
fn numbering(group: &Group, name: &str, rows: usize) -> Hdf<Dataset> {
    let numbers: Vec<i64> = (0_i64..).take(rows).collect();
    let dataset = group.new_dataset::<i64>().shape(rows).create(name)?;
    if rows > 0 {
        dataset.write_raw(&numbers)?;
    }
    Ok(dataset)
}

/// Returns a column of numbers; empty if the group does not have it.
pub(super) fn numbers(group: &Group, name: &str) -> Hdf<Vec<f64>> {
    if group.link_exists(name) { bounded::column(&group.dataset(name)?) } else { Ok(Vec::new()) }
}

/// Returns a column of texts.
pub(super) fn texts(group: &Group, name: &str) -> Hdf<Vec<String>> {
    let texts: Vec<VarLenUnicode> = bounded::column(&group.dataset(name)?)?;
    Ok(texts.iter().map(ToString::to_string).collect())
}

//! Compound tables whose columns are known only at run time: the typed interface wants a Rust struct for each.
#![allow(unsafe_code)]

use hdf5::types::{CompoundField, CompoundType, FloatSize, TypeDescriptor};
use hdf5::{Dataset, Datatype, Group, Result};
use hdf5_sys::h5d::{H5Dread, H5Dwrite};
use hdf5_sys::h5p::H5P_DEFAULT;
use hdf5_sys::h5s::H5S_ALL;

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub name: String,
    pub values: Values,
}

/// The values of a column.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    /// Written as fixed-length UTF-8, as long as the longest.
    Text(Vec<String>),
    /// 8 bytes.
    Number(Vec<f64>),
}

impl Column {
    pub fn text(name: &str, values: Vec<String>) -> Self {
        Self { name: name.into(), values: Values::Text(values) }
    }

    pub fn number(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self { name: name.into(), values: Values::Number(values) }
    }

    /// Bytes of one value. Multiples of 8 keep the numbers aligned.
    fn width(&self) -> usize {
        match &self.values {
            Values::Text(texts) => texts.iter().map(String::len).max().unwrap_or(0).next_multiple_of(8).max(8),
            Values::Number(_) => 8,
        }
    }

    fn descriptor(&self) -> TypeDescriptor {
        match &self.values {
            Values::Text(_) => TypeDescriptor::FixedUnicode(self.width()),
            Values::Number(_) => TypeDescriptor::Float(FloatSize::U8),
        }
    }
}

fn row_type(columns: &[Column]) -> TypeDescriptor {
    let mut offset = 0;
    let mut fields = Vec::with_capacity(columns.len());
    for (index, column) in columns.iter().enumerate() {
        fields.push(CompoundField::new(&column.name, column.descriptor(), offset, index));
        offset += column.width();
    }
    TypeDescriptor::Compound(CompoundType { fields, size: offset })
}

fn row_bytes(columns: &[Column], rows: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    for row in 0..rows {
        for column in columns {
            match &column.values {
                Values::Text(texts) => {
                    let start = bytes.len();
                    bytes.extend_from_slice(texts[row].as_bytes());
                    bytes.resize(start + column.width(), 0);
                }
                Values::Number(numbers) => bytes.extend_from_slice(&numbers[row].to_ne_bytes()),
            }
        }
    }
    bytes
}

/// Writes a table of `rows` rows; every column has that many values.
pub(super) fn write(group: &Group, name: &str, columns: &[Column], rows: usize) -> Result<Dataset> {
    let descriptor = row_type(columns);
    let dataset = group.new_dataset_builder().empty_as(&descriptor).shape(rows).create(name)?;
    if rows == 0 {
        return Ok(dataset);
    }
    let memory = Datatype::from_descriptor(&descriptor)?;
    let bytes = row_bytes(columns, rows);
    if bytes.len() != rows * memory.size() {
        return Err(format!("table {name}: columns of unequal length").into());
    }
    // SAFETY: both ids live through the call, and `bytes` holds `rows` values of the memory type (checked above).
    let status = hdf5::sync::sync(|| unsafe {
        H5Dwrite(dataset.id(), memory.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.as_ptr().cast())
    });
    hdf5::h5check(status)?;
    Ok(dataset)
}

/// Reads a table of text and 8-byte numbers; columns of other types are left out.
pub(super) fn read(dataset: &Dataset) -> Result<Vec<Column>> {
    let descriptor = dataset.dtype()?.to_descriptor()?;
    let TypeDescriptor::Compound(row) = &descriptor else {
        return Err("not a compound table".into());
    };
    super::bounded::check(dataset)?;
    let memory = Datatype::from_descriptor(&descriptor)?;
    let rows = dataset.size();
    let mut bytes = vec![0_u8; rows * memory.size()];
    if rows > 0 {
        // SAFETY: both ids live through the call, and `bytes` has room for every row in the memory type.
        let status = hdf5::sync::sync(|| unsafe {
            H5Dread(dataset.id(), memory.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.as_mut_ptr().cast())
        });
        hdf5::h5check(status)?;
    }
    let size = memory.size().max(1);
    Ok(row.fields.iter().filter_map(|field| column(field, &bytes, size)).collect())
}

fn column(field: &CompoundField, bytes: &[u8], row_size: usize) -> Option<Column> {
    let width = field.ty.size();
    let cells = bytes.chunks_exact(row_size).map(|row| &row[field.offset..field.offset + width]);
    let values = match field.ty {
        TypeDescriptor::FixedUnicode(_) | TypeDescriptor::FixedAscii(_) => {
            Values::Text(cells.map(|b| String::from_utf8_lossy(b).trim_end_matches('\0').to_owned()).collect())
        }
        TypeDescriptor::Float(FloatSize::U8) => {
            Values::Number(cells.map(|b| f64::from_ne_bytes(b.try_into().unwrap_or_default())).collect())
        }
        _ => return None,
    };
    Some(Column { name: field.name.clone(), values })
}

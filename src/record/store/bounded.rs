//! Reading of datasets in files that may be damaged: shapes are compared with what the file can contain before memory is allocated.

use hdf5::{Container, Dataset, H5Type};

type Hdf<T> = hdf5::Result<T>;

/// Memory that any dataset may occupy, bytes.
const FREE: f64 = 16.0 * 1024.0 * 1024.0;
/// Largest number of bytes that one byte of a compressed chunk can represent; deflate reaches 1032.
const COMPRESSION: f64 = 1100.0;

/// Returns all values of a one-dimensional dataset.
pub(super) fn column<T: H5Type>(dataset: &Dataset) -> Hdf<Vec<T>> {
    let shape = dataset.shape();
    if shape.len() != 1 {
        return Err(format!("`{}` has {} dimensions, expected 1", dataset.name(), shape.len()).into());
    }
    check(dataset)?;
    dataset.read_raw()
}

/// Checks that the shape of a dataset is plausible.
///
/// # Errors
/// An error if the dataset, or one of its chunks, claims to have more values than its part of the file can contain.
pub(super) fn check(dataset: &Dataset) -> Hdf<()> {
    let stored = dataset.storage_size().min(dataset.file()?.size()) as f64;
    let compressed = if dataset.filters().is_empty() { 1.0 } else { COMPRESSION };
    let size = dataset.dtype()?.size() as f64;
    for (what, shape) in [("", Some(dataset.shape())), ("chunks of ", dataset.chunk())] {
        let Some(shape) = shape else { continue };
        let values: f64 = shape.iter().map(|&n| n as f64).product();
        if values * size > compressed * stored + FREE {
            let shape = shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(" x ");
            let name = dataset.name();
            return Err(format!("`{name}` has {what}the shape {shape}, but only {stored} bytes in the file").into());
        }
    }
    Ok(())
}

/// Checks that an attribute has no more values than the file has bytes: attributes are not compressed.
pub(super) fn attribute_fits(attribute: &Container, file_bytes: u64) -> Hdf<()> {
    let values: f64 = attribute.shape().iter().map(|&n| n as f64).product();
    if values <= file_bytes as f64 { Ok(()) } else { Err(format!("an attribute has {values:e} values").into()) }
}

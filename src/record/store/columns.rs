//! Datasets that are extended by rows and truncated to a checkpoint.

use hdf5::Dataset;
use ndarray::s;

type Hdf<T> = hdf5::Result<T>;

/// Writes values behind the first rows.
pub(super) fn append(dataset: &Dataset, start: usize, values: &[f64]) -> Hdf<()> {
    let end = start + values.len();
    dataset.resize(end)?;
    dataset.write_slice(values, s![start..end])
}

/// Keeps the first rows of a dataset alone.
pub(super) fn cut(dataset: &Dataset, rows: usize) -> Hdf<()> {
    if is_longer(dataset, rows)? { dataset.resize(rows) } else { Ok(()) }
}

/// Whether a dataset has more rows than these.
///
/// # Errors
/// It has less.
pub(super) fn is_longer(dataset: &Dataset, rows: usize) -> Hdf<bool> {
    let found = dataset.shape().first().copied().unwrap_or(0);
    if found < rows {
        return Err(format!("`{}` has {found} rows, but its checkpoint has {rows}", dataset.name()).into());
    }
    Ok(found > rows)
}

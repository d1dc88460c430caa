//! Datasets that are extended by rows and truncated to a checkpoint.

use hdf5::Dataset;
use ndarray::s;

type Hdf<T> = hdf5::Result<T>;

/// Writes values from row `start` onwards, after extending the dataset.
pub(super) fn append(dataset: &Dataset, start: usize, values: &[f64]) -> Hdf<()> {
    let end = start + values.len();
    dataset.resize(end)?;
    dataset.write_slice(values, s![start..end])
}

/// Truncates a dataset to its first `rows` rows.
pub(super) fn cut(dataset: &Dataset, rows: usize) -> Hdf<()> {
    if is_longer(dataset, rows)? { dataset.resize(rows) } else { Ok(()) }
}

/// Returns true if a dataset has more than `rows` rows.
///
/// # Errors
/// An error if it has fewer.
pub(super) fn is_longer(dataset: &Dataset, rows: usize) -> Hdf<bool> {
    let found = dataset.shape().first().copied().unwrap_or(0);
    if found < rows {
        return Err(format!("`{}` has {found} rows, but its checkpoint has {rows}", dataset.name()).into());
    }
    Ok(found > rows)
}

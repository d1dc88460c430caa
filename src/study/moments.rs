//! Mean and standard deviation of samples.

/// Returns the mean and the sample standard deviation (divisor n - 1), or `None` for fewer than two values.
pub(super) fn moments(values: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    let count = values.clone().count();
    if count < 2 {
        return None;
    }
    let mean = values.clone().sum::<f64>() / count as f64;
    let squares: f64 = values.map(|value| (value - mean) * (value - mean)).sum();
    Some((mean, (squares / (count - 1) as f64).sqrt()))
}

//! Spread of bootstrap replicates.

/// Half the width of a 95 % interval in standard deviations of the normal distribution.
pub(super) const HALF_95: f64 = 1.959_964;

/// Standard deviation of one column of the replicates about their mean; what is not finite is left out. 0 with fewer than two values.
#[expect(clippy::needless_pass_by_value, reason = "iterators are passed by value")]
pub(super) fn deviation(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let finite = || values.clone().filter(|value| value.is_finite());
    let count = finite().count();
    if count < 2 {
        return 0.0;
    }
    let mean = finite().sum::<f64>() / count as f64;
    (finite().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (count - 1) as f64).sqrt()
}

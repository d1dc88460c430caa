//! Spread and bias of bootstrap replicates.

use crate::study::moments::moments;

/// Half width of a 95 % interval in standard deviations of the normal distribution.
pub(super) const HALF_95: f64 = 1.959_964;

/// Standard deviation of a uniform distribution over its width: that of a rounding error over the step.
pub(super) const OF_UNIFORM: f64 = 0.288_675_1;

/// Returns the standard deviation of a quantity among the replicates. Values that are not finite are ignored. 0 for fewer than two values.
pub(super) fn deviation(values: impl Iterator<Item = f64> + Clone) -> f64 {
    moments(values.filter(|value| value.is_finite())).map_or(0.0, |(_, deviation)| deviation)
}

/// Returns the mean of a quantity among the replicates minus the estimate from which they were drawn. Values that are not finite are ignored. 0 for
/// fewer than two values.
pub(super) fn bias(values: impl Iterator<Item = f64> + Clone, estimate: f64) -> f64 {
    moments(values.filter(|value| value.is_finite())).map_or(0.0, |(mean, _)| mean - estimate)
}

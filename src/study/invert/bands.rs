//! Spread and bias of bootstrap replicates.

use crate::study::moments::moments;

/// Half the width of a 95 % interval in standard deviations of the normal distribution.
pub(super) const HALF_95: f64 = 1.959_964;

/// Standard deviation of one column of the replicates about their mean; what is not finite is left out. 0 with fewer than two values.
pub(super) fn deviation(values: impl Iterator<Item = f64> + Clone) -> f64 {
    moments(values.filter(|value| value.is_finite())).map_or(0.0, |(_, deviation)| deviation)
}

/// Mean of one column of the replicates less the estimate that they were drawn about; what is not finite is left out. 0 with fewer than
/// two values.
pub(super) fn bias(values: impl Iterator<Item = f64> + Clone, estimate: f64) -> f64 {
    moments(values.filter(|value| value.is_finite())).map_or(0.0, |(mean, _)| mean - estimate)
}

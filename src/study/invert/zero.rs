//! The zero of a gauge: what its record holds before the wave arrives.

use super::noise::Noise;

/// A record without its zero offset.
pub(super) struct Zeroed {
    /// Times (s) and strains.
    pub(super) record: (Vec<f64>, Vec<f64>),
    /// Mean strain before the wave, which is removed.
    pub(super) offset: f64,
    /// Its standard error.
    pub(super) offset_error: f64,
    /// Standard deviation of the strain about it before the wave.
    pub(super) noise: f64,
    /// Before the wave.
    pub(super) samples: usize,
}

/// Part of the time before a wave that is free of its foot.
pub(super) const QUIET: f64 = 0.8;

impl Zeroed {
    /// With the wave at a time.
    pub(super) fn until(time: &[f64], strain: &[f64], wave: f64) -> Self {
        let start = time.first().copied().unwrap_or(0.0);
        let samples = time.partition_point(|&t| t < start + QUIET * (wave - start)).max(1).min(strain.len());
        let quiet = &strain[..samples];
        let offset = mean(quiet);
        let noise = Noise::about(quiet, &vec![offset; samples]);
        Self {
            record: (time.to_vec(), strain.iter().map(|e| e - offset).collect()),
            offset,
            offset_error: noise.error_of_mean(),
            noise: noise.rms(),
            samples,
        }
    }
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

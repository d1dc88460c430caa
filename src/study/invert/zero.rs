//! Zero offset of a gauge: the strain that it records before the wave arrives.

use super::bands::OF_UNIFORM;
use super::noise::Noise;

/// A record without its zero offset.
pub(super) struct Zeroed {
    /// Times (s) and strains.
    pub(super) record: (Vec<f64>, Vec<f64>),
    /// Mean strain before the wave, which has been removed.
    pub(super) offset: f64,
    /// Standard error of the offset, due to noise and rounding.
    pub(super) offset_error: f64,
    /// Standard deviation of the strain about the offset before the wave.
    pub(super) noise: f64,
    /// Step to which the strains are rounded; 0 if the noise averages out the rounding.
    pub(super) rounding: f64,
    /// Number of samples before the wave.
    pub(super) samples: usize,
}

/// Fraction of the time before a wave that is not affected by the foot of the wave.
pub(super) const QUIET: f64 = 0.8;

impl Zeroed {
    /// Removes the mean strain before a wave that arrives at time `wave` (s).
    pub(super) fn until(time: &[f64], strain: &[f64], wave: f64) -> Self {
        let start = time.first().copied().unwrap_or(0.0);
        let samples = time.partition_point(|&t| t < start + QUIET * (wave - start)).max(1).min(strain.len());
        let quiet = &strain[..samples];
        let offset = mean(quiet);
        let noise = Noise::about(quiet, &vec![offset; samples]);
        let rounding = noise.rounding(strain);
        Self {
            record: (time.to_vec(), strain.iter().map(|e| e - offset).collect()),
            offset,
            offset_error: noise.error_of_mean(samples).hypot(OF_UNIFORM * rounding),
            noise: noise.rms(),
            rounding,
            samples,
        }
    }
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

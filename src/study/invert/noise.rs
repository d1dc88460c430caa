//! Noise of a record: the residuals of its fit, which are resampled in blocks for bootstrap replicates.

use rand::RngExt;
use rand_xorshift::XorShiftRng;

use crate::study::random::standard_normal;

/// Number of samples of a digitized record.
const SAMPLES: usize = 4000;

/// Samples a record like a digitizer: equally spaced samples with normally distributed noise, whose standard deviation is the fraction `part` of the
/// largest strain.
pub(super) fn digitized(time: &[f64], strain: &[f64], part: f64, rng: &mut XorShiftRng) -> (Vec<f64>, Vec<f64>) {
    let deviation = part * strain.iter().fold(0.0_f64, |top, e| top.max(e.abs()));
    let (Some(&first), Some(&last)) = (time.first(), time.last()) else { return Default::default() };
    let even = |k: usize| first + (last - first) * k as f64 / (SAMPLES - 1) as f64;
    let times: Vec<f64> = (0..SAMPLES).map(even).collect();
    let noisy = times.iter().map(|&t| at(time, strain, t) + deviation * standard_normal(rng)).collect();
    (times, noisy)
}

/// Returns the value of a record at a time, interpolated linearly; its first or last value outside. A jump consists of two samples at one time.
pub(super) fn at(time: &[f64], values: &[f64], t: f64) -> f64 {
    let next = time.partition_point(|&own| own <= t);
    if next == 0 || next == time.len() {
        return values.get(next.saturating_sub(1)).copied().unwrap_or(0.0);
    }
    let (a, b) = (time[next - 1], time[next]);
    values[next - 1] + (values[next] - values[next - 1]) * ((t - a) / (b - a))
}

/// Draws the error of a value that is rounded to a step; 0 without a step.
pub(super) fn rounded(step: f64, rng: &mut XorShiftRng) -> f64 {
    if step > 0.0 { step * (rng.random::<f64>() - 0.5) } else { 0.0 }
}

/// Residuals of a fit.
pub(super) struct Noise {
    residuals: Vec<f64>,
    /// Number of consecutive residuals that are drawn together: about their correlation length.
    block: usize,
}

/// Autocorrelation below which residuals count as independent.
const INDEPENDENT: f64 = 0.1;

impl Noise {
    /// Computes the residuals of values about their fit.
    pub(super) fn about(values: &[f64], fit: &[f64]) -> Self {
        let residuals: Vec<f64> = values.iter().zip(fit).map(|(value, fit)| value - fit).collect();
        let block = correlated(&residuals);
        Self { residuals, block }
    }

    /// Returns the root mean square of the residuals.
    pub(super) fn rms(&self) -> f64 {
        let squares: f64 = self.residuals.iter().map(|r| r * r).sum();
        (squares / self.residuals.len().max(1) as f64).sqrt()
    }

    /// Returns the standard error of the mean of this number of values, allowing for the correlation of neighbours; 0 for a single value that is its
    /// own fit.
    pub(super) fn error_of_mean(&self, values: usize) -> f64 {
        self.rms() * (self.block as f64 / values.max(1) as f64).sqrt()
    }

    /// Returns the step to which values with this noise are rounded, if the noise is too small to average out the rounding; otherwise 0.
    pub(super) fn rounding(&self, values: &[f64]) -> f64 {
        let step = rounding_step(values);
        if self.rms() < 0.5 * step { step } else { 0.0 }
    }

    /// Returns the fit plus resampled residuals (moving-block bootstrap, H. R. Kuensch, Ann. Statist. 17, 1989).
    pub(super) fn replicate(&self, fit: &[f64], rng: &mut XorShiftRng) -> Vec<f64> {
        let n = self.residuals.len();
        let mut values = Vec::with_capacity(n);
        while values.len() < n {
            let start = rng.random_range(0..=n - self.block);
            let take = self.block.min(n - values.len());
            values.extend((0..take).map(|k| self.residuals[start + k]));
        }
        values.iter().zip(fit).map(|(residual, fit)| fit + residual).collect()
    }
}

/// Fewest different values of a record whose step is known, and fewest values that successive samples repeat if they occur at all steps.
const FEWEST_VALUES: usize = 5;

/// Difference from a multiple of a step, relative to it, that is due to the precision of numbers.
const MULTIPLE: f64 = 1e-3;

/// Returns the step to which values are rounded, as by an analog-to-digital converter: their smallest difference, if all differences are multiples of
/// it; otherwise 0. If no step is left out, several values have to be repeated by the next sample: the samples of a straight line are even, too.
fn rounding_step(values: &[f64]) -> f64 {
    let ordered = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        let least = 1e-9 * values.iter().fold(0.0_f64, |top, value| top.max(value.abs()));
        values.dedup_by(|b, a| *b - *a <= least);
        values
    };
    let repeated = ordered(values.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect());
    let differences: Vec<f64> = ordered(values.to_vec()).windows(2).map(|pair| pair[1] - pair[0]).collect();
    let step = differences.iter().copied().fold(f64::INFINITY, f64::min);
    let is_multiple = |difference: &f64| (difference / step - (difference / step).round()).abs() < MULTIPLE;
    let leaves_out = differences.iter().any(|difference| *difference > 1.5 * step);
    let known = differences.len() >= FEWEST_VALUES && (leaves_out || repeated.len() >= FEWEST_VALUES);
    if known && differences.iter().all(is_multiple) { step } else { 0.0 }
}

/// Returns the first lag with a small autocorrelation, at least 1 and at most a twentieth of the record.
fn correlated(residuals: &[f64]) -> usize {
    let variance: f64 = residuals.iter().map(|r| r * r).sum();
    let small = |lag: usize| {
        let product: f64 = residuals.iter().zip(&residuals[lag..]).map(|(a, b)| a * b).sum();
        product <= INDEPENDENT * variance
    };
    let most = (residuals.len() / 20).max(1);
    (1..most).find(|&lag| small(lag)).unwrap_or(most)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn the_step_of_a_converter_is_found() {
        let record = |of: &dyn Fn(f64) -> f64| (0..900).map(|k| of(f64::from(k) / 900.0)).collect::<Vec<_>>();
        let step = rounding_step(&record(&|t| 12e-6 * (1e-3 * t.sqrt() / 12e-6).round()));
        assert!((step / 12e-6 - 1.0).abs() < 1e-9, "{step:e}");
        let few: Vec<f64> = (0..20).map(|k| 1e-3 * (50.0 * (-0.2 * f64::from(k)).exp()).round()).collect();
        assert!((rounding_step(&few) / 1e-3 - 1.0).abs() < 1e-9);
        // A smooth record, and a trapezoidal pulse, whose edges have even steps.
        assert_eq!(rounding_step(&record(&f64::sqrt)), 0.0);
        assert_eq!(rounding_step(&record(&|t| (30.0 * t).min(1.0).min(30.0 - 30.0 * t).max(0.0))), 0.0);
    }

    #[test]
    fn blocks_are_as_long_as_the_correlation() {
        let mut rng = XorShiftRng::seed_from_u64(1);
        let white: Vec<f64> = (0..4000).map(|_| standard_normal(&mut rng)).collect();
        let moving: Vec<f64> = white.windows(10).map(|w| w.iter().sum()).collect();
        assert_eq!(correlated(&white), 1);
        assert!((7..=11).contains(&correlated(&moving)), "{}", correlated(&moving));
        let noise = Noise::about(&white, &vec![0.0; 4000]);
        let drawn = Noise::about(&noise.replicate(&vec![0.0; 4000], &mut rng), &vec![0.0; 4000]);
        // Four standard errors of a standard deviation.
        assert!((drawn.rms() / noise.rms() - 1.0).abs() < 4.0 / (8000_f64).sqrt());
    }
}

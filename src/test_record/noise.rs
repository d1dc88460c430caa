//! Estimation of the noise of a record without a model of its curve.
//!
//! Each stress is compared with the straight line between its neighbours (Gasser, Sroka and Jennen-Steinmetz, Biometrika 73, 1986, 625-633) and
//! with the cubic through two neighbours on either side. If rows are far apart, the first estimate includes the curvature of the curve; the smaller
//! of the two estimates is used. A knee, a jump and a yield drop also differ from their neighbours: the largest differences near a row are
//! discarded.

/// Number of rows on either side whose differences are used for the noise at a row.
const NEAR: usize = 25;

/// Fraction of the differences that is used, the smallest ones.
const KEPT: f64 = 0.8;

/// Mean of the smallest [`KEPT`] of the squares of standard normal numbers.
const MEAN_OF_KEPT: f64 = 0.4377;

/// Returns the variance of the noise at each row, Pa^2; at least that of the rounding step, which neighbours within one step do not show.
pub(super) fn variances(rows: &[(f64, f64)], resolution: f64) -> Vec<f64> {
    let rounding = resolution * resolution / 12.0;
    let [line, cubic] = [scale(&squares::<1>(rows)), scale(&squares::<2>(rows))];
    let at = |row: usize, of: &[f64], reach: usize| {
        of.get(row.saturating_sub(reach).min(of.len().saturating_sub(1))).copied().unwrap_or_default()
    };
    (0..rows.len()).map(|row| at(row, &line, 1).min(at(row, &cubic, 2)).max(rounding)).collect()
}

/// Returns the squared differences of the inner rows from the polynomial through `N` neighbours on either side, over their variance for white noise
/// of variance 1.
fn squares<const N: usize>(rows: &[(f64, f64)]) -> Vec<f64> {
    rows.windows(2 * N + 1)
        .map(|near| {
            let (strain, stress) = near[N];
            let (mut off, mut variance) = (stress, 1.0);
            for (k, &(e, s)) in near.iter().enumerate().filter(|(k, _)| *k != N) {
                let others = near.iter().enumerate().filter(|(j, _)| *j != k && *j != N);
                let weight: f64 = others.map(|(_, other)| (strain - other.0) / (e - other.0)).product();
                off -= weight * s;
                variance += weight * weight;
            }
            off * off / variance
        })
        .collect()
}

/// Returns the mean square near each row without the largest values.
fn scale(squares: &[f64]) -> Vec<f64> {
    let mean = |k: usize| {
        let mut near = squares[k.saturating_sub(NEAR)..(k + NEAR + 1).min(squares.len())].to_vec();
        let kept = ((KEPT * near.len() as f64) as usize).max(1);
        near.select_nth_unstable_by(kept - 1, f64::total_cmp);
        near[..kept].iter().sum::<f64>() / kept as f64 / MEAN_OF_KEPT
    };
    (0..squares.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(i: u32) -> (f64, f64) {
        let strain = 1e-4 * f64::from(i);
        (strain, if i < 40 { 70e9 * strain } else { 280e6 + 1e9 * (strain - 0.004) - 5e9 * (strain - 0.004).powi(2) })
    }

    #[test]
    fn a_knee_is_no_noise() {
        let rows: Vec<(f64, f64)> = (0..300).map(row).collect();
        let largest = variances(&rows, 0.0).into_iter().fold(0.0, f64::max).sqrt();
        assert!(largest < 1e3, "{largest} Pa");
        assert!(variances(&rows, 1e6).iter().all(|v| (v / (1e12 / 12.0) - 1.0).abs() < 1e-9));
    }

    #[test]
    fn white_noise_has_its_variance() {
        let random = |i: u32| (f64::from(i) * 12.989_8).sin() * 43_758.545_3;
        // The sum of three evenly distributed numbers is nearly normal, with a variance of 1/4.
        let normal = |i: u32| (0..3).map(|k| random(3 * i + k) - random(3 * i + k).floor() - 0.5).sum::<f64>();
        let rows: Vec<(f64, f64)> = (0..3000).map(|i| (row(i).0, row(i).1 + 1e6 * normal(i))).collect();
        let mean = variances(&rows, 0.0).iter().sum::<f64>() / 3000.0;
        assert!((mean / 0.25e12 - 1.0).abs() < 0.15, "{mean:e}");
    }
}

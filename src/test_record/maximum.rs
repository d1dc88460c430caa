//! Test of whether a record passes its largest stress, and the end of its curve if it does not.
//!
//! The smoothed curve of a test that was stopped while its stress rose has its largest stress inside the record in most cases, because of noise.
//! Therefore the record has to fall: the mean of its last rows has to be below that of earlier rows by more than the noise of both means. Groups of
//! all sizes are compared. As long as the true stress rises, none of these differences has a positive mean.

/// Number of standard errors by which the last rows have to be below earlier ones. Of records with rising stress, fewer than one in 1000 exceeds
/// it; of those at constant stress, some percent do.
const SURELY: f64 = 4.0;

/// Factor by which the sizes of groups grow.
const LARGER: f64 = 1.4;

/// Smallest number of rows of a group: fewer may all be outliers.
const FEWEST: usize = 3;

/// Number of standard errors by which the line at the end of a curve that does not fall has to rise.
const RISES: f64 = 2.0;

/// Whether the last rows are below earlier ones by more than the noise. If the noise is below `floor` (Pa), single rows are compared.
pub(super) fn falls(rows: &[(f64, f64)], variances: &[f64], floor: f64) -> bool {
    let Some(first) = rows.first().map(|row| row.1) else { return false };
    let [stress, variance] = [sums(rows.iter().map(|row| row.1 - first)), sums(variances.iter().copied())];
    let clean = SURELY * (variance[rows.len()] / rows.len() as f64).sqrt() < floor;
    let least = if clean { 1 } else { FEWEST };
    let mean = |from: usize, to: usize| {
        let count = (to - from) as f64;
        ((stress[to] - stress[from]) / count, (variance[to] - variance[from]) / (count * count))
    };
    sizes(least, rows.len()).any(|last| {
        let before = rows.len() - last;
        let (end, noise) = mean(before, rows.len());
        sizes(least, before).any(|size| {
            (size..=before).any(|to| {
                let (earlier, its_noise) = mean(to - size, to);
                earlier - end > SURELY * (noise + its_noise).sqrt() + ROUNDING * floor
            })
        })
    })
}

/// Difference attributed to rounding, relative to the floor.
const ROUNDING: f64 = 1e-6;

/// Iterates over the numbers of rows of a group, up to `most`.
fn sizes(least: usize, most: usize) -> impl Iterator<Item = usize> {
    let next = |size: &usize| Some(((*size as f64 * LARGER) as usize).max(size + 1));
    std::iter::successors(Some(least), next).take_while(move |size| *size <= most)
}

fn sums(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sums = vec![0.0];
    for value in values {
        sums.push(sums[sums.len() - 1] + value);
    }
    sums
}

/// Replaces the end of a curve whose largest stress is due to noise by a least-squares line through the rows: the shortest one that rises
/// significantly to the largest stress or, if there is none (as at constant stress), one from the end of the elastic line that does not fall.
/// Returns the strain at which the line starts; `None` if the curve is not changed, because an earlier stress is larger.
pub(super) fn rising_end(curve: &mut Vec<(f64, f64)>, rows: &[(f64, f64)], variances: &[f64]) -> Option<f64> {
    let end = rows.last()?.0;
    let top = (0..curve.len()).max_by(|a, b| curve[*a].1.total_cmp(&curve[*b].1))?;
    let mut largest_before: Vec<f64> = Vec::new();
    for point in curve.iter() {
        largest_before.push(largest_before.last().map_or(point.1, |largest| largest.max(point.1)));
    }
    let line = |from: usize| {
        let (slope, error) = slope_from(curve[from], rows, variances)?;
        let last = curve[from].1 + slope * (end - curve[from].0);
        (last >= largest_before[from]).then_some((from, slope, error, last))
    };
    let surely = |&(_, slope, error, _): &(usize, f64, f64, f64)| slope > RISES * error && slope > 0.0;
    // The second point is the end of the elastic line.
    let found = (1..top).rev().filter_map(line).find(surely);
    let level = || {
        let from = curve.get(1)?;
        let (slope, _) = slope_from(*from, rows, variances)?;
        let last = from.1 + slope.max(0.0) * (end - from.0);
        (last >= largest_before[1]).then_some((1, last))
    };
    let (from, last) = found.map(|(from, _, _, last)| (from, last)).or_else(level)?;
    let start = curve[from].0;
    curve.truncate(from + 1);
    curve.push((end, last));
    Some(start)
}

/// Returns the slope, and its standard error, of the least-squares line from a point through the rows after it.
fn slope_from((strain, stress): (f64, f64), rows: &[(f64, f64)], variances: &[f64]) -> Option<(f64, f64)> {
    let behind = rows.partition_point(|row| row.0 <= strain);
    let [mut xx, mut xy, mut noise] = [0.0; 3];
    for (row, variance) in rows[behind..].iter().zip(&variances[behind..]) {
        let x = row.0 - strain;
        xx += x * x;
        xy += x * (row.1 - stress);
        noise += x * x * variance;
    }
    (xx > 0.0).then(|| (xy / xx, noise.sqrt() / xx))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal enough: the sum of twelve numbers between -0.5 and 0.5.
    fn noise(seed: f64, k: f64) -> f64 {
        let one = |j: u32| ((k + 1.0) * 12.989_8 + seed * 78.233 + f64::from(j) * 3.7).sin() * 43_758.545_3;
        (0..12).map(|j| one(j) - one(j).floor() - 0.5).sum()
    }

    /// A parabola with its top at a strain of 0.2 and 400 MPa.
    fn record(end: f64, deviation: f64, seed: u32) -> Vec<(f64, f64)> {
        let stress = |e: f64| 400e6 - 5e9 * (e - 0.2) * (e - 0.2);
        (0..400)
            .map(|i| (end * (f64::from(i) + 1.0) / 400.0, f64::from(i)))
            .map(|(e, i)| (e, stress(e) + deviation * noise(f64::from(seed), i)))
            .collect()
    }

    #[test]
    fn only_records_past_their_largest_stress_fall() {
        for (deviation, floor) in [(0.0, 8e4), (1e6, 8e4), (4e6, 8e4)] {
            let variances = vec![deviation * deviation; 400];
            for seed in 0..40 {
                assert!(!falls(&record(0.18, deviation, seed), &variances, floor), "{deviation}, {seed}");
                assert!(falls(&record(0.3, deviation, seed), &variances, floor), "{deviation}, {seed}");
            }
        }
        assert!(falls(&record(0.202, 0.0, 1), &[0.0; 400], 8e4));
    }

    #[test]
    fn a_curve_that_does_not_fall_ends_with_its_largest_stress() {
        let deviation = 4e6;
        let variances = vec![deviation * deviation; 400];
        for seed in 0..40 {
            let rows = record(0.18, deviation, seed);
            // A curve with its largest stress at row 370.
            let mut curve: Vec<_> =
                rows.iter().step_by(30).map(|row| (row.0, 400e6 - 5e9 * (row.0 - 0.2).powi(2))).collect();
            curve.extend([(rows[370].0, 405e6), (rows[399].0, 396e6)]);
            let start = rising_end(&mut curve, &rows, &variances).expect("a line");
            let last = curve[curve.len() - 1];
            assert!(start > 0.05 && last.0 == rows[399].0, "{seed}: {start}");
            assert!(
                curve.iter().all(|point| point.1 <= last.1) && (last.1 / 398e6 - 1.0).abs() < 0.015,
                "{seed}: {last:?}"
            );
        }
    }
}

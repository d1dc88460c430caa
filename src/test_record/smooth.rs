//! Smoothing of the plastic part of a record by local regression, evaluated at as many strains as its shape requires.
//!
//! The half-width of a window is at most half of the distance to the end of the elastic line, since curves of metals bend less the farther they are
//! from yield, or as wide as necessary to reduce the noise to a thousandth of the largest stress. Between two strains the curve is straight: at a
//! knee, a yield drop or a serration, rows are inserted.

use super::fit::{Estimate, parabola};
use super::local::{AGREE, Local};

/// Half-width over the distance to the end of the elastic line.
const HALF_WIDTH: f64 = 0.5;

/// Smallest number of rows on either side of a window of given width, as far as there are any.
const FEWEST: usize = 5;
/// Largest number of rows on either side of a window that the noise requires.
const MOST: f64 = 200.0;

/// Standard error to which noise is reduced, over the largest stress.
const PRECISION: f64 = 1e-3;

/// Standard error of a local parabola with tricube weights over that of the mean of its rows.
const PARABOLA: f64 = 1.9;

/// Stress difference that is neglected, over the largest stress.
pub(super) const FLOOR: f64 = 2e-4;

/// Factor by which the strains at which the curve is evaluated grow, measured from the end of the elastic line.
const STEP: f64 = 1.03;

/// Number of rows between two such strains up to which the curve is evaluated at the rows instead.
const SPARSE: usize = 2;

/// A smoothed curve.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Smooth {
    /// Points (strain, stress) from the first row to the last.
    pub curve: Vec<(f64, f64)>,
    /// Slope at the first row.
    pub slope: f64,
}

/// Smooths rows (strain increasing), which start after the elastic line, with a window of a given width in strain or with a width that depends on
/// the rows.
pub(super) fn smooth(rows: &[(f64, f64)], variances: &[f64], largest: f64, window: Option<f64>) -> Smooth {
    let local = Local { rows, variances, floor: FLOOR * largest };
    let precise = (PRECISION * largest / PARABOLA).powi(2);
    let half_width = |strain: f64| match window {
        // A parabola needs some rows, however narrow the window is.
        Some(window) => (0.5 * window).max(local.holding(strain, FEWEST)),
        None => local.half_width(strain, widest(&local, strain, precise)),
    };
    let strains = strains(rows);
    let estimates: Vec<(f64, Estimate)> =
        strains.iter().filter_map(|&strain| Some((strain, local.estimate(strain, half_width(strain))?))).collect();
    let slope = estimates.first().map_or(0.0, |(_, first)| first.slope);
    let mut curve = refined(&local, &estimates, half_width);
    insert_maximum(&mut curve, local.floor);
    Smooth { curve, slope }
}

/// Returns the curve with additional points where it is not straight between two of `points`.
fn refined(local: &Local<'_>, points: &[(f64, Estimate)], half_width: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let mut curve: Vec<(f64, f64)> = points.iter().take(1).map(|(strain, point)| (*strain, point.value)).collect();
    for pair in points.windows(2) {
        let mut open = vec![(pair[1].0, pair[1].1.value)];
        while let (Some(&(to, value)), Some(&(from, before))) = (open.last(), curve.last()) {
            let inner = local.rows.partition_point(|row| row.0 <= from)..local.rows.partition_point(|row| row.0 < to);
            let strain = local.rows[inner.start + inner.len() / 2].0;
            let middle = if inner.is_empty() { None } else { local.estimate(strain, half_width(strain)) };
            let off = |middle: &Estimate| middle.value - before - (value - before) * (strain - from) / (to - from);
            match middle.filter(|middle| off(middle).abs() > local.floor + AGREE * middle.error) {
                Some(middle) => open.push((strain, middle.value)),
                None => curve.extend(open.pop()),
            }
        }
    }
    curve
}

/// Returns the strains of evaluation: the rows where they are sparse, and strains at geometrically growing distances from the first row where they
/// are dense.
fn strains(rows: &[(f64, f64)]) -> Vec<f64> {
    let (start, end) = (rows[0].0, rows[rows.len() - 1].0);
    let first = (2.0 * (rows[rows.len().min(9) - 1].0 - start) / 8.0).max(1e-6 * (end - start));
    let steps = std::iter::successors(Some(first), |p| Some(p * STEP)).take_while(|p| start + p * STEP < end);
    let (mut strains, mut from) = (vec![start], 1);
    for strain in steps.map(|p| start + p).chain([end]) {
        let to = rows.partition_point(|row| row.0 <= strain);
        if to - from <= SPARSE {
            strains.extend(rows[from..to].iter().map(|row| row.0));
        } else {
            strains.push(strain);
        }
        from = to;
    }
    strains
}

/// Returns the largest half-width at a strain: [`HALF_WIDTH`] times the distance to the first row, or as much as the noise requires. At the first
/// row, whose tangent gives the elastic limit, the distance is that to the origin.
fn widest(local: &Local<'_>, strain: f64, precise: f64) -> f64 {
    let at = local.rows.partition_point(|row| row.0 < strain).min(local.rows.len() - 1);
    let near = &local.variances[at..(at + 50).min(local.variances.len())];
    let noise = near.iter().sum::<f64>() / near.len() as f64;
    let needed = (0.5 * noise / precise).clamp(FEWEST as f64, MOST) as usize;
    let start = local.rows[0].0;
    let distance = if strain > start { strain - start } else { start };
    (HALF_WIDTH * distance).max(local.holding(strain, needed))
}

/// Inserts the vertex of the parabola through the largest value and its neighbours, unless it is far above them, as at a sharp peak.
fn insert_maximum(curve: &mut Vec<(f64, f64)>, floor: f64) {
    let Some(top) = (0..curve.len()).max_by(|a, b| curve[*a].1.total_cmp(&curve[*b].1)) else { return };
    if top == 0 || top + 1 >= curve.len() {
        return;
    }
    let (origin, largest) = curve[top];
    let Some(fit) = parabola(curve[top - 1..=top + 1].iter().map(|&(e, s)| (e - origin, s, 1.0))) else { return };
    let vertex = -fit.b / (2.0 * fit.c);
    let inside = vertex != 0.0 && (curve[top - 1].0..curve[top + 1].0).contains(&(origin + vertex));
    if fit.c < 0.0 && inside && fit.at(vertex) <= largest + floor {
        let place = if vertex < 0.0 { top } else { top + 1 };
        curve.insert(place, (origin + vertex, fit.at(vertex)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plateau with a knee at its end and a sudden fall later, as at a serration.
    fn stress(strain: f64) -> f64 {
        let fall = if strain > 0.055 { 8e6 } else { 0.0 };
        200e6 + 2e9 * (strain - 0.02).max(0.0) - fall
    }

    fn at(curve: &[(f64, f64)], strain: f64) -> f64 {
        let k = curve.partition_point(|point| point.0 <= strain).clamp(1, curve.len() - 1);
        let (a, b) = (curve[k - 1], curve[k]);
        a.1 + (b.1 - a.1) * (strain - a.0) / (b.0 - a.0)
    }

    #[test]
    fn rows_without_noise_stay_where_they_are() {
        for count in [50, 300, 3000] {
            let strains = (0..count).map(|i| 0.003 + 0.08 * f64::from(i) / f64::from(count - 1));
            let rows: Vec<(f64, f64)> = strains.map(|e| (e, stress(e))).collect();
            let smoothed = smooth(&rows, &vec![0.0; rows.len()], 320e6, None);
            for &(strain, stress) in &rows {
                let off = (at(&smoothed.curve, strain) - stress).abs();
                assert!(off <= 2.0 * FLOOR * 320e6, "{count} rows: {off} Pa off at {strain}");
            }
            assert!(smoothed.slope.abs() < 1e6, "{}", smoothed.slope);
        }
    }

    #[test]
    fn noise_is_reduced_and_the_knee_stays() {
        let rows: Vec<(f64, f64)> = (0..3000)
            .map(|i| (0.003 + 2e-5 * f64::from(i), (f64::from(i) * 12.989_8).sin() * 43_758.545_3))
            .map(|(e, random)| (e, stress(e).max(200e6) + 2e6 * (random - random.floor() - 0.5)))
            .filter(|row| row.0 < 0.05)
            .collect();
        // Evenly between -1 and 1 MPa: 0.58 MPa.
        let smoothed = smooth(&rows, &vec![1e12 / 3.0; rows.len()], 260e6, None);
        let off = |row: &(f64, f64)| (at(&smoothed.curve, row.0) - stress(row.0)).powi(2);
        let error = (rows.iter().map(off).sum::<f64>() / rows.len() as f64).sqrt();
        assert!(error < 0.12e6, "{error}");
        assert!(rows.iter().all(|row| off(row) < 0.6e6_f64.powi(2)));
    }

    #[test]
    fn a_sharp_peak_is_not_rounded_upwards() {
        let mut curve = vec![(0.0, 100e6), (1e-6, 101e6), (1e-3, 100.9e6)];
        insert_maximum(&mut curve, 1e4);
        assert_eq!(curve.len(), 3);
        let mut curve = vec![(0.0, 100e6), (1e-3, 100.01e6), (2e-3, 100.005e6)];
        insert_maximum(&mut curve, 1e4);
        assert_eq!(curve.len(), 4);
    }
}

//! Weighted least squares with polynomials: a straight line, a parabola, or a higher degree.

/// A fit `a + b x + c x^2` about an origin of x; c is 0 for a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fit {
    pub a: f64,
    pub b: f64,
    pub c: f64,
    /// Mean squared residual.
    pub residual: f64,
}

impl Fit {
    pub fn at(&self, x: f64) -> f64 {
        self.a + x * (self.b + x * self.c)
    }
}

/// A point (x, y, weight), with x relative to the origin of the fit.
pub(super) type Point = (f64, f64, f64);

/// Fits a straight line; `None` with fewer than two different x.
pub(super) fn line(points: impl Iterator<Item = Point> + Clone) -> Option<Fit> {
    let [w, x, y, xx, xy] = points
        .clone()
        .fold([0.0; 5], |m, (x, y, w)| [m[0] + w, m[1] + w * x, m[2] + w * y, m[3] + w * x * x, m[4] + w * x * y]);
    let spread = xx - x * x / w;
    if spread.is_nan() || spread <= 1e-12 * xx {
        return None;
    }
    let b = (xy - x * y / w) / spread;
    let fit = Fit { a: (y - b * x) / w, b, c: 0.0, residual: 0.0 };
    Some(Fit { residual: residual(fit, points), ..fit })
}

/// Fits a parabola, or a line if the points do not determine a parabola.
pub(super) fn parabola(points: impl Iterator<Item = Point> + Clone) -> Option<Fit> {
    let straight = line(points.clone())?;
    let Some([a, b, c]) = polynomial(points.clone()) else { return Some(straight) };
    let fit = Fit { a, b, c, residual: 0.0 };
    Some(Fit { residual: residual(fit, points), ..fit })
}

/// Value, slope and standard error of a fit at its origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Estimate {
    pub value: f64,
    pub slope: f64,
    pub error: f64,
}

/// Returns the value and slope at the origin of a parabola fitted to points (x, y, weight, variance), with the standard error of the value due to
/// independent noise of the points. Uses a line, or the mean, if the points do not determine a parabola.
pub(super) fn parabola_with_error(points: impl Iterator<Item = (f64, f64, f64, f64)> + Clone) -> Option<Estimate> {
    estimate::<3>(points.clone()).or_else(|| estimate::<2>(points.clone())).or_else(|| estimate::<1>(points))
}

fn estimate<const N: usize>(points: impl Iterator<Item = (f64, f64, f64, f64)> + Clone) -> Option<Estimate> {
    let weighted = points.clone().map(|(x, y, w, _)| (x, y, w));
    let (unit, m, r) = normal_equations::<N>(weighted);
    let solved = solve(m, r)?;
    // The value is a sum of the y, each multiplied by its weight and by this polynomial.
    let part = solve(m, std::array::from_fn(|k| if k == 0 { 1.0 } else { 0.0 }))?;
    let variance: f64 = points
        .map(|(x, _, w, variance)| {
            let at = part.iter().rev().fold(0.0, |sum, c| sum * (x / unit) + c);
            (w * at).powi(2) * variance
        })
        .sum();
    Some(Estimate { value: solved[0], slope: solved.get(1).map_or(0.0, |b| b / unit), error: variance.sqrt() })
}

/// Returns the coefficients of x^0, x^1, ... of a fitted polynomial with N coefficients (at most 4); `None` if the points do not determine them.
pub(super) fn polynomial<const N: usize>(points: impl Iterator<Item = Point> + Clone) -> Option<[f64; N]> {
    let (unit, m, r) = normal_equations::<N>(points);
    let solved: [f64; N] = solve(m, r)?;
    Some(std::array::from_fn(|k| solved[k] / unit.powi(k as i32)))
}

/// Returns the unit of x, and the normal equations for a polynomial in x over that unit.
fn normal_equations<const N: usize>(points: impl Iterator<Item = Point> + Clone) -> (f64, [[f64; N]; N], [f64; N]) {
    let (w, xx) = points.clone().fold((0.0, 0.0), |m, (x, _, w)| (m.0 + w, m.1 + w * x * x));
    // The root mean square of x as the unit makes the normal equations well conditioned.
    let unit = (xx / w).sqrt();
    let (mut m, mut r) = ([0.0; 7], [0.0; N]);
    for (x, y, w) in points {
        let (u, mut power) = (x / unit, w);
        for (k, moment) in m.iter_mut().enumerate().take(2 * N - 1) {
            *moment += power;
            if k < N {
                r[k] += power * y;
            }
            power *= u;
        }
    }
    (unit, std::array::from_fn(|row| std::array::from_fn(|column| m[row + column])), r)
}

fn residual(fit: Fit, points: impl Iterator<Item = Point>) -> f64 {
    let (sum, weight) = points.fold((0.0, 0.0), |m, (x, y, w)| (m.0 + w * (y - fit.at(x)).powi(2), m.1 + w));
    sum / weight
}

/// Solves linear equations by Gaussian elimination; `None` if they are singular.
fn solve<const N: usize>(mut m: [[f64; N]; N], mut r: [f64; N]) -> Option<[f64; N]> {
    let size = m[0][0].abs();
    for k in 0..N {
        let pivot = (k..N).max_by(|a, b| m[*a][k].abs().total_cmp(&m[*b][k].abs()))?;
        m.swap(k, pivot);
        r.swap(k, pivot);
        if m[k][k].is_nan() || m[k][k].abs() <= 1e-10 * size {
            return None;
        }
        for row in k + 1..N {
            let factor = m[row][k] / m[k][k];
            let above = m[k];
            for (value, above) in m[row].iter_mut().zip(above).skip(k) {
                *value -= factor * above;
            }
            r[row] -= factor * r[k];
        }
    }
    for k in (0..N).rev() {
        let known: f64 = (k + 1..N).map(|column| m[k][column] * r[column]).sum();
        r[k] = (r[k] - known) / m[k][k];
    }
    Some(r)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_recovered() {
        let points: Vec<Point> =
            (0..20).map(|i| 1e-3 * f64::from(i)).map(|x| (x, 3.0 - 2.0 * x + 5.0 * x * x, 1.0 + x)).collect();
        let fit = parabola(points.iter().copied()).expect("a fit");
        assert!((fit.a - 3.0).abs() < 1e-10 && (fit.b + 2.0).abs() < 1e-8 && (fit.c - 5.0).abs() < 1e-5, "{fit:?}");
        let with_error = points.iter().map(|&(x, y, w)| (x, y, w, 0.0));
        let estimate = parabola_with_error(with_error).expect("an estimate");
        assert!((estimate.value - 3.0).abs() < 1e-10 && (estimate.slope + 2.0).abs() < 1e-8 && estimate.error == 0.0);
        // Five even points: the middle of the parabola is (-3, 12, 17, 12, -3)/35 of them, with an error of sqrt(17/35).
        let even = (-2..=2).map(|x| (f64::from(x), 1.0, 1.0, 4.0));
        let estimate = parabola_with_error(even).expect("an estimate");
        assert!((estimate.error - 2.0 * (17.0_f64 / 35.0).sqrt()).abs() < 1e-12, "{estimate:?}");
        let fit = line(points.iter().map(|p| (p.0, 1.0 + 4.0 * p.0, 1.0))).expect("a fit");
        assert!((fit.b - 4.0).abs() < 1e-10 && fit.residual < 1e-24);
        assert!(line([(1.0, 2.0, 1.0), (1.0, 3.0, 1.0)].into_iter()).is_none());
    }
}

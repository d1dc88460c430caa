//! Smoothing of the plastic part of a record: local quadratic regression with tricube weights (Cleveland, JASA 74, 1979, 829-836).
//!
//! The half-width at a strain is half of the distance to the end of the elastic line, since curves of metals bend the less the farther they
//! are from yield, or what it takes to bring the noise down to a thousandth of the largest stress. It is made smaller until the residuals
//! are no larger than the noise, so that knees, yield drops and plateaus stay.

use super::fit::{Fit, parabola};

/// Half-width over the distance to the end of the elastic line.
const HALF_WIDTH: f64 = 0.5;

/// Factor by which the half-width is made smaller.
const SMALLER: f64 = 0.75;

/// Fewest rows on either side, where there are any, and most for the sake of noise.
const FEWEST: usize = 5;
const MOST: f64 = 200.0;

/// Standard error to which noise is brought down, over the largest stress.
const PRECISION: f64 = 1e-3;

/// Standard error of a local parabola with tricube weights over that of the mean of its rows.
const PARABOLA: f64 = 1.9;

/// Residuals below this part of the largest stress are none.
const FLOOR: f64 = 2e-4;

/// Strains at which the curve is evaluated grow by this factor, from the end of the elastic line.
const STEP: f64 = 1.03;

/// A smoothed curve.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Smooth {
    /// (strain, stress) at the first row, at strains whose distance from it grows like a geometric series, and at the largest stress.
    pub curve: Vec<(f64, f64)>,
    /// Slope at the first row.
    pub slope: f64,
}

/// Smooths rows (strain increasing), the first of which are the first past the elastic line, by a window of a given width in strain or as the
/// rows ask for.
pub(super) fn smooth(rows: &[(f64, f64)], variances: &[f64], largest: f64, window: Option<f64>) -> Smooth {
    let (start, end) = (rows[0].0, rows[rows.len() - 1].0);
    let first = (2.0 * (rows[rows.len().min(9) - 1].0 - start) / 8.0).max(1e-6 * (end - start));
    let steps = std::iter::successors(Some(first), |p| Some(p * STEP)).take_while(|p| start + p * STEP < end);
    let strains: Vec<f64> = std::iter::once(start).chain(steps.map(|p| start + p)).chain([end]).collect();
    let precise = (PRECISION * largest / PARABOLA).powi(2);
    let local = Local { rows, variances, floor: (FLOOR * largest).powi(2), precise };
    let half_width = |e: f64| match window {
        // A parabola needs some rows, however narrow the window is.
        Some(window) => (0.5 * window).max(local.holding(e, FEWEST)),
        None => local.half_width(e, e - start),
    };
    let widths: Vec<f64> = strains.iter().map(|&e| half_width(e)).collect();
    let mut smooth = Smooth { curve: Vec::new(), slope: 0.0 };
    for (k, &strain) in strains.iter().enumerate() {
        let near = &widths[k.saturating_sub(2)..(k + 3).min(widths.len())];
        // A width that changes from place to place would leave steps.
        let width = near.iter().fold(f64::INFINITY, |a: f64, b| a.min(1.5 * b)).min(mean_of_logarithms(near));
        if let Some(fit) = local.fit(strain, width) {
            if k == 0 {
                smooth.slope = fit.b;
            }
            smooth.curve.push((strain, fit.a));
        }
    }
    insert_maximum(&mut smooth.curve);
    smooth
}

fn mean_of_logarithms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64).exp()
}

struct Local<'a> {
    rows: &'a [(f64, f64)],
    variances: &'a [f64],
    floor: f64,
    /// Variance to which noise is brought down by the rows of a window, Pa^2.
    precise: f64,
}

impl Local<'_> {
    /// The largest half-width, up to [`HALF_WIDTH`] of `distance` or what the noise needs, with residuals of the size of the noise.
    fn half_width(&self, strain: f64, distance: f64) -> f64 {
        let least = self.holding(strain, FEWEST);
        let noise = self.variances[self.rows.partition_point(|row| row.0 < strain).min(self.rows.len() - 1)..]
            .iter()
            .take(50)
            .copied()
            .fold((0.0, 0.0), |sum, v| (sum.0 + v, sum.1 + 1.0));
        let needed = (0.5 * noise.0 / noise.1 / self.precise).clamp(FEWEST as f64, MOST) as usize;
        let mut width = (HALF_WIDTH * distance).max(self.holding(strain, needed));
        while width > least && !self.fits(strain, width) {
            width = (SMALLER * width).max(least);
        }
        width
    }

    /// The half-width that holds so many rows on either side, or twice as many on one side at the first and the last row.
    fn holding(&self, strain: f64, rows: usize) -> f64 {
        let at = self.rows.partition_point(|row| row.0 < strain);
        let one_sided = if at == 0 || at + 1 >= self.rows.len() { 2 * rows } else { rows };
        let (low, high) = (at.saturating_sub(one_sided), (at + one_sided).min(self.rows.len() - 1));
        (strain - self.rows[low].0).max(self.rows[high].0 - strain)
    }

    fn fits(&self, strain: f64, width: f64) -> bool {
        let Some(fit) = self.fit(strain, width) else { return false };
        let (mut weight, mut squares, mut noise) = (0.0, 0.0, 0.0);
        for k in self.within(strain, width) {
            let w = tricube((self.rows[k].0 - strain) / width);
            weight += w;
            squares += w * w;
            noise += w * self.variances[k];
        }
        let independent = weight * weight / squares;
        fit.residual <= noise / weight * (1.0 + 4.0 / independent.sqrt()) + self.floor
    }

    fn within(&self, strain: f64, width: f64) -> std::ops::Range<usize> {
        let first = self.rows.partition_point(|row| row.0 <= strain - width);
        first..self.rows.partition_point(|row| row.0 < strain + width)
    }

    fn fit(&self, strain: f64, width: f64) -> Option<Fit> {
        let rows = &self.rows[self.within(strain, width)];
        parabola(rows.iter().map(|&(e, s)| (e - strain, s, tricube((e - strain) / width))))
    }
}

fn tricube(x: f64) -> f64 {
    let rest = 1.0 - x.abs().powi(3);
    if rest > 0.0 { rest.powi(3) } else { 0.0 }
}

/// Adds the vertex of the parabola through the largest value and its neighbours.
fn insert_maximum(curve: &mut Vec<(f64, f64)>) {
    let Some(top) = (0..curve.len()).max_by(|a, b| curve[*a].1.total_cmp(&curve[*b].1)) else { return };
    if top == 0 || top + 1 >= curve.len() {
        return;
    }
    let origin = curve[top].0;
    let Some(fit) = parabola(curve[top - 1..=top + 1].iter().map(|&(e, s)| (e - origin, s, 1.0))) else { return };
    let vertex = -fit.b / (2.0 * fit.c);
    if fit.c < 0.0 && vertex != 0.0 && (curve[top - 1].0..curve[top + 1].0).contains(&(origin + vertex)) {
        let place = if vertex < 0.0 { top } else { top + 1 };
        curve.insert(place, (origin + vertex, fit.at(vertex)));
    }
}

//! Estimation of the curve at one strain by local quadratic regression with tricube weights (Cleveland, JASA 74, 1979, 829-836), in the widest
//! window that the noise allows (Lepskii, Theory Probab. Appl. 35, 1990, 454-466).
//!
//! Windows grow from the rows on either side of the strain. Each gives a stress with its standard error, and a window is admitted as long as its
//! stress agrees with those of all narrower windows. Therefore the curve moves by no more than the noise of its rows, and rows without noise are
//! not changed, including knees and yield drops.

use super::fit::{Estimate, parabola_with_error};

/// Factor by which windows grow.
const LARGER: f64 = 4.0 / 3.0;

/// Number of standard errors within which stresses agree.
pub(super) const AGREE: f64 = 2.5;

/// Standard error over the floor below which a wider window is not needed.
const ENOUGH: f64 = 0.25;

/// Rows with the variances of their noise.
pub(super) struct Local<'a> {
    /// (strain, stress), strain increasing.
    pub rows: &'a [(f64, f64)],
    /// Variances of the stresses, Pa^2.
    pub variances: &'a [f64],
    /// Difference up to which stresses agree even without noise, Pa.
    pub floor: f64,
}

impl Local<'_> {
    /// Returns the half-width of the widest window, up to `most`, whose stress agrees with those of all narrower windows; 0 stands for the straight
    /// line between the rows. Windows with a larger standard error than a narrower one, such as those with rows on one side only, are skipped.
    pub fn half_width(&self, strain: f64, most: f64) -> f64 {
        let (mut width, mut least) = (0.0, f64::INFINITY);
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut next = 0.0;
        while let Some(estimate) = self.estimate(strain, next) {
            if estimate.error <= least {
                let tolerance = AGREE * estimate.error + self.floor;
                (low, high) = (low.max(estimate.value - tolerance), high.min(estimate.value + tolerance));
                if low > high {
                    break;
                }
                (width, least) = (next, estimate.error);
            }
            if next >= most || least < ENOUGH * self.floor {
                break;
            }
            next = if next > 0.0 { (LARGER * next).min(most) } else { self.holding(strain, 1).min(most) };
        }
        width
    }

    /// Returns the half-width of the window with this number of rows on either side, or twice as many on one side at the first and the last row.
    pub fn holding(&self, strain: f64, rows: usize) -> f64 {
        let at = self.rows.partition_point(|row| row.0 < strain);
        let one_sided = if at == 0 || at + 1 >= self.rows.len() { 2 * rows } else { rows };
        let (low, high) = (at.saturating_sub(one_sided), (at + one_sided).min(self.rows.len() - 1));
        (strain - self.rows[low].0).max(self.rows[high].0 - strain)
    }

    /// Returns the stress, its slope and its standard error in a window; interpolates between the neighbouring rows if it has fewer than three.
    pub fn estimate(&self, strain: f64, width: f64) -> Option<Estimate> {
        let first = self.rows.partition_point(|row| row.0 <= strain - width);
        let end = self.rows.partition_point(|row| row.0 < strain + width);
        if end < first + 3 {
            return self.between_rows(strain);
        }
        let points = (first..end).map(|k| {
            let (e, s) = self.rows[k];
            (e - strain, s, tricube((e - strain) / width), self.variances[k])
        });
        parabola_with_error(points)
    }

    /// Interpolates linearly between the two rows beside a strain.
    fn between_rows(&self, strain: f64) -> Option<Estimate> {
        let after = self.rows.partition_point(|row| row.0 <= strain).clamp(1, self.rows.len() - 1);
        let ((e, s), (end, to)) = (*self.rows.get(after - 1)?, *self.rows.get(after)?);
        let part = (strain - e) / (end - e);
        let variance = (1.0 - part).powi(2) * self.variances[after - 1] + part * part * self.variances[after];
        Some(Estimate { value: s + part * (to - s), slope: (to - s) / (end - e), error: variance.sqrt() })
    }
}

fn tricube(x: f64) -> f64 {
    let rest = 1.0 - x.abs().powi(3);
    if rest > 0.0 { rest.powi(3) } else { 0.0 }
}

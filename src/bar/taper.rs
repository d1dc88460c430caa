//! Section that varies along a segment: a table of areas or diameters, linear between its rows.

use std::f64::consts::PI;

use serde::Serialize;

use super::{Distribution, RowError};

/// Quantity given by the rows of a taper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Profile {
    /// Areas, m^2; the area is linear between rows.
    Area,
    /// Diameters of round sections, m; the diameter is linear between rows (a cone).
    Diameter,
}

/// Section along a segment; x is measured from the left end of the segment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Taper {
    profile: Profile,
    x: Vec<f64>,
    size: Vec<f64>,
}

impl Taper {
    /// Builds a taper from rows (x in m, size in m^2 or m): at least two, x increasing from 0, sizes > 0, all finite.
    ///
    /// # Errors
    /// Returns the first row that violates a rule, and the rule.
    pub fn new(profile: Profile, rows: &[(f64, f64)]) -> Result<Self, RowError> {
        for (i, &(x, size)) in rows.iter().enumerate() {
            if !x.is_finite() || !size.is_finite() {
                return Err(RowError::of(i, "is not finite"));
            }
            if size <= 0.0 {
                return Err(RowError::of(i, "is not positive"));
            }
            if i == 0 && x != 0.0 {
                return Err(RowError::of(0, "is not at the left end of the segment, x = 0"));
            }
            if i > 0 && x <= rows[i - 1].0 {
                return Err(RowError::of(i, "does not have a larger x than the row before it"));
            }
        }
        if rows.len() < 2 {
            let rule = "is the only row: a taper needs a row at each end of the segment";
            return Err(RowError::of(rows.len().saturating_sub(1), rule));
        }
        Ok(Self { profile, x: rows.iter().map(|r| r.0).collect(), size: rows.iter().map(|r| r.1).collect() })
    }

    /// Returns the position of the last row, m.
    pub fn length(&self) -> f64 {
        self.x[self.x.len() - 1]
    }

    /// Returns true if all rows have the same size.
    pub fn is_uniform(&self) -> bool {
        self.size.iter().all(|&size| size == self.size[0])
    }

    /// Returns the area at x, m^2; outside of the table, that of the nearest row.
    pub fn area(&self, x: f64) -> f64 {
        let last = self.x.len() - 1;
        let k = self.x.partition_point(|&row| row <= x).clamp(1, last) - 1;
        let part = ((x - self.x[k]) / (self.x[k + 1] - self.x[k])).clamp(0.0, 1.0);
        self.area_of((1.0 - part) * self.size[k] + part * self.size[k + 1])
    }

    fn area_of(&self, size: f64) -> f64 {
        match self.profile {
            Profile::Area => size,
            Profile::Diameter => PI / 4.0 * size * size,
        }
    }

    /// Returns the mean area over `from..to` (m, from < to). Exact, since the area is at most quadratic in x and Simpson's rule is exact for it.
    pub fn mean(&self, from: f64, to: f64) -> f64 {
        let mut volume = 0.0;
        let mut add = |a: f64, b: f64| {
            volume += (b - a) / 6.0 * (self.area(a) + 4.0 * self.area(0.5 * (a + b)) + self.area(b));
        };
        let mut left = from;
        for &row in self.x.iter().filter(|&&row| row > from && row < to) {
            add(left, row);
            left = row;
        }
        add(left, to);
        volume / (to - from)
    }

    /// Returns the volume-weighted mean of `values` along the segment. Exact, since between rows their product with the area is at most cubic in x,
    /// for which Simpson's rule is exact, too.
    pub fn mean_of(&self, values: &Distribution) -> f64 {
        let inside = values.rows().map(|row| row.0).filter(|&x| x < self.length());
        let mut ends: Vec<f64> = self.x.iter().copied().chain(inside).collect();
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let part = |pair: &[f64]| {
            let (a, b, middle) = (pair[0], pair[1], 0.5 * (pair[0] + pair[1]));
            let product = |x: f64, value: f64| self.area(x) * value;
            (b - a) / 6.0
                * (product(a, values.at(a)) + 4.0 * product(middle, values.at(middle)) + product(b, values.before(b)))
        };
        let sum: f64 = ends.windows(2).map(part).sum();
        sum / (self.length() * self.mean(0.0, self.length()))
    }

    /// Returns the rows: x (m) and size (m^2 or m).
    pub fn rows(&self) -> impl Iterator<Item = (f64, f64)> {
        self.x.iter().copied().zip(self.size.iter().copied())
    }

    /// Returns the exponent with which the area depends on the size.
    fn power(&self) -> f64 {
        if self.profile == Profile::Area { 1.0 } else { 2.0 }
    }

    /// Returns the largest |dA/dx|/A, 1/m.
    pub fn steepest(&self) -> f64 {
        let power = self.power();
        let pair =
            |(x, size): (&[f64], &[f64])| power * (size[1] - size[0]).abs() / ((x[1] - x[0]) * size[0].min(size[1]));
        self.x.windows(2).zip(self.size.windows(2)).map(pair).fold(0.0, f64::max)
    }

    /// Returns, for each part in which the area is monotonic, its length, m, and the logarithm of the ratio of its end areas.
    pub fn stretches(&self) -> Vec<[f64; 2]> {
        let power = self.power();
        let rows = self.x.windows(2).zip(self.size.windows(2));
        let mut stretches: Vec<[f64; 2]> = Vec::new();
        for (x, size) in rows {
            let (length, grown) = (x[1] - x[0], power * (size[1] / size[0]).ln());
            match stretches.last_mut() {
                Some(last) if last[1] * grown >= 0.0 => *last = [last[0] + length, last[1] + grown],
                _ => stretches.push([length, grown]),
            }
        }
        stretches
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_exact_for_cones_and_wedges() {
        let wedge = Taper::new(Profile::Area, &[(0.0, 1.0), (1.0, 3.0), (2.0, 2.0)]).expect("rows are right");
        assert_eq!((wedge.area(0.5), wedge.area(1.0), wedge.area(1.5), wedge.area(9.0)), (2.0, 3.0, 2.5, 2.0));
        assert!((wedge.mean(0.5, 1.5) - 2.625).abs() < 1e-15);
        assert_eq!(wedge.steepest(), 2.0);
        // A cone of height 3 from its apex, truncated at 1: volume pi/12 (27 - 1) for a diameter equal to the height.
        let cone = Taper::new(Profile::Diameter, &[(0.0, 1.0), (2.0, 3.0)]).expect("rows are right");
        let volume = PI / 12.0 * 26.0;
        assert!((2.0 * cone.mean(0.0, 2.0) - volume).abs() < 1e-14 * volume);
        assert_eq!(cone.steepest(), 2.0);
        assert!(
            !cone.is_uniform() && Taper::new(Profile::Area, &[(0.0, 2.0), (1.0, 2.0)]).expect("right").is_uniform()
        );
    }

    #[test]
    fn wrong_rows_are_refused_by_index() {
        let wrong = |rows: &[(f64, f64)]| Taper::new(Profile::Area, rows).expect_err("wrong").at();
        assert_eq!(wrong(&[]), 0);
        assert_eq!(wrong(&[(0.0, 1.0)]), 0);
        assert_eq!(wrong(&[(0.1, 1.0), (1.0, 1.0)]), 0);
        assert_eq!(wrong(&[(0.0, 1.0), (0.0, 2.0)]), 1);
        assert_eq!(wrong(&[(0.0, 1.0), (1.0, 0.0)]), 1);
        assert_eq!(wrong(&[(0.0, 1.0), (1.0, f64::NAN)]), 1);
    }
}

//! Stress-strain curve of first loading: a checked table, linear between its knots.

use serde::{Deserialize, Serialize};

use crate::error::{Error, InputError};
use crate::units::Dimension;

/// Behaviour after the last knot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Beyond {
    /// The specimen fractured at the last row.
    Rupture,
    /// Extrapolation with the last slope.
    Extend,
    /// The run stops.
    Error,
}

/// The ultimate point of a curve, which determines its critical impact velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ultimate {
    /// Ultimate strain.
    pub strain: f64,
    /// Ultimate stress, Pa.
    pub stress: f64,
    /// Reason why it is the ultimate point.
    pub reason: UltimateReason,
}

/// Reason for which a point is the ultimate point of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum UltimateReason {
    /// The engineering stress has its maximum within the data and does not exceed it later.
    MaximumStress,
    /// The data end with fracture while the stress still rises.
    RuptureStrain,
}

/// An error in a table of rows. Its message counts rows from 1, as in files; the [`InputError`] converted from it counts from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("row {}: {message}", row + 1)]
pub struct CurveError {
    /// Row of the table as given, from 0.
    pub row: usize,
    /// What is wrong, with the value.
    pub message: String,
}

impl From<CurveError> for InputError {
    fn from(CurveError { row, message }: CurveError) -> Self {
        let error = Self::new(format!("row {row} (counted from 0): {message}")).key("rows");
        error.allowed(CurveError::ALLOWED).help("correct this row of the stress-strain curve")
    }
}

impl From<CurveError> for Error {
    fn from(error: CurveError) -> Self {
        InputError::from(error).into()
    }
}

impl CurveError {
    /// Requirements on the rows.
    pub(crate) const ALLOWED: &'static str = "finite, not negative, strain increasing from row to row";
}

/// A piecewise linear curve of stress and strain magnitudes that starts at (0, 0), with strictly increasing strain. Stress may fall (a yield drop,
/// necking) and slopes may increase (lock-up).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    strain: Vec<f64>,
    stress: Vec<f64>,
    beyond: Beyond,
}

impl Curve {
    /// Creates a curve from a table of (strain, stress in Pa) magnitudes. A missing first row (0, 0) is added.
    ///
    /// # Errors
    /// Fewer than two knots, a value that is negative or not finite, strain that does not increase, stress at zero strain, or an initial slope that
    /// is not positive.
    pub fn new(rows: &[(f64, f64)], beyond: Beyond) -> Result<Self, CurveError> {
        for row in 0..rows.len() {
            check_row(rows, row)?;
        }
        let origin_missing = rows.first().is_none_or(|r| r.0 > 0.0);
        let origin = origin_missing.then_some((0.0, 0.0));
        let (strain, stress): (Vec<f64>, Vec<f64>) = origin.into_iter().chain(rows.iter().copied()).unzip();
        if strain.len() < 2 {
            return Err(refuse(0, "the table needs at least one row with a strain above 0"));
        }
        if stress[1] <= 0.0 {
            let row = usize::from(!origin_missing);
            return Err(refuse(row, format!("stress {:e} Pa does not rise from the origin", stress[1])));
        }
        Ok(Self { strain, stress, beyond })
    }

    /// Returns the strains of the knots, starting at 0.
    pub fn strain(&self) -> &[f64] {
        &self.strain
    }

    /// Returns the stresses of the knots, Pa, starting at 0.
    pub fn stress(&self) -> &[f64] {
        &self.stress
    }

    /// Returns the behaviour after the last knot.
    pub fn beyond(&self) -> Beyond {
        self.beyond
    }

    /// Iterates over the slopes of the segments, Pa; one fewer than knots.
    pub fn slopes(&self) -> impl Iterator<Item = f64> + '_ {
        self.strain.windows(2).zip(self.stress.windows(2)).map(|(e, s)| (s[1] - s[0]) / (e[1] - e[0]))
    }

    /// Returns the steepest slope, Pa.
    pub fn steepest(&self) -> f64 {
        self.slopes().fold(0.0, f64::max)
    }

    /// Returns the strain of the last knot.
    pub fn last_strain(&self) -> f64 {
        self.strain[self.strain.len() - 1]
    }

    /// Returns the elastic limit (strain, stress): the end of the part that follows the slope `modulus` from the origin. (0, 0) if the initial
    /// slope is smaller than `modulus`.
    pub fn elastic_limit(&self, modulus: f64) -> (f64, f64) {
        let follows = self.slopes().take_while(|&slope| (slope / modulus - 1.0).abs() <= SLOPE_ROUND_OFF).count();
        (self.strain[follows], self.stress[follows])
    }

    /// Moves the first rows exactly onto the line of slope `modulus` through the origin, as long as only the rounding of the written digits
    /// separates them from it. The strains are changed, since stresses are more often round numbers.
    #[must_use]
    pub(super) fn on_elastic_line(mut self, modulus: f64) -> Self {
        for k in 1..self.strain.len() {
            let off = (self.stress[k] / (modulus * self.strain[k]) - 1.0).abs();
            let strain = self.stress[k] / modulus;
            let increases = strain > self.strain[k - 1] && self.strain.get(k + 1).is_none_or(|next| strain < *next);
            if off > SECANT_ROUND_OFF || !increases {
                break;
            }
            if off > EXACT {
                self.strain[k] = strain;
            }
        }
        self
    }

    /// Returns the first segment steeper than `modulus`: index of its upper knot, and its slope, Pa.
    pub fn steeper_than(&self, modulus: f64) -> Option<(usize, f64)> {
        self.slopes().enumerate().find(|&(_, slope)| slope > modulus * (1.0 + SLOPE_ROUND_OFF)).map(|(k, s)| (k + 1, s))
    }

    /// Returns the slope of the last segment, Pa.
    pub fn last_slope(&self) -> f64 {
        self.slope(self.strain.len() - 2)
    }

    /// Returns the stress at a strain >= 0. After the last knot it continues with the last slope for `Beyond::Extend`, and is otherwise the last
    /// stress.
    pub fn stress_at(&self, strain: f64) -> f64 {
        let last = self.strain.len() - 1;
        let upper = self.strain.partition_point(|&knot| knot <= strain);
        if upper <= last {
            let k = upper.max(1) - 1;
            return self.stress[k] + self.slope(k) * (strain - self.strain[k]);
        }
        match self.beyond {
            Beyond::Extend => self.stress[last] + self.last_slope() * (strain - self.strain[last]),
            Beyond::Rupture | Beyond::Error => self.stress[last],
        }
    }

    /// Returns the ultimate point, which determines the critical velocity; `None` if the data do not contain it.
    ///
    /// It is the first knot that has the largest stress, so that a plateau counts from its start. It does not count if the curve can rise above it:
    /// if the largest stress is that of the last knot, or if an extension rises without limit. A curve that ends with fracture while it rises
    /// (`Beyond::Rupture`) has its ultimate point at the last knot, with a different reason.
    pub fn ultimate(&self) -> Option<Ultimate> {
        let last = self.strain.len() - 1;
        let top = (1..=last).fold(0, |top, k| if self.stress[k] > self.stress[top] { k } else { top });
        let point = |reason| Some(Ultimate { strain: self.strain[top], stress: self.stress[top], reason });
        let rises_at_end = self.last_slope() > 0.0;
        match self.beyond {
            Beyond::Extend if rises_at_end => None,
            Beyond::Error if top == last => None,
            Beyond::Rupture if top == last => point(UltimateReason::RuptureStrain),
            _ => point(UltimateReason::MaximumStress),
        }
    }

    /// Whether a run cannot continue past the last knot because nothing is known there. If the data contain a maximum of the stress, no more is
    /// needed, because waves carry no larger stress.
    pub fn stops_at_end(&self) -> bool {
        self.beyond == Beyond::Error && self.ultimate().is_none()
    }

    /// Returns the curve with every drop filled: f(e) = max over e' <= e of the table. This is the stress that waves can carry into the bar, since
    /// a falling stress has no wave speed; the upper concave hull is unchanged.
    ///
    /// If an extension exceeds an earlier maximum only after the last knot, knots are added there, so that the last strain can be larger than that
    /// of this curve.
    #[must_use]
    pub fn running_maximum(&self) -> Self {
        let mut strain = vec![0.0];
        let mut stress = vec![0.0];
        let mut top: f64 = 0.0;
        for k in 1..self.strain.len() {
            if self.stress[k] > top && self.stress[k - 1] < top {
                push_distinct(&mut strain, &mut stress, self.reaches(k - 1, top), top);
            }
            top = top.max(self.stress[k]);
            push_distinct(&mut strain, &mut stress, self.strain[k], top);
        }
        let last = self.strain.len() - 1;
        if self.beyond == Beyond::Extend && self.last_slope() > 0.0 && self.stress[last] < top {
            let crossing = self.reaches(last - 1, top);
            let width = self.strain[last] - self.strain[last - 1];
            push_distinct(&mut strain, &mut stress, crossing, top);
            push_distinct(&mut strain, &mut stress, crossing + width, top + self.last_slope() * width);
        }
        Self { strain, stress, beyond: self.beyond }
    }

    /// Returns the slope of segment `k`, Pa.
    fn slope(&self, k: usize) -> f64 {
        (self.stress[k + 1] - self.stress[k]) / (self.strain[k + 1] - self.strain[k])
    }

    /// Returns the strain at which the line of segment `k` has this stress.
    fn reaches(&self, k: usize, stress: f64) -> f64 {
        self.strain[k] + (stress - self.stress[k]) / self.slope(k)
    }
}

/// Relative difference up to which slopes count as equal: strains written as decimals carry a relative error of 1e-16, which becomes 1e-10 of the
/// slope for a segment of 1e-6 of its strain.
pub(crate) const SLOPE_ROUND_OFF: f64 = 1e-10;

/// Relative difference from the modulus up to which secants from the origin are on the elastic line: half a unit of the last of six significant
/// digits, with which strains are often written.
pub(super) const SECANT_ROUND_OFF: f64 = 5e-6;

/// As [`SECANT_ROUND_OFF`], for numbers that are not rounded to decimals: their rows are not moved.
const EXACT: f64 = 1e-15;

/// Formats a slope that is too steep, and the modulus, with as many digits as show the difference, at least seven.
pub(super) fn above_modulus(slope: f64, modulus: f64) -> String {
    let digits = (1.0 - (slope / modulus - 1.0).log10()).clamp(6.0, 15.0) as usize;
    format!("{slope:.digits$e} Pa, above the modulus {modulus:.digits$e} Pa")
}

fn refuse(row: usize, message: impl Into<String>) -> CurveError {
    CurveError { row, message: message.into() }
}

/// Checks one row by itself and against the previous one.
fn check_row(rows: &[(f64, f64)], row: usize) -> Result<(), CurveError> {
    let (strain, stress) = rows[row];
    for (name, value) in [("strain", strain), ("stress", stress)] {
        if !value.is_finite() {
            return Err(refuse(row, format!("{name} is {value}, not a finite number")));
        }
        if value < 0.0 {
            return Err(refuse(row, format!("{name} {value:e} is negative; curves are given as magnitudes")));
        }
    }
    let range = Dimension::Stress.magnitudes();
    if stress > range.most || (stress > 0.0 && stress < range.least) || strain > Dimension::None.magnitudes().most {
        return Err(refuse(row, format!("strain {strain:e} with stress {stress:e} Pa: {}", range.reason)));
    }
    if strain == 0.0 && stress != 0.0 {
        return Err(refuse(row, format!("stress {stress:e} Pa at zero strain; the curve starts at (0, 0)")));
    }
    let Some(before) = row.checked_sub(1).map(|r| rows[r].0) else { return Ok(()) };
    if strain == before {
        return Err(refuse(row, format!("strain {strain:e} is given twice")));
    }
    if strain < before {
        return Err(refuse(row, format!("strain {strain:e} is smaller than {before:e} in the row before")));
    }
    Ok(())
}

/// Appends a knot, unless round-off has placed it on the previous one.
fn push_distinct(strain: &mut Vec<f64>, stress: &mut Vec<f64>, e: f64, s: f64) {
    if strain.last().is_none_or(|&last| e > last) {
        strain.push(e);
        stress.push(s);
    }
}

//! A first-loading stress-strain curve: a checked table, linear between its knots.

use serde::{Deserialize, Serialize};

use crate::error::{Error, InputError};
use crate::units::Dimension;

/// What happens past the last knot.
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

/// The point on which a critical impact velocity rests.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ultimate {
    /// Strain at that point.
    pub strain: f64,
    /// Stress at that point, Pa.
    pub stress: f64,
    /// Why it is the ultimate point.
    pub reason: UltimateReason,
}

/// Why a curve has an ultimate point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum UltimateReason {
    /// The engineering stress has its largest value inside the data and does not rise after it.
    MaximumStress,
    /// The data end by fracture while the stress still rises.
    RuptureStrain,
}

/// Why a table is refused: the row (from 0) and the values that are wrong. Its message counts rows from 1, as in files, that of the
/// [`InputError`] it becomes from 0.
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
    /// What rows have to be.
    pub(crate) const ALLOWED: &'static str = "finite, not negative, strain increasing from row to row";
}

/// Straight between knots, starting at (0, 0); magnitudes; strain strictly increasing. Stress may fall (a yield
/// drop, necking) and slopes may grow (lock-up).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    strain: Vec<f64>,
    stress: Vec<f64>,
    beyond: Beyond,
}

impl Curve {
    /// Checks a table of (strain, stress in Pa) magnitudes. A missing first row (0, 0) is added.
    ///
    /// # Errors
    /// Fewer than two knots, a value that is not finite or negative, strain that does not increase, stress at
    /// zero strain, a first slope that is not positive.
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

    /// Knot strains, from 0.
    pub fn strain(&self) -> &[f64] {
        &self.strain
    }

    /// Knot stresses, Pa, from 0.
    pub fn stress(&self) -> &[f64] {
        &self.stress
    }

    /// What happens past the last knot.
    pub fn beyond(&self) -> Beyond {
        self.beyond
    }

    /// Slopes of the segments, Pa; one fewer than knots.
    pub fn slopes(&self) -> impl Iterator<Item = f64> + '_ {
        self.strain.windows(2).zip(self.stress.windows(2)).map(|(e, s)| (s[1] - s[0]) / (e[1] - e[0]))
    }

    /// The steepest slope, Pa.
    pub fn steepest(&self) -> f64 {
        self.slopes().fold(0.0, f64::max)
    }

    /// Strain of the last knot.
    pub fn last_strain(&self) -> f64 {
        self.strain[self.strain.len() - 1]
    }

    /// End of the part that follows `modulus` from the origin (strain, stress): the elastic limit. (0, 0) where
    /// the first slope is smaller than `modulus`.
    pub fn elastic_limit(&self, modulus: f64) -> (f64, f64) {
        let follows = self.slopes().take_while(|&slope| (slope / modulus - 1.0).abs() <= SLOPE_ROUND_OFF).count();
        (self.strain[follows], self.stress[follows])
    }

    /// With the first rows exactly on the line of `modulus` from the origin, as long as only the rounding of the written digits takes them off
    /// it: the strains move, since stresses are round numbers more often.
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

    /// The first segment steeper than `modulus`: index of its upper knot and its slope, Pa.
    pub fn steeper_than(&self, modulus: f64) -> Option<(usize, f64)> {
        self.slopes().enumerate().find(|&(_, slope)| slope > modulus * (1.0 + SLOPE_ROUND_OFF)).map(|(k, s)| (k + 1, s))
    }

    /// Slope of the last segment, Pa.
    pub fn last_slope(&self) -> f64 {
        self.slope(self.strain.len() - 2)
    }

    /// Stress at a strain >= 0; past the last knot with the last slope if `Beyond::Extend`, otherwise the
    /// last stress.
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

    /// The point on which the critical velocity rests, or none within the data.
    ///
    /// It is the first knot that has the largest stress, so a plateau counts from its start. It counts unless
    /// the curve rises past it: that is so where the largest stress is the last knot's and the curve still
    /// rises there, or where an extension rises for ever. A curve that breaks while it rises
    /// (`Beyond::Rupture`) has its ultimate point at the last knot, with its own reason.
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

    /// True where a run cannot continue past the last knot: nothing is known there. Past a largest stress inside the data
    /// nothing more is needed of them: waves carry no more than that.
    pub fn stops_at_end(&self) -> bool {
        self.beyond == Beyond::Error && self.ultimate().is_none()
    }

    /// The curve with every drop filled: f(e) = max over e' <= e of the table. This is what waves can carry into
    /// the bar, since a falling stress has no wave speed; with its upper concave hull unchanged.
    ///
    /// Where an extension rises past an earlier maximum only after the last knot, knots are added there, so the
    /// last strain can be larger than this curve's.
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

    /// Slope of segment `k`, Pa.
    fn slope(&self, k: usize) -> f64 {
        (self.stress[k + 1] - self.stress[k]) / (self.strain[k + 1] - self.strain[k])
    }

    /// Strain at which the line of segment `k` has this stress.
    fn reaches(&self, k: usize, stress: f64) -> f64 {
        self.strain[k] + (stress - self.stress[k]) / self.slope(k)
    }
}

/// Slopes that differ by less than this (relative) are the same line: strains written in decimals carry a
/// relative error of 1e-16, which a segment 1e-6 of its strain long turns into 1e-10 of its slope.
pub(crate) const SLOPE_ROUND_OFF: f64 = 1e-10;

/// Secants from the origin that differ from the modulus by less than this (relative) are on the elastic line: half a unit of the last of six
/// significant digits, to which strains are often written.
pub(super) const SECANT_ROUND_OFF: f64 = 5e-6;

/// The same of numbers that are not rounded in decimals: their rows stay as they are.
const EXACT: f64 = 1e-15;

/// A slope that is too steep, and the modulus, in as many digits as show the difference, at least seven.
pub(super) fn above_modulus(slope: f64, modulus: f64) -> String {
    let digits = (1.0 - (slope / modulus - 1.0).log10()).clamp(6.0, 15.0) as usize;
    format!("{slope:.digits$e} Pa, above the modulus {modulus:.digits$e} Pa")
}

fn refuse(row: usize, message: impl Into<String>) -> CurveError {
    CurveError { row, message: message.into() }
}

/// Checks one row for itself and against the row before.
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

/// Adds a knot, unless round-off has put it on the one before.
fn push_distinct(strain: &mut Vec<f64>, stress: &mut Vec<f64>, e: f64, s: f64) {
    if strain.last().is_none_or(|&last| e > last) {
        strain.push(e);
        stress.push(s);
    }
}

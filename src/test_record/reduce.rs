//! The reduction of one record to a curve.

use serde::Serialize;

use super::clean::{NEGATIVE_SIGNS, clean, count};
use super::decimate::decimate;
use super::modulus::{ElasticLine, Variances, elastic_line};
use super::smooth::{FLOOR, Smooth, smooth};
use super::{maximum, modulus, noise};
use crate::error::InputError;
use crate::input::{Allowed, Checked, finite, member, optional};
use crate::units::Dimension;

/// Settings of the reduction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reduce {
    /// Elastic modulus, Pa, > 0, if it is known more accurately than from the record.
    pub modulus: Option<f64>,
    /// Whether the extensions include those of machine and grips: strains are then corrected so that the elastic line has the slope `modulus`.
    pub compliance: bool,
    /// Stresses between which the elastic line is fitted, Pa, 0 <= low < high; `None`: they are searched for.
    pub elastic_range: Option<[f64; 2]>,
    /// Whether strains are shifted so that the elastic line starts at zero.
    pub toe: bool,
    /// Width in strain of the smoothing window, > 0; `None`: as wide as curve and noise allow.
    pub window: Option<f64>,
    /// Largest stress difference between the curve of the knots and the smoothed one, over the largest stress, and largest relative difference of
    /// the impact velocity of each segment between two knots. 1e-5 to 0.05.
    pub tolerance: f64,
    /// Step to which the stresses of the record are rounded, Pa; 0 if they are not rounded.
    pub stress_step: f64,
    /// Step to which the strains of the record are rounded; 0 if they are not rounded.
    pub strain_step: f64,
}

impl Default for Reduce {
    fn default() -> Self {
        Self {
            modulus: None,
            compliance: false,
            elastic_range: None,
            toe: true,
            window: None,
            tolerance: Self::TOLERANCE,
            stress_step: 0.0,
            strain_step: 0.0,
        }
    }
}

impl Reduce {
    /// Default tolerance of the knots.
    pub const TOLERANCE: f64 = 1e-3;
    /// Smallest number of rows of a record; fewer rows are a table, which is used without reduction.
    pub const FEWEST_ROWS: usize = 50;

    /// Checks that the numbers are within their ranges.
    pub(crate) fn check(&self) -> Checked {
        optional("modulus", self.modulus, Dimension::Stress, Allowed::Positive)?;
        self.elastic_range.map_or(Ok(()), check_range)?;
        optional("window", self.window, Dimension::None, Allowed::Positive)?;
        check_tolerance(self.tolerance)?;
        // The step of values that are all equal is infinite.
        let step = |step: f64| Some(step).filter(|step| *step != f64::INFINITY);
        optional("stress_step", step(self.stress_step), Dimension::Stress, Allowed::NotNegative)?;
        optional("strain_step", step(self.strain_step), Dimension::None, Allowed::NotNegative)
    }
}

/// Checks the tolerance of knots.
pub(super) fn check_tolerance(tolerance: f64) -> Checked {
    member("tolerance", tolerance, Dimension::None, Allowed::Within(1e-5, 0.05))
}

/// Checks the stresses between which an elastic line is fitted, Pa.
pub(super) fn check_range([low, high]: [f64; 2]) -> Checked {
    if low >= 0.0 && high > low && high.is_finite() {
        return Ok(());
    }
    let error =
        InputError::new(format!("{} MPa to {} MPa is an empty interval", low / 1e6, high / 1e6)).key("elastic_range");
    Err(error.allowed("0 <= low < high").help("name the smaller stress first"))
}

/// Plastic strain of the proof stress.
pub const PROOF_OFFSET: f64 = 0.002;

/// Largest relative standard error of a modulus that counts as determined (ASTM E111: coefficient of variation of the slope).
const UNCERTAIN: f64 = 0.02;

/// The curve of a record, and the properties determined on the way.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reduction {
    /// Number of rows of the record.
    pub rows: usize,
    /// Elastic line in the strains of the record.
    pub line: ElasticLine,
    /// Elastic modulus, Pa.
    #[serde(rename = "modulus_Pa")]
    pub modulus: f64,
    /// Stress at a plastic strain of 0.2 %, Pa; `None` if the curve ends before.
    #[serde(rename = "proof_stress_Pa")]
    pub proof_stress: Option<f64>,
    /// Strain and stress (Pa) at the largest force.
    pub maximum: (f64, f64),
    /// Strain and stress (Pa) before the fracture, if the record contains one.
    pub fracture: Option<(f64, f64)>,
    /// Standard deviation of the noise of the stress, Pa.
    #[serde(rename = "noise_Pa")]
    pub noise: f64,
    /// Knots (strain, stress in Pa) from the origin; the second one is the end of the elastic line.
    pub knots: Vec<(f64, f64)>,
    /// One sentence for each change of the record.
    pub changes: Vec<String>,
}

impl Reduction {
    /// Whether strains or stresses had negative signs, as is common in compression.
    pub fn had_negative_signs(&self) -> bool {
        self.changes.iter().any(|change| change == NEGATIVE_SIGNS)
    }
}

/// Reduces a record (engineering strain, engineering stress in Pa, in the order of the test) to a curve.
///
/// # Errors
/// A number is out of range or not finite, or the record has no elastic part or not enough rows.
pub fn reduce(record: &[(f64, f64)], how: &Reduce) -> Result<Reduction, InputError> {
    how.check()?;
    finite("record.strain", record.iter().map(|row| row.0))?;
    finite("record.stress", record.iter().map(|row| row.1))?;
    let cleaned = clean(record);
    let (mut rows, mut changes) = (cleaned.rows, cleaned.changes);
    if rows.len() < Reduce::FEWEST_ROWS {
        let message = format!("{} of {} are left: {}", count(rows.len()), record.len(), changes.join("; "));
        let error = InputError::new(message).key("record");
        let error = error.allowed(format!("at least {} rows of growing strain", Reduce::FEWEST_ROWS));
        return Err(error.help("check the columns"));
    }
    // The more evenly timed rows share a strain, the more accurate is their mean.
    let variance = |rows: &usize| (how.strain_step / *rows as f64).powi(2) / 12.0;
    let rounding: Vec<f64> = cleaned.of_one_strain.iter().map(variance).collect();
    let variances = noise::variances(&rows, how.stress_step);
    let largest = rows.iter().map(|row| row.1).fold(0.0, f64::max);
    let line = elastic_line(&rows, Variances { noise: &variances, rounding: &rounding }, how.elastic_range)
        .filter(|line| line.slope > 0.0 && line.end < rows.len());
    let Some(line) = line else { return Err(no_line(how, largest)) };
    let (modulus, start) = correct(&mut rows, &line, how, &mut changes)?;
    if let Some(window) = how.window {
        fits(window, rows[rows.len() - 1].0 - rows[start].0)?;
    }
    let mean_noise = (variances.iter().sum::<f64>() / variances.len() as f64).sqrt();
    let mut curve = whole_curve((&rows, &variances, largest), start, modulus, how.window);
    changes.push(format!(
        "{} between strain {:.5} and {:.5} smoothed by local quadratic regression (noise {:.3} MPa)",
        count(rows.len() - start),
        rows[start].0,
        rows[rows.len() - 1].0,
        mean_noise / 1e6
    ));
    let past = (start + 1).min(rows.len() - 1);
    changes.extend(end_rising(&mut curve, &rows[past..], &variances[past..], FLOOR * largest));
    let knots = decimate(&curve, how.tolerance);
    changes.push(format!(
        "{} points kept: within {} % of the largest stress and of the velocity of each segment",
        knots.len(),
        decimal(100.0 * how.tolerance)
    ));
    Ok(Reduction {
        rows: record.len(),
        line,
        modulus,
        proof_stress: proof_stress(&curve, modulus),
        maximum: top(&knots),
        fracture: cleaned.fractured.then(|| knots[knots.len() - 1]),
        noise: mean_noise,
        knots: rounded(&knots, modulus),
        changes,
    })
}

fn no_line(how: &Reduce, largest: f64) -> InputError {
    let Some([low, high]) = how.elastic_range.map(|range| range.map(|stress| stress / 1e6)) else {
        let error = InputError::new("the record has no straight part at its start");
        return error.key("elastic_range").help("name the stresses of its elastic part");
    };
    let message = format!(
        "no line can be fitted between {low} and {high} MPa; the largest stress of the record is {:.1} MPa",
        largest / 1e6
    );
    let allowed = format!("an interval with at least {} rows, along which the stress rises", modulus::FEWEST);
    InputError::new(message).key("elastic_range").allowed(allowed).help("name an interval below the yield stress")
}

/// Smallest length of a curve in smoothing windows: a wider window hides the shape of the curve.
const FEWEST_WINDOWS: f64 = 2.0;

/// Checks that a smoothing window is not too wide for a curve of this strain after its elastic line.
fn fits(window: f64, strain: f64) -> Result<(), InputError> {
    let most = strain / FEWEST_WINDOWS;
    if window <= most {
        return Ok(());
    }
    let message =
        format!("a window of strain {window} is too wide for a record of strain {strain:.4} behind its elastic line");
    let error = InputError::new(message).key("window").allowed(format!("at most {most:.4}, half of the record"));
    Err(error.help("give a smaller one, or leave it out to have the width chosen by curve and noise"))
}

/// Relative difference from a given modulus above which the slope of the record is not that of its elastic line.
const SAME_SLOPE: f64 = 0.05;

/// Shifts strains so that the elastic line passes through the origin, and removes the compliance of machine and grips if this is requested. Returns
/// the modulus and the last row on the elastic line.
fn correct(
    rows: &mut [(f64, f64)],
    line: &ElasticLine,
    how: &Reduce,
    changes: &mut Vec<String>,
) -> Result<(f64, usize), InputError> {
    let modulus = how.modulus.unwrap_or_else(|| six_digits(line.slope));
    let ratio = line.slope / modulus;
    let most = 1.0 + SAME_SLOPE.max(3.0 * line.error / line.slope);
    if ratio > most {
        let message = format!(
            "{:.4} GPa is less than the slope of the record, {:.4} +- {:.4} GPa",
            modulus / 1e9,
            line.slope / 1e9,
            line.error / 1e9
        );
        let least = (line.slope / most / 1e5).ceil() / 1e4;
        let error = InputError::new(message).key("modulus").allowed(format!("at least {least} GPa"));
        return Err(error.help("check the gauge length, the units and the modulus"));
    }
    if how.modulus.is_none() && line.error > UNCERTAIN * line.slope {
        let error = 100.0 * line.error / line.slope;
        changes.push(format!("the modulus is uncertain by {error:.1} % (ASTM E111 allows 2 %): give a better one"));
    }
    if let Some([lower, upper]) = line.bend {
        changes.push(format!(
            "the rows of the elastic range are not on one line, their slope is {:.3} GPa in its lower half and {:.3} GPa in its upper one: \
             name a narrower elastic range, without toe and knee",
            lower / 1e9,
            upper / 1e9
        ));
    }
    let (mut last, mut through, mut compliance) = (line.end - 1, line.middle, 0.0);
    if how.compliance {
        compliance = 1.0 / line.slope - 1.0 / modulus;
        changes.push(format!(
            "strains corrected for the compliance of machine and grips: the record has a slope of {:.3} GPa",
            line.slope / 1e9
        ));
    } else if (ratio - 1.0).abs() > SAME_SLOPE {
        // No part of the record has the slope of the modulus: the line touches the record at the start of its steepest part.
        (last, through) = (line.from, line.between[0].max(0.0));
        let message =
            "the line of the modulus is drawn through the first point of the steepest part, which has a slope of";
        changes.push(format!(
            "{message} {:.3} GPa (the strains can be corrected for the compliance instead)",
            line.slope / 1e9
        ));
    }
    // Strain at which the line of the modulus has zero stress.
    let found = line.origin + through * (1.0 / line.slope - compliance - 1.0 / modulus);
    let origin = if how.toe { found } else { 0.0 };
    changes.push(if how.toe {
        format!("toe: strains shifted by {:.3e}, so that the elastic line starts at zero", -origin)
    } else {
        format!("toe: strains as recorded, in which the elastic line starts at {found:.3e}")
    });
    for row in rows.iter_mut() {
        row.0 -= origin + compliance * row.1;
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok((modulus, last.max(rows.partition_point(|row| row.0 <= 0.0))))
}

/// Makes a curve rise to its end if noise explains a largest stress inside it. Returns a sentence if the curve was changed.
fn end_rising(curve: &mut Vec<(f64, f64)>, rows: &[(f64, f64)], variances: &[f64], floor: f64) -> Option<String> {
    let (last, (strain, stress)) = (*curve.last()?, top(curve));
    if stress <= last.1 || maximum::falls(rows, variances, floor) {
        return None;
    }
    let start = maximum::rising_end(curve, rows, variances)?;
    Some(format!(
        "no largest stress before the end: the fall by {:.3} MPa from strain {strain:.5} on is within the noise; from strain {start:.5} on \
         the curve is the line of least squares to the end of the record",
        (stress - last.1) / 1e6
    ))
}

/// Returns the point of the largest stress, the first of equal ones.
fn top(curve: &[(f64, f64)]) -> (f64, f64) {
    curve.iter().copied().fold((0.0, 0.0), |a, b| if b.1 > a.1 { b } else { a })
}

/// A fall of the stress after the elastic line is an upper yield point if it exceeds this number of standard deviations of the noise, and
/// [`YIELD_DROP`] times the stress.
const YIELD_DROP_NOISE: f64 = 4.0;
const YIELD_DROP: f64 = 0.02;

/// If the rows after the elastic line have a gap longer than the line, and than the elastic strain at this fraction of the largest stress, the
/// tangent after the gap cannot give the elastic limit: the curve is straight across the gap.
const SHORT_LINE: f64 = 0.1;

/// Returns the elastic line and the smoothed curve after it; no slope exceeds the modulus. `start` is the last row on the line.
fn whole_curve(
    (rows, variances, largest): (&[(f64, f64)], &[f64], f64),
    start: usize,
    modulus: f64,
    window: Option<f64>,
) -> Vec<(f64, f64)> {
    let past = (start + 1).min(rows.len() - 2);
    let smoothed = smooth(&rows[past..], &variances[past..], largest, window);
    let near = &variances[start.saturating_sub(25)..(start + 25).min(variances.len())];
    let noise = (near.iter().sum::<f64>() / near.len() as f64).sqrt();
    let last = rows[start].0;
    let gap = rows[past].0 - last > last.max(SHORT_LINE * largest / modulus);
    let limit = if gap { last } else { elastic_limit(rows[start], &smoothed, modulus, noise) };
    let limit = limit.max(modulus::LEAST_LIMIT * largest / modulus);
    let mut curve = vec![(0.0, 0.0), (limit, modulus * limit)];
    for (strain, stress) in smoothed.curve {
        let last = curve[curve.len() - 1];
        if strain > last.0 {
            curve.push((strain, stress.min(last.1 + modulus * (strain - last.0)).max(0.0)));
        }
    }
    curve
}

/// Returns the strain at the end of the elastic line, where it meets the tangent of the curve after it. `last` is the last row that may lie on the
/// line; if it is an upper yield point, it is the end.
fn elastic_limit((last, upper): (f64, f64), smoothed: &Smooth, modulus: f64, noise: f64) -> f64 {
    let Some(&(strain, stress)) = smoothed.curve.first() else { return last };
    let drop = upper.min(modulus * last) - stress;
    if drop > YIELD_DROP_NOISE * noise && drop > YIELD_DROP * modulus * last {
        return last;
    }
    let slope = smoothed.slope.clamp(-0.9 * modulus, 0.9 * modulus);
    ((stress - slope * strain) / (modulus - slope)).clamp(0.5 * last, strain)
}

/// Returns the stress at which the line with the slope of the modulus and a plastic strain of 0.2 % intersects the curve (ASTM E8/E8M, offset
/// method; ISO 6892-1).
fn proof_stress(curve: &[(f64, f64)], modulus: f64) -> Option<f64> {
    let above = |(strain, stress): (f64, f64)| stress - modulus * (strain - PROOF_OFFSET);
    let pair = curve.windows(2).find(|pair| above(pair[0]) > 0.0 && above(pair[1]) <= 0.0)?;
    let part = above(pair[0]) / (above(pair[0]) - above(pair[1]));
    Some(pair[0].1 + part * (pair[1].1 - pair[0].1))
}

/// Formats a number without the rounding error of a factor.
fn decimal(value: f64) -> String {
    six_digits(value).to_string()
}

/// Rounds a modulus to six significant digits, so that files stay readable.
pub(super) fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Rounds knots to steps of 100 Pa and 1e-9; the second one stays on the elastic line.
pub(super) fn rounded(knots: &[(f64, f64)], modulus: f64) -> Vec<(f64, f64)> {
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for (k, &(strain, stress)) in knots.iter().enumerate() {
        let stress = (stress / 100.0).round() * 100.0;
        let strain = if k == 1 { stress / modulus } else { (strain * 1e9).round() / 1e9 };
        if rows.last().is_none_or(|last| strain > last.0) {
            let most = rows.last().map_or(0.0, |last| last.1 + modulus * (strain - last.0));
            rows.push((strain, if k < 2 { stress } else { stress.min((most / 100.0).floor() * 100.0) }));
        }
    }
    rows
}

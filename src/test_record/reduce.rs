//! The reduction of one record.

use serde::Serialize;

use super::clean::{NEGATIVE_SIGNS, clean, count};
use super::decimate::decimate;
use super::modulus::{ElasticLine, Variances, elastic_line};
use super::smooth::{FLOOR, Smooth, smooth};
use super::{maximum, modulus, noise};
use crate::error::InputError;
use crate::input::{Allowed, Checked, finite, member, optional};
use crate::units::Dimension;

/// How a record is reduced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reduce {
    /// Elastic modulus, Pa, > 0, if it is known better than by the record.
    pub modulus: Option<f64>,
    /// The extensions include those of machine and grips: strains are corrected so that the elastic line has the modulus.
    pub compliance: bool,
    /// Stresses between which the elastic line is fitted, Pa, 0 <= low < high; none: they are searched for.
    pub elastic_range: Option<[f64; 2]>,
    /// Strains are shifted so that the elastic line starts at zero.
    pub toe: bool,
    /// Width in strain of the window of the smoothing, > 0; none: as wide as curve and noise allow.
    pub window: Option<f64>,
    /// Largest distance in stress of the knots' curve from the smoothed one, over the largest stress; the impact velocity of no piece
    /// between two knots differs by more than this part, either. 1e-5 to 0.05.
    pub tolerance: f64,
    /// Step to which the stresses of the record are rounded, Pa; 0: none.
    pub stress_step: f64,
    /// Step to which its strains are rounded; 0: none.
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
    /// Fewest rows of a record; fewer are a table, which is kept as it is.
    pub const FEWEST_ROWS: usize = 50;

    /// Its numbers.
    pub(crate) fn check(&self) -> Checked {
        optional("modulus", self.modulus, Dimension::Stress, Allowed::Positive)?;
        self.elastic_range.map_or(Ok(()), check_range)?;
        optional("window", self.window, Dimension::None, Allowed::Positive)?;
        check_tolerance(self.tolerance)?;
        // Values of which none differs have no step.
        let step = |step: f64| Some(step).filter(|step| *step != f64::INFINITY);
        optional("stress_step", step(self.stress_step), Dimension::Stress, Allowed::NotNegative)?;
        optional("strain_step", step(self.strain_step), Dimension::None, Allowed::NotNegative)
    }
}

/// A tolerance of knots.
pub(super) fn check_tolerance(tolerance: f64) -> Checked {
    member("tolerance", tolerance, Dimension::None, Allowed::Within(1e-5, 0.05))
}

/// Stresses between which an elastic line is fitted, Pa.
pub(super) fn check_range([low, high]: [f64; 2]) -> Checked {
    if low >= 0.0 && high > low && high.is_finite() {
        return Ok(());
    }
    let error =
        InputError::new(format!("{} MPa to {} MPa is an empty interval", low / 1e6, high / 1e6)).key("elastic_range");
    Err(error.allowed("0 <= low < high").help("name the smaller stress first"))
}

/// Offset of the proof stress.
pub const PROOF_OFFSET: f64 = 0.002;

/// Largest standard error of the modulus, relative, with which it counts as determined (ASTM E111: coefficient of variation of the slope).
const UNCERTAIN: f64 = 0.02;

/// A record and the curve made of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reduction {
    /// Rows of the record.
    pub rows: usize,
    /// The elastic line in the strains of the record.
    pub line: ElasticLine,
    /// Elastic modulus, Pa.
    #[serde(rename = "modulus_Pa")]
    pub modulus: f64,
    /// Stress at a plastic strain of 0.2 %, Pa; none where the curve ends before.
    #[serde(rename = "proof_stress_Pa")]
    pub proof_stress: Option<f64>,
    /// Strain and stress (Pa) at the largest force.
    pub maximum: (f64, f64),
    /// Strain and stress (Pa) before the fracture, if the record holds one.
    pub fracture: Option<(f64, f64)>,
    /// Standard deviation of the noise of the stress, Pa.
    #[serde(rename = "noise_Pa")]
    pub noise: f64,
    /// (strain, stress in Pa) from the origin, the second one the end of the elastic line.
    pub knots: Vec<(f64, f64)>,
    /// One sentence for each change of the record.
    pub changes: Vec<String>,
}

impl Reduction {
    /// Strains or stresses had negative signs, as they often have in compression.
    pub fn had_negative_signs(&self) -> bool {
        self.changes.iter().any(|change| change == NEGATIVE_SIGNS)
    }
}

/// Reduces a record (engineering strain, engineering stress in Pa, in the order of the test) to a curve.
///
/// # Errors
/// Numbers out of range, rows that are not finite; a record without an elastic part, or without enough rows.
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
    // The mean of evenly timed rows of one strain is the nearer to it the more there are.
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

/// A window of the smoothing hides the shape of a curve that is not longer than some windows.
const FEWEST_WINDOWS: f64 = 2.0;

/// Refuses a window of the smoothing that is too long for a curve of this strain behind its elastic line.
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

/// A slope of the record that differs by more than this from a given modulus is not that of its elastic line.
const SAME_SLOPE: f64 = 0.05;

/// Shifts strains so that the elastic line goes through the origin, and takes the compliance of machine and grips out if that is asked
/// for. Returns the modulus and the last row on the elastic line.
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
        // The record has no part with the slope of the modulus: the line touches it where it is steepest at first.
        (last, through) = (line.from, line.between[0].max(0.0));
        let message =
            "the line of the modulus is drawn through the first point of the steepest part, which has a slope of";
        changes.push(format!(
            "{message} {:.3} GPa (the strains can be corrected for the compliance instead)",
            line.slope / 1e9
        ));
    }
    // Strain at which the line of the modulus has no stress.
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

/// A curve with a largest stress inside that noise explains rises to its end. Returns a sentence where it was changed.
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

/// The point of the largest stress, the first of equal ones.
fn top(curve: &[(f64, f64)]) -> (f64, f64) {
    curve.iter().copied().fold((0.0, 0.0), |a, b| if b.1 > a.1 { b } else { a })
}

/// A fall of the stress past the elastic line by more than so many standard deviations of the noise, and by more than this part of it, is
/// an upper yield point.
const YIELD_DROP_NOISE: f64 = 4.0;
const YIELD_DROP: f64 = 0.02;

/// A gap in the rows past the elastic line that is longer than the line, and than that of this part of the largest stress, is too long for
/// the tangent behind it to tell the elastic limit: the curve is straight there.
const SHORT_LINE: f64 = 0.1;

/// The elastic line and the smoothed curve behind it; no slope is above the modulus. `start` is the last row on the line.
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

/// Strain at the end of the elastic line: where the curve behind it, prolonged by its tangent, meets it. `last` is the last row that may lie
/// on the line; if it is an upper yield point it is the end.
fn elastic_limit((last, upper): (f64, f64), smoothed: &Smooth, modulus: f64, noise: f64) -> f64 {
    let Some(&(strain, stress)) = smoothed.curve.first() else { return last };
    let drop = upper.min(modulus * last) - stress;
    if drop > YIELD_DROP_NOISE * noise && drop > YIELD_DROP * modulus * last {
        return last;
    }
    let slope = smoothed.slope.clamp(-0.9 * modulus, 0.9 * modulus);
    ((stress - slope * strain) / (modulus - slope)).clamp(0.5 * last, strain)
}

/// Where the line of the modulus through a plastic strain of 0.2 % crosses the curve (ASTM E8/E8M, offset method; ISO 6892-1).
fn proof_stress(curve: &[(f64, f64)], modulus: f64) -> Option<f64> {
    let above = |(strain, stress): (f64, f64)| stress - modulus * (strain - PROOF_OFFSET);
    let pair = curve.windows(2).find(|pair| above(pair[0]) > 0.0 && above(pair[1]) <= 0.0)?;
    let part = above(pair[0]) / (above(pair[0]) - above(pair[1]));
    Some(pair[0].1 + part * (pair[1].1 - pair[0].1))
}

/// Without the rounding of a factor.
fn decimal(value: f64) -> String {
    six_digits(value).to_string()
}

/// A modulus in as many digits as it is known in, so that files stay readable.
pub(super) fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Knots in steps of 100 Pa and 1e-9; the second one stays on the elastic line.
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

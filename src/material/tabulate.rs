//! Conversion of laws and true-stress tables to engineering tables.
//!
//! For incompressible plastic flow, true values are converted to engineering ones by e = exp(eps) - 1, s = sigma/(1 + e) in tension and, in
//! magnitudes, e = 1 - exp(-eps), s = sigma/(1 - e) in compression. The elastic part is kept straight in the engineering measure, s = E e, so that
//! elastic waves have a single speed.

use super::curve::SECANT_ROUND_OFF;
use super::formula::ToTabulate;
use super::{CurveError, Law, Measure, Sense};
use crate::error::InputError;
use crate::input::{Allowed, Checked, finite, member, optional};
use crate::root::bisect;
use crate::typed::Range;
use crate::units::Dimension;

/// Settings of the conversion of a law to a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tabulate {
    /// Largest stress difference between table and law, over the largest stress; the impact velocity of the table at any strain is within the same
    /// fraction of that of the law. From 1e-8 to 0.1, as in materials.
    pub tolerance: f64,
    /// Engineering strain at which the table ends, in compression at most [`Tabulate::MOST_COMPRESSION`]. `None`: 1.5 times the true strain at the
    /// largest engineering stress; if there is no such maximum, [`Tabulate::DEFAULT_TRUE_END`] in true compression and [`Tabulate::DEFAULT_END`]
    /// otherwise.
    pub to_strain: Option<f64>,
}

impl Tabulate {
    /// Default engineering strain at the end of the table of a law without a maximum.
    pub const DEFAULT_END: f64 = 0.5;
    /// Default true strain at the end of the compression table of a true law: 1.5 times the strain of about 1 that Taylor cylinders and other
    /// compression tests of metals reach.
    pub const DEFAULT_TRUE_END: f64 = 1.5;
    /// Largest engineering strain of a compression table: at 1 no length is left, and not far below it the engineering stress rises more steeply
    /// than the elastic line.
    pub const MOST_COMPRESSION: f64 = 0.9;

    /// Checks the tolerance and the modulus of a table.
    fn check(tolerance: f64, modulus: Option<f64>) -> Checked {
        member("tolerance", tolerance, Dimension::None, ToTabulate::ALLOWED)?;
        optional("modulus", modulus, Dimension::Stress, Allowed::Positive)
    }
}

/// An engineering table made from a law or from true stresses.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tabulated {
    /// Rows (strain, stress in Pa) from the elastic limit on, without the origin.
    pub rows: Vec<(f64, f64)>,
    /// Largest stress difference from the law or the true curve, Pa, sampled between the knots.
    pub error: f64,
}

/// Converts true strain and stress (magnitudes) to engineering ones.
pub fn engineering_from_true(sense: Sense, strain: f64, stress: f64) -> (f64, f64) {
    let stretched = sense.sign() * strain;
    (sense.sign() * stretched.exp_m1(), stress * (-stretched).exp())
}

/// Converts engineering strain and stress (magnitudes) to true ones.
pub fn true_from_engineering(sense: Sense, strain: f64, stress: f64) -> (f64, f64) {
    let sign = sense.sign();
    (sign * (sign * strain).ln_1p(), stress * (1.0 + sign * strain))
}

/// A law with the data that convert its stresses to engineering ones.
struct Branch<'a> {
    law: &'a Law,
    modulus: f64,
    measure: Measure,
    sense: Sense,
}

impl Branch<'_> {
    /// Returns the elastic strain at a stress, in the measure of the law. True stress on the straight engineering line is sigma = E e (1 + e) in
    /// tension and E e (1 - e) in compression.
    fn elastic_strain(&self, stress: f64) -> f64 {
        match self.measure {
            Measure::Engineering => stress / self.modulus,
            Measure::True => {
                let sign = self.sense.sign();
                sign * (sign * elastic_engineering_strain(self.sense, stress / self.modulus)).ln_1p()
            }
        }
    }

    /// Returns d(elastic strain)/d(stress), 1/Pa.
    fn elastic_compliance(&self, stress: f64) -> f64 {
        let sign = self.sense.sign();
        let e = elastic_engineering_strain(self.sense, stress / self.modulus);
        match self.measure {
            Measure::Engineering => 1.0 / self.modulus,
            Measure::True => 1.0 / (self.modulus * (1.0 + sign * e) * (1.0 + sign * 2.0 * e)),
        }
    }

    /// Returns the total strain in the measure of the law at its parameter `x` (plastic strain, or total strain for Hollomon).
    fn total(&self, x: f64) -> f64 {
        if self.law.of_total_strain() { x } else { x + self.elastic_strain(self.law.stress(x)) }
    }

    /// Returns the engineering (strain, stress) at the parameter of the law.
    fn point(&self, x: f64) -> (f64, f64) {
        match self.measure {
            Measure::Engineering => (self.total(x), self.law.stress(x)),
            Measure::True => engineering_from_true(self.sense, self.total(x), self.law.stress(x)),
        }
    }

    /// Returns the parameter at which the table leaves the elastic line.
    ///
    /// Laws with a yield stress start there, and Hollomon's law starts where it meets the line. The Ramberg-Osgood law has no elastic part; it
    /// starts where its distance from the line is half of the tolerance (`allowance`, Pa).
    fn elastic_limit(&self, allowance: f64) -> f64 {
        match self.law {
            Law::Hollomon { .. } => {
                let off_line = |x: f64| {
                    let (strain, stress) = self.point(x);
                    self.modulus * strain - stress
                };
                bisect([1e-15_f64.ln(), 1.0_f64.ln()], 0.0, |ln| off_line(ln.exp()) < 0.0).exp()
            }
            Law::RambergOsgood { .. } => 0.5 * allowance / self.modulus,
            _ => 0.0,
        }
    }

    /// Returns d ln(engineering stress)/dx, up to a positive factor; zero at the largest engineering stress.
    fn rise(&self, x: f64) -> f64 {
        let stress = self.law.stress(x);
        let of_law = self.law.slope(x) / stress;
        if self.law.of_total_strain() {
            return of_law - 1.0;
        }
        of_law * (1.0 - stress * self.elastic_compliance(stress)) - 1.0
    }

    /// Returns the parameter of the largest engineering stress; only true stresses in tension have one.
    fn maximum(&self, from: f64) -> Option<f64> {
        const FARTHEST: f64 = 10.0;
        if self.measure == Measure::Engineering || self.sense == Sense::Compression || self.rise(FARTHEST) > 0.0 {
            return None;
        }
        if self.rise(from.max(f64::MIN_POSITIVE)) <= 0.0 {
            return Some(from);
        }
        Some(bisect([from, FARTHEST], 0.0, |x| self.rise(x) > 0.0))
    }

    /// Returns the engineering strain at the end of the table if neither a strain is given nor the stress has a maximum.
    fn default_end(&self) -> f64 {
        let compressed = self.measure == Measure::True && self.sense == Sense::Compression;
        if compressed { -(-Tabulate::DEFAULT_TRUE_END).exp_m1() } else { Tabulate::DEFAULT_END }
    }

    /// Returns the largest stress, to which tolerances are relative: in compression that of the law itself, since the engineering stress of a true
    /// law grows with the cross-section without limit.
    fn top(&self, x: f64) -> f64 {
        self.point(x).1.min(self.law.stress(x))
    }

    /// Returns the parameter at an engineering strain.
    fn parameter_at(&self, strain: f64) -> f64 {
        let mut high = 1.0;
        while self.point(high).0 < strain && high < 1e3 {
            high *= 2.0;
        }
        bisect([0.0, high], 0.0, |x| self.point(x).0 < strain)
    }
}

/// Returns the elastic engineering strain at a true stress of q E: e (1 +- e) = q.
pub(super) fn elastic_engineering_strain(sense: Sense, q: f64) -> f64 {
    2.0 * q / (1.0 + (1.0 + 4.0 * sense.sign() * q).max(0.0).sqrt())
}

/// Tabulates a law. The table starts at the elastic limit (its origin is omitted) and has knots exactly at the elastic limit and at the largest
/// engineering stress.
///
/// # Errors
/// The table would end before the elastic limit, or the tolerance or the modulus is out of range.
pub fn tabulate_law(
    law: &Law,
    modulus: f64,
    measure: Measure,
    sense: Sense,
    how: Tabulate,
) -> Result<Tabulated, InputError> {
    Tabulate::check(how.tolerance, Some(modulus))?;
    let branch = Branch { law, modulus, measure, sense };
    let start = branch.elastic_limit(0.0);
    let maximum = branch.maximum(start);
    let end = match (how.to_strain, maximum) {
        (Some(strain), _) if sense == Sense::Compression => branch.parameter_at(strain.min(Tabulate::MOST_COMPRESSION)),
        (Some(strain), _) => branch.parameter_at(strain),
        (None, Some(x)) => 1.5 * x.max(start).max(1e-3),
        (None, None) => branch.parameter_at(branch.default_end()),
    };
    if end.is_nan() || end <= start || branch.point(end).0 <= branch.point(start).1 / modulus {
        let limit = branch.point(start).1 / modulus;
        let message = format!("the table would end before the elastic limit, which is at strain {limit:.4e}");
        return Err(InputError::new(message)
            .key("to_strain")
            .help("end it at a larger strain, or check the constants"));
    }
    let top = branch.top(maximum.map_or(end, |x| x.min(end)));
    let start = start.max(branch.elastic_limit(how.tolerance * top));
    let limit = branch.point(start).1;
    let mut breaks = vec![start];
    breaks.extend(maximum.filter(|x| (start..end).contains(x) && *x > start));
    breaks.push(end);
    let mut table = refine(&|x| branch.point(x), &breaks, how.tolerance, top);
    // Exactly on the elastic line, so that the initial slope is the modulus.
    table.rows[0] = (limit / modulus, limit);
    if matches!(law, Law::RambergOsgood { .. }) {
        table.error = table.error.max(modulus * start);
    }
    Ok(table)
}

/// Returns the largest stress difference between the table of a true Ramberg-Osgood law and the law, Pa, that is due to the straight elastic part
/// in the engineering measure: the elastic strain of this law is sigma/E in its own measure. The other laws have no elastic strain of their own.
pub(super) fn elastic_error(law: &Law, modulus: f64, measure: Measure, sense: Sense, rows: &[(f64, f64)]) -> f64 {
    if measure == Measure::Engineering || !matches!(law, Law::RambergOsgood { .. }) {
        return 0.0;
    }
    let branch = Branch { law, modulus, measure, sense };
    let mut before = (0.0, 0.0);
    let off = |&(strain, stress): &(f64, f64)| {
        let slope = (stress - before.1) / (strain - before.0);
        before = (strain, stress);
        let stretch = 1.0 + sense.sign() * strain;
        let elastic = stress * stretch / modulus - branch.elastic_strain(stress * stretch);
        // At constant true stress, a change of true strain changes the engineering strain and the engineering stress.
        (elastic * (slope * stretch + sense.sign() * stress)).abs()
    };
    rows.iter().map(off).fold(0.0, f64::max)
}

/// Converts rows of true strain (> 0) and stress to an engineering table, with knots added where straight true segments are curved. Rows on the
/// elastic line (slope `modulus`, or that of the first row if `None`) stay on it. For `tolerance`, see [`Tabulate`].
///
/// # Errors
/// The tolerance or the modulus is out of range, rows are not finite, or their strains are too large or do not increase from above 0.
pub fn tabulate_true_rows(
    rows: &[(f64, f64)],
    modulus: Option<f64>,
    sense: Sense,
    tolerance: f64,
) -> Result<Tabulated, InputError> {
    Tabulate::check(tolerance, modulus)?;
    finite("rows.strain", rows.iter().map(|row| row.0))?;
    finite("rows.stress", rows.iter().map(|row| row.1))?;
    check_true_strains(rows)?;
    let Some(&(first_strain, first_stress)) = rows.first() else { return Ok(Tabulated::default()) };
    let modulus = modulus.unwrap_or(first_stress / first_strain);
    let on_line = |&&(strain, stress): &&(f64, f64)| (stress / (modulus * strain) - 1.0).abs() <= SECANT_ROUND_OFF;
    let elastic = rows.iter().take_while(on_line).count();
    let mut table = Tabulated::default();
    for &(_, stress) in &rows[..elastic] {
        let strain = elastic_engineering_strain(sense, stress / modulus);
        table.rows.push((strain, modulus * strain));
    }
    let top = rows.iter().map(|&(e, s)| engineering_from_true(sense, e, s).1).fold(0.0, f64::max);
    for k in elastic..rows.len() {
        let from = if k == 0 { (0.0, 0.0) } else { rows[k - 1] };
        let piece = straight_true_piece(from, rows[k], sense, tolerance, top);
        let known = usize::from(!table.rows.is_empty());
        table.rows.extend_from_slice(&piece.rows[known..]);
        table.error = table.error.max(piece.error);
    }
    Ok(table)
}

/// Largest true strain of a table, ln 1e12: the engineering strain of a larger one exceeds the allowed magnitude.
const MOST_TRUE_STRAIN: f64 = 27.6;

/// Checks that true strains increase and can be converted.
pub(super) fn check_true_strains(rows: &[(f64, f64)]) -> Result<(), CurveError> {
    let mut above = 0.0;
    for (row, &(strain, _)) in rows.iter().enumerate() {
        let range = Allowed::Above(above, MOST_TRUE_STRAIN);
        if !range.holds(strain) {
            let allowed = range.describe("strain", Dimension::None);
            return Err(CurveError { row, message: format!("true strain {strain:e}, where {allowed}") });
        }
        above = strain;
    }
    Ok(())
}

/// Converts one straight segment of a true table, with a knot at its largest engineering stress: in tension, where the true slope equals the true
/// stress.
fn straight_true_piece(from: (f64, f64), to: (f64, f64), sense: Sense, tolerance: f64, top: f64) -> Tabulated {
    let slope = (to.1 - from.1) / (to.0 - from.0);
    let point = |e: f64| engineering_from_true(sense, e, from.1 + slope * (e - from.0));
    let peak = from.0 + (slope - from.1) / slope;
    let mut breaks = vec![from.0];
    breaks.extend((sense == Sense::Tension && slope > 0.0 && peak > from.0 && peak < to.0).then_some(peak));
    breaks.push(to.0);
    refine(&point, &breaks, tolerance, top)
}

/// Returns straight segments between the given parameters, divided until the tolerances are met.
pub(super) fn refine(point: &dyn Fn(f64) -> (f64, f64), breaks: &[f64], tolerance: f64, top: f64) -> Tabulated {
    let limits = Limits {
        stress: tolerance * top,
        relative: 0.3 * tolerance,
        velocity: 0.02 * tolerance * velocity_scale(point, breaks),
    };
    let mut table = Tabulated { rows: vec![point(breaks[0])], error: 0.0 };
    for pair in breaks.windows(2) {
        split(point, (pair[0], pair[1]), limits, 60, &mut table);
    }
    table
}

/// Error limits of one straight segment.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// Limit of the stress difference, Pa.
    stress: f64,
    /// Limit of the relative difference of its velocity jump; less than the tolerance, since bisection shows only part of the error.
    relative: f64,
    /// Absolute limit of that difference, sqrt(Pa): sqrt(d stress d strain) is a velocity times sqrt(density). It applies to the few segments at
    /// the steep start and near the maximum, where the slope approaches zero and bisection does not reduce the relative error.
    velocity: f64,
}

fn velocity_part(from: (f64, f64), to: (f64, f64)) -> f64 {
    ((to.0 - from.0) * (to.1 - from.1)).max(0.0).sqrt()
}

fn velocity_scale(point: &dyn Fn(f64) -> (f64, f64), breaks: &[f64]) -> f64 {
    const SAMPLES: u32 = 64;
    let origin = (0.0, 0.0);
    let mut total = velocity_part(origin, point(breaks[0]));
    for pair in breaks.windows(2) {
        let at = |i: u32| point(pair[0] + (pair[1] - pair[0]) * f64::from(i) / f64::from(SAMPLES));
        total += (0..SAMPLES).map(|i| velocity_part(at(i), at(i + 1))).sum::<f64>();
    }
    total
}

/// Appends the segments from `range.0` (already in the table) to `range.1`.
fn split(point: &dyn Fn(f64) -> (f64, f64), range: (f64, f64), limits: Limits, depth: u32, table: &mut Tabulated) {
    const SAMPLES: u32 = 8;
    let (from, to) = (point(range.0), point(range.1));
    let slope = (to.1 - from.1) / (to.0 - from.0);
    let off = |i: u32| {
        let (strain, stress) = point(range.0 + (range.1 - range.0) * f64::from(i) / f64::from(SAMPLES));
        (stress - from.1 - slope * (strain - from.0)).abs()
    };
    let error = (1..SAMPLES).map(off).fold(0.0, f64::max);
    let middle = 0.5 * (range.0 + range.1);
    let halves = velocity_part(from, point(middle)) + velocity_part(point(middle), to);
    let lost = (velocity_part(from, to) - halves).abs();
    if depth > 0 && (error > limits.stress || lost > limits.velocity.max(limits.relative * halves)) {
        split(point, (range.0, middle), limits, depth - 1, table);
        split(point, (middle, range.1), limits, depth - 1, table);
        return;
    }
    table.error = table.error.max(error);
    table.rows.push(to);
}

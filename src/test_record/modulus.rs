//! The elastic line of a record: least squares over the part that is straight within the noise (ASTM E111).
//!
//! The part is found by a search. Of all intervals between some tens of stresses, those are admitted whose slope is, within its uncertainty, the
//! steepest; of these, the one whose slope has the smallest uncertainty is chosen. The uncertainty has two parts: the standard error, and the bias
//! by the curvature of the interval, as far as it exceeds the noise. Therefore neither the toe nor the knee is part of the fit. Rounded strains are
//! an error that the noise does not show: a clean record whose spacing is near a multiple of the step follows one straight line up to the first
//! extra step, and another one after it.

use super::fit::{Fit, line, polynomial};

/// Ratio of successive stresses at which intervals start and end ...
const LEVELS_FACTOR: f64 = 1.12;

/// ... from this fraction of the largest stress on.
const LEVELS_FROM: f64 = 0.01;

/// Smallest number of rows of an interval.
pub(super) const FEWEST: usize = 8;

/// Relative uncertainty of the slope below which intervals differ by their length only.
const RESOLUTION: f64 = 1e-3;

/// An interval is admitted if its slope plus twice its error is at least this fraction of the largest value of slope minus four times error.
const ADMITTED: f64 = 0.97;

/// Uncertainty, relative to that of the best interval, up to which an interval might have been the best if the record had been rounded differently.
const AS_GOOD: f64 = 1.25;

/// If the rows before an interval are steeper by this factor, and by [`SURELY`] standard deviations of the noise, they are the elastic ones.
const STEEPER: f64 = 1.5;
const SURELY: f64 = 4.0;

/// Smallest elastic limit over the largest stress: a curve has to start along its modulus.
pub(super) const LEAST_LIMIT: f64 = 1e-3;

/// Number of standard errors within which rows after the interval still lie on its line.
const ON_LINE: f64 = 2.5;

/// A material that is linear in logarithmic strain and true stress deviates from its line in engineering values by this factor times the strain,
/// relative to the stress; the deviation is limited to [`MOST_CURVED`], since rows past a knee deviate more.
const CURVED: f64 = 1.5;
const MOST_CURVED: f64 = 4e-3;

/// Deviation of rows from a line, relative to the stress, that is accepted without noise.
const STRAIGHT: f64 = 1e-3;

/// Factor down to which the groups of rows that locate the end of the line are shortened.
const SHORTEST: usize = 4;

/// The elastic line: stress = slope (strain - origin).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ElasticLine {
    /// Slope, Pa.
    #[serde(rename = "slope_Pa")]
    pub slope: f64,
    /// Standard error of the slope, including the spread over the equally good intervals, Pa.
    #[serde(rename = "standard_error_Pa")]
    pub error: f64,
    /// Strain at zero stress.
    pub origin: f64,
    /// Stresses of the first and the last row of the fit, Pa.
    #[serde(rename = "fitted_between_Pa")]
    pub between: [f64; 2],
    /// Number of rows of the fit.
    pub rows: usize,
    /// Slopes in the lower and the upper half of a given range if they differ by more than noise and some percent, Pa.
    #[serde(rename = "slopes_of_halves_Pa", skip_serializing_if = "Option::is_none")]
    pub bend: Option<[f64; 2]>,
    /// Stress of the line in the middle of the fit, Pa.
    #[serde(skip)]
    pub(super) middle: f64,
    /// First row of the fit.
    #[serde(skip)]
    pub(super) from: usize,
    /// First row after those that lie on the line.
    #[serde(skip)]
    pub(super) end: usize,
}

/// An interval of rows with its line.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    from: usize,
    to: usize,
    mean: f64,
    fit: Fit,
    /// Standard error of the slope, Pa.
    error: f64,
    /// Root mean square error of the slope including the bias, Pa.
    total: f64,
    /// Width in strain.
    width: f64,
}

/// Variances at each row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variances<'a> {
    /// Variance of the noise of the stress, Pa^2.
    pub noise: &'a [f64],
    /// Variance of the rounding of the strain.
    pub rounding: &'a [f64],
}

/// Returns the elastic line of rows sorted by strain. `range` (Pa) is the interval of stress to be fitted; if `None`, the interval is searched for.
/// Returns `None` if no interval has enough rows.
pub(super) fn elastic_line(
    rows: &[(f64, f64)],
    variances: Variances<'_>,
    range: Option<[f64; 2]>,
) -> Option<ElasticLine> {
    let largest = rows.iter().map(|row| row.1).fold(0.0, f64::max);
    let (best, spread) = match range {
        Some([low, high]) => (candidate(rows, variances, level(rows, low), level(rows, high))?, 0.0),
        None => search(rows, variances, largest)?,
    };
    let end = extend(rows, variances, &best, largest);
    let origin = best.mean - best.fit.a / best.fit.b;
    let ends = [best.from, best.to - 1];
    let on_line = ends.map(|row| best.fit.at(rows[row].0 - best.mean));
    // If the rows of the fit are curved, its end rows do not lie on its line.
    let between = if range.is_some() { ends.map(|row| near(rows, row)) } else { on_line };
    Some(ElasticLine {
        slope: best.fit.b,
        error: best.error.hypot(spread),
        origin,
        between,
        rows: best.to - best.from,
        bend: range.and_then(|_| bend(rows, variances, &best)),
        middle: 0.5 * (on_line[0] + on_line[1]),
        from: best.from,
        end: if range.is_some() { best.to } else { end },
    })
}

/// Returns the mean stress of a row and two neighbours on either side, Pa.
fn near(rows: &[(f64, f64)], row: usize) -> f64 {
    let five = &rows[row.saturating_sub(2)..(row + 3).min(rows.len())];
    five.iter().map(|row| row.1).sum::<f64>() / five.len() as f64
}

/// The slopes of the halves of a straight interval differ by less than this fraction of the larger one ...
const SAME_SLOPE: f64 = 0.05;

/// ... or by less than this number of standard errors.
const SAME_SLOPE_ERRORS: f64 = 3.0;

/// Returns the slopes of the lower and the upper half of an interval if they differ: it then contains a part of the toe or of the knee.
fn bend(rows: &[(f64, f64)], variances: Variances<'_>, whole: &Candidate) -> Option<[f64; 2]> {
    let middle = usize::midpoint(whole.from, whole.to);
    let half = |from: usize, to: usize| {
        let part = rows.get(from..to).filter(|part| part.len() >= FEWEST / 2)?;
        let count = part.len() as f64;
        let mean = part.iter().map(|row| row.0).sum::<f64>() / count;
        let points = part.iter().map(|&(e, s)| (e - mean, s, 1.0));
        let spread: f64 = points.clone().map(|(x, _, _)| x * x).sum();
        let noise = variances.noise[from..to].iter().sum::<f64>() / count;
        Some((line(points)?.b, noise / spread))
    };
    let ((lower, a), (upper, b)) = (half(whole.from, middle)?, half(middle, whole.to)?);
    let limit = (SAME_SLOPE * lower.max(upper)).max(SAME_SLOPE_ERRORS * (a + b).sqrt());
    ((lower - upper).abs() > limit).then_some([lower, upper])
}

/// Returns the first row from which the mean of five rows is at least this stress.
fn level(rows: &[(f64, f64)], stress: f64) -> usize {
    let mean = |five: &[(f64, f64)]| five.iter().map(|row| row.1).sum::<f64>() / five.len() as f64;
    rows.windows(5).position(|five| mean(five) >= stress).map_or(rows.len(), |k| if k == 0 { 0 } else { k + 2 })
}

/// Returns the best interval, and the root-mean-square difference between its slope and those of equally good intervals, Pa.
fn search(rows: &[(f64, f64)], variances: Variances<'_>, largest: f64) -> Option<(Candidate, f64)> {
    let stresses =
        std::iter::successors(Some(LEVELS_FROM), |part| Some(part * LEVELS_FACTOR)).take_while(|part| *part < 0.98);
    let mut places: Vec<usize> = std::iter::once(0).chain(stresses.map(|part| level(rows, part * largest))).collect();
    places.dedup();
    let pairs = places.iter().enumerate().flat_map(|(k, &from)| places[k + 1..].iter().map(move |&to| (from, to)));
    let all: Vec<Candidate> = pairs.filter_map(|(from, to)| candidate(rows, variances, from, to)).collect();
    // Among hundreds of intervals with few rows and much noise, some are too steep by three standard errors.
    let steepest = all.iter().map(|c| c.fit.b - 4.0 * c.total).fold(0.0, f64::max);
    let admitted = all.into_iter().filter(|c| c.fit.b + 2.0 * c.total >= ADMITTED * steepest && c.fit.b > 0.0);
    let admitted: Vec<Candidate> = admitted.filter(|c| !follows_steeper_rows(rows, variances, c)).collect();
    let best = *admitted.iter().min_by(|a, b| score(a).total_cmp(&score(b)))?;
    let as_good = admitted.iter().filter(|c| score(c) <= AS_GOOD * score(&best));
    let squares: Vec<f64> = as_good.map(|c| (c.fit.b - best.fit.b).powi(2)).collect();
    Some((best, (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()))
}

/// Whether the rows before an interval rise more steeply: they are then the elastic ones, too few for a line of their own.
fn follows_steeper_rows(rows: &[(f64, f64)], variances: Variances<'_>, c: &Candidate) -> bool {
    let (first, start) = (rows[0], rows[c.from].0);
    let rise = c.fit.at(start - c.mean) - first.1;
    rise > STEEPER * c.fit.b * (start - first.0) + SURELY * variances.noise[0].sqrt()
}

/// Returns the relative error of the slope; below the resolution, longer intervals have a smaller score.
fn score(c: &Candidate) -> f64 {
    let relative = c.total / c.fit.b;
    if relative > RESOLUTION { relative } else { RESOLUTION * (1.0 - 1e-3 * (c.to - c.from) as f64 / (c.to as f64)) }
}

fn candidate(rows: &[(f64, f64)], variances: Variances<'_>, from: usize, to: usize) -> Option<Candidate> {
    let part = rows.get(from..to).filter(|part| part.len() >= FEWEST)?;
    let count = part.len() as f64;
    let mean = part.iter().map(|row| row.0).sum::<f64>() / count;
    let points = part.iter().map(|&(e, s)| (e - mean, s, 1.0));
    let fit = line(points.clone())?;
    let ([_, _, c], [_, centre, _, _]) = (polynomial(points.clone())?, polynomial(points.clone())?);
    let spread: f64 = points.map(|(x, _, _)| x * x).sum();
    let width = part[part.len() - 1].0 - part[0].0;
    let mean_of = |variances: &[f64]| variances[from..to].iter().sum::<f64>() / count;
    let noise = mean_of(variances.noise);
    // Successive strains are rounded by similar or evenly growing amounts, so that more rows hardly improve the slope. Its error is 0.15 to 0.3 of
    // a step over the width.
    let rounding = 0.5 * fit.b * fit.b * mean_of(variances.rounding) / (width * width);
    let square = noise / spread + rounding;
    let error = (fit.residual.max(noise) / spread + rounding).sqrt();
    // From the middle to the ends of the interval the slope of a parabola changes by c times the width. A cubic, which can bend in opposite senses
    // at the two ends, as toe and knee do, gives the slope in the middle. For evenly spaced rows the variances of these two are 15 and 5.25 times
    // that of the slope.
    let by_curvature = ((c * width).powi(2) - 15.0 * square).max(0.0);
    let by_ends = ((centre - fit.b).powi(2) - 5.25 * square).max(0.0);
    Some(Candidate { from, to, mean, fit, error, total: (error * error + by_curvature + by_ends).sqrt(), width })
}

/// Returns the first row after the interval that is not on its line. Rows are compared with the line in groups, long enough for their mean to
/// distinguish 0.5 % of the stress from noise. Of tens of groups on the line some deviate by chance, so that two successive groups have to deviate
/// in the same sense. Shorter groups then locate the start of the deviation.
fn extend(rows: &[(f64, f64)], variances: Variances<'_>, best: &Candidate, largest: f64) -> usize {
    let (mut end, mut shorter) = (best.to, 1);
    while end < rows.len() {
        let noise = variances.noise[end].max(variances.noise[end - 1]);
        let told = 5e-3 * rows[end].1.max(1e-3 * largest);
        let needed = (4.0 * noise / (told * told)).ceil().clamp(1.0, 25.0) as usize;
        let count = (needed / shorter).max(1);
        let off = |from: usize| {
            rows.get(from..from + count).map(|group| off_line(group, [noise, variances.rounding[from]], best))
        };
        let Some(first) = off(end) else { return end };
        if first == 0.0 || first * off(end + count).unwrap_or(first) <= 0.0 {
            end += count;
        } else if count == 1 || shorter == SHORTEST {
            return end;
        } else {
            shorter *= 2;
        }
    }
    rows.len()
}

/// Returns by how much the mean of rows is below the line, Pa; 0 if noise, the rounding of strains, the error of the slope or the curvature of
/// elastic rows explain the difference. In the worst case all rows of the group are rounded by the same amount, and the line passes through two
/// rows at its ends.
fn off_line(group: &[(f64, f64)], [noise, rounding]: [f64; 2], best: &Candidate) -> f64 {
    let count = group.len() as f64;
    let (strain, stress) = group.iter().fold((0.0, 0.0), |sum, row| (sum.0 + row.0 / count, sum.1 + row.1 / count));
    let below = best.fit.at(strain - best.mean) - stress;
    let of_line = 0.5 + 1.5 * ((strain - best.mean) / best.width).powi(2);
    let rounding = best.fit.b * best.fit.b * rounding * (1.0 + of_line);
    let error = (noise / count + rounding + (best.error * (strain - best.mean)).powi(2)).sqrt();
    let explained = ON_LINE * error + (STRAIGHT + (CURVED * strain).min(MOST_CURVED)) * stress;
    if below.abs() > explained { below } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five elastic rows are too few; a line through the rows past the knee had 4 % of the modulus.
    #[test]
    fn a_line_past_the_knee_is_none() {
        let stress = |strain: f64| if strain < 5.2e-4 { 115e9 * strain } else { 60e6 + 4e9 * (strain - 5.2e-4) };
        let rows: Vec<(f64, f64)> = (0..300)
            .map(|i| 1e-4 * f64::from(i))
            .map(|strain| (strain, (stress(strain) / 1e6).round() * 1e6))
            .collect();
        assert_eq!(elastic_line(&rows, Variances { noise: &[0.3e12; 300], rounding: &[0.0; 300] }, None), None);
    }

    /// The end of the elastic line of a material that is linear in logarithmic strain and true stress up to a knee, in engineering values.
    #[test]
    fn the_elastic_line_ends_at_the_knee_of_a_clean_record() {
        let (modulus, knee) = (100e9, 0.002);
        let stress = |log: f64| if log <= knee { modulus * log } else { modulus * knee + 2e9 * (log - knee) };
        for steps in [40, 400] {
            let rows: Vec<(f64, f64)> = (0..5 * steps)
                .map(|i| knee * f64::from(i) / f64::from(steps - 1))
                .map(|log| (log.exp_m1(), stress(log) * (-log).exp()))
                .collect();
            let none = vec![0.0; rows.len()];
            let line = elastic_line(&rows, Variances { noise: &none, rounding: &none }, None).expect("a line");
            assert!((line.slope / modulus - 1.0).abs() < 5e-3, "{line:?}");
            // 1 % of the rows: past the knee the curve has to leave the line first.
            let last = rows[line.end - 1].0 / knee.exp_m1();
            assert!((0.999..1.02).contains(&last), "{steps}: {last}");
        }
    }
}

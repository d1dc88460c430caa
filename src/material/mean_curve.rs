//! The mean of the curves of several tests.
//!
//! Plastic strain and stress are averaged at equal fractions of the plastic strain at the largest stress, and after it at equal fractions of the
//! interval to the last row, so that tests which neck at different strains do not blunt the maximum of the mean. A test whose stress rises up to
//! its last row does not contain the interval after the largest stress: its fractions are those of the mean of the tests that do, scaled so that
//! both end together if it broke or is the longer one. After the end of a test the mean continues with the mean increment of the tests that have
//! data there, without a step.

use super::TestCurve;
use crate::error::InputError;
use crate::input::{Checked, positive};
use crate::units::Dimension;

/// Difference up to which fractions count as equal.
const SAME: f64 = 1e-9;

/// Checks that there is at least one test.
pub(crate) fn check_tests(count: usize) -> Checked {
    if count > 0 {
        return Ok(());
    }
    let error = InputError::new("there is no test to combine").key("tests");
    Err(error.allowed("at least one test").help("give the curves of the tests"))
}

/// Returns the mean of the moduli of several tests, Pa.
///
/// # Errors
/// There is no test.
pub fn mean_modulus(tests: &[TestCurve]) -> Result<f64, InputError> {
    check_tests(tests.len())?;
    Ok(tests.iter().map(|test| test.modulus).sum::<f64>() / tests.len() as f64)
}

/// Returns the mean of the curves of several tests: rows (strain, stress in Pa) from the elastic limit on, with elastic strains computed with
/// `modulus` (Pa). The rows are the knots of all tests, since the mean is also straight between them.
///
/// # Errors
/// There is no test, or the modulus is out of range.
pub fn mean_curve(tests: &[TestCurve], modulus: f64) -> Result<Vec<(f64, f64)>, InputError> {
    check_tests(tests.len())?;
    positive([("modulus", modulus, Dimension::Stress)])?;
    let flows = flows(tests);
    let mut rows: Vec<(f64, f64)> = Vec::new();
    let mut add = |(p, s): (f64, f64)| {
        let strain = p + s / modulus;
        // The slope between closer strains would be dominated by rounding.
        if rows.last().is_none_or(|last| strain > last.0 * (1.0 + SAME)) {
            rows.push((strain, s));
        }
    };
    let fractions = fractions(&flows);
    let mut at = mean(flows.iter().map(|flow| flow.at(0.0, Side::Behind)));
    add(at);
    for pair in fractions.windows(2) {
        let with_data: Vec<&Flow> = flows.iter().filter(|flow| flow.reach() > 0.5 * (pair[0] + pair[1])).collect();
        let between = |from: (f64, Side), to: (f64, Side)| {
            let change = |flow: &&Flow| {
                let (start, end) = (flow.at(from.0, from.1), flow.at(to.0, to.1));
                (end.0 - start.0, end.1 - start.1)
            };
            mean(with_data.iter().map(change))
        };
        for step in [
            between((pair[0], Side::Behind), (pair[1], Side::Before)),
            between((pair[1], Side::Before), (pair[1], Side::Behind)),
        ] {
            at = (at.0 + step.0, at.1 + step.1);
            add(at);
        }
    }
    Ok(rows)
}

fn mean(values: impl ExactSizeIterator<Item = (f64, f64)>) -> (f64, f64) {
    let count = values.len() as f64;
    let sum = values.fold((0.0, 0.0), |sum, value| (sum.0 + value.0, sum.1 + value.1));
    (sum.0 / count, sum.1 / count)
}

/// Returns the curves with the plastic strains that their fractions refer to.
fn flows(tests: &[TestCurve]) -> Vec<Flow> {
    let mut flows: Vec<Flow> = tests.iter().map(Flow::of).collect();
    let longest = flows.iter().map(Flow::last).fold(0.0, f64::max);
    let (top, end) = mean_spans(flows.iter().filter(|flow| flow.falls()))
        .or_else(|| mean_spans(flows.iter().filter(|flow| !flow.stopped)))
        .unwrap_or((longest, longest));
    for flow in flows.iter_mut().filter(|flow| !flow.falls()) {
        let scale = if end > 0.0 { flow.end / end } else { 1.0 };
        let scale = if flow.stopped { scale.max(1.0) } else { scale };
        (flow.top, flow.end) = (scale * top, scale * end);
    }
    flows
}

/// Returns the mean plastic strains at the largest stress and at the last row.
fn mean_spans<'a>(flows: impl Iterator<Item = &'a Flow>) -> Option<(f64, f64)> {
    let spans: Vec<(f64, f64)> = flows.map(|flow| (flow.top, flow.end)).collect();
    (!spans.is_empty()).then(|| mean(spans.into_iter()))
}

/// Returns the fractions of all knots, in increasing order.
fn fractions(flows: &[Flow]) -> Vec<f64> {
    let mut all: Vec<f64> =
        flows.iter().flat_map(|flow| flow.points.iter().map(|point| flow.fraction(point.0))).chain([0.0]).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|later, first| *later - *first < SAME);
    all
}

/// Side from which the limit of a value at a jump is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Before,
    Behind,
}

/// Stress as a function of plastic strain, which never decreases, from the elastic limit on.
struct Flow {
    points: Vec<(f64, f64)>,
    /// Plastic strain at fraction 1, that of the largest stress.
    top: f64,
    /// Plastic strain at fraction 2, that of the last row.
    end: f64,
    stopped: bool,
}

impl Flow {
    fn of(test: &TestCurve) -> Self {
        let limit = test.curve.elastic_limit(test.modulus);
        let mut points = vec![(0.0, limit.1)];
        let mut top = (0.0, limit.1);
        for (&strain, &stress) in test.curve.strain().iter().zip(test.curve.stress()).filter(|knot| *knot.0 > limit.0) {
            let p = (strain - stress / test.modulus).max(points[points.len() - 1].0);
            points.push((p, stress));
            if stress > top.1 {
                top = (p, stress);
            }
        }
        let end = points[points.len() - 1].0;
        Self { points, top: top.0, end, stopped: test.stopped_while_rising() }
    }

    /// Whether the curve continues after the largest stress.
    fn falls(&self) -> bool {
        self.end > self.top
    }

    fn last(&self) -> f64 {
        self.points[self.points.len() - 1].0
    }

    fn fraction(&self, p: f64) -> f64 {
        if p > self.top {
            1.0 + (p - self.top) / (self.end - self.top)
        } else if self.top > 0.0 {
            p / self.top
        } else {
            0.0
        }
    }

    /// Returns the fraction at its last row.
    fn reach(&self) -> f64 {
        self.fraction(self.last())
    }

    /// Returns the plastic strain and the stress at a fraction.
    fn at(&self, t: f64, side: Side) -> (f64, f64) {
        let p = if t <= 1.0 { t * self.top } else { self.top + (t - 1.0) * (self.end - self.top) };
        let near = SAME * self.last();
        let behind = match side {
            Side::Before => self.points.partition_point(|point| point.0 < p - near),
            Side::Behind => self.points.partition_point(|point| point.0 <= p + near),
        };
        let [before, after] = [behind.saturating_sub(1), behind.min(self.points.len() - 1)].map(|k| self.points[k]);
        let on_knot = match side {
            Side::Before => after,
            Side::Behind => before,
        };
        if (on_knot.0 - p).abs() <= near {
            return on_knot;
        }
        (p, before.1 + (after.1 - before.1) * (p - before.0) / (after.0 - before.0))
    }
}

#[cfg(test)]
mod tests {
    use super::{TestCurve, mean_curve};
    use crate::material::{Beyond, Curve};

    /// Elastic up to 200 MPa, a yield drop, a jump of an elastic slope, and a largest stress.
    const KNOTS: [(f64, f64); 8] = [
        (0.001, 200e6),
        (0.0012, 180e6),
        (0.02, 185e6),
        (0.02002, 189e6),
        (0.05, 250e6),
        (0.1, 300e6),
        (0.15, 320e6),
        (0.2, 310e6),
    ];

    fn test(knots: &[(f64, f64)], scale: f64, beyond: Beyond) -> TestCurve {
        let rows: Vec<_> = knots.iter().map(|&(e, s)| (scale * e, scale * s)).collect();
        TestCurve {
            record: "a".into(),
            modulus: 200e9,
            density: None,
            curve: Curve::new(&rows, beyond).expect("a curve"),
        }
    }

    fn near(found: &[(f64, f64)], expected: impl Iterator<Item = (f64, f64)>) {
        let expected: Vec<_> = expected.collect();
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (a, b) in found.iter().zip(expected) {
            assert!((a.0 / b.0 - 1.0).abs() < 1e-7 && (a.1 / b.1 - 1.0).abs() < 1e-7, "{found:?}");
        }
    }

    fn mean(tests: &[TestCurve], modulus: f64) -> Vec<(f64, f64)> {
        mean_curve(tests, modulus).expect("tests")
    }

    #[test]
    fn the_mean_of_equal_curves_is_the_curve() {
        let same = [0; 3].map(|_| test(&KNOTS, 1.0, Beyond::Error));
        near(&mean(&same, 200e9), KNOTS.into_iter());
        let scaled = [0.9, 1.1].map(|scale| test(&KNOTS, scale, Beyond::Error));
        near(&mean(&scaled, 200e9), KNOTS.into_iter());
    }

    #[test]
    fn a_test_that_breaks_while_its_stress_rises_does_not_lengthen_the_mean() {
        let falling = test(&KNOTS, 1.0, Beyond::Rupture);
        let mut knots = KNOTS;
        knots[7] = (0.2 + 12e6 / 200e9, 322e6);
        let rising = test(&knots, 1.0, Beyond::Rupture);
        let top = (320e6 + 2.0 * 320e6) / 3.0;
        let end = (322e6 + 2.0 * 310e6) / 3.0;
        // The same plastic strains: stresses are averaged, with elastic strains of their own.
        let at = |knot: (f64, f64), stress: f64| (knot.0 + (stress - knot.1) / 200e9, stress);
        let expected = KNOTS[..6].iter().copied().chain([at(KNOTS[6], top), at(KNOTS[7], end)]);
        near(&mean(&[falling.clone(), rising, falling], 200e9), expected);
    }

    #[test]
    fn a_test_that_stopped_neither_ends_nor_lowers_the_mean() {
        let whole = test(&KNOTS, 1.0, Beyond::Error);
        let stopped = test(&KNOTS[..6], 1.0, Beyond::Error);
        assert!(stopped.stopped_while_rising() && !whole.stopped_while_rising());
        near(&mean(&[whole.clone(), stopped, whole], 200e9), KNOTS.into_iter());
        // Two that stopped at different strains: the mean goes as far as the longer one.
        let both = [&KNOTS[..5], &KNOTS[..6]].map(|knots| test(knots, 1.0, Beyond::Error));
        near(&mean(&both, 200e9), KNOTS[..6].iter().copied());
    }
}

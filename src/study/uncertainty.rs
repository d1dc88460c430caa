//! The uncertainty of a critical velocity from the scatter of repeated tests.

use rand::{RngExt, SeedableRng};
use rand_xorshift::XorShiftRng;
use rayon::prelude::*;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use super::moments::moments;
use super::random::standard_normal;
use crate::material::{Beyond, Curve, Material, Scatter, Sense, TestCurve, mean_curve};
use crate::wave::similarity;

/// How the bootstrap is carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bootstrap {
    /// Resamples.
    pub resamples: usize,
    /// Seed of the random numbers; the result does not depend on the number of threads.
    pub seed: u64,
}

/// The critical velocity of one test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OfTest {
    /// Name of its record.
    pub record: String,
    /// m/s; none where the data hold none.
    pub critical_velocity_m_s: Option<f64>,
}

/// The critical velocity with its scatter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Uncertainty {
    /// "tests" where the curves of tests are resampled, "deviation" where the curve is moved by its standard deviation.
    pub basis: &'static str,
    /// The tests; empty for a deviation.
    pub tests: Vec<OfTest>,
    /// Mean of the tests, or of the moved curves, m/s.
    pub mean_m_s: f64,
    /// Standard deviation of single specimens, m/s.
    pub standard_deviation_m_s: f64,
    /// 95 % interval, m/s: of the critical velocity of the mean curve for tests (at least 3), of that of a specimen for a deviation.
    pub interval_95_m_s: Option<[f64; 2]>,
    /// Resamples.
    pub resamples: usize,
    /// Seed.
    pub seed: u64,
}

/// Fewest tests that have an interval.
const FEWEST: usize = 3;

/// Parts of a distribution outside its 95 % interval, on each side.
const TAIL: f64 = 0.025;

/// The uncertainty of the critical velocity of a material by its scatter; none without scatter, in the other sense, or where fewer than two
/// of the tests have a critical velocity.
pub fn uncertainty(material: &Material, sense: Sense, how: Bootstrap) -> Option<Uncertainty> {
    let scatter = material.scatter.as_deref()?;
    if sense == Sense::Compression && material.compression.is_some() {
        return None;
    }
    if scatter.tests.is_empty() {
        of_deviation(material.branch(sense), material.density, scatter, how)
    } else {
        of_tests(&scatter.tests, material.density, how)
    }
}

/// Tests are drawn with replacement; the statistic is the critical velocity of their mean curve. The percentiles are widened for few tests
/// so that for normal scatter they are those of Student's t (Hesterberg, The American Statistician 69, 2015, 371-386).
fn of_tests(tests: &[TestCurve], density: f64, how: Bootstrap) -> Option<Uncertainty> {
    let own = |test: &TestCurve| test.density.unwrap_or(density);
    let velocity = |test: &TestCurve| similarity::critical(&test.curve, own(test)).map(|c| c.velocity);
    let each: Vec<Option<f64>> = tests.iter().map(velocity).collect();
    let usable: Vec<&TestCurve> = tests.iter().zip(&each).filter(|(_, v)| v.is_some()).map(|(test, _)| test).collect();
    let values: Vec<f64> = each.iter().flatten().copied().collect();
    let (mean, deviation) = moments(values.iter().copied())?;
    let resampled = || {
        resample(how, |rng| {
            let drawn: Vec<&TestCurve> = usable.iter().map(|_| usable[rng.random_range(0..usable.len())]).collect();
            of_rows(&mean_curve(&drawn).1, density)
        })
    };
    let interval = (usable.len() >= FEWEST).then(|| interval(resampled(), widened_tail(usable.len()))).flatten();
    let named = tests.iter().zip(&each);
    Some(Uncertainty {
        basis: "tests",
        tests: named.map(|(t, v)| OfTest { record: t.record.clone(), critical_velocity_m_s: *v }).collect(),
        mean_m_s: mean,
        standard_deviation_m_s: deviation,
        interval_95_m_s: interval,
        resamples: how.resamples,
        seed: how.seed,
    })
}

/// The whole curve is moved by a normally distributed multiple of its standard deviation, the same at all strains.
fn of_deviation(curve: &Curve, density: f64, scatter: &Scatter, how: Bootstrap) -> Option<Uncertainty> {
    let moved = resample(how, |rng| {
        let z = standard_normal(rng);
        let knots = curve.strain().iter().zip(curve.stress()).skip(1);
        let rows: Vec<_> = knots.map(|(&e, &s)| (e, (s + z * scatter.deviation_at(e)).max(0.0))).collect();
        of_rows(&rows, density)
    });
    let (mean, deviation) = moments(moved.iter().copied())?;
    Some(Uncertainty {
        basis: "deviation",
        tests: Vec::new(),
        mean_m_s: mean,
        standard_deviation_m_s: deviation,
        interval_95_m_s: interval(moved, TAIL),
        resamples: how.resamples,
        seed: how.seed,
    })
}

/// Critical velocity of rows that hold their largest stress, as the mean of tests with a critical velocity does.
fn of_rows(rows: &[(f64, f64)], density: f64) -> Option<f64> {
    let curve = Curve::new(rows, Beyond::Rupture).ok()?;
    similarity::critical(&curve, density).map(|c| c.velocity)
}

/// Draws on all threads; each has random numbers of its own, so that the result does not depend on their number.
fn resample(how: Bootstrap, draw: impl Fn(&mut XorShiftRng) -> Option<f64> + Sync) -> Vec<f64> {
    let one = |k: usize| {
        draw(&mut XorShiftRng::seed_from_u64(how.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(k as u64)))
    };
    (0..how.resamples).into_par_iter().filter_map(one).collect()
}

/// The part of the bootstrap distribution outside the interval of `count` tests, on each side.
fn widened_tail(count: usize) -> f64 {
    let degrees = (count - 1) as f64;
    let (Ok(student), Ok(normal)) = (StudentsT::new(0.0, 1.0, degrees), Normal::new(0.0, 1.0)) else { return TAIL };
    normal.cdf((count as f64 / degrees).sqrt() * student.inverse_cdf(TAIL))
}

/// The values between which all but a part `tail` on each side lies.
fn interval(mut values: Vec<f64>, tail: f64) -> Option<[f64; 2]> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let at = |part: f64| {
        let place = part * last as f64;
        let low = place.floor() as usize;
        values[low] + (place - low as f64) * (values[(low + 1).min(last)] - values[low])
    };
    Some([at(tail), at(1.0 - tail)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_tests_have_wider_percentiles() {
        // t(0.975, 4) = 2.7764 and t(0.975, 19) = 2.0930: the normal distribution has 0.00095 and 0.0159 below
        // -2.7764 sqrt(5/4) and -2.0930 sqrt(20/19).
        assert!((widened_tail(5) - 0.00095).abs() < 1e-5, "{}", widened_tail(5));
        assert!((widened_tail(20) - 0.0159).abs() < 1e-4, "{}", widened_tail(20));
        assert!((widened_tail(10_000) - TAIL).abs() < 1e-4);
    }

    #[test]
    fn a_deviation_in_proportion_to_the_stress_has_half_its_scatter() {
        let rows = [(0.001, 200e6), (0.05, 300e6), (0.1, 400e6)];
        let mut material = Material::from_curve("a", 8000.0, Curve::new(&rows, Beyond::Rupture).expect("a curve"));
        let deviation = rows.iter().map(|row| (row.0, 0.04 * row.1)).collect();
        material.scatter = Some(Box::new(Scatter { deviation, tests: Vec::new() }));
        let found = uncertainty(&material, Sense::Tension, Bootstrap { resamples: 4000, seed: 7 }).expect("scatter");
        let velocity = similarity::critical(&material.tension, 8000.0).expect("critical").velocity;
        assert!((found.standard_deviation_m_s / velocity / 0.02 - 1.0).abs() < 0.05, "{found:?}");
        let [low, high] = found.interval_95_m_s.expect("an interval");
        // Of sqrt(1 + 0.04 z) with z = -1.96 and 1.96.
        assert!((low / velocity / 0.9600 - 1.0).abs() < 4e-3 && (high / velocity / 1.0385 - 1.0).abs() < 4e-3);
    }
}

//! Uncertainty of a critical velocity due to the scatter of repeated tests.

use rand::SeedableRng;
use rand_xorshift::XorShiftRng;
use rayon::prelude::*;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::moments::moments;
use super::random::standard_normal;
use crate::material::{Beyond, Curve, Material, Scatter, Sense, TestCurve};
use crate::wave::similarity;

/// Number and seed of the random specimens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bootstrap {
    /// Number of specimens.
    pub resamples: usize,
    /// Seed of the random numbers; the result does not depend on the number of threads.
    pub seed: u64,
}

/// Critical velocity of one test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OfTest {
    /// Name of the record of the test.
    pub record: String,
    /// Critical velocity, m/s; `None` if the curve of the test has no ultimate point.
    pub critical_velocity_m_s: Option<f64>,
}

/// Statistics of the critical velocity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Uncertainty {
    /// "tests" if the material has curves of single tests; "deviation" if its curve is shifted by multiples of its standard deviation.
    pub basis: &'static str,
    /// The tests; empty for a deviation.
    pub tests: Vec<OfTest>,
    /// Mean of the tests or of the shifted curves, m/s; `None` if fewer than two have a critical velocity.
    pub mean_m_s: Option<f64>,
    /// Standard deviation of single specimens, m/s; `None` if fewer than two have a critical velocity.
    pub standard_deviation_m_s: Option<f64>,
    /// 95 % interval, m/s. For tests (at least 3): Student's t interval of the mean. For a deviation: interval of a single specimen.
    pub interval_95_m_s: Option<[f64; 2]>,
    /// Number of random specimens; `None` for tests.
    pub resamples: Option<usize>,
    /// Seed of the random numbers; `None` for tests.
    pub seed: Option<u64>,
}

/// Fewest tests with a critical velocity for which an interval is computed.
pub const FEWEST: usize = 3;

/// Probability outside the 95 % interval on each side.
const TAIL: f64 = 0.025;

/// Computes the uncertainty of the critical velocity of a material from its scatter. Returns `None` without scatter, and in compression if the
/// material has a separate compression curve, to which the scatter does not apply.
pub fn uncertainty(material: &Material, sense: Sense, how: Bootstrap) -> Option<Uncertainty> {
    let scatter = material.scatter.as_deref()?;
    if sense == Sense::Compression && material.compression.is_some() {
        return None;
    }
    if scatter.tests.is_empty() {
        of_deviation(material, sense, scatter, how)
    } else {
        Some(of_tests(&scatter.tests, material.density))
    }
}

/// Computes the mean, the standard deviation and Student's t interval of the critical velocities of the tests. Bootstrap resampling is not used,
/// because few tests show only part of the scatter and the interval would be too narrow: for three tests it contains the mean in only four of five
/// cases.
fn of_tests(tests: &[TestCurve], density: f64) -> Uncertainty {
    let of_test = |test: &TestCurve| OfTest {
        record: test.record.clone(),
        critical_velocity_m_s: similarity::critical(&test.curve, test.density.unwrap_or(density)).map(|c| c.velocity),
    };
    let tests: Vec<OfTest> = tests.iter().map(of_test).collect();
    let values: Vec<f64> = tests.iter().filter_map(|test| test.critical_velocity_m_s).collect();
    let (mean, deviation) = moments(values.iter().copied()).unzip();
    let interval = mean.zip(deviation).filter(|_| values.len() >= FEWEST).map(|(mean, deviation)| {
        let half = students_t(values.len() - 1) * deviation / (values.len() as f64).sqrt();
        [mean - half, mean + half]
    });
    Uncertainty {
        basis: "tests",
        tests,
        mean_m_s: mean,
        standard_deviation_m_s: deviation,
        interval_95_m_s: interval,
        resamples: None,
        seed: None,
    }
}

/// Returns the 97.5 % quantile of Student's t distribution.
fn students_t(degrees: usize) -> f64 {
    StudentsT::new(0.0, 1.0, degrees as f64).map_or(f64::INFINITY, |student| student.inverse_cdf(1.0 - TAIL))
}

/// Computes the uncertainty for a standard deviation of the flow stress. The flow stress of a specimen is shifted by a normally distributed multiple
/// of the standard deviation, the same at all strains.
fn of_deviation(material: &Material, sense: Sense, scatter: &Scatter, how: Bootstrap) -> Option<Uncertainty> {
    let curve = material.branch(sense);
    let moved = resample(how, |rng| {
        let z = standard_normal(rng);
        of_rows(&moved_rows(curve, material.modulus, |strain| z * scatter.deviation_at(strain)), material.density)
    });
    let (mean, deviation) = moments(moved.iter().copied())?;
    Some(Uncertainty {
        basis: "deviation",
        tests: Vec::new(),
        mean_m_s: Some(mean),
        standard_deviation_m_s: Some(deviation),
        interval_95_m_s: interval(moved, TAIL),
        resamples: Some(how.resamples),
        seed: Some(how.seed),
    })
}

/// Returns the rows from the elastic limit on, with stresses shifted by `by(strain)` at constant plastic strain. Up to the shifted limit the curve is
/// the elastic line of `modulus`, which does not scatter.
fn moved_rows(curve: &Curve, modulus: f64, by: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let limit = curve.elastic_limit(modulus).0;
    let mut rows: Vec<(f64, f64)> = Vec::new();
    let plastic = curve.strain().iter().zip(curve.stress()).filter(|knot| *knot.0 > 0.0 && *knot.0 >= limit);
    for (&strain, &stress) in plastic {
        let moved = (stress + by(strain)).max(0.0);
        let strain = strain + (moved - stress) / modulus;
        // A drop as steep as elastic unloading does not increase the strain: the row before it is kept.
        if strain > rows.last().map_or(0.0, |last| last.0) {
            rows.push((strain, moved));
        }
    }
    rows
}

/// Returns the critical velocity of a curve with these rows. If the largest stress is that of the last row, the curve ends there by fracture.
fn of_rows(rows: &[(f64, f64)], density: f64) -> Option<f64> {
    let curve = Curve::new(rows, Beyond::Rupture).ok()?;
    similarity::critical(&curve, density).map(|c| c.velocity)
}

/// Draws the specimens on all threads. Each specimen has its own random numbers, so the result does not depend on the number of threads.
fn resample(how: Bootstrap, draw: impl Fn(&mut XorShiftRng) -> Option<f64> + Sync) -> Vec<f64> {
    let one = |k: usize| {
        draw(&mut XorShiftRng::seed_from_u64(how.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(k as u64)))
    };
    (0..how.resamples).into_par_iter().filter_map(one).collect()
}

/// Returns the quantiles `tail` and 1 - `tail` of the values.
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
    fn the_interval_of_few_tests_is_that_of_students_t() {
        // t(0.975, 2) = 4.30265, t(0.975, 4) = 2.77645.
        for (degrees, expected) in [(2, 4.302_65), (4, 2.776_45)] {
            assert!((students_t(degrees) / expected - 1.0).abs() < 1e-5, "{degrees}: {}", students_t(degrees));
        }
        let test = |scale: f64| TestCurve {
            record: "a".into(),
            modulus: 200e9,
            density: None,
            curve: Curve::new(&[(0.001, 200e6), (0.1 * scale, 300e6)], Beyond::Rupture).expect("a curve"),
        };
        let found = of_tests(&[test(0.9), test(1.0), test(1.1)], 8000.0);
        let (mean, deviation) = found.mean_m_s.zip(found.standard_deviation_m_s).expect("three tests");
        let [low, high] = found.interval_95_m_s.expect("three tests");
        assert!((0.5 * (low + high) / mean - 1.0).abs() < 1e-12);
        assert!((0.5 * (high - low) / (4.302_65 * deviation / 3.0_f64.sqrt()) - 1.0).abs() < 1e-5);
        let open = Curve::new(&[(0.001, 200e6), (0.1, 300e6)], Beyond::Error).expect("a curve");
        let stopped = TestCurve { curve: open, ..test(1.0) };
        let found = of_tests(&[test(1.0), stopped], 8000.0);
        assert!(found.tests.len() == 2 && found.mean_m_s.is_none() && found.interval_95_m_s.is_none(), "{found:?}");
    }

    #[test]
    fn a_deviation_of_the_stress_moves_the_plastic_rows_and_leaves_the_elastic_line() {
        let rows = [(0.001, 200e6), (0.05, 300e6), (0.1, 400e6)];
        let mut material = Material::from_curve("a", 8000.0, Curve::new(&rows, Beyond::Rupture).expect("a curve"))
            .expect("a material");
        let deviation = rows.iter().map(|row| (row.0, 0.04 * row.1)).collect();
        material.scatter = Some(Box::new(Scatter { deviation, tests: Vec::new() }));
        let found = uncertainty(&material, Sense::Tension, Bootstrap { resamples: 4000, seed: 7 }).expect("scatter");
        // 5 m/s up to the elastic limit, and sqrt(d sigma d eps/rho) for each segment.
        let velocity = |z: f64| {
            let segment = |strain: f64, stress: f64| {
                let more = 0.04 * z * stress;
                ((stress + more) * (strain + more / 200e9) / 8000.0).sqrt()
            };
            5.0 * (1.0 + 0.04 * z) + segment(0.049, 100e6) + segment(0.05, 100e6)
        };
        let slope = 0.5 * (velocity(1.0) - velocity(-1.0));
        let deviation = found.standard_deviation_m_s.expect("scatter");
        assert!((deviation / slope - 1.0).abs() < 0.05, "{found:?}");
        let [low, high] = found.interval_95_m_s.expect("an interval");
        for (bound, z) in [(low, -1.96), (high, 1.96)] {
            assert!((bound / velocity(z) - 1.0).abs() < 4e-3, "{bound} {}", velocity(z));
        }
    }
}

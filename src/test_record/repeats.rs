//! One mean curve with a scatter band from several repeats of one test.

use super::decimate::decimate;
use super::reduce::{Reduction, check_tolerance, rounded, six_digits};
use crate::error::InputError;
use crate::material::{Beyond, Curve, Scatter, TestCurve, check_tests, mean_curve, mean_modulus};

/// The mean of several tests and their scatter.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeats {
    /// Mean modulus, Pa.
    pub modulus: f64,
    /// Knots (strain, stress in Pa) of the mean curve from the origin; the second one is the end of the elastic line.
    pub knots: Vec<(f64, f64)>,
    /// Behaviour after the last knot: rupture if all tests that reached it broke there, otherwise unknown.
    pub beyond: Beyond,
    /// One sentence if the tests are hardly of one material, and one for each test that ends before the mean curve.
    pub notes: Vec<String>,
    /// Contents of `[band]` of the material file.
    pub scatter: Scatter,
}

/// Factor by which the knots of the mean are closer to it than those of a test are to its record, so that they add little to the error of the
/// latter.
const FINER: f64 = 4.0;

/// Combines reduced records (name, reduction). `tolerance` is that of the knots, relative to the largest stress.
///
/// # Errors
/// There is no test, the tolerance is out of range, or the knots of a reduction do not form a curve.
pub fn combine(tests: &[(String, Reduction)], tolerance: f64) -> Result<Repeats, InputError> {
    check_tolerance(tolerance)?;
    check_tests(tests.len())?;
    let curve = |(record, reduction): &(String, Reduction)| {
        let beyond = if reduction.fracture.is_some() { Beyond::Rupture } else { Beyond::Error };
        let curve = Curve::new(&reduction.knots, beyond).map_err(|e| InputError::new(format!("{record}: {e}")))?;
        Ok(TestCurve { record: record.clone(), modulus: reduction.modulus, density: None, curve })
    };
    let tests = tests.iter().map(curve).collect::<Result<Vec<_>, InputError>>()?;
    let modulus = six_digits(mean_modulus(&tests)?);
    let rows: Vec<(f64, f64)> = std::iter::once((0.0, 0.0)).chain(mean_curve(&tests, modulus)?).collect();
    let knots = rounded(&decimate(&rows, tolerance / FINER), modulus);
    let reached: Vec<&TestCurve> = tests.iter().filter(|test| !test.stopped_while_rising()).collect();
    let all_broke = !reached.is_empty() && reached.iter().all(|test| test.curve.beyond() == Beyond::Rupture);
    let beyond = if all_broke { Beyond::Rupture } else { Beyond::Error };
    let notes = differing(&tests).into_iter().chain(stopped(&tests)).collect();
    let deviation = deviation(&tests, &knots);
    Ok(Repeats { modulus, knots, beyond, notes, scatter: Scatter { deviation, tests } })
}

/// Largest difference between repeats of one test, relative to the mean.
const ALIKE: f64 = 0.2;

/// Returns a sentence if the tests look like those of different materials.
fn differing(tests: &[TestCurve]) -> Option<String> {
    let shortest = tests.iter().map(|test| test.curve.last_strain()).fold(f64::INFINITY, f64::min);
    let named = [
        ("moduli", 1e9, "GPa", tests.iter().map(|test| test.modulus).collect::<Vec<_>>()),
        ("largest stresses", 1e6, "MPa", tests.iter().map(|test| largest_stress(test, shortest)).collect()),
    ];
    let differ = named.into_iter().filter_map(|(what, unit, symbol, values)| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(0.0, f64::max);
        (high - low > ALIKE * 0.5 * (high + low))
            .then(|| format!("{what} from {:.1} to {:.1} {symbol}", low / unit, high / unit))
    });
    let differ: Vec<_> = differ.collect();
    (!differ.is_empty()).then(|| {
        format!(
            "the tests differ by more than repeats of one test do ({}): check that they are of one material",
            differ.join(", ")
        )
    })
}

/// Returns the largest stress of a test up to a strain, Pa.
fn largest_stress(test: &TestCurve, strain: f64) -> f64 {
    let rows = test.curve.strain().iter().zip(test.curve.stress()).filter(|(at, _)| **at <= strain);
    rows.map(|(_, stress)| *stress).fold(test.curve.stress_at(strain), f64::max)
}

/// Returns a sentence for each test that was stopped while its stress rose, about its part in the mean curve.
fn stopped(tests: &[TestCurve]) -> Vec<String> {
    let of = |test: &TestCurve| {
        let (record, strain) = (&test.record, test.curve.last_strain());
        format!(
            "{record} ends at strain {strain:.5} while its stress rises: past it the mean curve goes on by the mean increment of the \
             other tests"
        )
    };
    let longest = tests.iter().map(|test| test.curve.last_strain()).fold(0.0, f64::max);
    let ends = |test: &&TestCurve| test.stopped_while_rising() && test.curve.last_strain() < longest;
    tests.iter().filter(ends).map(of).collect()
}

/// Returns the standard deviation of the stress at the strains of the knots, up to the end of the shortest test.
fn deviation(tests: &[TestCurve], knots: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let shortest = tests.iter().map(|test| test.curve.last_strain()).fold(f64::INFINITY, f64::min);
    let count = tests.len() as f64;
    let at = |strain: f64| {
        let stresses: Vec<f64> = tests.iter().map(|test| test.curve.stress_at(strain)).collect();
        let mean = stresses.iter().sum::<f64>() / count;
        let square = stresses.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        (strain, (square.sqrt() / 100.0).round() * 100.0)
    };
    knots.iter().map(|knot| knot.0).filter(|strain| *strain > 0.0 && *strain <= shortest).map(at).collect()
}

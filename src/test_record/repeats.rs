//! One curve with a band from several repeats of one test.

use super::decimate::decimate;
use super::reduce::Reduction;
use crate::error::InputError;
use crate::material::{Beyond, Curve, Scatter, TestCurve, mean_curve};

/// The mean of several tests and their scatter.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeats {
    /// Mean modulus, Pa.
    pub modulus: f64,
    /// (strain, stress in Pa) of the mean curve, from the end of its elastic line on.
    pub knots: Vec<(f64, f64)>,
    /// What `[band]` of the material file holds.
    pub scatter: Scatter,
}

/// Combines reduced records (name, reduction). `tolerance` is that of the knots, over the largest stress.
///
/// # Errors
/// A reduction whose knots are no curve.
pub fn combine(tests: &[(String, Reduction)], tolerance: f64) -> Result<Repeats, InputError> {
    let curve = |(record, reduction): &(String, Reduction)| {
        let beyond = if reduction.fracture.is_some() { Beyond::Rupture } else { Beyond::Error };
        let curve = Curve::new(&reduction.knots, beyond).map_err(|e| InputError::new(format!("{record}: {e}")))?;
        Ok(TestCurve { record: record.clone(), modulus: reduction.modulus, density: None, curve })
    };
    let tests = tests.iter().map(curve).collect::<Result<Vec<_>, InputError>>()?;
    let (modulus, rows) = mean_curve(&tests.iter().collect::<Vec<_>>());
    let knots = decimate(&rows, tolerance);
    let deviation = deviation(&tests, &knots);
    Ok(Repeats { modulus, knots, scatter: Scatter { deviation, tests } })
}

/// Standard deviation of the stress at the strains of the knots, as far as all tests go.
fn deviation(tests: &[TestCurve], knots: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let shortest = tests.iter().map(|test| test.curve.last_strain()).fold(f64::INFINITY, f64::min);
    let count = tests.len() as f64;
    let at = |strain: f64| {
        let stresses: Vec<f64> = tests.iter().map(|test| test.curve.stress_at(strain)).collect();
        let mean = stresses.iter().sum::<f64>() / count;
        let square = stresses.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        (strain, (square.sqrt() / 100.0).round() * 100.0)
    };
    knots.iter().map(|knot| knot.0).filter(|strain| *strain <= shortest).map(at).collect()
}

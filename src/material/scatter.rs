//! The scatter of repeated tests about a curve. Runs ignore it; uncertainty studies use it.

use serde::Serialize;

use super::csv;
use super::curve::above_modulus;
use super::keys::Keys;
use super::raw::{RawBand, RawTest};
use super::row::TableRow;
use super::{Beyond, Curve, CurveError};
use crate::error::{InputError, Result};
use crate::input::Allowed;
use crate::units::{Dimension, Quantity};

/// The scatter of repeated tests.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Scatter {
    /// Rows (engineering strain, standard deviation of the engineering stress in Pa).
    pub deviation: Vec<(f64, f64)>,
    /// One curve per test.
    pub tests: Vec<TestCurve>,
}

/// The curve of one test, in engineering measure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestCurve {
    /// Name of the record.
    pub record: String,
    /// Elastic modulus, Pa.
    #[serde(rename = "modulus_Pa")]
    pub modulus: f64,
    /// Density, kg/m^3; `None` if it is that of the material.
    #[serde(skip)]
    pub density: Option<f64>,
    /// The curve.
    pub curve: Curve,
}

impl Scatter {
    /// Returns the standard deviation of the stress at a strain, Pa: linear between rows, constant after the last one.
    pub fn deviation_at(&self, strain: f64) -> f64 {
        interpolate(&self.deviation, strain)
    }
}

impl TestCurve {
    /// Whether the test was stopped while its stress rose: its data contain neither a largest stress nor a fracture.
    pub fn stopped_while_rising(&self) -> bool {
        self.curve.ultimate().is_none()
    }
}

/// Interpolates linearly between points of increasing x, constant outside; 0 without points.
fn interpolate(points: &[(f64, f64)], x: f64) -> f64 {
    let upper = points.partition_point(|point| point.0 <= x);
    match (upper.checked_sub(1).map(|k| points[k]), points.get(upper)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0),
        (Some(only), None) => only.1,
        (None, first) => first.map_or(0.0, |only| only.1),
    }
}

/// Checks and converts `[band]`.
pub(super) fn resolve(raw: RawBand, beyond: Beyond, keys: Keys<'_>) -> Result<Scatter> {
    let unit = match &raw.unit {
        Some(unit) => csv::factor(unit.get_ref(), Dimension::Stress)
            .map_err(|e| keys.error(unit.span(), "band.unit", e.message).help(e.help))?,
        None => 1.0,
    };
    let deviation = raw
        .deviation
        .as_ref()
        .map_or_else(|| Ok(Vec::new()), |rows| table(rows.get_ref(), "band.deviation", unit, keys))?;
    if let (Some(rows), true) = (&raw.deviation, deviation.windows(2).any(|pair| pair[1].0 <= pair[0].0)) {
        let error = keys.error(rows.span(), "band.deviation", "the strain does not increase from row to row");
        return Err(error.help("sort the rows by strain, each strain once").into());
    }
    let tests = raw.test.unwrap_or_default().into_iter().enumerate();
    let tests = tests.map(|(k, raw)| test(&raw, k, beyond, unit, keys)).collect::<Result<_>>()?;
    Ok(Scatter { deviation, tests })
}

fn test(raw: &RawTest, place: usize, beyond: Beyond, unit: f64, keys: Keys<'_>) -> Result<TestCurve> {
    let key = format!("band.test.{place}");
    let wrong = |message: String| -> InputError {
        keys.error(raw.table.span(), &format!("{key}.table"), message)
            .allowed(CurveError::ALLOWED)
            .help("rows are [strain, stress] as magnitudes; the first row is (0, 0) or omitted")
    };
    let rows = table(raw.table.get_ref(), &format!("{key}.table"), unit, keys)?;
    let curve = Curve::new(&rows, raw.beyond.unwrap_or(beyond)).map_err(|e| wrong(e.to_string()))?;
    let modulus = keys.si(&raw.modulus)?.unwrap_or_else(|| curve.steepest());
    let curve = curve.on_elastic_line(modulus);
    if let Some((knot, slope)) = curve.steeper_than(modulus) {
        let of = above_modulus(slope, modulus);
        return Err(wrong(format!("the slope up to strain {:e} is {of}", curve.strain()[knot])).into());
    }
    let record = raw.record.clone().unwrap_or_else(|| format!("test {}", place + 1));
    Ok(TestCurve { record, modulus, density: None, curve })
}

fn table(rows: &[TableRow], name: &str, unit: f64, keys: Keys<'_>) -> Result<Vec<(f64, f64)>> {
    let row = |(row, TableRow(strain, stress)): (usize, &TableRow)| {
        let e = keys.number_in_row(strain, (name, row, "strain"), Dimension::None, Allowed::NotNegative)?;
        let s = keys.number_in_row(stress, (name, row, "stress"), Dimension::Stress, Allowed::NotNegative)?;
        Ok((e, if matches!(stress.get_ref(), Quantity::Number(_)) { s * unit } else { s }))
    };
    rows.iter().enumerate().map(row).collect()
}

//! Results of a tension-impact test.

use std::path::Path;

use serde::Serialize;

use super::plan::{METRICS, Test};
use crate::destination::write_whole;
use crate::error::{Error, Result};
use crate::record::Field;
use crate::record::store::{ResultFile, SweepColumn, SweepFile, Values, write_sweep};
use crate::study::sweep::{Row, case_file, rows};

/// Result of one impact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Impact velocity.
    pub velocity_m_s: f64,
    /// Status as in the table of a sweep: `rupture`, `done` (no fracture occurred), `stopped`, `refused`.
    pub status: &'static str,
    /// Reason why the case was stopped or refused; empty otherwise.
    pub reason: String,
    /// Plastic elongation of all fragments, relative to the gauge length; `None` if no fracture occurred.
    pub elongation: Option<f64>,
    /// Energy absorbed by plastic flow and fracture, J; `None` if no fracture occurred.
    #[serde(rename = "energy_absorbed_J")]
    pub energy: Option<f64>,
    /// Position of the first fracture, measured from the struck end.
    pub fracture_position_m: Option<f64>,
    /// Time of the first fracture.
    pub fracture_time_s: Option<f64>,
    /// Whether the first fracture is at the struck end.
    pub at_struck_end: bool,
    /// Whether the first fracture is at the struck end and occurs before a wave has returned from the far end. The bar then cannot sustain the
    /// velocity.
    pub at_once: bool,
    /// Plastic strain along the specimen at the end of the run, at [`Results::x`].
    #[serde(skip)]
    pub residual_strain: Vec<f64>,
}

/// Results of all impacts of a test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Results {
    /// Name of the material.
    pub material: String,
    /// Gauge length.
    pub length_m: f64,
    /// Curve used for the next two values: `static`, or `adiabatic` for a material with heating.
    pub curve: &'static str,
    /// Critical velocity of the curve.
    pub critical_velocity_m_s: f64,
    /// Plastic strain at the maximum of the curve.
    pub static_elongation: f64,
    /// Largest elongation, relative to the gauge length.
    pub largest_elongation: Option<f64>,
    /// Impact velocity of the largest elongation.
    pub velocity_of_largest_elongation_m_s: Option<f64>,
    /// Interval that contains the critical velocity. At the second velocity and at all higher ones the bar fractures immediately at the struck end;
    /// at the first velocity it does not. `None` if there are no two such velocities.
    pub critical_between_m_s: Option<[f64; 2]>,
    /// Results of the impacts, ordered by velocity.
    pub points: Vec<Point>,
    /// Positions of the residual strains, m from the struck end.
    #[serde(skip)]
    pub x: Vec<f64>,
}

/// Collects the results of the cases in the folder of a test. Cases without a row are omitted.
///
/// # Errors
/// A file cannot be read.
pub fn results(test: &Test, folder: &Path) -> Result<Results> {
    let (mut points, mut x) = (Vec::new(), Vec::new());
    for row in rows(folder)? {
        let (place, strain) = profile(folder, &row)?;
        if !place.is_empty() {
            x = place;
        }
        points.push(point(test, row, strain));
    }
    let broken = points.iter().filter_map(|point| Some((point.elongation?, point.velocity_m_s)));
    let largest = broken.max_by(|a, b| a.0.total_cmp(&b.0));
    let begins = points.windows(2).rfind(|pair| !pair[0].at_once);
    Ok(Results {
        material: test.material.clone(),
        length_m: test.length,
        curve: test.curve,
        critical_velocity_m_s: test.critical_velocity,
        static_elongation: test.static_elongation,
        largest_elongation: largest.map(|(elongation, _)| elongation),
        velocity_of_largest_elongation_m_s: largest.map(|(_, velocity)| velocity),
        critical_between_m_s: begins
            .filter(|pair| pair[1].at_once)
            .map(|pair| [pair[0].velocity_m_s, pair[1].velocity_m_s]),
        points,
        x,
    })
}

fn point(test: &Test, row: Row, residual_strain: Vec<f64>) -> Point {
    let number = |k: usize| row.metrics.get(METRICS[k]).and_then(serde_json::Value::as_f64);
    let [elongation, energy, position, time] = [0, 1, 2, 3].map(number);
    let at_struck_end = row.metrics.get(METRICS[4]).is_some_and(|site| site == "left end");
    Point {
        velocity_m_s: test.velocities[row.case],
        status: row.status.name(),
        elongation: time.and(elongation).map(|elongation| elongation / test.length),
        energy: time.and(energy),
        fracture_position_m: position,
        fracture_time_s: time,
        at_struck_end,
        at_once: at_struck_end && time.is_some_and(|time| time < 2.0 * test.transit),
        reason: row.reason,
        residual_strain,
    }
}

/// Returns the positions and plastic strains of a case at the end of its run; both are empty if the case has no result file or no frames.
fn profile(folder: &Path, row: &Row) -> Result<(Vec<f64>, Vec<f64>)> {
    let path = case_file(folder, row.case);
    if !path.exists() {
        return Ok((Vec::new(), Vec::new()));
    }
    let file = ResultFile::open(&path)?;
    let frames = file.time()?.len();
    if frames == 0 {
        return Ok((Vec::new(), Vec::new()));
    }
    Ok((file.x()?, file.field(Field::PlasticStrain, frames - 1..frames)?.row(0).to_vec()))
}

/// Name, unit and accessor of a numerical value of a [`Point`].
type Number = (&'static str, &'static str, fn(&Point) -> Option<f64>);
const NUMBERS: [Number; 6] = [
    ("elongation", "1", |p| p.elongation),
    ("energy_absorbed_J", "J", |p| p.energy),
    ("fracture_position_m", "m", |p| p.fracture_position_m),
    ("fracture_time_s", "s", |p| p.fracture_time_s),
    ("at_struck_end", "1", |p| Some(f64::from(p.at_struck_end))),
    ("at_once", "1", |p| Some(f64::from(p.at_once))),
];

/// Writes a CSV file with one row per velocity. Missing values are empty.
///
/// # Errors
/// A file error.
pub fn write_csv(path: &Path, results: &Results) -> Result<()> {
    let failed = |e: csv::Error| Error::file(path, e);
    let mut csv = csv::Writer::from_writer(Vec::new());
    let names = NUMBERS.iter().map(|number| number.0);
    csv.write_record(["velocity_m_s", "status", "reason"].into_iter().chain(names)).map_err(failed)?;
    for point in &results.points {
        let numbers = NUMBERS.iter().map(|number| (number.2)(point).map_or_else(String::new, |v| format!("{v:?}")));
        let first = [format!("{:?}", point.velocity_m_s), point.status.to_owned(), point.reason.clone()];
        csv.write_record(first.into_iter().chain(numbers)).map_err(failed)?;
    }
    write_whole(path, &csv.into_inner().map_err(|e| Error::file(path, e.into_error()))?)
}

/// Writes an HDF5 file with the velocity as coordinate, and the residual strain as a function of velocity and position.
///
/// # Errors
/// A file error.
pub fn write_hdf5(path: &Path, results: &Results) -> Result<()> {
    let points = &results.points;
    let column =
        |name: &str, units: &str, values| SweepColumn { name: name.to_owned(), units: units.to_owned(), values };
    let mut columns = vec![column("status", "", Values::Texts(points.iter().map(|p| p.status.to_owned()).collect()))];
    columns.extend(NUMBERS.iter().map(|(name, units, value)| {
        let name = name.trim_end_matches("_J").trim_end_matches("_m").trim_end_matches("_s");
        column(name, units, Values::Numbers(points.iter().map(|p| value(p).unwrap_or(f64::NAN)).collect()))
    }));
    let mut scales = vec![column("velocity", "m/s", Values::Numbers(points.iter().map(|p| p.velocity_m_s).collect()))];
    if !results.x.is_empty() {
        scales.push(column("x", "m", Values::Numbers(results.x.clone())));
        let missing = vec![f64::NAN; results.x.len()];
        let row = |p: &Point| if p.residual_strain.is_empty() { missing.clone() } else { p.residual_strain.clone() };
        columns.push(column("residual_strain", "1", Values::Numbers(points.iter().flat_map(row).collect())));
    }
    let title = format!("Tension impact of {}", results.material);
    let metadata = serde_json::to_string(results).map_err(|e| Error::file(path, e))?;
    write_sweep(path, &SweepFile { title, plan: metadata, scales, columns })
}

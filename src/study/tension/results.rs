//! Results of a tension-impact test.

use std::path::Path;

use serde::Serialize;

use super::plan::{METRICS, Test};
use crate::destination::write_whole;
use crate::error::{Error, Result};
use crate::record::Field;
use crate::record::store::{ResultFile, Side, SweepColumn, SweepFile, Values, write_sweep};
use crate::study::sweep::{Row, Status, case_file, rows};

/// Result of one impact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Impact velocity.
    pub velocity_m_s: f64,
    /// Status as in the table of a sweep: `rupture`, `done` (no fracture occurred), `stopped`, `refused`. A stopped run has the fracture that it had
    /// reached.
    pub status: &'static str,
    /// Reason why the case was stopped or refused; empty otherwise.
    pub reason: String,
    /// Plastic elongation of all fragments, relative to the gauge length; `None` if no fracture occurred or the run stopped.
    pub elongation: Option<f64>,
    /// Energy absorbed by plastic flow and fracture, J; `None` if no fracture occurred or the run stopped.
    #[serde(rename = "energy_absorbed_J")]
    pub energy: Option<f64>,
    /// Position of the first fracture, measured from the struck end.
    pub fracture_position_m: Option<f64>,
    /// Time of the first fracture.
    pub fracture_time_s: Option<f64>,
    /// Whether the first fracture is at the struck end; `None` if the run stopped before a fracture.
    pub at_struck_end: Option<bool>,
    /// Whether the first fracture is at the struck end and occurs before a wave has returned from the far end. The bar then cannot sustain the
    /// velocity. `None` if the run stopped before either was known.
    pub at_once: Option<bool>,
    /// Plastic strain along the specimen at the end of the run, at [`Results::x`]; empty if the run stopped.
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
    /// Critical velocity of the curve, or of its part up to the strain at which the fracture criterion is met, if that is smaller.
    pub critical_velocity_m_s: f64,
    /// Plastic strain at the end of this part of the curve: its maximum, or where the fracture criterion is met.
    pub static_elongation: f64,
    /// Largest elongation, relative to the gauge length.
    pub largest_elongation: Option<f64>,
    /// Impact velocity of the largest elongation.
    pub velocity_of_largest_elongation_m_s: Option<f64>,
    /// Interval that contains the critical velocity. At the second velocity and at all higher ones the bar fractures immediately at the struck end;
    /// at the first velocity it does not. Velocities whose runs stopped before this was known do not count. `None` if there are no two such
    /// velocities.
    pub critical_between_m_s: Option<[f64; 2]>,
    /// Results of the impacts, ordered by velocity.
    pub points: Vec<Point>,
    /// Positions of the residual strains, m from the struck end.
    #[serde(skip)]
    pub x: Vec<f64>,
}

impl Results {
    /// Checks that a run has reached its end.
    ///
    /// # Errors
    /// [`Error::Checks`] with the reason of the first run if none has.
    pub fn check(&self) -> Result<()> {
        match self.points.first().filter(|_| self.points.iter().all(|point| !point.reason.is_empty())) {
            Some(first) => Err(Error::Checks(format!("no run has reached its end; the first one: {}", first.reason))),
            None => Ok(()),
        }
    }
}

/// Collects the results of the cases in the folder of a test. Cases without a row are omitted.
///
/// # Errors
/// A file cannot be read.
pub fn results(test: &Test, folder: &Path) -> Result<Results> {
    let (mut points, mut x) = (Vec::new(), Vec::new());
    for row in rows(folder)? {
        let (path, status) = (case_file(folder, row.case), row.status);
        let mut point = point(test, row);
        if path.exists() {
            let file = ResultFile::open(&path)?;
            if status == Status::Stopped {
                point.add_observed(test, &file)?;
            } else if let Some(places) = point.add_profile(&file)? {
                x = places;
            }
        }
        points.push(point);
    }
    let broken = points.iter().filter_map(|point| Some((point.elongation?, point.velocity_m_s)));
    let largest = broken.max_by(|a, b| a.0.total_cmp(&b.0));
    let decided: Vec<(f64, bool)> = points.iter().filter_map(|p| Some((p.velocity_m_s, p.at_once?))).collect();
    let begins = decided.windows(2).rfind(|pair| !pair[0].1);
    Ok(Results {
        material: test.material.clone(),
        length_m: test.length,
        curve: test.curve,
        critical_velocity_m_s: test.critical_velocity,
        static_elongation: test.static_elongation,
        largest_elongation: largest.map(|(elongation, _)| elongation),
        velocity_of_largest_elongation_m_s: largest.map(|(_, velocity)| velocity),
        critical_between_m_s: begins.filter(|pair| pair[1].1).map(|pair| [pair[0].0, pair[1].0]),
        points,
        x,
    })
}

fn point(test: &Test, row: Row) -> Point {
    let number = |k: usize| row.metrics.get(METRICS[k]).and_then(serde_json::Value::as_f64);
    let [elongation, energy, position, time] = [0, 1, 2, 3].map(number);
    let site = row.metrics.get(METRICS[4]).and_then(serde_json::Value::as_str);
    let ended = [Status::Done, Status::Rupture].contains(&row.status);
    let at_struck_end = site == Some(STRUCK_END);
    Point {
        velocity_m_s: test.velocities[row.case],
        status: row.status.name(),
        elongation: time.and(elongation).map(|elongation| elongation / test.length),
        energy: time.and(energy),
        fracture_position_m: position,
        fracture_time_s: time,
        at_struck_end: ended.then_some(at_struck_end),
        at_once: ended.then_some(at_struck_end && time.is_some_and(|time| time < test.return_time())),
        reason: row.reason,
        residual_strain: Vec::new(),
    }
}

/// Site of a fracture at the struck end in result files.
const STRUCK_END: &str = "left end";

impl Point {
    /// Adds what a run that stopped had reached: its first fracture, and whether the time in which the bar would fracture at once had passed.
    fn add_observed(&mut self, test: &Test, file: &ResultFile) -> Result<()> {
        let ruptures = file.ruptures()?;
        if let Some(first) = ruptures.iter().min_by(|a, b| a.time.total_cmp(&b.time)) {
            let at_struck_end = first.site == STRUCK_END;
            (self.fracture_position_m, self.fracture_time_s) = (Some(first.x), Some(first.time));
            self.at_struck_end = Some(at_struck_end);
            self.at_once = Some(at_struck_end && first.time < test.return_time());
        } else if file.end(Side::Left)?.time.last().is_some_and(|&time| time >= test.return_time()) {
            self.at_once = Some(false);
        }
        Ok(())
    }

    /// Adds the plastic strain along the specimen at the end of the run, and returns its positions; `None` if the file has no frames.
    fn add_profile(&mut self, file: &ResultFile) -> Result<Option<Vec<f64>>> {
        let frames = file.time()?.len();
        if frames == 0 {
            return Ok(None);
        }
        self.residual_strain = file.field(Field::PlasticStrain, frames - 1..frames)?.row(0).to_vec();
        file.x().map(Some)
    }
}

/// Name, unit and accessor of a numerical value of a [`Point`].
type Number = (&'static str, &'static str, fn(&Point) -> Option<f64>);
const NUMBERS: [Number; 6] = [
    ("elongation", "1", |p| p.elongation),
    ("energy_absorbed_J", "J", |p| p.energy),
    ("fracture_position_m", "m", |p| p.fracture_position_m),
    ("fracture_time_s", "s", |p| p.fracture_time_s),
    ("at_struck_end", "1", |p| p.at_struck_end.map(f64::from)),
    ("at_once", "1", |p| p.at_once.map(f64::from)),
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

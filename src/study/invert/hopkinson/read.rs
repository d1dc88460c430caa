//! Records of a split-Hopkinson test, from a CSV file or a result file.

use std::path::Path;

use rand::SeedableRng;
use rand_xorshift::XorShiftRng;

use super::test_set::{ElasticBar, Records, Setup};
use crate::error::{InputError, Result};
use crate::material::{Beyond, Curve};
use crate::record::store::{Gauge, ResultFile};
use crate::study::invert::given::turns_back;
use crate::study::invert::noise::digitized;
use crate::study::invert::setup::{self, Segment};
use crate::study::invert::table::Table;
use crate::units::Dimension;

/// A test from a result file.
#[derive(Debug, Clone)]
pub struct Test {
    /// Bars and specimen.
    pub setup: Setup,
    /// Gauge records.
    pub records: Records,
    /// Name of the specimen's material.
    pub material: String,
    /// Density of the specimen, kg/m^3.
    pub density: f64,
    /// Elastic modulus of the specimen, Pa.
    pub modulus: f64,
    /// Curve of the specimen in the simulation.
    pub given: Option<Curve>,
    /// Whether the run has a rate law; `given` is then the quasi-static curve.
    pub rate: bool,
    /// Time from the passage of the transmitted pulse at its gauge to its return from the far end, s.
    pub limit: f64,
}

/// Reads the columns time, incident strain and transmitted strain, in this order.
///
/// # Errors
/// An invalid file, a number of columns other than three, times that decrease or are not in seconds.
pub fn records_from_csv(path: &Path) -> Result<Records> {
    let of = |column: usize, _: &str| if column == 0 { Dimension::Time } else { Dimension::None };
    let table = Table::read(path, of)?;
    let [time, incident, transmitted] = table.columns.as_slice() else {
        let message = format!("{} has {} columns", path.display(), table.columns.len());
        let help = "give the time, the strain of the incident bar and the strain of the transmission bar";
        return Err(InputError::new(message).allowed("3 columns").help(help).into());
    };
    if let Some(row) = turns_back(time, false) {
        return Err(table.error(row, "the time is smaller than in the row before").help("sort the rows").into());
    }
    short(&table, time)?;
    for (column, strain) in [incident, transmitted].into_iter().enumerate() {
        elastic(&table, column + 1, strain)?;
    }
    Ok(Records { incident: (time.clone(), incident.clone()), transmitted: (time.clone(), transmitted.clone()) })
}

/// Longest record whose times have no unit, s. The times of a longer record are probably in microseconds or milliseconds: in this time, waves
/// propagate through 500 m of steel.
const LONGEST_WITHOUT_UNIT: f64 = 0.1;

/// Refuses times without a unit that are probably not in seconds.
fn short(table: &Table, time: &[f64]) -> Result<()> {
    let lasts = time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first);
    if lasts <= LONGEST_WITHOUT_UNIT || table.has_unit(0) {
        return Ok(());
    }
    let name = &table.names[0];
    let message = format!("a record of {lasts} s{}", table.unit_note(0));
    Err(table
        .error_in(time.len() - 1, name, message)
        .allowed(format!("<= {LONGEST_WITHOUT_UNIT} s if no unit is given"))
        .help(format!("name the unit in the first line: {name}_us for microseconds, {name}_s for seconds"))
        .into())
}

/// Largest strain of an elastic bar. Larger values are probably in microstrain or percent.
const MOST_ELASTIC: f64 = 0.02;

/// Refuses strains that are too large for an elastic bar.
fn elastic(table: &Table, column: usize, strain: &[f64]) -> Result<()> {
    let largest = (0..strain.len()).max_by(|&a, &b| strain[a].abs().total_cmp(&strain[b].abs()));
    let Some(row) = largest.filter(|&row| strain[row].abs() > MOST_ELASTIC) else { return Ok(()) };
    let name = &table.names[column];
    let message = format!("a strain of {} on an elastic bar{}", strain[row], table.unit_note(column));
    Err(table
        .error_in(row, name, message)
        .allowed(format!("|strain| <= {MOST_ELASTIC}"))
        .help(format!("name the unit in the first line: {name}_ue for microstrain, {name}_% for percent"))
        .into())
}

impl Records {
    /// Samples the records like a digitizer and adds noise, whose standard deviation is the fraction `part` of each record's largest strain.
    #[must_use]
    pub fn with_noise(mut self, part: f64, seed: u64) -> Self {
        let mut rng = XorShiftRng::seed_from_u64(seed);
        for record in [&mut self.incident, &mut self.transmitted] {
            *record = digitized(&record.0, &record.1, part, &mut rng);
        }
        self
    }
}

impl Test {
    /// Reads a test from the result of a scene with striker, incident bar, specimen and transmission bar. The specimen is the shortest inner segment;
    /// the two adjacent bars must have a gauge each. `gauges` selects them by name if there are several.
    ///
    /// # Errors
    /// Another arrangement, missing areas of the sections, missing gauges.
    pub fn from_result(file: &ResultFile, gauges: &[String]) -> Result<Self> {
        let segments = setup::segments(file)?;
        let wrong = |message: String, help: &str| {
            InputError::new(format!("{}: {message}", file.path().display())).help(help.to_owned())
        };
        let inner = 1..segments.len().saturating_sub(1);
        let shortest = inner.min_by(|&a, &b| segments[a].length.total_cmp(&segments[b].length)).ok_or_else(|| {
            wrong("the bar has no segment between two others".into(), "see runs/split-hopkinson.toml for such a scene")
        })?;
        let [before, specimen, after] = [shortest - 1, shortest, shortest + 1].map(|k| &segments[k]);
        let area = |segment: &Segment| {
            segment.area.ok_or_else(|| wrong("the segments have no area".into(), "give each segment a diameter"))
        };
        let all = file.gauges()?;
        let on = |segment: &Segment, what: &str| {
            let here = |gauge: &&Gauge| {
                (segment.start..=segment.end()).contains(&gauge.x)
                    && (gauges.is_empty() || gauges.contains(&gauge.name))
            };
            let help = "record a gauge on each bar, and name them where there are several";
            let error = || wrong(format!("there is no gauge on the {what} bar"), help).key("gauges");
            all.iter().find(here).cloned().ok_or_else(error)
        };
        let (first, second) = (on(before, "incident")?, on(after, "transmission")?);
        let bar = |segment: &Segment, distance: f64| -> Result<ElasticBar> {
            Ok(ElasticBar { modulus: segment.modulus, density: segment.density, area: area(segment)?, distance })
        };
        let setup = Setup {
            incident: bar(before, before.end() - first.x)?,
            transmitted: bar(after, second.x - after.start)?,
            length: specimen.length,
            area: area(specimen)?,
        };
        let limit = 2.0 * (after.end() - second.x) / after.c0();
        let gauge = |gauge: Gauge| (gauge.trace.time, gauge.trace.strain);
        Ok(Self {
            setup,
            records: Records { incident: gauge(first), transmitted: gauge(second) },
            material: specimen.name.clone(),
            density: specimen.density,
            modulus: specimen.modulus,
            given: Curve::new(&specimen.curve(true), Beyond::Error).ok(),
            rate: setup::has_effect(file.metadata(), "rate"),
            limit,
        })
    }
}

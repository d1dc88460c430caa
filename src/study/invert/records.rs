//! Strain records at gauges along a bar, from a CSV file or a result file.

use std::path::Path;

use rand::SeedableRng;
use rand_xorshift::XorShiftRng;

use super::given::{check_record, turns_back};
use super::noise::digitized;
use super::setup::{self, Segment};
use super::table::Table;
use crate::error::{InputError, Result};
use crate::input::{Allowed, Checked, member};
use crate::material::{Beyond, Curve, Sense};
use crate::record::store::{Gauge, ResultFile};
use crate::units::Dimension;

/// Record of one gauge.
#[derive(Debug, Clone)]
pub struct Record {
    /// Name in the file.
    pub name: String,
    /// Distance from the loaded end of the bar, m.
    pub distance: f64,
    /// Times, s, not decreasing.
    pub time: Vec<f64>,
    /// Strains, positive in the sense of the loading.
    pub strain: Vec<f64>,
}

/// Records of a test, with the data of the bar that their file contains.
#[derive(Debug, Clone)]
pub struct Recording {
    /// Records, ordered by distance.
    pub records: Vec<Record>,
    /// Sense of the loading.
    pub sense: Sense,
    /// Density, kg/m^3.
    pub density: Option<f64>,
    /// Elastic modulus, Pa.
    pub modulus: Option<f64>,
    /// Distance from the loaded end to the origin of the first reflection, m.
    pub length: Option<f64>,
    /// Curve that a simulation used, for comparison.
    pub given: Option<Curve>,
    /// Whether the records are from a simulation, whose gauges have no zero offset.
    pub simulated: bool,
    /// Properties of the run that simple-wave theory does not describe, one sentence each.
    pub notes: Vec<String>,
}

impl Recording {
    /// Reads records from a CSV file: times in the first column, and the strain of one gauge in each other column. `distances` are those of the
    /// gauges (m).
    ///
    /// # Errors
    /// An invalid file; different numbers of distances and gauges; times that decrease.
    pub fn from_csv(path: &Path, distances: &[f64]) -> Result<Self> {
        let dimension = |column: usize, _: &str| if column == 0 { Dimension::Time } else { Dimension::None };
        let table = Table::read(path, dimension)?;
        let gauges = table.names.len() - 1;
        if gauges != distances.len() {
            let message =
                format!("{} has {gauges} gauges, and {} positions are given", path.display(), distances.len());
            let help = "give the distance of each gauge from the loaded end, in the order of the columns";
            return Err(InputError::new(message).key("distances").help(help).into());
        }
        let time = &table.columns[0];
        if let Some(row) = turns_back(time, false) {
            return Err(table.error(row, "the time is smaller than in the row before").help("sort the rows").into());
        }
        for column in 1..=gauges {
            table.plausible_strains(column)?;
        }
        let record = |(k, &distance): (usize, &f64)| Record {
            name: table.names[k + 1].clone(),
            distance,
            time: time.clone(),
            strain: table.columns[k + 1].clone(),
        };
        let records = distances.iter().enumerate().map(record).collect();
        Ok(Self {
            records,
            sense: Sense::Tension,
            density: None,
            modulus: None,
            length: None,
            given: None,
            simulated: false,
            notes: Vec::new(),
        }
        .in_the_sense_of_loading())
    }

    /// Reads the gauges of a result file, or only those in `names` if that is not empty.
    ///
    /// # Errors
    /// No gauges, an unknown name, gauges in several segments.
    pub fn from_result(file: &ResultFile, names: &[String]) -> Result<Self> {
        let gauges = chosen(file, names)?;
        let segments = setup::segments(file)?;
        let segment = common_segment(file, &segments, &gauges)?;
        let from_left = arrives_from_left(&gauges);
        let distance = |x: f64| if from_left { x - segment.start } else { segment.end() - x };
        let record = |gauge: &Gauge| Record {
            name: gauge.name.clone(),
            distance: distance(gauge.x),
            time: gauge.trace.time.clone(),
            strain: gauge.trace.strain.clone(),
        };
        let recording = Self {
            records: gauges.iter().map(record).collect(),
            sense: Sense::Tension,
            density: Some(segment.density),
            modulus: Some(segment.modulus),
            length: Some(segment.length),
            given: None,
            simulated: true,
            notes: setup::outside_theory(file.metadata()),
        };
        let recording = recording.in_the_sense_of_loading();
        let knots = segment.curve(recording.sense == Sense::Compression);
        Ok(Self { given: Curve::new(&knots, Beyond::Error).ok(), ..recording })
    }

    /// Samples the records like a digitizer and adds noise, whose standard deviation is the fraction `part` of each record's largest strain.
    #[must_use]
    pub fn with_noise(mut self, part: f64, seed: u64) -> Self {
        let mut rng = XorShiftRng::seed_from_u64(seed);
        for record in &mut self.records {
            (record.time, record.strain) = digitized(&record.time, &record.strain, part, &mut rng);
        }
        self
    }

    pub(super) fn check(&self) -> Checked {
        for (k, record) in self.records.iter().enumerate() {
            let name = format!("records.{k}");
            member(&format!("{name}.distance"), record.distance, Dimension::Length, Allowed::NotNegative)?;
            check_record(&name, &record.time, &record.strain)?;
        }
        Ok(())
    }

    fn in_the_sense_of_loading(mut self) -> Self {
        let extreme = |sign: f64| self.records.iter().flat_map(|r| &r.strain).fold(0.0_f64, |top, e| top.max(sign * e));
        if extreme(-1.0) > extreme(1.0) {
            self.sense = Sense::Compression;
            self.records.iter_mut().flat_map(|r| &mut r.strain).for_each(|e| *e = -*e);
        }
        self.records.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        self
    }
}

fn chosen(file: &ResultFile, names: &[String]) -> Result<Vec<Gauge>> {
    let all = file.gauges()?;
    let known: Vec<&str> = all.iter().map(|gauge| gauge.name.as_str()).collect();
    if let Some(unknown) = names.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(InputError::new(format!("{} has no gauge `{unknown}`", file.path().display()))
            .key("gauges")
            .allowed(known.join(", "))
            .help("name gauges of the scene")
            .into());
    }
    if all.is_empty() {
        return Err(InputError::new(format!("{} has no gauges", file.path().display()))
            .help("add gauges = { near = \"20 mm\", far = \"80 mm\" } under [record], and run the scene again")
            .into());
    }
    Ok(all.into_iter().filter(|gauge| names.is_empty() || names.contains(&gauge.name)).collect())
}

fn common_segment<'a>(file: &ResultFile, segments: &'a [Segment], gauges: &[Gauge]) -> Result<&'a Segment> {
    let holds = |segment: &&Segment| gauges.iter().all(|gauge| (segment.start..=segment.end()).contains(&gauge.x));
    segments.iter().find(holds).ok_or_else(|| {
        InputError::new(format!("the gauges of {} lie in several segments", file.path().display()))
            .key("gauges")
            .help("name gauges of one segment")
            .into()
    })
}

/// Returns whether half of the largest strain arrives at the left gauge before it arrives at the right one.
fn arrives_from_left(gauges: &[Gauge]) -> bool {
    let largest = |gauge: &Gauge| gauge.trace.strain.iter().fold(0.0_f64, |top, e| top.max(e.abs()));
    let level = 0.5 * gauges.iter().map(largest).fold(f64::INFINITY, f64::min);
    let arrival = |gauge: &Gauge| {
        let reached = gauge.trace.strain.iter().position(|e| e.abs() >= level);
        reached.map_or(f64::INFINITY, |row| gauge.trace.time[row])
    };
    let by_x = |a: &&Gauge, b: &&Gauge| a.x.total_cmp(&b.x);
    let (left, right) = (gauges.iter().min_by(by_x), gauges.iter().max_by(by_x));
    left.map(arrival) <= right.map(arrival)
}

//! Output: frame times, fields, gauges, and limits of their size.

use super::super::raw::{Gauges, MOST_FRAMES, RawRecord};
use super::super::{Effects, Method, Record, Solve};
use super::{Checker, GIB, first_given};
use crate::bar::Bar;
use crate::error::Result;
use crate::record::{Field, Precision};
use crate::typed::{Key, NotNegative, Of, Placed, Positive};
use crate::units::measures::Time;
use crate::units::{Dimension, System, format};

/// Default number of samples over x for a method without cells.
const SAMPLES: usize = 1000;
/// Largest size of a result file before compression, GiB; a larger one is assumed to be a mistake.
const MOST_GIB: f64 = 64.0;
/// Largest number of gauges: each is a group of the file, and a column of its table of fronts.
const MOST_GAUGES: usize = 1000;
/// Bytes per row of a gauge: time, stress, strain, velocity and temperature.
const GAUGE_BYTES: f64 = 40.0;
/// Number of rows for which the file allocates space at once.
const LEAST_ROWS: f64 = 1024.0;

impl Checker<'_> {
    pub(super) fn record(
        &self,
        raw: &RawRecord,
        bar: &Bar,
        (effects, auto): (&Effects, bool),
        solve: &Solve,
    ) -> Result<Record> {
        let cells = self.count_of_cells(&raw.cells)?;
        let tracked = solve.method.tracks_fronts();
        let record = Record {
            times: self.times(raw, solve.until)?,
            // The recorded samples must not depend on the method that a tolerance selects.
            cells: cells.or((tracked || solve.tolerance.is_some()).then_some(SAMPLES)),
            paths: self.paths(raw, &solve.method)?,
            fields: self.fields(raw, effects, auto)?,
            gauges: self.gauges(&raw.gauges, bar.length(), "bar")?,
            precision: raw.precision.unwrap_or_default(),
            compression: raw.compression.unwrap_or_default(),
        };
        self.gauges_fit(&record, solve, bar)?;
        self.fits(raw, &record, solve)?;
        Ok(record)
    }

    /// Returns whether the straight segments of fronts are recorded.
    fn paths(&self, raw: &RawRecord, method: &Method) -> Result<bool> {
        let tracked = method.tracks_fronts();
        match &raw.paths {
            Some(paths) if !tracked => {
                let (what, other) = match method {
                    Method::CharacteristicNet { .. } => ("a rate-dependent bar", "remove `rate` from [effects]"),
                    _ => ("method = \"fd\"", "use method = \"moc\" in [solve]"),
                };
                let message = format!("`paths` does not apply to {what}, in which no fronts are tracked");
                let help = format!("remove `paths`, or {other}");
                Err(self.error(paths.span(), "record.paths", message).help(help).into())
            }
            Some(paths) => Ok(*paths.get_ref()),
            None => Ok(tracked),
        }
    }

    /// Returns the frame times, from at most one of the three forms.
    fn times(&self, raw: &RawRecord, until: f64) -> Result<Vec<f64>> {
        let forms = [
            ("frames", raw.frames.place()),
            ("every", raw.every.place()),
            ("times", raw.times.as_ref().map(Placed::span)),
        ];
        self.at_most_one("record", forms)?;
        if let Some(every) = &raw.every {
            return self.times_every(every, until);
        }
        if let Some(times) = &raw.times {
            return self.times_listed(times, until);
        }
        let gib = |asked| {
            let each = 8.0 * SAMPLES as f64;
            format!(": of {SAMPLES} samples and one field they are {:.0} GiB", asked * each / GIB)
        };
        Ok(even_times(self.count(&raw.frames, MOST_FRAMES, gib)?, until))
    }

    fn times_every(&self, every: &Of<Time, Positive>, until: f64) -> Result<Vec<f64>> {
        let key = "record.every";
        let step = self.si(every)?;
        let whole = (until / step * (1.0 + 1e-12)).floor();
        if whole > MOST_FRAMES as f64 {
            let message = format!("{every} gives {whole:.3e} frames");
            let allowed = format!("at most {MOST_FRAMES} frames");
            return Err(self.error(every.span(), key, message).allowed(allowed).help("use a longer interval").into());
        }
        let mut times: Vec<f64> = (0..=whole as usize).map(|i| (i as f64 * step).min(until)).collect();
        // If the interval divides the run except for rounding, its last multiple is the end; otherwise the last interval is shorter.
        match times.last_mut() {
            Some(last) if until - *last <= 1e-9 * step => *last = until,
            _ => times.push(until),
        }
        Ok(times)
    }

    fn times_listed(&self, list: &Placed<Vec<Of<Time, NotNegative>>>, until: f64) -> Result<Vec<f64>> {
        let mut times: Vec<f64> = Vec::with_capacity(list.get_ref().len());
        for (i, value) in list.get_ref().iter().enumerate() {
            let key = format!("record.times.{i}");
            let time = self.si(value)?;
            if time > until {
                let message = format!("{value} is after the end of the run");
                let allowed = format!("0 <= time <= {}", format(until, Dimension::Time, System::Si));
                let help = "remove it, or increase solve.until";
                return Err(self.error(value.span(), &key, message).allowed(allowed).help(help).into());
            }
            if times.last().is_some_and(|&before| time <= before) {
                let error = self.error(value.span(), &key, format!("{value} is not after the time before it"));
                return Err(error.allowed("increasing times").help("list the times in order, each once").into());
            }
            times.push(time);
        }
        if times.is_empty() {
            let error = self.error(list.span(), "record.times", "the list of times is empty");
            return Err(error.allowed("at least one time").help("use frames = 1 for the end alone").into());
        }
        Ok(times)
    }

    /// Reads the fields. With `auto`, fields of effects that are not yet enabled are allowed, because `effects = "auto"` enables these effects.
    fn fields(&self, raw: &RawRecord, effects: &Effects, auto: bool) -> Result<Vec<Field>> {
        let Some(list) = &raw.fields else { return Ok(vec![Field::Stress, Field::Strain, Field::Velocity]) };
        let mut fields = Vec::with_capacity(list.len());
        for (i, word) in list.iter().enumerate() {
            let key = format!("record.fields.{i}");
            let Some(field) = Field::ALL.into_iter().find(|f| f.name() == word.get_ref()) else {
                let known = Field::ALL.map(Field::name);
                return Err(self.document.word_error(word.span(), &key, word.get_ref(), &known).into());
            };
            if fields.contains(&field) {
                let error = self.error(word.span(), &key, format!("`{}` is given twice", field.name()));
                return Err(error.help("name each field once").into());
            }
            if let Some(effect) = field.needs().filter(|effect| !auto && effects.named(effect).is_none()) {
                let (without, add) = match effect {
                    "heat" => ("adiabatic heating", "heat = { fraction = 0.9 }"),
                    _ => ("a hardening rule", "hardening = \"isotropic\""),
                };
                let message = format!("`{}` is not available without {without}", field.name());
                let help = format!("add [effects] with {add}, or remove the field");
                return Err(self.error(word.span(), &key, message).help(help).into());
            }
            if field != field.base() && !self.torsion {
                let message = format!("`{}` is available in torsion only", field.name());
                let help = "remove the field, or set mode = \"torsion\" in [bar]";
                return Err(self.error(word.span(), &key, message).help(help).into());
            }
            fields.push(field);
        }
        Ok(fields)
    }

    /// Returns the gauges in the order of the file. The map does not preserve the order, but the positions of the values do.
    pub(in crate::scene) fn gauges(&self, raw: &Gauges, length: f64, body: &str) -> Result<Vec<(String, f64)>> {
        let mut list: Vec<_> = raw.iter().collect();
        list.sort_by_key(|(_, place)| place.span().start);
        let mut gauges = Vec::with_capacity(list.len());
        for (name, place) in list {
            let key = format!("record.gauges.{name}");
            if name.trim().is_empty() || name.contains('/') || name.chars().any(char::is_control) || name == "." {
                let error = self.error(place.span(), &key, format!("`{name}` is not a valid gauge name"));
                return Err(error
                    .allowed("a name that is not empty or `.`, without `/` and control characters")
                    .help("it becomes a group of the result file")
                    .into());
            }
            let x = self.si(place)?;
            if !(0.0..=length).contains(&x) {
                let message = format!("{place} is outside the {body}");
                let allowed = format!("0 <= {name} <= {}", format(length, Dimension::Length, System::Si));
                let help = "positions are measured from the left end";
                return Err(self.error(place.span(), &key, message).allowed(allowed).help(help).into());
            }
            gauges.push((name.clone(), x));
        }
        Ok(gauges)
    }

    /// Refuses histories above the limit of size. The number of rows of front tracking is not known in advance.
    fn gauges_fit(&self, record: &Record, solve: &Solve, bar: &Bar) -> Result<()> {
        let steps = match solve.method {
            Method::Leapfrog { cells, cfl } | Method::Muscl { cells, cfl } => cells as f64 / cfl,
            Method::CharacteristicNet { cells } => cells as f64,
            Method::FrontTracking { .. } => 0.0,
        } * solve.until
            / bar.transit_time();
        let gauges = record.gauges.len();
        let gib = gauges as f64 * steps.max(LEAST_ROWS) * GAUGE_BYTES / GIB;
        if gauges <= MOST_GAUGES && gib <= MOST_GIB {
            return Ok(());
        }
        let (key, span) =
            ("record.gauges", self.document.span_of("record.gauges").unwrap_or_else(|| self.end_of_text()));
        let size = if steps > 0.0 {
            std::format!(" with {steps:.0} rows each, at least {gib:.1} GiB in all")
        } else {
            String::new()
        };
        let error = self.error(span, key, std::format!("there are {gauges} gauges{size}"));
        let help = "use fewer gauges; fields over x record every sample: increase `frames`";
        Err(error.allowed(std::format!("at most {MOST_GAUGES} gauges and {MOST_GIB} GiB")).help(help).into())
    }

    /// Refuses fields above the limit of size.
    fn fits(&self, raw: &RawRecord, record: &Record, solve: &Solve) -> Result<()> {
        let own = match solve.method {
            Method::Leapfrog { cells, .. } | Method::Muscl { cells, .. } | Method::CharacteristicNet { cells } => cells,
            Method::FrontTracking { .. } => SAMPLES,
        };
        let cells = record.cells.unwrap_or(own);
        let width = match record.precision {
            Precision::F64 => 8.0,
            Precision::F32 => 4.0,
        };
        let (frames, fields) = (record.times.len(), record.fields.len());
        let bytes = frames as f64 * cells as f64 * fields as f64 * width;
        if bytes <= MOST_GIB * GIB {
            return Ok(());
        }
        let (key, span) = first_given([
            ("record.frames", raw.frames.place()),
            ("record.every", raw.every.place()),
            ("record.times", raw.times.as_ref().map(Placed::span)),
            ("record.cells", raw.cells.place()),
        ])
        .unwrap_or_else(|| ("record", self.end_of_text()));
        let message = format!("{frames} frames of {cells} cells and {fields} fields are {:.0} GiB", bytes / GIB);
        let help = "record fewer frames, or fewer samples over x: cells = 1000 in [record]";
        Err(self.error(span, key, message).allowed(format!("at most {MOST_GIB} GiB")).help(help).into())
    }
}

/// Returns `frames` evenly spaced times from 0 to `until`, both included; a single frame is at the end.
fn even_times(frames: usize, until: f64) -> Vec<f64> {
    let intervals = frames - 1;
    (0..frames).map(|i| if i == intervals { until } else { until * i as f64 / intervals as f64 }).collect()
}

//! Writing of result files: frames, histories and ledger rows.

use std::path::{Path, PathBuf};

use hdf5::{Dataset, File, Group};
use ndarray::{ArrayView2, s};

use super::attributes::{get_text, put, put_quantity, put_text, text};
use super::checkpoint::{self, Checkpoint, Rows};
use super::chunks::Chunks;
use super::claim::{Claim, GONE, in_place, remove_unnamed};
use super::columns::{append, cut, is_longer};
use super::create::{
    CHUNK_COLUMNS, SAMPLE, TRACE_ROWS, build, end_columns, gauge_columns, gauge_links, ledger_columns,
};
use super::figures;
use super::open_rw;
use super::paths::PathTable;
use super::ruptures;
use super::tables::{self, Column};
use super::{Header, INTERRUPTED, Layout, Message, RUNNING, RunFigures, Side, Trailer};
use crate::destination;
use crate::error::{Error, Result};
use crate::record::{AuditRow, Compression, ErrorTable, Frame, FrontRow, LedgerRow, MaterialRecord, Precision, Trace};
use crate::units::{Dimension, System, format};

type Hdf<T> = hdf5::Result<T>;

/// Size of the waiting frames from which they are written, bytes.
const BLOCK_BYTES: usize = 4 << 20;
/// Open file and the data that have not been written to it yet.
#[derive(Debug)]
pub(super) struct Sink {
    path: PathBuf,
    claim: Claim,
    file: File,
    frames: Frames,
    gauges: Vec<Table>,
    /// Name of the group of each gauge, and name of the gauge.
    gauge_names: Vec<(String, String)>,
    /// True if energies are in J, false if they are per m^2.
    area_given: bool,
    /// See [`super::Geometry`].
    end_factors: Option<[f64; 2]>,
    ends: [Table; 2],
    ledger: Table,
    paths: Option<PathTable>,
    /// Identifier of the run.
    run_id: String,
    /// True if something was written since the last flush.
    unflushed: bool,
}

/// Fields over x and t.
#[derive(Debug)]
struct Frames {
    time: Dataset,
    fields: Vec<Dataset>,
    precision: Precision,
    /// Compressor; `None` if the library filters the datasets.
    chunks: Option<Chunks>,
    columns: usize,
    written: usize,
    /// Time of the last frame written, s.
    last: Option<f64>,
    times: Vec<f64>,
    /// Waiting rows, one block per field.
    blocks: Vec<Vec<f64>>,
}

/// Number and length of the pauses in which a run waits for access to its own new file.
const PATIENCE: usize = 200;
const PAUSE: std::time::Duration = std::time::Duration::from_millis(5);

/// One-dimensional columns of equal length that grow together; the first is the time.
#[derive(Debug)]
struct Table {
    /// Dimension of the columns, which has no values.
    samples: Dataset,
    columns: Vec<Dataset>,
    waiting: Vec<Vec<f64>>,
    written: usize,
}

impl Sink {
    /// Builds the file next to its final place, then moves it there.
    pub fn create(path: &Path, header: &Header, layout: &Layout, materials: &[MaterialRecord]) -> Result<Self> {
        let claim = in_place(path, |file| build(file, header, layout, materials))?;
        Self::claimed(path, &claim, layout, PATIENCE)
    }

    /// Opens the file of a run and truncates it to a checkpoint.
    pub fn resume(path: &Path, layout: &Layout, checkpoint: &Checkpoint) -> Result<Self> {
        let place = destination::resolve(path)?;
        let claim = Claim::new(&place, &place).map_err(|e| Error::file(path, e))?;
        let mut sink = Self::claimed(path, &claim, layout, 0)?;
        sink.reserve(0)?;
        sink.cut(checkpoint).map_err(|e| Error::file(path, format!("the file cannot be resumed: {e}")))?;
        remove_unnamed(&place);
        Ok(sink)
    }

    /// Opens the file. `patience` is the number of pauses in which it waits for a process that has opened this file
    /// instead of its own and is about to notice it.
    fn claimed(path: &Path, claim: &Claim, layout: &Layout, patience: usize) -> Result<Self> {
        let open = || Self::open(path, claim.share()?, layout);
        let mut opened = open();
        for _ in 0..patience {
            if !opened.as_ref().is_err_and(is_locked) || claim.holds().is_err() {
                break;
            }
            std::thread::sleep(PAUSE);
            opened = open();
        }
        let sink = opened.map_err(|e| {
            let locked = is_locked(&e).then(|| "another run writes this file".to_owned());
            let gone = (!path.exists()).then(|| GONE.to_owned());
            Error::file(path, locked.or(gone).unwrap_or_else(|| e.to_string()))
        })?;
        sink.claim.holds()?;
        Ok(sink)
    }

    /// Removes all that was written after a checkpoint: rows, and the data that a run writes when it ends.
    fn cut(&mut self, checkpoint: &Checkpoint) -> Hdf<()> {
        let Rows { frames, gauges, ends, ledger, paths } = &checkpoint.rows;
        self.frames.cut(*frames)?;
        for (table, rows) in self.gauges.iter_mut().zip(gauges).chain(self.ends.iter_mut().zip(ends)) {
            table.cut(*rows)?;
        }
        self.ledger.cut(*ledger)?;
        if let Some(table) = &mut self.paths {
            table.cut(*paths, &checkpoint.waiting)?;
        }
        let [links, attributes] = members(&self.file)?;
        for link in links.iter().filter(|link| !checkpoint.members[0].contains(link)) {
            self.file.unlink(link)?;
        }
        for attribute in attributes.iter().filter(|attribute| !checkpoint.members[1].contains(attribute)) {
            self.file.delete_attr(attribute)?;
        }
        self.file.attr("outcome")?.write_scalar(&text(RUNNING)?)?;
        self.file.flush()
    }

    /// Writes a checkpoint of all data so far.
    fn keep(&mut self, mut checkpoint: Checkpoint) -> Result<()> {
        self.flush()?;
        checkpoint.rows = Rows {
            frames: self.frames.written,
            gauges: self.gauges.iter().map(|table| table.written).collect(),
            ends: self.ends.each_ref().map(|table| table.written),
            ledger: self.ledger.written,
            paths: self.paths.as_ref().map_or(0, PathTable::written),
        };
        checkpoint.waiting = self.paths.as_ref().map(PathTable::waiting).unwrap_or_default();
        checkpoint.run_id.clone_from(&self.run_id);
        checkpoint.members = members(&self.file).map_err(|e| Error::file(&self.path, e))?;
        checkpoint.write(self.claim.path())
    }

    fn open(path: &Path, claim: Claim, layout: &Layout) -> Hdf<Self> {
        let file = open_rw(claim.path())?;
        let frames = Frames::open(&file, layout)?;
        let mut gauges = Vec::with_capacity(layout.gauges.len());
        let gauge_links = gauge_links(layout);
        for name in &gauge_links {
            let names: Vec<&str> = gauge_columns(layout).iter().map(|c| c[0]).collect();
            gauges.push(Table::open(&file.group(&format!("gauges/{name}"))?, &names)?);
        }
        let end_columns: Vec<&str> = end_columns(layout, file.attr("radius").is_ok()).iter().map(|c| c[0]).collect();
        let end = |side: Side| Table::open(&file.group(&format!("ends/{}", side.name()))?, &end_columns);
        let ends = [end(Side::Left)?, end(Side::Right)?];
        let ledger = Table::open(&file.group("ledger")?, &ledger_columns().map(|c| c[0]).collect::<Vec<_>>())?;
        let paths = layout.paths.then(|| PathTable::open(&file, layout.compression)).transpose()?;
        Ok(Self {
            path: path.to_owned(),
            claim,
            run_id: get_text(&file, "run_id")?,
            file,
            frames,
            gauges,
            gauge_names: gauge_links.into_iter().zip(layout.gauges.iter().map(|(name, _)| name.clone())).collect(),
            area_given: layout.area_given,
            end_factors: layout.geometry.end_factors,
            ends,
            ledger,
            paths,
            unflushed: false,
        })
    }

    /// Processes one message. Large amounts of data are written immediately; small ones wait for the next flush.
    pub fn take(&mut self, message: Message) -> Result<()> {
        let much = match message {
            Message::Frame(frame) => self.frames.push(&frame),
            Message::Gauge(index, trace) => match self.gauges.get_mut(index) {
                Some(table) => {
                    let all = [&trace.time, &trace.stress, &trace.strain, &trace.velocity, &trace.temperature];
                    table.push(&all.map(Vec::as_slice)[..table.columns.len()])
                }
                None => Err(format!("there is no gauge number {index}").into()),
            },
            Message::End(side, trace) => self.push_end(side, &trace),
            Message::Ledger(row) => {
                let values = ledger_values(&row);
                self.ledger.push(&values.iter().map(std::slice::from_ref).collect::<Vec<_>>())
            }
            Message::Paths(rows) => match &mut self.paths {
                Some(table) => Ok(table.push(&rows)),
                None => Err("this file has no table of paths".into()),
            },
            Message::Checkpoint(checkpoint) => return self.keep(*checkpoint),
            Message::Finish(ending) => return self.finish(&ending),
        };
        let path = &self.path;
        if much.map_err(|e| Error::file(path, e))? {
            self.write_waiting()?;
        }
        Ok(())
    }

    /// Adds rows of an end to the waiting ones; returns true if it is time to write them.
    fn push_end(&mut self, side: Side, Trace { time, stress, velocity, .. }: &Trace) -> Hdf<bool> {
        let table = &mut self.ends[side as usize];
        let Some(factors) = self.end_factors else { return table.push(&[time, stress, velocity]) };
        let loads: Vec<f64> = stress.iter().map(|stress| factors[side as usize] * stress).collect();
        table.push(&[time, stress, velocity, &loads])
    }

    /// Writes all waiting data and passes them to the operating system.
    pub fn flush(&mut self) -> Result<()> {
        self.write_waiting()?;
        self.claim.holds()?;
        if self.unflushed {
            self.file.flush().map_err(|e| disk_error(&self.path, &e))?;
            self.unflushed = false;
        }
        Ok(())
    }

    fn write_waiting(&mut self) -> Result<()> {
        self.reserve(0)?;
        let path = &self.path;
        let mut wrote = self.frames.write().map_err(|e| disk_error(path, &e))?;
        for table in self.gauges.iter_mut().chain(&mut self.ends).chain(std::iter::once(&mut self.ledger)) {
            wrote |= table.write().map_err(|e| disk_error(path, &e))?;
        }
        if let Some(table) = &mut self.paths {
            wrote |= table.write().map_err(|e| disk_error(path, &e))?;
        }
        self.unflushed |= wrote;
        Ok(())
    }

    /// Writes the tables that are known only at the end, then the outcome as the very last item.
    pub fn finish(&mut self, ending: &Trailer) -> Result<()> {
        self.flush()?;
        let tables = tables::bytes(16 + self.gauges.len(), ending.fronts.len()) + tables::bytes(32, ending.audit.len());
        self.reserve(tables + figures::bytes(&ending.figures.figures))?;
        let path = self.path.clone();
        self.write_ending(ending).map_err(|e| disk_error(&path, &e))?;
        self.release();
        self.claim.holds()?;
        if ending.outcome != INTERRUPTED {
            checkpoint::remove(self.claim.path());
        }
        Ok(())
    }

    /// Reserves space for all waiting data, and for `more` bytes.
    fn reserve(&mut self, more: u64) -> Result<()> {
        let tables = self.gauges.iter().chain(&self.ends).chain(std::iter::once(&self.ledger));
        let waiting = self.frames.bytes()
            + tables.map(Table::bytes).sum::<usize>()
            + self.paths.as_ref().map_or(0, PathTable::bytes);
        let kept = self.frames.last.map_or_else(String::new, |last| {
            let last = format(last, Dimension::Time, System::Si);
            std::format!("; the frames written before are kept, up to t = {last}")
        });
        self.claim.reserve(self.file.size(), waiting as u64 + more).map_err(|e| match e {
            Error::File { path, reason, help } => Error::File { path, reason: reason + &kept, help },
            other => other,
        })
    }

    /// Releases the disk space that the file does not use.
    pub fn release(&self) {
        self.claim.release(self.file.size());
    }

    /// Writes the reason to a file that cannot be continued. All its frames are kept.
    pub fn abandon(&self, error: &Error) {
        let Error::File { reason, .. } = error else { return };
        let said = put_text(&self.file, "reason", reason)
            .and_then(|()| self.file.attr("outcome")?.write_scalar(&text("stopped")?));
        if said.and_then(|()| self.file.flush()).is_ok() {
            self.release();
        }
    }

    fn write_ending(&mut self, ending: &Trailer) -> Hdf<()> {
        write_fronts(&self.file, &ending.fronts, &self.gauge_names)?;
        write_audit(&self.file, &ending.audit)?;
        if let Some(ruptures) = &ending.figures.ruptures {
            ruptures::write(&self.file, ruptures, self.area_given)?;
        }
        write_root(&self.file, &ending.figures)?;
        figures::write(&self.file, &ending.figures.figures, self.gauge_names.iter().map(|(link, _)| link))?;
        if let Some(table) = &mut self.paths {
            table.finish(ending.figures.paths_complete)?;
        }
        self.file.flush()?;
        self.file.attr("outcome")?.write_scalar(&text(&ending.outcome)?)?;
        self.file.flush()
    }
}

impl Frames {
    fn open(file: &File, layout: &Layout) -> Hdf<Self> {
        let fields = layout.fields.iter().map(|f| file.dataset(f.name())).collect::<Hdf<Vec<_>>>()?;
        let blocks = vec![Vec::new(); fields.len()];
        Ok(Self {
            time: file.dataset("time")?,
            fields,
            precision: layout.precision,
            chunks: (layout.compression == Compression::Deflate).then(Chunks::new),
            columns: layout.x.len(),
            written: 0,
            last: None,
            times: Vec::new(),
            blocks,
        })
    }

    /// Truncates the frames to the first `rows` ones.
    fn cut(&mut self, rows: usize) -> Hdf<()> {
        for dataset in &self.fields {
            if is_longer(dataset, rows)? {
                dataset.resize((rows, self.columns))?;
            }
        }
        cut(&self.time, rows)?;
        self.written = rows;
        let last = rows.saturating_sub(1)..rows;
        self.last = self.time.read_slice_1d::<f64, _>(s![last])?.first().copied();
        Ok(())
    }

    /// Adds a frame to the waiting ones; returns true if it is time to write them.
    fn push(&mut self, frame: &Frame) -> Hdf<bool> {
        if frame.rows.len() != self.blocks.len() || frame.rows.iter().any(|row| row.len() != self.columns) {
            return Err(format!(
                "a frame of {} rows does not fit {} fields of {} samples",
                frame.rows.len(),
                self.blocks.len(),
                self.columns
            )
            .into());
        }
        self.times.push(frame.time);
        for (block, row) in self.blocks.iter_mut().zip(&frame.rows) {
            block.extend_from_slice(row);
        }
        Ok(8 * self.times.len() * self.columns * self.blocks.len() >= BLOCK_BYTES)
    }

    /// Returns an upper bound of the size of the waiting frames in the file, bytes.
    fn bytes(&self) -> usize {
        // Deflate lengthens incompressible data slightly; every frame is a chunk with an entry in a tree.
        self.times.len() * (9 * self.columns + 256) * self.blocks.len()
    }

    /// Writes the waiting frames, fields before times, so that a file cut off in between has no time without its
    /// fields. Returns true if something was written.
    fn write(&mut self) -> Hdf<bool> {
        let rows = self.times.len();
        if rows == 0 {
            return Ok(false);
        }
        let (start, end) = (self.written, self.written + rows);
        for (dataset, block) in self.fields.iter().zip(&mut self.blocks) {
            dataset.resize((end, self.columns))?;
            if let Some(chunks) = &mut self.chunks {
                for (row, values) in (start..end).zip(block.chunks(self.columns)) {
                    chunks.write_row(dataset, row, self.columns.min(CHUNK_COLUMNS), values, self.precision)?;
                }
            } else {
                let view = ArrayView2::from_shape((rows, self.columns), block).map_err(|e| e.to_string())?;
                match self.precision {
                    Precision::F64 => dataset.write_slice(view, s![start..end, ..])?,
                    Precision::F32 => dataset.write_slice(&view.mapv(|v| v as f32), s![start..end, ..])?,
                }
            }
            block.clear();
        }
        append(&self.time, start, &self.times)?;
        self.last = self.times.last().copied();
        self.times.clear();
        self.written = end;
        Ok(true)
    }
}

impl Table {
    fn open(group: &Group, names: &[&str]) -> Hdf<Self> {
        let columns = names.iter().map(|name| group.dataset(name)).collect::<Hdf<Vec<_>>>()?;
        let waiting = vec![Vec::new(); columns.len()];
        Ok(Self { samples: group.dataset(SAMPLE)?, columns, waiting, written: 0 })
    }

    /// Truncates the table to the first `rows` rows.
    fn cut(&mut self, rows: usize) -> Hdf<()> {
        self.written = rows;
        self.columns.iter().try_for_each(|dataset| cut(dataset, rows))?;
        cut(&self.samples, rows)
    }

    /// Adds rows, given column by column, to the waiting ones; returns true if it is time to write them.
    fn push(&mut self, columns: &[&[f64]]) -> Hdf<bool> {
        let rows = columns.first().map_or(0, |column| column.len());
        if columns.len() != self.waiting.len() || columns.iter().any(|column| column.len() != rows) {
            return Err("the columns of a history differ in length".into());
        }
        for (waiting, column) in self.waiting.iter_mut().zip(columns) {
            waiting.extend_from_slice(column);
        }
        Ok(self.waiting[0].len() >= TRACE_ROWS)
    }

    /// Returns an upper bound of the size of the waiting rows in the file, in whole chunks, bytes.
    fn bytes(&self) -> usize {
        let chunks = if self.waiting[0].is_empty() { 0 } else { 1 + self.waiting[0].len().div_ceil(TRACE_ROWS) };
        8 * TRACE_ROWS * chunks * self.columns.len()
    }

    /// Writes the waiting rows, time last. Returns true if something was written.
    fn write(&mut self) -> Hdf<bool> {
        let rows = self.waiting[0].len();
        if rows == 0 {
            return Ok(false);
        }
        for (dataset, waiting) in self.columns.iter().zip(&mut self.waiting).rev() {
            append(dataset, self.written, waiting)?;
            waiting.clear();
        }
        self.written += rows;
        self.samples.resize(self.written)?;
        Ok(true)
    }
}

fn disk_error(path: &Path, error: &hdf5::Error) -> Error {
    Error::file(path, format!("cannot write the result: {error}; is the disk full?"))
}

/// Returns the names of the links and of the attributes of the root.
fn members(file: &File) -> Hdf<[Vec<String>; 2]> {
    Ok([file.member_names()?, file.attr_names()?])
}

fn write_fronts(file: &File, fronts: &[FrontRow], gauges: &[(String, String)]) -> Hdf<()> {
    let number = |name: &str, units, long_name: &str, value: fn(&FrontRow) -> f64| {
        Column::numbers(name, units, long_name, fronts.iter().map(value).collect())
    };
    let mut columns = vec![
        Column::texts("origin", "origin of the front", fronts.iter().map(|f| f.origin.clone()).collect()),
        number("strain_behind", "1", "engineering strain behind the front", |f| f.strain_behind),
        number("strain_ahead", "1", "engineering strain ahead of the front", |f| f.strain_ahead),
        number("stress_behind", "Pa", "engineering stress behind the front", |f| f.stress_behind),
        number("stress_ahead", "Pa", "engineering stress ahead of the front", |f| f.stress_ahead),
        number("speed", "m/s", "speed from the stress-strain curve, with respect to the undeformed bar", |f| f.speed),
        number("speed_measured", "m/s", "speed measured in the fields", |f| f.speed_measured),
        number("position", "m", "last position in the undeformed bar", |f| f.position),
        number("last_seen", "s", "time of the last position", |f| f.last_seen),
        number("load_held_until", "s", "time until which the load at the origin is constant", |f| f.load_held_until),
    ];
    for (index, (link, name)) in gauges.iter().enumerate() {
        let times = fronts.iter().map(|f| f.arrivals.get(index).copied().unwrap_or(f64::NAN)).collect();
        let long_name = format!("arrival at the gauge {name}");
        columns.push(Column::numbers(&format!("arrival_{link}"), "s", &long_name, times));
    }
    tables::write(file, "fronts", "front", &columns, fronts.len()).map(|_| ())
}

fn write_audit(file: &File, audit: &[AuditRow]) -> Hdf<()> {
    let texts = |name: &str, long_name: &str, value: fn(&AuditRow) -> String| {
        Column::texts(name, long_name, audit.iter().map(value).collect())
    };
    let numbers = |name: &str, long_name: &str, value: fn(&AuditRow) -> f64| {
        Column::numbers(name, "1", long_name, audit.iter().map(value).collect())
    };
    let columns = [
        texts("effect", "neglected effect", |row| row.effect.clone()),
        texts("message", "size of the effect and how to include it", AuditRow::message),
        numbers("estimate", "estimated relative change of the stress, or the quantity named in the message", |row| {
            row.estimate
        }),
        numbers("threshold", "estimate above which the effect is significant", |row| row.threshold),
    ];
    tables::write(file, "audit", "row", &columns, audit.len()).map(|_| ())
}

fn write_root(file: &File, figures: &RunFigures) -> Hdf<()> {
    put_quantity(file, "wall_seconds", figures.wall_seconds, "s")?;
    put_quantity(file, "step_wall_seconds", figures.step_wall_seconds, "s")?;
    put(file, "cells", &figures.cells)?;
    put(file, "steps", &figures.steps)?;
    put(file, "events", &figures.events)?;
    put(file, "cell_steps", &figures.cell_steps)?;
    if let Some(reason) = &figures.reason {
        put_text(file, "reason", reason)?;
    }
    if let Some(error) = &figures.error {
        let group = file.create_group("error")?;
        put(&group, "value", &error.value)?;
        put_text(&group, "measure", &error.measure)?;
        put_text(&group, "reference", &error.reference)?;
        for (measure, value) in error.table.iter().flat_map(ErrorTable::entries) {
            put(&group, measure.key(), &value)?;
        }
    }
    Ok(())
}

fn ledger_values(row: &LedgerRow) -> Vec<f64> {
    let mut values = vec![row.time];
    values.extend(row.energies.values());
    values.extend([row.work_left, row.work_right, row.energies.momentum, row.impulse, row.residual]);
    values
}

/// Returns true if the library could not open a file because another process has it open for writing.
fn is_locked(error: &hdf5::Error) -> bool {
    let said = error.to_string();
    said.contains("unable to lock file") || said.contains("lock request failed")
}

//! The writing side: builds the file, then appends frames, histories and ledger rows.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, DatasetBuilderEmpty, Extent, File, Group, H5Type, Location};
use ndarray::{ArrayView2, s};

use super::compound::{self, Column};
use super::{Ending, FORMAT_VERSION, Finish, Header, Layout, Message, RUNNING, Side, scales};
use crate::error::{Error, Result};
use crate::record::{AuditRow, Compression, Frame, FrontRow, LedgerRow, MaterialRecord, Precision, Trace};

type Hdf<T> = hdf5::Result<T>;

/// Samples in a chunk of the fields. A chunk is a piece of one frame, so that a chunk on the disk never changes: HDF5
/// moves a compressed chunk that is written again, and a process killed between that and the next flush leaves a
/// chunk that cannot be decompressed (1 kill in 5 of a writer at full speed, with chunks of 64 frames).
const CHUNK_COLUMNS: usize = 16_384;
/// Frames are written together up to this many bytes.
const BLOCK_BYTES: usize = 4 << 20;
/// Rows in a chunk of a history. Histories are not compressed, so that a chunk grows in place, for the same reason.
const TRACE_ROWS: usize = 1024;
/// Rows in a chunk of the frame times and of the ledger.
const FRAME_ROWS: usize = 256;

/// Columns of a history: name, units, long name.
const GAUGE_COLUMNS: [[&str; 3]; 4] =
    [TIME, ["stress", "Pa", "engineering stress, tension positive"], ["strain", "1", "engineering strain"], VELOCITY];
const END_COLUMNS: [[&str; 3]; 3] = [TIME, ["stress", "Pa", "engineering stress, tension positive"], VELOCITY];
const TIME: [&str; 3] = ["time", "s", "time"];
const VELOCITY: [&str; 3] = ["velocity", "m/s", "velocity in +x"];

/// Columns of the ledger: name, long name. Energies but for time, the momenta, and the residual.
const LEDGER_COLUMNS: [[&str; 2]; 10] = [
    ["time", "time"],
    ["kinetic", "kinetic energy"],
    ["elastic", "recoverable strain energy"],
    ["plastic", "energy dissipated in plastic flow since the start"],
    ["viscous", "energy taken since the start by the damping of grid-scale ripples"],
    ["work_left", "work done by the left end since the start"],
    ["work_right", "work done by the right end since the start"],
    ["momentum", "momentum of the bar in +x"],
    ["impulse", "impulse given by both ends since the start"],
    ["residual", "energy not accounted for, relative"],
];

/// The open file and what waits to be written to it.
#[derive(Debug)]
pub(super) struct Sink {
    path: PathBuf,
    file: File,
    frames: Frames,
    gauges: Vec<Table>,
    gauge_links: Vec<String>,
    ends: [Table; 2],
    ledger: Table,
    /// Something was written since the last flush.
    unflushed: bool,
}

/// The fields over x and t.
#[derive(Debug)]
struct Frames {
    time: Dataset,
    fields: Vec<Dataset>,
    precision: Precision,
    columns: usize,
    written: usize,
    times: Vec<f64>,
    /// Rows waiting, one block a field.
    blocks: Vec<Vec<f64>>,
}

/// One-dimensional columns of equal length that grow together; the first is time.
#[derive(Debug)]
struct Table {
    columns: Vec<Dataset>,
    waiting: Vec<Vec<f64>>,
    written: usize,
}

impl Sink {
    /// Builds the file beside its final place, then moves it there.
    pub fn create(path: &Path, header: &Header, layout: &Layout, materials: &[MaterialRecord]) -> Result<Self> {
        if path.is_dir() {
            return Err(Error::file(path, "this is a folder; a result needs a file name"));
        }
        if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(|e| Error::file(folder, e))?;
        }
        let temporary = temporary_name(path)?;
        let built = build(&temporary, header, layout, materials)
            .map_err(|e| Error::file(path, e))
            .and_then(|()| std::fs::rename(&temporary, path).map_err(|e| Error::file(path, e)));
        if let Err(error) = built {
            // It may never have been made; the error that counts is the one that is returned.
            let _ = std::fs::remove_file(&temporary);
            return Err(error);
        }
        Self::open(path, layout).map_err(|e| Error::file(path, e))
    }

    fn open(path: &Path, layout: &Layout) -> Hdf<Self> {
        // Chunks are written whole and once, so a cache would only put off their compression until the flush.
        let file = File::with_options().with_fapl(|p| p.chunk_cache(1, 0, 1.0)).open_rw(path)?;
        let frames = Frames::open(&file, layout)?;
        let mut gauges = Vec::with_capacity(layout.gauges.len());
        let gauge_links = gauge_links(layout);
        for name in &gauge_links {
            let names = GAUGE_COLUMNS.map(|c| c[0]);
            gauges.push(Table::open(&file.group(&format!("gauges/{name}"))?, &names)?);
        }
        let end = |side: Side| Table::open(&file.group(&format!("ends/{}", side.name()))?, &END_COLUMNS.map(|c| c[0]));
        let ends = [end(Side::Left)?, end(Side::Right)?];
        let ledger = Table::open(&file.group("ledger")?, &LEDGER_COLUMNS.map(|c| c[0]))?;
        Ok(Self { path: path.to_owned(), file, frames, gauges, gauge_links, ends, ledger, unflushed: false })
    }

    /// Takes one message; much is written at once, little waits for the next flush.
    pub fn take(&mut self, message: Message) -> Result<()> {
        let much = match message {
            Message::Frame(frame) => self.frames.push(&frame),
            Message::Gauge(index, trace) => match self.gauges.get_mut(index) {
                Some(table) => {
                    table.push([&trace.time, &trace.stress, &trace.strain, &trace.velocity].map(Vec::as_slice))
                }
                None => Err(format!("there is no gauge number {index}").into()),
            },
            Message::End(side, Trace { time, stress, velocity, .. }) => {
                self.ends[side as usize].push([&time, &stress, &velocity].map(Vec::as_slice))
            }
            Message::Ledger(row) => self.ledger.push(ledger_values(&row).each_ref().map(std::slice::from_ref)),
            Message::Finish(ending) => return self.finish(&ending),
        };
        let path = &self.path;
        if much.map_err(|e| Error::file(path, e))? {
            self.write_waiting()?;
        }
        Ok(())
    }

    /// Writes whatever waits and hands it to the operating system.
    pub fn flush(&mut self) -> Result<()> {
        self.write_waiting()?;
        if self.unflushed {
            self.file.flush().map_err(|e| disk_error(&self.path, &e))?;
            self.unflushed = false;
        }
        Ok(())
    }

    fn write_waiting(&mut self) -> Result<()> {
        let path = &self.path;
        let mut wrote = self.frames.write().map_err(|e| disk_error(path, &e))?;
        for table in self.gauges.iter_mut().chain(&mut self.ends).chain(std::iter::once(&mut self.ledger)) {
            wrote |= table.write().map_err(|e| disk_error(path, &e))?;
        }
        self.unflushed |= wrote;
        Ok(())
    }

    /// Writes the tables known only at the end, then the outcome as the very last thing.
    pub fn finish(&mut self, ending: &Ending) -> Result<()> {
        self.flush()?;
        let path = self.path.clone();
        self.write_ending(ending).map_err(|e| Error::file(&path, e))
    }

    fn write_ending(&mut self, ending: &Ending) -> Hdf<()> {
        write_fronts(&self.file, &ending.fronts, &self.gauge_links)?;
        write_audit(&self.file, &ending.audit)?;
        write_figures(&self.file, &ending.figures)?;
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
            columns: layout.x.len(),
            written: 0,
            times: Vec::new(),
            blocks,
        })
    }

    /// Keeps a frame; true where it is time to write.
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

    /// Writes the waiting rows, fields before times: a file cut off in between has no time without its fields.
    fn write(&mut self) -> Hdf<bool> {
        let rows = self.times.len();
        if rows == 0 {
            return Ok(false);
        }
        let (start, end) = (self.written, self.written + rows);
        for (dataset, block) in self.fields.iter().zip(&mut self.blocks) {
            dataset.resize((end, self.columns))?;
            let view = ArrayView2::from_shape((rows, self.columns), block).map_err(|e| e.to_string())?;
            match self.precision {
                Precision::F64 => dataset.write_slice(view, s![start..end, ..])?,
                Precision::F32 => dataset.write_slice(&view.mapv(|v| v as f32), s![start..end, ..])?,
            }
            block.clear();
        }
        append(&self.time, start, &self.times)?;
        self.times.clear();
        self.written = end;
        Ok(true)
    }
}

impl Table {
    fn open(group: &Group, names: &[&str]) -> Hdf<Self> {
        let columns = names.iter().map(|name| group.dataset(name)).collect::<Hdf<Vec<_>>>()?;
        let waiting = vec![Vec::new(); columns.len()];
        Ok(Self { columns, waiting, written: 0 })
    }

    /// Keeps rows, given column by column; true where it is time to write.
    fn push<const N: usize>(&mut self, columns: [&[f64]; N]) -> Hdf<bool> {
        let rows = columns.first().map_or(0, |column| column.len());
        if columns.len() != self.waiting.len() || columns.iter().any(|column| column.len() != rows) {
            return Err("the columns of a history differ in length".into());
        }
        for (waiting, column) in self.waiting.iter_mut().zip(columns) {
            waiting.extend_from_slice(column);
        }
        Ok(self.waiting[0].len() >= TRACE_ROWS)
    }

    /// Writes the waiting rows, time last.
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
        Ok(true)
    }
}

fn disk_error(path: &Path, error: &hdf5::Error) -> Error {
    Error::file(path, format!("{error}; is the disk full?"))
}

fn append(dataset: &Dataset, start: usize, values: &[f64]) -> Hdf<()> {
    let end = start + values.len();
    dataset.resize(end)?;
    dataset.write_slice(values, s![start..end])
}

/// Everything but the data, in a file that is then closed.
fn build(path: &Path, header: &Header, layout: &Layout, materials: &[MaterialRecord]) -> Hdf<()> {
    let file = File::create(path)?;
    build_root(&file, header, layout)?;
    build_fields(&file, layout)?;
    build_histories(&file, layout)?;
    build_ledger(&file, layout)?;
    build_materials(&file, materials)?;
    file.flush()?;
    file.close()
}

fn build_root(file: &File, header: &Header, layout: &Layout) -> Hdf<()> {
    put_text(file, "format", "barwave")?;
    put(file, "format_version", &FORMAT_VERSION)?;
    put_text(file, "program_version", env!("CARGO_PKG_VERSION"))?;
    if let Some(revision) = super::git_revision() {
        put_text(file, "git_revision", revision)?;
    }
    put_text(file, "title", &header.title)?;
    put_text(file, "created", &timestamp(SystemTime::now()))?;
    put_text(file, "scene", &header.scene)?;
    put_text(file, "scene_resolved", &header.scene_resolved)?;
    put_texts(file, "overrides", &header.overrides)?;
    put_texts(file, "effects", &header.effects)?;
    put_text(file, "method", &header.method)?;
    put_text(file, "scheme", &header.scheme)?;
    put_text(file, "energy_units", energy_units(layout.area_given))?;
    if let Some(velocity) = header.critical_velocity {
        put(file, "critical_velocity", &velocity)?;
    }
    put_text(file, "outcome", RUNNING)
}

fn build_fields(file: &File, layout: &Layout) -> Hdf<()> {
    let time = file.new_dataset::<f64>().chunk(FRAME_ROWS).shape(Extent::resizable(0)).create("time")?;
    describe(&time, "s", "time")?;
    let x = file.new_dataset::<f64>().shape(layout.x.len()).create("x")?;
    x.write_raw(&layout.x)?;
    describe(&x, "m", "position along the bar, from the left end, as undeformed")?;
    for field in &layout.fields {
        let shape = (Extent::resizable(0), Extent::fixed(layout.x.len()));
        let builder = match layout.precision {
            Precision::F64 => file.new_dataset::<f64>().fill_value(f64::NAN),
            Precision::F32 => file.new_dataset::<f32>().fill_value(f32::NAN),
        };
        let dataset = compressed(builder, layout.compression)
            .chunk((1, layout.x.len().clamp(1, CHUNK_COLUMNS)))
            .shape(shape)
            .create(field.name())?;
        describe(&dataset, field.units(), field.long_name())?;
    }
    let names: Vec<&str> = layout.fields.iter().map(|f| f.name()).collect();
    scales::attach(file, &["time", "x"], &names)
}

fn build_histories(file: &File, layout: &Layout) -> Hdf<()> {
    let gauges = file.create_group("gauges")?;
    for (index, (link, (name, x))) in gauge_links(layout).iter().zip(&layout.gauges).enumerate() {
        let group = gauges.create_group(link)?;
        build_columns(&group, &GAUGE_COLUMNS, TRACE_ROWS)?;
        put(&group, "x", x)?;
        put_text(&group, "x_units", "m")?;
        put(&group, "index", &(index as u32))?;
        put_text(&group, "name", name)?;
    }
    let ends = file.create_group("ends")?;
    for side in [Side::Left, Side::Right] {
        build_columns(&ends.create_group(side.name())?, &END_COLUMNS, TRACE_ROWS)?;
    }
    Ok(())
}

fn build_ledger(file: &File, layout: &Layout) -> Hdf<()> {
    let columns = LEDGER_COLUMNS.map(|[name, long_name]| {
        let units = match (name, layout.area_given) {
            ("time", _) => "s",
            ("residual", _) => "1",
            ("momentum" | "impulse", true) => "N s",
            ("momentum" | "impulse", false) => "N s/m^2",
            (_, area_given) => energy_units(area_given),
        };
        [name, units, long_name]
    });
    build_columns(&file.create_group("ledger")?, &columns, FRAME_ROWS)
}

fn energy_units(area_given: bool) -> &'static str {
    if area_given { "J" } else { "J/m^2" }
}

/// Growing columns of a group; the first is the scale of the others.
fn build_columns(group: &Group, columns: &[[&str; 3]], rows: usize) -> Hdf<()> {
    for [name, units, long_name] in columns {
        let builder = group.new_dataset::<f64>().fill_value(f64::NAN);
        describe(&builder.chunk(rows).shape(Extent::resizable(0)).create(*name)?, units, long_name)?;
    }
    let names: Vec<&str> = columns.iter().map(|c| c[0]).collect();
    scales::attach(group, &names[..1], &names[1..])
}

fn build_materials(file: &File, materials: &[MaterialRecord]) -> Hdf<()> {
    let group = file.create_group("material")?;
    let names = link_names(materials.iter().map(|m| m.name.as_str()));
    for (material, name) in materials.iter().zip(&names) {
        let group = group.create_group(name)?;
        let strain = group.new_dataset::<f64>().shape(material.strain.len()).create("strain")?;
        strain.write_raw(&material.strain)?;
        describe(&strain, "1", "engineering strain")?;
        let stress = group.new_dataset::<f64>().shape(material.stress.len()).create("stress")?;
        stress.write_raw(&material.stress)?;
        describe(&stress, "Pa", "engineering stress, tension positive")?;
        scales::attach(&group, &["strain"], &["stress"])?;
        put(&group, "density", &material.density)?;
        put(&group, "modulus", &material.modulus)?;
        let provenance = &material.provenance;
        put_text(&group, "name", &material.name)?;
        put_text(&group, "citation", &provenance.citation)?;
        put_text(&group, "measured", &provenance.measured)?;
        put_text(&group, "confidence", &provenance.confidence)?;
        put_text(&group, "origin", &provenance.origin)?;
    }
    Ok(())
}

fn write_fronts(file: &File, fronts: &[FrontRow], gauges: &[String]) -> Hdf<()> {
    let number = |name: &str, value: fn(&FrontRow) -> f64| Column::number(name, fronts.iter().map(value).collect());
    let mut columns = vec![
        Column::text("origin", fronts.iter().map(|f| f.origin.clone()).collect()),
        number("strain_behind", |f| f.strain_behind),
        number("strain_ahead", |f| f.strain_ahead),
        number("stress_behind", |f| f.stress_behind),
        number("stress_ahead", |f| f.stress_ahead),
        number("speed", |f| f.speed),
        number("speed_measured", |f| f.speed_measured),
        number("position", |f| f.position),
        number("last_seen", |f| f.last_seen),
    ];
    for (index, gauge) in gauges.iter().enumerate() {
        let times = fronts.iter().map(|f| f.arrivals.get(index).copied().unwrap_or(f64::NAN)).collect();
        columns.push(Column::number(format!("arrival_{gauge}"), times));
    }
    let table = compound::write(file, "fronts", &columns, fronts.len())?;
    put_text(&table, "long_name", "fronts: strains 1, stresses Pa, speeds m/s, position m, times s")?;
    scales::numbering(file, "front", fronts.len())?;
    scales::attach(file, &["front"], &["fronts"])
}

fn write_audit(file: &File, audit: &[AuditRow]) -> Hdf<()> {
    let group = file.create_group("audit")?;
    scales::numbering(&group, "row", audit.len())?;
    let texts = |name: &str, value: fn(&AuditRow) -> &str| -> Hdf<()> {
        let values = audit.iter().map(|row| text(value(row))).collect::<Hdf<Vec<_>>>()?;
        write_column(&group, name, &values)
    };
    texts("effect", |row| &row.effect)?;
    texts("message", |row| &row.message)?;
    write_column(&group, "estimate", &audit.iter().map(|row| row.estimate).collect::<Vec<_>>())?;
    write_column(&group, "threshold", &audit.iter().map(|row| row.threshold).collect::<Vec<_>>())?;
    scales::attach(&group, &["row"], &["effect", "message", "estimate", "threshold"])
}

fn write_column<T: H5Type>(group: &Group, name: &str, values: &[T]) -> Hdf<()> {
    let dataset = group.new_dataset::<T>().shape(values.len()).create(name)?;
    if values.is_empty() { Ok(()) } else { dataset.write_raw(values) }
}

fn write_figures(file: &File, figures: &Finish) -> Hdf<()> {
    put(file, "wall_seconds", &figures.wall_seconds)?;
    put(file, "step_wall_seconds", &figures.step_wall_seconds)?;
    put(file, "cells", &figures.cells)?;
    put(file, "steps", &figures.steps)?;
    put(file, "events", &figures.events)?;
    put(file, "cell_steps", &figures.cell_steps)?;
    if let Some(reason) = &figures.reason {
        put_text(file, "reason", reason)?;
    }
    if let Some(error) = &figures.error {
        put(file, "error_value", &error.value)?;
        put_text(file, "error_measure", &error.measure)?;
        put_text(file, "error_reference", &error.reference)?;
    }
    Ok(())
}

fn ledger_values(row: &LedgerRow) -> [f64; 10] {
    [
        row.time,
        row.kinetic,
        row.elastic,
        row.plastic,
        row.viscous,
        row.work_left,
        row.work_right,
        row.momentum,
        row.impulse,
        row.residual,
    ]
}

fn compressed(builder: DatasetBuilderEmpty, compression: Compression) -> DatasetBuilderEmpty {
    match compression {
        Compression::Deflate => builder.shuffle().deflate(1),
        Compression::Lzf => builder.shuffle().lzf(),
        Compression::None => builder,
    }
}

fn describe(dataset: &Dataset, units: &str, long_name: &str) -> Hdf<()> {
    put_text(dataset, "units", units)?;
    put_text(dataset, "long_name", long_name)
}

fn put<T: H5Type>(location: &Location, name: &str, value: &T) -> Hdf<()> {
    location.new_attr::<T>().create(name)?.write_scalar(value)
}

fn put_text(location: &Location, name: &str, value: &str) -> Hdf<()> {
    put(location, name, &text(value)?)
}

fn put_texts(location: &Location, name: &str, values: &[String]) -> Hdf<()> {
    let values = values.iter().map(|value| text(value)).collect::<Hdf<Vec<_>>>()?;
    let attribute = location.new_attr::<VarLenUnicode>().shape(values.len()).create(name)?;
    if values.is_empty() { Ok(()) } else { attribute.write_raw(&values) }
}

/// HDF5 text ends at a zero byte, which no text file has; one that does is cut there rather than refused.
fn text(value: &str) -> Hdf<VarLenUnicode> {
    let until_zero = value.split('\0').next().unwrap_or_default();
    until_zero.parse().map_err(|e: hdf5::types::StringError| e.to_string().into())
}

/// `.NAME.<pid>.tmp` beside the final file, so that moving it is one step on the same disk.
fn temporary_name(path: &Path) -> Result<PathBuf> {
    let name = path.file_name().ok_or_else(|| Error::file(path, "a result needs a file name"))?;
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.tmp", std::process::id()));
    Ok(path.with_file_name(temporary))
}

fn gauge_links(layout: &Layout) -> Vec<String> {
    link_names(layout.gauges.iter().map(|(name, _)| name.as_str()))
}

/// Names fit for groups: no slash, no leading dot, not empty, no two alike.
fn link_names<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut links: Vec<String> = Vec::new();
    for name in names {
        let mut base = name.replace(['/', '\0'], "-");
        if base.is_empty() || base.starts_with('.') {
            base.insert(0, '_');
        }
        let mut link = base.clone();
        let mut number = 2;
        while links.contains(&link) {
            link = format!("{base}-{number}");
            number += 1;
        }
        links.push(link);
    }
    links
}

/// ISO 8601 in UTC, to the second.
fn timestamp(now: SystemTime) -> String {
    let seconds = now.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let (year, month, day) = civil_from_days((seconds / 86_400).cast_signed());
    let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// Year, month and day of a number of days since 1970-01-01 (Hinnant's algorithm, proleptic Gregorian calendar:
/// years run from March, so that the leap day comes last).
fn civil_from_days(days: i64) -> (i64, i64, i64) {
    let shifted = days + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    (year_of_era + era * 400 + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn timestamps_are_civil_utc() {
        let at = |seconds| timestamp(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(at(0), "1970-01-01T00:00:00Z");
        assert_eq!(at(951_782_399), "2000-02-28T23:59:59Z");
        assert_eq!(at(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(at(1_709_251_199), "2024-02-29T23:59:59Z");
        assert_eq!(at(4_107_542_400), "2100-03-01T00:00:00Z");
    }

    #[test]
    fn link_names_are_safe_and_differ() {
        let links = link_names(["a/b", "a-b", "", ".x", "a/b"].into_iter());
        assert_eq!(links, ["a-b", "a-b-2", "_", "_.x", "a-b-3"]);
    }
}

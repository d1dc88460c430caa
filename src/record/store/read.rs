//! Reading of result files, including unfinished ones, as plain data.

use std::ops::Range;
use std::path::{Path, PathBuf};

use hdf5::{File, Group};
use ndarray::{Array2, s};

use super::attributes::{FORMAT, get, get_text, get_texts};
use super::create::{END_TORQUE, energy_units, momentum_units};
use super::shared::{NotOpened, SharedFile};
use super::sweep::SWEEP_FORMAT;
use super::tables::{numbers as column, texts};
use super::{FORMAT_VERSION, RUNNING, Side, paths};
use super::{bounded, heap};
use crate::error::{InputError, Result};
use crate::material::Provenance;
use crate::record::{AuditRow, ErrorFigure, ErrorTable, Field, FrontRow, LedgerRow, MaterialRecord, PathRow, Trace};
use crate::solver::Energies;
use crate::text_file::{self, NamedFiles};

type Hdf<T> = hdf5::Result<T>;

/// Open result file. Attributes are read immediately, data on request.
#[derive(Debug)]
pub struct ResultFile {
    path: PathBuf,
    file: SharedFile,
    metadata: Metadata,
}

/// Root attributes.
#[derive(Debug, Clone, Default)]
pub struct Metadata {
    /// Version of the program that wrote the file.
    pub program_version: String,
    /// Commit from which the program was built, if known.
    pub git_revision: Option<String>,
    /// Start of the run, ISO 8601 in UTC.
    pub created: String,
    /// Title of the scene.
    pub title: String,
    /// Exact text of the scene.
    pub scene: String,
    /// Scene as JSON with all defaults.
    pub scene_resolved: String,
    /// Overrides, as typed.
    pub overrides: Vec<String>,
    /// Effects that the run simulated, including plasticity if the bar could yield.
    pub effects: Vec<String>,
    /// Notes on problematic settings of the scene; empty in files of older programs.
    pub notes: Vec<String>,
    /// Method: "fd" or "moc".
    pub method: String,
    /// Scheme: "leapfrog", ...
    pub scheme: String,
    /// Outcome: "done", "running", ...
    pub outcome: String,
    /// Reason for which the run stopped, if it stopped early.
    pub reason: Option<String>,
    /// Unit of energies: "J" or "J/m^2".
    pub energy_units: String,
    /// Critical velocity, m/s.
    pub critical_velocity: Option<f64>,
    /// Wall time of the whole run, s; `None` in an unfinished file, like all following fields.
    pub wall_seconds: Option<f64>,
    /// Wall time of the solver alone, s.
    pub step_wall_seconds: Option<f64>,
    /// Number of cells.
    pub cells: Option<u64>,
    /// Number of time steps; of events in front tracking.
    pub steps: Option<u64>,
    /// Number of events of front tracking: interactions of fronts, and steps of the ends.
    pub events: Option<u64>,
    /// Number of cells times steps.
    pub cell_steps: Option<u64>,
    /// Error against a reference, if there is one.
    pub error: Option<ErrorFigure>,
}

impl Metadata {
    /// Returns true until the run has ended: for the file of a run in progress, or of a killed one.
    pub fn is_unfinished(&self) -> bool {
        self.outcome == RUNNING
    }
}

/// Scene of a result file of any format version, which can be run again from this file alone.
#[derive(Debug, Clone)]
pub struct StoredScene {
    /// Name of the scene: the stem of its file.
    pub name: String,
    /// Exact text of the scene.
    pub text: String,
    /// Overrides, as typed.
    pub overrides: Vec<String>,
    /// Files to which the scene refers.
    pub files: NamedFiles,
}

impl StoredScene {
    /// Reads the scene of a result file.
    ///
    /// # Errors
    /// As for [`ResultFile::open`].
    pub fn read(path: &Path) -> Result<Self> {
        let file = open(path)?;
        if let Ok(newer) = get::<u32>(&file, "format_version")
            && newer > FORMAT_VERSION
        {
            return Err(other_version(path, Some(newer)).into());
        }
        let read = || -> Hdf<Self> {
            let resolved: serde_json::Value =
                serde_json::from_str(&get_text(&file, "scene_resolved")?).unwrap_or_default();
            Ok(Self {
                name: resolved["name"].as_str().unwrap_or("scene").to_owned(),
                text: get_text(&file, "scene")?,
                overrides: get_texts(&file, "overrides")?,
                files: read_scene_files(&file)?,
            })
        };
        read().map_err(|e| damaged(path, &e).into())
    }
}

/// History at a gauge of the bar.
#[derive(Debug, Clone)]
pub struct Gauge {
    /// Name of the gauge in the scene.
    pub name: String,
    /// Position, m from the left end.
    pub x: f64,
    /// History at the gauge.
    pub trace: Trace,
}

impl ResultFile {
    /// Opens a result file.
    ///
    /// # Errors
    /// [`InputError`] if the file is missing, is not a result file, or has a layout that this program does not know.
    pub fn open(path: &Path) -> Result<Self> {
        let file = open(path)?;
        match get::<u32>(&file, "format_version") {
            Ok(FORMAT_VERSION) => {}
            found => return Err(other_version(path, found.ok()).into()),
        }
        let metadata = read_metadata(&file).map_err(|e| damaged(path, &e))?;
        Ok(Self { path: path.to_owned(), file, metadata })
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the root attributes.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// Returns the frame times, s; in a file that was cut off, only those of the frames that every field has.
    pub fn time(&self) -> Result<Vec<f64>> {
        self.of_bar(|file| {
            let mut time: Vec<f64> = bounded::column(&file.dataset("time")?)?;
            for field in present(file) {
                time.truncate(file.dataset(field.name())?.shape().first().copied().unwrap_or(0));
            }
            Ok(time)
        })
    }

    /// Returns the sample positions, m.
    pub fn x(&self) -> Result<Vec<f64>> {
        self.of_bar(|file| bounded::column(&file.dataset("x")?))
    }

    /// Returns the left and right bounds of the cells around the samples, m.
    pub fn bounds(&self) -> Result<Vec<[f64; 2]>> {
        self.of_bar(|file| {
            let (dataset, samples) = (file.dataset("x_bounds")?, file.dataset("x")?.size());
            if dataset.shape() != [samples, 2] {
                let shape = dataset.shape();
                return Err(format!("`x_bounds` has the shape {shape:?}, expected [{samples}, 2]").into());
            }
            bounded::check(&dataset)?;
            Ok(dataset.read_raw::<f64>()?.chunks_exact(2).map(|cell| [cell[0], cell[1]]).collect())
        })
    }

    /// Returns the fields in the file.
    pub fn fields(&self) -> Vec<Field> {
        present(&self.file)
    }

    /// Returns the frames `rows` of a field, with shape (rows, `n_x`).
    ///
    /// # Errors
    /// An [`InputError`] if the file does not have the field or the frames, or is damaged.
    pub fn field(&self, field: Field, rows: Range<usize>) -> Result<Array2<f64>> {
        self.has_frames(field, &rows)?;
        self.of_bar(|file| {
            let (dataset, columns) = (file.dataset(field.name())?, file.dataset("x")?.size());
            match dataset.shape()[..] {
                [_, m] if m == columns => {}
                ref shape => {
                    let name = field.name();
                    return Err(
                        format!("`{name}` has the shape {shape:?}, expected frames of {columns} samples").into()
                    );
                }
            }
            bounded::check(&dataset)?;
            dataset.read_slice_2d(s![rows.start..rows.end, ..])
        })
    }

    /// Returns the gauges, in the scene's order.
    pub fn gauges(&self) -> Result<Vec<Gauge>> {
        self.of_bar(|file| {
            gauge_groups(file)?
                .iter()
                .map(|(_, group)| {
                    Ok(Gauge { name: get_text(group, "name")?, x: get(group, "x")?, trace: read_trace(group)? })
                })
                .collect()
        })
    }

    /// Returns the history of an end.
    pub fn end(&self, side: Side) -> Result<Trace> {
        self.of_bar(|file| read_trace(&file.group(&format!("ends/{}", side.name()))?))
    }

    /// Returns the torque at an end in torsion, N m, at the times of [`Self::end`]; empty if the file has none.
    pub fn end_torque(&self, side: Side) -> Result<Vec<f64>> {
        self.of_bar(|file| column(&file.group(&format!("ends/{}", side.name()))?, END_TORQUE[0]))
    }

    /// Returns the ledger.
    pub fn ledger(&self) -> Result<Vec<LedgerRow>> {
        self.of_bar(|file| read_ledger(&file.group("ledger")?))
    }

    /// Returns the fronts; empty for an unfinished file.
    pub fn fronts(&self) -> Result<Vec<FrontRow>> {
        self.run(|file| {
            if !file.link_exists("fronts") {
                return Ok(Vec::new());
            }
            let gauges: Vec<String> = gauge_groups(file)?.into_iter().map(|(link, _)| link).collect();
            read_fronts(&file.group("fronts")?, &gauges)
        })
    }

    /// Returns the straight segments of fronts, in the order in which they ended; empty if the file has none.
    pub fn paths(&self) -> Result<Vec<PathRow>> {
        self.run(|file| if file.link_exists("paths") { paths::read(file) } else { Ok(Vec::new()) })
    }

    /// Returns the neglected effects; empty for an unfinished file.
    pub fn audit(&self) -> Result<Vec<AuditRow>> {
        self.run(|file| if file.link_exists("audit") { read_audit(&file.group("audit")?) } else { Ok(Vec::new()) })
    }

    /// Returns the unique identifier of the run that wrote the file; empty in files of programs that did not write it.
    pub fn run_id(&self) -> String {
        get_text(&self.file, "run_id").unwrap_or_default()
    }

    /// Returns the files to which the scene refers.
    pub fn scene_files(&self) -> Result<NamedFiles> {
        self.run(read_scene_files)
    }

    /// Returns the stress-strain curves as the run used them.
    pub fn materials(&self) -> Result<Vec<MaterialRecord>> {
        self.run(|file| {
            let group = file.group("material")?;
            group.member_names()?.iter().map(|name| read_material(&group.group(name)?)).collect()
        })
    }

    /// Returns the unit of the momentum and the impulse in the ledger.
    pub fn momentum_units(&self) -> &'static str {
        momentum_units(self.is_in_torsion(), self.metadata().energy_units == energy_units(true))
    }

    /// Returns true if the bar is in torsion: its stresses, strains and velocities are then those of shear.
    pub fn is_in_torsion(&self) -> bool {
        self.run(|file| Ok(get_text(file, "mode").is_ok())).unwrap_or(false)
    }

    /// Refuses frames that the file does not have.
    fn has_frames(&self, field: Field, rows: &Range<usize>) -> Result<()> {
        self.needs_bar()?;
        let (name, fields) = (field.name(), self.fields());
        if !fields.contains(&field) {
            let names: Vec<&str> = fields.iter().map(|field| field.name()).collect();
            let help = format!("record it: add \"{name}\" to `fields` under [record] in the scene, and run it again");
            let error = wrong(&self.path, &format!("the file has no field `{name}`"), &help);
            return Err(error.allowed(names.join(", ")).into());
        }
        let frames = self.run(|file| Ok(file.dataset(name)?.shape().first().copied().unwrap_or(0)))?;
        if rows.start <= rows.end && rows.end <= frames {
            return Ok(());
        }
        let message = format!("the frames {}..{} are not in the file", rows.start, rows.end);
        let help = "the number of frames is that of the times";
        Err(wrong(&self.path, &message, help).allowed(format!("0 <= start <= end <= {frames}")).into())
    }

    /// Reads data that only the result of a bar has.
    fn of_bar<T>(&self, read: impl FnOnce(&File) -> Hdf<T>) -> Result<T> {
        self.needs_bar()?;
        self.run(read)
    }

    pub(super) fn run<T>(&self, read: impl FnOnce(&File) -> Hdf<T>) -> Result<T> {
        read(&self.file).map_err(|e| damaged(&self.path, &e).into())
    }
}

/// Opens a file that barwave wrote.
fn open(path: &Path) -> Result<SharedFile> {
    if path.is_dir() {
        return Err(wrong(path, "this is a folder", "name a result file in it").into());
    }
    if !path.is_file() {
        return Err(wrong(path, "no such file", "name a result file that `barwave run` wrote").into());
    }
    super::recover(path);
    // Files that cannot be read here are reported by the library.
    if !heap::have_ends(path).unwrap_or(true) {
        let message = "the result file is damaged: a list of texts in it has no end";
        return Err(wrong(path, message, "copy it again, or run its scene again").into());
    }
    let file = SharedFile::open(path).map_err(|e| cannot_open(path, &e))?;
    log::info!("reading {}", path.display());
    match get_text(&file, "format").ok().as_deref() {
        Some(FORMAT) => Ok(file),
        Some(SWEEP_FORMAT) => {
            let help = "draw it with `barwave sweep SWEEP.toml -o DIR --resume --plot FILE.svg`, DIR being its folder; the \
                        same table stands beside it, as .csv";
            Err(wrong(path, "this is the table of a sweep, not the result of a run", help).into())
        }
        _ => {
            let help = "result files have the root attribute format = \"barwave\"";
            Err(wrong(path, "this HDF5 file is not a barwave result", help).into())
        }
    }
}

fn wrong(path: &Path, message: &str, help: &str) -> InputError {
    InputError::new(format!("{}: {message}", path.display())).help(help)
}

/// Returns the error for a file of another layout.
fn other_version(path: &Path, found: Option<u32>) -> InputError {
    let shown = path.display();
    match found {
        Some(newer) if newer > FORMAT_VERSION => {
            let message = format!("the file has the format version {newer}; this program reads {FORMAT_VERSION}");
            wrong(path, &message, "read it with a newer barwave, the one that wrote it or a later one")
        }
        Some(older) => {
            let message = format!("the file has the older format version {older}; this program reads {FORMAT_VERSION}");
            wrong(path, &message, &format!("simulate its scene again: barwave run {shown}"))
        }
        None => wrong(path, "the file has no format version", "run its scene again"),
    }
}

fn damaged(path: &Path, error: &hdf5::Error) -> InputError {
    let said = error.to_string();
    // The library names its functions before the cause.
    let cause = said.rsplit(": ").next().filter(|_| said.starts_with("H5"));
    let message = match cause {
        Some(cause) => format!("the result file is damaged: HDF5 cannot read it ({cause})"),
        None => format!("the result file is damaged: {said}"),
    };
    wrong(path, &message, "copy it again, or run its scene again")
}

fn cannot_open(path: &Path, why: &NotOpened) -> InputError {
    let said = match why {
        NotOpened::Locked => {
            return wrong(path, "the file is locked by the run that writes it", "wait until the run has ended");
        }
        NotOpened::Failed(error) => error.to_string(),
    };
    if said.contains("truncated") {
        return wrong(path, "the file is truncated", "copy it again, or run its scene again");
    }
    if text_file::is_hdf5(path) {
        return wrong(path, "the file is damaged or truncated", "copy it again, or run its scene again");
    }
    wrong(path, "this is not an HDF5 file", "name a result file that `barwave run` wrote")
}

fn read_metadata(file: &File) -> Hdf<Metadata> {
    Ok(Metadata {
        program_version: get_text(file, "program_version")?,
        git_revision: get_text(file, "git_revision").ok(),
        created: get_text(file, "created")?,
        title: get_text(file, "title")?,
        scene: get_text(file, "scene")?,
        scene_resolved: get_text(file, "scene_resolved")?,
        overrides: get_texts(file, "overrides")?,
        effects: get_texts(file, "effects")?,
        notes: get_texts(file, "notes").unwrap_or_default(),
        method: get_text(file, "method")?,
        scheme: get_text(file, "scheme")?,
        outcome: get_text(file, "outcome")?,
        reason: get_text(file, "reason").ok(),
        energy_units: get_text(file, "energy_units")?,
        critical_velocity: get(file, "critical_velocity").ok(),
        wall_seconds: get(file, "wall_seconds").ok(),
        step_wall_seconds: get(file, "step_wall_seconds").ok(),
        cells: get(file, "cells").ok(),
        steps: get(file, "steps").ok(),
        events: get(file, "events").ok(),
        cell_steps: get(file, "cell_steps").ok(),
        error: read_error(file).ok(),
    })
}

fn read_error(file: &File) -> Hdf<ErrorFigure> {
    let group = file.group("error")?;
    let table = ErrorTable::of(|measure| get(&group, measure.key()).ok());
    Ok(ErrorFigure {
        table: table.largest().map(|_| table),
        value: get(&group, "value")?,
        measure: get_text(&group, "measure")?,
        reference: get_text(&group, "reference")?,
    })
}

fn present(file: &File) -> Vec<Field> {
    Field::ALL.into_iter().filter(|field| file.link_exists(field.name())).collect()
}

/// Returns the groups of the gauges with their link names, in the scene's order (HDF5 lists links in alphabetical order).
pub(super) fn gauge_groups(file: &File) -> Hdf<Vec<(String, Group)>> {
    let gauges = file.group("gauges")?;
    let mut groups = Vec::new();
    for name in gauges.member_names()? {
        let group = gauges.group(&name)?;
        groups.push((get::<u32>(&group, "index")?, name, group));
    }
    groups.sort_by_key(|(index, ..)| *index);
    Ok(groups.into_iter().map(|(_, name, group)| (name, group)).collect())
}

fn read_trace(group: &Group) -> Hdf<Trace> {
    let mut trace = Trace {
        time: column(group, "time")?,
        stress: column(group, "stress")?,
        strain: column(group, "strain")?,
        velocity: column(group, "velocity")?,
        temperature: column(group, "temperature")?,
    };
    // Columns differ in length only if the file was cut off during a flush.
    let rows = trace.time.len().min(trace.stress.len()).min(trace.velocity.len());
    let temperature = &mut trace.temperature;
    for values in [&mut trace.time, &mut trace.stress, &mut trace.strain, &mut trace.velocity, temperature] {
        values.truncate(rows);
    }
    Ok(trace)
}

fn read_ledger(group: &Group) -> Hdf<Vec<LedgerRow>> {
    let rest = ["time", "work_left", "work_right", "momentum", "impulse", "residual"];
    let [time, work_left, work_right, momentum, impulse, residual] = rest.map(|name| column(group, name));
    let (time, work, momentum) = (time?, [work_left?, work_right?], momentum?);
    let (impulse, residual) = (impulse?, residual?);
    // Older files lack some energies, and have `viscous` instead of two of them.
    let mut energies = Vec::new();
    for [name, _] in Energies::COLUMNS {
        let stored = if *name == "numerical" && group.link_exists("viscous") { "viscous" } else { name };
        energies.push((*name, if group.link_exists(stored) { column(group, stored)? } else { Vec::new() }));
    }
    let all = [&time, &work[0], &work[1], &momentum, &impulse, &residual];
    let rows = all.into_iter().map(Vec::len).min().unwrap_or(0);
    let row = |i: usize| {
        let energy =
            |name: &str| energies.iter().find(|(own, _)| *own == name).and_then(|(_, values)| values.get(i).copied());
        LedgerRow {
            time: time[i],
            energies: Energies { momentum: momentum[i], ..Energies::by_name(energy) },
            work_left: work[0][i],
            work_right: work[1][i],
            impulse: impulse[i],
            residual: residual[i],
        }
    };
    Ok((0..rows).map(row).collect())
}

fn read_scene_files(file: &File) -> Hdf<NamedFiles> {
    if !file.link_exists("scene_files") {
        return Ok(NamedFiles::default());
    }
    let group = file.group("scene_files")?;
    Ok(NamedFiles {
        base: get_text(&group, "base")?,
        materials: get_text(&group, "materials").ok(),
        texts: texts(&group, "path")?.into_iter().zip(texts(&group, "text")?).collect(),
    })
}

fn read_fronts(group: &Group, gauges: &[String]) -> Hdf<Vec<FrontRow>> {
    let [strain_behind, strain_ahead] = ["strain_behind", "strain_ahead"].map(|name| column(group, name));
    let [stress_behind, stress_ahead] = ["stress_behind", "stress_ahead"].map(|name| column(group, name));
    let (strains, stresses) = ([strain_behind?, strain_ahead?], [stress_behind?, stress_ahead?]);
    let [speed, measured] = ["speed", "speed_measured"].map(|name| column(group, name));
    let [position, last_seen] = ["position", "last_seen"].map(|name| column(group, name));
    let (speeds, places) = ([speed?, measured?], [position?, last_seen?]);
    // Files of earlier versions do not have this column.
    let load_held_until = column(group, "load_held_until").unwrap_or_default();
    let arrivals =
        gauges.iter().map(|gauge| column(group, &format!("arrival_{gauge}"))).collect::<Hdf<Vec<Vec<f64>>>>()?;
    let at = |values: &[f64], row: usize| values.get(row).copied().unwrap_or(f64::NAN);
    let front = |(row, origin): (usize, String)| FrontRow {
        origin,
        strain_behind: at(&strains[0], row),
        strain_ahead: at(&strains[1], row),
        stress_behind: at(&stresses[0], row),
        stress_ahead: at(&stresses[1], row),
        speed: at(&speeds[0], row),
        speed_measured: at(&speeds[1], row),
        position: at(&places[0], row),
        last_seen: at(&places[1], row),
        load_held_until: at(&load_held_until, row),
        arrivals: arrivals.iter().map(|times| at(times, row)).collect(),
    };
    Ok(texts(group, "origin")?.into_iter().enumerate().map(front).collect())
}

fn read_audit(group: &Group) -> Hdf<Vec<AuditRow>> {
    let (effects, messages) = (texts(group, "effect")?, texts(group, "message")?);
    let (estimates, thresholds) = (column(group, "estimate")?, column(group, "threshold")?);
    let rows = effects.iter().zip(&messages).zip(estimates.iter().zip(&thresholds));
    Ok(rows
        .map(|((effect, message), (&estimate, &threshold))| {
            let prefix = format!("{effect}: ");
            let finding = message.strip_prefix(&prefix).unwrap_or(message).to_owned();
            AuditRow { effect: effect.clone(), estimate, threshold, finding, ..AuditRow::default() }
        })
        .collect())
}

fn read_material(group: &Group) -> Hdf<MaterialRecord> {
    Ok(MaterialRecord {
        name: get_text(group, "name")?,
        strain: column(group, "strain")?,
        stress: column(group, "stress")?,
        tension: [column(group, "tension_strain")?, column(group, "tension_stress")?],
        compression: [column(group, "compression_strain")?, column(group, "compression_stress")?],
        density: get(group, "density")?,
        modulus: get(group, "modulus")?,
        provenance: Provenance {
            citation: get_text(group, "citation")?,
            measured: get_text(group, "measured")?,
            confidence: get_text(group, "confidence")?,
            origin: get_text(group, "origin")?,
        },
    })
}

//! The reading side: everything that a result file holds, as plain data. It reads unfinished files too.

use std::ops::Range;
use std::path::{Path, PathBuf};

use hdf5::types::VarLenUnicode;
use hdf5::{File, Group};
use ndarray::{Array2, s};

use super::attributes::{get, get_text, get_texts};
use super::bounded;
use super::compound::{self, Column, Values};
use super::existing::is_locked;
use super::{FORMAT_VERSION, RUNNING, Side, paths};
use crate::error::{InputError, Result};
use crate::material::Provenance;
use crate::record::{AuditRow, ErrorFigure, ErrorTable, Field, FrontRow, LedgerRow, MaterialRecord, PathRow, Trace};
use crate::solver::Energies;
use crate::text_file::NamedFiles;

type Hdf<T> = hdf5::Result<T>;

/// An open result file. Attributes are read at once, data when asked for.
#[derive(Debug)]
pub struct ResultFile {
    path: PathBuf,
    file: File,
    facts: Facts,
}

/// The root attributes.
#[derive(Debug, Clone, Default)]
pub struct Facts {
    /// Version of the program that wrote the file.
    pub program_version: String,
    /// The commit it was built from, where known.
    pub git_revision: Option<String>,
    /// When the run started, ISO 8601 UTC.
    pub created: String,
    /// For people.
    pub title: String,
    /// The scene's exact text.
    pub scene: String,
    /// JSON with every default filled in.
    pub scene_resolved: String,
    /// Overrides, as typed.
    pub overrides: Vec<String>,
    /// Effects that were simulated.
    pub effects: Vec<String>,
    /// What does not go well in what the scene asks for; empty in files of programs that did not say.
    pub notes: Vec<String>,
    /// "fd" or "moc".
    pub method: String,
    /// "leapfrog", ...
    pub scheme: String,
    /// "done", "running", ...
    pub outcome: String,
    /// Why a run stopped that could not go on.
    pub reason: Option<String>,
    /// "J" or "J/m^2".
    pub energy_units: String,
    /// m/s.
    pub critical_velocity: Option<f64>,
    /// Whole run, s; none in an unfinished file, like all that follow.
    pub wall_seconds: Option<f64>,
    /// Stepping alone, s.
    pub step_wall_seconds: Option<f64>,
    /// Cells.
    pub cells: Option<u64>,
    /// Time steps.
    pub steps: Option<u64>,
    /// Front collisions.
    pub events: Option<u64>,
    /// Cells times steps.
    pub cell_steps: Option<u64>,
    /// Error against a reference.
    pub error: Option<ErrorFigure>,
}

impl Facts {
    /// True until the run ended: the file of a run that goes on, or was killed.
    pub fn is_unfinished(&self) -> bool {
        self.outcome == RUNNING
    }
}

/// A history at a place on the bar.
#[derive(Debug, Clone)]
pub struct Gauge {
    /// As the scene names it.
    pub name: String,
    /// m from the left end.
    pub x: f64,
    /// The history.
    pub trace: Trace,
}

impl ResultFile {
    /// Opens a result file.
    ///
    /// # Errors
    /// [`InputError`] where the file is missing, no result file, or of a layout that this program does not know.
    pub fn open(path: &Path) -> Result<Self> {
        if path.is_dir() {
            return Err(wrong(path, "this is a folder", "name a result file in it").into());
        }
        if !path.is_file() {
            return Err(wrong(path, "there is no such file", "name a result file that `barwave run` wrote").into());
        }
        super::recover(path);
        let file = File::open(path).map_err(|e| cannot_open(path, &e))?;
        let format: Hdf<String> = get_text(&file, "format");
        if format.ok().as_deref() != Some("barwave") {
            return Err(wrong(
                path,
                "this HDF5 file is not a barwave result",
                "result files have the root attribute format = \"barwave\"",
            )
            .into());
        }
        match get::<u32>(&file, "format_version") {
            Ok(FORMAT_VERSION) => {}
            found => {
                let found = found.map_or("missing".into(), |v| v.to_string());
                let message = format!("the file's format_version is {found}, and this program reads {FORMAT_VERSION}");
                return Err(
                    wrong(path, &message, "use the program version that wrote it, or run its scene again").into()
                );
            }
        }
        let facts = read_facts(&file).map_err(|e| damaged(path, &e))?;
        Ok(Self { path: path.to_owned(), file, facts })
    }

    /// Where the file is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The root attributes.
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// Frame times, s; in a file that was cut off, of the frames that every field has.
    pub fn time(&self) -> Result<Vec<f64>> {
        self.run(|file| {
            let mut time: Vec<f64> = bounded::column(&file.dataset("time")?)?;
            for field in present(file) {
                time.truncate(file.dataset(field.name())?.shape().first().copied().unwrap_or(0));
            }
            Ok(time)
        })
    }

    /// Sample positions, m.
    pub fn x(&self) -> Result<Vec<f64>> {
        self.run(|file| bounded::column(&file.dataset("x")?))
    }

    /// Fields in the file.
    pub fn fields(&self) -> Vec<Field> {
        present(&self.file)
    }

    /// Frames `rows` of a field, shape (rows, `n_x`).
    pub fn field(&self, field: Field, rows: Range<usize>) -> Result<Array2<f64>> {
        self.run(|file| {
            let (dataset, columns) = (file.dataset(field.name())?, file.dataset("x")?.size());
            match dataset.shape()[..] {
                [n, m] if m == columns && rows.start <= rows.end && rows.end <= n => {}
                ref shape => {
                    let (name, end) = (field.name(), rows.end);
                    return Err(format!(
                        "`{name}` has the shape {shape:?}, expected {end} frames of {columns} samples"
                    )
                    .into());
                }
            }
            dataset.read_slice_2d(s![rows.start..rows.end, ..])
        })
    }

    /// Gauges, in the scene's order.
    pub fn gauges(&self) -> Result<Vec<Gauge>> {
        self.run(|file| {
            gauge_groups(file)?
                .iter()
                .map(|(_, group)| {
                    Ok(Gauge { name: get_text(group, "name")?, x: get(group, "x")?, trace: read_trace(group)? })
                })
                .collect()
        })
    }

    /// History of an end.
    pub fn end(&self, side: Side) -> Result<Trace> {
        self.run(|file| read_trace(&file.group(&format!("ends/{}", side.name()))?))
    }

    /// The ledger.
    pub fn ledger(&self) -> Result<Vec<LedgerRow>> {
        self.run(|file| read_ledger(&file.group("ledger")?))
    }

    /// Fronts; empty in an unfinished file.
    pub fn fronts(&self) -> Result<Vec<FrontRow>> {
        self.run(|file| {
            if !file.link_exists("fronts") {
                return Ok(Vec::new());
            }
            let gauges: Vec<String> = gauge_groups(file)?.into_iter().map(|(link, _)| link).collect();
            Ok(fronts_from(&compound::read(&file.dataset("fronts")?)?, &gauges))
        })
    }

    /// Straight pieces of fronts, in the order in which they ended; empty where the file has none.
    pub fn paths(&self) -> Result<Vec<PathRow>> {
        self.run(|file| if file.link_exists("paths") { paths::read(file) } else { Ok(Vec::new()) })
    }

    /// Neglected effects; empty in an unfinished file.
    pub fn audit(&self) -> Result<Vec<AuditRow>> {
        self.run(|file| if file.link_exists("audit") { read_audit(&file.group("audit")?) } else { Ok(Vec::new()) })
    }

    /// Tells the run that wrote the file from every other one; empty in files of programs that did not say.
    pub fn run_id(&self) -> String {
        get_text(&self.file, "run_id").unwrap_or_default()
    }

    /// The files that the scene names.
    pub fn scene_files(&self) -> Result<NamedFiles> {
        self.run(|file| {
            if !file.link_exists("scene_files") {
                return Ok(NamedFiles::default());
            }
            let group = file.group("scene_files")?;
            let texts = |name: &str| -> Hdf<Vec<VarLenUnicode>> { bounded::column(&group.dataset(name)?) };
            let pairs = texts("path")?.into_iter().zip(texts("text")?);
            Ok(NamedFiles {
                base: get_text(&group, "base")?,
                materials: get_text(&group, "materials").ok(),
                texts: pairs.map(|(path, text)| (path.to_string(), text.to_string())).collect(),
            })
        })
    }

    /// Curves as the run used them.
    pub fn materials(&self) -> Result<Vec<MaterialRecord>> {
        self.run(|file| {
            let group = file.group("material")?;
            group.member_names()?.iter().map(|name| read_material(&group.group(name)?)).collect()
        })
    }

    pub(super) fn run<T>(&self, read: impl FnOnce(&File) -> Hdf<T>) -> Result<T> {
        read(&self.file).map_err(|e| damaged(&self.path, &e).into())
    }
}

fn wrong(path: &Path, message: &str, help: &str) -> InputError {
    InputError::new(format!("{}: {message}", path.display())).help(help)
}

fn damaged(path: &Path, error: &hdf5::Error) -> InputError {
    wrong(path, &format!("the result file is damaged: {error}"), "copy it again, or run its scene again")
}

fn cannot_open(path: &Path, error: &hdf5::Error) -> InputError {
    let said = error.to_string();
    if is_locked(error) {
        return wrong(path, "the file is locked by the run that writes it", "wait until the run has ended");
    }
    if said.contains("truncated") {
        return wrong(
            path,
            "the file was cut off while it was copied or written",
            "copy it again, or run its scene again",
        );
    }
    if super::existing::has_signature(path) {
        return wrong(path, "the file is damaged or was cut off", "copy it again, or run its scene again");
    }
    wrong(path, "this is not an HDF5 file", "name a result file that `barwave run` wrote")
}

fn read_facts(file: &File) -> Hdf<Facts> {
    Ok(Facts {
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
    let group = file.group("error").ok();
    let table = ErrorTable::of(|measure| get(group.as_ref()?, measure.key()).ok());
    Ok(ErrorFigure {
        table: table.largest().map(|_| table),
        value: get(file, "error_value")?,
        measure: get_text(file, "error_measure")?,
        reference: get_text(file, "error_reference")?,
    })
}

fn present(file: &File) -> Vec<Field> {
    Field::ALL.into_iter().filter(|field| file.link_exists(field.name())).collect()
}

/// Gauge groups with their link names, in the scene's order (links are kept in alphabetical order).
fn gauge_groups(file: &File) -> Hdf<Vec<(String, Group)>> {
    let gauges = file.group("gauges")?;
    let mut groups = Vec::new();
    for name in gauges.member_names()? {
        let group = gauges.group(&name)?;
        groups.push((get::<u32>(&group, "index")?, name, group));
    }
    groups.sort_by_key(|(index, ..)| *index);
    Ok(groups.into_iter().map(|(_, name, group)| (name, group)).collect())
}

fn column(group: &Group, name: &str) -> Hdf<Vec<f64>> {
    if group.link_exists(name) { bounded::column(&group.dataset(name)?) } else { Ok(Vec::new()) }
}

fn read_trace(group: &Group) -> Hdf<Trace> {
    let mut trace = Trace {
        time: column(group, "time")?,
        stress: column(group, "stress")?,
        strain: column(group, "strain")?,
        velocity: column(group, "velocity")?,
        temperature: column(group, "temperature")?,
    };
    // Only a file that was cut off in the middle of a flush has columns of different lengths.
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
    // Older files lack some energies, and have `viscous` for two of them.
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

fn fronts_from(columns: &[Column], gauges: &[String]) -> Vec<FrontRow> {
    let values = |name: &str| columns.iter().find(|c| c.name == name).map(|c| &c.values);
    let number = |name: &str, row: usize| match values(name) {
        Some(Values::Number(numbers)) => numbers.get(row).copied().unwrap_or(f64::NAN),
        _ => f64::NAN,
    };
    let Some(Values::Text(origins)) = values("origin") else {
        return Vec::new();
    };
    let front = |(row, origin): (usize, &String)| FrontRow {
        origin: origin.clone(),
        strain_behind: number("strain_behind", row),
        strain_ahead: number("strain_ahead", row),
        stress_behind: number("stress_behind", row),
        stress_ahead: number("stress_ahead", row),
        speed: number("speed", row),
        speed_measured: number("speed_measured", row),
        position: number("position", row),
        last_seen: number("last_seen", row),
        arrivals: gauges.iter().map(|gauge| number(&format!("arrival_{gauge}"), row)).collect(),
    };
    origins.iter().enumerate().map(front).collect()
}

fn read_audit(group: &Group) -> Hdf<Vec<AuditRow>> {
    let texts = |name: &str| -> Hdf<Vec<VarLenUnicode>> { bounded::column(&group.dataset(name)?) };
    let (effects, messages) = (texts("effect")?, texts("message")?);
    let (estimates, thresholds) = (column(group, "estimate")?, column(group, "threshold")?);
    let rows = effects.iter().zip(&messages).zip(estimates.iter().zip(&thresholds));
    Ok(rows
        .map(|((effect, message), (&estimate, &threshold))| {
            let prefix = format!("{effect}: ");
            let finding = message.strip_prefix(&prefix).unwrap_or(message).to_owned();
            AuditRow { effect: effect.to_string(), estimate, threshold, finding, remedy: String::new() }
        })
        .collect())
}

fn read_material(group: &Group) -> Hdf<MaterialRecord> {
    Ok(MaterialRecord {
        name: get_text(group, "name")?,
        strain: column(group, "strain")?,
        stress: column(group, "stress")?,
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

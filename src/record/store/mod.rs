//! Result file (HDF5). Only the files of this module use the hdf5 crates.
//!
//! # Contents
//! The interface is specified in its section "Result file". In addition to it:
//!
//! - `time` and `x` are dimension scales attached to every field, so that h5py (`ds.dims[0]`) and xarray show labelled
//!   axes. `x_bounds`, `area` and `/bar` are the geometry.
//! - `/gauges/<name>`, `/ends/<side>` and `/ledger` are groups of columns over a dimension `sample` without values; the
//!   first column is `time`. netCDF requires dimensions of one name to be identical in a group and those below it
//!   (`xarray.open_datatree`).
//! - `/fronts`, `/ruptures`, `/audit`, `/scene_files` and the segments of `/bar` are tables (`tables`): groups of
//!   columns whose rows are numbered by a scale. `/fronts` has a column `arrival_<gauge>` for each gauge.
//! - `/paths`, in files of the method "moc", is a growing table with one row per straight segment of a front. Its
//!   attribute `complete` is 1 if the run has ended and no segment was omitted.
//! - Fields of the method "moc" are exact at their places: a sample on a front has the state behind it, one on a joint
//!   the state to its right (attribute `sampling`). Histories have two rows for each step, before and after it.
//! - `/scene_files`, if the scene refers to files with materials or histories, contains their paths and texts, and as
//!   attributes the folders in which they were found. The root attribute `run_id` identifies the run uniquely.
//! - NaN means missing: fields that the writer did not reach, fronts that could not be followed.
//!
//! # Completeness
//! The file is built under a temporary name in the folder of the final one (`.OUT.h5.<pid>-<n>.tmp`), with attributes,
//! axes, materials and empty datasets. It is then renamed in one step, replacing an older result. A start that fails
//! therefore leaves an older result unchanged and nothing under the final name. From then on, the final name always
//! refers to a file that can be opened, with `outcome = "running"` until [`Writer::finish`] writes the true outcome as
//! its last action. A killed run thus leaves all its frames up to the last flush under the final name; it flushes four
//! times a second. Data on the disk are never rewritten: the chunks of a frame contain only that frame, histories grow
//! uncompressed, and segments of fronts are written in whole chunks. The metadata that HDF5 keeps of them change
//! atomically with each flush (`journal`), so that a kill at any time leaves the state of the last flush.
//!
//! # Threads
//! libhdf5 has one global lock, so that a single thread writes. [`Writer`] is its sending end: frames and traces pass
//! through a bounded channel, compression runs in parallel with the stepping, and a solver that is faster than the disk
//! waits.

mod attributes;
mod bounded;
mod checkpoint;
mod chunks;
mod claim;
mod columns;
mod create;
#[cfg(unix)]
mod driver;
mod existing;
mod figures;
mod filters;
mod heap;
mod impact;
#[cfg(unix)]
mod journal;
mod paths;
mod read;
mod ruptures;
mod scales;
mod shared;
mod sweep;
mod tables;
#[cfg(not(unix))]
mod unjournaled;
mod write;

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

pub use checkpoint::{Checkpoint, Rows, checksum, path_of as checkpoint_path, remove as remove_checkpoint};
pub use existing::{check_output, check_table};
pub use figures::{StoredFigure, StoredPlace};
pub use impact::{StoredColumn, StoredImpact, StoredTable, write_impact};
pub use read::{Gauge, Metadata, ResultFile, StoredScene};
pub use ruptures::StoredRupture;
pub use sweep::{SweepColumn, SweepFile, Values, write_sweep};

use super::{
    AuditRow, Compression, ErrorFigure, Field, Figures, Frame, FrontRow, LedgerRow, MaterialRecord, PathRow, Precision,
    Trace,
};
use crate::error::{Error, Result};
use crate::law::rupture::Rupture;
use crate::text_file::NamedFiles;
use write::Sink;

#[cfg(unix)]
use driver::open_rw;
#[cfg(unix)]
use journal::{recover, remove as remove_journal};
#[cfg(not(unix))]
use unjournaled::{open_rw, recover, remove_journal};

/// Version of the file's layout, in the root attribute `format_version`.
pub const FORMAT_VERSION: u32 = 2;

/// Value of the root attribute `outcome` until a run ends.
pub const RUNNING: &str = "running";

/// Value of the root attribute `outcome` of an interrupted run.
pub const INTERRUPTED: &str = "interrupted";

/// Longest time for which a finished frame is only in memory.
const FLUSH_EVERY: Duration = Duration::from_millis(250);

/// Largest memory of the frames waiting in the channel, bytes.
const QUEUE_BYTES: usize = 64 << 20;

/// Returns the commit from which this program was built, if it was built in its own repository; "+" marks local changes.
pub fn git_revision() -> Option<&'static str> {
    option_env!("BARWAVE_GIT_REVISION")
}

/// Root attributes of a run that are known before its first step.
#[derive(Debug, Clone, Default)]
pub struct Header {
    /// Title of the scene.
    pub title: String,
    /// Exact text of the scene file.
    pub scene: String,
    /// Scene as JSON with all defaults.
    pub scene_resolved: String,
    /// Overrides (`--set`), as typed.
    pub overrides: Vec<String>,
    /// Effects that are simulated.
    pub effects: Vec<String>,
    /// Method: "fd" or "moc".
    pub method: String,
    /// Scheme: "leapfrog", ...
    pub scheme: String,
    /// Critical velocity, m/s; `None` if the data do not determine it.
    pub critical_velocity: Option<f64>,
    /// Notes on problematic settings of the scene, one sentence each.
    pub notes: Vec<String>,
    /// Radius at which stress, strain and velocity are recorded, for a bar in torsion, m; momenta are then in N m s. `None` for an axial bar.
    pub torsion: Option<f64>,
    /// Files to which the scene refers.
    pub files: NamedFiles,
}

/// Geometry of a bar.
#[derive(Debug, Clone, Default)]
pub struct Geometry {
    /// Length, m.
    pub length: f64,
    /// Segments from left to right.
    pub parts: Vec<Part>,
    /// Left and right bound of the cell around each sample, m.
    pub bounds: Vec<[f64; 2]>,
    /// Cross-section at each sample, m^2; `None` if the scene gives none, and in torsion.
    pub area: Option<Vec<f64>>,
    /// Factors that convert the stresses of both ends into forces (N), or into torques (N m) in torsion; `None` if the scene gives no area.
    pub end_factors: Option<[f64; 2]>,
}

/// Segment of a bar.
#[derive(Debug, Clone)]
pub struct Part {
    /// Position of the left end, m.
    pub start: f64,
    /// Position of the right end, m.
    pub end: f64,
    /// Name of its material.
    pub material: String,
    /// Cross-sections of its left and right end, m^2; `None` if the scene gives no area.
    pub areas: Option<[f64; 2]>,
}

/// Contents of the file and their format.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Geometry of the bar.
    pub geometry: Geometry,
    /// Sample positions of the fields, m from the left end; `n_x` of them.
    pub x: Vec<f64>,
    /// Fields, in the order of the rows of every [`Frame`].
    pub fields: Vec<Field>,
    /// Names and positions (m) of the gauges.
    pub gauges: Vec<(String, f64)>,
    /// Precision of the fields (axes, traces and ledger are always stored in 8 bytes).
    pub precision: Precision,
    /// Compression of the fields and of `/paths`.
    pub compression: Compression,
    /// True if energies are in J and momenta in N s, false if they are per m^2.
    pub area_given: bool,
    /// Description of how the fields were sampled over x; empty if there is none.
    pub sampling: String,
    /// True if the file has `/paths`.
    pub paths: bool,
    /// True if the gauges record the temperature.
    pub temperature: bool,
}

/// End of the bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// End at x = 0.
    Left,
    /// End at x = length.
    Right,
}

impl Side {
    /// Returns the name of the group under `/ends`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }
}

/// Results that are known when a run ends; most of them are written as root attributes.
#[derive(Debug, Clone, Default)]
pub struct RunFigures {
    /// Wall time of the whole run, s.
    pub wall_seconds: f64,
    /// Wall time of the solver alone, s.
    pub step_wall_seconds: f64,
    /// Number of cells (0 if the method has none).
    pub cells: u64,
    /// Number of time steps; of events in front tracking.
    pub steps: u64,
    /// Number of events of front tracking: interactions of fronts, and steps of the ends.
    pub events: u64,
    /// Number of cells times steps computed.
    pub cell_steps: u64,
    /// Reason for which the run stopped, if it stopped early.
    pub reason: Option<String>,
    /// Error against a reference, if there is one.
    pub error: Option<ErrorFigure>,
    /// True if `/paths` contains every front up to the end.
    pub paths_complete: bool,
    /// Fractures of the bar; `None` if fracture was not simulated, in which case the file has no `/ruptures`.
    pub ruptures: Option<Vec<Rupture>>,
    /// Figures for `/figures`.
    pub figures: Figures,
}

/// Writing end of a result file.
///
/// Every method passes its data to the writer thread; an error of that thread (e.g. a full disk) is returned by the
/// next call. Dropping a writer without [`Writer::finish`] flushes the data it was given and leaves
/// `outcome = "running"`.
#[derive(Debug)]
pub struct Writer {
    path: PathBuf,
    sender: Option<SyncSender<Message>>,
    /// Reason and help of the error that ended the thread.
    failure: Option<[String; 2]>,
    thread: Option<JoinHandle<Result<()>>>,
}

/// Message to the writer thread.
#[derive(Debug)]
enum Message {
    Frame(Frame),
    Gauge(usize, Trace),
    End(Side, Trace),
    Ledger(LedgerRow),
    Paths(Vec<PathRow>),
    Checkpoint(Box<Checkpoint>),
    Finish(Box<Trailer>),
}

/// Data that [`Writer::finish`] writes.
#[derive(Debug)]
struct Trailer {
    outcome: String,
    fronts: Vec<FrontRow>,
    audit: Vec<AuditRow>,
    figures: RunFigures,
}

impl Writer {
    /// Starts a result file: builds it under a temporary name, renames it, and starts the writer thread. Missing folders are created.
    ///
    /// # Errors
    /// [`Error::File`] if the file cannot be created or replaced; an older file is then unchanged.
    pub fn create(path: &Path, header: &Header, layout: &Layout, materials: &[MaterialRecord]) -> Result<Self> {
        Self::start(Sink::create(path, header, layout, materials)?, path, layout)
    }

    /// Reopens the file of an interrupted run and removes what was written after the checkpoint.
    ///
    /// # Errors
    /// [`Error::File`] if the file cannot be written, or contains less than the checkpoint refers to.
    pub fn resume(path: &Path, layout: &Layout, checkpoint: &Checkpoint) -> Result<Self> {
        Self::start(Sink::resume(path, layout, checkpoint)?, path, layout)
    }

    fn start(sink: Sink, path: &Path, layout: &Layout) -> Result<Self> {
        let frame_bytes = 8 * (layout.x.len() * layout.fields.len()).max(1);
        let (sender, receiver) = sync_channel((QUEUE_BYTES / frame_bytes).clamp(2, 256));
        let thread = std::thread::Builder::new()
            .name("result file".into())
            .spawn(move || serve(sink, &receiver))
            .map_err(|e| Error::file(path, e))?;
        Ok(Self { path: path.to_owned(), sender: Some(sender), failure: None, thread: Some(thread) })
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a frame; frames must be in order of time.
    pub fn frame(&mut self, frame: Frame) -> Result<()> {
        self.send(Message::Frame(frame))
    }

    /// Adds rows to the gauge at `index` of the layout.
    pub fn gauge(&mut self, index: usize, trace: Trace) -> Result<()> {
        self.send(Message::Gauge(index, trace))
    }

    /// Adds rows to the history of an end (its `strain` is not stored).
    pub fn end(&mut self, side: Side, trace: Trace) -> Result<()> {
        self.send(Message::End(side, trace))
    }

    /// Adds a row to the ledger.
    pub fn ledger(&mut self, row: LedgerRow) -> Result<()> {
        self.send(Message::Ledger(row))
    }

    /// Adds straight segments of fronts; the layout must contain `paths`.
    pub fn paths(&mut self, rows: Vec<PathRow>) -> Result<()> {
        self.send(Message::Paths(rows))
    }

    /// Flushes all data so far, then writes the corresponding checkpoint with its row counts.
    pub fn checkpoint(&mut self, checkpoint: Checkpoint) -> Result<()> {
        self.send(Message::Checkpoint(Box::new(checkpoint)))
    }

    /// Writes the results that are known only at the end, then the outcome, and closes the file.
    pub fn finish(mut self, outcome: &str, fronts: &[FrontRow], audit: &[AuditRow], figures: RunFigures) -> Result<()> {
        let ending = Trailer { outcome: outcome.into(), fronts: fronts.into(), audit: audit.into(), figures };
        self.send(Message::Finish(Box::new(ending)))?;
        self.join()
    }

    fn send(&mut self, message: Message) -> Result<()> {
        if self.sender.as_ref().is_some_and(|sender| sender.send(message).is_ok()) {
            return Ok(());
        }
        // The thread has ended, and its result is the reason.
        self.join()?;
        let closed = || ["the file is closed already".to_owned(), String::new()];
        let [reason, help] = self.failure.clone().unwrap_or_else(closed);
        Err(Error::File { path: self.path.clone(), reason, help })
    }

    fn join(&mut self) -> Result<()> {
        drop(self.sender.take());
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => {
                if let Err(Error::File { reason, help, .. }) = &result {
                    self.failure = Some([reason.clone(), help.clone()]);
                }
                result
            }
            Some(Err(_)) => Err(Error::file(&self.path, "the writer thread stopped")),
            None => Ok(()),
        }
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        // An error cannot be reported from here; the data flushed before it are in the file.
        let _ = self.join();
    }
}

/// Runs the writer thread: processes messages until the end and flushes at regular intervals.
fn serve(mut sink: Sink, messages: &Receiver<Message>) -> Result<()> {
    // The first frame is written to the disk immediately.
    let mut next_flush = Instant::now();
    loop {
        let taken = match messages.recv_timeout(next_flush.saturating_duration_since(Instant::now())) {
            Ok(Message::Finish(ending)) => return sink.finish(&ending).inspect_err(|e| sink.abandon(e)),
            Ok(message) => sink.take(message),
            Err(RecvTimeoutError::Disconnected) => return sink.flush().inspect(|()| sink.release()),
            Err(RecvTimeoutError::Timeout) => Ok(()),
        };
        let due = Instant::now() >= next_flush;
        taken.and_then(|()| if due { sink.flush() } else { Ok(()) }).inspect_err(|e| sink.abandon(e))?;
        if due {
            next_flush = Instant::now() + FLUSH_EVERY;
        }
    }
}

//! The result file (HDF5). Only the files of this module name the hdf5 crates.
//!
//! # What is in it
//! The contract is "Result file" in the interface. What this module adds to it:
//!
//! - `time` and `x` are dimension scales attached to every field, so h5py (`ds.dims[0]`) and xarray see labelled axes. `x_bounds`, `area` and
//!   `/bar` are the geometry.
//! - `/gauges/<name>`, `/ends/<side>` and `/ledger` are groups of columns over a dimension `sample` without values, the first of them
//!   `time`: netCDF wants dimensions of one name to be one in a group and those below it (`xarray.open_datatree`).
//! - `/fronts`, `/ruptures`, `/audit`, `/scene_files` and the segments of `/bar` are tables (`tables`): groups of columns numbered by a
//!   scale. `/fronts` has a column `arrival_<gauge>` for each gauge.
//! - `/paths`, in files of the method "moc", is a growing table, one row a straight piece of a front; its attribute `complete` is 1 where
//!   the run ended and no piece was left out.
//! - Fields of the method "moc" are exact at their places: a sample on a front has the state behind it, one on a joint
//!   the state to its right (attribute `sampling`). Histories have two rows for each step, before and after it.
//! - `/scene_files`, where the scene names materials or histories in files, has their paths and texts, and as attributes the folders
//!   that they were looked up in; the root attribute `run_id` tells a run from every other one.
//! - NaN means "not there": fields that were never reached by the writer, fronts that could not be followed.
//!
//! # When is it complete
//! The file is built under a temporary name beside its final one (`.OUT.h5.<pid>-<n>.tmp`): attributes, axes, materials,
//! empty datasets. Only then does it take its final name, in one step, replacing an older result. So a start that
//! fails leaves an older result alone and nothing under the final name, and from then on the final name always holds
//! a file that opens, with `outcome = "running"` until [`Writer::finish`] writes the true outcome as its last act.
//! A killed run therefore leaves its frames where the user looks for them: all that were flushed, four times a
//! second. Data on the disk are never rewritten (a frame's chunks hold nothing but that frame; histories grow
//! uncompressed; pieces of fronts are written in whole chunks), and the tables that HDF5 keeps of them change in one step
//! with each flush (`journal`), so that a kill at any moment leaves what the last flush wrote.
//!
//! # Threads
//! libhdf5 has one global lock, so one thread writes. [`Writer`] is its sending end: frames and traces go through a
//! bounded channel, compression runs beside the stepping, and a solver that is faster than the disk waits.

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
pub use existing::{check_output, check_table, is_hdf5};
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

/// The value of the root attribute `outcome` until a run ends.
pub const RUNNING: &str = "running";

/// Its value for an interrupted run.
pub const INTERRUPTED: &str = "interrupted";

/// Longest time for which a finished frame stays only in memory.
const FLUSH_EVERY: Duration = Duration::from_millis(250);

/// Memory that frames waiting in the channel may take, bytes.
const QUEUE_BYTES: usize = 64 << 20;

/// The commit that this program was built from, where it was built inside its own repository; "+" marks local changes.
pub fn git_revision() -> Option<&'static str> {
    option_env!("BARWAVE_GIT_REVISION")
}

/// What the root attributes say of a run before its first step.
#[derive(Debug, Clone, Default)]
pub struct Header {
    /// For people.
    pub title: String,
    /// The scene file's exact text.
    pub scene: String,
    /// JSON with every default filled in.
    pub scene_resolved: String,
    /// Overrides (`--set`), as typed.
    pub overrides: Vec<String>,
    /// Effects that are simulated.
    pub effects: Vec<String>,
    /// "fd" or "moc".
    pub method: String,
    /// "leapfrog", ...
    pub scheme: String,
    /// m/s; none where the data hold none.
    pub critical_velocity: Option<f64>,
    /// Notes on problematic settings of the scene, one sentence each.
    pub notes: Vec<String>,
    /// Of a bar in torsion: the radius whose stress, strain and velocity are recorded, m. Momenta are then N m s.
    pub torsion: Option<f64>,
    /// Files that the scene names.
    pub files: NamedFiles,
}

/// The geometry of a bar.
#[derive(Debug, Clone, Default)]
pub struct Geometry {
    /// m.
    pub length: f64,
    /// Segments from left to right.
    pub parts: Vec<Part>,
    /// Left and right bound of the cell around each sample, m.
    pub bounds: Vec<[f64; 2]>,
    /// Cross-section at each sample, m^2; none where the scene gives none, and in torsion.
    pub area: Option<Vec<f64>>,
    /// What makes forces (N), in torsion torques (N m), of the stresses of both ends; none where the scene gives no area.
    pub end_factors: Option<[f64; 2]>,
}

/// A segment of a bar.
#[derive(Debug, Clone)]
pub struct Part {
    /// Left end, m.
    pub start: f64,
    /// Right end, m.
    pub end: f64,
    /// Name of its material.
    pub material: String,
    /// Cross-sections of its ends, m^2.
    pub areas: Option<[f64; 2]>,
}

/// What the file holds and how.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Of the bar.
    pub geometry: Geometry,
    /// Sample positions of the fields, m from the left end; `n_x` of them.
    pub x: Vec<f64>,
    /// Fields, in the order of the rows of every [`Frame`].
    pub fields: Vec<Field>,
    /// Gauges: name and place, m.
    pub gauges: Vec<(String, f64)>,
    /// Numbers of the fields (axes, traces and ledger are always 8 bytes).
    pub precision: Precision,
    /// Compression of the fields and of `/paths`.
    pub compression: Compression,
    /// Energies are J and momenta N s where true, per m^2 where false.
    pub area_given: bool,
    /// How the fields were sampled over x, for people; empty: not said.
    pub sampling: String,
    /// The file has `/paths`.
    pub paths: bool,
    /// Gauges have a column of the temperature.
    pub temperature: bool,
}

/// An end of the bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// x = 0.
    Left,
    /// x = length.
    Right,
}

impl Side {
    /// Name of the group under `/ends`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }
}

/// What is known when a run ends; written as root attributes.
#[derive(Debug, Clone, Default)]
pub struct RunFigures {
    /// Whole run, s.
    pub wall_seconds: f64,
    /// Stepping alone, s.
    pub step_wall_seconds: f64,
    /// Cells (0 where the method has none).
    pub cells: u64,
    /// Time steps.
    pub steps: u64,
    /// Front collisions.
    pub events: u64,
    /// Cells times steps, as they were computed.
    pub cell_steps: u64,
    /// Reason for which a run stopped.
    pub reason: Option<String>,
    /// Error against a reference, where there is one.
    pub error: Option<ErrorFigure>,
    /// `/paths` has every front up to the end.
    pub paths_complete: bool,
    /// Where and when the bar broke; none: it was not to break, and the file has no `/ruptures`.
    pub ruptures: Option<Vec<Rupture>>,
    /// For `/figures`.
    pub figures: Figures,
}

/// The writing end of a result file.
///
/// Every method passes its data to the writer thread; an error of that thread (a full disk, say) is returned by the
/// next call. Dropping a writer without [`Writer::finish`] flushes what it was given and leaves `outcome = "running"`.
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

/// Everything that [`Writer::finish`] writes.
#[derive(Debug)]
struct Trailer {
    outcome: String,
    fronts: Vec<FrontRow>,
    audit: Vec<AuditRow>,
    figures: RunFigures,
}

impl Writer {
    /// Starts a result file: builds it under a temporary name, gives it its final one, and starts the writing thread.
    /// Missing folders are made.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be made or replaced; an older file is then untouched.
    pub fn create(path: &Path, header: &Header, layout: &Layout, materials: &[MaterialRecord]) -> Result<Self> {
        Self::start(Sink::create(path, header, layout, materials)?, path, layout)
    }

    /// Reopens the file of an interrupted run and removes what was written after the checkpoint.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be written, or holds less than the checkpoint says.
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

    /// Where the file is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a frame; frames come in the order of time.
    pub fn frame(&mut self, frame: Frame) -> Result<()> {
        self.send(Message::Frame(frame))
    }

    /// Adds rows to the gauge at `index` of the layout.
    pub fn gauge(&mut self, index: usize, trace: Trace) -> Result<()> {
        self.send(Message::Gauge(index, trace))
    }

    /// Adds rows to the history of an end (its `strain` is not kept).
    pub fn end(&mut self, side: Side, trace: Trace) -> Result<()> {
        self.send(Message::End(side, trace))
    }

    /// Adds a row to the ledger.
    pub fn ledger(&mut self, row: LedgerRow) -> Result<()> {
        self.send(Message::Ledger(row))
    }

    /// Adds straight segments of fronts; the layout must ask for them.
    pub fn paths(&mut self, rows: Vec<PathRow>) -> Result<()> {
        self.send(Message::Paths(rows))
    }

    /// Flushes all data so far, then writes the corresponding checkpoint, with its row counts filled in.
    pub fn checkpoint(&mut self, checkpoint: Checkpoint) -> Result<()> {
        self.send(Message::Checkpoint(Box::new(checkpoint)))
    }

    /// Writes what is known only at the end, then the outcome, and closes the file.
    pub fn finish(mut self, outcome: &str, fronts: &[FrontRow], audit: &[AuditRow], figures: RunFigures) -> Result<()> {
        let ending = Trailer { outcome: outcome.into(), fronts: fronts.into(), audit: audit.into(), figures };
        self.send(Message::Finish(Box::new(ending)))?;
        self.join()
    }

    fn send(&mut self, message: Message) -> Result<()> {
        if self.sender.as_ref().is_some_and(|sender| sender.send(message).is_ok()) {
            return Ok(());
        }
        // The thread is gone, and its result says why.
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
        // Nobody is left to hear of an error here; what was flushed before it is in the file.
        let _ = self.join();
    }
}

/// The writer thread: processes messages until the end and flushes at regular intervals.
fn serve(mut sink: Sink, messages: &Receiver<Message>) -> Result<()> {
    // The first frame is on the disk at once.
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

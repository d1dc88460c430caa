//! Checkpoint of a run, in a file of its own next to the result: `OUT.h5.checkpoint`.
//!
//! It is written under a temporary name and renamed, after the rows that it refers to have been flushed. Whenever a run
//! is killed, the checkpoint is therefore complete, and the result file contains at least the rows that it refers to.
//! It is removed when the run ends.
//!
//! The file starts with two lines of text, `barwave checkpoint <version>` and the program that wrote it. A checksum of
//! these lines and the state (CRC-32, 4 bytes, least significant first) and the state follow.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::destination::log_written;
use crate::error::{Error, InputError, Result};
use crate::record::PathRow;
use crate::snapshot::{pack, unpack};

/// Version of the file's layout and of every state in it.
const VERSION: u32 = 24;

/// Start of the first line.
const START: &str = "barwave checkpoint ";

/// Size of the checksum, bytes.
const CHECKSUM: usize = 4;

/// Numbers of rows of the growing tables of a result file.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rows {
    /// Rows of the fields and their times.
    pub frames: usize,
    /// Rows of each gauge.
    pub gauges: Vec<usize>,
    /// Rows of the histories of the left and the right end.
    pub ends: [usize; 2],
    /// Rows of the ledger.
    pub ledger: usize,
    /// Rows of the paths of fronts.
    pub paths: usize,
}

/// State of a run between two steps.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Identifier of the run in the result file; set by the writer, like the next three fields.
    pub run_id: String,
    /// Numbers of rows in the result file.
    pub rows: Rows,
    /// Paths of fronts that have not been written yet because they do not fill a whole chunk.
    pub waiting: Vec<PathRow>,
    /// Names of the links and attributes of the root of the result file.
    pub members: [Vec<String>; 2],
    /// [`checksum`] of the resolved scene.
    pub scene: u32,
    /// True if the run was to estimate its error.
    pub estimate_error: bool,
    /// Wall time between two checkpoints, s.
    pub every: f64,
    /// Wall time of the run so far, s.
    pub wall_seconds: f64,
    /// Effects and method that the program chose, serialized.
    pub chosen: Vec<u8>,
    /// State of the solver and of all recorders, serialized.
    pub state: Vec<u8>,
}

/// Returns the CRC-32 of a text.
pub fn checksum(text: &str) -> u32 {
    crc32fast::hash(text.as_bytes())
}

/// Returns the path of the checkpoint of a result file.
pub fn path_of(output: &Path) -> PathBuf {
    beside(output, "", ".checkpoint")
}

fn temporary(output: &Path) -> PathBuf {
    beside(output, ".", ".checkpoint.tmp")
}

fn beside(output: &Path, before: &str, after: &str) -> PathBuf {
    let mut name = std::ffi::OsString::from(before);
    name.push(output.file_name().unwrap_or_default());
    name.push(after);
    output.with_file_name(name)
}

/// Removes the checkpoint of a result file, and an incomplete one.
pub fn remove(output: &Path) {
    for path in [path_of(output), temporary(output)] {
        // Neither file needs to exist.
        let _ = std::fs::remove_file(path);
    }
}

/// Returns the program with its version and, if known, its commit.
fn program() -> String {
    let revision = super::git_revision().map(|revision| format!(" ({revision})")).unwrap_or_default();
    format!("barwave {}{revision}", env!("CARGO_PKG_VERSION"))
}

impl Checkpoint {
    /// Replaces the checkpoint of a result file.
    pub(super) fn write(&self, output: &Path) -> Result<()> {
        let (path, temporary) = (path_of(output), temporary(output));
        let failed = |e: &dyn std::fmt::Display| {
            Error::file(&path, format!("cannot write the checkpoint: {e}; the previous one is kept"))
        };
        let state = pack(self).map_err(|e| failed(&e))?;
        let head = format!("{START}{VERSION}\n{}\n", program());
        let sum = checksum_of(&head, &state).to_le_bytes();
        let mut file = File::create(&temporary).map_err(|e| failed(&e))?;
        let written = [head.as_bytes(), &sum, &state].into_iter().try_for_each(|part| file.write_all(part));
        written.and_then(|()| std::fs::rename(&temporary, &path)).map_err(|e| {
            let _ = std::fs::remove_file(&temporary);
            failed(&e)
        })?;
        log_written(&path, head.len() + sum.len() + state.len());
        Ok(())
    }

    /// Reads the checkpoint of a result file; returns `None` if there is none.
    ///
    /// # Errors
    /// An [`InputError`] if it is damaged, or from another version of the program.
    pub fn read(output: &Path) -> Result<Option<Self>> {
        let path = path_of(output);
        match std::fs::read(&path) {
            Ok(bytes) => Self::from_bytes(&bytes, &path).map(Some),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(e) => Err(Error::file(&path, e)),
        }
    }

    fn from_bytes(bytes: &[u8], path: &Path) -> Result<Self> {
        let damaged = || wrong(path, "the checkpoint is damaged");
        let mut lines = bytes.splitn(3, |&byte| byte == b'\n');
        let mut line = || lines.next().and_then(|line| std::str::from_utf8(line).ok()).ok_or_else(damaged);
        let (first, written_by) = (line()?, line()?);
        let version: u32 = first.strip_prefix(START).and_then(|version| version.parse().ok()).ok_or_else(damaged)?;
        if version != VERSION {
            let message = format!("the checkpoint has version {version}; this program reads version {VERSION}");
            return Err(wrong(path, &message).into());
        }
        let head = format!("{first}\n{written_by}\n");
        let (sum, state) =
            bytes.get(head.len()..).and_then(<[u8]>::split_first_chunk::<CHECKSUM>).ok_or_else(damaged)?;
        if u32::from_le_bytes(*sum) != checksum_of(&head, state) {
            return Err(damaged().into());
        }
        if written_by != program() {
            let message = format!("the checkpoint was written by {written_by}; this is {}", program());
            return Err(wrong(path, &message).into());
        }
        unpack(state).map_err(|_| damaged().into())
    }
}

fn checksum_of(head: &str, state: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(head.as_bytes());
    hasher.update(state);
    hasher.finalize()
}

fn wrong(path: &Path, message: &str) -> InputError {
    let help = "resume with the program that wrote it, or run the scene again; the frames so far can be read";
    InputError::new(format!("{}: {message}", path.display())).help(help)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(bytes: &[u8]) -> String {
        Checkpoint::from_bytes(bytes, Path::new("a.h5.checkpoint")).expect_err("refused").to_string()
    }

    #[test]
    fn a_checkpoint_comes_back_and_damage_is_found() {
        let folder = tempfile::tempdir().expect("a folder");
        let output = folder.path().join("a.h5");
        assert_eq!(Checkpoint::read(&output).expect("none is no error"), None);
        let rows = Rows { frames: 3, gauges: vec![7, 7], ends: [7, 7], ledger: 3, paths: 9 };
        let checkpoint = Checkpoint { rows, every: 0.1, state: vec![1, 2, 3], ..Checkpoint::default() };
        checkpoint.write(&output).expect("written");
        assert_eq!(Checkpoint::read(&output).expect("whole"), Some(checkpoint));
        let bytes = std::fs::read(path_of(&output)).expect("bytes");
        assert!(!temporary(&output).exists());
        for at in [0, 25, 30, bytes.len() - 1] {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1;
            assert!(message(&damaged).contains("damaged"), "byte {at}");
        }
        for length in [0, 10, 30, bytes.len() - 1] {
            assert!(message(&bytes[..length]).contains("damaged"), "{length} bytes");
        }
        assert!(message(&[&bytes[..], b" "].concat()).contains("damaged"));
        let later = String::from_utf8_lossy(&bytes[..bytes.len().min(19)]) + "99\n";
        assert!(message(&[later.as_bytes(), &bytes[21..]].concat()).contains("version 99"));
        remove(&output);
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }

    #[test]
    fn a_checkpoint_of_another_program_is_refused() {
        let (head, state) =
            (format!("{START}{VERSION}\nbarwave 0.0.1\n"), pack(&Checkpoint::default()).expect("packed"));
        let sum = checksum_of(&head, &state).to_le_bytes();
        let refused = message(&[head.as_bytes(), &sum, &state].concat());
        assert!(refused.contains("written by barwave 0.0.1; this is barwave"), "{refused}");
    }
}

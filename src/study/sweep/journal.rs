//! The folder of a sweep: `sweep.json` with its plan, and `rows.jsonl`, to which a row is appended when a case ends.
//!
//! If a sweep is killed, all rows written so far remain. The last line may be incomplete and is then dropped.

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::metrics::{Row, Status};
use super::plan::Plan;
use super::shard::Shard;
use crate::destination::{self, write_whole};
use crate::error::{Error, InputError, Result};

/// File names in the folder.
const PLAN: &str = "sweep.json";
const ROWS: &str = "rows.jsonl";

/// Content of `sweep.json`.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Begun {
    plan: Plan,
    shard: [usize; 2],
}

/// The file of rows, open for appending.
#[derive(Debug)]
pub(super) struct Journal {
    rows: File,
    path: PathBuf,
}

impl Drop for Journal {
    /// Releases the lock. A child process that was forked in the meantime would otherwise hold it until it executes its program.
    fn drop(&mut self) {
        let _ = self.rows.unlock();
    }
}

impl Journal {
    /// Returns whether a folder contains a sweep.
    pub fn is_in(folder: &Path) -> bool {
        folder.join(PLAN).exists()
    }

    /// Returns whether the sweep in a folder has started its cases.
    pub fn has_rows(folder: &Path) -> bool {
        folder.join(ROWS).exists()
    }

    /// Starts a sweep in a folder, which is created if it does not exist.
    ///
    /// # Errors
    /// An [`InputError`] if the folder already contains a sweep of which a case was accepted, contains another file of the same name, or is used by
    /// another sweep; a file error.
    pub fn begin(folder: &Path, plan: &Plan, shard: Shard) -> Result<Self> {
        destination::folder_at(folder)?;
        if Self::has_rows(folder) && !Self::all_refused(folder) {
            let message = format!("the folder {} already contains a sweep", folder.display());
            let help = "continue it, or choose another folder";
            return Err(InputError::new(message).key("resume").help(help).into());
        }
        let path = folder.join(PLAN);
        if path.exists() && Self::plan(folder).is_err() {
            let message = format!("{} already exists and is not the plan of a sweep", path.display());
            let help = "choose another folder, or move that file away";
            return Err(InputError::new(message).key("folder").help(help).into());
        }
        let begun = Begun { plan: plan.clone(), shard: [shard.index, shard.count] };
        let json = serde_json::to_string_pretty(&begun).map_err(|e| Error::file(&path, e))?;
        write_whole(&path, (json + "\n").as_bytes())?;
        let journal = Self::open(folder)?;
        journal.rows.set_len(0).map_err(|e| Error::file(&journal.path, e))?;
        Ok(journal)
    }

    /// Returns whether a sweep has rows and all of them are refused cases, so that it can be replaced without loss.
    fn all_refused(folder: &Path) -> bool {
        Self::rows(folder).is_ok_and(|rows| !rows.is_empty() && rows.iter().all(|row| row.status == Status::Refused))
    }

    /// Removes the files of a sweep from a folder, and the folder if it is then empty.
    pub fn remove(self, folder: &Path) {
        drop(self);
        for name in [PLAN, ROWS] {
            // Files that cannot be removed are left in place.
            let _ = std::fs::remove_file(folder.join(name));
        }
        let _ = std::fs::remove_dir(folder);
    }

    /// Continues a sweep in a folder. Returns the journal and the existing rows.
    ///
    /// # Errors
    /// An [`InputError`] if the folder contains no sweep, or another one.
    pub fn resume(folder: &Path, plan: &Plan, shard: Shard) -> Result<(Self, Vec<Row>)> {
        let (begun, of) = Self::plan(folder)?;
        if begun != *plan || of != shard {
            let message = format!("the folder {} contains another sweep", folder.display());
            let help = "resume with the files and the shard that it was started with, or choose another folder";
            return Err(InputError::new(message).key("resume").help(help).into());
        }
        let mut journal = Self::open(folder)?;
        let rows = journal.complete_rows()?;
        Ok((journal, rows))
    }

    fn open(folder: &Path) -> Result<Self> {
        let path = folder.join(ROWS);
        let opened = OpenOptions::new().create(true).read(true).append(true).open(&path);
        let rows = opened.map_err(|e| Error::file(&path, e))?;
        if rows.try_lock().is_err() {
            let message = format!("another sweep is writing to {}", folder.display());
            let help = "wait until it has ended, or choose another folder";
            return Err(InputError::new(message).key("folder").help(help).into());
        }
        Ok(Self { rows, path })
    }

    /// Reads the plan and the shard in a folder.
    pub fn plan(folder: &Path) -> Result<(Plan, Shard)> {
        let path = folder.join(PLAN);
        let wrong = |what: &str| {
            let help = "give a folder that `barwave sweep` wrote";
            InputError::new(format!("{} {what}", folder.display())).help(help)
        };
        let text = std::fs::read_to_string(&path).map_err(|_| wrong("contains no sweep (sweep.json is missing)"))?;
        let begun: Begun =
            serde_json::from_str(&text).map_err(|e| wrong(&format!("contains a damaged sweep.json: {e}")))?;
        let [index, count] = begun.shard;
        Ok((begun.plan, Shard { index, count }))
    }

    /// Reads the rows in a folder.
    pub fn rows(folder: &Path) -> Result<Vec<Row>> {
        let path = folder.join(ROWS);
        let text = std::fs::read_to_string(&path).map_err(|e| Error::file(&path, e))?;
        rows(&text, &path).map(|read| read.0)
    }

    /// Reads the rows written so far and removes an incomplete last line from the file.
    fn complete_rows(&mut self) -> Result<Vec<Row>> {
        let file = |e| Error::file(&self.path, e);
        let mut text = String::new();
        self.rows.rewind().map_err(file)?;
        self.rows.read_to_string(&mut text).map_err(file)?;
        let (rows, whole) = rows(&text, &self.path)?;
        self.rows.set_len(whole as u64).map_err(file)?;
        Ok(rows)
    }

    /// Appends a row, given as a line of JSON, in one write.
    pub fn add(&mut self, line: &str) -> Result<()> {
        self.rows.write_all(format!("{line}\n").as_bytes()).map_err(|e| Error::file(&self.path, e))
    }
}

/// Returns the rows of all complete lines, and the number of bytes of these lines.
fn rows(text: &str, path: &Path) -> Result<(Vec<Row>, usize)> {
    let whole = text.rfind('\n').map_or(0, |end| end + 1);
    let row = |(k, line): (usize, &str)| {
        serde_json::from_str(line).map_err(|e| {
            let message = format!("{}:{}: a damaged row: {e}", path.display(), k + 1);
            Error::from(InputError::new(message).help("delete that line and resume the sweep: its case is run again"))
        })
    };
    let rows = text[..whole].lines().enumerate().map(row).collect::<Result<_>>()?;
    Ok((rows, whole))
}

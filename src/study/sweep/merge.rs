//! Merges the shards of a sweep into one table.

use std::path::{Path, PathBuf};

use super::journal::Journal;
use super::metrics::Row;
use super::table::write_tables;
use crate::destination;
use crate::error::{Error, InputError, Result};
use crate::text_file;

/// Number of missing cases that are listed.
const NAMED: usize = 10;

/// Merges the rows in folders of one sweep, or of the shards inside them, into `output` and the CSV table beside it. Returns the number of rows.
/// Existing files are replaced, see [`super::check_tables`].
///
/// # Errors
/// An [`InputError`] if folders contain no sweep or different ones; [`Error::Checks`] if cases are missing, unless `partial`.
pub fn merge(folders: &[PathBuf], output: &Path, partial: bool) -> Result<usize> {
    let mut all = Vec::new();
    for folder in folders {
        all.extend(sweeps_in(folder)?);
    }
    let (plan, _) = Journal::plan(&all[0])?;
    let mut rows: Vec<Row> = Vec::new();
    for folder in &all {
        if Journal::plan(folder)?.0 != plan {
            let message = format!("{} and {} contain different sweeps", all[0].display(), folder.display());
            return Err(InputError::new(message)
                .help("merge shards that were run from the same files by the same program")
                .into());
        }
        rows.extend(Journal::rows(folder)?);
    }
    rows.sort_by_key(|row| row.case);
    rows.dedup_by_key(|row| row.case);
    let mut have = rows.iter().map(|row| row.case).peekable();
    let missing: Vec<usize> = (0..plan.cases()).filter(|case| have.next_if_eq(case).is_none()).collect();
    if !missing.is_empty() && !partial {
        return Err(Error::Checks(describe(&missing, plan.cases())));
    }
    destination::make_folder(output)?;
    write_tables(&output.with_extension("csv"), output, &plan, &rows)?;
    Ok(rows.len())
}

/// Returns the folder itself, or those of the shards inside it.
fn sweeps_in(folder: &Path) -> Result<Vec<PathBuf>> {
    if Journal::is_in(folder) {
        return Ok(vec![folder.to_owned()]);
    }
    let entries = std::fs::read_dir(folder).map_err(|e| {
        InputError::new(format!("cannot read the folder `{}`: {}", folder.display(), text_file::plain_reason(&e)))
            .help("give the folders that `barwave sweep` wrote")
    })?;
    let mut inside: Vec<PathBuf> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| Journal::is_in(path)).collect();
    inside.sort();
    if inside.is_empty() {
        // Returns the error that the folder contains no sweep.
        Journal::plan(folder)?;
    }
    Ok(inside)
}

fn describe(missing: &[usize], cases: usize) -> String {
    let named: Vec<String> = missing.iter().take(NAMED).map(ToString::to_string).collect();
    let more = if missing.len() > NAMED { ", ..." } else { "" };
    format!(
        "{} of {cases} cases are missing: {}{more}; run their shards with --resume, or merge without them with --partial",
        missing.len(),
        named.join(", ")
    )
}

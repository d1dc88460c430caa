//! Registry of the files that a command has read: scenes, materials, records, histories, results. They are read deep inside checks, and no output
//! may replace them; see [`crate::destination::resolve`].

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

static READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Registers an input, so that no output can replace it.
pub fn protect(input: &Path) {
    if let (Ok(path), Ok(mut read)) = (input.canonicalize(), READ.lock()) {
        read.insert(path);
    }
}

/// Whether this file has been read.
pub fn is_protected(path: &Path) -> bool {
    path.canonicalize().is_ok_and(|path| READ.lock().is_ok_and(|read| read.contains(&path)))
}

//! Check of an existing file at the path of a new result file.

use std::path::Path;

use super::attributes::{FORMAT, get_text};
use super::shared::{NotOpened, SharedFile};
use super::sweep::SWEEP_FORMAT;
use crate::destination;
use crate::error::InputError;
use crate::text_file::{HDF5_SIGNATURE, signature};

/// Contents of a path before a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Existing {
    /// No file, or an empty one.
    Nothing,
    /// File of the format to be written, complete or not.
    Own,
    /// File that another process is writing.
    InUse,
    /// Any other file, or one that can no longer be read.
    Other,
}

/// Refuses a path at which a run would replace anything but a result; with `force` any other file may be replaced.
///
/// # Errors
/// An [`InputError`] if another run is writing the file, if it is not a result, or if [`destination::resolve`] refuses the path.
pub fn check_output(path: &Path, force: bool) -> Result<(), InputError> {
    check(path, FORMAT, "a result file", force)
}

/// Refuses a path at which the table of a sweep would replace anything but such a table; `force` as in [`check_output`].
///
/// # Errors
/// As for [`check_output`].
pub fn check_table(path: &Path, force: bool) -> Result<(), InputError> {
    check(path, SWEEP_FORMAT, "the table of a sweep", force)
}

fn check(path: &Path, format: &str, what: &str, force: bool) -> Result<(), InputError> {
    let refuse = |what: &str, help: &str| {
        Err(InputError::new(format!("the output {} {what}", path.display()))
            .help(format!("choose another name, or {help}")))
    };
    match existing(&destination::resolve(path)?, format) {
        Existing::InUse => refuse("is being written by another run", "wait until that run has ended"),
        Existing::Other if !force => refuse(&format!("already exists and is not {what}"), "move that file away"),
        Existing::Other | Existing::Nothing | Existing::Own => Ok(()),
    }
}

/// Returns the contents of a path, given the expected value of `format`.
fn existing(path: &Path, format: &str) -> Existing {
    if !path.exists() {
        return Existing::Nothing;
    }
    super::recover(path);
    match signature(path) {
        Ok(start) if start.is_empty() => Existing::Nothing,
        Ok(start) if start == HDF5_SIGNATURE => match SharedFile::open(path) {
            Ok(file) if get_text(&file, "format").is_ok_and(|own| own == format) => Existing::Own,
            Err(NotOpened::Locked) => Existing::InUse,
            _ => Existing::Other,
        },
        _ => Existing::Other,
    }
}

//! Where files may be written: never in place of a folder, a device, a named pipe or a socket.

use std::path::{Path, PathBuf};

use crate::error::{Error, InputError};
use crate::text_file::special;

/// The file that a path stands for: what a symbolic link points to, otherwise the path itself.
///
/// # Errors
/// What stands there and must not be replaced, or a symbolic link to nothing.
pub fn resolve(path: &Path) -> Result<PathBuf, InputError> {
    let refuse =
        |what: &str, help: &str| Err(InputError::new(format!("the output {} {what}", path.display())).help(help));
    let is_link = path.symlink_metadata().is_ok_and(|m| m.is_symlink());
    let Ok(metadata) = path.metadata() else {
        return if is_link { refuse("is a broken symbolic link", "name another file") } else { Ok(path.to_owned()) };
    };
    if metadata.is_dir() {
        return refuse("is a folder", "name a file in it");
    }
    if !metadata.is_file() {
        return refuse(&format!("is a {}, which must not be replaced", special(&metadata)), "name a file");
    }
    Ok(if is_link { path.canonicalize().unwrap_or_else(|_| path.to_owned()) } else { path.to_owned() })
}

/// True of `-`, which stands for standard output.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// Makes the folder of a file, and those above it.
///
/// # Errors
/// It is missing and cannot be made.
pub fn make_folder(path: &Path) -> Result<(), Error> {
    match path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) => std::fs::create_dir_all(folder).map_err(|e| Error::file(folder, e)),
        None => Ok(()),
    }
}

//! Writing of files: never in place of a folder, a device, a named pipe, a socket or a file that was read, and either completely or not at all.

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, InputError};
use crate::inputs;
use crate::text_file::special;

/// Returns the file that a path refers to: the target of a symbolic link, otherwise the path itself.
///
/// # Errors
/// The path refers to something that must not be replaced (including an input file), or is a symbolic link to nothing.
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
    if inputs::is_protected(path) {
        return refuse("is a file that this command reads", "name another file");
    }
    Ok(if is_link { path.canonicalize().unwrap_or_else(|_| path.to_owned()) } else { path.to_owned() })
}

/// Whether the path is `-`, which stands for standard output.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// Creates the folder of a file and its missing parents.
///
/// # Errors
/// The folder is missing and cannot be created.
pub fn make_folder(path: &Path) -> Result<(), Error> {
    match path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) => folder_at(folder),
        None => Ok(()),
    }
}

/// Creates a folder and its missing parents.
///
/// # Errors
/// The folder is missing and cannot be created.
pub fn folder_at(folder: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(folder).map_err(|e| cannot_write(folder, &e))
}

/// Returns the error for a file or a folder that the system refuses to write.
pub fn cannot_write(path: &Path, error: &std::io::Error) -> Error {
    let reason = match error.kind() {
        ErrorKind::NotFound => "there is no such folder, and it cannot be made",
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => "a file stands where a folder is needed",
        ErrorKind::PermissionDenied => "permission denied",
        ErrorKind::ReadOnlyFilesystem => "the file system is read-only",
        ErrorKind::StorageFull => "no space is left on the disk",
        ErrorKind::QuotaExceeded => "the disk quota is used up",
        ErrorKind::FileTooLarge => "the file has reached the largest size allowed (ulimit -f)",
        _ => return Error::file(path, format!("cannot write it: {error}")),
    };
    let help = match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "make room there, or choose another disk",
        ErrorKind::FileTooLarge => "raise the limit, or choose a smaller output",
        _ => "choose a folder in which files may be written",
    };
    Error::File { path: path.to_owned(), reason: format!("cannot write it: {reason}"), help: help.to_owned() }
}

/// Returns the error for standard output that cannot be written.
pub fn cannot_print(error: &std::io::Error) -> Error {
    let help = "redirect the output to a file on a disk with room";
    Error::File { path: PathBuf::from("stdout"), reason: error.to_string(), help: help.to_owned() }
}

/// Writes a file under a temporary name and then renames it, so that the final name never holds an incomplete file. Missing folders are created;
/// `-` is standard output.
///
/// # Errors
/// The folder cannot be written to, or the path refers to something that must not be replaced.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    if is_stdout(path) {
        let mut stdout = std::io::stdout().lock();
        let written = stdout.write_all(bytes).and_then(|()| stdout.flush());
        // A reader that has closed the pipe is not an error.
        return written.or_else(|e| match e.kind() {
            ErrorKind::BrokenPipe => Ok(()),
            _ => Err(cannot_print(&e)),
        });
    }
    make_folder(path)?;
    let target = resolve(path)?;
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", writer_number()));
    let temporary = target.with_file_name(name);
    std::fs::write(&temporary, bytes).and_then(|()| std::fs::rename(&temporary, target)).map_err(|e| {
        // A failure to remove the temporary file is ignored: the first error is the one to report.
        let _ = std::fs::remove_file(&temporary);
        cannot_write(path, &e)
    })?;
    log_written(path, bytes.len());
    Ok(())
}

/// Returns a number that is unique among the writers of files: the process id, and a counter within the process.
pub(crate) fn writer_number() -> String {
    static WRITERS: AtomicU64 = AtomicU64::new(0);
    format!("{}-{}", std::process::id(), WRITERS.fetch_add(1, Ordering::Relaxed))
}

/// Writes a file that must not exist yet, completely or not at all; `exists` returns the error if it exists.
///
/// # Errors
/// The file exists, or it cannot be written.
pub fn write_new(path: &Path, bytes: &[u8], exists: impl Fn() -> Error) -> Result<(), Error> {
    let mut file = OpenOptions::new().write(true).create_new(true).open(path).map_err(|e| match e.kind() {
        ErrorKind::AlreadyExists => exists(),
        _ => cannot_write(path, &e),
    })?;
    file.write_all(bytes).map_err(|e| {
        // Removes the incomplete file; a failure to do so is ignored.
        let _ = std::fs::remove_file(path);
        cannot_write(path, &e)
    })?;
    log_written(path, bytes.len());
    Ok(())
}

/// Logs a written file, which `--verbose` shows.
pub fn log_written(path: &Path, bytes: usize) {
    log::info!("wrote {}: {bytes} bytes", path.display());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a folder");
        write_whole(&folder.path().join("a.txt"), b"abc").expect("it can be written");
        write_whole(&folder.path().join("no/such/b.txt"), b"abc").expect("folders are made");
        assert!(write_whole(&folder.path().join("a.txt/b.txt"), b"abc").is_err());
        let names: Vec<_> = std::fs::read_dir(folder.path()).expect("a folder").flatten().collect();
        assert_eq!(names.len(), 2, "a.txt and the folder: {names:?}");
    }
}

//! Exclusive use of the path and the disk space of a result file: checks that the file is still at its path, and reserves space before it is used.
//!
//! HDF5 cannot undo a write that fails half-way: a full disk would leave an unreadable file. The file is therefore
//! extended before anything is written to it. If this fails, everything written before remains intact.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};

use super::checkpoint;
use crate::destination;
use crate::error::{Error, Result};

/// Bytes reserved for the metadata of HDF5 and for the end of a run.
const SPARE: u64 = 1 << 20;
/// Bytes by which the file is extended beyond what is needed immediately.
const STEP: u64 = 4 << 20;

/// Error message for a run whose file has been moved or removed.
pub(super) const GONE: &str = "the result file was removed, moved or replaced during the run";

/// Builds a file next to its final place, then moves it there. Missing folders are created.
pub(super) fn in_place(path: &Path, build: impl Fn(&hdf5::File) -> hdf5::Result<()>) -> Result<Claim> {
    let path = &destination::resolve(path)?;
    destination::make_folder(path)?;
    let temporary = temporary_name(path)?;
    // The operating system states more clearly than the HDF5 library why a file cannot be created.
    File::create(&temporary).map_err(|e| destination::cannot_write(path, &e))?;
    let room = Claim::new(&temporary, path).map_err(|e| Error::file(path, e)).and_then(|mut claim| claim.reserve(0, 0));
    let built = room
        .and_then(|()| {
            create(&temporary)
                .and_then(|file| build(&file).and_then(|()| file.close()))
                .map_err(|e| Error::file(path, e))
        })
        .and_then(|()| Claim::new(&temporary, path).map_err(|e| Error::file(path, e)))
        .and_then(|claim| {
            // The checkpoint of an older result must not remain next to the new one.
            checkpoint::remove(path);
            std::fs::rename(&temporary, path).map(|()| claim).map_err(|e| Error::file(path, e))
        });
    if built.is_ok() {
        log::info!("writing {}", path.display());
        super::remove_journal(path);
        remove_unnamed(path);
    } else {
        // The file may never have been created; only the error that is returned matters.
        let _ = std::fs::remove_file(&temporary);
    }
    built
}

/// Creates an HDF5 file without the library's lock. No other process knows its name, and a child process that is forked
/// while the file is open would hold the lock after it is closed.
fn create(path: &Path) -> hdf5::Result<hdf5::File> {
    hdf5::File::with_options().with_fapl(|access| access.file_locking(false)).create(path)
}

/// Removes temporary files of runs with this output path that were killed before the files got their final name.
pub(super) fn remove_unnamed(path: &Path) {
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else { return };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let start = format!(".{}.", name.to_string_lossy());
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let found = entry.file_name().to_string_lossy().into_owned();
        let writer = found.strip_prefix(&start).and_then(|rest| rest.strip_suffix(".tmp"));
        let process = writer.and_then(|writer| writer.split('-').next());
        if process.is_some_and(|id| id.parse::<u32>().is_ok() && has_ended(id)) {
            // It does not matter which process removes the file first.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Returns true if no such process is running; false if unknown.
fn has_ended(process: &str) -> bool {
    let processes = Path::new("/proc");
    processes.join("self").exists() && !processes.join(process).exists()
}

/// Returns the name `.NAME.<pid>-<n>.tmp` in the folder of the final file, so that the move is a single step on the same disk.
fn temporary_name(path: &Path) -> Result<PathBuf> {
    let name = path.file_name().ok_or_else(|| Error::file(path, "a result needs a file name"))?;
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.tmp", destination::writer_number()));
    Ok(path.with_file_name(temporary))
}

/// File, and the length up to which disk space is reserved for it.
#[derive(Debug)]
pub(super) struct Claim {
    path: PathBuf,
    file: File,
    reserved: u64,
}

impl Claim {
    /// Creates the claim of a file that has just been created at `temporary` and will be moved to `path`.
    pub fn new(temporary: &Path, path: &Path) -> std::io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).open(temporary)?;
        Ok(Self { path: path.to_owned(), file, reserved: 0 })
    }

    /// Returns a second claim of the same file.
    pub fn share(&self) -> hdf5::Result<Self> {
        let file = self.file.try_clone().map_err(|e| hdf5::Error::from(e.to_string().as_str()))?;
        Ok(Self { path: self.path.clone(), file, reserved: self.reserved })
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Checks that the file is still at its path.
    ///
    /// # Errors
    /// [`Error::File`] if the file has been removed or replaced, alone or with its folder.
    pub fn holds(&self) -> Result<()> {
        let here = std::fs::metadata(&self.path).ok().zip(self.file.metadata().ok());
        if here.is_some_and(|(found, own)| same_file(&found, &own)) {
            return Ok(());
        }
        Err(Error::file(&self.path, GONE))
    }

    /// Reserves space for `bytes` after the first `used` bytes, and a margin.
    ///
    /// # Errors
    /// [`Error::File`] if the disk is full, or the file must not grow that far.
    pub fn reserve(&mut self, used: u64, bytes: u64) -> Result<()> {
        let needed = used + bytes + SPARE;
        if needed <= self.reserved {
            return Ok(());
        }
        let more = needed + STEP;
        let grown =
            allocate(&self.file, more).map(|()| more).or_else(|_| allocate(&self.file, needed).map(|()| needed));
        self.reserved =
            grown.map_err(|e| Error::File { path: self.path.clone(), reason: full(&e), help: ROOM.to_owned() })?;
        Ok(())
    }

    /// Releases the space after the first `used` bytes.
    pub fn release(&self, used: u64) {
        // A file that remains longer than its contents can be read all the same.
        let _ = self.file.set_len(used);
    }
}

/// Help for an error when the file cannot grow.
const ROOM: &str = "make room there, name a file on another disk, or record fewer frames, fields or cells";

fn full(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::StorageFull => "the disk is full".into(),
        std::io::ErrorKind::QuotaExceeded => "the disk quota is used up".into(),
        std::io::ErrorKind::FileTooLarge => "the file has reached the largest size allowed (ulimit -f)".into(),
        _ => error.to_string(),
    }
}

/// Allocates a file of this length on the disk. File systems without this function report no error; a full disk is then detected by the write.
#[cfg(target_os = "linux")]
fn allocate(file: &File, length: u64) -> std::io::Result<()> {
    use rustix::fs::{FallocateFlags, fallocate};
    use rustix::io::Errno;
    match fallocate(file, FallocateFlags::empty(), 0, length) {
        Err(e @ (Errno::NOSPC | Errno::FBIG | Errno::DQUOT)) => Err(e.into()),
        _ => Ok(()),
    }
}

#[cfg(not(target_os = "linux"))]
fn allocate(_: &File, _: u64) -> std::io::Result<()> {
    Ok(())
}

#[cfg(unix)]
fn same_file(a: &std::fs::Metadata, b: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

#[cfg(not(unix))]
fn same_file(_: &std::fs::Metadata, _: &std::fs::Metadata) -> bool {
    true
}

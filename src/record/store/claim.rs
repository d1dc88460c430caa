//! Exclusive use of the path and disk space of a result file: whether the file is still at its path, and space reserved before it
//! is used.
//!
//! HDF5 cannot undo a write that fails half-way: a full disk would leave a file that cannot be read. So the file is made longer before
//! anything is written to it. Where that fails, everything written before is whole.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};

use super::checkpoint;
use crate::destination;
use crate::error::{Error, Result};

/// Bytes reserved for the tables of HDF5 itself and for the end of a run.
const SPARE: u64 = 1 << 20;
/// Bytes by which the file grows beyond what is needed at once.
const STEP: u64 = 4 << 20;

/// Message for a run whose file has been moved or removed.
pub(super) const GONE: &str = "the result file was removed, moved or replaced during the run";

/// Has a file built beside its final place, then moves it there. Missing folders are made.
pub(super) fn in_place(path: &Path, build: impl Fn(&hdf5::File) -> hdf5::Result<()>) -> Result<Claim> {
    let path = &destination::resolve(path)?;
    destination::make_folder(path)?;
    let temporary = temporary_name(path)?;
    // The system says more plainly than the HDF5 library why a file cannot be made.
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
            // The checkpoint of an older result never stands beside the new one.
            checkpoint::remove(path);
            std::fs::rename(&temporary, path).map(|()| claim).map_err(|e| Error::file(path, e))
        });
    if built.is_ok() {
        log::info!("writing {}", path.display());
        super::remove_journal(path);
        remove_unnamed(path);
    } else {
        // It may never have been made; the error that counts is the one that is returned.
        let _ = std::fs::remove_file(&temporary);
    }
    built
}

/// A new HDF5 file without the library's lock: no other process knows its name, and a child process that is forked while the file is open
/// would hold the lock beyond its closing.
fn create(path: &Path) -> hdf5::Result<hdf5::File> {
    hdf5::File::with_options().with_fapl(|access| access.file_locking(false)).create(path)
}

/// Removes files of runs to this path that were killed before they gave them their final name.
pub(super) fn remove_unnamed(path: &Path) {
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else { return };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let start = format!(".{}.", name.to_string_lossy());
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let found = entry.file_name().to_string_lossy().into_owned();
        let writer = found.strip_prefix(&start).and_then(|rest| rest.strip_suffix(".tmp"));
        let process = writer.and_then(|writer| writer.split('-').next());
        if process.is_some_and(|id| id.parse::<u32>().is_ok() && has_ended(id)) {
            // Whoever removes it first is right.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// True if no such process is running; false if unknown.
fn has_ended(process: &str) -> bool {
    let processes = Path::new("/proc");
    processes.join("self").exists() && !processes.join(process).exists()
}

/// `.NAME.<pid>-<n>.tmp` beside the final file, so that moving it is one step on the same disk.
fn temporary_name(path: &Path) -> Result<PathBuf> {
    let name = path.file_name().ok_or_else(|| Error::file(path, "a result needs a file name"))?;
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.tmp", destination::writer_number()));
    Ok(path.with_file_name(temporary))
}

/// The file and the length up to which the disk has room for it.
#[derive(Debug)]
pub(super) struct Claim {
    path: PathBuf,
    file: File,
    reserved: u64,
}

impl Claim {
    /// Of a file that has just been made at `temporary` and will stand at `path`.
    pub fn new(temporary: &Path, path: &Path) -> std::io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).open(temporary)?;
        Ok(Self { path: path.to_owned(), file, reserved: 0 })
    }

    /// The same once more.
    pub fn share(&self) -> hdf5::Result<Self> {
        let file = self.file.try_clone().map_err(|e| hdf5::Error::from(e.to_string().as_str()))?;
        Ok(Self { path: self.path.clone(), file, reserved: self.reserved })
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// # Errors
    /// The file has been removed or replaced, with its folder or alone.
    pub fn holds(&self) -> Result<()> {
        let here = std::fs::metadata(&self.path).ok().zip(self.file.metadata().ok());
        if here.is_some_and(|(found, own)| same_file(&found, &own)) {
            return Ok(());
        }
        Err(Error::file(&self.path, GONE))
    }

    /// Makes room for `bytes` after the first `used`, and some to spare.
    ///
    /// # Errors
    /// The disk is full, or the file may not grow as far.
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

    /// Gives back what was not used.
    pub fn release(&self, used: u64) {
        // A file that stays longer than what it holds is read all the same.
        let _ = self.file.set_len(used);
    }
}

/// What to do where the file cannot grow.
const ROOM: &str = "make room there, name a file on another disk, or record fewer frames, fields or cells";

fn full(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::StorageFull => "the disk is full".into(),
        std::io::ErrorKind::QuotaExceeded => "the disk quota is used up".into(),
        std::io::ErrorKind::FileTooLarge => "the file has reached the largest size allowed (ulimit -f)".into(),
        _ => error.to_string(),
    }
}

/// Makes a file as long as this on the disk. File systems that cannot do so say nothing: then a full disk is found by the write.
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

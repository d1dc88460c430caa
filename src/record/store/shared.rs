//! Reading of a file that other processes may be writing.

use std::ops::Deref;
use std::path::Path;

use hdf5::File;

/// File that is open for reading; while it is, no run can open it for writing.
#[derive(Debug)]
pub(super) struct SharedFile {
    file: File,
    /// Lock that replaces the one of the HDF5 library, which releases its own by closing: a child process forked while
    /// the file is open would keep that lock until it executes its program.
    lock: std::fs::File,
}

/// Reason for which a file cannot be opened.
#[derive(Debug)]
pub(super) enum NotOpened {
    /// A run is writing the file.
    Locked,
    Failed(hdf5::Error),
}

impl SharedFile {
    pub fn open(path: &Path) -> Result<Self, NotOpened> {
        let failed = |e: std::io::Error| NotOpened::Failed(e.to_string().as_str().into());
        let lock = std::fs::File::open(path).map_err(failed)?;
        // On a file system without locks the file is read without one.
        if matches!(lock.try_lock_shared(), Err(std::fs::TryLockError::WouldBlock)) {
            return Err(NotOpened::Locked);
        }
        let unlocked = File::with_options().with_fapl(|access| access.file_locking(false)).open(path);
        // A file that the same process has open with locks can be opened again only with locks.
        match unlocked.or_else(|_| File::open(path)) {
            Ok(file) => Ok(Self { file, lock }),
            Err(error) => {
                let _ = lock.unlock();
                Err(NotOpened::Failed(error))
            }
        }
    }
}

impl Deref for SharedFile {
    type Target = File;

    fn deref(&self) -> &File {
        &self.file
    }
}

impl Drop for SharedFile {
    fn drop(&mut self) {
        // An error only means that the file system has no locks.
        let _ = self.lock.unlock();
    }
}

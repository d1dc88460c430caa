//! Reading a file beside processes that may write it.

use std::ops::Deref;
use std::path::Path;

use hdf5::File;

/// A file that is open for reading; while it is, no run can open it for writing.
#[derive(Debug)]
pub(super) struct SharedFile {
    file: File,
    /// Holds the lock in place of the HDF5 library, which releases its own by closing: a child process that is forked while the file is open
    /// would keep that until it executes its program.
    lock: std::fs::File,
}

/// Why a file cannot be opened.
#[derive(Debug)]
pub(super) enum NotOpened {
    /// A run writes it.
    Locked,
    Failed(hdf5::Error),
}

impl SharedFile {
    pub fn open(path: &Path) -> Result<Self, NotOpened> {
        let failed = |e: std::io::Error| NotOpened::Failed(e.to_string().as_str().into());
        let lock = std::fs::File::open(path).map_err(failed)?;
        // A file system without locks is no reason not to read.
        if matches!(lock.try_lock_shared(), Err(std::fs::TryLockError::WouldBlock)) {
            return Err(NotOpened::Locked);
        }
        let unlocked = File::with_options().with_fapl(|access| access.file_locking(false)).open(path);
        // A file that the same process has open with locks can be opened again only with them.
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
        // Where there are no locks there is none to release.
        let _ = self.lock.unlock();
    }
}

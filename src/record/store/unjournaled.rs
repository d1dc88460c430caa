//! Files on systems without a journal, which a kill during a flush can damage.

use std::path::Path;

use hdf5::File;

/// Opens a file for reading and writing.
pub(super) fn open_rw(path: &Path) -> hdf5::Result<File> {
    // Chunks are written whole and once, so a cache would only put off their compression until the flush.
    File::with_options().with_fapl(|p| p.chunk_cache(1, 0, 1.0)).open_rw(path)
}

/// There is no journal.
pub(super) fn recover(_path: &Path) {}

/// There is no journal.
pub(super) fn remove_journal(_path: &Path) {}

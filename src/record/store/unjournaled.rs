//! Access to files on systems without the journal; a kill during a flush can damage them.

use std::path::Path;

use hdf5::File;

/// Opens a file for reading and writing.
pub(super) fn open_rw(path: &Path) -> hdf5::Result<File> {
    // Each chunk is written once and completely, so that a cache would only delay its compression until the flush.
    File::with_options().with_fapl(|p| p.chunk_cache(1, 0, 1.0)).open_rw(path)
}

/// Does nothing: there is no journal.
pub(super) fn recover(_path: &Path) {}

/// Does nothing: there is no journal.
pub(super) fn remove_journal(_path: &Path) {}

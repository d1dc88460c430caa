//! Which arguments are result files.

use std::path::Path;

/// Whether a file is a result file, by its name.
pub(super) fn is_result(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("h5") || e.eq_ignore_ascii_case("hdf5"))
}

//! Recognizes result files among the arguments.

use std::path::Path;

/// Returns true if a file is a result file, by its name.
pub(super) fn is_result(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("h5") || e.eq_ignore_ascii_case("hdf5"))
}

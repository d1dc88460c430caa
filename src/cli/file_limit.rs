//! Files that reach the size limit of the process (`ulimit -f`).

/// Makes a write beyond the limit fail with an error, as one on a full disk does. Without this, the system ends the program with SIGXFSZ, and the file
/// that was being written remains under its temporary name.
#[cfg(unix)]
#[allow(unsafe_code)]
pub(super) fn report_as_error() {
    // SAFETY: ignoring a signal installs no handler; no other thread runs yet.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}

#[cfg(not(unix))]
pub(super) fn report_as_error() {}

//! What `--verbose` shows: the program's log, as plain lines on stderr.

use log::{LevelFilter, Log, Metadata, Record};

use super::output;

/// Writes records of the program, and none of the libraries that it uses.
struct Details;

impl Log for Details {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.target().starts_with("barwave")
    }

    fn log(&self, record: &Record<'_>) {
        if self.enabled(record.metadata()) {
            output::note(&format!("{}\n", record.args()));
        }
    }

    fn flush(&self) {}
}

/// Shows the log of this process from now on.
pub(super) fn show() {
    // Where the process has a log already, that one goes on.
    if log::set_logger(&Details).is_ok() {
        log::set_max_level(LevelFilter::Info);
    }
}

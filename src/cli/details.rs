//! Output of `--verbose`: the log of the program, as plain lines on stderr.

use log::{LevelFilter, Log, Metadata, Record};

use super::output;

/// Logger that writes the records of the program, but not those of its libraries.
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

/// Enables the log of this process.
pub(super) fn show() {
    // If the process already has a logger, that one is kept.
    if log::set_logger(&Details).is_ok() {
        log::set_max_level(LevelFilter::Info);
    }
}

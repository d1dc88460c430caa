//! Ctrl-C and SIGTERM: commands poll a flag and end in an orderly way.

use super::{message, output};
use crate::error::Error;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

static STOP: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// Ends the program when the user interrupts a command that keeps nothing, and says so.
pub(super) fn nothing_kept() {
    // A handler can only be missing where another one is set already; the command then ends as that one says.
    let _ = ctrlc::set_handler(|| {
        output::remark("interrupted: nothing is kept\n");
        message::show(&Error::Interrupted);
        std::process::exit(Error::Interrupted.exit_code().into());
    });
}

/// A flag that is set when the user interrupts; shared by all runs of a command.
pub(super) fn flag() -> Arc<AtomicBool> {
    let stop = STOP.get_or_init(|| {
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        // A handler can only be missing where another one is set already; the command then ends as that one says.
        let _ = ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed));
        stop
    });
    Arc::clone(stop)
}

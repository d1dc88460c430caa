//! Ctrl-C and SIGTERM: commands poll a flag and end in an orderly way.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

static STOP: OnceLock<Arc<AtomicBool>> = OnceLock::new();

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

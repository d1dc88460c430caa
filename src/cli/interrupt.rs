//! Ctrl-C and SIGTERM: commands poll a flag and end in an orderly way.

use super::{message, output};
use crate::error::Error;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

static STOP: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// Makes an interruption end the program with a message that nothing is kept.
pub(super) fn nothing_kept() {
    // Setting a handler fails only if another one is already set; an interruption then has the effect of that handler.
    let _ = ctrlc::set_handler(|| {
        output::remark("interrupted: nothing is kept\n");
        message::show(&Error::Interrupted);
        std::process::exit(Error::Interrupted.exit_code().into());
    });
}

/// Returns the flag that an interruption sets; all runs of a command share it.
pub(super) fn flag() -> Arc<AtomicBool> {
    let stop = STOP.get_or_init(|| {
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        // Setting a handler fails only if another one is already set; an interruption then has the effect of that handler.
        let _ = ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed));
        stop
    });
    Arc::clone(stop)
}

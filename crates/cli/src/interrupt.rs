//! Ctrl-C: the work ends with what is known so far.
use std::sync::atomic::{AtomicBool, Ordering};

static ASKED_FOR: AtomicBool = AtomicBool::new(false);

/// From now on the first Ctrl-C asks the work to end; the second one ends the process.
pub(crate) fn listen() {
    // Without a handler Ctrl-C ends the process at once, as it always does.
    let _ = ctrlc::set_handler(|| {
        if ASKED_FOR.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    });
}

/// Whether the work is asked to end.
pub(crate) fn was_asked_for() -> bool {
    ASKED_FOR.load(Ordering::SeqCst)
}

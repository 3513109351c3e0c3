//! Interrupts: the first one stops a run after the current step, or within it if it is long; the second one
//! ends the process at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

/// Installs the handler; returns the flag that an interrupt (SIGINT, SIGTERM, SIGHUP; Ctrl-C) raises.
pub fn watch() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let raise = move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    ctrlc::set_handler(raise).map_err(|error| Failure::Tool(format!("cannot watch for interrupts: {error}")))?;
    Ok(stop)
}

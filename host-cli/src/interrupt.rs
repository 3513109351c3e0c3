//! Interrupts: the first one stops a run after the current step, or within it if it is long; one that comes a second later
//! or after that ends the process at once.

use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use crate::failure::Failure;

/// Time between two looks whether there is an interrupt.
const LATENCY: Duration = Duration::from_millis(50);

/// Time after the first interrupt in which others are its repetitions: `timeout` and a terminal that closes signal both a
/// process and its group.
const REPETITION: Duration = Duration::from_secs(1);

/// Installs the handler; returns the flag that an interrupt (SIGINT, SIGTERM, SIGHUP; Ctrl-C) raises.
pub fn watch() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let mut raised: Option<Instant> = None;
    let raise = move || {
        flag.store(true, Ordering::Relaxed);
        if raised.get_or_insert_with(Instant::now).elapsed() > REPETITION {
            std::process::exit(130);
        }
    };
    ctrlc::set_handler(raise).map_err(|error| Failure::Tool(format!("cannot watch for interrupts: {error}")))?;
    Ok(stop)
}

/// Does work that looks for no interrupt itself, such as to build a scene. `None` after an interrupt: then the work is
/// left behind and ends with the process, so it must change no file.
pub fn until<T: Send + 'static>(
    stop: &AtomicBool,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<Option<T>, Failure> {
    let (at_work, end) = channel::<()>();
    let working = thread::Builder::new().spawn(move || {
        // Dropped at the end of the work, also by a panic.
        let _at_work = at_work;
        work()
    });
    let working = working.map_err(|error| Failure::Tool(format!("cannot start a thread: {error}")))?;
    while !stop.load(Ordering::Relaxed) {
        if end.recv_timeout(LATENCY) == Err(RecvTimeoutError::Disconnected) {
            return Ok(Some(working.join().unwrap_or_else(|panic| resume_unwind(panic))));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_done_or_left_behind() {
        let [calm, interrupted] = [false, true].map(AtomicBool::new);
        assert_eq!(until(&calm, || 7).unwrap(), Some(7));
        // This work never ends.
        let (_held, forever) = channel::<()>();
        assert_eq!(until(&interrupted, move || forever.recv().unwrap()).unwrap(), None);
    }
}

//! The C interface of Muslin: a cooked scene in memory of the caller. `include/muslin.h` is generated from this crate.
//!
//! | file | contents |
//! |---|---|
//! | `status.rs` | the result of every call, and its words |
//! | `handle.rs` | opening a scene, and the handle that all calls take |
//! | `step.rs` | steps within a budget |
//! | `read.rs` | views of the columns, and other readouts |
//! | `live.rs` | changes between steps |
//! | `snapshot.rs` | copies of the state |
#![cfg_attr(not(feature = "std"), no_std)]

mod handle;
mod live;
mod read;
mod snapshot;
mod status;
mod step;

pub use handle::{MuslinCloth, muslin_error, muslin_open, muslin_required_bytes, muslin_version};
pub use live::*;
pub use read::*;
pub use snapshot::{muslin_go_back, muslin_snapshot, muslin_snapshot_bytes};
pub use status::{MuslinStatus, muslin_message};
pub use step::{MuslinBudget, MuslinReport, muslin_step};

/// Without an operating system nobody could read a message.
#[cfg(not(feature = "std"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

//! The same bits whatever the threads, the machine and the optimiser.
//!
//! Run: `cargo test -p muslin-tests --test determinism`. `check -- --all` runs it in three profiles: that of the tests,
//! without any optimisation, and in that of release.
//! `MUSLIN_BLESS=1` rewrites `goldens.txt` from what the core does now. A failure names the first
//! step whose state differs.

mod goldens;
mod signs;
mod threads;

//! The bits of a simulation do not depend on the threads, the machine or the optimiser.
//!
//! Run: `cargo test -p muslin-tests --test determinism`. `check -- --all` runs it in three profiles: the test
//! profile, a profile without optimisation, and the release profile.
//! `MUSLIN_BLESS=1` rewrites `goldens.txt` from the current results of the core. A failure names the first step
//! whose state differs.

mod goldens;
mod signs;
mod threads;

//! The bits of a simulation do not depend on the threads. `goldens` compares them over machines and profiles.
//!
//! Run: `cargo test -p muslin-tests --test determinism`. A failure names the first step whose state differs.

mod signs;
mod threads;

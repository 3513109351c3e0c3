//! Narrow phase: distances against brute force, times of impact against exact answers.
//!
//! Run: `cargo test -p muslin-tests --test narrow_phase`; with `-- --nocapture` it prints counts of queries,
//! hits, false hits and distances. The long fuzz tests: `-- --ignored --nocapture long_form`, or one of them:
//! `never_missed::long_form`.

mod complete;
mod distances;
mod fuzz;
mod lanes;
mod lattice;
mod local_minimum;
mod never_missed;
mod quiet;
mod tight_inclusion;
mod times;
mod truth;

//! Narrow phase: distances against brute force, times of impact against exact truth.
//!
//! Run: `cargo test -p muslin-tests --test narrow_phase`; with `-- --nocapture` it prints
//! counts of queries, hits, false hits and distances. The long fuzzes: `-- --ignored --nocapture long_form`,
//! or one of them: `never_missed::long_form`.

#[path = "narrow_phase/distances.rs"]
mod distances;
#[path = "narrow_phase/exact.rs"]
mod exact;
#[path = "narrow_phase/fuzz.rs"]
mod fuzz;
#[path = "narrow_phase/head_on.rs"]
mod head_on;
#[path = "narrow_phase/lattice.rs"]
mod lattice;
#[path = "narrow_phase/local_minimum.rs"]
mod local_minimum;
#[path = "narrow_phase/never_missed.rs"]
mod never_missed;
#[path = "narrow_phase/polynomial.rs"]
mod polynomial;
#[path = "narrow_phase/tight_inclusion.rs"]
mod tight_inclusion;
#[path = "narrow_phase/times.rs"]
mod times;
#[path = "narrow_phase/truth.rs"]
mod truth;

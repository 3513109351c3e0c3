//! Closed forms for chains, ropes, strips and falling cloth.
//!
//! Run: `cargo test -p muslin-tests --test analytic`; with `-- --nocapture` it prints the measured values
//! beside the expected ones.

mod cantilever;
mod chains;
mod falls;
mod keys;
mod loads;
mod reactions;
mod short_steps;

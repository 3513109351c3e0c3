//! Closed forms: what chains, ropes, strips and falling cloth must do.
//!
//! Run: `cargo test -p muslin-tests --test analytic`; with `-- --nocapture` it prints measured
//! beside expected.

mod cantilever;
mod chains;
mod falls;

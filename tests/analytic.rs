//! Closed forms: what chains, ropes, strips and falling cloth must do.
//!
//! Run: `cargo test -p muslin-tests --test analytic`; with `-- --nocapture` it prints measured
//! beside expected.

#[path = "analytic/cantilever.rs"]
mod cantilever;
#[path = "analytic/chains.rs"]
mod chains;
#[path = "analytic/falls.rs"]
mod falls;

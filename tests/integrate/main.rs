//! Time integration: what each method does to one oscillator, and how its error falls with the
//! step on chains and cloth.
//!
//! Run: `cargo test -p muslin-tests --test integrate`; with `-- --nocapture` it prints measured
//! beside expected. A failure names method, step, expected and measured.

mod manufactured;
mod orders;
mod oscillator;

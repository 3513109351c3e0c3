//! Time integration: the update of one oscillator by each method, and the decrease of the error with the step
//! on chains and cloth; error control.
//!
//! Run: `cargo test -p muslin-tests --test integrate`; with `-- --nocapture` it prints the measured values
//! beside the expected ones. A failure names method, step, expected and measured value.

mod error_control;
mod manufactured;
mod orders;
mod oscillator;

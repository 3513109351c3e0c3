//! Implicit steps and held vertices: the linear solve against a dense one, Newton's method, pins, momentum, and
//! the report of a divergence.
//!
//! Run: `cargo test -p muslin-tests --test solver`; with `-- --nocapture` it prints the worst error of every
//! comparison beside its bound.

mod divergence;
mod linear;
mod momentum;
mod newton;
mod pins;
mod preconditioner;

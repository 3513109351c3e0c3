//! Implicit steps and held vertices: the linear solve against a dense one, Newton's method, pins,
//! momentum, and what a divergence reports.
//!
//! Run: `cargo test -p muslin-tests --test solver`; with `-- --nocapture` it prints the worst
//! error of every comparison beside its bound.

#[path = "solver/divergence.rs"]
mod divergence;
#[path = "solver/linear.rs"]
mod linear;
#[path = "solver/momentum.rs"]
mod momentum;
#[path = "solver/newton.rs"]
mod newton;
#[path = "solver/pins.rs"]
mod pins;
#[path = "solver/preconditioner.rs"]
mod preconditioner;

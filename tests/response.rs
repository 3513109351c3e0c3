//! What contact does: friction, momentum and energy, that nothing passes through anything, and that
//! too little room loses nothing.
//!
//! Run: `cargo test --release -p muslin-tests --test response`; with `-- --nocapture` it prints
//! every measured value beside its bound.

#![expect(clippy::useless_conversion, reason = "conversions to double, of doubles")]

#[path = "response/capacity.rs"]
mod capacity;
#[path = "response/cone.rs"]
mod cone;
#[path = "response/constraint.rs"]
mod constraint;
#[path = "response/coupling.rs"]
mod coupling;
#[path = "response/friction.rs"]
mod friction;
#[path = "response/impact.rs"]
mod impact;
#[path = "response/momentum.rs"]
mod momentum;
#[path = "response/refusal.rs"]
mod refusal;
#[path = "response/safety.rs"]
mod safety;
#[path = "response/stretch.rs"]
mod stretch;
#[path = "response/zone.rs"]
mod zone;

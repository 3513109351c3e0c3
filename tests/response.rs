//! What contact does: friction, momentum and energy, that nothing passes through anything, and that
//! too little room loses nothing.
//!
//! Run: `cargo test -p muslin-tests --test response`; with `-- --nocapture` it prints
//! every measured value beside its bound.

#![expect(clippy::useless_conversion, reason = "conversions to double, of doubles")]

#[path = "response/afresh.rs"]
mod afresh;
#[path = "response/belt.rs"]
mod belt;
#[path = "response/capacity.rs"]
mod capacity;
#[path = "response/cone.rs"]
mod cone;
#[path = "response/constraint.rs"]
mod constraint;
#[path = "response/coupling.rs"]
mod coupling;
#[path = "response/exact.rs"]
mod exact;
#[path = "response/friction.rs"]
mod friction;
#[path = "response/hands.rs"]
mod hands;
#[path = "response/impact.rs"]
mod impact;
#[path = "response/last_resort.rs"]
mod last_resort;
#[path = "response/momentum.rs"]
mod momentum;
#[path = "response/refusal.rs"]
mod refusal;
#[path = "response/safety.rs"]
mod safety;
#[path = "response/sliding.rs"]
mod sliding;
#[path = "response/stretch.rs"]
mod stretch;
#[path = "response/zone.rs"]
mod zone;

/// What most of the sheets here are of.
const CLOTH: &str = r#"
    density = 0.2
    stretch = { model = "membrane", stiffness = 1000.0, damping = 0.0005 }
    shear = { stiffness = 300.0 }
    bend = { model = "hinge", rigidity = 1e-5, damping = 0.001 }
"#;

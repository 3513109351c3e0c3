//! What contact does: friction, momentum and energy, that nothing passes through anything, and that
//! too little room loses nothing.
//!
//! Run: `cargo test -p muslin-tests --test response`; with `-- --nocapture` it prints
//! every measured value beside its bound.

#![expect(clippy::useless_conversion, reason = "conversions to double, of doubles")]

mod afresh;
mod belt;
mod capacity;
mod cone;
mod constraint;
mod coupling;
mod default_integrator;
mod exact;
mod friction;
mod hands;
mod impact;
mod last_resort;
mod momentum;
mod refusal;
mod safety;
mod sliding;
mod stretch;
mod turning;
mod zone;

/// What most of the sheets here are of.
const CLOTH: &str = r#"
    density = 0.2
    stretch = { model = "membrane", stiffness = 1000.0, damping = 0.0005 }
    shear = { stiffness = 300.0 }
    bend = { model = "hinge", rigidity = 1e-5, damping = 0.001 }
"#;

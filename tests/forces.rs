//! Forces: every term against its energy, its Jacobian against its force, and the closed forms
//! that sheets obey.
//!
//! Run: `cargo test -p muslin-tests --test forces`; with `-- --nocapture` it prints the worst
//! error of every comparison beside its bound. A failure names the element with all its numbers,
//! the worst component and both values.

#[path = "forces/assembly.rs"]
mod assembly;
#[path = "forces/derivatives.rs"]
mod derivatives;
#[path = "forces/dissipation.rs"]
mod dissipation;
#[path = "forces/invariance.rs"]
mod invariance;
#[path = "forces/moduli.rs"]
mod moduli;
#[path = "forces/patch.rs"]
mod patch;
#[path = "forces/projection.rs"]
mod projection;

//! Forces: every term against its energy, its Jacobian against its force, and the closed forms for sheets.
//!
//! Run: `cargo test -p muslin-tests --test forces`; with `-- --nocapture` it prints the worst error of every
//! comparison beside its bound. A failure names the element with all its numbers, the worst component and both
//! values.

mod assembly;
mod derivatives;
mod dissipation;
mod invariance;
mod moduli;
mod patch;
mod projection;

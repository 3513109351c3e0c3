//! Start states with crossings, and what untangling makes of them: in both precisions.
//!
//! Run: `cargo test -p muslin-tests --test untangle`; with `-- --nocapture` it prints what
//! each case took.

#![expect(clippy::useless_conversion, reason = "conversions to double, of doubles")]

#[path = "untangle/cases.rs"]
mod cases;
#[path = "untangle/contour.rs"]
mod contour;
#[path = "untangle/tangles.rs"]
mod tangles;

//! Start states with crossings, and what untangling makes of them: in both precisions.
//!
//! Run: `cargo test -p muslin-tests --test untangle`; with `-- --nocapture` it prints what
//! each case took.

#![expect(clippy::useless_conversion, reason = "conversions to double, of doubles")]

mod cases;
mod contour;
mod tangles;

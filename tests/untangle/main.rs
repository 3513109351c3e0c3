//! Start states with crossings, and the results of untangling them: in both precisions.
//!
//! Run: `cargo test -p muslin-tests --test untangle`; with `-- --nocapture` it prints the statistics of
//! each case.

#![expect(clippy::useless_conversion, reason = "conversions to double, of doubles")]

mod cases;
mod contour;
mod tangles;

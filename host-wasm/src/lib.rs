//! Muslin in the browser: scenes in, columns out, without copies. Pages use it through `muslin.js`.
#![forbid(unsafe_code)]
// `pack` optimises for size what no step does.
#![cfg_attr(small, feature(optimize_attribute))]

mod clock;
mod live;
#[cfg(feature = "count")]
mod memory;
mod scenes;
mod simulation;
mod surface;
mod watch;

//! Muslin in the browser: scenes in, columns out, without copies. Pages use it through `muslin.js`.
#![forbid(unsafe_code)]

mod clock;
#[cfg(feature = "count")]
mod memory;
mod scenes;
mod simulation;
mod surface;

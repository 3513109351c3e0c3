//! Muslin in the browser: scenes in, columns out, nothing copied. `muslin.js` is what pages see of it.
#![forbid(unsafe_code)]

mod clock;
#[cfg(feature = "count")]
mod memory;
mod scenes;
mod simulation;
mod surface;

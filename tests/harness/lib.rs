//! What the tests share.

pub mod dense;
pub mod differences;
pub mod kit;
pub mod rng;
pub mod states;
pub mod worst;

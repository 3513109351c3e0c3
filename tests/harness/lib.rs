//! What the tests share.

<<<<<<< HEAD
pub mod data;
=======
pub mod cloth_ball;
pub mod crumpled;
>>>>>>> 89a85af (Broad phase: control bits, with a reference cell and brute force to test against)
pub mod dense;
pub mod differences;
pub mod kit;
pub mod net;
pub mod oscillator;
pub mod query;
pub mod rng;
pub mod spectrum;
pub mod states;
pub mod threads;
pub mod topology;
pub mod worst;

/// The README, so that its Rust is compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

//! Code that the test suites share.

pub mod aligned;
pub mod belt;
pub mod case;
pub mod cloth_ball;
pub mod cooked;
#[path = "../../host-cli/src/bench/crumpled.rs"]
pub mod crumpled;
pub mod data;
pub mod dense;
pub mod differences;
pub mod exact;
pub mod head_on;
pub mod kit;
pub mod live_calls;
pub mod net;
pub mod oscillator;
pub mod pieces;
pub mod polynomial;
pub mod query;
pub mod rng;
pub mod soft;
pub mod states;
pub mod stiff;
pub mod threads;
pub mod topology;
pub mod torture;
pub mod truth;
pub mod worst;

/// The manuals that contain Rust code, so that doctests compile and run it.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
#[doc = include_str!("../../core/README.md")]
#[doc = include_str!("../../core/manual/driving.md")]
#[doc = include_str!("../../core/manual/no_heap.md")]
pub struct Manuals;

//! The device finds what the core finds: names, shaders, layouts, each stage, and the whole.
//!
//! Without a driver the tests that need one are reported as ignored; with `MUSLIN_REQUIRE_GPU=1` they fail.
//! Run: `cargo test --profile checked -p muslin-tests --test parity`.

#![cfg_attr(not(gpu), expect(dead_code, reason = "what tests of the device share"))]

#[cfg(gpu)]
#[path = "broad_phase/agree.rs"]
mod agree;
#[path = "broad_phase/case.rs"]
mod case;
#[path = "parity/cloth_ball.rs"]
mod cloth_ball;
#[path = "narrow_phase/exact.rs"]
mod exact;
#[path = "parity/layouts.rs"]
mod layouts;
#[path = "parity/loss.rs"]
mod loss;
#[path = "parity/methods.rs"]
mod methods;
#[path = "parity/motion.rs"]
mod motion;
#[path = "parity/names.rs"]
mod names;
#[path = "parity/on_device.rs"]
mod on_device;
#[path = "narrow_phase/polynomial.rs"]
mod polynomial;
#[path = "parity/queries.rs"]
mod queries;
#[path = "parity/room.rs"]
mod room;
#[path = "torture/scenes.rs"]
mod scenes;
#[path = "parity/shaders.rs"]
mod shaders;
#[path = "parity/stages.rs"]
mod stages;
#[path = "parity/torture.rs"]
mod torture;

//! The device finds what the core finds: names, shaders, layouts, each stage, and the whole.
//!
//! Run: `cargo test -p muslin-tests-gpu -- --include-ignored --skip long_form`. Without a driver the tests that need one
//! say so and pass; with `MUSLIN_REQUIRE_GPU=1` they fail.

#[path = "../broad_phase/agree.rs"]
mod agree;
#[path = "../broad_phase/case.rs"]
mod case;
mod cloth_ball;
#[path = "../narrow_phase/exact.rs"]
mod exact;
#[path = "../narrow_phase/head_on.rs"]
mod head_on;
mod layouts;
mod loss;
mod methods;
mod motion;
mod names;
mod on_device;
#[path = "../narrow_phase/polynomial.rs"]
mod polynomial;
mod queries;
mod room;
#[path = "../torture/scenes.rs"]
mod scenes;
mod shaders;
mod stages;
mod torture;

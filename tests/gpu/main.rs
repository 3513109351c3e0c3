//! The device finds what the core finds: names, shaders, layouts, each stage, and the whole.
//!
//! Run: `cargo test -p muslin-tests-gpu -- --include-ignored --skip long_form`. Without a driver the tests that need one
//! say so and pass; with `MUSLIN_REQUIRE_GPU=1` they fail.

#[path = "../broad_phase/agree.rs"]
mod agree;
mod cloth_ball;
mod layouts;
mod loss;
mod methods;
mod motion;
mod names;
mod on_device;
mod queries;
mod room;
mod shaders;
mod stages;
mod torture;

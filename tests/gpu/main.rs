//! The device finds the same pairs as the core: names, shaders, layouts, each stage, and whole detections.
//!
//! Run: `cargo test -p muslin-tests-gpu -- --include-ignored --skip long_form`. Without a driver, the tests that
//! need one report that and pass; with `MUSLIN_REQUIRE_GPU=1` they fail.

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

//! The README tells the truth: its scene runs, and it names every built-in scene and method.
//!
//! Run with `cargo test -p muslin-tests --test readme`; its Rust is compiled by
//! `cargo test -p muslin-tests --doc`.

use harness::steps::Steps;
use muslin_core::integrate::Method;
use muslin_core::scene::{BUILT_IN, SceneDesc};
use muslin_core::simulation::Simulation;

const README: &str = include_str!("../README.md");

#[test]
fn its_scene_runs() {
    let text =
        README.split("```toml\nname").nth(1).and_then(|rest| rest.split("```").next()).expect("the README has a scene");
    let scene: SceneDesc =
        toml::from_str(&format!("name{text}")).unwrap_or_else(|error| panic!("the README's scene: {error}"));
    let mut cloth = Simulation::new(&scene, &[]).expect("the README's scene builds");
    for _ in 0..10 {
        cloth.take_step().expect("the README's scene stays finite");
    }
}

#[test]
fn it_names_what_is_built_in() {
    let scenes = BUILT_IN.iter().map(|(name, _)| *name);
    let missing: Vec<_> = scenes.chain(Method::ALL.map(Method::name)).filter(|name| !README.contains(name)).collect();
    assert!(missing.is_empty(), "the README does not name {missing:?}; add a line to its tables");
}

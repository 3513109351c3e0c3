//! Every built-in scene to its end: finite, every solve converged, and no edge stretched by more
//! than a tenth in any step.
//!
//! Run with `cargo test -p muslin-tests --test built_in`.

use muslin_core::dispatch::Serial;
use muslin_core::scene::{BUILT_IN, SceneDesc};
use muslin_core::simulation::Simulation;

/// `flag`, the softest, reaches 1.066 when the wind takes it up.
const MOST_STRETCH: f64 = 1.1;

fn ends_well(name: &str) {
    let text = BUILT_IN.iter().find(|(known, _)| *known == name).expect("the scene is built in").1;
    let scene: SceneDesc = toml::from_str(text).expect("built-in scenes parse");
    let mut cloth = Simulation::new(&scene, &[]).expect("built-in scenes build");
    let timing = scene.timing();
    for step in 1..=timing.frames * timing.steps_per_frame {
        cloth.step(&Serial).unwrap_or_else(|diverged| panic!("{name}: {diverged}"));
        let stretch = cloth.stretch().max;
        assert!(stretch < MOST_STRETCH, "{name}: an edge is stretched to {stretch} in step {step}");
    }
    assert_eq!(cloth.work().unconverged, 0, "{name}: solves ended at their limit of iterations");
}

macro_rules! scenes {
    ($($name:ident),*) => {
        $(#[test]
        fn $name() {
            ends_well(stringify!($name));
        })*

        #[test]
        fn every_built_in_scene_is_here() {
            let names: Vec<_> = BUILT_IN.iter().map(|(name, _)| *name).collect();
            assert_eq!(names, [$(stringify!($name)),*], "give the new scene a test");
        }
    };
}

scenes!(cantilever, curtain, flag, hanging, skirt, swing);

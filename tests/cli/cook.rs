//! `muslin cook`: the block takes the steps of the scene, and a bad command leaves no file.

use std::fs;

use harness::aligned::Aligned;
use muslin_core::cooked::{Cloth, required_bytes};
use muslin_core::dispatch::Serial;
use muslin_core::simulation::Simulation;

use crate::kit::{Place, TINY};

const FLOOR: &str =
    "[contact]\nthickness = 0.005\n[[collider]]\nshape = \"plane\"\npoint = [0, 0.9, 0]\nnormal = [0, 1, 0]\n";

#[test]
fn a_cooked_scene_takes_the_steps_of_the_scene() {
    let place = Place::new();
    let text = format!("{TINY}{FLOOR}");
    place.write("floor.toml", &text);
    let told = place.muslin("cook floor.toml -o sub/floor.bin --quiet").expect(0).stdout;
    let file = fs::read(place.path("sub/floor.bin")).expect("it is written");
    let needed = required_bytes(&file).expect("it is cooked");
    assert!(told.contains(&format!("sub/floor.bin: {} bytes", file.len())), "{told}");
    assert!(told.contains(&format!("{needed} bytes of memory")), "{told}");
    let (mut block, mut memory) = (Aligned::new(&file), Aligned::filled(needed, 0));
    let mut cloth = Cloth::open(block.all(), memory.all()).expect("it opens");
    let desc = harness::kit::single::scene(&text);
    let mut owned = Simulation::new(&desc, &[]).expect("it builds");
    for n in 0..20 {
        owned.step(&Serial).expect("it steps");
        cloth.step(&Serial).expect("it has room");
        assert_eq!(owned.positions(), cloth.positions(), "step {n}");
    }
}

#[test]
fn what_cannot_be_cooked_leaves_no_file() {
    let place = Place::new();
    place.write("floor.toml", format!("{TINY}{FLOOR}"));
    for (words, code, said) in [
        ("cook tiny.toml -o a.bin --set cloth.density=-1", 2, "density"),
        ("cook nowhere.toml -o a.bin", 2, "nowhere.toml"),
        ("cook tiny.toml -o a.bin --hands=-1", 2, "--hands"),
        ("cook tiny.toml -o a.bin --margin 0.5", 2, "--margin"),
        ("cook floor.toml -o a.bin --set integrator.method=rk4 --set cloth.stretch.stiffness=1e7", 3, "step"),
        ("cook tiny.toml -o tiny.toml/a.bin", 1, "a.bin"),
    ] {
        let told = place.muslin(words).expect(code).stderr;
        assert!(told.contains(said), "{words}: {told}");
        assert!(!place.path("a.bin").exists(), "{words}");
    }
    // It says what helps, as `muslin run` does, also before the first step.
    let words = "cook floor.toml --set integrator.method=rk4 --set cloth.stretch.stiffness=1e7 --quiet";
    let told = place.muslin(words).expect(3).stderr;
    assert!(told.contains("an implicit method"), "{told}");
    assert!(told.lines().filter(|line| line.contains("integrator.step")).count() > 1, "no warning: {told}");
    // With the room given, no step is taken.
    place.muslin("cook tiny.toml -o b.bin --pairs 10 --contacts 5 --precision f64 --quiet").expect(0);
    assert!(place.path("b.bin").exists());
}

#[test]
fn a_build_system_reads_the_needs() {
    let place = Place::new();
    place.write("floor.toml", format!("{TINY}{FLOOR}"));
    let told = place.muslin("cook floor.toml -o floor.bin --hands 2 --json").expect(0).stdout;
    let needs: serde_json::Value = serde_json::from_str(&told).expect("it is JSON");
    let file = fs::read(place.path("floor.bin")).expect("it is written");
    assert_eq!(needs["block_bytes"], file.len());
    assert_eq!(needs["memory_bytes"], required_bytes(&file).expect("it is cooked"));
    assert_eq!((&needs["alignment"], &needs["hands"], &needs["forces"]), (&32.into(), &2.into(), &0.into()));
    assert!(needs["measured_s"].as_f64().is_some_and(|seconds| seconds > 0.0), "{told}");
}

/// A collider that the program will move touches nothing in the run.
#[test]
fn a_scene_that_touches_nothing_has_room_for_contacts() {
    let place = Place::new();
    place.write("far.toml", format!("{TINY}{FLOOR}").replace("[0, 0.9, 0]", "[0, -90, 0]"));
    let told = place.muslin("cook far.toml -o far.bin --quiet --json").expect(0);
    assert!(told.stderr.contains("a guess"), "{}", told.stderr);
    let needs: serde_json::Value = serde_json::from_str(&told.stdout).expect("it is JSON");
    for key in ["candidates", "contacts"] {
        assert!(needs[key].as_u64().is_some_and(|room| room > 0), "{key}: {}", told.stdout);
    }
}

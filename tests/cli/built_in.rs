//! Every built-in scene runs, and the garment of the shared data runs.

use std::path::Path;

use crate::kit::{Place, PointCache};

fn names(place: &Place) -> Vec<String> {
    let rows = place.muslin("scenes --json").expect(0).json();
    rows.as_array().unwrap().iter().map(|row| row["name"].as_str().unwrap().into()).collect()
}

fn is_finite(cache: &PointCache) -> bool {
    cache.frames.iter().flatten().flatten().all(|x| x.is_finite())
}

#[test]
fn lists_scenes_by_name_and_purpose() {
    let place = Place::new();
    let list = place.muslin("scenes").expect(0).stdout;
    let names = names(&place);
    for expected in ["flag", "curtain", "hanging", "cantilever", "swing", "skirt"] {
        assert!(names.iter().any(|name| name == expected), "{expected} is not in {names:?}");
    }
    assert_eq!(list.lines().count(), names.len());
    for (line, name) in list.lines().zip(&names) {
        assert!(line.starts_with(name.as_str()) && line.len() > name.len() + 10, "{line}");
    }
    let outcome = place.muslin("scenes flg").expect(2);
    assert!(outcome.stderr.contains("flg") && outcome.stderr.contains("flag"), "{outcome:?}");
}

#[test]
fn every_scene_runs() {
    let place = Place::new();
    for name in names(&place) {
        let summary = place.run(&format!("{name} --duration 0.1"));
        assert_eq!((&summary["scene"], &summary["verdict"]), (&name.as_str().into(), &"ok".into()));
        let cache = PointCache::parse(&place.read("out/cloth.pc2"));
        assert!(cache.frames.len() > 3 && is_finite(&cache), "{name}");
        assert!(summary["stretch"]["max"].as_f64().unwrap() < 2.0, "{name}: {summary}");
        assert_eq!(summary["work"]["unconverged"], 0, "{name}: {summary}");
    }
}

#[test]
fn a_printed_scene_is_a_scene_file() {
    let place = Place::new();
    let printed = place.muslin("scenes cantilever").expect(0).stdout;
    place.write("my.toml", printed);
    let [built_in, file] = ["cantilever", "my.toml"].map(|scene| place.run(&format!("{scene} --duration 0.05")));
    assert_eq!(built_in["state_hash"], file["state_hash"]);
}

#[test]
#[ignore = "slow"]
fn the_garment_runs() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dress = here.join("../../shared/data/garment/dress.obj");
    if !dress.exists() && std::env::var("MUSLIN_REQUIRE_DATA").as_deref() != Ok("1") {
        eprintln!("skipped: {} is absent", dress.display());
        return;
    }
    let place = Place::new();
    let scene = here.join("../tests/scenes/dress.toml");
    let summary = place.run(&format!("{} --duration 0.04", scene.display()));
    assert_eq!((&summary["vertices"], &summary["steps"]), (&15_656.into(), &10.into()));
    assert_eq!(summary["verdict"], "ok");
    assert!(is_finite(&PointCache::parse(&place.read("out/cloth.pc2"))));
    assert!(summary["stretch"]["max"].as_f64().unwrap() < 3.0, "{summary}");
}

#[test]
#[ignore = "slow"]
fn a_skirt_that_spins_passes_through_nothing() {
    let place = Place::new();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/scenes/spin.toml");
    let summary = place.run(&format!("{} --duration 0.2 --audit", scene.display()));
    assert_eq!((&summary["vertices"], &summary["intersections"]), (&7_964.into(), &0.into()));
    assert_eq!(summary["verdict"], "ok");
}

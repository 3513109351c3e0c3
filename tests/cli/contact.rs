//! Runs with contact: their reports on contact, and invalid motion files of colliders.

use crate::decode;
use crate::kit::{Place, PointCache, TINY};

/// A sheet that falls on a ball.
const DROP: &str = r#"name = "drop"
duration = 0.2
frame_rate = 20
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.3, 0.3], cells = [8, 8] }
position = [0.0, 0.22, 0.0]
density = 0.2
stretch = { model = "membrane", stiffness = 100.0 }
shear = { stiffness = 50.0 }

[[collider]]
shape = "sphere"
center = [0.0, 0.0, 0.0]
radius = 0.2

[contact]
thickness = 0.004
friction = 0.3

[integrator]
step = 0.01
"#;

/// The scene [`DROP`] with a floor of two triangles instead of the ball. A point cache moves the floor.
fn floor() -> String {
    let ball = "shape = \"sphere\"\ncenter = [0.0, 0.0, 0.0]\nradius = 0.2\n";
    assert!(DROP.contains(ball));
    DROP.replace(ball, "shape = \"mesh\"\nfile = \"floor.obj\"\nmotion = \"floor.pc2\"\nmotion_rate = 10\n")
}

const FLOOR: &str = "v -1 0.2 -1\nv 1 0.2 -1\nv 1 0.2 1\nv -1 0.2 1\nf 1 3 2\nf 1 4 3\n";

/// A point cache in which points with these x and z rise from y = 0 by 0.1 m per frame.
fn rising(corners: &[[f32; 2]], frames: u32) -> Vec<u8> {
    let mut bytes = b"POINTCACHE2\0".to_vec();
    let head = [1, corners.len() as u32, 0, 1_f32.to_bits(), frames];
    head.iter().for_each(|word| bytes.extend(word.to_le_bytes()));
    for frame in 0..frames {
        let points = corners.iter().flat_map(|&[x, z]| [x, 0.1 * frame as f32, z]);
        points.for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    bytes
}

const CORNERS: [[f32; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

#[test]
fn the_summary_counts_and_times_contact() {
    let place = Place::new();
    place.write("drop.toml", DROP);
    for words in ["--backend cpu", "--precision f64"] {
        let summary = place.run(&format!("drop.toml --audit {words}"));
        assert_eq!((&summary["verdict"], &summary["backend"]), (&"ok".into(), &"cpu".into()));
        assert_eq!([&summary["intersections"], &summary["intersections_at_start"]], [&0, &0]);
        assert!(summary["contacts"]["candidates"].as_u64() > summary["contacts"]["proximity"].as_u64());
        assert!(summary["contacts"]["proximity"].as_u64() > Some(20), "{summary}");
        assert!(summary["penetration_m"].as_f64().is_some_and(|depth| depth < 1e-4), "{summary}");
        let stages = ["predict", "broad_phase", "narrow_phase", "response", "output"];
        let ms = stages.map(|stage| summary["stage_ms"][stage].as_f64().unwrap());
        assert!(ms.iter().all(|&ms| ms > 0.0), "{summary}");
        let wall = 1e3 * summary["wall_s"].as_f64().unwrap() / summary["steps"].as_f64().unwrap();
        assert!(ms[..4].iter().sum::<f64>() <= wall, "{summary}");
    }
    let text = place.muslin("run drop.toml --out out --preview none --audit").expect(0).stdout;
    for part in [
        "pairs tested per step, ",
        " of them nearer than the thickness",
        " broad phase, ",
        "impacts ",
        "steps rejected",
        "penetration ",
        "audit 0 ",
    ] {
        assert!(text.contains(part), "{part:?} is not in {text}");
    }
}

#[test]
fn a_run_without_contact_says_nothing_of_it() {
    let place = Place::new();
    let text = place.muslin("run tiny.toml --out out --preview none").expect(0).stdout;
    assert!(!text.contains("contact") && !text.contains("audit"), "{text}");
    let stages = place.run("tiny.toml")["stage_ms"].clone();
    assert_eq!(["broad_phase", "narrow_phase", "response"].map(|key| stages[key].as_f64()), [Some(0.0); 3]);
}

#[test]
fn what_the_gpu_cannot_do() {
    Place::new().refuses("tiny.toml --backend gpu", &["--backend gpu", "tiny has no contact", "--backend cpu"]);
    Place::new().refuses("tiny.toml --backend gpu --precision f64", &["--backend gpu", "single precision"]);
    Place::new().refuses("tiny.toml --backend vulkan", &["'vulkan'", "cpu, gpu"]);
}

/// A second sheet that passes through the middle of the first.
pub const THROUGH: &str = "\n[[cloth]]\ngrid = { size = [0.3, 0.3], cells = [4, 4] }\nposition = [0, 1.01, 0]\n\
                       rotation = [90, 0, 10]\ndensity = 0.2\n";

#[test]
fn a_scene_that_starts_crossed_is_intersecting() {
    let place = Place::new();
    place.write("crossed.toml", TINY.to_owned() + THROUGH);
    let outcome = place.muslin("run crossed.toml --out out --preview none --audit --json").expect(3);
    let summary = outcome.json();
    let worst = summary["intersections"].as_u64().unwrap();
    let start = summary["intersections_at_start"].as_u64().unwrap();
    assert!(summary["verdict"] == "intersecting" && worst >= start && start > 0, "{summary}");
    let frame = summary["intersections_frame"].as_u64().unwrap();
    for part in [
        format!("intersecting: {worst} intersections in the worst frame, {frame},"),
        format!("starts with {start} intersections"),
    ] {
        assert!(outcome.stderr.contains(&part), "{part:?} is not in {outcome:?}");
    }
    assert_eq!(PointCache::parse(&place.read("out/cloth.pc2")).frames.len(), 5, "all frames are there");
    let text = place.muslin("run crossed.toml --out out --preview none --audit").expect(3).stdout;
    assert!(text.contains(&format!("it starts with {start} intersections")), "{text}");
    assert_eq!(place.run("crossed.toml")["intersections"], serde_json::Value::Null, "not asked, not looked");
}

#[test]
fn with_contact_a_crossed_start_is_untangled() {
    let place = Place::new();
    place.write("crossed.toml", TINY.to_owned() + THROUGH);
    for words in ["--precision f32", "--precision f64"] {
        let words = format!("run crossed.toml --out out --preview none --set contact.thickness=0.004 {words}");
        let outcome = place.muslin(&format!("{words} --audit --json")).expect(0);
        let summary = outcome.json();
        assert_eq!((&summary["verdict"], &summary["intersections"]), (&"ok".into(), &0.into()), "{outcome:?}");
        let start = summary["intersections_at_start"].as_u64().unwrap();
        assert!(start > 0 && summary["intersections_untangled"] == start, "{summary}");
        let note = format!("{start} crossings at the start: untangled in ");
        assert!(outcome.stderr.contains(&note) && outcome.stderr.contains(" mm"), "{outcome:?}");
        let unasked = place.muslin(&words).expect(0);
        assert!(unasked.stderr.contains(&note), "{unasked:?}");
        assert!(unasked.stdout.contains(&format!("start {start} intersections untangled")), "{unasked:?}");
        let quiet = place.muslin(&format!("{words} --quiet")).expect(0).stderr;
        assert!(quiet.starts_with(&note) && quiet.lines().count() == 1, "a warning, and nothing else: {quiet}");
    }
}

#[test]
fn what_is_held_is_reported() {
    let place = Place::new();
    let all = "\n[[cloth.pin]]\nselect = { box = [[-1, -1, -1], [1, 2, 1]] }\n";
    place.write("held.toml", TINY.replace("\n[[cloth.pin]]\nselect = { corners = [0, 1] }\n", all) + THROUGH + all);
    let outcome = place.muslin("run held.toml --out out --json --audit --set contact.thickness=0.004").expect(3);
    let summary = outcome.json();
    let start = summary["intersections_at_start"].as_u64().unwrap();
    assert_eq!((&summary["intersections"], &summary["intersections_untangled"]), (&start.into(), &0.into()));
    for part in
        ["left (fixed by pins or colliders), nothing was moved", "could not be untangled: separate these surfaces"]
    {
        assert!(outcome.stderr.contains(part), "{part:?} is not in {outcome:?}");
    }
}

#[test]
fn a_sheet_that_starts_in_the_floor_comes_out() {
    let place = Place::new();
    let sunk = floor().replace("motion = \"floor.pc2\"\nmotion_rate = 10\n", "");
    let sunk = sunk.replace("position = [0.0, 0.22, 0.0]", "position = [0.0, 0.21, 0.0]\nrotation = [0.0, 0.0, 20.0]");
    place.write("sunk.toml", sunk);
    place.write("floor.obj", FLOOR);
    let summary = place.run("sunk.toml --audit");
    assert_eq!((&summary["verdict"], &summary["intersections"]), (&"ok".into(), &0.into()));
    assert!(summary["intersections_untangled"].as_u64() > Some(0), "{summary}");
    let last = PointCache::parse(&place.read("out/cloth.pc2")).frames.pop().unwrap();
    assert!(last.iter().all(|p| p[1] > 0.2), "it came out below: {last:?}");
}

#[test]
fn cloth_that_passes_through_cloth_is_intersecting() {
    let place = Place::new();
    let held = TINY.replace("corners = [0, 1]", "box = [[-1, 0.9, -1], [1, 1.1, 1]]");
    let second = "\n[[cloth]]\ngrid = { size = [0.3, 0.3], cells = [4, 4] }\nposition = [0, 1.06, 0]\n\
                  rotation = [18, 0, 0]\ndensity = 0.2\n";
    place.write("through.toml", held + second);
    let outcome = place.muslin("run through.toml --out out --preview none --audit --json").expect(3);
    assert!(outcome.stderr.contains("the scene has no [contact]"), "{outcome:?}");
    assert_eq!(outcome.json()["intersections_at_start"], 0);
    let summary = place.run("through.toml --audit --set contact.thickness=0.004");
    assert_eq!((&summary["verdict"], &summary["intersections"]), (&"ok".into(), &0.into()));
}

#[test]
fn a_point_cache_moves_a_collider() {
    let place = Place::new();
    place.write("drop.toml", floor());
    place.write("floor.obj", FLOOR);
    place.write("floor.pc2", rising(&CORNERS, 5));
    let summary = place.run("drop.toml --audit");
    assert_eq!((&summary["verdict"], &summary["intersections"]), (&"ok".into(), &0.into()));
    // The floor rises from 0 m to 0.2 m during the run; the sheet stays above it.
    let last = PointCache::parse(&place.read("out/cloth.pc2")).frames.pop().unwrap();
    assert!(last.iter().all(|p| p[1] > 0.2), "{last:?}");
}

#[test]
fn point_caches_that_cannot_be_used() {
    let place = Place::new();
    let scene = floor();
    place.write("drop.toml", &scene);
    place.write("floor.obj", FLOOR);
    place.refuses("drop.toml", &["drop.toml: cannot read floor.pc2"]);
    place.write("floor.pc2", rising(&CORNERS[..3], 5));
    place.refuses("drop.toml", &["collider 0", "point cache has 3 points", "mesh 4 vertices"]);
    let whole = rising(&CORNERS, 5);
    place.write("floor.pc2", &whole[..whole.len() - 7]);
    place.refuses("drop.toml", &["floor.pc2: it has", "complete copy"]);
    place.write("floor.pc2", "PTCACHE");
    place.refuses("drop.toml", &["floor.pc2: "]);
    place.write("floor.pc2", whole);
    place.write("drop.toml", scene.replace("motion_rate = 10\n", ""));
    place.refuses("drop.toml", &["collider 0: motion_rate is needed"]);
    place.write("drop.toml", DROP.replace("radius = 0.2\n", "radius = 0.2\nmotion = \"floor.pc2\"\n"));
    place.refuses("drop.toml", &["collider 0: motion has no meaning with shape = \"sphere\""]);
}

#[test]
fn colliders_are_in_the_picture() {
    let place = Place::new();
    place.write("drop.toml", DROP);
    // Counts dark grey pixels: the cloth, the wall and the lit floor have other colours.
    let grey = |words: &str| {
        place.muslin(&format!("run drop.toml --out out --preview png {words}")).expect(0);
        let is_grey = |p: &&[u8; 3]| p.iter().max().unwrap() - p.iter().min().unwrap() < 30 && p[1] < 125;
        decode::png(&place.read("out/preview.png")).pixels.iter().filter(is_grey).count()
    };
    let (with, without) = (grey(""), grey("--set collider=[]"));
    assert!(with > without + 20_000, "{with} grey pixels, {without} without the ball");
}

#[test]
fn the_bench_measures_contact() {
    let place = Place::new();
    place.write("drop.toml", DROP);
    let report = place.muslin("bench drop.toml --json").expect(0).json();
    let scene = &report["scenes"][0];
    let contact = &scene["contact"];
    assert!(contact["candidates_per_s"].as_f64() > Some(1.0) && contact["contacts_per_s"].as_f64() > Some(1.0));
    assert!(contact["candidates_per_contact"].as_f64() > Some(1.0), "{contact}");
    let stages: Vec<_> = scene["stages"].as_array().unwrap().iter().map(|s| s["stage"].as_str().unwrap()).collect();
    for stage in ["broad phase", "narrow phase", "response", "all"] {
        assert!(stages.contains(&stage), "{stage} is not in {stages:?}");
    }
}

/// Two blocks close on a sheet until the blocks overlap.
#[test]
fn a_sheet_without_room_ends_the_run_and_says_why() {
    let ball = "shape = \"sphere\"\ncenter = [0.0, 0.0, 0.0]\nradius = 0.2\n";
    let block = |y: f64, speed: f64| {
        format!(
            "shape = \"box\"\ncenter = [0.0, {y:?}, 0.0]\nhalf = [0.3, 0.1, 0.3]\n\
             motion = {{ keys = [[0.0, 0, 0, 0], [1.0, 0, {speed:?}, 0]] }}\n"
        )
    };
    let blocks = format!("{}\n[[collider]]\n{}", block(0.1, 0.2), block(0.34, -0.2));
    let place = Place::new();
    place.write("closing.toml", DROP.replace(ball, &blocks));
    let outcome = place.muslin("run closing.toml --out out --preview none --json --audit").expect(3);
    let summary = outcome.json();
    assert_eq!(summary["verdict"], "diverged");
    assert_eq!(summary["intersections"], 0, "a frame was written in which surfaces cross");
    assert!(summary["frames"].as_u64().unwrap() > 1, "no frame was kept: {summary}");
    assert!(outcome.stderr.contains("surfaces could not be kept apart in step "), "{outcome:?}");
    assert!(outcome.stderr.contains("leave the cloth room"), "no advice: {outcome:?}");
}

/// Continuous detection is off, so that the first part of the run already has penetrations to report.
#[test]
fn a_resumed_run_tells_of_the_whole() {
    let place = Place::new();
    let deep = DROP.replace("friction = 0.3", "friction = 0.3\ncontinuous = false").replace("0.22, 0.0]", "0.4, 0.0]");
    place.write("deep.toml", deep);
    for words in ["--set integrator.method=bdf2", "--precision f64", "--set integrator.error=0.0005"] {
        let words = format!("deep.toml --duration 0.5 --audit {words}");
        let whole = place.run(&format!("{words} --checkpoint 40"));
        let parts = place.run(&format!("{words} --resume out/checkpoint.muslin"));
        assert!(whole["contacts"]["candidates"].as_u64() > Some(0), "nothing came near: {whole}");
        for key in [
            "state_hash",
            "steps",
            "size_m",
            "stretch",
            "contacts",
            "rejected_steps",
            "error_control",
            "penetration_m",
            "verdict",
            "intersections",
            "intersections_frame",
            "intersections_at_start",
            "intersections_untangled",
        ] {
            assert_eq!(whole[key], parts[key], "{words}: {key}");
        }
    }
}

#[test]
fn a_thickness_that_does_not_fit_the_mesh_is_noted() {
    let place = Place::new();
    place.write("drop.toml", DROP);
    // A layer thicker than the edges pushes neighbours apart: most of the energy comes from this.
    for (thickness, noted, code) in [("0.004", false, 0), ("0.2", true, 3), ("1e-7", true, 0)] {
        let words =
            format!("run drop.toml --out out --preview none --duration 0.05 --set contact.thickness={thickness}");
        let outcome = place.muslin(&words).expect(code);
        assert_eq!(outcome.stderr.contains("with edges of"), noted, "{thickness} m: {}", outcome.stderr);
    }
}

//! The files that a run leaves on disk.

use serde_json::Value;

use crate::kit::{Place, PointCache, TINY, obj};

/// The keys of `summary.json` in the interface contract; `a.b` is the key `b` in the section `a`.
const KEYS: &str = "tool version scene precision backend adapter threads vertices triangles steps rejected_steps \
    simulated_s wall_s verdict stage_ms.predict stage_ms.broad_phase stage_ms.narrow_phase stage_ms.response \
    stage_ms.output stretch.max stretch.mean energy.kinetic energy.stretch energy.shear energy.bend energy.gravity \
    momentum contacts.candidates contacts.proximity contacts.impacts contacts.zones contacts.failsafe intersections \
    penetration_m work.force_evaluations work.cg_iterations work.newton_iterations state_hash";

#[test]
fn all_formats_at_once() {
    let place = Place::new();
    place.muslin("run tiny.toml --out a/b --export obj,pc2,usda,vtp,obj").expect(0);
    let frames = (0..5).map(|k| format!("frames/frame_0000{k}.obj"));
    let vtp = (0..5).map(|k| format!("vtp/cloth_0000{k}.vtp"));
    let single =
        ["cloth.obj", "cloth.pc2", "cloth.usda", "cloth.vtp.series", "preview.gif", "run.json", "summary.json"];
    let mut expected: Vec<String> = frames.chain(vtp).chain(single.map(String::from)).collect();
    expected.sort();
    assert_eq!(place.files("a/b"), expected);
}

#[test]
fn point_cache_and_obj_frames_say_the_same() {
    let place = Place::new();
    place.run("tiny.toml --export obj,pc2");
    let cache = PointCache::parse(&place.read("out/cloth.pc2"));
    assert_eq!((cache.points, cache.start, cache.frames.len()), (27, 0.0, 5));
    for (k, frame) in cache.frames.iter().enumerate() {
        let (vertices, faces) = obj(&place.read(&format!("out/frames/frame_{k:05}.obj")));
        assert_eq!((&vertices, faces.len()), (frame, 36), "frame {k}");
    }
    assert_eq!(place.read("out/cloth.obj"), place.read("out/frames/frame_00000.obj"));
    assert!(cache.frames.windows(2).all(|pair| pair[0] != pair[1]), "the cloth does not move");
    let held = |frame: &Vec<[f32; 3]>| frame[0];
    assert!(cache.frames.iter().all(|frame| held(frame) == held(&cache.frames[0])), "a pin moves");
}

#[test]
fn the_summary_has_the_keys_of_the_contract() {
    let place = Place::new();
    let summary = place.run("tiny.toml --threads 2");
    for key in KEYS.split(' ') {
        let found = key.split('.').try_fold(&summary, |value, key| value.get(key));
        assert!(found.is_some(), "{key} is not in {summary}");
    }
    let values = ["tool", "scene", "precision", "backend", "verdict"].map(|key| summary[key].as_str().unwrap());
    assert_eq!(values, ["muslin", "tiny", "f32", "cpu", "ok"]);
    let counts = ["threads", "vertices", "triangles", "steps", "rejected_steps"].map(|k| summary[k].as_u64().unwrap());
    assert_eq!(counts, [2, 27, 36, 20, 0]);
    assert!((summary["simulated_s"].as_f64().unwrap() - 0.2).abs() < 1e-6);
    assert!(["adapter", "intersections", "penetration_m"].iter().all(|key| summary[key].is_null()));
    assert_eq!(summary["work"]["newton_iterations"], 20);
    let hash = summary["state_hash"].as_str().unwrap().strip_prefix("fnv1a:").unwrap();
    assert!(hash.len() == 16 && hash.chars().all(|c| matches!(c, '0'..='9' | 'a'..='f')), "{hash}");
    assert_eq!(serde_json::from_slice::<Value>(&place.read("out/summary.json")).unwrap(), summary);
}

#[test]
fn the_vertex_order_is_that_of_the_input() {
    let place = Place::new();
    let mesh = "v 0.5 0 0\nv 0 0 0.25\nv -0.5 0 0\nv 0 0 -0.25\nf 1 4 3 2\n";
    place.write("mesh.obj", mesh);
    place.write("scene.toml", TINY.replace("grid = { size = [0.3, 0.3], cells = [4, 4] }", "mesh = \"mesh.obj\""));
    place.run("scene.toml --duration 0.1 --export obj");
    let (vertices, faces) = obj(&place.read("out/frames/frame_00000.obj"));
    assert_eq!(vertices, [[0.5, 1.0, 0.0], [0.0, 1.0, 0.25], [-0.5, 1.0, 0.0], [0.0, 1.0, -0.25]]);
    assert_eq!((faces.len(), place.files("out/frames").len()), (2, 3));
}

#[test]
fn without_out_the_folder_has_the_name_of_the_file() {
    let place = Place::new();
    place.muslin("run tiny.toml --preview none").expect(0);
    let files = ["cloth.obj", "cloth.pc2", "run.json", "summary.json"].map(|file| format!("out/tiny/{file}"));
    assert_eq!(place.files("."), [&files[..], &["tiny.toml".to_owned()]].concat());
    place.muslin("run tiny.toml --preview none --set name=../up").expect(0);
    assert!(!place.path("up").exists());
}

#[test]
fn a_scene_without_a_name_is_called_by_its_file() {
    let place = Place::new();
    std::fs::create_dir(place.path("deep")).unwrap();
    place.write("deep/my.napkin.toml", TINY.replace("name = \"tiny\"\n", ""));
    let scene = |words: &str| place.run(&format!("deep/my.napkin.toml {words}"))["scene"].clone();
    assert_eq!(scene(""), "my.napkin");
    assert_eq!(scene("--set cloth.density=0.3"), "my.napkin");
    assert_eq!(scene("--set name=other"), "other");
    place.muslin("run deep/my.napkin.toml --preview none").expect(0);
    assert!(place.path("out/my.napkin/summary.json").exists());
    let study = place.muslin("stability deep/my.napkin.toml --methods rk4 --duration 0.05 --out out --json").expect(0);
    assert_eq!(study.json()["scene"], "my.napkin");
}

#[test]
fn frames_need_not_be_written() {
    let place = Place::new();
    place.refuses("tiny.toml --export pc2,none", &["--export: none excludes"]);
    let with = place.muslin("run tiny.toml --out with --json").expect(0).json();
    let run = |words: &str| place.muslin(&format!("run tiny.toml --out out --json --export none {words}")).expect(0);
    let without = run("");
    assert_eq!(place.files("out"), ["preview.gif", "run.json", "summary.json"]);
    assert_eq!(without.json()["state_hash"], with["state_hash"]);
    assert!(without.stderr.contains("wrote out/summary.json, out/preview.gif"), "{without:?}");
    // A run that stops at a checkpoint and is resumed leaves no other files.
    run("--preview none --checkpoint 10 --duration 0.1");
    assert_eq!(place.files("out"), ["checkpoint.muslin", "run.json", "summary.json"]);
    let parts =
        place.muslin("run tiny.toml --json --export none --preview none --resume out/checkpoint.muslin").expect(0);
    assert_eq!(parts.json()["state_hash"], with["state_hash"]);
    assert_eq!(place.files("out"), ["checkpoint.muslin", "run.json", "summary.json"]);
}

#[test]
fn a_shorter_run_leaves_no_frames_of_a_longer_one() {
    let place = Place::new();
    place.run("tiny.toml --export obj,pc2");
    place.run("tiny.toml --export obj,pc2 --duration 0.1");
    assert_eq!(place.files("out/frames").len(), 3);
    assert_eq!(PointCache::parse(&place.read("out/cloth.pc2")).frames.len(), 3);
}

#[test]
fn a_run_of_no_time_shows_the_start() {
    let place = Place::new();
    let outcome = place.muslin("run tiny.toml --out out --duration 0 --export obj,pc2 --json").expect(0);
    assert_eq!((outcome.json()["steps"].as_u64(), outcome.json()["frames"].as_u64()), (Some(0), Some(1)));
    assert_eq!(PointCache::parse(&place.read("out/cloth.pc2")).frames.len(), 1);
    assert!(place.path("out/preview.gif").exists());
}

#[test]
fn error_control_is_plotted() {
    let place = Place::new();
    let run = |words: &str| {
        let outcome = place.muslin(&format!("run tiny.toml --out out --json --export none {words}"));
        outcome.expect(0)
    };
    let control = "--set integrator.method=backward-euler --set integrator.error=0.00001";
    run(&format!("--preview none {control}"));
    assert_eq!(place.files("out"), ["run.json", "summary.json"]);
    let summary = run(control).json();
    assert_eq!(place.files("out"), ["preview.gif", "run.json", "steps.svg", "summary.json"]);
    let plot = String::from_utf8(place.read("out/steps.svg")).unwrap();
    assert!(plot.contains("tiny: substeps"), "{plot}");
    // Two curves from the start through the ends of the 20 steps.
    let curves = plot.split("<path").filter(|path| path.contains("#0072b2"));
    assert_eq!(curves.map(|path| path.matches(['M', 'L']).count()).collect::<Vec<_>>(), [21, 21], "{plot}");
    let accepted = summary["error_control"]["accepted"].as_u64().unwrap();
    assert!(accepted > summary["steps"].as_u64().unwrap(), "{summary}");
    run("");
    assert_eq!(place.files("out"), ["preview.gif", "run.json", "summary.json"], "without error control");
}

#[test]
fn substeps_with_a_larger_error_are_counted_and_told() {
    let place = Place::new();
    let run = |error: &str| {
        let words =
            "run tiny.toml --out out --json --export none --preview none --set integrator.method=backward-euler";
        place.muslin(&format!("{words} --set integrator.error={error}")).expect(0)
    };
    let warns = |text: &str| text.contains("substeps exceed integrator.error");
    let [fine, impossible] = ["1e-5", "1e-12"].map(run);
    let count = |summary: &Value, key: &str| summary["error_control"][key].as_u64().unwrap();
    assert!(count(&fine.json(), "exceeding") == 0 && !warns(&fine.stderr), "{fine:?}");
    let summary = impossible.json();
    assert!(count(&summary, "exceeding") > 0 && warns(&impossible.stderr), "{impossible:?}");
    assert_eq!(count(&summary, "accepted"), 64 * summary["steps"].as_u64().unwrap());
}

#[test]
fn a_sheet_far_away_keeps_its_shape_in_obj_and_in_the_preview() {
    let place = Place::new();
    let far = "tiny.toml --set cloth.position=[1e5,1,0] --json --quiet";
    let codes = |summary: &Value| {
        let warnings = summary["warnings"].as_array().unwrap().iter();
        warnings.map(|warning| warning["code"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    let near = place.muslin("run tiny.toml --out near --export obj --preview png").expect(0);
    assert!(near.stderr.lines().all(|line| !line.contains("single precision")), "{near:?}");
    let with_obj = place.muslin(&format!("run {far} --out far --export obj --preview png")).expect(0).json();
    assert!(!codes(&with_obj).contains(&"export".into()), "{with_obj}");
    // Each vertex of the last frame is 100 km beside that of the scene at home; single precision would be 4 mm off.
    let last = |folder: &str| {
        let text = String::from_utf8(place.read(&format!("{folder}/frames/frame_00004.obj"))).unwrap();
        let vertices = text.lines().filter_map(|line| line.strip_prefix("v "));
        vertices.map(|line| line.split(' ').next().unwrap().parse().unwrap()).collect::<Vec<f64>>()
    };
    for (x, far) in last("near").into_iter().zip(last("far")) {
        assert!((far - 1e5 - x).abs() < 1e-6, "{far} beside {x}");
    }
    let pictures = ["near", "far"].map(|folder| place.read(&format!("{folder}/preview.png")));
    assert!(pictures[0].len().abs_diff(pictures[1].len()) * 20 < pictures[0].len(), "the pictures differ");
    for format in ["pc2", "usda", "vtp"] {
        let outcome = place.muslin(&format!("run {far} --out far --export obj,{format} --preview none")).expect(0);
        assert!(codes(&outcome.json()).contains(&"export".into()), "{format}: {outcome:?}");
        assert!(outcome.stderr.contains(&format!("--export {format}: ")), "{outcome:?}");
    }
}

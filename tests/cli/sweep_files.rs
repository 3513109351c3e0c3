//! Invalid sweep files: exit code 2, a message with the location and the error, no files written.

use crate::kit::{Place, blocks};
use crate::sweep::{SWEEP, place};

#[track_caller]
fn refuses(place: &Place, parts: &[&str]) {
    let outcome = place.muslin("sweep s.toml").expect(2);
    assert_eq!(outcome.stdout, "");
    for part in parts {
        assert!(outcome.stderr.contains(part), "{part:?} is not in {}", outcome.stderr);
    }
    assert!(!place.path("out").exists(), "something was written");
}

/// Asserts that the sweep is refused after `old` in it is replaced by `new`.
#[track_caller]
fn refuses_with(old: &str, new: &str, parts: &[&str]) {
    assert!(SWEEP.contains(old), "{old} is not in the sweep");
    let place = place();
    place.write("s.toml", SWEEP.replace(old, new));
    refuses(&place, &[&["s.toml: "], parts].concat());
}

const STEPS: &str = "integrator.step = [0.01, 0.005]";

#[test]
fn keys_that_are_not_known() {
    refuses_with("[grid]", "[gird]", &["line 7, column 2", "`gird`", "did you mean `grid`?"]);
    refuses_with("precision", "precison", &["line 2, column 1", "did you mean `precision`?"]);
    let step = "line 8: integrator.stp = 0.01: unknown field `stp`";
    refuses_with("integrator.step", "integrator.stp", &[step, "did you mean `step`?"]);
    refuses_with("frame_rate", "frame_rat", &["line 5: frame_rat = 50: ", "did you mean `frame_rate`?"]);
    refuses_with(
        "\"cloth.stretch.",
        "\"cloth.1.stretch.",
        &["line 9: cloth.1.stretch.stiffness = 200.0: ", "no index 1"],
    );
    refuses_with("[grid]", "[grid]\nintegrator..method = [1]", &["line 8, column 12"]);
    refuses_with("scene = \"tiny.toml\"", "", &["missing field `scene`"]);
}

#[test]
fn values_that_cannot_be_run() {
    refuses_with("0.005]", "\"x\"]", &["line 8: integrator.step = \"x\": ", "expected a number"]);
    // This error is found only when the scene is built. The runs before it are not run either.
    refuses_with(
        "0.005]",
        "-1]",
        &["the run with integrator.step = -1, cloth.stretch.stiffness = 200.0, f64: ", "greater than zero"],
    );
    refuses_with("0.005]", "1e-300]", &["integrator.step = 1e-300", "too many steps"]);
    refuses_with(STEPS, "integrator.step = 0.01", &["line 8: integrator.step must be a list", "[0.01, 0.005]"]);
    refuses_with(STEPS, "integrator.step = {}", &["line 8: integrator.step must be a list"]);
    refuses_with(STEPS, "integrator.step = []", &["line 8: integrator.step lists no value"]);
    refuses_with(STEPS, "integrator.step = [0.01, 0.02, 0.01]", &["line 8: integrator.step lists 0.01 twice"]);
    refuses_with("frame_rate = 50", "\"integrator.step\" = 1", &["line 8: integrator.step is given twice"]);
    refuses_with("[set]", "duration = 1\n[set]\nduration = 2", &["duration is given twice"]);
    refuses_with("[set]", "duration = \"x\"\n[set]", &["line 4, column 12", "expected a number"]);
    for precision in ["\"f16\"", "3", "[\"f32\", 1]"] {
        refuses_with(
            "[\"f64\", \"f32\"]",
            precision,
            &["line 2, column 13", "precision must be \"f32\", \"f64\" or a list"],
        );
    }
    for precision in ["[]", "[\"f32\", \"f32\"]"] {
        refuses_with("[\"f64\", \"f32\"]", precision, &["precision must name one or both of"]);
    }
}

#[test]
fn too_many_runs() {
    let many = (0..1001).map(|k| k.to_string()).collect::<Vec<_>>().join(", ");
    refuses_with(
        "frame_rate = 50\n\n[grid]",
        &format!("[grid]\nduration = [{many}]\nframe_rate = [{many}]"),
        &["more than 1000000"],
    );
}

#[test]
fn a_bad_run_of_another_shard() {
    let place = place();
    place.write("s.toml", SWEEP.replace("0.005]", "\"x\"]"));
    let outcome = place.muslin("sweep s.toml --shard 1/12").expect(2);
    assert!(outcome.stderr.contains("line 8: integrator.step = \"x\": "), "{}", outcome.stderr);
}

#[test]
fn files_that_are_not_there() {
    let place = Place::new();
    refuses(&place, &["cannot read s.toml"]);
    place.write("s.toml", "scene = \"skrit\"");
    refuses(&place, &["there is no file skrit", "did you mean the built-in scene skirt?"]);
    place.write("tiny.toml", "name = \"tiny\"\n");
    place.write("s.toml", "scene = \"tiny.toml\"");
    refuses(&place, &["tiny.toml: ", "missing field"]);
}

#[test]
fn scenes_are_beside_the_sweep_or_built_in() {
    let place = place();
    std::fs::create_dir(place.path("deep")).unwrap();
    std::fs::rename(place.path("tiny.toml"), place.path("deep/own.toml")).unwrap();
    place.write("deep/s.toml", "scene = \"own.toml\"\nduration = 0.05\n");
    place.muslin("sweep deep/s.toml").expect(0);
    place.write("deep/t.toml", "scene = \"cantilever\"\nduration = 0\n");
    place.muslin("sweep deep/t.toml --out t.jsonl").expect(0);
    assert_eq!(place.files("out"), ["s.jsonl"]);
    assert_eq!(crate::sweep::lines(&place, "t.jsonl")[0]["scene"], "cantilever");
}

#[test]
fn the_manual_has_one_that_runs() {
    let manual = include_str!("../../host-cli/manual/sweep.md");
    let place = Place::new();
    place.write("s.toml", blocks(manual, "toml")[0].replace("duration = 0.1 ", "duration = 0 "));
    place.muslin("sweep s.toml --quiet").expect(0);
    let all = crate::sweep::lines(&place, "out/s.jsonl");
    assert!(all.len() == 48 && all.iter().all(|line| line["steps"] == 0), "{} lines", all.len());
    assert!(manual.contains("# 48 runs, 48 lines in"));
}

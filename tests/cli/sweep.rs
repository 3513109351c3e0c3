//! `muslin sweep`: the list of runs, the contents of their lines, and the runs that are repeated.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use crate::kit::{Outcome, Place, TINY};

/// A sweep of twelve runs.
pub const SWEEP: &str = r#"scene = "tiny.toml"
precision = ["f64", "f32"]

[set]
frame_rate = 50

[grid]
integrator.step = [0.01, 0.005]
"cloth.stretch.stiffness" = [200.0, 50.0, 100]
"#;

/// A folder that contains the sweep as `s.toml`.
pub fn place() -> Place {
    let place = Place::new();
    place.write("s.toml", SWEEP);
    place
}

/// The parsed lines of a result file; panics if a line is incomplete.
#[track_caller]
pub fn lines(place: &Place, file: &str) -> Vec<Value> {
    let text = String::from_utf8(place.read(file)).unwrap();
    assert!(text.is_empty() || text.ends_with('\n'), "{file} ends in the middle of a line");
    text.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e} in {line}"))).collect()
}

/// The results that do not depend on timing, by key. Asserts that each key has one line.
#[track_caller]
pub fn results(lines: &[Value]) -> BTreeMap<String, [Value; 5]> {
    let told = |line: &Value| ["state_hash", "verdict", "steps", "work", "overrides"].map(|key| line[key].clone());
    let results: BTreeMap<_, _> =
        lines.iter().map(|line| (line["key"].as_str().unwrap().to_owned(), told(line))).collect();
    assert_eq!(results.len(), lines.len(), "a key has two lines");
    results
}

fn sweep(place: &Place, words: &str) -> Outcome {
    place.muslin(&format!("sweep {words}"))
}

#[test]
fn every_combination_is_run_in_order() {
    let place = place();
    let outcome = sweep(&place, "s.toml").expect(0);
    let lines = lines(&place, "out/s.jsonl");
    let mut expected = Vec::new();
    for step in [0.01, 0.005] {
        for stiffness in [json!(200.0), json!(50.0), json!(100)] {
            for precision in ["f64", "f32"] {
                expected.push((json!(step), stiffness.clone(), json!(precision)));
            }
        }
    }
    let of = |line: &Value| {
        let overrides = &line["overrides"];
        let varied = ["integrator.step", "cloth.stretch.stiffness"].map(|key| overrides[key].clone());
        assert_eq!((overrides.as_object().unwrap().len(), &overrides["frame_rate"]), (3, &json!(50)));
        (varied[0].clone(), varied[1].clone(), line["precision"].clone())
    };
    assert_eq!(lines.iter().map(of).collect::<Vec<_>>(), expected);
    let indices: Vec<_> = lines.iter().map(|line| line["index"].as_u64().unwrap()).collect();
    assert_eq!(indices, (0..12).collect::<Vec<_>>());
    let hashes: BTreeSet<_> = lines.iter().map(|line| line["state_hash"].as_str().unwrap()).collect();
    assert_eq!(hashes.len(), 12, "an override or a precision had no effect");

    let table: Vec<Vec<&str>> = outcome.stdout.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(table.len(), 13, "{}", outcome.stdout);
    assert_eq!(table[0][..4], ["index", "integrator.step", "cloth.stretch.stiffness", "precision"]);
    assert_eq!(table[4][..6], ["3", "0.01", "50.0", "f32", "ok", "20"]);
    assert!(outcome.stderr.contains("out/s.jsonl: 12 runs, 0 of them diverged"), "{}", outcome.stderr);
    assert_eq!(place.files("out"), ["s.jsonl"]);
}

#[test]
fn a_line_is_the_summary_of_the_run() {
    let place = place();
    sweep(&place, "s.toml --quiet").expect(0);
    let line = &lines(&place, "out/s.jsonl")[7];
    let set = "--set frame_rate=50 --set integrator.step=0.005 --set cloth.stretch.stiffness=200.0";
    let summary = place.run(&format!("tiny.toml --threads 1 {set}"));
    for (key, value) in summary.as_object().unwrap() {
        match key.as_str() {
            "wall_s" | "stage_ms" => assert!(!line[key].is_null(), "{key}"),
            _ => assert_eq!(&line[key], value, "{key}"),
        }
    }
}

/// A second, upright sheet that passes through the first, and a floor.
const TANGLED: &str = r#"
[[cloth]]
grid = { size = [0.1, 0.1], cells = [2, 2] }
position = [0.01, 1.0, 0.02]
rotation = [90.0, 10.0, 0.0]
density = 0.2

[contact]
thickness = 0.002

[[collider]]
shape = "plane"
point = [0.0, 0.9, 0.0]
normal = [0.0, 1.0, 0.0]
"#;

#[test]
fn a_line_tells_of_contact_and_the_start() {
    let place = place();
    place.write("tiny.toml", format!("{TINY}{TANGLED}"));
    place.write("s.toml", "scene = \"tiny.toml\"\n[grid]\nduration = [0, 0.1]\n");
    sweep(&place, "s.toml --quiet").expect(0);
    let all = lines(&place, "out/s.jsonl");
    for (line, duration) in all.iter().zip([0.0, 0.1]) {
        let summary = place.run(&format!("tiny.toml --duration {duration}"));
        assert!(line["intersections_untangled"].as_u64() > Some(0) && line["penetration_m"].is_f64(), "{line}");
        for key in ["intersections_untangled", "penetration_m", "contacts", "stretch", "state_hash"] {
            assert_eq!(line[key], summary[key], "{key}");
        }
    }
}

#[test]
fn what_has_its_line_is_not_run_again() {
    let place = place();
    let first = sweep(&place, "s.toml").expect(0);
    let bytes = place.read("out/s.jsonl");
    let again = sweep(&place, "s.toml").expect(0);
    assert!(again.stderr.contains("12 of 12 done before"), "{}", again.stderr);
    assert_eq!(again.stdout, first.stdout, "the table tells of all runs");
    assert!(bytes == place.read("out/s.jsonl"), "finished runs were written again");

    // Three more runs. Comments and blank lines do not change the scene.
    place.write("tiny.toml", format!("# a comment\n{}", TINY.replace("\"tiny\"\nduration", "\"tiny\"\n\nduration")));
    place.write(
        "s.toml",
        SWEEP.replace("[0.01, 0.005]", "[0.02, 0.01, 0.005]").replace("[\"f64\", \"f32\"]", "\"f32\""),
    );
    let more = sweep(&place, "s.toml").expect(0);
    assert!(more.stderr.contains("6 of 9 done before"), "{}", more.stderr);
    let all = lines(&place, "out/s.jsonl");
    assert_eq!((all.len(), results(&all).len()), (15, 15));
    assert!(all[12..].iter().all(|line| line["overrides"]["integrator.step"] == 0.02));
}

#[test]
fn a_changed_scene_is_run_anew() {
    let place = place();
    place.write("s.toml", "scene = \"sheet.toml\"\n");
    let mesh = "v 0 1 0\nv 0.1 1 0\nv 0.1 1 0.1\nv 0 1 0.1\nf 1 2 3\nf 1 3 4\n";
    let scene = TINY.replace("grid = { size = [0.3, 0.3], cells = [4, 4] }", "mesh = \"quad.obj\"");
    let scene = scene.replace("corners = [0, 1]", "vertices = [0]");
    place.write("quad.obj", mesh);
    place.write("sheet.toml", &scene);
    let mut runs = 0;
    let mut is_run = |what: &str| {
        sweep(&place, "s.toml --quiet").expect(0);
        let all = lines(&place, "out/s.jsonl");
        runs += 1;
        assert_eq!((all.len(), results(&all).len()), (runs, runs), "{what}");
    };
    is_run("the first time");
    place.write("quad.obj", mesh.replace("v 0.1 1 0\n", "v 0.11 1 0\n"));
    is_run("a vertex of the mesh moved");
    place.write("sheet.toml", scene.replace("rigidity = 1e-5", "rigidity = 2e-5"));
    is_run("a number of the scene changed");
    place.write("sheet.toml", scene.replace("duration = 0.2", "duration = 0.3"));
    is_run("the duration of the scene changed");
    place.write("s.toml", "scene = \"sheet.toml\"\nduration = 0.1\n");
    is_run("the duration of the sweep changed");
    place.write("s.toml", "scene = \"sheet.toml\"\nprecision = \"f64\"\n");
    is_run("the precision changed");
}

/// A step just beyond the limit of stability: energy appears, and the run ends before it diverges.
#[test]
fn doubtful_runs_are_counted_and_named() {
    let place = Place::new();
    let unstable = "integrator.method = \"symplectic-euler\"\nintegrator.step = 1e-6\nintegrator.error = 0\n\
                    gravity = [0, 0, 0]\ncloth.rotation = [37, 20, 10]\ncloth.position = [0.37, 7.1, 3.3]\n";
    let sweep_file = format!(
        "scene = \"tiny.toml\"\nduration = 0.05\n[set]\n{unstable}[grid]\ncloth.stretch.stiffness = [1e5, 1e7]\n"
    );
    place.write("s.toml", sweep_file);
    let outcome = sweep(&place, "s.toml").expect(0);
    assert!(outcome.stderr.contains("2 runs, 0 of them diverged, 1 doubtful"), "{}", outcome.stderr);
    let named: Vec<_> = outcome.stderr.lines().filter(|line| line.starts_with("doubtful: ")).collect();
    assert!(matches!(named[..], [line] if line.contains("cloth.stretch.stiffness")), "{}", outcome.stderr);
}

#[test]
fn divergence_is_a_result() {
    let place = Place::new();
    let methods = "integrator.method = [\"backward-euler\", \"explicit-euler\", \"bdf2\"]";
    place.write("s.toml", format!("scene = \"tiny.toml\"\n[set]\ncloth.stretch.stiffness = 1e5\n[grid]\n{methods}\n"));
    let outcome = sweep(&place, "s.toml").expect(0);
    assert!(outcome.stderr.contains("3 runs, 1 of them diverged"), "{}", outcome.stderr);
    let row: Vec<_> = outcome.stdout.lines().nth(2).unwrap().split_whitespace().collect();
    assert!(matches!(row[..], [.., "diverged", _, "-", "-"]), "neither time nor stretch are results: {row:?}");
    assert!(outcome.stderr.lines().any(|line| line.starts_with("diverged: ")), "{}", outcome.stderr);
    let all = lines(&place, "out/s.jsonl");
    let verdicts: Vec<_> = all.iter().map(|line| line["verdict"].as_str().unwrap()).collect();
    assert_eq!(verdicts, ["ok", "diverged", "ok"]);
    let why = all[1]["divergence"].as_str().unwrap();
    let failed = all[1]["steps"].as_u64().unwrap();
    assert!(why.starts_with(&format!("diverged in step {failed}: an edge is ")), "{why}");
    assert!(why.contains("integrator.step") && !why.contains("frames"), "{why}");
    assert!(sweep(&place, "s.toml").expect(0).stderr.contains("3 of 3 done before"));
}

#[test]
fn shards_part_the_grid() {
    let place = place();
    sweep(&place, "s.toml --quiet --out whole.jsonl").expect(0);
    let mut parts = Vec::new();
    for (number, indices) in
        [(1, vec![0, 5, 10]), (2, vec![1, 6, 11]), (3, vec![2, 7]), (4, vec![3, 8]), (5, vec![4, 9])]
    {
        let quiet = sweep(&place, &format!("s.toml --quiet --shard {number}/5")).expect(0);
        assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
        let part = lines(&place, &format!("out/s.{number}-of-5.jsonl"));
        assert_eq!(part.iter().map(|line| line["index"].as_u64().unwrap()).collect::<Vec<_>>(), indices);
        parts.extend(part);
    }
    assert_eq!(results(&parts), results(&lines(&place, "whole.jsonl")));
    // With more shards than runs, the last shard has no runs.
    sweep(&place, "s.toml --shard 13/13").expect(0);
    assert_eq!(place.read("out/s.13-of-13.jsonl"), b"");
    for shard in ["0/3", "4/3", "1", "1/0", "a/b", "-1/3", "1/3/5"] {
        let refused = sweep(&place, &format!("s.toml --shard={shard}")).expect(2);
        assert!(refused.stderr.contains("--shard") && refused.stderr.contains("1/8 to 8/8"), "{}", refused.stderr);
    }
}

#[test]
fn threads_change_nothing() {
    let place = place();
    place.write("tiny.toml", TINY.replace("cells = [4, 4]", "cells = [48, 48]").replace("0.2\nframe", "0.05\nframe"));
    let of = |threads: u32| {
        let file = format!("{threads}.jsonl");
        sweep(&place, &format!("s.toml --quiet --threads {threads} --out {file}")).expect(0);
        let all = lines(&place, &file);
        assert!(all.iter().all(|line| line["threads"] == threads));
        results(&all)
    };
    assert_eq!(of(1), of(3));
}

//! `muslin stability`: stability limits compared with theory, verdicts and reports. Times are never asserted.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::kit::{Place, STIFF};

/// A free sheet at rest: rounding starts its motion, and only a step above the limit makes the motion grow.
const FREE: &str = r#"name = "free"
duration = 0.4

[[cloth]]
grid = { size = [0.4, 0.35], cells = [4, 4] }
density = 0.2
stretch = { model = "membrane", stiffness = 5.0 }
shear = { stiffness = 2.0 }
bend = { model = "hinge", rigidity = 1e-4 }

[integrator]
step = 0.005
"#;

const SCALES: [f64; 5] = [0.0625, 0.25, 1.0, 4.0, 16.0];

fn map(words: &str) -> (Place, Value) {
    map_of(FREE, words)
}

fn map_of(scene: &str, words: &str) -> (Place, Value) {
    let place = Place::new();
    place.write("free.toml", scene);
    let code = if words.contains("--budget") { 3 } else { 0 };
    let map = place.muslin(&format!("stability free.toml --json {words}")).expect(code).json();
    (place, map)
}

fn limit<'a>(map: &'a Value, method: &str, newton: u64) -> &'a Value {
    let mut limits = map["limits"].as_array().unwrap().iter();
    limits.find(|limit| limit["method"] == method && limit["newton"] == newton).unwrap()
}

fn rows<'a>(map: &'a Value, method: &str) -> impl Iterator<Item = &'a Value> {
    map["rows"].as_array().unwrap().iter().filter(move |row| row["method"] == method)
}

#[test]
fn limits_are_those_of_the_fastest_mode() {
    let (place, map) = map("");
    for method in ["symplectic-euler", "rk4"] {
        let limit = limit(&map, method, 1);
        let ratio = limit["ratio"].as_f64().unwrap();
        println!("{method}: {limit}");
        // The flat sheet is linear while its motion is small.
        assert!((ratio - 1.0).abs() <= 0.005, "{method}: measured over theory {ratio}, expected 1 within 0.5 %");
        for row in rows(&map, method) {
            let (step, theory) = (row["step"].as_f64().unwrap(), row["theory"].as_f64().unwrap());
            assert_eq!(row["verdict"] == "fine", step <= theory, "{row}");
            assert_eq!(row["why"].is_null(), row["verdict"] == "fine", "{row}");
        }
        let scales: BTreeSet<_> = rows(&map, method).map(|row| row["stiffness_scale"].to_string()).collect();
        assert_eq!(scales, SCALES.map(|scale| Value::from(scale).to_string()).into(), "{method}");
    }
    for method in ["explicit-euler", "midpoint"] {
        assert_eq!(limit(&map, method, 1)["theory"], 0.0, "{method} is never stable without damping");
        assert!(limit(&map, method, 1)["ratio"].is_null());
    }
    for (method, newton) in [("backward-euler", 1), ("backward-euler", 20), ("implicit-midpoint", 1), ("bdf2", 1)] {
        let limit = limit(&map, method, newton);
        assert!(limit["theory"].is_null() && limit["failed"].is_null(), "{limit}");
        assert_eq!(limit["measured"], 0.02, "the longest step of twenty in the scene: {limit}");
        assert_eq!(
            (&limit["watched_s"], &limit["whole"]["held_s"]),
            (&map["duration_s"], &map["duration_s"]),
            "{limit}"
        );
        assert_eq!((&limit["whole"]["verdict"], &limit["whole"]["lasting"]), (&"fine".into(), &limit["measured"]));
    }
    let controlled = map["controlled"].as_array().unwrap();
    assert_eq!(controlled.len(), 4 * SCALES.len(), "each implicit method on each scale");
    for row in controlled {
        assert_eq!((&row["error_m"], &row["step"]), (&0.001.into(), &0.02.into()), "the default error: {row}");
    }
    let undamped = map["rows"].as_array().unwrap().iter().all(|row| row["damping_scale"] == 1.0);
    assert!(undamped && map["damping_ratio"] == 0.0, "there is nothing to scale");

    let files = ["stability.json", "stability.svg", "stability.txt", "study.html"];
    assert_eq!(place.files("out/free"), files);
    let text = String::from_utf8(place.read("out/free/stability.txt")).unwrap();
    for words in ["/theory", "to the end, 400.00 ms", "fails from, by stiffness", "agree with it"] {
        assert!(text.contains(words), "{words:?} is not in {text}");
    }
}

/// On a sheet that swings from two corners the longest steps of implicit midpoint fail. Error control divides them.
#[test]
fn error_control_is_shown_beside_the_longest_steps() {
    let scene = FREE
        .replace("duration = 0.4", "duration = 2.0\ngravity = [0.0, -9.81, 0.0]")
        .replace("stiffness = 5.0", "stiffness = 100.0")
        .replace("bend =", "pin = [{ select = { corners = [0, 1] } }]\nbend =");
    let (place, map) = map_of(&scene, "--methods symplectic-euler,implicit-midpoint --set integrator.error=0.0005");
    let longest = rows(&map, "implicit-midpoint").filter_map(|row| row["step"].as_f64()).fold(0.0, f64::max);
    let fails = |row: &Value| row["step"] == longest && row["verdict"] != "fine";
    assert!(rows(&map, "implicit-midpoint").any(fails), "{}", map["rows"]);

    let controlled = map["controlled"].as_array().unwrap();
    let scales: BTreeSet<_> = controlled.iter().map(|row| row["stiffness_scale"].to_string()).collect();
    assert_eq!(scales, SCALES.map(|scale| Value::from(scale).to_string()).into(), "{controlled:?}");
    for row in controlled {
        assert_eq!((&row["method"], &row["verdict"]), (&"implicit-midpoint".into(), &"fine".into()), "{row}");
        assert_eq!((row["step"].as_f64(), row["error_m"].as_f64()), (Some(longest), Some(0.0005)), "{row}");
        let number = |key: &str| row[key].as_f64().unwrap();
        assert!(number("substeps") > number("steps") && number("taken_back") > 0.0, "{row}");
        assert!(number("shortest_s") < number("mean_s") && number("mean_s") < longest, "{row}");
        assert!((number("mean_s") * number("substeps") / number("watched_s") - 1.0).abs() < 1e-6, "{row}");
    }

    let text = String::from_utf8(place.read("out/free/stability.txt")).unwrap();
    let (_, table) = text.split_once("error control, by stiffness").expect("a table");
    let line = table.lines().nth(1).unwrap();
    assert!(line.starts_with("implicit-midpoint") && line.matches(" ms, ").count() == 5, "{text}");
    assert!(text.contains("by errors of at most 0.5 mm and steps of at most 80 ms"), "{text}");
    assert!(String::from_utf8(place.read("out/free/stability.svg")).unwrap().contains("with error control"));
}

#[test]
fn damping_is_mapped_where_there_is_some() {
    let (_, map) = map("--methods symplectic-euler --set cloth.stretch.damping=0.001");
    assert!(map["damping_ratio"].as_f64().unwrap() > 0.0);
    let by_damping: Vec<_> = rows(&map, "symplectic-euler").filter(|row| row["damping_scale"] != 1.0).collect();
    let scales: BTreeSet<_> = by_damping.iter().map(|row| row["damping_scale"].to_string()).collect();
    assert_eq!(scales.len(), 4, "{scales:?}");
    // The method takes damping with the velocity of the step before, so more damping lowers the limit.
    let theory = |scale: f64| by_damping.iter().find(|row| row["damping_scale"] == scale).unwrap()["theory"].as_f64();
    assert!(theory(16.0) < theory(4.0) && theory(4.0) < theory(0.25), "{by_damping:?}");
    assert!(map["rows"].as_array().unwrap().iter().all(|row| row["method"] == "symplectic-euler"));
}

/// The sheet is so stiff that 1000 steps end before the pull begins. A stretched sheet is stiffer, so the limit
/// that is measured over these steps does not hold to the end of the scene.
#[test]
fn the_longest_step_is_watched_to_the_scene_s_end() {
    let scene = FREE.replace("stiffness = 5.0", "stiffness = 5e4").replace(
        "bend =",
        r#"pin = [{ select = { edge = "left" } }, { select = { edge = "right" }, motion = { keys = [[0, 0, 0, 0], [0.2, 0, 0, 0], [0.4, 0.2, 0, 0]] } }]
bend ="#,
    );
    let (place, map) = map_of(&scene, "--methods symplectic-euler");
    let limit = limit(&map, "symplectic-euler", 1);
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{limit}"));
    let (measured, whole) = (number(&limit["measured"]), &limit["whole"]);
    assert!(number(&limit["watched_s"]) < 0.2, "{limit}");
    assert!(whole["verdict"] != "fine" && (0.2..0.4).contains(&number(&whole["held_s"])), "{limit}");
    let lasting = number(&whole["lasting"]);
    assert!(lasting <= 0.951 * measured, "{limit}");
    let text = String::from_utf8(place.read("out/free/stability.txt")).unwrap();
    let line = text.lines().find(|line| line.starts_with("symplectic-euler")).unwrap();
    assert!(line.contains(" ms by ") && line.ends_with("holds"), "{text}");
}

/// Without damping explicit Euler gains energy with every step. The report must not show a limit as if shorter steps
/// were stable.
#[test]
fn no_step_is_advised_where_every_step_gains_energy() {
    let (place, map) = map("--methods explicit-euler,symplectic-euler");
    assert_eq!(limit(&map, "explicit-euler", 1)["theory"], 0.0);
    let text = String::from_utf8(place.read("out/free/stability.txt")).unwrap();
    assert!(text.contains("explicit-euler gains energy with every step, because nothing damps the cloth"), "{text}");
    assert_eq!(text.matches("gains energy").count(), 1, "symplectic Euler has a limit: {text}");
}

/// A damped sheet swings and is pulled tight. Its motion across the tension is not damped, so explicit Euler gains
/// energy there also below the limit that holds at the start, and the report advises no step.
#[test]
fn no_step_is_advised_if_none_that_was_tried_holds_to_the_end() {
    let (place, map) = map_of(STIFF, "--methods explicit-euler");
    let limit = limit(&map, "explicit-euler", 1);
    assert!(limit["measured"].is_number() && limit["theory"].as_f64().unwrap() > 0.0, "{limit}");
    assert!(limit["whole"]["verdict"] != "not run" && limit["whole"]["lasting"].is_null(), "{limit}");
    let text = String::from_utf8(place.read("out/free/stability.txt")).unwrap();
    assert!(text.contains("explicit-euler: no step is advised"), "{text}");
}

#[test]
fn what_the_budget_leaves_out_is_said() {
    let (place, map) = map("--budget 0");
    assert!(map["rows"].as_array().unwrap().iter().all(|row| row["verdict"] == "not run"), "{}", map["rows"]);
    let text = String::from_utf8(place.read("out/free/stability.txt")).unwrap();
    assert!(text.contains("runs are missing") && text.matches("not run").count() == 8, "{text}");
    for limit in map["limits"].as_array().unwrap() {
        assert!(limit["measured"].is_null() && limit["ratio"].is_null() && limit["runs"] == 0, "{limit}");
    }
    let controlled = map["controlled"].as_array().unwrap();
    assert!(!controlled.is_empty() && controlled.iter().all(|row| row["verdict"] == "not run"), "{controlled:?}");
}

#[test]
fn where_nothing_pulls_nothing_limits() {
    let (_, map) = map("--methods rk4,backward-euler --set cloth.pin=[{select={box=[[-9,-9,-9],[9,9,9]]}}]");
    let rk4 = limit(&map, "rk4", 1);
    assert!(rk4["theory"].is_null() && rk4["runs"] == 0, "{rk4}");
    assert_eq!(limit(&map, "backward-euler", 1)["measured"], 0.02);
}

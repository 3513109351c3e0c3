//! The verdict of a run and its warnings: errors that feed energy are doubted, work from outside is not.

use serde_json::Value;

use crate::kit::{Place, TINY};

/// A sheet of a millimetre on a ball, with the error that suits a sheet of a metre.
const MILLIMETRE: &str = "ball --set cloth.scale=0.001 --set cloth.grid.cells=[20,20] --set cloth.position=[0,0.00075,0] \
    --set collider=[{shape=\"sphere\",center=[0,0.0004,0],radius=0.0003},{shape=\"plane\",point=[0,0,0],normal=[0,1,0]}] \
    --set contact.thickness=4e-6 --precision f64 --duration 0.1";

fn codes(summary: &Value) -> Vec<&str> {
    summary["warnings"].as_array().unwrap().iter().map(|warning| warning["code"].as_str().unwrap()).collect()
}

/// The summary of a run with this exit code.
fn run(place: &Place, words: &str, code: i32) -> Value {
    place.muslin(&format!("run {words} --out out --preview none --export none --json --quiet")).expect(code).json()
}

#[test]
fn energy_from_nowhere_is_doubted() {
    let place = Place::new();
    let (coarse, fine) =
        (run(&place, MILLIMETRE, 3), run(&place, &format!("{MILLIMETRE} --set integrator.error=1e-5"), 0));
    let appeared = |summary: &Value| {
        let part = |key: &str| summary["energy_balance"][key].as_f64().unwrap();
        part("appeared") / part("moved")
    };
    println!("{} and {} of the energy that moved appeared", appeared(&coarse), appeared(&fine));
    assert_eq!((&coarse["verdict"], &fine["verdict"]), (&Value::from("doubtful"), &Value::from("ok")));
    assert!(codes(&coarse).contains(&"energy"), "{}", coarse["warnings"]);
    assert!(coarse["doubt"].as_str().unwrap().contains("appeared from nowhere"), "{}", coarse["doubt"]);
    assert_eq!((codes(&fine), &fine["doubt"]), (vec![], &Value::Null));
}

/// Pins, colliders and wind give energy, and the cloth cannot have more than it was given.
#[test]
fn work_from_outside_is_no_reason_for_doubt() {
    let place = Place::new();
    for (words, giver) in
        [("twist --duration 0.5", "pins"), ("poncho --duration 2", "colliders"), ("flag --duration 1", "wind")]
    {
        let summary = run(&place, words, 0);
        let balance = &summary["energy_balance"];
        let [given, appeared] = [giver, "appeared"].map(|key| balance[key].as_f64().unwrap());
        assert_eq!(summary["verdict"], "ok", "{words}: {balance}");
        assert!(given > 0.1 && appeared < 0.2 * given, "{words}: {balance}");
    }
}

/// A dragged corner lifts the sheet: the work of the pin is what gravity and springs hold, and what friction took.
#[test]
fn a_lifted_sheet_has_the_energy_of_its_pins() {
    let place = Place::new();
    let pins = "select = { box = [[-1, 0.9, -1], [1, 1.1, 1]] }\nmotion = { keys = [[0, 0, 0, 0], [0.2, 0, 0.5, 0]] }";
    place.write("lifted.toml", TINY.replace("select = { corners = [0, 1] }", pins));
    for method in ["backward-euler", "implicit-midpoint", "bdf2", "symplectic-euler"] {
        let words = format!(
            "lifted.toml --set integrator.method={method} --set integrator.step=0.0005 --precision f64 --duration 0.1"
        );
        let summary = run(&place, &words, 0);
        // All vertices are pinned and move at 2.5 m/s: 18 g are lifted by a quarter of a metre.
        let work = summary["energy_balance"]["pins"].as_f64().unwrap();
        let mass = summary["mass_kg"].as_f64().unwrap();
        assert!((work / (mass * 9.81 * 0.25) - 1.0).abs() < 1e-3, "{method}: {work} J to lift {mass} kg");
    }
}

#[test]
fn every_note_is_in_the_summary_and_in_the_lines_of_a_sweep() {
    let place = Place::new();
    place.write("tiny.toml", TINY);
    let explicit = "tiny.toml --set integrator.method=rk4 --set integrator.step=0.03 --duration 0.12";
    let summary = run(&place, explicit, 3);
    assert_eq!(codes(&summary), ["step", "duration", "unstable"], "{}", summary["warnings"]);
    let told = place.muslin(&format!("run {explicit} --out out --preview none")).expect(3).stderr;
    for warning in summary["warnings"].as_array().unwrap() {
        assert!(told.contains(warning["text"].as_str().unwrap()), "{warning} is not in {told}");
    }
    let soft = "--set cloth.stretch.stiffness=0.25 --set cloth.stretch.damping=0.2 --set cloth.shear.stiffness=0.25";
    let summary = run(&place, &format!("tiny.toml {soft} --duration 1"), 0);
    assert_eq!((codes(&summary), &summary["verdict"]), (vec!["stretch"], &Value::from("ok")));

    place
        .write("s.toml", "scene = \"tiny.toml\"\n[set]\nduration = 0.12\n[grid]\n\"integrator.step\" = [0.01, 0.03]\n");
    place.muslin("sweep s.toml --out all.jsonl --quiet").expect(0);
    let lines = String::from_utf8(place.read("all.jsonl")).unwrap();
    let warned: Vec<_> =
        lines.lines().map(|line| serde_json::from_str::<Value>(line).unwrap()["warnings"].clone()).collect();
    assert!(
        warned.iter().all(|warnings| warnings[0]["code"] == "step" || warnings[0]["code"] == "duration"),
        "{warned:?}"
    );
}

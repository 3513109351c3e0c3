//! Options that change the run, and the text of `--help`.

use serde_json::Value;

use crate::kit::{Place, TINY};

/// A second sheet at a height of 2 m, without pins.
const SECOND: &str = "\n[[cloth]]\ngrid = { size = [0.3, 0.3], cells = [2, 2] }\nposition = [0, 2, 0]\ndensity = 0.2\n";

fn number(summary: &Value, section: &str, key: &str) -> f64 {
    summary[section][key].as_f64().unwrap()
}

#[test]
fn set_takes_numbers_words_and_arrays() {
    let place = Place::new();
    let run = |words: &str| place.run(&format!("tiny.toml {words}"));
    let plain = run("");
    let changed = run("--set integrator.step=0.005 --set integrator.method=bdf2 --set cloth.grid.cells=[2,2]");
    assert_eq!(
        (&plain["steps"], &plain["method"], &plain["vertices"]),
        (&20.into(), &"backward-euler".into(), &27.into())
    );
    assert_eq!((&changed["steps"], &changed["method"], &changed["vertices"]), (&40.into(), &"bdf2".into(), &10.into()));
    assert_eq!(run("--set name=\"other\"")["scene"], "other");
    assert!(number(&run("--set gravity=[0,0,0]"), "energy", "kinetic") < 1e-12);
    assert!(number(&run("--set gravity=[0,9.81,0] --set cloth.pin=[]"), "energy", "gravity") < -0.1);
    assert!(run("--set gravity.1=-1")["momentum"][1].as_f64() > plain["momentum"][1].as_f64());
}

#[test]
fn set_reaches_one_cloth_or_all() {
    let place = Place::new();
    place.write("two.toml", TINY.to_owned() + SECOND);
    // Gravitational energy at the start, m g h, divided by the energy of the first sheet.
    let potential = |words: &str| {
        let summary = place.run(&format!("two.toml --duration 0 {words}"));
        number(&summary, "energy", "gravity") / (0.2 * 0.3 * 0.3 * 9.81)
    };
    let expect = |words: &str, expected: f64| {
        let found = potential(words);
        assert!((found - expected).abs() < 1e-5, "{words}: {found}, not {expected}");
    };
    expect("", 3.0);
    expect("--set cloth.density=0.4", 6.0);
    expect("--set cloth.0.density=0.4", 4.0);
    expect("--set cloth.1.density=0.4", 5.0);
    expect("--set cloth.density=0.4 --set cloth.1.density=0.2", 4.0);
}

#[test]
fn a_new_section_may_take_several_overrides() {
    let place = Place::new();
    let shear = "--set cloth.shear.damping=0.001 --set cloth.shear.stiffness=10";
    place.write("bare.toml", TINY.replace("[cloth.shear]\nstiffness = 50.0\n", ""));
    assert!(number(&place.run(&format!("bare.toml {shear}")), "energy", "shear") > 0.0);
    let outcome = place.muslin("run bare.toml --out no --set cloth.shear.damping=0.001").expect(2);
    assert!(outcome.stderr.contains("--set cloth.shear.damping=0.001: missing field `stiffness`"), "{outcome:?}");
}

#[test]
fn duration_and_precision() {
    let place = Place::new();
    assert_eq!(place.run("tiny.toml --duration 0.1")["steps"], 10);
    assert_eq!(place.run("tiny.toml --duration 1e-1 --set duration=7")["steps"], 10);
    let [single, double] = ["f32", "f64"].map(|name| place.run(&format!("tiny.toml --precision {name}")));
    assert_eq!((&single["precision"], &double["precision"]), (&"f32".into(), &"f64".into()));
    assert_ne!(single["state_hash"], double["state_hash"]);
    let [a, b] = [single, double].map(|summary| number(&summary, "energy", "gravity"));
    assert!((a - b).abs() < 1e-3 * b.abs(), "f32 {a} does not follow f64 {b}");
}

/// A step that is not written to the last digit would else cost one more step in each frame of 0.05 s.
#[test]
fn a_step_within_a_thousandth_of_an_equal_part_of_the_frame_is_that_part() {
    let place = Place::new();
    let run = |step: f64| place.run(&format!("tiny.toml --set integrator.newton=20 --set integrator.step={step:?}"));
    let sixth = run(0.05 / 6.0);
    assert_eq!(sixth["steps"], 4 * 6);
    for rounded in [0.00833, 0.008333, 0.00834] {
        assert_eq!(run(rounded)["state_hash"], sixth["state_hash"], "{rounded}");
    }
    for (step, steps) in [(0.00832, 7), (0.04999, 1), (0.0499, 2), (0.05001, 1), (0.3, 1)] {
        assert_eq!(run(step)["steps"], 4 * steps, "{step}");
    }
}

#[test]
fn says_when_time_does_not_divide_as_asked() {
    let place = Place::new();
    let notes = |words: &str| place.muslin(&format!("run tiny.toml --out out --preview none {words}")).expect(0).stderr;
    assert!(notes("--set integrator.step=0.03").contains("taking 2 steps of 25.0000 ms"));
    assert!(
        notes("--set integrator.step=0.3 --set integrator.newton=20")
            .contains("longer than a frame: taking one step of 50.0000 ms")
    );
    assert!(notes("--duration 0.12").contains("taking 3 frames, 0.1500 s"));
    assert!(!notes("--set integrator.step=0.0084").contains("taking"), "a hair less is not worth a note");
    assert!(!notes("").contains("taking"));
    assert!(notes("--quiet --duration 0.12").contains("taking 3 frames"), "warnings are not for hushing");
    assert_eq!(notes("--quiet"), "");
}

#[test]
fn every_command_has_help_with_an_example() {
    let place = Place::new();
    for command in
        ["", "run", "detect", "chart", "stability", "needs", "choose", "validate", "sweep", "scenes", "bench"]
    {
        let [long, short] = ["--help", "-h"].map(|flag| place.muslin(&format!("{command} {flag}")).expect(0));
        assert_eq!((long.stderr.as_str(), short.stderr.as_str()), ("", ""));
        for help in [long.stdout, short.stdout] {
            let example = help.split_once("Example").unwrap_or_else(|| panic!("{command} has none: {help}")).1;
            assert!(example.contains(format!("  muslin {command}").trim_end()), "{command}: {help}");
        }
    }
    let usage = place.muslin("").expect(2);
    assert!(usage.stdout.is_empty() && usage.stderr.contains("muslin run flag"), "{usage:?}");
    assert_eq!(place.muslin("--version").expect(0).stdout, format!("muslin {}\n", env!("CARGO_PKG_VERSION")));
}

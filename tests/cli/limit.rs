//! Before it starts, a run notes a step above the stability limit of its method and suggests a stable step.

use crate::kit::Place;

/// The number after `said` in a note, up to a comma or the end of the line.
fn named(note: &str, said: &str) -> f64 {
    let rest = note.split(said).nth(1).unwrap_or_else(|| panic!("{said:?} is not in {note:?}"));
    rest.split([',', '\n']).next().unwrap().parse().unwrap_or_else(|error| panic!("{error} in {note:?}"))
}

const STIFF: &str = "--preview none --out out --set cloth.stretch.stiffness=1e4 --set integrator.method=";

#[test]
fn the_step_that_is_named_is_borne_and_a_little_more_is_not() {
    let place = Place::new();
    for method in ["symplectic-euler", "rk4"] {
        let run = |step: f64, code: i32| {
            let words = format!("run tiny.toml {STIFF}{method} --set integrator.step={step}");
            place.muslin(&words).expect(code).stderr
        };
        let note = run(0.01, 3);
        assert!(note.contains("step 10.00 ms is longer than"), "{note:?}");
        let safe = named(&note, "--set integrator.step=");
        assert!(!run(safe, 0).contains("longer than"), "{method} at {safe} s");
        // The suggested step is four fifths of the limit, rounded to two digits.
        assert!(run(1.5 * safe, 3).contains("longer than"), "{method} at {safe} s and a half");
    }
}

#[test]
fn methods_that_never_bear_it_are_said_to_be_so() {
    let place = Place::new();
    for method in ["explicit-euler", "midpoint"] {
        let words = "run tiny.toml --preview none --out out --duration 0.05 --set integrator.step=1e-6";
        let words = format!("{words} --set integrator.method={method}");
        let note = place.muslin(&words).expect(0).stderr;
        assert!(note.contains(&format!("{method} gains energy in every step without damping")), "{note:?}");
        let damped = place.muslin(&format!("{words} --set cloth.stretch.damping=1e-4")).expect(0).stderr;
        assert!(!damped.contains("gains energy"), "{damped:?}");
    }
}

#[test]
fn masses_that_single_precision_loses_are_said_to_be_lost() {
    let place = Place::new();
    let run = |words: &str| {
        let words = format!("run tiny.toml --preview none --out out --duration 0.05 --set integrator.method={words}");
        place.muslin(&words).stderr.contains("single precision rounds such masses away")
    };
    let stiff = "--set cloth.stretch.stiffness=1e9 --set integrator.step=0.01";
    assert!(run(&format!("backward-euler {stiff}")) && run(&format!("bdf2 {stiff}")));
    assert!(!run("backward-euler") && !run(&format!("backward-euler {stiff} --precision f64")));
}

#[test]
fn masses_are_lost_only_on_a_long_way_and_in_long_steps() {
    let place = Place::new();
    let run = |seconds: f64, error: f64| {
        let words = format!("run tiny.toml --preview none --out out --duration {seconds}");
        let words = format!("{words} --set cloth.stretch.stiffness=3e6 --set integrator.error={error}");
        place.muslin(&words).stderr.contains("single precision rounds such masses away")
    };
    assert!(run(0.5, 0.0) && run(0.5, 1e-2), "the cloth falls by its size");
    assert!(!run(0.05, 0.0), "it falls by a twenty-fifth of its size");
    assert!(!run(0.5, 1e-5), "error control takes steps of a tenth");
}

#[test]
fn nothing_is_said_where_nothing_limits() {
    let place = Place::new();
    for (words, is_said) in [("backward-euler", false), ("rk4 --quiet", true)] {
        let outcome = place.muslin(&format!("run tiny.toml {STIFF}{words}"));
        assert_eq!(outcome.stderr.contains("longer than"), is_said, "{outcome:?}");
    }
}

//! `muslin chart`: orders, error floors, counts and refused scenes. Times are never asserted. Where the cost of
//! a run matters, it is computed from counts.

use serde_json::Value;

use crate::kit::{Place, TINY, in_page, soft_in_air};

const METHODS: [(&str, f64); 7] = [
    ("explicit-euler", 1.0),
    ("symplectic-euler", 1.0),
    ("midpoint", 2.0),
    ("rk4", 4.0),
    ("backward-euler", 1.0),
    ("implicit-midpoint", 2.0),
    ("bdf2", 2.0),
];

/// The runs of a method in a precision with the scene's own solver, from coarse to fine.
fn series<'a>(chart: &'a Value, method: &str, precision: &str) -> impl Iterator<Item = &'a Value> {
    let rows = chart["rows"].as_array().unwrap().iter();
    rows.filter(move |row| row["method"] == method && row["precision"] == precision && row["solver"].is_null())
}

/// Those with fixed steps.
fn rows<'a>(chart: &'a Value, method: &str, precision: &str) -> Vec<&'a Value> {
    series(chart, method, precision).filter(|row| row["allowed_error_m"].is_null()).collect()
}

/// Those under error control.
fn controlled<'a>(chart: &'a Value, method: &str, precision: &str) -> Vec<&'a Value> {
    series(chart, method, precision).filter(|row| row["allowed_error_m"].is_f64()).collect()
}

/// The force evaluations of the cheapest run in double precision with an RMS error of at most `error`, m.
fn evaluations(chart: &Value, method: &str, error: f64) -> u64 {
    let near =
        rows(chart, method, "f64").into_iter().filter(|row| row["error_rms"].as_f64().is_some_and(|e| e <= error));
    near.map(|row| row["force_evaluations"].as_u64().unwrap()).min().unwrap_or_else(|| panic!("{method} at {error}"))
}

#[test]
fn a_soft_sheet_is_charted_by_every_method() {
    let place = Place::new();
    place.write("soft.toml", soft_in_air(0.1));
    let chart = place.muslin("chart soft.toml --finest 5e-5 --cost counts --json").expect(0).json();

    for (method, theory) in METHODS {
        let order = chart["orders"].as_array().unwrap().iter().find(|order| order["method"] == method).unwrap();
        let measured = order["measured"].as_f64().unwrap();
        println!("{method}: order {measured:.3}, theory {theory}");
        assert_eq!(order["theory"], theory);
        assert!((measured - theory).abs() <= 0.1, "{method}: order {measured}, theory {theory}");
    }
    assert_eq!(chart["omitted"], Value::Array(Vec::new()));

    let (least, own) = (&chart["reference"]["least_charted"], &chart["reference"]["self_error"]);
    assert!((least.as_f64().unwrap() / own.as_f64().unwrap() / 1e3 - 1.0).abs() < 1e-12, "{least} of {own}");
    for row in chart["rows"].as_array().unwrap() {
        assert!(row["step"].as_f64().unwrap() >= 5e-5, "{row} is finer than what was asked for");
        // A row has no error if its run failed or if its error is too small for the reference to measure.
        assert_eq!(row["error_rms"].is_null(), !row["why"].is_null(), "{row}");
        assert!(row["stable"] == true || row["error_rms"].is_null(), "{row}");
        assert!(row["error_rms"].as_f64().is_none_or(|error| error >= least.as_f64().unwrap()), "{row}");
        assert!(row["error_max"].as_f64() >= row["error_rms"].as_f64(), "{row}");
        assert_eq!(row["stretch"].is_number(), row["stable"] == true, "a run that fails has no stretch: {row}");
    }
    let order = chart["reference"]["order"].as_f64().unwrap();
    assert!((order - 4.0).abs() < 0.1, "the reference converges by order {order}");
    let agreement = &chart["reference"]["agreement"];
    assert!(agreement["error_rms"].as_f64().unwrap() < 1e-6, "an implicit method agrees by {agreement}");

    for method in ["symplectic-euler", "midpoint", "rk4"] {
        let steps = rows(&chart, method, "f64");
        assert!(steps[0]["stable"] == false && steps[1]["stable"] == true, "{method} does not begin beyond its limit");
        let halved = steps[0]["step"].as_f64().unwrap() / steps[1]["step"].as_f64().unwrap();
        assert!((halved - 2.0).abs() < 1e-12, "{method}: {halved}");
    }
    // At a small error a method of higher order needs fewer evaluations.
    let [rk4, midpoint, euler] = ["rk4", "midpoint", "symplectic-euler"].map(|m| evaluations(&chart, m, 1.2e-4));
    assert!(2 * rk4 < midpoint && 2 * midpoint < euler, "evaluations for 1.2e-4: {rk4}, {midpoint}, {euler}");

    // In single precision rounding limits the smallest error of RK4.
    let least = |precision| {
        rows(&chart, "rk4", precision).iter().filter_map(|row| row["error_rms"].as_f64()).fold(1.0, f64::min)
    };
    let (single, double) = (least("f32"), least("f64"));
    assert!(single > 10.0 * double, "floors: f32 {single}, f64 {double}");

    error_control_is_charted(&chart);
    assert_eq!(place.files("out/soft"), ["chart.json", "chart.svg", "chart.txt", "study.html"]);
    let svg = String::from_utf8(place.read("out/soft/chart.svg")).unwrap();
    let page = String::from_utf8(place.read("out/soft/study.html")).unwrap();
    assert!(svg.starts_with("<svg") && page.contains(&in_page(&svg, "chart")), "the page shows the picture");
    let (clips, used) = (page.matches("<clipPath id=\"chart-").count(), page.matches("url(#chart-").count());
    assert!(clips > 0 && used >= clips, "names in the picture: {clips} clips, {used} used");
    for name in METHODS.map(|(method, _)| method).into_iter().chain(PANELS) {
        assert!(svg.contains(name), "{name} is not in the picture");
    }
    let words = String::from_utf8(place.read("out/soft/chart.txt")).unwrap();
    assert!(!words.contains("not small yet"), "{words}");
}

/// Words of the panels and the legend.
const PANELS: [&str; 8] =
    ["f32", "failed", "hollow", "um", "error control", "cheapest", "error by cause", "of the linearisation"];

/// Implicit methods have runs with an allowed error: a smaller one takes more steps to a smaller error.
fn error_control_is_charted(chart: &Value) {
    for (method, _) in METHODS {
        for precision in ["f64", "f32"] {
            let runs = controlled(chart, method, precision);
            assert_eq!(runs.len() > 2, IMPLICIT.contains(&method), "{method} {precision}: {runs:?}");
            let column = |key: &str| runs.iter().filter_map(|row| row[key].as_f64()).collect::<Vec<_>>();
            let [allowed, steps, reached] = ["allowed_error_m", "steps", "error_rms"].map(column);
            println!("{method} {precision}: {allowed:?} m allowed, {reached:?} reached in {steps:?} steps");
            assert!(allowed.is_sorted_by(|a, b| a > b) && steps.is_sorted(), "{method} {precision}");
            if let ([coarse, ..], [.., fine]) = (reached.as_slice(), reached.as_slice()) {
                assert!(10.0 * fine < *coarse, "{method} {precision}: {reached:?}");
            }
        }
    }
}

const IMPLICIT: [&str; 3] = ["backward-euler", "implicit-midpoint", "bdf2"];

/// The report explains why errors are not separated, and how to separate them.
#[test]
fn without_causes_it_says_why() {
    let place = Place::new();
    place.write("soft.toml", soft_in_air(0.1));
    let told = |words: &str| {
        let words = format!("chart soft.toml --methods bdf2 --finest 1e-3 --cost counts --json {words}");
        let chart = place.muslin(&words).expect(0).json();
        assert!(chart["causes"].is_null(), "{chart}");
        let text = String::from_utf8(place.read("out/soft/chart.txt")).unwrap();
        let why = chart["no_causes"].as_str().unwrap().to_owned();
        assert!(text.lines().any(|line| line == why), "{why} is not in {text}");
        why
    };
    let not_run = "No error by cause: backward-euler, the scene's method, was not run; name it in --methods";
    assert_eq!(told(""), not_run);
    assert!(
        told("--set integrator.method=rk4").starts_with("No error by cause: rk4, the scene's method, is explicit:")
    );
}

/// The cheapest implicit runs are repeated with other solvers, and the errors of backward Euler, the scene's method,
/// are separated: the error of the step falls by first order and that of the linearisation by a single Newton iteration
/// faster.
#[test]
fn the_solver_is_varied_and_errors_are_separated() {
    let place = Place::new();
    place.write("soft.toml", soft_in_air(0.1));
    let words = "chart soft.toml --methods backward-euler,bdf2 --finest 1e-3 --cost counts --json";
    let chart = place.muslin(words).expect(0).json();
    let svg = String::from_utf8(place.read("out/soft/chart.svg")).unwrap();
    assert!(svg.contains("other solver"), "runs with another solver are drawn");
    let rows = chart["rows"].as_array().unwrap().iter();
    let varied: Vec<_> = rows.filter_map(|row| row["solver"].as_str()).collect();
    for solver in ["Newton to convergence", "10 times as loose", "100 times as loose"] {
        assert!(varied.contains(&solver), "{solver}: {varied:?}");
    }
    let causes = &chart["causes"];
    assert_eq!(causes["method"], "backward-euler");
    let steps = causes["steps"].as_array().unwrap();
    assert!(steps.len() > 4, "{causes}");
    let fall = |key: &str| {
        let [first, last] = [&steps[0], &steps[4]].map(|cause| cause[key].as_f64().unwrap());
        (first / last).log2() / 4.0
    };
    let [step, newton] = [fall("of_step"), fall("linearisation")];
    println!("the error of the step falls by order {step:.2}, that of one Newton iteration by {newton:.2}");
    assert!((step - 1.0).abs() < 0.2 && newton > step + 0.5, "orders {step} and {newton}: {causes}");
}

#[test]
fn with_contact_the_outline_is_charted() {
    let place = Place::new();
    let ball = "\n[[collider]]\nshape = \"sphere\"\ncenter = [0.0, 0.8, 0.0]\nradius = 0.15\n\
                [contact]\nthickness = 0.004\n";
    place.write("drop.toml", format!("{}{ball}", TINY.replace("[[cloth.pin]]\nselect = { corners = [0, 1] }\n", "")));
    let outcome =
        place.muslin("chart drop.toml --cost counts --budget 1 --methods backward-euler,bdf2 --json").expect(0);
    let chart = outcome.json();
    assert_eq!(chart["measure"], "outline");
    assert!(chart["reference"]["agreement"].is_null());
    let good: Vec<_> = rows(&chart, "backward-euler", "f64").into_iter().filter(|row| row["stable"] == true).collect();
    assert!(good.len() > 2, "{chart}");
    for row in good {
        assert_eq!(row["penetration_m"], 0.0, "{row}");
        assert!(row["stretch"].as_f64().unwrap() >= 1.0, "{row}");
    }
    assert!(controlled(&chart, "backward-euler", "f32").iter().any(|row| row["stable"] == true), "{chart}");
    let words = String::from_utf8(place.read("out/drop/chart.txt")).unwrap();
    assert!(words.contains("the order of every method collapses"), "{words}");
    let svg = String::from_utf8(place.read("out/drop/chart.svg")).unwrap();
    assert!(svg.contains("stretch by cost"), "with contact the stretch is drawn");
}

#[test]
fn what_cannot_be_charted_says_so() {
    let place = Place::new();
    let short = place.muslin("chart tiny.toml --set cloth.stretch.stiffness=1e9 --cost counts --budget 0.1").expect(3);
    for said in ["no reference for tiny", "the shortest step that was tried", "--duration"] {
        assert!(short.stderr.contains(said), "{said}: {}", short.stderr);
    }
    let still = place.muslin("chart tiny.toml --duration 0").expect(2);
    assert!(still.stderr.contains("duration"), "{}", still.stderr);
    for finest in ["0", "-1", "1ms"] {
        let refused = place.muslin(&format!("chart tiny.toml --finest {finest}")).expect(2);
        assert!(refused.stderr.contains("a time in seconds, above zero"), "{}", refused.stderr);
    }
    let unknown = place.muslin("chart tiny.toml --methods euler").expect(2);
    assert!(unknown.stderr.contains("symplectic-euler"), "{}", unknown.stderr);
    assert!(!place.path("out").exists());
}

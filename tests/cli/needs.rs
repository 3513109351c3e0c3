//! `muslin needs`: terms whose effect is known in closed form, counts and refused scenes. Times are never
//! asserted.

use serde_json::Value;

use crate::kit::{Place, in_page};

const GRAVITY: f64 = 9.81;

/// A flat sheet that falls in air; the drag is the same on all of the sheet.
const FALL: &str = r#"name = "fall"
duration = 0.5
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.3, 0.3], cells = [4, 4] }
density = 0.2
stretch = { model = "spring", stiffness = 5.0 }

[drag]
linear = 0.4

[integrator]
method = "rk4"
step = 0.0025
"#;

/// A sheet with gravity along its plane: it stays in its plane and touches nothing.
const HANG: &str = r#"name = "hang"
duration = 0.2
gravity = [9.81, 0.0, 0.0]

[[cloth]]
grid = { size = [0.3, 0.3], cells = [6, 6] }
density = 0.2
stretch = { model = "membrane", stiffness = 100.0 }
shear = { stiffness = 50.0 }
bend = { model = "hinge", rigidity = 1e-5 }
pin = [{ select = { edge = "left" } }]

[integrator]
step = 0.01
"#;

const CONTACT: &str = "\n[contact]\nthickness = 0.004\nfriction = 0.3\n";

/// A sheet on a plane; gravity is tilted by a slope of 1/2.
const SLIDE: &str = r#"name = "slide"
duration = 0.4
gravity = [4.3871653718, -8.7743307435, 0.0]

[[cloth]]
grid = { size = [0.3, 0.3], cells = [8, 9] }
position = [0.0, 0.0041, 0.0]
density = 0.2
stretch = { model = "membrane", stiffness = 1000.0, damping = 0.0005 }
shear = { stiffness = 300.0 }

[[collider]]
shape = "plane"
point = [0.0, 0.0, 0.0]
normal = [0.0, 1.0, 0.0]
friction = 0.3

[contact]
thickness = 0.004

[integrator]
step = 0.005
"#;

/// A sheet by explicit Euler, which is stable only because of the damping.
const DAMPED: &str = r#"name = "damped"
duration = 1.0
gravity = [0.0, -9.81, 0.0]

[[cloth]]
grid = { size = [0.3, 0.3], cells = [4, 4] }
density = 0.2
stretch = { model = "spring", stiffness = 50.0, damping = 0.002 }
pin = [{ select = { corners = [0, 1] } }]

[integrator]
method = "explicit-euler"
step = 0.001
"#;

/// Runs the study of a scene and returns its report.
#[track_caller]
fn needs(place: &Place, text: &str, words: &str) -> Value {
    place.write("scene.toml", text);
    place.muslin(&format!("needs scene.toml --out out --json {words}")).expect(0).json()
}

/// A scene without a step is run under error control, as `run` does, and judged by a smaller allowed error.
#[test]
fn a_scene_under_error_control_is_run_as_it_is() {
    let place = Place::new();
    let scene = HANG.replace("[integrator]\nstep = 0.01\n", "");
    let hang = needs(&place, &scene, "--cost counts");
    assert_eq!(hang["allowed_error"], 1e-3);
    assert_eq!(hang["finer"], "half the longest step with a quarter of the allowed error");
    assert!(
        hang["step_error"]["rms"].as_f64().unwrap() > 0.0,
        "the finer run takes other steps: {}",
        hang["step_error"]
    );
    let run = place.muslin("run scene.toml --out run --set frame_rate=100 --preview none --json").expect(0).json();
    assert_eq!(hang["counts"]["cg_iterations"], run["work"]["cg_iterations"], "{run}");
    let own = needs(&place, &format!("{scene}[integrator]\nerror = 0.001\ntolerance = 1e-6\n"), "--cost counts");
    let iterations = |needs: &Value| needs["counts"]["cg_iterations"].as_u64().unwrap();
    assert!(iterations(&own) > iterations(&hang), "the scene's own tolerance rules");
    let words = String::from_utf8(place.read("out/needs.txt")).unwrap();
    assert!(words.contains("Half the longest step with a quarter of the allowed error moves the cloth by"), "{words}");
    let fixed = needs(&place, HANG, "--cost counts");
    assert!(fixed["allowed_error"].is_null() && fixed["finer"] == "half the step", "{fixed}");
}

/// The row of a run, such as "without bending".
#[track_caller]
fn row<'a>(needs: &'a Value, run: &str) -> &'a Value {
    let found = needs["rows"].as_array().unwrap().iter().find(|row| row["run"] == run);
    found.unwrap_or_else(|| panic!("{run} is not in {}", needs["rows"]))
}

/// The names of all runs, sorted alphabetically.
fn runs(needs: &Value) -> Vec<&str> {
    let mut runs: Vec<_> = needs["rows"].as_array().unwrap().iter().map(|row| row["run"].as_str().unwrap()).collect();
    runs.sort_unstable();
    runs
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Asserts that two lengths agree within a relative error of at most `part`.
#[track_caller]
fn close(measured: &Value, expected: f64, part: f64) {
    let off = number(measured) / expected - 1.0;
    println!("{measured} m, expected {expected} m: off by {off:.1e}");
    assert!(off.abs() <= part, "{measured} m, expected {expected} m");
}

#[test]
fn drag_is_worth_what_it_brakes() {
    let study = needs(&Place::new(), FALL, "");
    assert_eq!(runs(&study), ["in double precision", "without drag"]);
    // v' = -g - rate v with drag, v' = -g without drag.
    let rate = 0.4 / 0.2;
    let apart = |t: f64| 0.5 * GRAVITY * t * t - GRAVITY / rate * (t - (1.0 - (-rate * t).exp()) / rate);
    let squares = (1..=20).map(|k| apart(0.5 * f64::from(k) / 20.0).powi(2)).sum::<f64>();
    let drag = row(&study, "without drag");
    close(&drag["change_rms"], (squares / 20.0).sqrt(), 1e-4);
    close(&drag["change_max"], apart(0.5), 1e-4);
    close(&drag["change_end"], apart(0.5), 1e-4);
    assert_eq!(drag["exceeds_step"], true);
    assert!(drag["sentence"].as_str().unwrap().starts_with("drag moves the cloth by 0.14 m (RMS; at most 0.32 m"));
    // RK4 takes four evaluations per step with any terms. Halving its step changes little more than rounding.
    assert_eq!(
        (&study["counts"]["force_evaluations"], &drag["counts"]["force_evaluations"]),
        (&800.into(), &800.into())
    );
    assert!(number(&study["step_error"]["rms"]) < 1e-5, "{}", study["step_error"]);
    assert_eq!(study["measure"], "positions");
}

#[test]
fn friction_is_worth_the_way_that_it_holds_back() {
    let study = needs(&Place::new(), SLIDE, "");
    assert_eq!(study["measure"], "outline");
    let friction = row(&study, "without friction");
    // The sheet slides along x, which is a direction of the outline. Backward Euler goes farther by h / T, 1.25 %.
    let way = 0.5 * 0.3 * 8.7743307435 * 0.4 * 0.4;
    close(&friction["change_max"], way, 0.03);
    let mean_fourth_power = (1..=20).map(|k| (f64::from(k) / 20.0).powi(4)).sum::<f64>() / 20.0;
    close(&friction["positions_rms"], way * mean_fourth_power.sqrt(), 0.03);
    // The sheet does not touch itself: self-collision changes no position, but its detection costs candidates.
    let own = row(&study, "without self-collision");
    assert_eq!((&own["change_max"], &own["counts"]["candidates"]), (&0.0.into(), &0.into()));
    assert_eq!(own["same_counts"], false);
    let continuous = row(&study, "without continuous testing");
    assert_eq!((&continuous["change_max"], &continuous["same_counts"]), (&0.0.into(), &true.into()));
    // Terms that move nothing are listed apart from terms that the error of the step hides.
    assert_eq!(study["hidden"]["still"], serde_json::json!(["self-collision", "continuous testing"]));
    let conclusion = study["conclusion"].as_str().unwrap();
    assert!(
        conclusion.starts_with("Self-collision and continuous testing do not move the outline; hidden by"),
        "{conclusion}"
    );
    assert!(study["counts"]["candidates"].as_u64() > Some(0));
    let contact = row(&study, "without contact");
    assert!(contact["sentence"].as_str().unwrap().starts_with("contact, with all colliders, moves the outline"));
    assert_eq!(contact["counts"]["contacts"], 0);
}

#[test]
fn bending_is_worth_nothing_in_a_plane() {
    let place = Place::new();
    let exact = needs(&place, HANG, "--set integrator.method=rk4 --set integrator.step=0.0005");
    for run in ["without bending", "with bending springs"] {
        let row = row(&exact, run);
        // Bending springs also resist stretching, so they change the result.
        assert_eq!(row["change_max"] == 0.0, run == "without bending", "{row}");
        assert_eq!(row["verdict"], "ok");
    }
    assert!(
        row(&exact, "without bending")["sentence"].as_str().unwrap().starts_with("bending does not move the cloth")
    );
    let solved = needs(&place, &format!("{HANG}{CONTACT}"), "");
    let bending = row(&solved, "without bending");
    assert!(number(&bending["change_rms"]) < 1e-2 * number(&solved["step_error"]["rms"]), "{bending}");
    // Shear is a part of the membrane, hinges are a part of bending, and friction is a part of contact.
    assert_eq!(solved["hidden"]["terms"], serde_json::json!(["membrane", "bending", "contact"]));
    assert!(solved["hidden"]["parts"].as_array().unwrap().contains(&"shear".into()), "{}", solved["hidden"]);
    let springs = row(&solved, "with springs")["sentence"].as_str().unwrap();
    assert!(springs.starts_with("the membrane with its shear instead of springs"), "{springs}");
    let rest = &solved["hidden"]["without_them"];
    assert_eq!((&rest["verdict"], &rest["counts"]["candidates"]), (&"ok".into(), &0.into()), "{rest}");
    close(&rest["change_rms"], number(&row(&solved, "with springs")["change_rms"]), 1e-3);
}

#[test]
fn a_scene_that_needs_a_term_to_run_says_so() {
    let study = needs(&Place::new(), DAMPED, "");
    let damping = &study["rows"][0];
    assert_eq!((&damping["term"], &damping["verdict"]), (&"damping".into(), &"diverged".into()), "{}", study["rows"]);
    for key in ["change_rms", "change_max", "exceeds_step", "cost_fraction", "wall_s", "counts"] {
        assert!(damping[key].is_null(), "{key} of {damping}");
    }
    let sentence = damping["sentence"].as_str().unwrap();
    assert!(
        sentence.starts_with("without damping it fails at 0.") && sentence.contains("times as long as at rest"),
        "{sentence}"
    );
    assert!(study["hidden"]["terms"].as_array().unwrap().is_empty(), "{}", study["hidden"]);
}

#[test]
fn only_what_is_modelled_is_tried() {
    let place = Place::new();
    let bare = FALL.replace("linear = 0.4", "linear = 0.0");
    assert_eq!(runs(&needs(&place, &bare, "")), ["in double precision"]);
    let wind = "--set drag.wind.velocity=[1,0,0] --set drag.wind.normal=0.1 --set integrator.method=bdf2";
    let blown = ["in double precision", "with Newton's method", "without drag", "without wind"];
    assert_eq!(runs(&needs(&place, FALL, wind)), blown);
    let solved = "--set integrator.newton=4 --set integrator.method=backward-euler";
    assert!(runs(&needs(&place, FALL, solved)).contains(&"with one Newton iteration"));
}

/// The first of two cloths is pinned everywhere, and the second has the simpler models already. A simpler model in
/// the first cloth therefore changes nothing, provided that the second cloth keeps its own models.
#[test]
fn each_cloth_is_changed_in_its_own_models() {
    let second = "[[cloth]]\ngrid = { size = [0.2, 0.2], cells = [4, 4] }\nposition = [1.0, 0.0, 0.0]\ndensity = 0.2\n\
                  stretch = { model = \"spring\", stiffness = 80.0 }\n\
                  bend = { model = \"spring\", stiffness = 0.5, damping = 0.001 }\n\
                  pin = [{ select = { corners = [0] } }]\n";
    let held = HANG.replace("edge = \"left\"", "box = [[-1, -1, -1], [1, 1, 1]]");
    let two = held.replace("[integrator]", &format!("{second}\n[integrator]"));
    let study = needs(&Place::new(), &two, "--set integrator.method=rk4 --set integrator.step=0.0005");
    let (still, moving) =
        (["with bending springs", "with springs", "without shear"], ["without bending", "without damping"]);
    // The runs above and the run in double precision.
    assert_eq!(runs(&study).len(), 1 + still.len() + moving.len(), "{:?}", runs(&study));
    for run in still {
        assert_eq!(row(&study, run)["change_max"], 0.0, "{run}");
    }
    for run in moving {
        assert!(number(&row(&study, run)["change_rms"]) > 1e-6, "{run}: {}", row(&study, run));
    }
}

#[test]
fn numbers_words_and_picture_are_written() {
    let place = Place::new();
    let study = needs(&place, SLIDE, "--duration 0.1");
    let rows = study["rows"].as_array().unwrap();
    let changes: Vec<_> = rows.iter().map(|row| number(&row["change_rms"])).collect();
    assert!(changes.is_sorted_by(|a, b| a >= b), "{changes:?}");
    let own = number(&study["step_error"]["rms"]);
    for row in rows {
        assert!(number(&row["change_max"]) >= number(&row["change_rms"]), "{row}");
        assert_eq!(row["exceeds_step"], number(&row["change_rms"]) > own, "{row}");
        let [cost, least, most] = [&row["cost_fraction"], &row["cost_range"][0], &row["cost_range"][1]].map(number);
        assert!(least <= cost && cost <= most && number(&row["wall_s"]) > 0.0, "{row}");
        assert!(row["repeats"].as_u64() >= Some(1) && row["why"].is_null(), "{row}");
    }
    // Newton's method solves more linear systems, so its counts are larger.
    let newton = &row(&study, "with Newton's method")["counts"];
    for count in ["force_evaluations", "cg_iterations"] {
        assert!(newton[count].as_u64() > study["counts"][count].as_u64(), "{count}: {newton} and {}", study["counts"]);
    }

    assert_eq!(place.files("out"), ["needs.json", "needs.svg", "needs.txt", "study.html"]);
    assert_eq!(serde_json::from_slice::<Value>(&place.read("out/needs.json")).unwrap(), study);
    let text = |file: &str| String::from_utf8(place.read(file)).unwrap();
    let (svg, words, page) = (text("out/needs.svg"), text("out/needs.txt"), text("out/study.html"));
    assert!(svg.starts_with("<svg") && page.contains(&in_page(&svg, "needs")), "the page shows the picture");
    assert!(svg.contains(">change<") && svg.contains(">change by half"), "a long title would be cut off: {svg}");
    for row in rows {
        let run = row["run"].as_str().unwrap();
        assert!(svg.contains(&run.replace('\'', "&apos;")), "{run} is not in the picture");
        assert!(words.to_lowercase().contains(&row["sentence"].as_str().unwrap().to_lowercase()), "{words}");
    }
    assert!(words.contains(study["conclusion"].as_str().unwrap()), "{words}");
    // The frame interval is 1/30 s, the interval between moments 1/200 s.
    assert!((number(&study["step"]) - 0.005).abs() < 1e-12 && (number(&study["run_step"]) - 1.0 / 210.0).abs() < 1e-12);
    assert!(words.contains("5.00 ms, where muslin run takes 4.76 ms"), "{words}");
}

#[test]
fn what_cannot_be_compared_says_so() {
    let place = Place::new();
    place.write("damped.toml", DAMPED);
    let late = place.muslin("needs tiny.toml --budget 0").expect(3);
    assert!(late.stderr.contains("tiny takes longer than 0 s") && late.stderr.contains("--budget"), "{}", late.stderr);
    let lost = place.muslin("needs damped.toml --set cloth.stretch.damping=0").expect(3);
    assert!(
        lost.stderr.contains("times as long as at rest") && lost.stderr.contains("integrator.step"),
        "{}",
        lost.stderr
    );
    let still = place.muslin("needs tiny.toml --duration 0").expect(2);
    assert!(still.stderr.contains("duration"), "{}", still.stderr);
    assert!(!place.path("out").exists());
}

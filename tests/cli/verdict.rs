//! The verdict of a run and its warnings: errors that feed energy are doubted, work from outside is not.

use serde_json::Value;

use crate::kit::{Place, TINY};

/// A stiff sheet that implicit midpoint makes ring under error control.
const RINGING: &str = r#"duration = 0.6
frame_rate = 20
gravity = [0.3, -9.81, 0.2]
[[cloth]]
grid = { size = [0.4, 0.4], cells = [12, 14] }
rotation = [10, 5, 0]
density = 0.2
stretch = { model = "membrane", stiffness = 2000, damping = DAMPING }
shear = { stiffness = 400 }
bend = { model = "hinge", rigidity = 2e-5 }
pin = [{ select = { corners = [0, 1] } }]
[integrator]
method = "implicit-midpoint"
error = 0.001
"#;

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
    place.write("ringing.toml", RINGING.replace("DAMPING", "0"));
    let coarse = run(&place, "ringing.toml --precision f64", 3);
    let fine = run(&place, "ringing.toml --precision f64 --set integrator.error=0.0001", 0);
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

/// Damping takes the energy, so that hardly any is left.
#[test]
fn energy_that_damping_takes_again_is_doubted() {
    let place = Place::new();
    place.write("damped.toml", RINGING.replace("DAMPING", "0.0005"));
    let coarse = run(&place, "damped.toml", 3);
    let balance = &coarse["energy_balance"];
    let [appeared, method, moved] = ["appeared", "method", "moved"].map(|key| balance[key].as_f64().unwrap());
    println!("{appeared} of {method} J are left; {}", coarse["doubt"]);
    assert!(appeared < 0.5 * moved && method > moved, "{balance}");
    assert!(codes(&coarse).contains(&"energy"), "{}", coarse["warnings"]);
    let fine = run(&place, "damped.toml --set integrator.error=0.0001", 0);
    assert_eq!((&fine["verdict"], codes(&fine)), (&Value::from("ok"), vec![]));
}

/// One linear solve in a step adds energy where stiff cloth turns at a collider, and contacts take it again: hardly a
/// tenth is left. The scene ends with fifteen times the right kinetic energy.
#[test]
fn energy_that_contacts_take_again_is_doubted() {
    let place = Place::new();
    place.write(
        "small.toml",
        r#"duration = 0.13
frame_rate = 100
gravity = [0, -9.81, 0]
[[cloth]]
grid = { size = [0.026, 0.026], cells = [4, 5] }
position = [0, 0.028, 0]
density = 0.0242
stretch = { model = "membrane", stiffness = 3080 }
shear = { stiffness = 924 }
bend = { model = "hinge", rigidity = 4e-9 }
velocity = [0.028, 0.024, 0]
[[collider]]
shape = "capsule"
a = [-0.013, -0.026, 0]
b = [0.013, -0.026, 0]
radius = 0.0078
[contact]
thickness = 0.0013
friction = 0.8
[integrator]
error = 7.8e-5
"#,
    );
    let coarse = run(&place, "small.toml", 3);
    println!("{}", coarse["energy_balance"]);
    assert!(codes(&coarse).contains(&"energy"), "{}", coarse["warnings"]);
    let fine = run(&place, "small.toml --set integrator.error=0 --set integrator.step=2.5e-5", 0);
    assert_eq!((&fine["verdict"], codes(&fine)), (&Value::from("ok"), vec![]), "{}", fine["warnings"]);
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

/// A light strip with a load on its tip bends fast, and one linear solve in each step does not follow the turning
/// triangles.
#[test]
fn doubt_names_what_helps_and_spares_the_equilibrium() {
    let place = Place::new();
    place.write(
        "strip.toml",
        r#"duration = 20.0
until_rest = 1e-6
frame_rate = 20
[[cloth]]
grid = { size = [0.0462, 0.2], cells = [8, 40] }
density = 0.02
stretch = { model = "membrane", stiffness = 5000.0 }
shear = { stiffness = 2000.0 }
bend = { model = "hinge", rigidity = 1e-3 }
pin = [{ select = { box = [[-1, -1, -0.101], [1, 1, -0.0949]] } }]
load = [{ select = { edge = "front" }, force = [0.0, -0.01, 0.0], share = "length" }]
[drag]
linear = 0.4
[integrator]
step = 0.01
error = 0
"#,
    );
    let outcome = place.muslin("run strip.toml --out out --preview none --json --precision f64").expect(3);
    let once = outcome.json();
    assert_eq!(outcome.stderr.matches("appeared from nowhere").count(), 1, "it is told once: {}", outcome.stderr);
    let doubt = once["doubt"].as_str().unwrap();
    assert!(doubt.contains("take integrator.newton = 20") && doubt.contains("an equilibrium"), "{doubt}");
    let newton = run(&place, "strip.toml --precision f64 --set integrator.newton=20", 0);
    let [one, other] = [&once, &newton].map(|summary| summary["stretch"]["max"].as_f64().unwrap() - 1.0);
    assert!((one / other - 1.0).abs() < 1e-3, "the equilibria differ: {one} and {other}");
}

/// A sheet that starts within the thickness of a plane is lifted. This work is known, and it is no error of the steps.
#[test]
fn lifting_an_overlap_is_work_and_no_doubt() {
    let place = Place::new();
    place.write(
        "slope.toml",
        r#"duration = 0.5
frame_rate = 20
gravity = [0.0, -9.81, 0.0]
[[cloth]]
grid = { size = [0.1, 0.1], cells = [8, 8] }
position = [0.0, 0.00101, 0.0]
rotation = [20, 0, 0]
density = 0.2
stretch = { model = "membrane", stiffness = 500.0 }
shear = { stiffness = 200.0 }
[[collider]]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0.9396926, 0.3420201]
[contact]
thickness = 0.001
friction = 0.5
self = false
[integrator]
step = 0.002
error = 0
"#,
    );
    let summary = run(&place, "slope.toml --precision f64", 0);
    let [separation, appeared] = ["separation", "appeared"].map(|key| summary["energy_balance"][key].as_f64().unwrap());
    // It rises by the overlap, 0.05 mm along the normal.
    let lift = 9.81 * summary["mass_kg"].as_f64().unwrap() * (0.001 - 0.00101 * 0.9396926) * 0.9396926;
    println!("{separation} J of {lift} J, {appeared} J appeared");
    assert!((separation / lift - 1.0).abs() < 0.05, "{separation} J to lift it by {lift} J");
    assert!(appeared < 0.05 * lift, "{appeared} J appeared");
    assert_eq!(summary["verdict"], "ok");
}

/// Backward Euler damps a pendulum that nothing else damps.
#[test]
fn energy_that_the_method_takes_is_told() {
    let place = Place::new();
    place.write(
        "pendulum.toml",
        r#"duration = 6.0
frame_rate = 20
gravity = [0.0, -9.81, 0.0]
[[cloth]]
grid = { size = [0.5, 0.5], cells = [1, 1], pattern = "diagonal" }
density = 0.1
stretch = { model = "membrane", stiffness = 1e4 }
shear = { stiffness = 1e4 }
pin = [{ select = { edge = "back" } }]
"#,
    );
    let taken = |words: &str| {
        let summary = run(&place, &format!("pendulum.toml --precision f64 {words}"), 0);
        let balance = &summary["energy_balance"];
        let part = balance["method"].as_f64().unwrap() / balance["moved"].as_f64().unwrap();
        println!("{words}: the method added {part} of the energy that moved");
        (part, codes(&summary).contains(&"method"))
    };
    let (euler, told) = taken("");
    assert!(euler < -0.5 && told, "{euler}");
    // A plane that is not touched changes nothing.
    let plane =
        "[[collider]]\nshape = \"plane\"\npoint = [0, -5, 0]\nnormal = [0, 1, 0]\n[contact]\nthickness = 0.001\n";
    place.write("above.toml", [&place.read("pendulum.toml"), plane.as_bytes()].concat());
    let above = run(&place, "above.toml --precision f64", 0);
    assert!(codes(&above).contains(&"method"), "{}", above["warnings"]);
    let (midpoint, told) = taken(
        "--set integrator.method=implicit-midpoint --set integrator.step=0.001 --set integrator.error=0 \
         --set integrator.newton=20",
    );
    assert!(midpoint.abs() < 0.01 && !told, "{midpoint}");
    let damped = run(&place, "pendulum.toml --set cloth.stretch.damping=0.001 --duration 0.1", 0);
    assert_eq!(damped["energy_balance"]["method"], Value::Null, "what damping took is not measured");
    let (euler, told) = taken("--set cloth.stretch.damping=0.001 --series series.csv");
    assert!(euler < -0.5 && told, "{euler} beside measured damping");
}

/// Newton's method iterates without the contacts: friction is too weak.
#[test]
fn contacts_that_newtons_method_leaves_out_are_told() {
    let place = Place::new();
    let sheet = |height: f64| {
        format!(
            "duration = 0.1\nframe_rate = 20\ngravity = [0, -9.81, 0]\n[[cloth]]\n\
             grid = {{ size = [0.2, 0.2], cells = [6, 7] }}\nposition = [0, {height}, 0]\nvelocity = [0.5, 0, 0]\n\
             density = 0.2\nstretch = {{ model = \"membrane\", stiffness = 500 }}\nshear = {{ stiffness = 100 }}\n\
             [[collider]]\nshape = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n\
             [contact]\nthickness = 0.004\nfriction = 0.5\n"
        )
    };
    place.write("touches.toml", sheet(0.006));
    place.write("flies.toml", sheet(1.0));
    let told = |words: &str| {
        let summary = run(&place, words, 0);
        assert_eq!(summary["verdict"], "ok", "{words}: {}", summary["warnings"]);
        codes(&summary).contains(&"newton")
    };
    assert!(told("touches.toml --set integrator.newton=4"));
    assert!(!told("touches.toml") && !told("flies.toml --set integrator.newton=4"));
    assert!(!told(
        "touches.toml --set integrator.newton=4 --set integrator.method=symplectic-euler --set integrator.step=2e-4"
    ));
}

#[test]
fn an_error_that_is_large_for_the_cloth_is_told() {
    let place = Place::new();
    place.write(
        "small.toml",
        "duration = 0.1\nframe_rate = 20\n[[cloth]]\ngrid = { size = [0.01, 0.01], cells = [1, 1] }\ndensity = 0.1\n",
    );
    let coarse = run(&place, "small.toml", 0);
    assert_eq!(codes(&coarse), ["error"], "{coarse}");
    let text = coarse["warnings"][0]["text"].as_str().unwrap();
    assert!(text.contains("integrator.error = 1.0 mm") && text.contains("take 100.0 um or less"), "{text}");
    let fine = run(&place, "small.toml --set integrator.error=1e-4", 0);
    assert!(codes(&fine).is_empty(), "{fine}");
}

/// A table that turns by half a turn in each fixed step.
#[test]
fn motion_within_a_step_makes_a_result_doubtful() {
    let place = Place::new();
    place.write(
        "table.toml",
        r#"duration = 0.1
frame_rate = 20
[[cloth]]
grid = { size = [0.2, 0.2], cells = [2, 2] }
position = [0, 0.02, 0]
density = 0.2
stretch = { model = "spring", stiffness = 100.0 }
[[collider]]
shape = "box"
center = [0, -0.5, 0]
half = [1, 0.5, 1]
motion = { turn = { axis = [0, 1, 0], rate = 62.8 } }
[contact]
thickness = 0.01
"#,
    );
    let fixed = run(&place, "table.toml --set integrator.step=0.05", 3);
    assert_eq!(codes(&fixed), ["motion"], "{fixed}");
    let doubt = fixed["doubt"].as_str().unwrap();
    assert!(doubt.contains("up to 0.14 m from the straight and even way"), "{doubt}");
    let controlled = run(&place, "table.toml", 0);
    assert!(codes(&controlled).is_empty(), "{controlled}");
}

/// Cloth that comes to rest settles within the thickness.
#[test]
fn sheets_that_lie_still_are_not_doubted() {
    let place = Place::new();
    for (slope, height) in [(0.0, 0.004), (0.3, 0.005), (0.5, 0.005)] {
        place.write(
            "still.toml",
            format!(
                r#"duration = 0.5
gravity = [{:?}, -9.81, 0]
[[cloth]]
grid = {{ size = [0.3, 0.3], cells = [14, 16] }}
position = [0, {height:?}, 0]
density = 0.2
stretch = {{ model = "membrane", stiffness = 1000.0, damping = 0.001 }}
shear = {{ stiffness = 300.0, damping = 0.001 }}
bend = {{ model = "hinge", rigidity = 2e-5, damping = 0.01 }}
[[collider]]
shape = "box"
center = [0, -0.5, 0]
half = [3, 0.5, 3]
[contact]
thickness = {height:?}
friction = 0.6
"#,
                9.81 * slope
            ),
        );
        for precision in ["f32", "f64"] {
            let still = run(&place, &format!("still.toml --precision {precision}"), 0);
            assert!(codes(&still).is_empty(), "slope {slope}, {precision}: {}", still["warnings"]);
        }
    }
}

/// Backward Euler slows rotations down. A turning table that carries its sheet along makes up for the loss.
#[test]
fn a_rotation_that_backward_euler_slows_down_is_warned_of() {
    let place = Place::new();
    let scene = r#"duration = 1.0
frame_rate = 60
[[cloth]]
grid = { size = [1.0, 1.0], cells = [6, 6] }
position = [0, 0.005, 0]
density = 0.2
stretch = { model = "membrane", stiffness = 1000.0 }
spin = { axis = [0, 1, 0], rate = 6.0 }
[[collider]]
shape = "box"
center = [0, -0.5, 0]
half = [2, 0.5, 2]
motion = { turn = { axis = [0, 1, 0], rate = TABLE } }
[contact]
thickness = 0.005
friction = FRICTION
"#;
    place.write("ice.toml", scene.replace("TABLE", "0.0").replace("FRICTION", "0.0"));
    let carried = scene.replace("TABLE", "6.0").replace("FRICTION", "0.5");
    place.write("table.toml", format!("gravity = [0, -10, 0]\n{carried}"));
    for (words, is_warned) in [
        ("ice.toml", true),
        ("ice.toml --set integrator.error=0", true),
        ("ice.toml --set integrator.error=1e-5", false),
        ("ice.toml --set integrator.method=bdf2", false),
        ("table.toml", false),
    ] {
        let summary = run(&place, &format!("{words} --series series.csv"), 0);
        let found = summary["warnings"].as_array().unwrap().iter().find(|warning| warning["code"] == "method");
        assert_eq!(found.is_some(), is_warned, "{words}: {}", summary["warnings"]);
        let Some(found) = found else { continue };
        // The warning derives the loss from the frames. The series measures it at every vertex.
        let text = found["text"].as_str().unwrap();
        let told: f64 = text.split_once("took ").unwrap().1.split(' ').next().unwrap().parse().unwrap();
        let lost = -summary["energy_balance"]["method"].as_f64().unwrap();
        assert!((told / lost - 1.0).abs() < 0.1, "{words}: {told} J of {lost} J");
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

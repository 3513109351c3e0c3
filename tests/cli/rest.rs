//! Runs that end at rest.

use crate::kit::{Place, TINY};

/// A sheet that air stops within a second.
fn scene(speed: f64) -> String {
    format!("until_rest = {speed}\n{}\n[drag]\nlinear = 2.0\n", TINY.replace("duration = 0.2", "duration = 100.0"))
}

#[test]
fn a_run_ends_after_the_first_frame_at_rest() {
    let place = Place::new();
    place.write("scene.toml", scene(0.002));
    let whole = place.run("scene.toml --checkpoint 7 --export none");
    assert_eq!(whole["at_rest"], true);
    let (frames, time) = (whole["frames"].as_u64().unwrap(), whole["simulated_s"].as_f64().unwrap());
    assert!(time < 50.0, "it ended after {time} s");
    assert!((time - (frames - 1) as f64 / 20.0).abs() < 1e-5, "{time} s is not the end of frame {frames}");

    let again = place.run("scene.toml --resume out/checkpoint.muslin --export none");
    assert_eq!((&again["state_hash"], &again["steps"]), (&whole["state_hash"], &whole["steps"]), "resumed");

    let shorter = place.run(&format!("scene.toml --duration {:?} --export none", time - 0.05));
    assert_eq!(shorter["at_rest"], false, "one frame before");
    place.write("scene.toml", scene(0.002).replace("until_rest", "# until_rest"));
    assert!(place.run("scene.toml --duration 0.1 --export none")["at_rest"].is_null(), "without the key");
}

/// The speed counts in every step of the frame, not only at its end: a run that begins at rest does not end there.
#[test]
fn a_start_at_rest_is_no_end() {
    let place = Place::new();
    place.write("scene.toml", scene(0.1));
    let first = place.run("scene.toml --export none");
    assert!(first["frames"].as_u64() > Some(2) && first["at_rest"] == true, "{first}");
}

#[test]
fn the_end_at_rest_is_told() {
    let place = Place::new();
    place.write("scene.toml", scene(0.002));
    let told =
        |words: &str| place.muslin(&format!("run scene.toml --preview none --export none {words}")).expect(0).stdout;
    assert!(told("").contains("it came to rest, and the run ended"));
    let moves = told("--duration 0.1");
    assert!(moves.contains("it did not come to rest before the end: ") && moves.contains("until_rest is 0.002 m/s"));
}

/// The sheet lies at rest without gravity until the scene changes something.
#[test]
fn a_run_does_not_end_at_rest_before_what_the_scene_schedules() {
    let still = scene(0.002).replace("gravity = [0.0, -9.81, 0.0]\n", "");
    let load = "[[cloth.load]]\nselect = { edge = \"front\" }\nforce = ";
    let changes = [
        ("gravity", still.replace("frame_rate", "gravity = { keys = [[0, 0, 0, 0], [0.5, 0, -1, 0]] }\nframe_rate")),
        ("wind", format!("{still}[drag.wind]\nnormal = 1.0\nvelocity = {{ keys = [[0, 0, 0, 0], [0.5, 1, 0, 0]] }}\n")),
        (
            "load",
            still.replace(
                "[[cloth.pin]]",
                &format!("{load}{{ keys = [[0, 0, 0, 0], [0.5, 0, 0.01, 0]] }}\n[[cloth.pin]]"),
            ),
        ),
        ("pin", still.replace("corners = [0, 1] }", "corners = [0, 1] }\nuntil = 0.5")),
        (
            "motion",
            still.replace(
                "corners = [0, 1] }",
                "corners = [0, 1] }\nmotion = { keys = [[0, 0, 0, 0], [0.5, 0, 0, 0]] }",
            ),
        ),
    ];
    let place = Place::new();
    for (what, text) in changes {
        place.write("scene.toml", text);
        let run = place.run("scene.toml --duration 2 --export none");
        let time = run["simulated_s"].as_f64().unwrap();
        assert!(time > 0.5, "{what} changes until 0.5 s, and the run ended at {time} s");
    }
}

/// An arm that turns for ever reaches every place in its first turn.
#[test]
fn a_run_does_not_end_at_rest_before_a_rotation_without_an_end_has_turned_once() {
    let place = Place::new();
    let scene = r#"duration = 4.0
until_rest = 0.01
frame_rate = 20
gravity = [0, -9.81, 0]
[[cloth]]
grid = { size = [0.3, 0.3], cells = [4, 4] }
position = [0.7, 0.0051, 0]
density = 0.2
stretch = { model = "membrane", stiffness = 500.0, damping = 0.001 }
shear = { stiffness = 100.0 }
[[collider]]
shape = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
[[collider]]
shape = "box"
center = [0, 0.03, 0]
half = [1, 0.04, 0.02]
rotation = [0, 90, 0]
motion = { turn = { axis = [0, 1, 0], rate = 4.0 } }
[contact]
thickness = 0.005
friction = 0.3
"#;
    place.write("scene.toml", scene);
    let time = place.run("scene.toml --export none")["simulated_s"].as_f64().unwrap();
    assert!(time > std::f64::consts::TAU / 4.0, "the arm turns once until 1.57 s, and the run ended at {time} s");
}

/// A plate lies still in the frames of a point cache until 0.6 s, and then rises.
#[test]
fn a_run_does_not_end_at_rest_before_the_last_frame_of_a_point_cache() {
    let place = Place::new();
    let corners = [[-1.0f32, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
    let lines: String = corners.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    place.write("plate.obj", format!("{lines}f 1 3 2\nf 1 4 3\n"));
    let heights = [0.0f32, 0.0, 0.0, 0.0, 0.1];
    let mut cache = b"POINTCACHE2\0".to_vec();
    for word in [1, corners.len() as u32, 0.0f32.to_bits(), 1.0f32.to_bits(), heights.len() as u32] {
        cache.extend(word.to_le_bytes());
    }
    for height in heights {
        cache.extend(corners.iter().flat_map(|[x, y, z]| [*x, y + height, *z]).flat_map(f32::to_le_bytes));
    }
    place.write("plate.pc2", cache);
    let sheet = "duration = 3.0\nuntil_rest = 0.01\nframe_rate = 20\ngravity = [0, -9.81, 0]\n[contact]\n\
                 thickness = 0.005\n[[collider]]\nshape = \"mesh\"\nfile = \"plate.obj\"\nmotion = \"plate.pc2\"\n\
                 motion_rate = 5.0\n[[cloth]]\ngrid = { size = [0.3, 0.3], cells = [4, 4] }\nposition = [0, 0.0051, 0]\n\
                 density = 0.2\nstretch = { model = \"membrane\", stiffness = 500.0, damping = 0.001 }\n\
                 shear = { stiffness = 100.0 }\n";
    place.write("scene.toml", sheet);
    let time = place.run("scene.toml --export none")["simulated_s"].as_f64().unwrap();
    assert!(time > 0.8, "the plate rises until 0.8 s, and the run ended at {time} s");
}

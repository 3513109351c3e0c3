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

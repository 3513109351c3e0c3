//! A run that is resumed from a checkpoint equals the uninterrupted run, bit for bit.

use crate::kit::{Place, PointCache, TINY};

const METHODS: [&str; 7] =
    ["explicit-euler", "symplectic-euler", "midpoint", "rk4", "backward-euler", "implicit-midpoint", "bdf2"];

/// A scene that is stable for the explicit methods. Its pin moves, so that the resumed time matters too.
fn scene() -> String {
    let moving = "corners = [0, 1] }\nmotion = { keys = [[0.0, 0, 0, 0], [0.2, 0.1, 0.1, 0]] }";
    let soft = TINY.replace("100.0", "0.5").replace("50.0", "0.2").replace("step = 0.01", "step = 0.002");
    soft.replace("corners = [0, 1] }", moving)
}

#[test]
fn every_method_goes_on_where_it_stopped() {
    let place = Place::new();
    place.write("scene.toml", scene());
    for precision in ["f32", "f64"] {
        for method in METHODS {
            // `step` is the step of the last checkpoint: within a frame, next to a frame, at a frame, at the end.
            for (every, step) in [(35, 70), (76, 76), (75, 75), (100, 100)] {
                let words = format!("scene.toml --precision {precision} --set integrator.method={method}");
                let whole = place.run(&format!("{words} --checkpoint {every}"));
                let cache = place.read("out/cloth.pc2");
                let parts = place.run(&format!("{words} --resume out/checkpoint.muslin"));
                let which = format!("{precision} {method} from step {step}");
                assert_eq!(whole["state_hash"], parts["state_hash"], "{which}");
                assert_eq!((&whole["steps"], &whole["work"]), (&parts["steps"], &parts["work"]), "{which}");
                assert!(cache == place.read("out/cloth.pc2"), "{which}: the point caches differ");
            }
        }
    }
}

/// Its wall time is that of its own steps, and the last line is the verdict.
#[test]
fn the_report_of_a_resumed_run_names_its_own_part() {
    let place = Place::new();
    let told = |words: &str| place.muslin(&format!("run tiny.toml --out out --preview none {words}")).expect(0).stdout;
    let whole = told("--checkpoint 15");
    assert!(whole.contains(" s of wall time, ") && whole.ends_with("\nverdict ok\n"), "{whole}");
    let part = told("--resume out/checkpoint.muslin");
    assert!(part.contains(" s of wall time for the 5 steps since it was resumed, "), "{part}");
    assert!(part.ends_with("\nverdict ok\n"), "{part}");
}

/// Pins that begin and end, two of them moving: checkpoints before, at and after each change.
#[test]
fn pins_that_change_go_on_too() {
    let place = Place::new();
    let timed = "corners = [0] }\nuntil = 0.12\n[[cloth.pin]]\nselect = { edge = \"front\" }\nfrom = 0.05\nuntil = 0.1\n\
                 motion = { keys = [[0.0, 0, 0, 0], [0.2, 0, 0.1, 0.2]], turn = { axis = [0, 1, 0.5], rate = 3.0 } }\n\
                 [[cloth.pin]]\nselect = { corners = [1] }\nfrom = 0.15\naxes = \"xy\"";
    // Soft, and solved exactly: implicit midpoint would add energy as the pins take hold.
    let soft = TINY.replace("stiffness = 100.0", "stiffness = 20.0");
    place.write("scene.toml", soft.replace("corners = [0, 1] }", timed) + "newton = 20\n");
    for precision in ["f32", "f64"] {
        for method in &METHODS[4..] {
            for every in [11, 12, 13, 15, 17] {
                let words = format!("scene.toml --precision {precision} --set integrator.method={method}");
                let whole = place.run(&format!("{words} --checkpoint {every}"));
                let parts = place.run(&format!("{words} --resume out/checkpoint.muslin"));
                let which = format!("{precision} {method} from step {every}");
                assert_eq!(whole["state_hash"], parts["state_hash"], "{which}");
            }
            // Steps 5 and 10, at which pins change.
            for steps in [5_u32, 6, 10] {
                let words = format!("scene.toml --precision {precision} --set integrator.method={method}");
                place.run(&format!(
                    "{words} --duration {:?} --checkpoint {steps}",
                    0.01 * f64::from(steps.div_ceil(5) * 5)
                ));
                let parts = place.run(&format!("{words} --resume out/checkpoint.muslin"));
                let whole = place.run(&words);
                assert_eq!(whole["state_hash"], parts["state_hash"], "{precision} {method} from step {steps}");
            }
        }
    }
}

/// Gravity, wind and a load by keys, one of them within a step: checkpoints before, between and after them.
#[test]
fn forces_that_change_go_on_too() {
    let place = Place::new();
    let load =
        "[[cloth.load]]\nselect = { corners = [3] }\nforce = { keys = [[0.05, 0, 0, 0], [0.123, 0.01, 0, 0.01]] }\n";
    let wind = "velocity = { keys = [[0.1, 0, 0, 0], [0.15, 1, 2, 0]] }, normal = 0.5";
    let gravity = "gravity = { keys = [[0.0, 0, -9.81, 0], [0.125, 0, 0, 9.81]] }";
    let text = scene().replace("gravity = [0.0, -9.81, 0.0]", gravity);
    let text = text.replace("[integrator]", &format!("{load}\n[drag]\nwind = {{ {wind} }}\n\n[integrator]"));
    place.write("scene.toml", text);
    for (precision, method) in METHODS.into_iter().enumerate().map(|(k, method)| (["f32", "f64"][k % 2], method)) {
        for every in [26, 60, 70] {
            let words = format!("scene.toml --precision {precision} --set integrator.method={method}");
            let whole = place.run(&format!("{words} --checkpoint {every}"));
            let parts = place.run(&format!("{words} --resume out/checkpoint.muslin"));
            let which = format!("{precision} {method} from step {every}");
            assert_eq!(whole["state_hash"], parts["state_hash"], "{which}");
            assert_eq!(whole["energy_balance"], parts["energy_balance"], "{which}");
        }
    }
}

/// With contact, a step may depend on the contacts of the steps before.
#[test]
fn a_run_goes_on_where_something_touches() {
    let place = Place::new();
    let floor =
        "[contact]\nthickness = 0.004\n[[collider]]\nshape = \"plane\"\npoint = [0, 0.96, 0]\nnormal = [0, 1, 0]\n";
    place.write("scene.toml", format!("{TINY}{floor}"));
    for method in &METHODS[4..] {
        for every in [9, 11, 13, 17, 19] {
            let words = format!("scene.toml --set integrator.method={method}");
            let whole = place.run(&format!("{words} --checkpoint {every}"));
            assert!(whole["contacts"]["proximity"].as_u64() > Some(0), "nothing touches");
            let parts = place.run(&format!("{words} --resume out/checkpoint.muslin"));
            let which = format!("{method} from a multiple of step {every}");
            assert_eq!(whole["state_hash"], parts["state_hash"], "{which}");
            assert_eq!(whole["contacts"], parts["contacts"], "{which}");
        }
    }
}

#[test]
fn a_run_can_be_made_longer() {
    let place = Place::new();
    place.write("scene.toml", scene());
    for format in ["obj,pc2,vtp,usda", "pc2"] {
        let whole = place.run(&format!("scene.toml --export {format}"));
        std::fs::rename(place.path("out"), place.path("whole")).unwrap();

        place.run(&format!("scene.toml --export {format} --duration 0.1 --checkpoint 50"));
        let parts = place.run(&format!("scene.toml --export {format} --resume out/checkpoint.muslin"));
        assert_eq!(whole["state_hash"], parts["state_hash"]);
        std::fs::remove_file(place.path("out/checkpoint.muslin")).unwrap();
        place.same_files("out", "whole");
        ["out", "whole"].iter().for_each(|folder| std::fs::remove_dir_all(place.path(folder)).unwrap());
    }
}

#[test]
fn elsewhere_the_frames_go_on_in_number() {
    let place = Place::new();
    place.write("scene.toml", scene());
    let whole = place.run("scene.toml --export obj,pc2 --checkpoint 65");
    let all = PointCache::parse(&place.read("out/cloth.pc2"));
    std::fs::rename(place.path("out"), place.path("before")).unwrap();
    let parts = place.run("scene.toml --export obj,pc2 --resume before/checkpoint.muslin");
    assert_eq!(whole["state_hash"], parts["state_hash"]);
    let rest = PointCache::parse(&place.read("out/cloth.pc2"));
    assert_eq!((rest.start, rest.frames.as_slice()), (3.0, &all.frames[3..]));
    assert_eq!(place.files("out/frames"), ["frame_00003.obj", "frame_00004.obj"]);
}

#[test]
fn threads_may_change_between_the_parts() {
    let place = Place::new();
    place.write("scene.toml", scene());
    let whole = place.run("scene.toml --threads 1 --checkpoint 45");
    let parts = place.run("scene.toml --threads 3 --resume out/checkpoint.muslin");
    assert_eq!(whole["state_hash"], parts["state_hash"]);
}

#[test]
fn a_finished_run_still_gets_its_picture() {
    let place = Place::new();
    place.run("tiny.toml --checkpoint 20");
    place.muslin("run tiny.toml --out out --resume out/checkpoint.muslin").expect(0);
    assert!(place.path("out/preview.gif").exists() && place.path("out/summary.json").exists());
}

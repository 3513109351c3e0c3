//! Checkpoints that cannot be resumed: exit code 2, a message, no files written.

use crate::kit::{Place, TINY};

/// A folder with a checkpoint of `tiny.toml` in `kept.muslin`, and without `out`.
fn place() -> Place {
    let place = Place::new();
    place.run("tiny.toml --checkpoint 7");
    std::fs::rename(place.path("out/checkpoint.muslin"), place.path("kept.muslin")).unwrap();
    std::fs::remove_dir_all(place.path("out")).unwrap();
    place
}

#[test]
fn truncated_or_altered() {
    let place = place();
    let good = place.read("kept.muslin");
    let refuses = |bytes: &[u8], part: &str| {
        place.write("bad.muslin", bytes);
        place.refuses("tiny.toml --resume bad.muslin", &["bad.muslin: ", part]);
    };
    for length in [8, 9, 12, 20, 100, good.len() / 2, good.len() - 4, good.len() - 1] {
        refuses(&good[..length], "damaged");
    }
    for bit in (12 * 8..good.len() * 8).step_by(good.len() * 8 / 23) {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        refuses(&bad, "damaged");
    }
    refuses(&[&good[..], &[0]].concat(), "damaged");
    refuses(b"", "not a checkpoint of muslin");
    refuses(&good[..5], "not a checkpoint of muslin");
    refuses(TINY.as_bytes(), "not a checkpoint of muslin");
    refuses(&[&good[..8], &[99, 0, 0, 0], &good[12..]].concat(), "format 99");
}

#[test]
fn missing() {
    let place = place();
    place.refuses("tiny.toml --resume none.muslin", &["none.muslin: ", "cannot read checkpoint"]);
    place.refuses("tiny.toml --resume .", &[".: cannot read checkpoint"]);
}

#[test]
fn of_another_run() {
    let place = place();
    let refuses =
        |words: &str, part: &str| place.refuses(&format!("{words} --resume kept.muslin"), &["kept.muslin: ", part]);
    refuses("tiny.toml --precision f64", "--precision");
    refuses("flag", "another scene");
    refuses("tiny.toml --set integrator.step=0.005", "another scene");
    refuses("tiny.toml --set cloth.grid.cells=[2,2]", "another scene");
    refuses("tiny.toml --set integrator.method=bdf2", "another scene");
    refuses("tiny.toml --duration 0.05", "at step 14, the run ends with step 5; give a longer --duration");
    // A comment or another notation of the same number does not change the scene.
    place.write("same.toml", format!("# The same.\n{}", TINY.replace("step = 0.01", "step = 1e-2 # s")));
    place.run("same.toml --resume kept.muslin");
}

#[test]
fn of_another_mesh() {
    let place = Place::new();
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
    place.write("mesh.obj", mesh);
    place.write("scene.toml", TINY.replace("grid = { size = [0.3, 0.3], cells = [4, 4] }", "mesh = \"mesh.obj\""));
    place.run("scene.toml --checkpoint 10");
    std::fs::rename(place.path("out/checkpoint.muslin"), place.path("kept.muslin")).unwrap();
    std::fs::remove_dir_all(place.path("out")).unwrap();
    place.write("mesh.obj", mesh.replace("v 1 0 0", "v 1.5 0 0"));
    place.refuses("scene.toml --resume kept.muslin", &["another scene"]);
}

#[test]
fn a_checkpoint_that_cannot_be_written_leaves_the_old_one() {
    let place = Place::new();
    place.run("tiny.toml --checkpoint 7");
    let old = place.read("out/checkpoint.muslin");
    std::fs::create_dir(place.path("out/checkpoint.muslin.partial")).unwrap();
    let outcome = place.muslin("run tiny.toml --resume out/checkpoint.muslin --checkpoint 5").expect(1);
    assert!(outcome.stderr.contains("cannot write out/checkpoint.muslin"), "{outcome:?}");
    assert_eq!(place.read("out/checkpoint.muslin"), old);
}

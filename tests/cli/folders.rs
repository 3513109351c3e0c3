//! One folder contains the files of one run: commands do not share it, a new run removes what an old one left, and a
//! resumed run continues nothing but its own frames.

use std::fs;
use std::process::{Child, Stdio};

use crate::contact::THROUGH;
use crate::kit::{Place, PointCache, TINY, wait_until};

/// A command that writes many kinds of files into `out`, `steps.svg` among them.
const ALL: &str = "run tiny.toml --out out --export obj,pc2,usda,vtp --checkpoint 6 \
                   --set integrator.method=backward-euler --set integrator.error=1e-5";

/// Starts a run into `out` that would take very long, and waits for its first checkpoint.
fn endless(place: &Place) -> Child {
    let words = "run tiny.toml --out out --preview none --duration 1000000 --checkpoint 1";
    let child = place.command(words).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_until(|| place.path("out/checkpoint.muslin").exists(), "a checkpoint");
    child
}

#[test]
fn a_folder_in_use_is_refused_until_the_process_is_dead() {
    let place = Place::new();
    let mut first = endless(&place);
    for words in [
        "run tiny.toml --out out",
        "run tiny.toml --duration 1000000 --resume out/checkpoint.muslin",
        "stability tiny.toml --out out",
        "chart tiny.toml --out out",
        "validate --only hinge --out out",
    ] {
        let refused = place.muslin(words).expect(1);
        assert!(refused.stderr.contains("another muslin is writing to the folder out;"), "{words}: {refused:?}");
        assert_eq!(refused.stdout, "");
    }
    assert!(first.try_wait().unwrap().is_none(), "the first run has ended");
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(place.path("out/.muslin.lock").exists(), "a killed process leaves its lock file");
    place.run("tiny.toml");
    assert_eq!(place.files("out"), ["cloth.obj", "cloth.pc2", "run.json", "summary.json"]);
}

#[test]
#[cfg(unix)]
fn a_lock_that_is_a_link_is_refused() {
    let place = Place::new();
    fs::create_dir(place.path("out")).unwrap();
    place.write("mine.txt", "mine");
    for target in ["mine.txt", "nowhere.txt"] {
        std::os::unix::fs::symlink(place.path(target), place.path("out/.muslin.lock")).unwrap();
        for words in ["run tiny.toml --out out", "stability tiny.toml --out out"] {
            let refused = place.muslin(words).expect(1);
            assert!(
                refused.stderr.contains("out/.muslin.lock is a link or no file; remove it"),
                "{words}: {refused:?}"
            );
        }
        assert_eq!((place.read("mine.txt"), place.path("nowhere.txt").exists()), (b"mine".into(), false), "{target}");
        fs::remove_file(place.path("out/.muslin.lock")).unwrap();
    }
}

#[test]
fn an_output_folder_that_is_a_file() {
    let place = Place::new();
    place.write("out", "mine");
    for words in ["run tiny.toml --out out", "stability tiny.toml --out out", "validate --only hinge --out out"] {
        let refused = place.muslin(words).expect(2);
        assert!(refused.stderr.contains("out is a file; give a folder by --out"), "{words}: {refused:?}");
    }
    assert_eq!(place.read("out"), b"mine");
}

#[test]
fn a_new_run_removes_the_files_of_the_old_one_and_no_others() {
    let place = Place::new();
    for preview in ["gif", "png"] {
        place.muslin(&format!("{ALL} --preview {preview}")).expect(0);
    }
    let left = place.files("out");
    for file in ["checkpoint.muslin", "cloth.usda", "preview.png", "steps.svg", "vtp/cloth_00004.vtp"] {
        assert!(left.iter().any(|name| name == file), "{file} is not in {left:?}");
    }
    for own in ["out/notes.txt", "out/frames/frame_1.obj", "out/vtp/cloth_00001.vtp.txt", "out/needs.txt"] {
        place.write(own, "mine");
    }
    place.run("tiny.toml --export none");
    let mine = ["frames/frame_1.obj", "needs.txt", "notes.txt", "run.json", "summary.json", "vtp/cloth_00001.vtp.txt"];
    assert_eq!(place.files("out"), mine);

    mine.iter()
        .filter(|file| file.contains('/'))
        .for_each(|file| fs::remove_file(place.path("out").join(file)).unwrap());
    place.muslin(&format!("{ALL} --preview none")).expect(0);
    place.run("tiny.toml");
    let folders = ["frames", "vtp"].map(|folder| place.path("out").join(folder).exists());
    assert_eq!(folders, [false; 2], "an empty folder is left");
}

/// The same scene with other settings replaces itself as it always does; another scene may have been wanted still.
#[test]
fn a_run_tells_that_it_removes_another_scene() {
    let place = Place::new();
    place.write("other.toml", TINY.replace("\"tiny\"", "\"other\""));
    let told = |words: &str| {
        let outcome = place.muslin(&format!("run --out out --preview none {words}")).expect(0);
        outcome.stderr.contains("removed the outputs of tiny that were in out\n")
    };
    assert!(!told("tiny.toml"), "the folder is new");
    assert!(!told("tiny.toml --set cloth.density=0.3"), "the same scene");
    assert!(told("other.toml"));
    assert!(!told("other.toml"), "they are removed");
    place.run("tiny.toml");
    assert!(told("other.toml --quiet"), "a warning stands on stderr with --quiet too");
    assert_eq!(place.files("out"), ["cloth.obj", "cloth.pc2", "run.json", "summary.json"]);
}

#[test]
fn a_file_in_a_format_that_no_run_has_written_stays() {
    let place = Place::new();
    place.write("cloth.obj", "mine");
    place.write("cloth.usda", "mine");
    for _ in 0..2 {
        place.muslin("run tiny.toml --out . --export obj --preview none").expect(0);
    }
    assert!(["cloth.obj", "cloth.usda"].iter().all(|file| place.read(file) == b"mine"));
}

#[test]
fn a_run_that_is_refused_removes_nothing() {
    let place = Place::new();
    place.muslin(ALL).expect(0);
    fs::create_dir(place.path("copy")).unwrap();
    let files = place.files("out");
    let before: Vec<_> = files.iter().map(|file| place.read(&format!("out/{file}"))).collect();
    for words in ["--set cloth.density=-1", "--set integrator.step=1e-300", "--resume out/summary.json"] {
        place.muslin(&format!("run tiny.toml --out out {words}")).expect(2);
        assert_eq!(place.files("out"), files, "{words}");
        let after = files.iter().map(|file| place.read(&format!("out/{file}")));
        assert!(after.eq(before.iter().cloned()), "{words}: a file has changed");
    }
}

/// Makes `first.muslin` and `second.muslin`, the checkpoints of two runs of which the second is in `out`.
fn two_runs(place: &Place, second: &str) {
    for (name, words) in [("first", ""), ("second", second)] {
        place.run(&format!("tiny.toml --export obj,pc2,usda,vtp --checkpoint 12 {words}"));
        fs::copy(place.path("out/checkpoint.muslin"), place.path(&format!("{name}.muslin"))).unwrap();
    }
}

#[test]
fn a_resumed_run_does_not_continue_the_frames_of_another() {
    for second in ["--set cloth.density=0.3", "--precision f64"] {
        let place = Place::new();
        two_runs(&place, second);
        let before = place.read("out/cloth.pc2");
        let words = "run tiny.toml --out out --export obj,pc2,usda,vtp";
        let refused = place.muslin(&format!("{words} --resume first.muslin")).expect(2);
        assert!(refused.stderr.contains("out contains the frames of another run"), "{second}: {refused:?}");
        assert!(place.read("out/cloth.pc2") == before, "{second}: the frames have changed");
        place.muslin(&format!("{words} {second} --resume second.muslin")).expect(0);
        assert!(place.read("out/cloth.pc2") == before, "{second}: the same run has other frames");
    }
}

#[test]
fn a_resumed_run_does_not_continue_frames_that_no_run_claims() {
    let place = Place::new();
    two_runs(&place, "--set cloth.density=0.3");
    fs::remove_file(place.path("out/run.json")).unwrap();
    let resume = "run tiny.toml --out out --preview none --resume first.muslin";
    let refused = place.muslin(resume).expect(2);
    assert!(refused.stderr.contains("out contains the frames of another run"), "{refused:?}");
}

#[test]
fn a_new_run_removes_the_checkpoint_of_the_old_one() {
    let place = Place::new();
    place.run("tiny.toml --checkpoint 12");
    place.run("tiny.toml --set cloth.density=0.3");
    place.muslin("run tiny.toml --resume out/checkpoint.muslin").expect(2);
    assert_eq!(PointCache::parse(&place.read("out/cloth.pc2")).frames.len(), 5);
}

#[test]
fn a_new_run_in_place_of_an_interrupted_one_is_told() {
    let place = Place::new();
    let resume = "--resume out/checkpoint.muslin would have gone on with it";
    for (words, hints) in [("--quiet", true), ("--set cloth.density=0.3", false)] {
        let mut first = endless(&place);
        first.kill().unwrap();
        first.wait().unwrap();
        let told = place.muslin(&format!("run tiny.toml --out out --preview none {words}")).expect(0).stderr;
        assert_eq!(
            told.matches("an interrupted run").count() + told.matches("the interrupted run").count(),
            1,
            "{told}"
        );
        assert!(told.contains("at step ") && told.contains(resume) == hints, "{told}");
        let summary: serde_json::Value = serde_json::from_slice(&place.read("out/summary.json")).unwrap();
        let warnings = &summary["warnings"];
        assert!(
            warnings[0]["code"] == "replaced" && told.contains(warnings[0]["text"].as_str().unwrap()),
            "{warnings}"
        );
    }
    place.run("tiny.toml --checkpoint 12");
    let told = place.muslin("run tiny.toml --out out --preview none").expect(0).stderr;
    assert!(!told.contains("interrupted"), "the run before came to its end: {told}");
}

#[test]
fn frames_that_are_missing_are_told() {
    let place = Place::new();
    place.run("tiny.toml --export pc2,obj --checkpoint 12");
    let words = "run tiny.toml --preview none --quiet --json --export pc2,obj,usda,vtp --resume out/checkpoint.muslin";
    let warnings = &place.muslin(words).expect(0).json()["warnings"];
    let texts: Vec<_> = warnings.as_array().unwrap().iter().map(|warning| warning["text"].as_str().unwrap()).collect();
    let told = ["usda", "vtp"]
        .map(|format| format!("--export {format}: begins with frame 3; out does not contain all frames before it"));
    assert_eq!(texts, told);
}

/// The summary of a run of which the audit saw only a part, and the warning.
fn with_a_gap(place: &Place, scene: &str, [first, second]: [&str; 2], code: i32) -> (serde_json::Value, String) {
    place.muslin(&format!("run {scene} --out out --preview none --duration 0.1 --checkpoint 10 {first}"));
    let words = format!("run {scene} --preview none --json --resume out/checkpoint.muslin {second}");
    let outcome = place.muslin(&words).expect(code);
    (outcome.json(), outcome.stderr)
}

#[test]
fn an_audit_claims_only_the_frames_that_it_saw() {
    let place = Place::new();
    place.write("through.toml", TINY.to_owned() + THROUGH);
    let whole = place.muslin("run through.toml --out out --preview none --json --audit").expect(3).json();
    assert!(whole["intersections"].as_u64() > Some(0) && whole["frames_audited"] == whole["frames"], "{whole}");

    // Each part of the run is audited in turn: 3 frames, then 2.
    for (parts, audited, code) in [(["--audit", ""], 3, 0), (["", "--audit"], 2, 0)] {
        let (summary, told) = with_a_gap(&place, "tiny.toml", parts, code);
        assert!(summary["intersections"].is_null() && summary["frames_audited"] == audited, "{summary}");
        assert_eq!(summary["verdict"], "ok");
        let warning = format!("{audited} of 5 frames were audited, without intersections: nothing is known about");
        assert!(told.contains(&warning), "{told}");
    }
    let (summary, told) = with_a_gap(&place, "through.toml", ["", "--audit"], 3);
    assert!(summary["intersections"].is_null() && summary["verdict"] == "intersecting", "{summary}");
    assert!(told.contains("2 of 5 frames were audited, with intersections, most of them in frame "), "{told}");

    let (summary, told) = with_a_gap(&place, "tiny.toml", ["--audit", "--audit"], 0);
    assert!(summary["intersections"] == 0 && !told.contains("were audited"), "{summary}");
    let (summary, told) = with_a_gap(&place, "tiny.toml", ["", ""], 0);
    assert!(summary["frames_audited"] == 0 && !told.contains("were audited"), "{summary}");
}

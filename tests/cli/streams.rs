//! Data on stdout, notes on stderr, no colours without a terminal, and output that cannot be written.

use std::io::pipe;
use std::process::Stdio;

use crate::kit::{Place, wait};

const RUN: &str = "run tiny.toml --out out --preview none";
const ESCAPE: char = '\u{1b}';

#[test]
fn json_is_one_document_and_notes_are_elsewhere() {
    let place = Place::new();
    let outcome = place.muslin(&format!("{RUN} --json --set integrator.step=0.03")).expect(0);
    assert_eq!(outcome.json()["verdict"], "ok");
    assert!(
        outcome.stderr.contains("taking 2 steps of") && outcome.stderr.contains("wrote out/cloth.pc2"),
        "{outcome:?}"
    );
}

#[test]
fn warnings_are_on_stderr_even_where_it_is_quiet() {
    let place = Place::new();
    let soft = "--set cloth.stretch.stiffness=0.25 --set cloth.shear.stiffness=0.25 --duration 0.5";
    for words in ["", "--quiet", "--json"] {
        let outcome = place.muslin(&format!("{RUN} {soft} {words}")).expect(0);
        let warns = |text: &str| text.contains("cloth does not stretch by");
        assert!(warns(&outcome.stderr) && !warns(&outcome.stdout), "{words}: {outcome:?}");
    }
}

#[test]
fn quiet_is_quiet() {
    let place = Place::new();
    let outcome = place.muslin(&format!("{RUN} --quiet")).expect(0);
    assert_eq!((outcome.stdout.as_str(), outcome.stderr.as_str()), ("", ""));
    let outcome = place.muslin(&format!("{RUN} --quiet --json")).expect(0);
    assert_eq!((outcome.json()["steps"].as_u64(), outcome.stderr.as_str()), (Some(20), ""));
    let outcome = place.muslin(&format!("{RUN} --quiet --set nme=x")).expect(2);
    assert!(!outcome.stderr.is_empty(), "errors are not for hushing");
}

#[test]
fn a_person_gets_a_summary() {
    let place = Place::new();
    let outcome = place.muslin(RUN).expect(0);
    for part in [
        "tiny: 27 vertices, 36 triangles, 0.30 x 0.00 x 0.30 m, 0.018 kg, 2 pinned",
        "20 steps",
        "by backward-euler in f32",
        "state fnv1a:",
    ] {
        assert!(outcome.stdout.contains(part), "{part:?} is not in {}", outcome.stdout);
    }
}

#[test]
fn no_escape_codes_without_a_terminal() {
    let place = Place::new();
    for words in [RUN, "run --bogus", "run flg", "--help", "scenes", "run tiny.toml --set nme=x"] {
        let outcome = place.muslin(words);
        assert!(!outcome.stdout.contains(ESCAPE) && !outcome.stderr.contains(ESCAPE), "{outcome:?}");
    }
    let mut command = place.command("run --bogus");
    let outcome = place.finish({
        command.env("NO_COLOR", "1");
        command
    });
    assert!(!outcome.stderr.contains(ESCAPE));
}

#[test]
fn a_reader_that_went_away_is_no_fault() {
    let place = Place::new();
    let closed = || pipe().unwrap().1;
    for (words, code) in
        [(RUN, 0), ("scenes", 0), ("scenes flag", 0), ("--help", 0), ("run flg", 2), ("run --bogus", 2)]
    {
        let mut command = place.command(words);
        let mut child = command.stdout(closed()).stderr(closed()).spawn().unwrap();
        assert_eq!(wait(&mut child, &command).code(), Some(code), "{words}");
        let mut json = place.command(&format!("{RUN} --json"));
        let mut child = json.stdout(closed()).stderr(Stdio::null()).spawn().unwrap();
        assert_eq!(wait(&mut child, &json).code(), Some(0));
    }
}

#[test]
fn a_folder_that_cannot_be_made() {
    let place = Place::new();
    // The folder would be below a regular file, where not even root can create a folder.
    for format in ["obj", "pc2", "usda", "vtp"] {
        let outcome = place.muslin(&format!("run tiny.toml --out tiny.toml/out --export {format}")).expect(1);
        assert_eq!((outcome.stdout.as_str(), outcome.stderr.lines().count()), ("", 1), "{outcome:?}");
        assert!(outcome.stderr.contains("muslin: cannot write tiny.toml/out/"), "{outcome:?}");
        assert!(outcome.stderr.contains("check that its folder exists, is writable"), "{outcome:?}");
    }
    assert_eq!(place.files("."), ["tiny.toml"]);
}

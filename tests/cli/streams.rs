//! Data on stdout, notes on stderr, no colours without a terminal, and output that cannot be written.

use std::io::pipe;

use tempfile::NamedTempFile;

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
        let warns = |text: &str| text.contains("more than cloth does");
        // In the document, they are data.
        assert_eq!((warns(&outcome.stderr), warns(&outcome.stdout)), (true, words == "--json"), "{words}: {outcome:?}");
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
        "tiny: 27 vertices, 36 triangles, 0.30 m x 0 m x 0.30 m, 18.0 g, 2 pinned",
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
fn data_that_nobody_reads_are_a_failure() {
    let place = Place::new();
    place.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    place.write("sweep.toml", "scene = \"tiny.toml\"\nduration = 0.05\n");
    let closed = || pipe().unwrap().1;
    let study = "tiny.toml --duration 0.05 --cost counts --budget 1 --out study";
    for words in [
        RUN,
        &format!("{RUN} --json"),
        "scenes",
        "scenes flag",
        "scenes --json",
        "--help",
        "--version",
        "run --help",
        "devices",
        "detect sheet.obj --thickness 0",
        "bench tiny.toml",
        "sweep sweep.toml",
        "validate --list",
        "validate --only hanging --out study",
        &format!("stability {study} --methods rk4"),
        &format!("chart {study} --methods rk4 --json"),
        &format!("needs {study}"),
        &format!("choose {study} --tolerance 1cm"),
    ] {
        let mut command = place.command(words);
        let stderr = NamedTempFile::new().unwrap();
        let mut child = command.stdout(closed()).stderr(stderr.reopen().unwrap()).spawn().unwrap();
        let code = wait(&mut child, &command).code();
        let told = std::io::read_to_string(stderr).unwrap();
        assert!(code == Some(1) && told.contains("muslin: cannot write to stdout: "), "{words}: {code:?}, {told}");
        assert!(!told.contains("panicked"), "{words}: {told}");
    }
    // The files are written first.
    assert!(["out/summary.json", "study/needs.json"].iter().all(|file| place.path(file).exists()));
}

/// Before `main`, the runtime of Rust opens `/dev/null` for reading and writing in place of a closed stdout. Python and
/// Node.js open it in the same way for a program without output (`1<>`), which is no failure: the two look alike.
#[test]
#[cfg(unix)]
fn a_closed_stdout_is_like_dev_null() {
    let place = Place::new();
    for to in [">&-", ">/dev/null", "1<>/dev/null"] {
        let mut shell = std::process::Command::new("sh");
        shell.args(["-c", &format!("exec {} {RUN} --quiet --json {to}", env!("CARGO_BIN_EXE_muslin"))]);
        let mut child = shell.current_dir(place.path("")).spawn().unwrap();
        assert_eq!(wait(&mut child, &shell).code(), Some(0), "{to}");
        std::fs::remove_file(place.path("out/summary.json")).unwrap();
    }
}

#[test]
fn messages_that_nobody_reads_are_no_failure() {
    let place = Place::new();
    let closed = || pipe().unwrap().1;
    for (words, code) in [(format!("{RUN} --quiet").as_str(), 0), ("run flg", 2), ("run --bogus", 2)] {
        let mut command = place.command(words);
        let mut child = command.stdout(closed()).stderr(closed()).spawn().unwrap();
        assert_eq!(wait(&mut child, &command).code(), Some(code), "{words}");
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

//! Interrupted studies report what they know, exit with code 130, and go on from their finished runs. Costs are
//! computed from counts, so that the report is that of an uninterrupted study, number for number.
#![cfg(unix)]

use std::fs::OpenOptions;
use std::process::{Command, Stdio};
use std::thread;

use serde_json::Value;

use crate::kit::{Place, SOFT, TINY, wait, wait_until};

/// The output of a command that was interrupted.
struct Interrupted {
    stdout: String,
    stderr: String,
}

/// Interrupts a command once a condition is true, and asserts that it exits with code 130.
#[track_caller]
fn interrupt(place: &Place, words: &str, once: impl Fn() -> bool) -> Interrupted {
    signal(place, words, "-INT", once)
}

/// Sends a signal to a command once a condition is true, and asserts that it exits with code 130.
#[track_caller]
fn signal(place: &Place, words: &str, signal: &str, once: impl Fn() -> bool) -> Interrupted {
    // Not pipes: a report may be longer than a pipe holds.
    let [stdout, stderr] = [tempfile::NamedTempFile::new().unwrap(), tempfile::NamedTempFile::new().unwrap()];
    let mut command = place.command(words);
    let mut child = command.stdout(stdout.reopen().unwrap()).stderr(stderr.reopen().unwrap()).spawn().unwrap();
    wait_until(|| once() || child.try_wait().unwrap().is_some(), words);
    // It fails if the command has ended; then the exit code says so.
    let _ = Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status();
    let code = wait(&mut child, &command).code();
    let [stdout, stderr] = [stdout, stderr].map(|file| std::fs::read_to_string(file.path()).unwrap());
    assert_eq!(code, Some(130), "{words}: {stderr}");
    Interrupted { stdout, stderr }
}

/// Number of files in a folder, which may be absent.
fn count(place: &Place, folder: &str) -> usize {
    std::fs::read_dir(place.path(folder)).map_or(0, Iterator::count)
}

/// Interrupts a study once it has kept `runs` runs. Asserts that it has a partial report, and that the same command
/// then repeats none of its runs and ends with the report of an uninterrupted study. `stem` is that of its files.
#[track_caller]
fn goes_on(words: &str, stem: &str, runs: usize) {
    let place = Place::new();
    place.write("soft.toml", SOFT);
    let whole = place.muslin(&format!("{words} --json --out whole")).expect(0).json();
    let kept = format!("part/{stem}.kept");
    let words = format!("{words} --json --out part");
    let interrupted = interrupt(&place, &words, || count(&place, &kept) >= runs);
    let partial: Value = serde_json::from_str(&interrupted.stdout).unwrap();
    let finished = partial["finished"].as_u64().unwrap();
    assert!(partial["partial"] == true && finished >= runs as u64, "{partial}");
    assert!(interrupted.stderr.contains("go on with the same command"), "{}", interrupted.stderr);
    let report = String::from_utf8(place.read(&format!("part/{stem}.partial.txt"))).unwrap();
    assert!(report.starts_with(&format!("PARTIAL: interrupted after {finished} finished runs")), "{report}");
    assert!(!place.path(&format!("part/{stem}.json")).exists(), "a partial report has a name of its own");
    let mut again = place.muslin(&words).expect(0).json();
    let known = again.as_object_mut().unwrap().remove("runs_before_interrupt");
    assert_eq!(known, Some(finished.into()), "runs that were made again");
    assert_eq!(without_clock(again), without_clock(whole), "the report differs from that of an uninterrupted study");
    assert_eq!(place.files("part"), place.files("whole"), "files that an interrupt has left");
}

/// A report without the time of the checks of `validate`, which the clock measures.
fn without_clock(mut report: Value) -> Value {
    if report.get("passed").is_some() {
        report.as_object_mut().unwrap().remove("study_s");
    }
    report
}

#[test]
fn a_choice_goes_on_while_its_reference_is_sought() {
    goes_on("choose soft.toml --tolerance 0.1mm --set cloth.grid.cells=[12,12] --cost counts", "choose", 2);
}

#[test]
fn a_choice_goes_on_from_its_pilot_runs() {
    goes_on("choose soft.toml --tolerance 0.1mm --set cloth.grid.cells=[12,12] --cost counts", "choose", 12);
}

#[test]
fn a_chart_goes_on() {
    goes_on("chart soft.toml --finest 5e-5 --cost counts", "chart", 20);
}

#[test]
fn needs_goes_on() {
    goes_on("needs soft.toml --set cloth.grid.cells=[24,24] --cost counts", "needs", 4);
}

#[test]
fn a_map_of_stability_goes_on() {
    goes_on("stability soft.toml --cost counts --methods rk4,bdf2", "stability", 10);
}

#[test]
fn a_validation_goes_on() {
    goes_on("validate --only orders", "validate-orders", 3);
}

/// By the clock, times of both calls stand in one report, which says so.
#[test]
fn the_clock_is_read_in_both_calls() {
    let place = Place::new();
    place.write("soft.toml", SOFT);
    let words = "needs soft.toml --set cloth.grid.cells=[24,24] --out out";
    interrupt(&place, words, || count(&place, "out/needs.kept") >= 4);
    let report = place.muslin(words).expect(0).stdout;
    let last = report.trim_end().lines().last().unwrap();
    assert!(last.contains("runs were made before an interrupt, and their times were measured then"), "{report}");
}

/// The runs that were kept belong to their question: another scene makes its own.
#[test]
fn another_question_does_not_go_on() {
    let place = Place::new();
    place.write("soft.toml", SOFT);
    let words = "needs soft.toml --set cloth.grid.cells=[24,24] --cost counts --json --out out";
    interrupt(&place, words, || count(&place, "out/needs.kept") >= 4);
    let other = place.muslin(&format!("{words} --set cloth.density=0.3")).expect(0).json();
    assert_eq!(other.get("runs_before_interrupt"), None);
}

#[test]
fn before_a_run_is_finished_nothing_is_left() {
    let place = Place::new();
    place.write("long.toml", TINY.replace("frame_rate = 20", "frame_rate = 1"));
    let before = place.files(".");
    let words = "needs long.toml --duration 10000 --out deep/out";
    let interrupted = interrupt(&place, words, || place.path("deep/out").exists());
    assert!(interrupted.stderr.contains("there is nothing to report"), "{}", interrupted.stderr);
    assert!(place.files(".") == before && !place.path("deep").exists());
}

/// Many sheets in one place cross each other so often that untangling them takes very long.
#[test]
fn untangling_hears_an_interrupt() {
    let place = Place::new();
    let start = "name = \"pile\"\nduration = 0.1\n[contact]\nthickness = 0.002\n";
    let sheet = |index: i32| {
        format!(
            "[[cloth]]\ngrid = {{ size = [0.3, 0.3], cells = [4, 4] }}\nposition = [{}, {}, 0.0]\n\
             rotation = [{}, {}, 0]\ndensity = 0.2\nstretch = {{ model = \"membrane\", stiffness = 100.0 }}\n",
            0.001 * f64::from(index % 50),
            0.0005 * f64::from(index / 50),
            index % 90,
            index % 37
        )
    };
    place.write("pile.toml", (0..500).map(sheet).fold(start.to_owned(), |scene, sheet| scene + &sheet));
    let before = place.files(".");
    // The pause is longer than the scene takes to build, and far shorter than it takes to untangle.
    let started = std::time::Instant::now();
    let words = "run pile.toml --out out --preview none";
    let interrupted = interrupt(&place, words, || started.elapsed().as_secs() >= 5);
    assert!(interrupted.stderr.contains("interrupted before the first step"), "{}", interrupted.stderr);
    assert!(place.files(".") == before && !place.path("out").exists());
}

/// A scene and a sweep with a mesh from a pipe that nobody writes to: without an interrupt, to load them takes for
/// ever.
fn endless(place: &Place) {
    assert!(Command::new("mkfifo").arg(place.path("endless.obj")).status().unwrap().success());
    let grid = "grid = { size = [0.3, 0.3], cells = [4, 4] }";
    place.write("endless.toml", TINY.replace(grid, "mesh = \"endless.obj\""));
    place.write("sweep.toml", "scene = \"endless.toml\"\n[grid]\n\"cloth.density\" = [0.1, 0.2]\n");
}

/// Nothing is written before a scene is built.
#[test]
fn loading_a_scene_hears_an_interrupt() {
    let place = Place::new();
    endless(&place);
    let before = place.files(".");
    for words in [
        "run endless.toml",
        "sweep sweep.toml",
        "needs endless.toml",
        "chart endless.toml",
        "choose endless.toml --tolerance 1mm",
        "stability endless.toml",
    ] {
        for kind in ["-INT", "-TERM"] {
            // To open a pipe for writing waits for the command that opens it for reading.
            let pipe = place.path("endless.obj");
            let opened = thread::spawn(|| OpenOptions::new().write(true).open(pipe));
            let interrupted = signal(&place, words, kind, || opened.is_finished());
            assert!(interrupted.stderr.contains("; nothing is written"), "{words}: {}", interrupted.stderr);
            assert!(place.files(".") == before && !place.path("out").exists(), "{words}");
        }
    }
}

//! Sweeps that are killed, interrupted or run in parallel: in the end every run has exactly one complete line.
#![cfg(unix)]

use std::fs::File;
use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::kit::{Place, TINY, wait, wait_until};
use crate::sweep::{SWEEP, lines, place, results};

/// The third run would take very long.
const ENDLESS: &str = "[grid]\nduration = [0.1, 0.2, 1e6]\nintegrator.method = [\"backward-euler\"]\n";

fn start(place: &Place, words: &str) -> Child {
    let mut command = place.command(&format!("sweep {words}"));
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Starts the sweep [`ENDLESS`] and waits until it is in its third run.
fn start_endless(place: &Place) -> Child {
    place.write("s.toml", format!("scene = \"tiny.toml\"\n{ENDLESS}"));
    let sweep = start(place, "s.toml");
    let lines = || place.read("out/s.jsonl").split(|&b| b == b'\n').count();
    wait_until(|| place.path("out/s.jsonl").exists() && lines() == 3, "two lines");
    sweep
}

/// Shortens the third run and runs the sweep again; its results must equal an undisturbed sweep.
#[track_caller]
fn goes_on(place: &Place) {
    let before = place.read("out/s.jsonl");
    assert_eq!(lines(place, "out/s.jsonl").len(), 2);
    place.write("s.toml", format!("scene = \"tiny.toml\"\n{}", ENDLESS.replace("1e6", "0.3")));
    let outcome = place.muslin("sweep s.toml").expect(0);
    assert!(outcome.stderr.contains("2 of 3 done before"), "{}", outcome.stderr);
    assert!(place.read("out/s.jsonl").starts_with(&before), "finished lines were changed");
    same_as_undisturbed(place, "out/s.jsonl");
}

#[track_caller]
fn same_as_undisturbed(place: &Place, file: &str) {
    place.muslin("sweep s.toml --out undisturbed.jsonl").expect(0);
    assert_eq!(results(&lines(place, file)), results(&lines(place, "undisturbed.jsonl")));
}

#[test]
fn killed_in_the_middle() {
    let place = Place::new();
    let mut sweep = start_endless(&place);
    sweep.kill().unwrap();
    assert_eq!(sweep.wait().unwrap().signal(), Some(9));
    goes_on(&place);
}

#[test]
fn interrupted_in_the_middle() {
    for signal in ["-INT", "-TERM"] {
        let place = Place::new();
        let mut sweep = start_endless(&place);
        let sent = Command::new("sh").args(["-c", &format!("kill {signal} {}", sweep.id())]).status().unwrap();
        assert!(sent.success());
        assert_eq!(wait(&mut sweep, &place.command(signal)).code(), Some(130));
        let notes = std::io::read_to_string(sweep.stderr.take().unwrap()).unwrap();
        assert!(notes.contains("interrupted in the run with duration = 1000000.0"), "{notes}");
        assert!(notes.contains("go on with the same command"), "{notes}");
        goes_on(&place);
    }
}

#[test]
fn killed_again_and_again() {
    let place = many();
    for round in 0..10 {
        let mut sweep = start(&place, "s.toml");
        // The delay varies, so that sweeps are killed at different points.
        sleep(Duration::from_micros(3_000 + 3_333 * round));
        sweep.kill().unwrap();
        sweep.wait().unwrap();
    }
    place.muslin("sweep s.toml").expect(0);
    assert_eq!(lines(&place, "out/s.jsonl").len(), 60);
    same_as_undisturbed(&place, "out/s.jsonl");
}

/// A folder with a sweep of sixty short runs.
fn many() -> Place {
    let place = place();
    let steps: Vec<_> = (1..=10).map(|k| format!("{}", f64::from(k) * 1e-3)).collect();
    place.write("s.toml", SWEEP.replace("[0.01, 0.005]", &format!("[{}]", steps.join(", "))));
    place
}

#[test]
fn a_torn_line_is_cut_off() {
    let place = place();
    place.muslin("sweep s.toml --quiet").expect(0);
    let whole = place.read("out/s.jsonl");
    let last = whole[..whole.len() - 1].iter().rposition(|&byte| byte == b'\n').unwrap() + 1;
    // The last line is cut after its first byte, in its key, in its middle, or before its newline.
    for kept in [1, 20, (whole.len() - last) / 2, whole.len() - last - 1] {
        place.write("out/s.jsonl", &whole[..last + kept]);
        let outcome = place.muslin("sweep s.toml").expect(0);
        assert!(outcome.stderr.contains("11 of 12 done before"), "{kept}: {}", outcome.stderr);
        assert!(place.read("out/s.jsonl").starts_with(&whole[..last]), "{kept}: whole lines were changed");
        same_as_undisturbed(&place, "out/s.jsonl");
    }
}

#[test]
fn files_of_others_are_left_alone() {
    let place = place();
    for text in ["notes\n", "notes", "{\"a\": 1}\n", "{\"key\":\"a\"}\n", "\0\0\0"] {
        place.write("notes.txt", text);
        let outcome = place.muslin("sweep s.toml --out notes.txt").expect(2);
        assert!(outcome.stderr.contains("a line that no sweep has written"), "{text:?}: {}", outcome.stderr);
        assert_eq!(place.read("notes.txt"), text.as_bytes());
    }
    let folder = place.muslin("sweep s.toml --out .").expect(2);
    assert!(folder.stderr.contains(". is no file"), "{}", folder.stderr);
    let inside = place.muslin("sweep s.toml --out tiny.toml/s.jsonl").expect(1);
    assert!(inside.stderr.contains("tiny.toml/s.jsonl"), "{}", inside.stderr);
}

#[test]
fn a_full_disk_leaves_whole_lines() {
    let place = place();
    let mut limited = Command::new("sh");
    // The blocks are of 512 or 1024 bytes: some lines fit, but not all.
    let script = "trap '' XFSZ; ulimit -f 10; exec \"$0\" sweep s.toml";
    limited.args(["-c", script]).arg(place.command("").get_program()).current_dir(place.path(""));
    let outcome = place.finish(limited).expect(1);
    assert!(outcome.stderr.contains("cannot write out/s.jsonl") && outcome.stderr.contains("has room"), "{outcome:?}");
    let written = lines(&place, "out/s.jsonl").len();
    assert!((1..12).contains(&written), "{written} lines");
    place.muslin("sweep s.toml").expect(0);
    same_as_undisturbed(&place, "out/s.jsonl");
}

/// The mesh is a named pipe, so that the test determines the contents at each read.
#[test]
fn a_mesh_that_changes_under_way() {
    let place = Place::new();
    let mesh = "v 0 1 0\nv 0.1 1 0\nv 0.1 1 0.1\nv 0 1 0.1\nf 1 2 3\nf 1 3 4\n";
    let scene = TINY.replace("grid = { size = [0.3, 0.3], cells = [4, 4] }", "mesh = \"quad.obj\"");
    place.write("tiny.toml", scene.replace("corners = [0, 1]", "vertices = [0]"));
    place.write("s.toml", "scene = \"tiny.toml\"\n");
    assert!(Command::new("mkfifo").arg(place.path("quad.obj")).status().unwrap().success());
    let (pipe, meshes) =
        (place.path("quad.obj"), [mesh, mesh, &mesh.replace("v 0.1 1 0\n", "v 0.2 1 0\n")].map(String::from));
    let (next, folder) = (place.path("next.obj"), place.path(""));
    let writer = std::thread::spawn(move || {
        for mesh in meshes {
            let mut reader = File::options().write(true).open(&pipe).unwrap();
            reader.write_all(mesh.as_bytes()).unwrap();
            // A new pipe replaces this pipe before it closes, so that the next writer cannot reach the same reader.
            assert!(Command::new("mkfifo").arg("next.obj").current_dir(&folder).status().unwrap().success());
            std::fs::rename(&next, &pipe).unwrap();
        }
    });
    let outcome = place.muslin("sweep s.toml").expect(1);
    writer.join().unwrap();
    assert!(outcome.stderr.contains("has changed since the sweep began"), "{}", outcome.stderr);
    assert_eq!(place.read("out/s.jsonl"), b"");
}

/// Runs several processes on one result file and compares it with the file of a single process.
fn side_by_side(each: impl Fn(usize) -> String, count: usize) {
    let place = many();
    let mut sweeps: Vec<_> =
        (1..=count).map(|k| start(&place, &format!("s.toml --out all.jsonl {}", each(k)))).collect();
    for sweep in &mut sweeps {
        assert_eq!(wait(sweep, &place.command("sweep")).code(), Some(0));
    }
    assert_eq!(lines(&place, "all.jsonl").len(), 60);
    same_as_undisturbed(&place, "all.jsonl");
}

#[test]
fn shards_share_a_file() {
    side_by_side(|number| format!("--shard {number}/4"), 4);
}

/// This happens when a job is restarted while its first process still runs.
#[test]
fn the_same_sweep_three_times_at_once() {
    side_by_side(|_| String::new(), 3);
}

/// Runs the shards by GNU parallel; skipped if it is not installed.
#[test]
#[ignore = "slow"]
fn shards_by_gnu_parallel() {
    if Command::new("parallel").arg("--version").output().is_err() {
        eprintln!("skipped: GNU parallel is not installed");
        return;
    }
    let place = many();
    let muslin = place.command("");
    let mut parallel = Command::new("parallel");
    parallel.current_dir(place.path("")).arg(muslin.get_program());
    parallel.args(["sweep", "s.toml", "--quiet", "--shard", "{}/8", ":::", "1", "2", "3", "4", "5", "6", "7", "8"]);
    place.finish(parallel).expect(0);
    let all = (1..=8).flat_map(|number| lines(&place, &format!("out/s.{number}-of-8.jsonl")));
    place.muslin("sweep s.toml --out undisturbed.jsonl").expect(0);
    assert_eq!(results(&all.collect::<Vec<_>>()), results(&lines(&place, "undisturbed.jsonl")));
}

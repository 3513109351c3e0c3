//! Little memory: a scene that does not fit is refused before any work, and no result is lost.
#![cfg(target_os = "linux")]

use std::process::Command;

use crate::kit::{Outcome, Place, TINY};

const GRID: &str = "grid = { size = [0.3, 0.3], cells = [4, 4] }";
const PIN: &str = "corners = [0, 1]";

/// Runs `muslin` with an address space of so many KiB.
fn within(place: &Place, kibibytes: u64, words: &str) -> Outcome {
    let program = place.command(words);
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit -v {kibibytes} && exec \"$0\" \"$@\"")]).arg(program.get_program());
    // Each thread may reserve address space of its own.
    command.args(program.get_args()).env("MALLOC_ARENA_MAX", "1").current_dir(place.path("."));
    place.finish(command)
}

/// Sheets that would need more memory than the process may have end with an error that says how much they need.
#[test]
fn more_than_there_is_memory_for() {
    let place = Place::new();
    let sphere = "[contact]\nthickness = 0.001\n[[collider]]\nshape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 0.1\n";
    place.write("touching.toml", format!("{TINY}\n{sphere}"));
    let mesh = |mesh: &str| TINY.replace(GRID, mesh);
    place.write(
        "tube.toml",
        mesh("tube = { radius = 0.2, height = 0.6, cells = [5000, 5000] }").replace(PIN, "vertices = [0]"),
    );
    place.write("disc.toml", mesh("disc = { radius = 0.5, rings = 3000 }").replace(PIN, "vertices = [0]"));
    let cases = [
        ("run tiny.toml --out out --set cloth.grid.cells=[5000,5000]", "25012501 vertices"),
        ("run tiny.toml --out out --set cloth.grid.cells=[16000,16000]", "256040001 vertices"),
        ("run touching.toml --out out --set cloth.grid.cells=[1200,1200]", "1443001 vertices"),
        ("run tube.toml --out out --precision f64", "25005000 vertices"),
        ("run disc.toml --out out", "vertices"),
        ("needs tiny.toml --out out --set cloth.grid.cells=[5000,5000]", "25012501 vertices"),
        ("stability tiny.toml --out out --set cloth.grid.cells=[5000,5000]", "25012501 vertices"),
    ];
    for (words, vertices) in cases {
        let refused = within(&place, 4_000_000, words).expect(2);
        let named =
            ["needs about", "MB of memory", "coarser mesh", "MB of the 4096 MB that ulimit -v allows are in use"];
        for part in named.into_iter().chain([vertices]) {
            assert!(refused.stderr.contains(part), "{words}: {part:?} is not in {}", refused.stderr);
        }
        assert!(!place.path("out").exists(), "{words} has written");
    }
}

/// The number of megabytes after these words of a message.
fn megabytes(message: &str, words: &str) -> u64 {
    let after = message.split(words).nth(1).unwrap_or_else(|| panic!("{words:?} is not in {message:?}"));
    after.split_whitespace().next().unwrap().parse().unwrap_or_else(|error| panic!("{error} in {message:?}"))
}

/// From a limit at which the scene is refused up to one at which there is memory for everything.
#[test]
fn a_check_without_memory_costs_no_result() {
    let place = Place::new();
    let grid = "--set cloth.grid.cells=[150,150] --duration 0 --threads 1 --preview none --export none";
    for words in ["", "--set integrator.error=0", "--set integrator.method=symplectic-euler"] {
        let mut without = 0;
        for limit in (100_000..=300_000).step_by(10_000) {
            let outcome = within(&place, limit, &format!("run tiny.toml --out out {grid} --json {words}"));
            if outcome.code == Some(2) {
                let said = &outcome.stderr;
                let [needed, used] = ["needs about ", "mesh; "].map(|words| megabytes(said, words));
                let allowed = megabytes(said, "MB of the ");
                assert!(allowed == limit * 1024 / 1_000_000 && needed + used >= allowed, "{words}: {outcome:?}");
                continue;
            }
            let summary = outcome.expect(0).json();
            let codes = summary["warnings"].as_array().unwrap().iter();
            without += codes.filter(|warning| warning["code"] == "unchecked").count();
        }
        assert!(without > 0, "{words}: there was memory at every limit");
    }
}

/// A preview that there is no memory to draw is left out, and all else of the run is there: from a limit at which the
/// rest just runs up to one at which there is memory for the picture too.
#[test]
fn a_preview_without_memory_costs_no_result() {
    let place = Place::new();
    for kind in ["gif", "png"] {
        let mut drawn = Vec::new();
        for limit in (40_000..=200_000).step_by(10_000) {
            let run = |limit, kind: &str| {
                let words = format!("run tiny.toml --out out --threads 1 --json --preview {kind}");
                within(&place, limit, &words)
            };
            // With a little to spare for the snapshots.
            if run(limit - 4000, "none").code != Some(0) {
                continue;
            }
            let with_preview = run(limit, kind).expect(0);
            let summary = with_preview.json();
            let mut codes = summary["warnings"].as_array().unwrap().iter().map(|warning| &warning["code"]);
            let is_left_out = codes.any(|code| code == "preview");
            let said = with_preview.stderr.contains("the preview is left out: with 1 threads it needs about");
            assert_eq!(said, is_left_out, "{limit}: {with_preview:?}");
            let files = place.files("out");
            let has = |name: &str| files.iter().any(|file| file == name);
            assert_eq!(has(&format!("preview.{kind}")), !is_left_out, "{limit}: {files:?}");
            assert!(has("summary.json") && has("cloth.pc2") && !has(".muslin.lock"), "{limit}: {files:?}");
            drawn.push(!is_left_out);
        }
        assert!(drawn.is_sorted() && !drawn[0] && drawn[drawn.len() - 1], "{kind}: {drawn:?}");
    }
}

//! A disk that is full at any write: exit code 1, every output complete or absent, and the last checkpoint is kept.
//!
//! A limit on the size of files stands in for a full disk: it needs no privileges, and any file can be made the first
//! one that does not fit.
#![cfg(unix)]

use std::fs;
use std::process::Command;

use crate::kit::{Outcome, Place};

/// Runs `muslin` with files of at most this many blocks of 512 bytes.
fn limited(place: &Place, blocks: u64, words: &str) -> Outcome {
    let mut shell = Command::new("sh");
    // The signal would end the process before it sees the error of the write.
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec {} {words}", env!("CARGO_BIN_EXE_muslin"));
    shell.args(["-c", &script]).current_dir(place.path("")).env("RUST_BACKTRACE", "0");
    // Through pipes: files for the output would be limited too.
    let output = shell.output().unwrap();
    let [stdout, stderr] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert!(!stderr.contains("panicked"), "{words}: {stderr}");
    Outcome { code: output.status.code(), stdout, stderr }
}

/// The largest limits, in blocks, at which a file of the folder does not fit: one for each size of a file.
fn limits(place: &Place, folder: &str) -> Vec<u64> {
    let size = |file: String| fs::metadata(place.path(&format!("{folder}/{file}"))).unwrap().len();
    let sizes = place.files(folder).into_iter().map(size);
    let mut limits: Vec<_> = sizes.filter(|&size| size > 0).map(|size| (size - 1) / 512).collect();
    limits.sort_unstable();
    limits.dedup();
    limits
}

/// Asserts that each file in `out` is absent, partial or as in `whole`; times differ in some.
#[track_caller]
fn whole_or_absent(place: &Place, words: &str) {
    if !place.path("out").exists() {
        return;
    }
    let timed = ["summary.json", "checkpoint.muslin"];
    for file in place.files("out").iter().filter(|file| !file.ends_with(".partial")) {
        let [found, expected] = ["out", "whole"].map(|folder| place.read(&format!("{folder}/{file}")));
        let same = if timed.contains(&file.as_str()) { !found.is_empty() } else { found == expected };
        assert!(same, "{words}: {file} has {} of {} bytes", found.len(), expected.len());
    }
}

#[test]
fn a_run_keeps_whole_files_and_its_last_checkpoint() {
    let mut failed = 0;
    for options in [
        "--export obj --preview none",
        "--export pc2 --preview none",
        "--export usda --preview none",
        "--export vtp --preview none",
        "--export none --preview gif --checkpoint 3",
        "--export none --preview png",
        "--export obj,pc2,usda,vtp --preview gif --checkpoint 3",
    ] {
        let place = Place::new();
        let control = "--set integrator.method=backward-euler --set integrator.error=1e-5";
        let run = format!("run tiny.toml --quiet {control} {options}");
        let hash = place.muslin(&format!("{run} --json --out whole")).expect(0).json()["state_hash"].clone();
        for blocks in limits(&place, "whole") {
            let words = format!("{run} --out out in {blocks} blocks");
            let outcome = limited(&place, blocks, &format!("{run} --out out"));
            assert_eq!(outcome.code, Some(1), "{words}: {outcome:?}");
            assert!(outcome.stderr.contains("cannot write out/"), "{words}: {outcome:?}");
            failed += 1;
            whole_or_absent(&place, &words);
            if place.path("out/checkpoint.muslin").exists() {
                let more = format!("{run} --json --resume out/checkpoint.muslin");
                assert_eq!(place.muslin(&more).expect(0).json()["state_hash"], hash, "{words}");
                place.same_files_but("out", "whole", &["summary.json", "preview.gif", "steps.svg"]);
            }
            let _ = fs::remove_dir_all(place.path("out"));
        }
    }
    assert!(failed > 20, "only {failed} writes failed");
}

#[test]
fn a_study_keeps_whole_files() {
    let place = Place::new();
    let study = "stability tiny.toml --methods rk4 --duration 0.05 --cost counts --quiet";
    place.muslin(&format!("{study} --out whole")).expect(0);
    for blocks in limits(&place, "whole") {
        let outcome = limited(&place, blocks, &format!("{study} --out out"));
        assert_eq!(outcome.code, Some(1), "{blocks} blocks: {outcome:?}");
        whole_or_absent(&place, study);
        let _ = fs::remove_dir_all(place.path("out"));
    }
}

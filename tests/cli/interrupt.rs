//! Killed and interrupted runs resume from their checkpoint and end in the same state as an undisturbed run.
#![cfg(unix)]

use std::hash::{BuildHasher, RandomState};
use std::io::{BufRead, BufReader};
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::kit::{Place, TINY, wait, wait_until};

/// The signal of a kill.
const SIGKILL: i32 = 9;

/// A folder with a sheet that is large enough that writing a checkpoint takes a while.
fn place() -> Place {
    let place = Place::new();
    place.write(
        "sheet.toml",
        TINY.replace("cells = [4, 4]", "cells = [24, 24]").replace("0.2\nframe_rate", "0\nframe_rate"),
    );
    place
}

/// Starts a run into `out` that would take very long.
fn start(place: &Place, words: &str) -> Child {
    let mut command = place.command(&format!("run sheet.toml --out out --preview none --duration 10000 {words}"));
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

fn wait_for(place: &Place, file: &str) {
    wait_until(|| place.path(file).exists(), file);
}

/// The step of the checkpoint in `out`, read from the error message of a resumed run with a duration of zero.
fn step_reached(place: &Place) -> u64 {
    let outcome = place.muslin("run sheet.toml --out no --duration 0 --resume out/checkpoint.muslin");
    if outcome.code == Some(0) {
        return 0;
    }
    let words: Vec<&str> = outcome.stderr.split([' ', ',']).collect();
    let at = words.windows(2).position(|pair| pair == ["at", "step"]).unwrap_or_else(|| panic!("{outcome:?}"));
    words[at + 2].parse().unwrap()
}

/// Resumes for a few frames after the checkpoint and compares the output with an uninterrupted run.
fn ends_as_a_run_in_one(place: &Place) {
    let duration = (step_reached(place) + 15).div_ceil(5) as f64 * 0.05;
    // Both runs write checkpoints, which must agree too.
    let words = format!("sheet.toml --export obj,pc2,usda,vtp --checkpoint 5 --duration {duration}");
    let parts = place.run(&format!("{words} --resume out/checkpoint.muslin"));
    std::fs::rename(place.path("out"), place.path("parts")).unwrap();
    let whole = place.run(&words);
    assert_eq!(whole["state_hash"], parts["state_hash"]);
    place.same_files("out", "parts");
}

#[test]
fn killed_again_and_again() {
    let place = place();
    let mut resume = "";
    for round in 0..8 {
        let mut child = start(&place, &format!("--export obj,pc2,usda,vtp --checkpoint 1 {resume}"));
        wait_for(&place, "out/checkpoint.muslin");
        // The delay varies, so that runs are killed at different points.
        sleep(Duration::from_micros(5_000 + 7_777 * round));
        child.kill().unwrap();
        child.wait().unwrap();
        resume = "--resume out/checkpoint.muslin";
    }
    ends_as_a_run_in_one(&place);
}

/// Kills runs at random times, `kills` times in all, and resumes each until it ends as the undisturbed run does. Only
/// pictures may differ: they show the own part of a resumed run.
fn killed_at_random(kills: usize, preview: &str) {
    let place = place();
    let words = format!(
        "run sheet.toml --duration 1 --export obj,pc2,usda,vtp --series all.csv --checkpoint 3 --preview {preview}"
    );
    let started = Instant::now();
    let hash = place.muslin(&format!("{words} --json --out whole")).expect(0).json()["state_hash"].clone();
    let time = started.elapsed();
    let (mut killed, mut ended) = (0, 0);
    while killed < kills || ended == 0 {
        let resume = place.path("out/checkpoint.muslin").exists().then_some("--resume out/checkpoint.muslin");
        let mut command = place.command(&format!("{words} --quiet --out out {}", resume.unwrap_or_default()));
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        if killed < kills {
            sleep(time.mul_f64(random()));
            child.kill().unwrap();
        }
        let status = child.wait().unwrap();
        if status.signal() == Some(SIGKILL) {
            killed += 1;
            continue;
        }
        assert_eq!(status.code(), Some(0), "after {killed} kills");
        let summary: Value = serde_json::from_slice(&place.read("out/summary.json")).unwrap();
        assert_eq!(summary["state_hash"], hash, "after {killed} kills");
        place.same_files_but("out", "whole", &["summary.json", "preview.gif", "preview.png"]);
        std::fs::remove_dir_all(place.path("out")).unwrap();
        ended += 1;
    }
    println!("--preview {preview}: {killed} kills, {ended} runs came to their end");
}

/// A random number from 0 to 1.
fn random() -> f64 {
    RandomState::new().hash_one(0) as f64 / u64::MAX as f64
}

#[test]
#[ignore = "slow"]
fn killed_at_random_times() {
    ["none", "gif", "png"].iter().for_each(|preview| killed_at_random(8, preview));
}

#[test]
#[ignore = "slow"]
fn long_form_killed_a_hundred_times() {
    ["none", "gif", "png"].iter().for_each(|preview| killed_at_random(100, preview));
}

/// Signals a run `times` times at once, when the path `once` exists, checks that it ends as interrupted, and resumes it.
fn signalled(place: &Place, signal: &str, times: usize, once: &str) {
    let mut child = start(place, "--export obj,pc2,usda,vtp");
    wait_for(place, once);
    let kill = format!("kill {signal} {}", child.id());
    // The process may have ended before the last one.
    let all = format!("{kill}{}", format!(" && (sleep 0.002; {kill} || true)").repeat(times - 1));
    let sent = Command::new("sh").args(["-c", &all]).stderr(Stdio::null()).status().unwrap();
    assert!(sent.success(), "{all}");
    assert_eq!(wait(&mut child, &place.command(signal)).code(), Some(130));
    let notes = std::io::read_to_string(child.stderr.take().unwrap()).unwrap();
    assert!(notes.contains("interrupted at step") && notes.contains("--resume out/checkpoint.muslin"), "{notes}");
    assert!(!place.path("out/summary.json").exists());
    ends_as_a_run_in_one(place);
}

#[test]
fn interrupted_from_the_keyboard() {
    signalled(&place(), "-INT", 1, "out/frames/frame_00001.obj");
}

/// `timeout` signals a process and its group, and so does a terminal that closes.
#[test]
fn interrupted_twice_at_once() {
    signalled(&place(), "-INT", 2, "out/frames/frame_00001.obj");
}

#[test]
fn asked_to_terminate() {
    signalled(&place(), "-TERM", 1, "out/frames/frame_00001.obj");
}

/// The signal comes once the picture is announced: 120 frames of it are to be drawn.
#[test]
fn interrupted_while_the_preview_is_drawn() {
    let place = place();
    let mut command = place.command("run sheet.toml --out out --duration 1.2 --set frame_rate=100");
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut notes = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(notes.any(|note| note.contains("drawing out/preview.gif")), "the run ended early");
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert_eq!(wait(&mut child, &command).code(), Some(130));
    assert!(notes.any(|note| note.contains("interrupted while the preview was drawn")));
    assert_eq!(place.files("out"), ["cloth.obj", "cloth.pc2", "run.json", "summary.json"]);
}

/// The signal usually arrives before the first step, while the first frame is being written.
#[test]
fn interrupted_at_once() {
    let place = place();
    place.write("sheet.toml", TINY.replace("cells = [4, 4]", "cells = [80, 80]"));
    signalled(&place, "-INT", 1, "out/frames");
}

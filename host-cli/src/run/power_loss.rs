//! A run whose power is lost after any change on the disk goes on from its last checkpoint, and ends as the undisturbed
//! run does.
//!
//! The changes of a run are recorded once. For each of them, and for several ways to lose data that were not synced,
//! the test makes the folder that is left and resumes from the checkpoint in it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use clap::Parser;
use tempfile::TempDir;

use super::{CHECKPOINT, run_until};
use crate::args::{Arguments, Command, RunArguments};
use crate::disk::journal::{Disk, Event, Files, record};

/// 4 frames of 5 steps.
const SCENE: &str = r#"
duration = 0.2
frame_rate = 20
gravity = [0, -9.81, 0]
integrator = { step = 0.01 }
[[cloth]]
grid = { size = [0.3, 0.3], cells = [3, 3] }
density = 0.2
stretch = { model = "membrane", stiffness = 100.0 }
pin = [{ select = { corners = [0, 1] } }]
"#;

/// Ways to lose data for each change, besides the four in which all of a kind are lost.
const RANDOM: u64 = 4;

/// A folder with the scene, and the outputs of runs.
struct Place(TempDir);

impl Place {
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs the scene into the folder `out`.
    fn run(&self, out: &str, resume: bool) -> Result<(), String> {
        let (scene, out) = (self.path("scene.toml"), self.path(out));
        let checkpoint = out.join(CHECKPOINT);
        let [scene, out, checkpoint] = [&scene, &out, &checkpoint].map(|path| path.to_str().unwrap());
        let words = "--export obj,pc2,usda,vtp --series all.csv --preview none --quiet --threads 1 --checkpoint 3";
        let mut line = vec!["muslin", "run", scene, "--out", out];
        line.extend(words.split(' '));
        if resume {
            line.extend(["--resume", checkpoint]);
        }
        let Command::Run(arguments) = Arguments::parse_from(line).command else { unreachable!() };
        let arguments: &RunArguments = &arguments;
        run_until(arguments, &AtomicBool::new(false)).map_err(|failure| failure.to_string())
    }

    /// The files in a folder.
    fn files(&self, folder: &str) -> Files {
        let mut files = Files::new();
        read(&self.path(folder), &mut files);
        files
    }

    /// Makes a folder with these files, which have their paths in the folder `out`.
    fn make(&self, folder: &str, files: &Files) {
        let _ = fs::remove_dir_all(self.path(folder));
        for (path, bytes) in files {
            let path = self.path(folder).join(path.strip_prefix(self.path("out")).unwrap());
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        }
    }

    /// The outputs of a run in a folder, by their paths in it, and its hash.
    fn outputs(&self, folder: &str) -> (String, Files) {
        let root = self.path(folder);
        let mut files: Files = self
            .files(folder)
            .into_iter()
            .map(|(path, bytes)| (path.strip_prefix(&root).unwrap().into(), bytes))
            .collect();
        let summary: serde_json::Value =
            serde_json::from_slice(&files.remove(Path::new("summary.json")).unwrap()).unwrap();
        (summary["state_hash"].to_string(), files)
    }
}

fn read(folder: &Path, files: &mut Files) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => read(&path, files),
            false => drop(files.insert(path.clone(), fs::read(path).unwrap())),
        }
    }
}

/// The folders that a loss of power may leave.
fn losses(disk: &Disk, seed: u64) -> Vec<Files> {
    let of_a_kind =
        [false, true].map(|names| [false, true].map(|data| disk.lose(|| names, |n| if data { n - 1 } else { 0 })));
    let random = (0..RANDOM).map(|k| {
        let mut state = seed * RANDOM + k;
        let mut next = || {
            state += 1;
            crc32fast::hash(&state.wrapping_mul(0x9e37_79b9_7f4a_7c15).to_le_bytes()) as usize
        };
        let names: Vec<bool> = (0..64).map(|_| next() % 2 == 0).collect();
        let mut names = names.into_iter().cycle();
        disk.lose(|| names.next().unwrap(), |n| next() % n)
    });
    of_a_kind.into_iter().flatten().chain(random).collect()
}

/// Loses the power after each event of a run that began with these files; returns the number of folders resumed from.
fn every_loss(place: &Place, before: &Files, events: &[Event]) -> usize {
    let whole = place.outputs("whole");
    let checkpoint = place.path("out").join(CHECKPOINT);
    let mut disk = Disk::new(&place.path("out"), before);
    // The checkpoints so far, the older first, and how many of them must not be lost.
    let mut checkpoints: Vec<Vec<u8>> = before.get(&checkpoint).cloned().into_iter().collect();
    let (mut safe, mut written) = (checkpoints.len(), Vec::new());
    let mut seen = BTreeSet::new();
    for (number, event) in events.iter().enumerate() {
        // When the run goes on, its last checkpoint is safe.
        if !matches!(event, Event::SyncedFolder(_)) {
            safe = checkpoints.len();
        }
        match event {
            Event::Changed(_, bytes) => written.clone_from(bytes),
            Event::Renamed(_, to) if *to == checkpoint => checkpoints.push(written.clone()),
            _ => {}
        }
        disk.add(event);
        for left in losses(&disk, number as u64) {
            let after = format!("power lost after change {number}, {event:.80?}");
            let Some(found) = left.get(&checkpoint) else {
                assert_eq!(safe, 0, "{after}: the checkpoint is lost");
                continue;
            };
            let place_of = checkpoints.iter().position(|known| known == found);
            assert!(place_of.is_some(), "{after}: the checkpoint is torn");
            assert!(place_of >= safe.checked_sub(1), "{after}: an older checkpoint has come back");
            if !seen.insert(left.clone()) {
                continue;
            }
            place.make("left", &left);
            place.run("left", true).unwrap_or_else(|why| panic!("{after}: {why}"));
            let (hash, files) = place.outputs("left");
            assert_eq!(hash, whole.0, "{after}: the result differs");
            assert_eq!(files.keys().collect::<Vec<_>>(), whole.1.keys().collect::<Vec<_>>(), "{after}: other files");
            let differs = files.iter().find(|(path, bytes)| whole.1[*path] != **bytes);
            assert_eq!(differs.map(|(path, _)| path), None, "{after}: this file differs");
        }
    }
    seen.len()
}

#[test]
fn a_loss_of_power_keeps_the_last_checkpoint_and_the_frames_before_it() {
    // In memory, where there is a file system for this, syncs cost no time.
    let memory = Some(Path::new("/dev/shm")).filter(|memory| memory.is_dir());
    let place = Place(memory.map_or_else(tempfile::tempdir, tempfile::tempdir_in).unwrap());
    fs::write(place.path("scene.toml"), SCENE).unwrap();
    place.run("whole", false).unwrap();

    let events = record(&place.path("out"), || place.run("out", false).unwrap());
    let resumed = every_loss(&place, &Files::new(), &events);
    println!("{} changes of a run, {resumed} different folders were resumed from", events.len());

    // A resumed run rewrites files of the first one in place: the files after the checkpoint of step 9 and frame 2. It
    // copies those that are complete.
    let is_named = |event: &Event, name: &str| matches!(event, Event::Renamed(_, to) if to.ends_with(name));
    let nth = |name: &str, n: usize| {
        let mut named = events.iter().enumerate().filter(|(_, event)| is_named(event, name)).map(|(number, _)| number);
        named.nth(n).unwrap()
    };
    for cut in [nth(CHECKPOINT, 3), nth("cloth.pc2", 0) + 1, nth("cloth.usda", 0) + 1] {
        let mut disk = Disk::new(&place.path("out"), &Files::new());
        events[..cut].iter().for_each(|event| disk.add(event));
        let before = disk.lose(|| true, |n| n - 1);
        place.make("out", &before);
        let resumed_events = record(&place.path("out"), || place.run("out", true).unwrap());
        let resumed = every_loss(&place, &before, &resumed_events);
        println!("{} changes of a resumed run, {resumed} different folders were resumed from", resumed_events.len());
    }
}

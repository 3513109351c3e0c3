//! Files that are no plain files: links, devices and pipes; and files that are too large.
#![cfg(unix)]

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::process::Command;

use crate::kit::{Place, TINY};

/// A scene that is cheap to choose a method for.
const CHOOSE: &str = "choose tiny.toml --tolerance 1cm --duration 0.05 --cost counts --budget 1 --quiet --out study";

#[test]
fn choose_writes_through_a_link() {
    let place = Place::new();
    place.write("target.toml", "old");
    symlink("target.toml", place.path("link.toml")).unwrap();
    place.muslin(&format!("{CHOOSE} --write link.toml")).expect(0);
    assert!(place.path("link.toml").is_symlink(), "the link is gone");
    assert!(place.read("target.toml").starts_with(b"# Chosen by muslin choose"));
    place.run("link.toml");
}

/// A pipe stands for all devices: a real one would be lost if it were overwritten.
#[test]
fn choose_writes_to_files_only() {
    let place = Place::new();
    symlink("nothing.toml", place.path("dangling.toml")).unwrap();
    symlink("tiny.toml", place.path("scene.toml")).unwrap();
    fs::create_dir(place.path("folder")).unwrap();
    assert!(Command::new("mkfifo").arg(place.path("pipe")).status().unwrap().success());
    for (path, why) in [
        ("pipe", "not a file"),
        ("folder", "not a file"),
        ("dangling.toml", "leads to no file"),
        ("scene.toml", "this is the scene file itself"),
    ] {
        let refused = place.muslin(&format!("{CHOOSE} --write {path}")).expect(2);
        assert!(refused.stderr.contains(&format!("--write {path}: ")), "{refused:?}");
        assert!(refused.stderr.contains(why), "{refused:?}");
    }
    assert_eq!(place.read("tiny.toml"), TINY.as_bytes());
}

#[test]
fn a_partial_file_that_is_a_link_is_not_followed() {
    let place = Place::new();
    place.write("precious", "mine");
    fs::create_dir_all(place.path("out/frames")).unwrap();
    let partials = ["cloth.pc2", "cloth.usda", "frames/frame_00000.obj", "checkpoint.muslin", "summary.json"];
    let plant = || {
        for name in partials {
            symlink(place.path("precious"), place.path(&format!("out/{name}.partial"))).unwrap();
        }
    };
    plant();
    place.run("tiny.toml --export pc2,usda,obj --checkpoint 12");
    plant();
    place.run("tiny.toml --export pc2,usda,obj --resume out/checkpoint.muslin --checkpoint 2");
    assert_eq!(place.read("precious"), b"mine");
}

#[test]
fn files_without_an_end_are_refused() {
    let place = Place::new();
    for name in ["zero.toml", "zero.obj", "zero.ply", "zero.pc2"] {
        symlink("/dev/zero", place.path(name)).unwrap();
    }
    let mesh = |name: &str| TINY.replace("grid = { size = [0.3, 0.3], cells = [4, 4] }", &format!("mesh = \"{name}\""));
    place.write("obj.toml", mesh("zero.obj"));
    place.write("ply.toml", mesh("zero.ply"));
    let mover = "\n[[collider]]\nshape = \"mesh\"\nfile = \"floor.obj\"\nmotion = \"zero.pc2\"\nmotion_rate = 25\n";
    place.write("floor.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    place.write("pc2.toml", TINY.to_owned() + "[contact]\nthickness = 0.001\n" + mover);
    for (words, size) in [
        ("run tiny.toml --resume /dev/zero --out out", "64 MiB"),
        ("run zero.toml", "1 MiB"),
        ("sweep zero.toml", "1 MiB"),
        ("run obj.toml", "64 MiB"),
        ("run ply.toml", "64 MiB"),
        ("run pc2.toml", "64 MiB"),
        ("detect zero.obj --thickness 0", "64 MiB"),
    ] {
        let refused = place.muslin(words).expect(2);
        assert!(refused.stderr.contains(&format!("it is larger than {size}")), "{words}: {refused:?}");
    }
    assert!(!place.path("out").exists());
}

#[test]
fn files_that_are_too_large_are_not_read() {
    let place = Place::new();
    for (name, size) in [("large.toml", (1 << 20) + 1), ("large.obj", (4 << 30) + 1)] {
        File::create(place.path(name)).unwrap().set_len(size).unwrap();
    }
    for (words, size) in [("run large.toml", "1 MiB"), ("detect large.obj --thickness 0", "4096 MiB")] {
        let refused = place.muslin(words).expect(2);
        assert!(refused.stderr.contains(&format!("it is larger than {size}")), "{words}: {refused:?}");
    }
}

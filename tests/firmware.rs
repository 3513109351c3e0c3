//! The firmwares of `core/examples/cortex-m` in QEMU: a Cortex-M7 reaches the states of this machine, bit for bit, without a
//! heap, also where it drives the cloth. And the proof that no call of the core panics: a program that links only without a
//! panic handler.
//!
//! Run: `cargo test -p muslin-tests --test firmware -- --ignored --nocapture`. It needs `qemu-system-arm`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A command of cargo in the folder of the firmware. It has a target folder of its own.
fn cargo(words: &[&str], variables: &[(&str, &str)]) -> Output {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(words).current_dir(root().join("core/examples/cortex-m"));
    // The settings of the build that runs this test are for another processor.
    for name in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_TARGET"] {
        cargo.env_remove(name);
    }
    cargo.envs(variables.iter().copied());
    cargo.env("CARGO_TARGET_DIR", root().join("target/firmware")).output().expect("cargo starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
#[ignore = "slow: builds the firmware"]
fn a_microcontroller_reaches_the_same_states() {
    let has_qemu = Command::new("qemu-system-arm").arg("--version").output().is_ok_and(|it| it.status.success());
    if !has_qemu {
        assert!(std::env::var_os("MUSLIN_REQUIRE_QEMU").is_none(), "qemu-system-arm is missing: install QEMU for Arm");
        println!("skipped: qemu-system-arm is missing");
        return;
    }
    let formatted = cargo(&["fmt", "--check"], &[]);
    assert!(formatted.status.success(), "run cargo fmt in core/examples/cortex-m:\n{}", text(&formatted.stdout));
    let told = run("cortex-m", &[]);
    let golden =
        include_str!("goldens.txt").lines().find(|line| line.starts_with("cortex-m f32")).expect("a golden line");
    let last = golden.split(' ').next_back().expect("hashes");
    assert!(told.contains(&format!("{} steps, hash {last}", golden.split(' ').count() - 3)), "{told}{golden}");
    assert!(number(&told, "code") < 384 << 10, "{told}");
    assert!(number(&told, "stack") < 20 << 10, "{told}");
    assert!(number(&told, "memory") < 256 << 10, "{told}");
    // It drives the cloth by live calls.
    let told = run("drive", &[]);
    assert!(number(&told, "over the budget:") > 0, "the budget is never reached: {told}");
    // As little RAM as possible. It comes last: another scene builds all firmware anew.
    let told = run("cortex-m", &[("SCENE", "explicit.toml"), ("LEAN", "1"), ("STEPS", "400")]);
    assert!(number(&told, "stack") < 12_000 && number(&told, "memory") < 64_000, "{told}");
}

/// The output of a firmware, which must have reached the states of this machine.
fn run(name: &str, variables: &[(&str, &str)]) -> String {
    let ended = cargo(&["run", "--release", "--quiet", "--locked", "--bin", name], variables);
    let told = text(&ended.stdout);
    println!("{told}");
    assert!(ended.status.success(), "{told}{}", text(&ended.stderr));
    assert!(told.contains("as on the machine that cooked them"), "{told}");
    told
}

/// The number after some words.
fn number(told: &str, after: &str) -> usize {
    let rest = told.split(after).nth(1).unwrap_or_default();
    rest.split_whitespace().next().unwrap_or_default().parse().unwrap_or_else(|_| panic!("no {after:?} in {told}"))
}

#[test]
#[ignore = "slow: builds the core for another processor"]
fn no_call_of_the_core_panics() {
    let built = cargo(&["build", "--release", "--quiet", "--locked", "--bin", "no-panic"], &[]);
    if built.status.success() {
        return;
    }
    let reached = callers_of_panics();
    assert!(!reached.is_empty(), "the program that proves it cannot be built:\n{}", text(&built.stderr));
    panic!("these functions can panic; use the calls of core/src/column.rs in them: {reached:#?}");
}

/// The functions of the program `no-panic` that call one that panics.
fn callers_of_panics() -> BTreeSet<String> {
    cargo(&["rustc", "--release", "--quiet", "--locked", "--bin", "no-panic", "--", "--emit=asm"], &[]);
    let folder = root().join("target/firmware/thumbv7em-none-eabihf/release/deps");
    let files = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let listings = files.filter(|file| file.extension().is_some_and(|it| it == "s"));
    let newest = listings.max_by_key(|file| fs::metadata(file).and_then(|file| file.modified()).ok());
    let (mut callers, mut function) = (BTreeSet::new(), String::new());
    for line in newest.map(|file| fs::read_to_string(file).unwrap_or_default()).unwrap_or_default().lines() {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            [label] if label.ends_with(':') && !label.starts_with('.') => function = label.into(),
            [branch, to] if branch.starts_with('b') && (to.contains("panic") || to.contains("_fail")) => {
                callers.insert(function.clone());
            }
            _ => {}
        }
    }
    callers
}

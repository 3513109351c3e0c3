//! The firmware of `core/examples/cortex-m` in QEMU: a Cortex-M7 reaches the states of this machine, bit for bit, without a
//! heap. And the proof that no call of the core panics: a program that links only without a panic handler.
//!
//! Run: `cargo test -p muslin-tests --test firmware -- --ignored --nocapture`. It needs `qemu-system-arm`.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A command of cargo in the folder of the firmware. It has a target folder of its own.
fn cargo(words: &[&str]) -> Output {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(words).current_dir(root().join("core/examples/cortex-m"));
    // The settings of the build that runs this test are for another processor.
    for name in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_TARGET"] {
        cargo.env_remove(name);
    }
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
    let formatted = cargo(&["fmt", "--check"]);
    assert!(formatted.status.success(), "run cargo fmt in core/examples/cortex-m:\n{}", text(&formatted.stdout));
    let run = cargo(&["run", "--release", "--quiet", "--locked", "--bin", "cortex-m"]);
    let told = text(&run.stdout);
    println!("{told}");
    assert!(run.status.success(), "{told}{}", text(&run.stderr));
    assert!(told.contains("40 steps") && told.contains("as on the machine that cooked them"), "{told}");
    let number = |after: &str| -> usize {
        let rest = told.split(after).nth(1).unwrap_or_default();
        rest.split_whitespace().next().unwrap_or_default().parse().unwrap_or_else(|_| panic!("no {after:?} in {told}"))
    };
    assert!(number("stack ") < 32 << 10, "{told}");
    assert!(number("memory ") < 256 << 10, "{told}");
}

#[test]
#[ignore = "slow: builds the core for another processor"]
fn no_call_of_the_core_panics() {
    let built = cargo(&["build", "--release", "--quiet", "--locked", "--bin", "no-panic"]);
    let told = text(&built.stderr);
    let mut reached: Vec<_> = told.lines().filter(|line| line.contains("referenced by")).collect();
    reached.dedup();
    assert!(
        built.status.success(),
        "a panic can be reached: {reached:#?}\nUse the calls of core/src/column.rs there; cargo build --release --bin no-panic in \
         core/examples/cortex-m repeats this.\n{told}"
    );
}

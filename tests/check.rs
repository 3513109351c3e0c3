//! All checks, in the order in which they fail fastest: `cargo run -p muslin-tests --bin check`.
//! CI runs the same.
#![forbid(unsafe_code)]

use std::env;
use std::process::{Command, ExitCode};
use std::time::Instant;

/// Where the core must build without an operating system.
const BARE_TARGETS: [&str; 2] = ["thumbv7em-none-eabihf", "wasm32-unknown-unknown"];

/// The core in both precisions.
const CORES: [&str; 2] = ["muslin-core", "muslin-core-f64"];

/// What users build, which must also build without what the others' features bring.
const PACKAGES: [&str; 3] = ["muslin-core", "muslin-core-f64", "muslin-cli"];

/// Where a browser must be tested; without it only where there is what that needs.
const REQUIRE_BROWSER: &str = "MUSLIN_REQUIRE_BROWSER";

/// One command and the variables that it runs with.
struct Check {
    program: &'static str,
    arguments: Vec<String>,
    variables: &'static [(&'static str, &'static str)],
}

fn check(program: &'static str, arguments: &str) -> Check {
    Check { program, arguments: arguments.split_whitespace().map(String::from).collect(), variables: &[] }
}

fn cargo(arguments: &str) -> Check {
    check("cargo", arguments)
}

fn checks() -> Vec<Check> {
    let docs = Check { variables: &[("RUSTDOCFLAGS", "-D warnings")], ..cargo("doc --workspace --no-deps") };
    let mut checks = vec![cargo("fmt --all --check"), cargo("clippy --workspace --all-targets -- -D warnings"), docs];
    checks.extend(PACKAGES.iter().map(|package| cargo(&format!("check --package {package}"))));
    for core in CORES {
        for target in BARE_TARGETS {
            for features in ["", " --features alloc"] {
                checks
                    .push(cargo(&format!("check --package {core} --no-default-features{features} --target {target}")));
            }
        }
    }
    checks.push(cargo("test --workspace --profile checked"));
    if env::var_os(REQUIRE_BROWSER).is_some() || is_there("npm") {
        checks.push(cargo("run --package muslin-pack"));
        let mut browser = check("node", "--test --test-concurrency=1");
        browser.arguments.extend(browser_tests());
        checks.push(browser);
    } else {
        println!("npm is not there (https://nodejs.org): the page and the npm package are not tested");
    }
    checks
}

/// Files, because versions of Node.js differ in what they make of a folder.
fn browser_tests() -> Vec<String> {
    let files = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/browser")).into_iter().flatten().flatten();
    let names = files.map(|file| file.path().display().to_string()).filter(|name| name.ends_with(".test.mjs"));
    let mut names: Vec<_> = names.collect();
    names.sort_unstable();
    assert!(!names.is_empty(), "no tests in tests/browser");
    names
}

fn is_there(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

fn main() -> ExitCode {
    if !install_targets() {
        return ExitCode::FAILURE;
    }
    for check in checks() {
        let command = format!("{} {}", check.program, check.arguments.join(" "));
        let variables: Vec<_> = check.variables.iter().map(|(name, value)| format!("{name}=\"{value}\" ")).collect();
        println!("==> {}{command}", variables.concat());
        let started = Instant::now();
        let program = if check.program == "cargo" { env!("CARGO") } else { check.program };
        let status = Command::new(program).args(&check.arguments).envs(check.variables.iter().copied()).status();
        match status {
            Ok(status) if status.success() => println!("    passed in {:.0} s", started.elapsed().as_secs_f64()),
            Ok(_) => {
                println!("\nfailed: repeat it with\n    {}{command}", variables.concat());
                return ExitCode::FAILURE;
            }
            Err(error) => {
                println!("\ncannot start {program}: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    println!("\nall checks passed");
    ExitCode::SUCCESS
}

/// Adds the targets that the bare builds need, where rustup has not got them yet.
fn install_targets() -> bool {
    let added = Command::new("rustup").args(["target", "add"]).args(BARE_TARGETS).status();
    let ready = added.is_ok_and(|status| status.success());
    if !ready {
        println!("cannot add the targets {BARE_TARGETS:?}: install Rust by rustup (https://rustup.rs) and try again");
    }
    ready
}

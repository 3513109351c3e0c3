//! What is checked, in the order in which mistakes are found soonest: one row a step.

use std::fmt;

use crate::suites::Suite;

/// How much is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// After every change: minutes.
    Everyday,
    /// Before a change is published: what is slow too.
    All,
}

/// One step.
#[derive(Clone, Debug)]
pub struct Step {
    /// By which `--only` finds it.
    pub name: String,
    /// The lowest level that takes it.
    pub level: Level,
    /// What is run.
    pub task: Task,
}

/// What a step runs.
#[derive(Clone, Debug)]
pub enum Task {
    /// A command line that is to exit with 0, and the variables that it is given.
    Command(String, &'static [(&'static str, &'static str)]),
    /// Suites of tests in a profile of cargo.
    Suites(&'static str, Vec<Suite>),
}

/// The profile of cargo that all suites share.
pub const TESTED: &str = "dev";

/// Further profiles, in which the bits must be the same.
const PROFILES: [&str; 2] = ["unoptimised", "release"];

/// The suite that pins them.
const BITS: &str = "determinism";

/// Linted every day; the other packages are for browsers alone, and need much more to be built.
const LINTED: &str = "-p muslin-core -p muslin-core-f64 -p muslin-gpu -p muslin-cli -p muslin-tests \
                      -p muslin-tests-harness -p muslin-tests-gpu";

/// The core in both precisions.
const CORES: [&str; 2] = ["muslin-core", "muslin-core-f64"];

/// Where the core must build without an operating system.
pub const BARE_TARGETS: [&str; 2] = ["thumbv7em-none-eabihf", "wasm32-unknown-unknown"];

/// What is made of the core for a bare target.
const FEATURES: [&str; 2] = ["", " --features alloc"];

fn command(level: Level, name: &str, line: &str) -> Step {
    Step { name: name.to_owned(), level, task: Task::Command(line.to_owned(), &[]) }
}

/// Every step of both levels.
pub fn steps(suites: &[Suite]) -> Vec<Step> {
    use Level::{All, Everyday};
    let in_profile =
        |name: &str, level, profile, suites| Step { name: name.to_owned(), level, task: Task::Suites(profile, suites) };
    let mut steps = vec![
        command(Everyday, "format", "cargo fmt --all --check"),
        command(Everyday, "lints", &format!("cargo clippy {LINTED} --all-targets -- -D warnings")),
        in_profile("tests", Everyday, TESTED, suites.to_vec()),
        // With the other packages, so that libraries are those that the suites have built.
        command(Everyday, "manual", "cargo test --doc -p muslin-tests-harness -p muslin-tests -p muslin-cli"),
        command(All, "lints of every package", "cargo clippy --workspace --all-targets -- -D warnings"),
    ];
    let docs = Task::Command("cargo doc --workspace --no-deps".to_owned(), &[("RUSTDOCFLAGS", "-D warnings")]);
    steps.push(Step { name: "docs".to_owned(), level: All, task: docs });
    // Alone, a package has only the features that itself asks for.
    for package in CORES.iter().chain(&["muslin-cli"]) {
        steps.push(command(All, &format!("{package} alone"), &format!("cargo check -p {package}")));
    }
    for (core, target) in CORES.iter().flat_map(|core| BARE_TARGETS.map(|target| (core, target))) {
        for features in FEATURES {
            let name = format!("{core} for {target}{}", features.replace("--features", "with"));
            let line = format!("cargo check -p {core} --no-default-features{features} --target {target}");
            steps.push(command(All, &name, &line));
        }
    }
    for profile in PROFILES {
        let bits = suites.iter().filter(|suite| suite.name == BITS).cloned().collect();
        steps.push(in_profile(&format!("{BITS}, {profile}"), All, profile, bits));
    }
    steps.push(command(All, "package", "cargo run -p muslin-pack"));
    steps.push(command(All, "browser", &format!("node --test --test-concurrency=1{}", browser_tests())));
    steps
}

impl Step {
    /// Whether it builds for other targets than this machine.
    pub fn needs_targets(&self) -> bool {
        matches!(&self.task, Task::Command(line, _) if line.contains("--target") || line.contains("muslin-pack"))
    }

    /// The part of it that a level takes.
    pub fn at(self, level: Level) -> Option<Self> {
        let task = match self.task {
            Task::Suites(profile, suites) => {
                Task::Suites(profile, suites.into_iter().filter(|suite| suite.level <= level).collect())
            }
            command => command,
        };
        (self.level <= level).then_some(Self { task, ..self })
    }

    /// The part of it that has the word in its name: all of it, or some suites.
    pub fn part(self, word: &str) -> Option<Self> {
        if self.name.contains(word) {
            return Some(self);
        }
        let Task::Suites(profile, suites) = self.task else { return None };
        let suites: Vec<_> = suites.into_iter().filter(|suite| suite.name.contains(word)).collect();
        (!suites.is_empty()).then_some(Self { task: Task::Suites(profile, suites), ..self })
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mark = |level| if level == Level::All { '+' } else { ' ' };
        writeln!(f, "{} {}", mark(self.level), self.name)?;
        match &self.task {
            Task::Command(..) => Ok(()),
            Task::Suites(_, suites) => {
                suites.iter().try_for_each(|suite| writeln!(f, "{}     {}", mark(suite.level), suite.name))
            }
        }
    }
}

/// Files, because versions of Node.js differ in what they make of a folder.
fn browser_tests() -> String {
    let files = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/browser")).into_iter().flatten().flatten();
    let names = files.filter_map(|file| file.file_name().into_string().ok());
    let mut names: Vec<_> = names.filter(|name| name.ends_with(".test.mjs")).collect();
    names.sort_unstable();
    assert!(!names.is_empty(), "no tests in tests/browser");
    names.iter().map(|name| format!(" tests/browser/{name}")).collect()
}

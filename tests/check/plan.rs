//! The steps of the checks, in the order that finds mistakes soonest: one row per step.

use std::fmt;
use std::ops::RangeInclusive;

use crate::suites::{Suite, packages};

/// The level of checking.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// After every change: minutes.
    Everyday,
    /// Before a change is published: includes slow checks.
    All,
}

/// One step.
#[derive(Clone, Debug)]
pub struct Step {
    /// The name that `--only` matches.
    pub name: String,
    /// The levels that include it.
    pub levels: RangeInclusive<Level>,
    /// The task that it runs.
    pub task: Task,
}

/// The task of a step.
#[derive(Clone, Debug)]
pub enum Task {
    /// A command line that must exit with 0, and its environment variables.
    Command(String, &'static [(&'static str, &'static str)]),
    /// Suites of tests in a profile of cargo.
    Suites(&'static str, Vec<Suite>),
}

/// The profile of cargo that all suites share.
pub const TESTED: &str = "dev";

/// Further profiles, in which the bits must be the same.
const PROFILES: [&str; 3] = ["unoptimised", "size", "release"];

/// The suites whose results could differ between profiles: of bits, and of faults, which panic in some of them.
const PER_PROFILE: [&str; 2] = ["goldens", "faults"];

/// Packages linted every day; the other packages are for browsers only and take much longer to build.
const LINTED: &str = "-p muslin-core -p muslin-core-f64 -p muslin-gpu -p muslin-cli -p muslin-tests \
                      -p muslin-tests-harness -p muslin-tests-gpu";

/// The core in both precisions.
const CORES: [&str; 2] = ["muslin-core", "muslin-core-f64"];

/// Targets without an operating system, for which the core must build.
pub const BARE_TARGETS: [&str; 2] = ["thumbv7em-none-eabihf", "wasm32-unknown-unknown"];

/// Features with which the core is built for a bare target.
const FEATURES: [&str; 2] = ["", " --features alloc"];

/// A step of a level and those above.
fn step(level: Level, name: &str, task: Task) -> Step {
    Step { name: name.to_owned(), levels: level..=Level::All, task }
}

fn command(level: Level, name: &str, line: &str) -> Step {
    step(level, name, Task::Command(line.to_owned(), &[]))
}

/// Every step of both levels.
pub fn steps(suites: &[Suite]) -> Vec<Step> {
    use Level::{All, Everyday};
    let lints = |packages: &str| format!("cargo clippy {packages} --all-targets -- -D warnings");
    let everyday = command(Everyday, "lints", &lints(LINTED));
    // Code that may panic is refused only here.
    let without_alloc = format!("cargo clippy -p {} --no-default-features -- -D warnings", CORES.join(" -p "));
    let mut steps = vec![
        command(Everyday, "format", "cargo fmt --all --check"),
        Step { levels: Everyday..=Everyday, ..everyday },
        command(All, "lints of every package", &lints("--workspace")),
        command(Everyday, "lints without an allocator", &without_alloc),
        step(Everyday, "tests", Task::Suites(TESTED, suites.to_vec())),
    ];
    // With the packages of the suites, so that the libraries built for them are reused.
    let manual = |level| format!("cargo test --doc -p muslin-tests-harness{}", packages(level));
    steps.push(Step { levels: Everyday..=Everyday, ..command(Everyday, "manual", &manual(Everyday)) });
    steps.push(command(All, "manual", &manual(All)));
    let docs = Task::Command("cargo doc --workspace --no-deps".to_owned(), &[("RUSTDOCFLAGS", "-D warnings")]);
    steps.push(step(All, "docs", docs));
    // A package checked alone has only the features that it requests itself.
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
        let own = suites.iter().filter(|suite| PER_PROFILE.contains(&&*suite.name)).cloned().collect();
        steps.push(step(All, &format!("{}, {profile}", PER_PROFILE.join(", ")), Task::Suites(profile, own)));
    }
    // It installs the formatter of JavaScript, too, and checks the types of the package.
    steps.push(command(All, "package", "cargo run -p muslin-pack"));
    steps.push(command(All, "format and lints of JavaScript", "npm --prefix host-wasm run lint"));
    steps.push(command(All, "browser", &format!("node --test --test-concurrency=1{}", browser_tests())));
    steps
}

impl Step {
    /// Whether it builds for other targets than this machine.
    pub fn needs_targets(&self) -> bool {
        matches!(&self.task, Task::Command(line, _) if line.contains("--target") || line.contains("muslin-pack"))
    }

    /// The part of the step that belongs to a level.
    pub fn at(self, level: Level) -> Option<Self> {
        let task = match self.task {
            Task::Suites(profile, suites) => {
                Task::Suites(profile, suites.into_iter().filter(|suite| suite.level <= level).collect())
            }
            command => command,
        };
        self.levels.contains(&level).then_some(Self { task, ..self })
    }

    /// The part of the step with the word in its name: the whole step, or some of its suites.
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
        writeln!(f, "{} {}", mark(*self.levels.start()), self.name)?;
        match &self.task {
            Task::Command(..) => Ok(()),
            Task::Suites(_, suites) => {
                suites.iter().try_for_each(|suite| writeln!(f, "{}     {}", mark(suite.level), suite.name))
            }
        }
    }
}

/// Lists files, because versions of Node.js treat a folder differently.
fn browser_tests() -> String {
    let files = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/browser")).into_iter().flatten().flatten();
    let names = files.filter_map(|file| file.file_name().into_string().ok());
    let mut names: Vec<_> = names.filter(|name| name.ends_with(".test.mjs")).collect();
    names.sort_unstable();
    assert!(!names.is_empty(), "no tests in tests/browser");
    names.iter().map(|name| format!(" tests/browser/{name}")).collect()
}

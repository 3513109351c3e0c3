//! Runs steps: commands as a whole, suites test by test, with the time of each.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::Instant;

use serde_json::Value;

use crate::plan::{BARE_TARGETS, Level, Step, Task};
use crate::report::{Ending, Outcome, Report, Test, reasons};
use crate::suites::{self, Suite};

/// Variable that requires browser tests; without it they run only if their tools are installed.
const REQUIRE_BROWSER: &str = "MUSLIN_REQUIRE_BROWSER";

/// Arguments with which libtest reports the result and time of each test in JSON. They are unstable and need
/// `RUSTC_BOOTSTRAP` in the environment of the tests.
const TOLD: [&str; 5] = ["-Zunstable-options", "--format=json", "--report-time", "--show-output", "--color=never"];

/// Part of the name of a test that is run only by its own command, at no level.
const LONG_FORM: &str = "long_form";

/// Runs a step to its end, also after failures.
pub fn step(root: &Path, step: &Step, level: Level, report: &mut Report) {
    println!("==> {}", step.name);
    if let Some(why) = missing(step) {
        return report.skipped(&step.name, &why);
    }
    match &step.task {
        Task::Command(line, variables) => report.add(command(root, &step.name, line, variables)),
        Task::Suites(profile, suites) => {
            let started = Instant::now();
            let built = suites::build(root, profile, suites);
            let mut outcome = Outcome::new(format!("{}: build", step.name), started.elapsed());
            outcome.counts = false;
            match built {
                Ok(built) => {
                    report.add(outcome);
                    built.iter().for_each(|(suite, path)| report.add(run(suite, path, profile, level)));
                }
                Err(why) => report.add(outcome.failed(why)),
            }
        }
    }
}

fn command(root: &Path, name: &str, line: &str, variables: &[(&str, &str)]) -> Outcome {
    let mut words = line.split(' ');
    let program = words.next().unwrap_or_default();
    let started = Instant::now();
    let mut command = Command::new(if program == "cargo" { env!("CARGO") } else { program });
    command.args(words).envs(variables.iter().copied()).current_dir(root);
    let mut skipped = Vec::new();
    let status = if program == "node" { run_tap(&mut command, &mut skipped) } else { command.status() };
    let mut outcome = Outcome::new(name.to_owned(), started.elapsed());
    outcome.skipped = skipped;
    match status {
        Ok(status) if status.success() => outcome,
        Ok(_) => {
            let set: String = variables.iter().map(|(name, value)| format!("{name}=\"{value}\" ")).collect();
            outcome.failed(format!("repeat it with: {set}{line}"))
        }
        Err(error) => outcome.failed(format!("cannot start {program}: {error}")),
    }
}

/// Runs tests that report in TAP, and collects the reasons of skipped tests.
fn run_tap(command: &mut Command, skipped: &mut Vec<String>) -> std::io::Result<ExitStatus> {
    let mut child = command.stdout(Stdio::piped()).spawn()?;
    for line in BufReader::new(child.stdout.take().expect("it is piped")).lines().map_while(Result::ok) {
        println!("{line}");
        skipped.extend(line.split_once("# SKIP ").map(|(_, why)| why.to_owned()));
    }
    child.wait()
}

/// The reason why a step cannot be run here and may be skipped.
fn missing(step: &Step) -> Option<String> {
    let line = match &step.task {
        Task::Command(line, _) => line.as_str(),
        Task::Suites(..) => return None,
    };
    let of_browser = line.starts_with("node") || line.contains("muslin-pack");
    (of_browser && std::env::var_os(REQUIRE_BROWSER).is_none() && !is_there("npm"))
        .then(|| "npm is not there (https://nodejs.org): the page and the npm package are not tested".to_owned())
}

fn is_there(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Installs targets and components that some steps of the full level need, if rustup does not have them yet.
pub fn install(root: &Path, report: &mut Report) {
    let rustup = |arguments: &[&str]| Command::new("rustup").args(arguments).current_dir(root).status();
    let added = |arguments: &[&str]| rustup(arguments).is_ok_and(|done| done.success());
    let targets: Vec<_> = ["target", "add"].into_iter().chain(BARE_TARGETS).collect();
    if !(added(&targets) && added(&["component", "add", "rust-src"])) {
        let why = "install Rust by rustup (https://rustup.rs) and try again";
        report.add(Outcome::new("targets".to_owned(), std::time::Duration::ZERO).failed(why.to_owned()));
    }
}

/// Runs a suite; at the full level including the tests marked as slow.
fn run(suite: &Suite, path: &Path, profile: &str, level: Level) -> Outcome {
    print!("    {:<24}", suite.name);
    let _ = std::io::stdout().flush();
    let started = Instant::now();
    let mut command = Command::new(path);
    command.args(TOLD).args(["--skip", LONG_FORM]).args((level == Level::All).then_some("--include-ignored"));
    command.env("RUSTC_BOOTSTRAP", "1").current_dir(suite.folder()).stdout(Stdio::piped());
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // Mesa prints warnings without it.
        command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
    }
    let (mut tests, mut finished) = (Vec::new(), false);
    let ended = command.spawn().and_then(|mut child| {
        let lines = BufReader::new(child.stdout.take().expect("it is piped")).lines().map_while(Result::ok);
        for event in lines.filter_map(|line| serde_json::from_str::<Value>(&line).ok()) {
            finished |= event["type"] == "suite" && event["event"] != "started";
            tests.extend(test(&event));
        }
        child.wait()
    });
    let mut outcome = Outcome::new(suite.name.clone(), started.elapsed());
    for test in tests.iter().filter(|test| test.ending == Ending::Failed) {
        println!("\n---- {}: {}\n{}", suite.name, test.name, test.output);
        outcome = outcome.failed(format!("{}: repeat it with: {}", test.name, suite.repeat(&test.name, profile)));
    }
    match ended {
        Ok(_) if finished => {}
        Ok(status) => outcome = outcome.failed(format!("it ended by {status} before all its tests had run")),
        Err(error) => outcome = outcome.failed(format!("cannot start {}: {error}", path.display())),
    }
    outcome.tests = tests;
    println!("{outcome}");
    outcome
}

/// The test that ended, if this event of libtest reports one.
fn test(event: &Value) -> Option<Test> {
    let text = |key: &str| event[key].as_str().unwrap_or_default().to_owned();
    let output = text("stdout") + &text("message");
    let ending = match event["event"].as_str().filter(|_| event["type"] == "test")? {
        "ok" if reasons(&output).next().is_some() => Ending::Skipped,
        "ok" => Ending::Passed,
        "failed" => Ending::Failed,
        "ignored" => Ending::LeftOut,
        _ => return None,
    };
    Some(Test { name: text("name"), seconds: event["exec_time"].as_f64().unwrap_or(0.0), ending, output })
}

//! Runs all checks, those that fail fastest first: `cargo run -p muslin-tests --bin check [-- --all]`. All
//! steps run even if earlier ones fail; failures are listed at the end. CI runs the same checks.
#![forbid(unsafe_code)]

mod plan;
mod report;
mod run;
mod suites;

use std::path::Path;
use std::process::ExitCode;

use lexopt::prelude::{Long, Short, ValueExt};
use plan::{Level, Step};
use report::Report;

const HELP: &str = "\
All checks of Muslin.

Usage: cargo run -p muslin-tests --bin check [-- OPTIONS]

  --all        add the slow tests: torture, every scene, the GPU, the browser, other targets and profiles
  --only WORD  run only the steps and suites with WORD in their name
  --list       list all steps and suites; + marks those that --all adds
  --help       print this help

Examples:
  cargo run -p muslin-tests --bin check                          after a change: five minutes
  cargo run -p muslin-tests --bin check -- --all                 before a release: all tests
  cargo run -p muslin-tests --bin check -- --only forces         one suite; builds only its needs
  cargo run -p muslin-tests --bin check -- --all --only torture  one suite with its slow tests

One test: cargo test -p muslin-tests --test forces NAME
";

struct Arguments {
    level: Level,
    only: Option<String>,
    list: bool,
    help: bool,
}

fn arguments() -> Result<Arguments, lexopt::Error> {
    let mut arguments = Arguments { level: Level::Everyday, only: None, list: false, help: false };
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("all") => arguments.level = Level::All,
            Long("only") => arguments.only = Some(parser.value()?.string()?),
            Long("list") => arguments.list = true,
            Long("help") | Short('h') => arguments.help = true,
            _ => return Err(argument.unexpected()),
        }
    }
    Ok(arguments)
}

fn main() -> ExitCode {
    let arguments = match arguments() {
        Ok(arguments) => arguments,
        Err(error) => {
            eprintln!("{error}: see --help");
            return ExitCode::from(2);
        }
    };
    if arguments.help {
        print!("{HELP}");
        return ExitCode::SUCCESS;
    }
    match check(&arguments) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

/// Runs the requested steps; returns whether all passed.
fn check(arguments: &Arguments) -> Result<bool, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut steps = plan::steps(&suites::all(&root)?);
    if arguments.list {
        steps.iter().for_each(|step| print!("{step}"));
        return Ok(true);
    }
    steps = steps.into_iter().filter_map(|step| step.at(arguments.level)).collect();
    if let Some(word) = &arguments.only {
        steps = steps.into_iter().filter_map(|step| step.part(word)).collect();
        if steps.is_empty() {
            return Err(format!("no step or suite of this level has {word:?} in its name: see --list"));
        }
    }
    let mut report = Report::new();
    if steps.iter().any(Step::needs_targets) {
        run::install(&root, &mut report);
    }
    steps.iter().for_each(|step| run::step(&root, step, arguments.level, &mut report));
    print!("{report}");
    Ok(report.passed())
}

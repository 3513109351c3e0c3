//! The command-line host `muslin` as a library: [`main`] is the program. The host owns threads, files and clocks; the core
//! owns the physics.
#![forbid(unsafe_code)]

mod args;
mod bench;
mod checkpoint;
mod cook;
mod detect;
mod device;
mod devices;
mod disk;
mod divergence;
mod engine;
mod export;
mod failure;
mod folder;
mod interrupt;
mod limits;
mod mesh_io;
mod pool;
mod preview;
mod progress;
pub mod readers;
mod record;
mod run;
mod scene_file;
mod scenes;
mod stopwatch;
mod study;
mod summary;
mod units;
mod warning;

use std::process::ExitCode;

use args::{Arguments, Command};
use clap::Parser;
use failure::Failure;

/// Obeys the command line of the process.
pub fn main() -> ExitCode {
    let outcome = match Arguments::try_parse() {
        Ok(arguments) => obey(arguments.command),
        Err(error) => return explain(&error),
    };
    outcome.map_or_else(|failure| reported(&failure), |()| ExitCode::SUCCESS)
}

fn obey(command: Command) -> Result<(), Failure> {
    match command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Detect(arguments) => detect::detect(&arguments),
        Command::Chart(arguments) => study::chart(&arguments),
        Command::Stability(arguments) => study::stability(&arguments),
        Command::Choose(arguments) => study::choose(&arguments),
        Command::Needs(arguments) => study::needs(&arguments),
        Command::Sweep(arguments) => study::sweep(&arguments),
        Command::Validate(arguments) => study::validate(&arguments),
        Command::Cook(arguments) => cook::cook(&arguments),
        Command::Scenes(arguments) => scenes::print(&arguments),
        Command::Devices(arguments) => devices::print(&arguments),
        Command::Bench(arguments) => bench::bench(&arguments),
    }
}

/// Prints help or the version to stdout; prints an error in the arguments to stderr.
fn explain(error: &clap::Error) -> ExitCode {
    match error.print() {
        Err(unprinted) if !error.use_stderr() => reported(&failure::unprinted(&unprinted)),
        _ => ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)),
    }
}

fn reported(failure: &Failure) -> ExitCode {
    failure.report();
    failure.exit_code()
}

//! `muslin`: the command-line host. It owns threads, files and clocks; the core owns the physics.
#![forbid(unsafe_code)]

mod args;
mod bench;
mod checkpoint;
mod detect;
mod device;
mod devices;
mod engine;
mod export;
mod failure;
mod interrupt;
mod limits;
mod mesh_io;
mod pool;
mod preview;
mod progress;
mod record;
mod run;
mod scene_file;
mod scenes;
mod stopwatch;
mod study;
mod summary;
mod units;

use std::process::ExitCode;

use args::{Arguments, Command};
use clap::Parser;

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Detect(arguments) => detect::detect(&arguments),
        Command::Chart(arguments) => study::chart(&arguments),
        Command::Stability(arguments) => study::stability(&arguments),
        Command::Choose(arguments) => study::choose(&arguments),
        Command::Needs(arguments) => study::needs(&arguments),
        Command::Sweep(arguments) => study::sweep(&arguments),
        Command::Validate(arguments) => study::validate(&arguments),
        Command::Scenes(arguments) => scenes::print(&arguments),
        Command::Devices(arguments) => devices::print(&arguments),
        Command::Bench(arguments) => bench::bench(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.report();
            failure.exit_code()
        }
    }
}

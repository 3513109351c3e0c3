//! `muslin scenes`, `devices` and `bench`.

use clap::Args;

use super::help;
use super::values::threads;

/// `muslin scenes`.
#[derive(Debug, Args)]
#[command(after_help = help(include_str!("help/scenes.txt")))]
pub struct ScenesArguments {
    /// Print this scene's file
    pub name: Option<String>,
    /// Print the list as one JSON document
    #[arg(long)]
    pub json: bool,
}

/// `muslin devices`.
#[derive(Debug, Args)]
#[command(after_help = help(include_str!("help/devices.txt")))]
pub struct DevicesArguments {
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
}

/// `muslin bench`.
#[derive(Debug, Args)]
#[command(after_help = help(include_str!("help/bench.txt")))]
pub struct BenchArguments {
    /// Scene files, names of built-in scenes, or crumpled [default: the standard set]
    pub scenes: Vec<String>,
    /// Threads
    #[arg(long, value_name = "N", default_value = "1", value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
}

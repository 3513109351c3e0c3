//! `muslin cook`, `scenes`, `devices` and `bench`.

use std::path::PathBuf;

use clap::Args;

use super::help;
use super::values::{Precision, margin, seconds, threads};

/// `muslin cook`.
#[derive(Debug, Args)]
#[command(after_help = help(include_str!("help/cook.txt")))]
pub struct CookArguments {
    /// A scene file, or the name of a built-in scene
    pub scene: String,
    /// The file to write [default: SCENE.bin]
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Override a key of the scene, such as integrator.step=0.001
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Simulated seconds of the run that measures the room [default: the duration of the scene]
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    pub duration: Option<f64>,
    /// Precision in which the program computes
    #[arg(long, value_enum, default_value = "f32")]
    pub precision: Precision,
    /// Vertices that the program can hold at the same time
    #[arg(long, value_name = "N", default_value = "4")]
    pub hands: u32,
    /// Vertices on which the program can set forces at the same time
    #[arg(long, value_name = "N", default_value = "0")]
    pub forces: u32,
    /// Let the program deform colliders that are meshes
    #[arg(long)]
    pub deform: bool,
    /// Save memory: no cells for detection, no forces of elements are kept. With self-contact, steps take more time
    #[arg(long)]
    pub lean: bool,
    /// Measure the impulses that the cloth gives to colliders; each step costs one or two evaluations of the forces more
    #[arg(long)]
    pub impulses: bool,
    /// Give contacts X times the measured room, for scenes that the program drives
    #[arg(long, value_name = "X", default_value = "1", value_parser = margin)]
    pub margin: f64,
    /// Room for candidates of each kind [default: measured]
    #[arg(long, value_name = "N")]
    pub pairs: Option<usize>,
    /// Room for contacts [default: measured]
    #[arg(long, value_name = "N")]
    pub contacts: Option<usize>,
    /// Threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
    /// Show no progress
    #[arg(long)]
    pub quiet: bool,
}

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

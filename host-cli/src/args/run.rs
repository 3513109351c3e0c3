//! `muslin run`.

use std::path::PathBuf;

use clap::Args;

use super::help;
use super::values::{Backend, Precision, PreviewKind, seconds, series_name, threads};
use crate::export::Format;

/// A scene, its overrides and the output folder.
#[derive(Clone, Debug, Args)]
pub struct SceneArguments {
    /// A scene file, or the name of a built-in scene
    pub scene: String,
    /// Output folder [default: out/SCENE]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Override a key of the scene, such as integrator.step=0.001; cloth.KEY means every cloth,
    /// cloth.0.KEY the first
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Simulated seconds [default: the duration of the scene]
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    pub duration: Option<f64>,
}

/// `muslin run`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help(include_str!("help/run.txt")))]
pub struct RunArguments {
    /// The scene
    #[command(flatten)]
    pub of: SceneArguments,
    /// The hardware that computes
    #[arg(long, value_enum, default_value = "cpu")]
    pub backend: Backend,
    /// Precision of the computation
    #[arg(long, value_enum, default_value = "f32")]
    pub precision: Precision,
    /// Threads [default: one per core]; the result does not depend on it
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Formats of the exported frames, separated by commas, or none
    #[arg(long, value_enum, value_delimiter = ',', default_value = "pc2")]
    pub export: Vec<Format>,
    /// Write energies, works, momentum and reaction forces of every frame to this file in the output folder
    #[arg(long, value_name = "FILE.csv", value_parser = series_name)]
    pub series: Option<String>,
    /// The preview picture
    #[arg(long, value_enum, default_value = "gif")]
    pub preview: PreviewKind,
    /// Test every frame exactly for intersections
    #[arg(long)]
    pub audit: bool,
    /// Write a checkpoint every N steps
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), allow_negative_numbers = true)]
    pub checkpoint: Option<u64>,
    /// Continue from a checkpoint of the same scene
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
    /// Print the summary as one JSON document
    #[arg(long)]
    pub json: bool,
    /// Print only warnings and errors
    #[arg(long)]
    pub quiet: bool,
}

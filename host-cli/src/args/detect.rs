//! `muslin detect`.

use std::path::PathBuf;

use clap::Args;

use super::help;
use super::values::{Backend, DetectStage, Method, thickness, threads};

/// `muslin detect`.
#[derive(Debug, Args)]
#[command(after_help = help(include_str!("help/detect.txt")))]
pub struct DetectArguments {
    /// An OBJ or PLY file
    pub mesh: PathBuf,
    /// The same mesh some time later: the same triangles, other positions
    #[arg(long, value_name = "MESH")]
    pub next: Option<PathBuf>,
    /// Distance in metres below which a pair is a contact; 0 is allowed
    #[arg(long, value_name = "H", value_parser = thickness, allow_negative_numbers = true)]
    pub thickness: f32,
    /// The method that finds candidates; all methods find the same
    #[arg(long, value_enum, default_value = "grid")]
    pub method: Method,
    /// The hardware that computes
    #[arg(long, value_enum, default_value = "cpu")]
    pub backend: Backend,
    /// Stop after this stage; the stages before it run too
    #[arg(long, value_enum, default_value = "contacts")]
    pub stage: DetectStage,
    /// Threads [default: one per core]; the result does not depend on it
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
}

//! The studies: `muslin needs`, `choose`, `chart`, `stability`, `sweep` and `validate`.

use std::path::PathBuf;

use clap::Args;
use muslin_core::integrate;

use super::help;
use super::run::SceneArguments;
use super::values::{Cost, Shard, method, seconds, shard, step, threads, tolerance};

/// The arguments of every study.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// The scene
    #[command(flatten)]
    pub of: SceneArguments,
    /// How cost and budget are measured: clock time or counts of work
    #[arg(long, value_enum, default_value = "clock")]
    pub cost: Cost,
    /// Seconds that the study may take, approximately
    #[arg(long, value_name = "S", default_value = "600", value_parser = seconds, allow_negative_numbers = true)]
    pub budget: f64,
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
    /// Print only errors
    #[arg(long)]
    pub quiet: bool,
}

/// `muslin chart`.
#[derive(Debug, Args)]
#[command(after_help = help(include_str!("help/chart.txt")))]
pub struct ChartArguments {
    /// The scene and the limits
    #[command(flatten)]
    pub study: StudyArguments,
    /// Methods, separated by commas [default: all]
    #[arg(long, value_delimiter = ',', value_parser = method)]
    pub methods: Vec<integrate::Method>,
    /// Try no shorter step than this, even if budget is left
    #[arg(long, value_name = "S", value_parser = step, allow_negative_numbers = true)]
    pub finest: Option<f64>,
}

/// `muslin stability`.
#[derive(Debug, Args)]
#[command(after_help = help(include_str!("help/stability.txt")))]
pub struct StabilityArguments {
    /// The scene and the limits
    #[command(flatten)]
    pub study: StudyArguments,
    /// Methods, separated by commas [default: all]
    #[arg(long, value_delimiter = ',', value_parser = method)]
    pub methods: Vec<integrate::Method>,
}

/// `muslin needs`.
#[derive(Debug, Args)]
#[command(after_help = help(include_str!("help/needs.txt")))]
pub struct NeedsArguments {
    /// The scene and the limits
    #[command(flatten)]
    pub study: StudyArguments,
}

/// `muslin choose`.
#[derive(Debug, Args)]
#[command(after_help = help(include_str!("help/choose.txt")))]
pub struct ChooseArguments {
    /// The scene and the limits
    #[command(flatten)]
    pub study: StudyArguments,
    /// The largest allowed RMS error, in metres or with a unit, such as 1mm
    #[arg(long, value_name = "T", value_parser = tolerance, allow_negative_numbers = true)]
    pub tolerance: f64,
    /// Write the chosen scene to this file
    #[arg(long, value_name = "FILE")]
    pub write: Option<PathBuf>,
}

/// `muslin sweep`.
#[derive(Clone, Debug, Args)]
#[command(after_help = help(include_str!("help/sweep.txt")))]
pub struct SweepArguments {
    /// The file of the sweep
    pub sweep: PathBuf,
    /// Only every N-th run, from the I-th on
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Output file [default: out/SWEEP.jsonl, or out/SWEEP.I-of-N.jsonl]
    #[arg(long, value_name = "FILE.jsonl")]
    pub out: Option<PathBuf>,
    /// Threads per run; results do not depend on it
    #[arg(long, value_name = "N", default_value = "1", value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// Print only errors
    #[arg(long)]
    pub quiet: bool,
}

/// `muslin validate`.
#[derive(Debug, Args)]
#[command(after_help = help(include_str!("help/validate.txt")))]
pub struct ValidateArguments {
    /// Run only this group, or only the checks whose group and name, joined by a space, contain these whole words in
    /// this order
    #[arg(long, value_name = "NAME")]
    pub only: Option<String>,
    /// List the checks without running them
    #[arg(long)]
    pub list: bool,
    /// Output folder
    #[arg(long, value_name = "DIR", default_value = "out/validate")]
    pub out: PathBuf,
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
    /// Print only errors
    #[arg(long)]
    pub quiet: bool,
}

//! The values that options take, and how their text is read.

use std::path::Path;

use clap::ValueEnum;
use muslin_core::integrate;
use serde::Deserialize;

use crate::units;

/// Largest number of threads; a larger one is a typing error.
const MOST_THREADS: usize = 1024;

/// A number of threads.
pub fn threads(text: &str) -> Result<usize, String> {
    let threads = text.parse().ok().filter(|threads| (1..=MOST_THREADS).contains(threads));
    threads.ok_or_else(|| format!("must be a whole number from 1 to {MOST_THREADS}"))
}

/// A time above zero, s.
pub fn step(text: &str) -> Result<f64, String> {
    let step = text.parse().ok().filter(|&step: &f64| step > 0.0 && step.is_finite());
    step.ok_or_else(|| "must be a time in seconds, above zero".into())
}

/// A time, s.
pub fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|&seconds: &f64| seconds >= 0.0 && seconds.is_finite());
    seconds.ok_or_else(|| "must be a time in seconds, zero or more".into())
}

/// A factor that is at least 1.
pub fn margin(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok().filter(|factor: &f64| (1.0..=1e6).contains(factor));
    factor.ok_or_else(|| "must be a number from 1 to 1000000".into())
}

/// The name of a file of comma-separated values, without folders.
pub fn series_name(text: &str) -> Result<String, String> {
    let is_plain = Path::new(text).file_name().is_some_and(|name| name == text) && !text.contains('\\');
    let is_named = is_plain && text.len() > 4 && text.ends_with(".csv");
    let why = "must be a name that ends with .csv, without folders: the file is written to the output folder";
    is_named.then(|| text.into()).ok_or_else(|| why.into())
}

/// A length, m.
pub fn thickness(text: &str) -> Result<f32, String> {
    let metres = text.parse().ok().filter(|&metres: &f32| metres >= 0.0 && metres.is_finite());
    metres.ok_or_else(|| "must be a length in metres, zero or more".into())
}

/// A length above zero, m, with or without a unit.
pub fn tolerance(text: &str) -> Result<f64, String> {
    let metres = units::metres(text).filter(|&metres| metres > 0.0 && metres.is_finite());
    metres.ok_or_else(|| "must be a length above zero in metres, or with m, cm, mm, um or nm, such as 1mm".into())
}

/// The name of an integration method.
pub fn method(text: &str) -> Result<integrate::Method, String> {
    let names = || integrate::Method::ALL.map(integrate::Method::name).join(", ");
    let method = integrate::Method::ALL.into_iter().find(|method| method.name() == text);
    method.ok_or_else(|| format!("must be one of {}", names()))
}

/// A part of a sweep.
#[derive(Clone, Copy, Debug)]
pub struct Shard {
    /// Its number, from 1.
    pub number: usize,
    /// Number of shards.
    pub count: usize,
}

impl Shard {
    /// Whether the run with this index, from 0, belongs to the shard.
    pub const fn takes(self, index: usize) -> bool {
        index % self.count == self.number - 1
    }
}

/// A shard as `I/N`.
pub fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/').and_then(|(number, count)| Some((number.parse().ok()?, count.parse().ok()?)));
    let shard = parts.map(|(number, count)| Shard { number, count });
    let shard = shard.filter(|shard| (1..=shard.count).contains(&shard.number));
    shard.ok_or_else(|| "must be I/N, such as 1/8 to 8/8".into())
}

/// The hardware that computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// The processor.
    Cpu,
    /// A graphics processor finds the candidates, in single precision
    Gpu,
}

impl Backend {
    /// The name in summaries.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        }
    }
}

/// How to find candidates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// A uniform grid with control bits, as in runs.
    Grid,
    /// A simpler grid, written for tests: every box is stored in all cells that it touches.
    Reference,
    /// All pairs: slow.
    Brute,
}

/// The last stage of detection; it includes the stages before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub enum DetectStage {
    /// Pairs whose boxes overlap.
    Candidates,
    /// Pairs closer than the thickness.
    Contacts,
    /// Pairs that touch during the motion to the next mesh.
    Ccd,
    /// Edges that pass through triangles, found by an exact test.
    Intersections,
}

/// In which precision to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// Single precision, for runs.
    F32,
    /// Double precision, for references.
    F64,
}

impl Precision {
    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

/// The preview picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PreviewKind {
    /// preview.gif, an animation.
    Gif,
    /// preview.png, six moments.
    Png,
    /// No picture.
    None,
}

/// The measure of cost in a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Cost {
    /// Time on this machine
    Clock,
    /// Counts of work, converted to seconds on a machine with a memory bandwidth of 10 GB/s: the same results on every
    /// machine
    Counts,
}

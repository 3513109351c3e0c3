//! The command line.

use std::path::PathBuf;

use muslin_core::integrate;

use clap::{Args, Parser, Subcommand, ValueEnum};
use serde::Deserialize;

use crate::export::Format;
use crate::units;

/// A cloth simulator that says what each method costs and how wrong it is.
#[derive(Debug, Parser)]
#[command(
    name = "muslin",
    version,
    arg_required_else_help = true,
    after_help = "\
Examples:
  muslin run flag                       run a built-in scene, leave a picture in out/flag
  muslin scenes flag > my.toml          start a scene of your own
  muslin choose flag --tolerance 5mm    the cheapest way to run it within that
  muslin detect a.ply --thickness 0.002 what is near in a mesh, or meets on the way to the next
  muslin chart skirt --duration 0.5     which method is cheapest for which error
  muslin validate                       how far off it is where the answer is known
  muslin bench                          what each stage costs on this machine

Which study of a scene to run first:
  needs      which terms are worth modelling
  choose     the method and the step for an error that you can bear, or that there is none
  chart      the whole picture of error against cost, every method
  stability  how far the step is from where it fails
  validate   whether the models are right: no scene is needed
  sweep      many runs, over a grid of values"
)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulate a scene; write frames, a picture and a summary
    Run(RunArguments),
    /// Count what is near, meets or passes through itself in a mesh
    Detect(DetectArguments),
    /// Chart error against cost: every method, both precisions, on a scene
    Chart(ChartArguments),
    /// Map where each method fails: its step against the scene's stiffness and damping
    Stability(StabilityArguments),
    /// Measure what each modelled term of a scene changes and costs
    Needs(NeedsArguments),
    /// Run a scene over a grid of overrides: resumable, one JSON line a run
    Sweep(SweepArguments),
    /// Check the simulator against known answers: expected beside measured
    Validate(ValidateArguments),
    /// Choose the cheapest method, step and terms that meet a tolerance on a scene
    Choose(ChooseArguments),
    /// List the built-in scenes, or print one
    Scenes(ScenesArguments),
    /// List what there is to run on: the processor and graphics adapters
    Devices(DevicesArguments),
    /// Measure what each stage costs on this machine
    Bench(BenchArguments),
}

/// Most threads; more than this is a slip of the hand.
const MOST_THREADS: usize = 1024;

fn threads(text: &str) -> Result<usize, String> {
    let threads = text.parse().ok().filter(|threads| (1..=MOST_THREADS).contains(threads));
    threads.ok_or_else(|| format!("must be a whole number from 1 to {MOST_THREADS}"))
}

fn step(text: &str) -> Result<f64, String> {
    let step = text.parse().ok().filter(|&step: &f64| step > 0.0 && step.is_finite());
    step.ok_or_else(|| "must be a time in seconds, above zero".into())
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|&seconds: &f64| seconds >= 0.0 && seconds.is_finite());
    seconds.ok_or_else(|| "must be a time in seconds, zero or more".into())
}

fn thickness(text: &str) -> Result<f32, String> {
    let metres = text.parse().ok().filter(|&metres: &f32| metres >= 0.0 && metres.is_finite());
    metres.ok_or_else(|| "must be a length in metres, zero or more".into())
}

fn tolerance(text: &str) -> Result<f64, String> {
    let metres = units::metres(text).filter(|&metres| metres > 0.0 && metres.is_finite());
    metres.ok_or_else(|| "must be a length above zero in metres, or with m, cm, mm, um or nm, such as 1mm".into())
}

fn method(text: &str) -> Result<integrate::Method, String> {
    let names = || integrate::Method::ALL.map(integrate::Method::name).join(", ");
    let method = integrate::Method::ALL.into_iter().find(|method| method.name() == text);
    method.ok_or_else(|| format!("is none of {}", names()))
}

/// A part of a sweep.
#[derive(Clone, Copy, Debug)]
pub struct Shard {
    /// Which, from 1.
    pub number: usize,
    /// Of how many.
    pub count: usize,
}

impl Shard {
    /// Whether the run of that index, from 0, is its own.
    pub const fn takes(self, index: usize) -> bool {
        index % self.count == self.number - 1
    }
}

fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/').and_then(|(number, count)| Some((number.parse().ok()?, count.parse().ok()?)));
    let shard = parts.map(|(number, count)| Shard { number, count });
    let shard = shard.filter(|shard| (1..=shard.count).contains(&shard.number));
    shard.ok_or_else(|| "must be I/N, such as 1/8 to 8/8".into())
}

/// What computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// The processor.
    Cpu,
    /// A graphics processor: it finds what can touch, in single precision
    Gpu,
}

impl Backend {
    /// As summaries spell it.
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
    /// Cells and control bits, as runs do.
    Grid,
    /// Cells, by a simpler rule.
    Reference,
    /// Every pair compared: slow.
    Brute,
}

/// How far detection goes; each stage includes those before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub enum DetectStage {
    /// Pairs whose boxes overlap.
    Candidates,
    /// Pairs closer than the thickness.
    Contacts,
    /// Pairs that touch on the way to the next mesh.
    Ccd,
    /// Edges that pass through triangles, exactly.
    Intersections,
}

/// In which precision to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// Single: to run.
    F32,
    /// Double: as reference.
    F64,
}

impl Precision {
    /// As the command line spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

/// Which preview picture to leave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PreviewKind {
    /// preview.gif, the cloth in motion.
    Gif,
    /// preview.png, six moments.
    Png,
    /// No picture.
    None,
}

/// A scene, changed as asked, and where its results go.
#[derive(Clone, Debug, Args)]
pub struct SceneArguments {
    /// A scene file, or the name of a built-in scene
    pub scene: String,
    /// Where to write [default: a folder of the scene's name in out]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Override a key of the scene, such as integrator.step=0.001; cloth.KEY means every cloth,
    /// cloth.0.KEY the first
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Simulated seconds, instead of the scene's
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    pub duration: Option<f64>,
}

/// `muslin run`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin run hanging
  muslin run my.toml --out result --export obj,pc2 --preview png
  muslin run flag --set integrator.method=implicit-midpoint --set integrator.step=0.002
  muslin run fold --audit --set contact.friction=0.6
  muslin run fold --backend gpu
  muslin run curtain --checkpoint 100; muslin run curtain --resume out/curtain/checkpoint.muslin

Exit codes: 0 fine, 1 the tool failed, 2 bad usage or scene, 3 diverged, or --audit found surfaces
that pass through one another (outputs up to then are valid), 4 no graphics adapter, 130 interrupted
(a checkpoint is written).")]
pub struct RunArguments {
    /// The scene
    #[command(flatten)]
    pub of: SceneArguments,
    /// What computes
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
    /// The preview picture
    #[arg(long, value_enum, default_value = "gif")]
    pub preview: PreviewKind,
    /// Test every frame exactly for surfaces that pass through one another
    #[arg(long)]
    pub audit: bool,
    /// Write a checkpoint every N steps
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), allow_negative_numbers = true)]
    pub checkpoint: Option<u64>,
    /// Go on from a checkpoint of the same scene
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
    /// Print the summary as one JSON document
    #[arg(long)]
    pub json: bool,
    /// No progress, no summary; warnings and errors only
    #[arg(long)]
    pub quiet: bool,
}

/// `muslin detect`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin detect dress.obj --thickness 0.002
  muslin detect frame1.ply --next frame2.ply --thickness 0 --stage ccd
  muslin detect dress.obj --thickness 0.002 --stage intersections --json
  muslin detect dress.obj --thickness 0.002 --backend gpu

A candidate is a vertex with a triangle, or two edges, that share no vertex and whose boxes, each
wider by half the thickness on every side, touch or overlap. A contact is a candidate closer than
the thickness, as MESH stands: with a thickness of 0 there are none. With --next the boxes are those
of the motion, and ccd counts what touches in its course, things that are too near to tell included.
Intersections are edges of MESH that pass through triangles, by an exact test. All is in single
precision. With --backend gpu candidates, contacts and ccd come from one submission and have one
time, transfers included, of its second run; a pair as near to the thickness as rounding, or to
touching, may be counted otherwise.

Exit codes: 0 fine, 1 the tool failed, 2 bad usage or mesh, 4 no graphics adapter, or one whose
buffers are too small.")]
pub struct DetectArguments {
    /// An OBJ or PLY file
    pub mesh: PathBuf,
    /// The same mesh some time later: the same triangles, other positions
    #[arg(long, value_name = "MESH")]
    pub next: Option<PathBuf>,
    /// How near is in contact, m; 0 is allowed
    #[arg(long, value_name = "H", value_parser = thickness, allow_negative_numbers = true)]
    pub thickness: f32,
    /// How to find candidates; all find the same
    #[arg(long, value_enum, default_value = "grid")]
    pub method: Method,
    /// What computes
    #[arg(long, value_enum, default_value = "cpu")]
    pub backend: Backend,
    /// How far to go; each stage includes those before
    #[arg(long, value_enum, default_value = "contacts")]
    pub stage: DetectStage,
    /// Threads [default: one per core]; the counts do not depend on it
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
}

/// What a study's costs are told by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Cost {
    /// The time that runs take on this machine
    Clock,
    /// What they count, as seconds of a machine of 10 GB/s: the same results on every machine
    Counts,
}

/// What every study takes.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// The scene
    #[command(flatten)]
    pub of: SceneArguments,
    /// What costs and the budget are told by
    #[arg(long, value_enum, default_value = "clock")]
    pub cost: Cost,
    /// Seconds that the study may take, about
    #[arg(long, value_name = "S", default_value = "600", value_parser = seconds, allow_negative_numbers = true)]
    pub budget: f64,
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
    /// No progress, no table; errors only
    #[arg(long)]
    pub quiet: bool,
}

/// `muslin chart`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin chart skirt --duration 0.5
  muslin chart my.toml --methods backward-euler,bdf2,rk4 --budget 120

Every method runs the scene by steps in factors of two, in both precisions, on one thread. Errors
are RMS over 20 moments, as a part of the cloth's diagonal, against a reference whose steps are
halved until they no longer matter: positions against RK4 in double precision, or with contact,
which leaves no vertex a place of its own, the outline of the drape against backward Euler. Solvers
are asked for more as steps shrink. Writes chart.svg, chart.json, chart.txt and study.html.

Exit codes: 0 fine, 1 the tool failed, 2 bad usage or scene, 3 no reference within the budget,
nothing that could be charted, or a reference that no implicit method confirms (that is written),
130 interrupted.")]
pub struct ChartArguments {
    /// The scene and the limits
    #[command(flatten)]
    pub study: StudyArguments,
    /// Methods, separated by commas [default: all]
    #[arg(long, value_delimiter = ',', value_parser = method)]
    pub methods: Vec<integrate::Method>,
    /// No shorter steps than this, whatever is left of the budget
    #[arg(long, value_name = "S", value_parser = step, allow_negative_numbers = true)]
    pub finest: Option<f64>,
}

/// `muslin stability`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin stability skirt --methods symplectic-euler,rk4,backward-euler
  muslin stability my.toml --budget 120

Runs the scene in single precision, on one thread, by steps around each method's limit and with its
stiffness (and damping, if it has any) times 1/16 to 16: 1000 steps of explicit methods, 200 of
implicit ones, or to its end. A run is fine, or its energy grew to 10 times what backward Euler has,
or a step could not be taken, or a solver gave up. The limit of theory is that of the fastest mode
at the scene's start. On the scene itself the limit is then watched to the scene's end. Backward
Euler, where it is among the methods, is also run with newton = 20. Every method has a share of the
budget. Writes stability.svg, stability.json, stability.txt and study.html.

Exit codes: 0 fine, 1 the tool failed, 2 bad usage or scene, 3 the budget does not do for all runs
(those that are done are written), 130 interrupted.")]
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
#[command(after_help = "\
Examples:
  muslin needs skirt --duration 0.5
  muslin needs my.toml --budget 120 --json
  muslin needs ball --duration 0.7 --set integrator.step=0.002

Runs the scene as it stands, in single precision on one thread, and again without each term that
it models: shear, bending, damping, drag, wind, self-collision, continuous testing, friction,
contact with its colliders. Then with something simpler: springs for a membrane, bending springs for
hinges, one Newton iteration for several; and with what could be modelled besides: Newton's method,
up to 20 iterations a step, and double precision.

It tells how far each moves the cloth, RMS over 20 moments: positions, or with contact, which leaves
no vertex a place of its own, the outline of the drape. Half the step moves it too: a term that
moves it by less cannot be told at this step, and all such are switched off together in a last run.
Costs are the median of pairs of runs, told where the pairs are on one side; counts do not depend
on the machine. Steps fit into 20 equal parts of the time, and where a run takes another step that
is told. Bending springs store the energy of the hinges where the sheet is bent by 30 degrees from
triangle to triangle. Writes needs.svg, needs.json, needs.txt and study.html.

Exit codes: 0 fine (a term without which the scene fails is a result), 1 the tool failed, 2 bad
usage or scene, 3 the scene itself fails or the budget does not do for all runs (those that are
done are written), 130 interrupted.")]
pub struct NeedsArguments {
    /// The scene and the limits
    #[command(flatten)]
    pub study: StudyArguments,
}

/// `muslin sweep`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin sweep my-sweep.toml
  muslin sweep my-sweep.toml --shard 1/8
  parallel muslin sweep my-sweep.toml --quiet --shard {}/8 ::: 1 2 3 4 5 6 7 8

A sweep is a TOML file:
  scene = \"skirt\"                a file, relative to this one, or a built-in scene
  duration = 0.5                   if other than the scene's
  precision = [\"f32\", \"f64\"]     or one of them, in quotes; f32 if absent
  [set]                            for all runs, keys as --set of muslin run takes them
  cloth.density = 0.2
  [grid]                           every combination; the last key changes faster, precision fastest
  integrator.method = [\"backward-euler\", \"bdf2\"]
  integrator.step = [0.01, 0.005]

Each run appends one line to FILE.jsonl once it has ended, diverged runs too. What has its line is
not run again: killed or interrupted, a sweep goes on by the same command. A changed scene, mesh or
version of muslin is another run. Shards share a file only where it can be locked.

Exit codes: 0 all runs have their line, 1 the tool failed, 2 bad usage or sweep (nothing is run),
130 interrupted.")]
pub struct SweepArguments {
    /// The file of the sweep
    pub sweep: PathBuf,
    /// One part of N: the I-th run, the N-th after that, and so on
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Where to append lines [default: out/SWEEP.jsonl, or out/SWEEP.I-of-N.jsonl]
    #[arg(long, value_name = "FILE.jsonl")]
    pub out: Option<PathBuf>,
    /// Threads of a run; results do not depend on it
    #[arg(long, value_name = "N", default_value = "1", value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// No progress, no table; errors only
    #[arg(long)]
    pub quiet: bool,
}

/// `muslin validate`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin validate                       all checks: some minutes, most of them for the cantilever
  muslin validate --only hinge          one group; the report lists them
  muslin validate --only \"Gamma 10\"    those with these words in their name
  muslin validate --list                the names of all checks

Closed forms and known solutions, measured with the core in double precision: what is expected, what
came out, how far off that is and how far it may be. Writes validate.json, validate.txt and, where
the heavy cantilever was measured, validate.svg, its curve and what came out beside it; a part of the
checks writes to files of its own, such as validate-gamma-10.json.

Exit codes: 0 all checks pass, 1 the tool failed, 2 bad usage, 3 a check fails (the results are
written), 130 interrupted.")]
pub struct ValidateArguments {
    /// Only the group of this name, or checks with these whole words in theirs, the group before it
    #[arg(long, value_name = "NAME")]
    pub only: Option<String>,
    /// Print the names of the checks, measure nothing
    #[arg(long)]
    pub list: bool,
    /// Where to write
    #[arg(long, value_name = "DIR", default_value = "out/validate")]
    pub out: PathBuf,
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
    /// No progress, no table; errors only
    #[arg(long)]
    pub quiet: bool,
}

/// `muslin choose`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin choose swing --duration 0.5 --tolerance 1mm
  muslin choose my.toml --tolerance 0.5cm --budget 120 --write chosen.toml; muslin run chosen.toml

Finds a reference as exact as the tolerance asks, by BDF2 in double precision, its steps halved
until that moves it by a sixteenth of the tolerance and it converges by its order, or by RK4;
with contact, which leaves no vertex a place of its own, by backward Euler, the outline of the
drape, and a fourth: no other method vouches for that one, and how near another comes is told.
Then runs the scene by every method on one thread, by steps that fit into 20 equal parts of the
time, none longer than a frame, until one is within the tolerance (RMS over 20 moments) or takes
twice as long as the cheapest that is, and 0.1 s; then the cheapest without each term that it
models, with something simpler in its place and with a looser solver, and leaves out what is not
needed and costs more than 5 %. A tolerance as large as the cloth is refused.
The choice is run afresh and measured against a reference of half the step. Writes choose.svg,
choose.json, choose.txt and study.html, and with --write the scene as chosen, with its comments.

Exit codes: 0 fine, 1 the tool failed, 2 bad usage or scene, 3 nothing meets the tolerance within
the budget (what can be reached is told), 130 interrupted.")]
pub struct ChooseArguments {
    /// The scene and the limits
    #[command(flatten)]
    pub study: StudyArguments,
    /// RMS error allowed, m, or with a unit: 1mm
    #[arg(long, value_name = "T", value_parser = tolerance, allow_negative_numbers = true)]
    pub tolerance: f64,
    /// Save the scene with the choice in it
    #[arg(long, value_name = "FILE")]
    pub write: Option<PathBuf>,
}

/// `muslin scenes`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  muslin scenes flag > my.toml")]
pub struct ScenesArguments {
    /// Print this scene's file
    pub name: Option<String>,
    /// Print the list as one JSON document
    #[arg(long)]
    pub json: bool,
}

/// `muslin devices`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  muslin devices --json")]
pub struct DevicesArguments {
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
}

/// `muslin bench`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin bench                          the scenes and sizes of the README
  muslin bench hanging swing --threads 1
  muslin bench my.toml --json
  muslin bench crumpled                 candidates of crumpled sheets, 10k to 1M triangles")]
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

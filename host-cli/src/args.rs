//! The command line.

use std::path::PathBuf;

use muslin_core::integrate;

use clap::{Args, Parser, Subcommand, ValueEnum};
use serde::Deserialize;

use crate::export::Format;
use crate::units;

/// A cloth simulator that says what each method costs and how large its error is.
#[derive(Debug, Parser)]
#[command(
    name = "muslin",
    version,
    arg_required_else_help = true,
    after_help = "\
Examples:
  muslin run flag                       run a built-in scene, leave a picture in out/flag
  muslin scenes flag > my.toml          start a scene of your own
  muslin choose flag --tolerance 5mm    find the cheapest method within 5 mm
  muslin detect a.ply --thickness 0.002 find contacts in a mesh
  muslin chart skirt --duration 0.5     chart the error of every method against its cost
  muslin validate                       compare results with known answers
  muslin bench                          measure the cost of each stage on this machine

Studies, in the order in which to run them:
  needs      which terms must be modelled?
  choose     which method and step meet my tolerance?
  chart      how does the error of every method fall with its cost?
  stability  how far is the step from failing?
  validate   are the models right? (needs no scene)
  sweep      how do results change over a grid of values?"
)]
pub struct Arguments {
    /// The command
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulate a scene; write frames, a picture and a summary
    Run(RunArguments),
    /// Count contacts, impacts or intersections in a mesh
    Detect(DetectArguments),
    /// Chart error against cost: every method, both precisions, on a scene
    Chart(ChartArguments),
    /// Map where each method fails: step against stiffness and damping
    Stability(StabilityArguments),
    /// Measure the effect and the cost of each modelled term of a scene
    Needs(NeedsArguments),
    /// Run a scene over a grid of overrides: resumable, one JSON line per run
    Sweep(SweepArguments),
    /// Compare the simulator with known answers
    Validate(ValidateArguments),
    /// Choose the cheapest method, step and terms that meet a tolerance on a scene
    Choose(ChooseArguments),
    /// List the built-in scenes, or print one
    Scenes(ScenesArguments),
    /// List the processor and the graphics adapters
    Devices(DevicesArguments),
    /// Measure the cost of each stage on this machine
    Bench(BenchArguments),
}

/// Largest number of threads; a larger one is a typing error.
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

fn shard(text: &str) -> Result<Shard, String> {
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
    /// A grid with a simpler rule.
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
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin run hanging
  muslin run my.toml --out result --export obj,pc2 --preview png
  muslin run flag --set integrator.method=implicit-midpoint --set integrator.step=0.002
  muslin run fold --audit --set contact.friction=0.6
  muslin run fold --backend gpu
  muslin run curtain --checkpoint 100; muslin run curtain --resume out/curtain/checkpoint.muslin

Exit codes: 0 success, 1 an output could not be written, 2 wrong usage or scene, 3 diverged, or
--audit found intersections (outputs up to that point are valid), 4 no graphics adapter,
130 interrupted (a checkpoint was written).")]
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

/// `muslin detect`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin detect dress.obj --thickness 0.002
  muslin detect frame1.ply --next frame2.ply --thickness 0 --stage ccd
  muslin detect dress.obj --thickness 0.002 --stage intersections --json
  muslin detect dress.obj --thickness 0.002 --backend gpu

A candidate is a vertex and a triangle, or two edges. The pair shares no vertex, and its boxes touch
or overlap; each box is widened by half the thickness on every side. A contact is a candidate of MESH
that is closer than the thickness, so a thickness of 0 gives no contacts. With --next the boxes
contain the motion, and ccd counts the pairs that touch during it; pairs that rounding cannot decide
are included. Intersections are edges of MESH that pass through triangles, found by an exact test.

Everything is computed in single precision. With --backend gpu one submission finds candidates,
contacts and ccd; the table has its time in the second run, transfers included. There, rounding may
count a pair differently that is just at the thickness or just touching.

Exit codes: 0 success, 1 an output could not be written, 2 wrong usage or mesh, 4 no graphics
adapter, or its buffers are too small.")]
pub struct DetectArguments {
    /// An OBJ or PLY file
    pub mesh: PathBuf,
    /// The same mesh some time later: the same triangles, other positions
    #[arg(long, value_name = "MESH")]
    pub next: Option<PathBuf>,
    /// Pairs closer than this are contacts, m; 0 is allowed
    #[arg(long, value_name = "H", value_parser = thickness, allow_negative_numbers = true)]
    pub thickness: f32,
    /// The method that finds candidates; all methods find the same
    #[arg(long, value_enum, default_value = "grid")]
    pub method: Method,
    /// The hardware that computes
    #[arg(long, value_enum, default_value = "cpu")]
    pub backend: Backend,
    /// The last stage; it includes the stages before it
    #[arg(long, value_enum, default_value = "contacts")]
    pub stage: DetectStage,
    /// Threads [default: one per core]; the counts do not depend on it
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document
    #[arg(long)]
    pub json: bool,
}

/// The measure of cost in a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Cost {
    /// Time on this machine
    Clock,
    /// Counts, converted to seconds of a machine with 10 GB/s: the same results on every machine
    Counts,
}

/// The arguments of every study.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// The scene
    #[command(flatten)]
    pub of: SceneArguments,
    /// The measure of cost and budget
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
#[command(after_help = "\
Examples:
  muslin chart skirt --duration 0.5
  muslin chart my.toml --methods backward-euler,bdf2,rk4 --budget 120

Every method runs the scene in both precisions, on one thread, with steps in factors of two. The
error is the RMS distance from a reference over 20 moments, as a part of the cloth's diagonal. The
reference is RK4 in double precision, with its steps halved until they no longer matter. With
contact it is backward Euler, and the error is that of the drape's outline, because methods put
single vertices at different places. Shorter steps get a smaller solver tolerance. Writes chart.svg,
chart.json, chart.txt and study.html.

Exit codes: 0 success, 1 an output could not be written, 2 wrong usage or scene, 3 no reference
within the budget, nothing to chart, or a reference that no implicit method confirms (it is
written), 130 interrupted.")]
pub struct ChartArguments {
    /// The scene and the limits
    #[command(flatten)]
    pub study: StudyArguments,
    /// Methods, separated by commas [default: all]
    #[arg(long, value_delimiter = ',', value_parser = method)]
    pub methods: Vec<integrate::Method>,
    /// The shortest step, even if budget is left
    #[arg(long, value_name = "S", value_parser = step, allow_negative_numbers = true)]
    pub finest: Option<f64>,
}

/// `muslin stability`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin stability skirt --methods symplectic-euler,rk4,backward-euler
  muslin stability my.toml --budget 120

Runs the scene in single precision, on one thread. The steps lie around each method's limit, and
stiffness and damping are scaled by 1/16 to 16. A run takes 1000 steps of an explicit method or 200 of
an implicit one, or fewer to the scene's end. Its class is fine, energy growth (10 times the energy
of backward Euler), diverged, or solver failure. The limit of theory follows from the fastest mode at
the scene's start. On the scene itself the measured limit is verified to the scene's end. Backward
Euler is also run with newton = 20. Every method has a share of the budget. Writes stability.svg,
stability.json, stability.txt and study.html.

Exit codes: 0 success, 1 an output could not be written, 2 wrong usage or scene, 3 the budget is too
small for all runs (the finished ones are written), 130 interrupted.")]
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

Runs the scene in single precision, on one thread, and compares it with three kinds of variants:
without each of its terms (shear, bending, damping, drag, wind, self-collision, continuous testing,
friction, contact with its colliders); with a simpler term (springs for a membrane, bending springs
for hinges, one Newton iteration for several); and with more (Newton's method with up to 20
iterations, double precision).

For each variant it reports how far the cloth moves: the RMS distance over 20 moments or, with
contact, the change of the drape's outline. Half the step moves the cloth too. A term that moves it
by less cannot be judged at this step; in a last run all of these terms are switched off together.
The cost is the median of pairs of runs, reported where all pairs agree in sign. Counts do not depend
on the machine. Steps fit into 20 equal parts of the time; where a run takes another step, the report
says so. Bending springs store the same energy as hinges when the sheet is bent by 30 degrees from
triangle to triangle. Writes needs.svg, needs.json, needs.txt and study.html.

Exit codes: 0 success (a scene that fails without a term is a result), 1 an output could not be
written, 2 wrong usage or scene, 3 the scene itself fails, or the budget is too small for all runs
(the finished ones are written), 130 interrupted.")]
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
  duration = 0.5                   absent: the duration of the scene
  precision = [\"f32\", \"f64\"]     or one of them as a string; absent: f32
  [set]                            for all runs; the keys of muslin run --set
  cloth.density = 0.2
  [grid]                           every combination of these values
  integrator.method = [\"backward-euler\", \"bdf2\"]
  integrator.step = [0.01, 0.005]

Each run appends one line to FILE.jsonl at its end, even if it diverged. A run that has its line is
not repeated: to continue a killed or interrupted sweep, start it again with the same command. A
changed scene, mesh or version of muslin makes another run. Shards may share a file only where it can
be locked.

Exit codes: 0 all runs have their line, 1 an output could not be written, 2 wrong usage or sweep
(nothing was run), 130 interrupted.")]
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
#[command(after_help = "\
Examples:
  muslin validate                       all checks: some minutes, mostly for the cantilever
  muslin validate --only hinge          one group; the report lists the groups
  muslin validate --only \"Gamma 10\"    the checks with these words in their name
  muslin validate --list                list all checks

Compares the core in double precision with closed forms and known solutions. For each it reports the
expected value, the measured value, the error and the tolerance. Writes validate.json, validate.txt
and, with the heavy cantilever, validate.svg, which has its measured and its known curve. A part of
the checks writes files of its own, such as validate-gamma-10.json.

Exit codes: 0 all checks pass, 1 an output could not be written, 2 wrong usage, 3 a check fails (the
results are written), 130 interrupted.")]
pub struct ValidateArguments {
    /// Only the group with this name, or the checks with these whole words in "GROUP NAME"
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

/// `muslin choose`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  muslin choose swing --duration 0.5 --tolerance 1mm
  muslin choose my.toml --tolerance 0.5cm --budget 120 --write chosen.toml; muslin run chosen.toml

1. Finds a reference: BDF2 or RK4 in double precision. Its steps are halved until a further halving
   moves the cloth by less than a sixteenth of the tolerance and it converges by its order. With
   contact it is backward Euler, and the drape's outline must move by less than a fourth; no other
   method confirms that reference, and the report says how near another method comes.
2. Runs the scene with every method, on one thread. Steps fit into 20 equal parts of the time and are
   not longer than a frame. They are shortened until the RMS error over 20 moments is within the
   tolerance, or until a run takes 0.1 s more than twice the time of the cheapest run that is.
3. Runs the cheapest without each of its terms, with simpler terms and with a looser solver. It leaves
   out each term that is not needed and costs more than 5 %.
4. Runs the choice again and measures it against a reference of half the step.

A tolerance as large as the cloth is refused. Writes choose.svg, choose.json, choose.txt and
study.html, and with --write the chosen scene, with its comments.

Exit codes: 0 success, 1 an output could not be written, 2 wrong usage or scene, 3 no method meets
the tolerance within the budget (the report names the best), 130 interrupted.")]
pub struct ChooseArguments {
    /// The scene and the limits
    #[command(flatten)]
    pub study: StudyArguments,
    /// The largest RMS error, m, or with a unit: 1mm
    #[arg(long, value_name = "T", value_parser = tolerance, allow_negative_numbers = true)]
    pub tolerance: f64,
    /// Write the chosen scene to this file
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
  muslin bench                          the scenes and sizes of the manual
  muslin bench hanging swing --threads 1
  muslin bench my.toml --json
  muslin bench crumpled                 the broad phase on crumpled sheets, 10k to 1M triangles")]
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

#[cfg(test)]
mod tests {
    use clap::error::ErrorKind;

    use super::*;

    const MANUALS: [&str; 10] = [
        include_str!("../../README.md"),
        include_str!("../README.md"),
        include_str!("../manual/cost.md"),
        include_str!("../manual/detect.md"),
        include_str!("../manual/methods.md"),
        include_str!("../manual/running.md"),
        include_str!("../manual/scene.md"),
        include_str!("../manual/studies.md"),
        include_str!("../manual/sweep.md"),
        include_str!("../manual/validate.md"),
    ];

    /// The words of a command line up to its comment; quotes keep words together.
    fn words(line: &str) -> Vec<String> {
        let mut words = vec![String::new()];
        let mut quoted = false;
        for c in line.split(" #").next().unwrap_or("").split(" >").next().unwrap_or("").chars() {
            match c {
                '"' | '\'' => quoted = !quoted,
                ' ' if !quoted => words.push(String::new()),
                c => words.last_mut().expect("there is one").push(c),
            }
        }
        words.retain(|word| !word.is_empty());
        words
    }

    #[test]
    fn every_command_of_the_manuals_is_understood() {
        let mut count = 0;
        for manual in MANUALS {
            for (place, part) in manual.split("```").enumerate() {
                // Outside of blocks, commands stand between backquotes, and some lack their arguments.
                let lines: Vec<String> = match (place % 2, part.strip_prefix("sh\n")) {
                    (1, Some(block)) => block.lines().map(str::to_owned).collect(),
                    (1, None) => Vec::new(),
                    _ => part.split('`').skip(1).step_by(2).map(|code| code.replace('\n', " ")).collect(),
                };
                // A shell's variables are not known here.
                for line in lines.iter().filter(|line| line.starts_with("muslin ") && !line.contains('$')) {
                    let kind = Arguments::try_parse_from(words(line)).err().map(|error| error.kind());
                    let incomplete = place % 2 == 0 && kind == Some(ErrorKind::MissingRequiredArgument);
                    let fine = matches!(kind, None | Some(ErrorKind::DisplayHelp)) || incomplete;
                    assert!(fine, "the manual has {line:?}, which is {kind:?}");
                    count += 1;
                }
            }
        }
        assert!(count > 50, "{count} commands: the blocks are no longer found");
    }
}

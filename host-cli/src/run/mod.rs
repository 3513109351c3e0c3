//! `muslin run`: simulates a scene from its first to its last frame, and writes its files.

mod conclusion;
pub mod course;
mod files;
pub mod start;
mod step_plot;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use muslin_core::scene::{SceneDesc, Timing};

use crate::args::{Backend, Precision, PreviewKind, RunArguments};
use crate::checkpoint::{self, Checkpoint};
use crate::device::StepDetector;
use crate::engine::{self, Engine};
use crate::export::{Exporter, Format};
use crate::failure::{Failure, print_data, print_note};
use crate::interrupt;
use crate::pool::Pool;
use crate::preview::Preview;
use crate::progress;
use crate::record::Start;
use crate::scene_file::{self, SceneFile};
use course::{Course, Ending, Witness, total_steps};
use files::{to_json, write_preview, write_step_plot, write_summary};
use step_plot::StepPlot;

/// Name of the checkpoint in the output directory.
const CHECKPOINT: &str = "checkpoint.muslin";

/// Limit on the memory for the snapshots of the preview, bytes.
const PREVIEW_MEMORY: usize = 200 << 20;

/// Largest number of pictures in the preview.
const PREVIEW_FRAMES: usize = 120;

/// The output files of a run in progress.
struct Files<'a> {
    arguments: &'a RunArguments,
    out: PathBuf,
    scene_crc: u32,
    exporter: Exporter,
    preview: Option<Preview>,
    /// The plot of the substeps under error control.
    step_plot: Option<StepPlot>,
    /// Positions of the colliders' vertices, m.
    solids: Vec<[f32; 3]>,
    bar: ProgressBar,
}

/// Runs a scene.
pub fn run(arguments: &RunArguments) -> Result<(), Failure> {
    if arguments.export.len() > 1 && arguments.export.contains(&Format::None) {
        return Err(Failure::Usage("--export: none excludes all other formats".into()));
    }
    let scene = scene_file::asked(&arguments.of)?;
    let pool = pool(arguments, &scene)?;
    let built = engine::build(&scene, arguments.precision);
    let (mut engine, timing) = built.map_err(|why| Failure::Usage(format!("{}: {why}", arguments.of.scene)))?;
    let scene_crc = checkpoint::scene_crc(&scene);
    let resumed = match &arguments.resume {
        Some(path) => {
            let total = total_steps(&timing);
            Some(checkpoint::resume(path, engine.as_mut(), arguments.precision, scene_crc, total)?)
        }
        None => None,
    };
    let out = out(arguments, &scene)?;
    say_what_changed(arguments, &scene, &timing);
    if !arguments.quiet {
        start::weigh_meshes(&scene);
        start::weigh_thickness(engine.as_ref(), &scene.desc);
        start::weigh_step(engine.as_ref(), &scene.desc, &timing, arguments.precision);
    }
    let stop = interrupt::watch()?;
    let start = match resumed {
        Some(_) => Start::default(),
        None => untangle(engine.as_mut(), arguments, &pool),
    };
    let mut course = Course::begin(engine, timing, arguments.precision, arguments.audit, start, resumed);
    let mut files = Files::begin(arguments, out, scene_crc, &course, resumed.is_some(), &scene.desc)?;
    pool.install(|| {
        if resumed.is_none() {
            course.frame(&pool, &mut files)?;
        }
        let started = Instant::now();
        let ending = course.advance(&pool, &stop, &mut files);
        files.bar.finish_and_clear();
        files.finish(&course, &scene, &ending?, &pool, started.elapsed())
    })
}

/// The threads, with a device if it is requested. A device needs single precision and a scene with contact.
fn pool(arguments: &RunArguments, scene: &SceneFile) -> Result<Pool, Failure> {
    let pool = Pool::new(arguments.threads).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
    match arguments.backend {
        Backend::Cpu => Ok(pool),
        Backend::Gpu if arguments.precision == Precision::F64 => Err(Failure::Usage(
            "--backend gpu: graphics processors work in single precision; use --precision f32".into(),
        )),
        Backend::Gpu if scene.desc.contact.is_none() => Err(Failure::Usage(format!(
            "--backend gpu: {} has no contact, and the GPU only finds contacts; use --backend cpu",
            scene.desc.name
        ))),
        Backend::Gpu => Ok(pool.with_detector(StepDetector::open()?)),
    }
}

/// The output folder: the requested one, the folder of the checkpoint, or one named after the scene file.
fn out(arguments: &RunArguments, scene: &SceneFile) -> Result<PathBuf, Failure> {
    if let (None, Some(checkpoint)) = (&arguments.of.out, &arguments.resume) {
        // The files that a resumed run continues are in the folder of its checkpoint.
        return Ok(checkpoint.parent().unwrap_or(Path::new("")).into());
    }
    scene_file::folder(&arguments.of, scene)
}

/// Untangles the start state; prints a note if there was something to untangle.
fn untangle(engine: &mut dyn Engine, arguments: &RunArguments, pool: &Pool) -> Start {
    let (start, note) = pool.install(|| start::untangle(engine, arguments.audit, pool));
    if let Some(note) = note.filter(|_| !arguments.quiet) {
        print_note(&note);
    }
    start
}

fn say_what_changed(arguments: &RunArguments, scene: &SceneFile, timing: &Timing) {
    if arguments.quiet {
        return;
    }
    let (asked, duration, rate) = (scene.desc.integrator.step(), scene.desc.duration, scene.desc.frame_rate);
    let (n, step) = (timing.steps_per_frame, 1e3 * timing.step);
    if asked > 1.001 / rate {
        print_note(&format!(
            "step {} ms is longer than a frame: taking one step of {step:.4} ms per frame",
            1e3 * asked
        ));
    } else if timing.step < 0.9 * asked {
        print_note(&format!(
            "step {} ms does not divide a frame: taking {n} steps of {step:.4} ms per frame",
            1e3 * asked
        ));
    }
    let taken = timing.frames as f64 / rate;
    if (taken - duration).abs() > 1e-6 * duration {
        print_note(&format!(
            "duration {duration} s is not a whole number of frames: taking {} frames, {taken:.4} s",
            timing.frames
        ));
    }
}

impl<'a> Files<'a> {
    fn begin(
        arguments: &'a RunArguments,
        out: PathBuf,
        scene_crc: u32,
        course: &Course,
        resumed: bool,
        desc: &SceneDesc,
    ) -> Result<Self, Failure> {
        let frame_rate = desc.frame_rate;
        let Course { engine, timing, positions, steps, .. } = course;
        let first_frame = if resumed { steps / timing.steps_per_frame + 1 } else { 0 };
        let exporter = Exporter::create(&out, &arguments.export, engine.triangles(), frame_rate, first_frame as u32)?;
        let bar = progress_bar(arguments, total_steps(timing), *steps);
        let (preview, step_plot, solids) = (None, None, Vec::new());
        let mut files = Self { arguments, out, scene_crc, exporter, preview, step_plot, solids, bar };
        if arguments.preview != PreviewKind::None {
            files.step_plot = desc.integrator.error().map(|most| StepPlot::new(most, engine.substeps()));
            engine.write_solids(&mut files.solids);
            let most = PREVIEW_MEMORY / (12 * (positions.len() + files.solids.len()));
            let (triangles, pins, solids) = (engine.triangles(), engine.pins(), engine.solids());
            let mut preview = Preview::new(triangles, pins, solids, frame_rate, most.clamp(6, PREVIEW_FRAMES));
            // The preview of a resumed run begins here: earlier frames are in files, if they exist at all.
            if resumed {
                preview.frame(positions, &files.solids);
            }
            files.preview = Some(preview);
        }
        Ok(files)
    }

    fn write_checkpoint(&mut self, course: &Course) -> Result<PathBuf, Failure> {
        let path = self.out.join(CHECKPOINT);
        // Frames go to disk first: a checkpoint must never be ahead of them.
        self.exporter.flush()?;
        let checkpoint = Checkpoint {
            precision: self.arguments.precision,
            scene: self.scene_crc,
            chain: course.chain,
            record: course.record,
            snapshot: course.engine.snapshot(),
        };
        checkpoint::write(&path, &checkpoint).map_err(|error| Failure::Tool(error.to_string()))?;
        Ok(path)
    }

    /// Completes the files, writes preview and summary, and prints the outcome. An interrupted run writes a
    /// checkpoint instead.
    fn finish(
        mut self,
        course: &Course,
        scene: &SceneFile,
        ending: &Ending,
        pool: &Pool,
        wall: Duration,
    ) -> Result<(), Failure> {
        if let Ending::Interrupted = ending {
            let path = self.write_checkpoint(course)?;
            self.exporter.suspend()?;
            let message = format!(
                "interrupted at step {}; to continue, add --resume {} to the same command",
                course.steps,
                path.display()
            );
            return Err(Failure::Interrupted(message));
        }
        let mut summary = course.summary(scene, ending, pool, wall);
        summary.warnings().iter().for_each(|warning| print_note(warning));
        summary.divergence = summary.divergence.map(|what| format!("{what}. The frames before it are kept"));
        let intersecting = course.intersecting(scene);
        let Self { arguments, out, exporter, preview, step_plot, .. } = self;
        let mut written = exporter.finish()?;
        written.extend(write_preview(arguments, preview.as_ref(), &out)?);
        let plot = step_plot.and_then(|plot| plot.draw(&scene.desc.name));
        written.extend(plot.map(|plot| write_step_plot(&plot, &out)).transpose()?);
        written.push(write_summary(&summary, &out)?);
        if arguments.json {
            print_data(&to_json(&summary)?)?;
        } else if !arguments.quiet {
            print_data(&summary.lines())?;
        }
        if !arguments.quiet {
            let names: Vec<_> = written.iter().map(|path| path.display().to_string()).collect();
            print_note(&format!("wrote {}", names.join(", ")));
            let older: Vec<_> = files::older(&out, &written).iter().map(|path| path.display().to_string()).collect();
            if !older.is_empty() {
                print_note(&format!("of an earlier run: {}", older.join(", ")));
            }
        }
        match (summary.divergence, intersecting) {
            (Some(message), _) => Err(Failure::Diverged(message)),
            (None, Some(message)) => Err(Failure::Intersecting(message)),
            (None, None) => Ok(()),
        }
    }
}

impl Witness for Files<'_> {
    fn frame(&mut self, course: &Course) -> Result<(), Failure> {
        self.exporter.frame(&course.positions)?;
        if let Some(preview) = &mut self.preview {
            course.engine.write_solids(&mut self.solids);
            preview.frame(&course.positions, &self.solids);
        }
        Ok(())
    }

    fn step(&mut self, course: &Course) -> Result<(), Failure> {
        if self.arguments.checkpoint.is_some_and(|every| course.steps.is_multiple_of(every)) {
            self.write_checkpoint(course)?;
        }
        if let Some(plot) = &mut self.step_plot {
            plot.step(course);
        }
        self.bar.set_position(course.steps);
        Ok(())
    }
}

fn progress_bar(arguments: &RunArguments, total: u64, done: u64) -> ProgressBar {
    let template = "{elapsed_precise} {wide_bar} step {pos}/{len}, {eta} left";
    let bar = progress::bar(total, template, arguments.quiet);
    bar.set_position(done);
    bar.reset_eta();
    bar
}

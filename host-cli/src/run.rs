//! `muslin run`: a scene from its first to its last frame, and what is left of it on disk.

mod conclusion;
mod files;
mod start;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use muslin_core::scene::Timing;
use muslin_core::stage::Stage;

use crate::args::{PreviewKind, RunArguments};
use crate::checkpoint::{self, Checkpoint, Resumed};
use crate::engine::{self, Divergence, Engine, Halt};
use crate::export::Exporter;
use crate::failure::{Failure, print_data, print_note};
use crate::interrupt;
use crate::pool::Pool;
use crate::preview::Preview;
use crate::record::{Record, Start};
use crate::scene_file::{self, SceneFile};
use crate::stopwatch::Stopwatch;
use files::{to_json, write_preview, write_summary};

/// Name of the checkpoint in the output directory.
const CHECKPOINT: &str = "checkpoint.muslin";

/// Most memory for the snapshots of the preview, bytes.
const PREVIEW_MEMORY: usize = 200 << 20;

/// Most pictures in the preview.
const PREVIEW_FRAMES: usize = 120;

/// How the steps ended.
enum Ending {
    Complete,
    Diverged(Divergence),
    Interrupted,
}

/// Extent along the axes, m.
fn extent(positions: &[[f32; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|axis| {
        let along = positions.iter().map(|p| f64::from(p[axis]));
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    })
}

fn total_steps(timing: &Timing) -> u64 {
    timing.frames * timing.steps_per_frame
}

/// A run under way.
struct Run<'a> {
    arguments: &'a RunArguments,
    engine: Box<dyn Engine>,
    timing: Timing,
    out: PathBuf,
    scene_crc: u32,
    /// The hash chain over the first state and all steps.
    chain: u64,
    steps: u64,
    /// The step at which this process began; above 0 when resumed.
    begun: u64,
    exporter: Exporter,
    preview: Option<Preview>,
    positions: Vec<[f32; 3]>,
    /// Where the vertices of colliders are, m.
    solids: Vec<[f32; 3]>,
    record: Record,
    stepping: Duration,
    /// In the broad phase, the narrow phase and the response.
    contact: [Duration; 3],
    output: Duration,
}

/// Runs a scene.
pub fn run(arguments: &RunArguments) -> Result<(), Failure> {
    arguments.backend.check()?;
    let scene = scene_file::asked(&arguments.of)?;
    let pool = Pool::new(arguments.threads).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
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
        start::weigh_thickness(engine.as_ref(), &scene.desc);
        start::weigh_step(engine.as_ref(), &scene.desc, &timing);
    }
    let stop = interrupt::watch()?;
    let start = match resumed {
        Some(_) => Start::default(),
        None => pool.install(|| start::untangle(engine.as_mut(), arguments, &pool)),
    };
    let mut run = Run::begin(arguments, engine, timing, out, scene_crc, resumed, scene.desc.frame_rate, start)?;
    pool.install(|| {
        let started = Instant::now();
        let ending = run.advance(&pool, &stop)?;
        run.finish(&scene, &ending, pool.threads(), started.elapsed())
    })
}

/// Where to write: as asked, beside the checkpoint, or a folder named after the scene file.
fn out(arguments: &RunArguments, scene: &SceneFile) -> Result<PathBuf, Failure> {
    if let (None, Some(checkpoint)) = (&arguments.of.out, &arguments.resume) {
        // The files that the run goes on with lie beside its checkpoint.
        return Ok(checkpoint.parent().unwrap_or(Path::new("")).into());
    }
    scene_file::folder(&arguments.of, scene)
}

fn say_what_changed(arguments: &RunArguments, scene: &SceneFile, timing: &Timing) {
    if arguments.quiet {
        return;
    }
    let (asked, duration, rate) = (scene.desc.integrator.step, scene.desc.duration, scene.desc.frame_rate);
    let (n, step) = (timing.steps_per_frame, 1e3 * timing.step);
    if asked > 1.001 / rate {
        print_note(&format!("step {} ms is longer than a frame: taking one of {step:.4} ms a frame", 1e3 * asked));
    } else if timing.step < 0.9 * asked {
        print_note(&format!("step {} ms does not divide a frame: taking {n} of {step:.4} ms", 1e3 * asked));
    }
    let taken = timing.frames as f64 / rate;
    if (taken - duration).abs() > 1e-6 * duration {
        print_note(&format!(
            "duration {duration} s is no whole number of frames: taking {} of them, {taken:.4} s",
            timing.frames
        ));
    }
}

impl<'a> Run<'a> {
    fn begin(
        arguments: &'a RunArguments,
        engine: Box<dyn Engine>,
        timing: Timing,
        out: PathBuf,
        scene_crc: u32,
        resumed: Option<Resumed>,
        frame_rate: f64,
        start: Start,
    ) -> Result<Self, Failure> {
        let steps = engine.report().steps;
        let first_frame = if resumed.is_some() { steps / timing.steps_per_frame + 1 } else { 0 };
        let exporter = Exporter::create(&out, &arguments.export, engine.triangles(), frame_rate, first_frame as u32)?;
        let chain = resumed.map_or_else(|| engine.chain(None), |resumed| resumed.chain);
        let mut run = Self {
            arguments,
            engine,
            timing,
            out,
            scene_crc,
            chain,
            steps,
            begun: steps,
            exporter,
            preview: None,
            positions: Vec::new(),
            solids: Vec::new(),
            record: resumed.map_or(Record { start, ..Record::default() }, |resumed| resumed.record),
            stepping: Duration::ZERO,
            contact: [Duration::ZERO; 3],
            output: Duration::ZERO,
        };
        run.engine.write_positions(&mut run.positions);
        if resumed.is_none() {
            run.record.size = extent(&run.positions);
        }
        if arguments.preview != PreviewKind::None {
            run.engine.write_solids(&mut run.solids);
            let most = PREVIEW_MEMORY / (12 * (run.positions.len() + run.solids.len()));
            let (triangles, pins, solids) = (run.engine.triangles(), run.engine.pins(), run.engine.solids());
            let mut preview = Preview::new(triangles, pins, solids, frame_rate, most.clamp(6, PREVIEW_FRAMES));
            // A resumed run's picture begins here: the frames before are in files, if at all.
            if resumed.is_some() {
                preview.frame(&run.positions, &run.solids);
            }
            run.preview = Some(preview);
        }
        if resumed.is_none() {
            run.frame()?;
        }
        Ok(run)
    }

    /// Steps until the end, a divergence or an interrupt.
    fn advance(&mut self, pool: &Pool, stop: &AtomicBool) -> Result<Ending, Failure> {
        let bar = progress(self.arguments, total_steps(&self.timing), self.steps);
        let ending = self.take_steps(pool, stop, &bar);
        bar.finish_and_clear();
        ending
    }

    fn take_steps(&mut self, pool: &Pool, stop: &AtomicBool, bar: &ProgressBar) -> Result<Ending, Failure> {
        let total = total_steps(&self.timing);
        let stopwatch = Stopwatch::new(pool).until(stop);
        while self.steps < total {
            if stop.load(Ordering::Relaxed) {
                return Ok(Ending::Interrupted);
            }
            let started = Instant::now();
            let stepped = self.engine.step(&stopwatch);
            stopwatch.pause();
            self.stepping += started.elapsed();
            self.contact = [Stage::BroadPhase, Stage::NarrowPhase, Stage::Response].map(|s| stopwatch.time(s));
            match stepped {
                Ok(()) => {}
                Err(Halt::Diverged(divergence)) => return Ok(Ending::Diverged(divergence)),
                Err(Halt::Stopped) => return Ok(Ending::Interrupted),
            }
            self.steps += 1;
            self.chain = self.engine.chain(Some(self.chain));
            if self.steps.is_multiple_of(self.timing.steps_per_frame) {
                self.frame()?;
            }
            if self.arguments.checkpoint.is_some_and(|every| self.steps.is_multiple_of(every)) {
                self.write_checkpoint()?;
            }
            bar.set_position(self.steps);
        }
        Ok(Ending::Complete)
    }

    fn frame(&mut self) -> Result<(), Failure> {
        let started = Instant::now();
        self.engine.write_positions(&mut self.positions);
        self.exporter.frame(&self.positions)?;
        let record = &mut self.record;
        record.stretch = record.stretch.max(self.engine.largest_stretch());
        record.penetration = self.engine.penetration().map(|now| now.max(record.penetration.unwrap_or(0.0)));
        if self.arguments.audit {
            let found = (self.engine.crossings() as u64, self.steps / self.timing.steps_per_frame);
            if record.crossings.is_none_or(|worst| found.0 > worst.0) {
                record.crossings = Some(found);
            }
        }
        if let Some(preview) = &mut self.preview {
            self.engine.write_solids(&mut self.solids);
            preview.frame(&self.positions, &self.solids);
        }
        self.output += started.elapsed();
        Ok(())
    }

    fn write_checkpoint(&mut self) -> Result<PathBuf, Failure> {
        let path = self.out.join(CHECKPOINT);
        // First the frames: a checkpoint must never be ahead of them.
        self.exporter.flush()?;
        let checkpoint = Checkpoint {
            precision: self.arguments.precision,
            scene: self.scene_crc,
            chain: self.chain,
            record: self.record,
            snapshot: self.engine.snapshot(),
        };
        checkpoint::write(&path, &checkpoint).map_err(|error| Failure::Tool(error.to_string()))?;
        Ok(path)
    }

    /// Completes the files, writes picture and summary, and says how it went.
    fn finish(mut self, scene: &SceneFile, ending: &Ending, threads: usize, wall: Duration) -> Result<(), Failure> {
        if let Ending::Interrupted = ending {
            let path = self.write_checkpoint()?;
            self.exporter.suspend()?;
            let message = format!(
                "interrupted at step {}; go on with the same command and --resume {}",
                self.steps,
                path.display()
            );
            return Err(Failure::Interrupted(message));
        }
        let summary = self.summary(scene, ending, threads, wall);
        let intersecting = self.intersecting(scene);
        let Self { arguments, out, exporter, preview, .. } = self;
        let mut written = exporter.finish()?;
        written.extend(write_preview(arguments, preview.as_ref(), &out)?);
        written.push(write_summary(&summary, &out)?);
        if arguments.json {
            print_data(&to_json(&summary)?)?;
        } else if !arguments.quiet {
            print_data(&summary.lines())?;
        }
        if !arguments.quiet {
            let names: Vec<_> = written.iter().map(|path| path.display().to_string()).collect();
            print_note(&format!("wrote {}", names.join(", ")));
        }
        match (summary.divergence, intersecting) {
            (Some(message), _) => Err(Failure::Diverged(message)),
            (None, Some(message)) => Err(Failure::Intersecting(message)),
            (None, None) => Ok(()),
        }
    }
}

fn progress(arguments: &RunArguments, total: u64, done: u64) -> ProgressBar {
    // Draws on a terminal only.
    let target = if arguments.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(total), target);
    if let Ok(style) = ProgressStyle::with_template("{elapsed_precise} {wide_bar} step {pos}/{len}, {eta} left") {
        bar.set_style(style);
    }
    bar.set_position(done);
    bar.reset_eta();
    bar
}

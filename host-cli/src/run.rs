//! `muslin run`: a scene from its first to its last frame, and what is left of it on disk.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use muslin_core::scene::Timing;

use crate::args::{Precision, PreviewKind, RunArguments};
use crate::checkpoint::{self, Checkpoint};
use crate::engine::{self, Divergence, Engine};
use crate::export::{Exporter, whole};
use crate::failure::{Failure, print_data};
use crate::pool::Pool;
use crate::preview::Preview;
use crate::scene_file::{self, SceneFile};
use crate::summary::{Contacts, StageMs, Summary};

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

/// A run under way.
struct Run<'a> {
    arguments: &'a RunArguments,
    engine: Box<dyn Engine>,
    timing: Timing,
    out: PathBuf,
    scene_crc: u32,
    chain: Option<u64>,
    steps: u64,
    exporter: Exporter,
    preview: Option<Preview>,
    positions: Vec<[f32; 3]>,
    predict: Duration,
    output: Duration,
}

/// Runs a scene.
pub fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let scene = load(arguments)?;
    let pool = Pool::new(arguments.threads).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
    let (mut engine, timing) = engine::build(&scene, arguments.precision).map_err(Failure::Usage)?;
    let scene_crc = checkpoint::scene_crc(&scene);
    let mut chain = None;
    if let Some(path) = &arguments.resume {
        chain = Some(resume(path, engine.as_mut(), arguments.precision, scene_crc)?);
    }
    say_what_changed(arguments, &scene, &timing);
    let out = arguments.out.clone().unwrap_or_else(|| Path::new("out").join(&scene.desc.name));
    let mut run = Run::begin(arguments, engine, timing, out, scene_crc, chain, scene.desc.frame_rate)?;
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed))
        .map_err(|error| Failure::Tool(format!("cannot watch for interrupts: {error}")))?;
    let started = Instant::now();
    let ending = pool.install(|| run.advance(&pool, &stop))?;
    run.finish(&scene, &ending, pool.threads(), started.elapsed())
}

fn load(arguments: &RunArguments) -> Result<SceneFile, Failure> {
    let mut overrides = arguments.set.clone();
    if let Some(duration) = arguments.duration {
        overrides.push(format!("duration={duration:?}"));
    }
    scene_file::load(&arguments.scene, &overrides)
}

fn resume(path: &Path, engine: &mut dyn Engine, precision: Precision, scene_crc: u32) -> Result<u64, Failure> {
    let failed = |why: String| Failure::Usage(format!("{}: {why}", path.display()));
    let found = checkpoint::read(path).map_err(|error| failed(error.to_string()))?;
    if found.precision != precision {
        return Err(failed("was made in the other precision; add --precision as in the first run".into()));
    }
    if found.scene != scene_crc || !engine.restore(&found.snapshot) {
        return Err(failed("belongs to another scene; resume with the scene and the --set of the first run".into()));
    }
    Ok(found.chain)
}

fn say_what_changed(arguments: &RunArguments, scene: &SceneFile, timing: &Timing) {
    let asked = scene.desc.integrator.step;
    if !arguments.quiet && (timing.step / asked - 1.0).abs() > 1e-9 {
        let (n, step) = (timing.steps_per_frame, 1e3 * timing.step);
        eprintln!("step {:.4} ms does not divide a frame: taking {n} steps of {step:.4} ms", 1e3 * asked);
    }
}

impl<'a> Run<'a> {
    fn begin(
        arguments: &'a RunArguments,
        engine: Box<dyn Engine>,
        timing: Timing,
        out: PathBuf,
        scene_crc: u32,
        chain: Option<u64>,
        frame_rate: f64,
    ) -> Result<Self, Failure> {
        let steps = engine.report().steps;
        let first_frame = if chain.is_some() { steps / timing.steps_per_frame + 1 } else { 0 };
        let exporter = Exporter::create(&out, &arguments.export, engine.triangles(), frame_rate, first_frame as u32)?;
        let mut run = Self {
            arguments,
            engine,
            timing,
            out,
            scene_crc,
            chain,
            steps,
            exporter,
            preview: None,
            positions: Vec::new(),
            predict: Duration::ZERO,
            output: Duration::ZERO,
        };
        run.engine.write_positions(&mut run.positions);
        if arguments.preview != PreviewKind::None {
            let most = (PREVIEW_MEMORY / (12 * run.positions.len())).clamp(6, PREVIEW_FRAMES);
            run.preview = Some(Preview::new(run.engine.triangles(), run.engine.pins(), frame_rate, most));
        }
        if first_frame == 0 {
            run.frame()?;
        }
        Ok(run)
    }

    /// Steps until the end, a divergence or an interrupt.
    fn advance(&mut self, pool: &Pool, stop: &AtomicBool) -> Result<Ending, Failure> {
        let total = self.timing.frames * self.timing.steps_per_frame;
        let bar = progress(self.arguments, total, self.steps);
        while self.steps < total {
            if stop.load(Ordering::Relaxed) {
                return Ok(Ending::Interrupted);
            }
            let started = Instant::now();
            let stepped = self.engine.step(pool);
            self.predict += started.elapsed();
            if let Err(divergence) = stepped {
                return Ok(Ending::Diverged(divergence));
            }
            self.steps += 1;
            self.chain = Some(self.engine.chain(self.chain));
            if self.steps.is_multiple_of(self.timing.steps_per_frame) {
                self.frame()?;
            }
            if self.arguments.checkpoint.is_some_and(|every| self.steps.is_multiple_of(every)) {
                self.write_checkpoint()?;
            }
            bar.set_position(self.steps);
        }
        bar.finish_and_clear();
        Ok(Ending::Complete)
    }

    fn frame(&mut self) -> Result<(), Failure> {
        let started = Instant::now();
        self.engine.write_positions(&mut self.positions);
        self.exporter.frame(&self.positions)?;
        if let Some(preview) = &mut self.preview {
            preview.frame(&self.positions);
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
            chain: self.chain.unwrap_or_else(|| self.engine.chain(None)),
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
            let message = format!("interrupted at step {}; go on with --resume {}", self.steps, path.display());
            return Err(Failure::Interrupted(message));
        }
        let summary = self.summary(scene, ending, threads, wall);
        let Self { arguments, out, exporter, preview, .. } = self;
        let mut written = exporter.finish()?;
        written.extend(write_preview(arguments.preview, preview.as_ref(), &out)?);
        written.push(write_summary(&summary, &out)?);
        if arguments.json {
            print_data(&to_json(&summary)?)?;
        } else if !arguments.quiet {
            print_data(&summary.lines())?;
        }
        if !arguments.quiet {
            let names: Vec<_> = written.iter().map(|path| path.display().to_string()).collect();
            eprintln!("wrote {}", names.join(", "));
        }
        match summary.divergence {
            Some(message) => Err(Failure::Diverged(message)),
            None => Ok(()),
        }
    }

    fn summary(&self, scene: &SceneFile, ending: &Ending, threads: usize, wall: Duration) -> Summary {
        let report = self.engine.report();
        let per_step = |total: Duration| 1e3 * total.as_secs_f64() / (self.steps.max(1) as f64);
        let divergence = match ending {
            Ending::Diverged(d) => Some(format!(
                "diverged in step {} at particle {}, pulled hardest by {}; take a smaller integrator.step, \
                 softer terms or an implicit method. The frames before it are kept",
                d.step, d.particle, d.term
            )),
            _ => None,
        };
        Summary {
            tool: "muslin",
            version: env!("CARGO_PKG_VERSION"),
            scene: scene.desc.name.clone(),
            precision: match self.arguments.precision {
                Precision::F32 => "f32",
                Precision::F64 => "f64",
            },
            backend: "cpu",
            adapter: None,
            threads,
            vertices: self.positions.len(),
            triangles: self.engine.triangles().len(),
            method: scene.desc.integrator.method.name(),
            step_s: self.timing.step,
            frames: self.steps / self.timing.steps_per_frame + 1,
            steps: self.steps,
            rejected_steps: 0,
            simulated_s: report.time,
            wall_s: wall.as_secs_f64(),
            verdict: if divergence.is_some() { "diverged" } else { "ok" },
            divergence,
            stage_ms: StageMs { predict: per_step(self.predict), output: per_step(self.output), ..StageMs::default() },
            stretch: (&report).into(),
            energy: (&report).into(),
            momentum: report.momentum,
            contacts: Contacts::default(),
            intersections: None,
            penetration_m: None,
            work: (&report).into(),
            state_hash: format!("fnv1a:{:016x}", self.chain.unwrap_or_else(|| self.engine.chain(None))),
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
    bar
}

fn write_preview(kind: PreviewKind, preview: Option<&Preview>, out: &Path) -> Result<Option<PathBuf>, Failure> {
    let Some(preview) = preview else { return Ok(None) };
    let path = match kind {
        PreviewKind::Gif => out.join("preview.gif"),
        PreviewKind::Png => out.join("preview.png"),
        PreviewKind::None => return Ok(None),
    };
    match kind {
        PreviewKind::Gif => preview.write_gif(&path)?,
        _ => preview.write_png(&path)?,
    }
    Ok(Some(path))
}

fn to_json(summary: &Summary) -> Result<String, Failure> {
    serde_json::to_string_pretty(summary).map_err(|error| Failure::Tool(error.to_string()))
}

fn write_summary(summary: &Summary, out: &Path) -> Result<PathBuf, Failure> {
    use std::io::Write;
    let text = to_json(summary)?;
    whole::write(out.join("summary.json"), |file| writeln!(file, "{text}"))
        .map_err(|error| Failure::Tool(error.to_string()))
}

//! `muslin run`: simulates a scene from its first to its last frame, and writes its files.

mod conclusion;
pub mod course;
mod files;
mod manifest;
#[cfg(test)]
mod power_loss;
pub mod remedy;
mod series_plot;
pub mod start;
mod step_plot;
mod time_series;
mod verdict;
mod words;

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use muslin_core::scene::SceneDesc;

use crate::args::{Backend, Precision, PreviewKind, RunArguments};
use crate::checkpoint::{self, Checkpoint, Resumed};
use crate::device::StepDetector;
use crate::engine::{self, Engine};
use crate::export::{Exporter, Format};
use crate::failure::{Failure, print_data, print_note};
use crate::folder::Folder;
use crate::interrupt;
use crate::pool::Pool;
use crate::preview::Preview;
use crate::progress;
use crate::record::Start;
use crate::scene_file::{self, SceneFile};
use crate::stopwatch::Stopwatch;
use crate::warning::Warning;
use course::{Course, Ending, Witness, total_steps};
use files::{SERIES_PLOT, STEP_PLOT, to_json, undrawn, write_plot, write_preview, write_summary};
use step_plot::StepPlot;
use time_series::TimeSeries;

/// Name of the checkpoint in the output directory.
const CHECKPOINT: &str = "checkpoint.muslin";

/// Limit on the memory for the snapshots of the preview, bytes.
const PREVIEW_MEMORY: usize = 200 << 20;

/// Largest number of pictures in the preview.
const PREVIEW_FRAMES: usize = 120;

/// The output files of a run in progress.
struct Files<'a> {
    arguments: &'a RunArguments,
    folder: Folder,
    scene_crc: u32,
    exporter: Exporter,
    series: Option<TimeSeries>,
    preview: Option<Preview>,
    /// The plot of the substeps under error control.
    step_plot: Option<StepPlot>,
    /// Positions of the colliders' vertices, m.
    solids: Vec<[f32; 3]>,
    bar: ProgressBar,
}

/// A run before its first step. It has no files yet.
struct Prepared {
    scene: SceneFile,
    scene_crc: u32,
    pool: Pool,
    engine: Box<dyn Engine>,
    resumed: Option<Resumed>,
}

/// Runs a scene.
pub fn run(arguments: &RunArguments) -> Result<(), Failure> {
    run_until(arguments, &*interrupt::watch()?)
}

/// Loads and builds the scene, and reads the checkpoint.
fn prepare(arguments: &RunArguments) -> Result<Prepared, Failure> {
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
    if arguments.series.is_some() && resumed.as_ref().is_some_and(|resumed| !resumed.record.measures_reactions) {
        return Err(Failure::Usage(
            "--series: the run of this checkpoint measured no reactions; run the scene from its start with --series"
                .into(),
        ));
    }
    Ok(Prepared { scene, scene_crc, pool, engine, resumed })
}

/// Runs a scene to its end or until an interrupt.
fn run_until(arguments: &RunArguments, stop: &AtomicBool) -> Result<(), Failure> {
    let own = arguments.clone();
    let Some(prepared) = interrupt::until(stop, move || prepare(&own))? else {
        return Err(Failure::Interrupted("interrupted while the scene was built; nothing is written".into()));
    };
    let Prepared { scene, scene_crc, pool, mut engine, resumed } = prepared?;
    let folder = Folder::take(out(arguments, &scene)?)?;
    let stopwatch = Stopwatch::new(&pool).until(stop);
    let mut warnings = start::warnings(engine.as_ref(), &scene, arguments.precision, &stopwatch);
    let start = match resumed {
        Some(_) => Start::default(),
        None => untangle(engine.as_mut(), arguments, &pool, stop, &mut warnings)?,
    };
    let (observed, is_resumed) = ([arguments.audit, arguments.series.is_some()], resumed.is_some());
    let mut course = Course::begin(engine, &scene.desc, arguments.precision, observed, start, resumed);
    warnings.extend(claim(arguments, &folder, scene_crc, is_resumed, &scene.desc.name)?);
    let mut files = Files::begin(arguments, folder, scene_crc, &course, is_resumed, &scene.desc)?;
    warnings.extend(manifest::missing(&files.exporter, &files.folder));
    warnings.extend(files.series.as_ref().and_then(TimeSeries::missing));
    warnings.iter().for_each(Warning::print);
    course.warnings = warnings;
    pool.install(|| {
        if !is_resumed {
            course.frame(&pool, stop, &mut files)?;
        }
        let started = Instant::now();
        let ending = course.advance(&pool, stop, &mut files);
        files.bar.finish_and_clear();
        files.finish(&course, &scene, &ending?, &pool, started.elapsed(), stop)
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

/// Untangles the start state; adds a warning if there was something to untangle.
fn untangle(
    engine: &mut dyn Engine,
    arguments: &RunArguments,
    pool: &Pool,
    stop: &AtomicBool,
    warnings: &mut Vec<Warning>,
) -> Result<Start, Failure> {
    let untangled = pool.install(|| start::untangle(engine, arguments.audit, pool, stop));
    let (start, warning) = untangled.ok_or_else(|| {
        Failure::Interrupted(
            "interrupted before the first step: the start state was searched for crossings; nothing is written".into(),
        )
    })?;
    warnings.extend(warning);
    Ok(start)
}

/// Makes the folder that of this run, and checks that a resumed run may go on in it. The warning is about the run that was
/// there before.
fn claim(
    arguments: &RunArguments,
    folder: &Folder,
    scene_crc: u32,
    resumed: bool,
    scene: &str,
) -> Result<Option<Warning>, Failure> {
    let run = checkpoint::identity(scene_crc, arguments.precision);
    let (formats, series) = (&arguments.export, arguments.series.as_deref());
    match resumed {
        true => manifest::resume(folder, &run, formats, series).map(|()| None),
        false => manifest::begin(folder, &run, formats, series, scene),
    }
}

impl<'a> Files<'a> {
    fn begin(
        arguments: &'a RunArguments,
        folder: Folder,
        scene_crc: u32,
        course: &Course,
        resumed: bool,
        desc: &SceneDesc,
    ) -> Result<Self, Failure> {
        let frame_rate = desc.frame_rate;
        let Course { engine, timing, positions, steps, .. } = course;
        let first_frame = if resumed { steps / timing.steps_per_frame + 1 } else { 0 };
        let (out, formats) = (folder.path(), &arguments.export);
        let series = arguments.series.as_deref();
        let exporter = Exporter::create(out, formats, engine.triangles(), frame_rate, first_frame as u32)?;
        let series = series.map(|name| TimeSeries::begin(&out.join(name), course, first_frame)).transpose()?;
        let bar = progress_bar(arguments, total_steps(timing), *steps);
        let (preview, step_plot, solids) = (None, None, Vec::new());
        let mut files = Self { arguments, folder, scene_crc, exporter, series, preview, step_plot, solids, bar };
        if arguments.preview != PreviewKind::None {
            files.step_plot = desc.integrator.error().map(|most| StepPlot::new(most, engine.substeps()));
            engine.write_solids(&mut files.solids);
            let most = PREVIEW_MEMORY / (12 * (positions.len() + files.solids.len()));
            let (triangles, solids) = (engine.triangles(), engine.solids());
            let mut preview = Preview::new(triangles, solids, frame_rate, most.clamp(6, PREVIEW_FRAMES));
            // The preview of a resumed run begins here: earlier frames are in files, if they exist at all.
            if resumed {
                preview.frame(positions, &files.solids, || engine.held(), engine.origin());
            }
            files.preview = Some(preview);
        }
        Ok(files)
    }

    fn write_checkpoint(&mut self, course: &Course) -> Result<PathBuf, Failure> {
        let path = self.folder.path().join(CHECKPOINT);
        // Frames go to disk first: a checkpoint must never be ahead of them.
        self.exporter.flush()?;
        self.series.as_mut().map_or(Ok(()), TimeSeries::flush)?;
        let checkpoint = Checkpoint {
            precision: self.arguments.precision,
            scene: self.scene_crc,
            chain: course.chain,
            record: course.record(),
            snapshot: course.engine.snapshot(),
            impulses: course.engine.impulses(),
        };
        checkpoint::write(&path, &checkpoint)?;
        Ok(path)
    }

    /// Completes the files, writes summary and preview, and prints the outcome. An interrupted run writes a
    /// checkpoint instead.
    fn finish(
        mut self,
        course: &Course,
        scene: &SceneFile,
        ending: &Ending,
        pool: &Pool,
        wall: Duration,
        stop: &AtomicBool,
    ) -> Result<(), Failure> {
        if let Ending::Interrupted = ending {
            let path = self.write_checkpoint(course)?;
            let message = format!(
                "interrupted at step {}; to continue, add --resume {} to the same command",
                course.steps,
                path.display()
            );
            return Err(Failure::Interrupted(message));
        }
        let mut summary = course.summary(scene, ending, pool, wall);
        summary.warnings.extend(self.exporter.rounded(course.engine.mean_edge()));
        let undrawn = self.preview.as_ref().and_then(undrawn);
        self.preview = self.preview.filter(|_| undrawn.is_none());
        summary.warnings.extend(undrawn);
        // Those from before the first step are printed already, and the doubt is the last message.
        let new = summary.warnings[course.warnings.len()..].iter();
        new.filter(|warning| summary.doubt.as_ref() != Some(&warning.text)).for_each(Warning::print);
        summary.divergence = summary.divergence.map(|what| format!("{what}. The frames before it are kept"));
        let intersecting = course.intersecting(scene);
        let Self { arguments, folder, exporter, series, preview, step_plot, .. } = self;
        let mut written = exporter.finish()?;
        if let Some(series) = series {
            let path = series.finish()?;
            if arguments.preview != PreviewKind::None {
                let plot = series_plot::draw(&path, &scene.desc)?;
                written.extend(plot.map(|plot| write_plot(SERIES_PLOT, &plot, &folder)).transpose()?);
            }
            written.push(path);
        }
        let plot = step_plot.and_then(|plot| plot.draw(&scene.desc.name));
        written.extend(plot.map(|plot| write_plot(STEP_PLOT, &plot, &folder)).transpose()?);
        written.push(write_summary(&summary, &folder)?);
        // Last of the files: a picture that fails costs none of the others.
        let picture = write_preview(arguments, preview.as_ref(), folder.path(), stop);
        written.extend(picture.iter().flatten().cloned());
        if arguments.json {
            print_data(&to_json(&summary)?)?;
        } else if !arguments.quiet {
            print_data(&summary.lines())?;
        }
        if !arguments.quiet {
            let names: Vec<_> = written.iter().map(|path| path.display().to_string()).collect();
            print_note(&format!("wrote {}", names.join(", ")));
        }
        let lacks_picture = preview.is_some() && picture?.is_none();
        match (summary.divergence, intersecting, summary.doubt) {
            (Some(message), _, _) => Err(Failure::Diverged(message)),
            (None, Some(message), _) => Err(Failure::Intersecting(message)),
            (None, None, Some(doubt)) => Err(Failure::Doubtful(format!("doubtful: {doubt}"))),
            (None, None, None) if lacks_picture => Err(Failure::Interrupted(
                "interrupted while the preview was drawn; the run is complete, and only this picture is missing".into(),
            )),
            (None, None, None) => Ok(()),
        }
    }
}

impl Witness for Files<'_> {
    fn frame(&mut self, course: &Course) -> Result<(), Failure> {
        self.exporter.frame(&course.positions)?;
        self.series.as_mut().map_or(Ok(()), |series| series.frame(course))?;
        if let Some(preview) = &mut self.preview {
            course.engine.write_solids(&mut self.solids);
            preview.frame(&course.positions, &self.solids, || course.engine.held(), course.engine.origin());
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

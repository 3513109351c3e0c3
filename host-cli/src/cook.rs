//! `muslin cook`: writes a scene as one block of bytes for programs without a heap or a file system.

use std::io::Write as _;
use std::path::PathBuf;

use muslin_core::cooked::{ALIGNMENT, Room};
use serde::Serialize;

use crate::args::CookArguments;
use crate::divergence::Divergence;
use crate::engine::{self, Engine, Halt};
use crate::export::whole;
use crate::failure::{Failure, print_data, print_json, print_note};
use crate::pool::Pool;
use crate::progress;
use crate::run::start;
use crate::scene_file::{self, SceneFile};
use crate::stopwatch::Stopwatch;
use crate::warning::Warning;

/// Candidates of each kind, and contacts, that each vertex gets in a scene whose run touches nothing.
const UNKNOWN: [usize; 2] = [16, 1];

/// Room for candidates and for contacts.
struct Measured {
    room: [usize; 2],
    /// Simulated time of the run that measured it, s; 0: no run.
    seconds: f64,
    /// The source of the numbers, for people.
    source: String,
}

/// Cooks a scene and prints its needs.
pub fn cook(arguments: &CookArguments) -> Result<(), Failure> {
    let overrides: Vec<_> = arguments.duration.map(|s| format!("duration={s:?}")).into_iter().collect();
    let overrides = [&arguments.set[..], &overrides].concat();
    let scene = scene_file::load(&arguments.scene, &overrides)?;
    let pool = Pool::new(arguments.threads).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
    let (engine, untangled) = begin(&scene, arguments, &pool)?;
    let of_settings = start::warnings(engine.as_ref(), &scene, arguments.precision, &Stopwatch::new(&pool));
    of_settings.iter().chain(&untangled).for_each(Warning::print);
    let asked = |room| Measured { room, seconds: 0.0, source: "as asked for".into() };
    let measured = match (arguments.pairs, arguments.contacts) {
        _ if scene.desc.contact.is_none() => asked([0; 2]),
        (Some(pairs), Some(contacts)) => asked([pairs, contacts]),
        (pairs, contacts) => {
            let Measured { room, seconds, source } = measure(&scene, arguments, &pool)?;
            Measured { room: [pairs.unwrap_or(room[0]), contacts.unwrap_or(room[1])], seconds, source }
        }
    };
    let [pairs, contacts] = measured.room;
    let CookArguments { hands, forces, deform: deforms, impulses, lean: is_lean, .. } = *arguments;
    let block = engine.cook(&Room { pairs, contacts, hands, forces, deforms, impulses, is_lean });
    let memory_bytes = engine::required_bytes(&block);
    let file = arguments.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.bin", scene.desc.name)));
    let file = whole::write(file, |out| out.write_all(&block))?.display().to_string();
    let cooked = Cooked {
        file,
        block_bytes: block.len(),
        memory_bytes,
        alignment: ALIGNMENT,
        candidates: pairs,
        contacts,
        hands,
        forces,
        step_s: scene.desc.timing().step,
        measured_s: measured.seconds,
    };
    if arguments.json { print_json(&cooked) } else { print_data(&report(&cooked, &measured.source)) }
}

/// The needs of a cooked scene.
#[derive(Serialize)]
struct Cooked {
    file: String,
    block_bytes: usize,
    memory_bytes: usize,
    alignment: usize,
    candidates: usize,
    contacts: usize,
    hands: u32,
    forces: u32,
    /// Length of a step, s: an equal part of a frame.
    step_s: f64,
    /// Simulated time of the run that measured the room, s; 0: no run.
    measured_s: f64,
}

/// The engine at the start of the scene, untangled, and the warning if there was something to untangle.
fn begin(
    scene: &SceneFile,
    arguments: &CookArguments,
    pool: &Pool,
) -> Result<(Box<dyn Engine>, Option<Warning>), Failure> {
    let (mut engine, _) = engine::build(scene, arguments.precision).map_err(Failure::Usage)?;
    let never = std::sync::atomic::AtomicBool::new(false);
    let untangled = pool.install(|| start::untangle(engine.as_mut(), false, pool, &never));
    Ok((engine, untangled.and_then(|(_, warning)| warning)))
}

/// Runs the scene and measures the room that its contacts need, with a quarter more.
fn measure(scene: &SceneFile, arguments: &CookArguments, pool: &Pool) -> Result<Measured, Failure> {
    let (mut engine, _) = begin(scene, arguments, pool)?;
    engine.measure_room(arguments.lean);
    let first = engine.largest_stretch();
    let timing = scene.desc.timing();
    let steps = timing.frames * timing.steps_per_frame;
    let stopwatch = Stopwatch::new(pool);
    let template = "measuring the room for contacts {wide_bar} step {pos}/{len}, {eta} left";
    let bar = progress::bar(steps, template, arguments.quiet);
    for step in 1..=steps {
        match pool.install(|| engine.step(&stopwatch)) {
            Ok(()) => bar.inc(1),
            Err(Halt::Diverged(divergence)) => {
                return Err(Failure::Diverged(divergence.in_words(&scene.desc)));
            }
            Err(Halt::Stopped) => break,
        }
        let looks = step.is_multiple_of(timing.steps_per_frame);
        let flown_apart = || Divergence::of_stretch(engine.as_ref(), step, first);
        if let Some(divergence) = looks.then(flown_apart).flatten() {
            return Err(Failure::Diverged(divergence.in_words(&scene.desc)));
        }
    }
    bar.finish_and_clear();
    let seconds = steps as f64 * timing.step;
    let room = engine.room().map(|room| (room as f64 * arguments.margin) as usize);
    if room[1] > 0 {
        let source = format!(
            "{} times what {seconds:.3} s of the scene needed at most, or as asked for",
            1.25 * arguments.margin
        );
        return Ok(Measured { room, seconds, source });
    }
    print_note(&format!(
        "nothing touched in {seconds:.3} s, so the room for contacts is a guess; give --pairs and --contacts, or a scene whose \
         run touches as much as the program will"
    ));
    let vertices = engine.triangles().iter().flatten().max().map_or(0, |&last| last as usize + 1);
    Ok(Measured {
        room: [room[0].max(UNKNOWN[0] * vertices), UNKNOWN[1] * vertices],
        seconds,
        source: "a guess".into(),
    })
}

fn report(cooked: &Cooked, source: &str) -> String {
    let Cooked { file, block_bytes, memory_bytes, alignment, candidates, contacts, hands, forces, step_s, .. } = cooked;
    let contact = match [candidates, contacts] {
        [0, 0] => "no contacts".to_owned(),
        _ => format!("room for {candidates} candidates of each kind and {contacts} contacts ({source})"),
    };
    format!(
        "{file}: {block_bytes} bytes, which may stay in flash memory\n\
         {memory_bytes} bytes of memory (in C: muslin_required_bytes), both aligned to {alignment} bytes\n\
         {contact}; room for {hands} vertices that the program holds, and for {forces} on which it sets forces\n\
         steps of {:.4} ms",
        1e3 * step_s
    )
}

//! `muslin cook`: writes a scene as one block of bytes for programs without a heap or a file system.

use std::io::Write as _;
use std::path::PathBuf;

use muslin_core::cooked::Room;

use crate::args::CookArguments;
use crate::engine::{self, Engine, Halt};
use crate::export::whole;
use crate::failure::{Failure, print_data};
use crate::pool::Pool;
use crate::progress;
use crate::run::start;
use crate::scene_file::{self, SceneFile};
use crate::stopwatch::Stopwatch;

/// Room for candidates and for contacts, and the simulated time of the run that measured it, s; 0: no run.
struct Measured {
    room: [usize; 2],
    seconds: f64,
}

/// Cooks a scene and prints its needs.
pub fn cook(arguments: &CookArguments) -> Result<(), Failure> {
    let overrides: Vec<_> = arguments.duration.map(|s| format!("duration={s:?}")).into_iter().collect();
    let overrides = [&arguments.set[..], &overrides].concat();
    let scene = scene_file::load(&arguments.scene, &overrides)?;
    let pool = Pool::new(arguments.threads).map_err(|error| Failure::Tool(format!("cannot start threads: {error}")))?;
    let engine = begin(&scene, arguments, &pool)?;
    let measured = match (arguments.pairs, arguments.contacts) {
        _ if scene.desc.contact.is_none() => Measured { room: [0; 2], seconds: 0.0 },
        (Some(pairs), Some(contacts)) => Measured { room: [pairs, contacts], seconds: 0.0 },
        (pairs, contacts) => {
            let Measured { room, seconds } = measure(&scene, arguments, &pool)?;
            Measured { room: [pairs.unwrap_or(room[0]), contacts.unwrap_or(room[1])], seconds }
        }
    };
    let [pairs, contacts] = measured.room;
    let CookArguments { hands, forces, deform: deforms, impulses, lean: is_lean, .. } = *arguments;
    let block = engine.cook(&Room { pairs, contacts, hands, forces, deforms, impulses, is_lean });
    let memory = engine::required_bytes(&block);
    let file = arguments.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.bin", scene.desc.name)));
    let file = whole::write(file, |out| out.write_all(&block))?;
    print_data(&report(&block, memory, &measured, &file.display().to_string(), arguments))
}

/// The engine at the start of the scene, untangled.
fn begin(scene: &SceneFile, arguments: &CookArguments, pool: &Pool) -> Result<Box<dyn Engine>, Failure> {
    let (mut engine, _) = engine::build(scene, arguments.precision).map_err(Failure::Usage)?;
    let never = std::sync::atomic::AtomicBool::new(false);
    if let Some((_, Some(warning))) = pool.install(|| start::untangle(engine.as_mut(), false, pool, &never)) {
        warning.print();
    }
    Ok(engine)
}

/// Runs the scene and measures the room that its contacts need, with a quarter more.
fn measure(scene: &SceneFile, arguments: &CookArguments, pool: &Pool) -> Result<Measured, Failure> {
    let mut engine = begin(scene, arguments, pool)?;
    engine.measure_room(arguments.lean);
    let timing = scene.desc.timing();
    let steps = timing.frames * timing.steps_per_frame;
    let stopwatch = Stopwatch::new(pool);
    let template = "measuring the room for contacts {wide_bar} step {pos}/{len}, {eta} left";
    let bar = progress::bar(steps, template, arguments.quiet);
    for _ in 0..steps {
        match pool.install(|| engine.step(&stopwatch)) {
            Ok(()) => bar.inc(1),
            Err(Halt::Diverged(divergence)) => return Err(Failure::Diverged(divergence.what)),
            Err(Halt::Stopped) => break,
        }
    }
    bar.finish_and_clear();
    let room = engine.room().map(|room| (room as f64 * arguments.margin) as usize);
    Ok(Measured { room, seconds: steps as f64 * timing.step })
}

fn report(block: &[u8], memory: usize, measured: &Measured, file: &str, arguments: &CookArguments) -> String {
    let [pairs, contacts] = measured.room;
    let source = match measured.seconds {
        0.0 => "as asked for".to_owned(),
        seconds if arguments.margin > 1.0 => {
            format!("{} times a quarter more than {seconds} s of the scene needed at most", arguments.margin)
        }
        seconds => format!("a quarter more than {seconds} s of the scene needed at most"),
    };
    let contact = match measured.room {
        [0, 0] => "no contacts".to_owned(),
        _ => format!("room for {pairs} candidates of each kind and {contacts} contacts ({source})"),
    };
    format!(
        "{file}: {} bytes, which may stay in flash memory\n\
         {memory} bytes of memory (in C: muslin_required_bytes), both aligned to 32 bytes\n\
         {contact}; room for {} vertices that the program holds, and for {} on which it sets forces",
        block.len(),
        arguments.hands,
        arguments.forces
    )
}

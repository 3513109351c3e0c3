//! Before the first step: warnings of unsuitable settings, and the untangling of a start state with crossings.

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

use muslin_core::integrate::Method;
use muslin_core::integrate::stability::{Mode, longest_step};
use muslin_core::scene::{Content, SceneDesc, Timing};

use super::masses;
use crate::args::Precision;
use crate::engine::{Engine, Untangled};
use crate::mesh_io;
use crate::pool::Pool;
use crate::record::{Start, extent};
use crate::scene_file::SceneFile;
use crate::stopwatch::Stopwatch;
use crate::units::time;
use crate::warning::Warning;

/// Displacement by untangling beyond which the note asks the user to look at the start state, m.
const FAR: f64 = 0.05;

/// Smallest and largest ratio of thickness to mean edge length at which contact works as expected.
const THICKNESS: [f64; 2] = [1e-4, 1.0];

/// Iterations that give the frequency of the fastest mode to about one per cent. They cost less than the steps.
pub(super) const ITERATIONS: u32 = 100;

/// Part of the longest stable step at the start that is recommended as safe: stretched cloth is stiffer.
const MARGIN: f64 = 0.8;

/// The warnings of settings that do not suit the scene.
pub fn warnings(
    engine: &dyn Engine,
    scene: &SceneFile,
    timing: &Timing,
    precision: Precision,
    stopwatch: &Stopwatch<'_>,
) -> Vec<Warning> {
    let mut all = times(&scene.desc, timing);
    all.extend(loose_vertices(scene));
    all.extend(thickness(engine, &scene.desc));
    all.extend(step(engine, &scene.desc, timing, precision, stopwatch));
    all
}

/// A step or a duration that was changed to divide time into whole frames.
fn times(scene: &SceneDesc, timing: &Timing) -> Vec<Warning> {
    let (duration, rate) = (scene.duration, scene.frame_rate);
    // Nobody asked for a default.
    let asked = scene.integrator.step.unwrap_or(timing.step);
    let (n, step) = (timing.steps_per_frame, 1e3 * timing.step);
    let mut all = Vec::new();
    if asked > 1.001 / rate {
        let text = format!("step {} is longer than a frame: taking one step of {step:.4} ms per frame", time(asked));
        all.push(Warning::new("step", text));
    } else if timing.step < 0.9 * asked {
        let text = format!("step {} does not divide a frame: taking {n} steps of {step:.4} ms per frame", time(asked));
        all.push(Warning::new("step", text));
    }
    let taken = timing.frames as f64 / rate;
    if (taken - duration).abs() > 1e-6 * duration {
        let frames = timing.frames;
        let text =
            format!("duration {duration} s is not a whole number of frames: taking {frames} frames, {taken:.4} s");
        all.push(Warning::new("duration", text));
    }
    all
}

/// A step that is too long for the method in this precision.
fn step(
    engine: &dyn Engine,
    scene: &SceneDesc,
    timing: &Timing,
    precision: Precision,
    stopwatch: &Stopwatch<'_>,
) -> Option<Warning> {
    let method = scene.integrator.method;
    let modes = || engine.fastest_modes(0.0, ITERATIONS, stopwatch);
    match (method.is_implicit(), precision) {
        (true, Precision::F64) => None,
        // Error control takes shorter steps: it is judged by their number at the end.
        (true, Precision::F32) if scene.integrator.error().is_some() => None,
        (true, Precision::F32) => masses::warning(&modes(), scene, size(engine), timing.step),
        (false, _) => limit(&modes(), timing.step, method),
    }
}

/// Largest side of the box around the cloth, m.
fn size(engine: &dyn Engine) -> f64 {
    let mut positions = Vec::new();
    engine.write_state(&mut positions);
    extent(positions.into_iter()).into_iter().fold(0.0, f64::max)
}

/// A step longer than the longest stable step of an explicit method.
fn limit(modes: &[Mode; 2], step: f64, method: Method) -> Option<Warning> {
    let longest = longest_step(modes, method).filter(|&longest| step > longest)?;
    let (name, hertz) = (method.name(), modes[0].stiffness.sqrt() / TAU);
    if longest == 0.0 {
        let text = format!(
            "{name} gains energy in every step without damping; use --set integrator.method=symplectic-euler, or \
             give the cloth damping"
        );
        return Some(Warning::new("unstable", text));
    }
    // Rounded down to two digits.
    let safe = MARGIN * longest;
    let digit = 10f64.powf(safe.log10().floor() - 1.0);
    let safe = (safe / digit).floor() * digit;
    let text = format!(
        "step {} is longer than the limit of {name} at the start of this scene, {} (the fastest mode has {hertz:.0} \
         Hz), and stretched cloth lowers the limit: the cloth will fly apart; use --set integrator.step={safe:.1e}, \
         or --set integrator.method=backward-euler",
        time(step),
        time(longest)
    );
    Some(Warning::new("unstable", text))
}

/// Vertices of a collider's mesh that belong to no triangle. Cloth with such vertices is refused.
fn loose_vertices(scene: &SceneFile) -> impl Iterator<Item = Warning> {
    scene.resources.iter().filter_map(|(name, content)| {
        let of_collider = scene.desc.collider.iter().any(|collider| collider.file.as_ref() == Some(name));
        match content {
            Content::Mesh(mesh) if of_collider => mesh_io::loose_note(name, mesh.loose_vertices()),
            Content::Mesh(_) | Content::Cache(_) => None,
        }
        .map(|note| Warning::new("loose-vertices", note))
    })
}

/// A thickness that does not suit the mesh: often the reason is a length that is not in metres.
fn thickness(engine: &dyn Engine, scene: &SceneDesc) -> Option<Warning> {
    let contact = scene.contact.as_ref()?;
    let (thickness, edge) = (contact.thickness, engine.mean_edge());
    let beside = format!("contact.thickness = {thickness:?} m with edges of {edge:.1e} m on average");
    let text = if thickness > THICKNESS[1] * edge {
        format!(
            "{beside}: each vertex has many neighbours within the thickness, so steps are slow or fail; take a \
             thickness well below the edges"
        )
    } else if thickness < THICKNESS[0] * edge {
        format!("{beside}: such a thin layer is hard to keep apart, so steps are rejected")
    } else {
        return None;
    };
    Some(Warning::new("thickness", text))
}

/// Untangles the start state of a scene with contact. Also returns a warning, if there was something to untangle. `None` after an interrupt: then the state is not to be used.
pub fn untangle(
    engine: &mut dyn Engine,
    audit: bool,
    pool: &Pool,
    stop: &AtomicBool,
) -> Option<(Start, Option<Warning>)> {
    let stopwatch = Stopwatch::new(pool).until(stop);
    let audited = audit.then(|| engine.crossings(&stopwatch) as u64);
    let found = engine.untangle(&stopwatch);
    if (audit || found.is_some()) && stop.load(Ordering::Relaxed) {
        return None;
    }
    let Some(found) = found else { return Some((Start { crossings: audited, untangled: None }, None)) };
    let warning = (found.before > 0 || found.inside[0] > 0).then(|| Warning::new("untangled", words(&found)));
    let crossings = audited.unwrap_or(found.before as u64);
    Some((Start { crossings: Some(crossings), untangled: Some((found.before - found.after) as u64) }, warning))
}

fn words(found: &Untangled) -> String {
    let Untangled { before, after, inside, rounds, moved } = *found;
    let what = match (before, inside[0]) {
        (0, inside) => format!("{inside} vertices inside colliders"),
        (before, _) => format!("{before} crossings"),
    };
    let left = match (after, inside[1]) {
        (0, 0) => format!("untangled in {rounds} round{}", if rounds == 1 { "" } else { "s" }),
        (0, inside) => format!("{inside} vertices left inside (fixed by pins or colliders)"),
        (after, _) => format!("{after} left (fixed by pins or colliders)"),
    };
    let moved_far = moved > FAR;
    let moved = match rounds {
        0 => "nothing was moved".into(),
        _ => format!("vertices moved by up to {:.1} mm", 1e3 * moved),
    };
    let advice = if moved_far { "; look at frame 0, and separate the surfaces yourself if it is wrong" } else { "" };
    format!("{what} at the start: {left}, {moved}{advice}")
}

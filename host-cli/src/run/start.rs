//! Before the first step: notes on unsuitable settings are printed, and a start state with crossings is untangled.

use std::f64::consts::TAU;

use muslin_core::integrate::Method;
use muslin_core::integrate::stability::{Mode, longest_step};
use muslin_core::scene::{Content, SceneDesc, Timing};

use crate::args::Precision;
use crate::engine::{Engine, Untangled};
use crate::failure::print_note;
use crate::mesh_io;
use crate::pool::Pool;
use crate::record::Start;
use crate::scene_file::SceneFile;
use crate::stopwatch::Stopwatch;
use crate::units::time;

/// Displacement by untangling beyond which the note asks the user to look at the start state, m.
const FAR: f64 = 0.05;

/// Smallest and largest ratio of thickness to mean edge length at which contact works as expected.
const THICKNESS: [f64; 2] = [1e-4, 1.0];

/// Iterations that give the frequency of the fastest mode to about one per cent. They cost less than the steps.
const ITERATIONS: u32 = 100;

/// Part of the longest stable step at the start that is recommended as safe: stretched cloth is stiffer.
const MARGIN: f64 = 0.8;

/// Limit on step^2 times the largest eigenvalue in single precision. At the limit the rounding error of the
/// stiffness, 2^-24 of it, is an eighth of the mass. After half a second a sheet of 1 m was off by 0.08 mm at
/// 3e5, by 5 mm at 3e6 and by 0.3 m at 3e7.
const MASSES_LOST: f64 = 2e6;

/// Prints a note if the step is too long for the method in this precision.
pub fn weigh_step(engine: &dyn Engine, scene: &SceneDesc, timing: &Timing, precision: Precision) {
    let method = scene.integrator.method;
    match (method.is_implicit(), precision) {
        (true, Precision::F64) => {}
        (true, Precision::F32) => weigh_masses(&engine.fastest_modes(0.0, ITERATIONS), timing.step),
        (false, _) => weigh_limit(&engine.fastest_modes(0.0, ITERATIONS), timing.step, method),
    }
}

/// Prints a note if the matrix of an implicit step loses the masses beside the stiffness.
fn weigh_masses(modes: &[Mode; 2], step: f64) {
    let times = step * step * modes[0].stiffness;
    if times > MASSES_LOST {
        print_note(&format!(
            "step^2 x stiffness is {times:.0e} times the mass of a vertex: single precision rounds such masses away, \
             and the cloth does not fall as it should; use --precision f64, a shorter step or a softer cloth"
        ));
    }
}

/// Prints a note if the step is longer than the longest stable step of an explicit method.
fn weigh_limit(modes: &[Mode; 2], step: f64, method: Method) {
    let Some(longest) = longest_step(modes, method).filter(|&longest| step > longest) else { return };
    let (name, hertz) = (method.name(), modes[0].stiffness.sqrt() / TAU);
    if longest == 0.0 {
        print_note(&format!(
            "{name} gains energy in every step without damping; use --set integrator.method=symplectic-euler, or \
             give the cloth damping"
        ));
        return;
    }
    // Rounded down to two digits.
    let safe = MARGIN * longest;
    let digit = 10f64.powf(safe.log10().floor() - 1.0);
    let safe = (safe / digit).floor() * digit;
    print_note(&format!(
        "step {} is longer than the limit of {name} at the start of this scene, {} (the fastest mode has {hertz:.0} \
         Hz), and stretched cloth lowers the limit: the cloth will fly apart; use --set integrator.step={safe:.1e}, \
         or --set integrator.method=backward-euler",
        time(step),
        time(longest)
    ));
}

/// Prints a note if vertices of a collider's mesh belong to no triangle. Cloth with such vertices is refused.
pub fn weigh_meshes(scene: &SceneFile) {
    for (name, content) in &scene.resources {
        let of_collider = scene.desc.collider.iter().any(|collider| collider.file.as_ref() == Some(name));
        if let (true, Content::Mesh(mesh)) = (of_collider, content)
            && let Some(note) = mesh_io::loose_note(name, mesh.loose_vertices())
        {
            print_note(&note);
        }
    }
}

/// Prints a note if the thickness does not suit the mesh: often the reason is a length that is not in metres.
pub fn weigh_thickness(engine: &dyn Engine, scene: &SceneDesc) {
    let Some(contact) = &scene.contact else { return };
    let (thickness, edge) = (contact.thickness, engine.mean_edge());
    let beside = format!("contact.thickness = {thickness:?} m with edges of {edge:.1e} m on average");
    if thickness > THICKNESS[1] * edge {
        print_note(&format!(
            "{beside}: each vertex has many neighbours within the thickness, so steps are slow or fail; take a \
             thickness well below the edges"
        ));
    } else if thickness < THICKNESS[0] * edge {
        print_note(&format!("{beside}: such a thin layer is hard to keep apart, so steps are rejected"));
    }
}

/// Untangles the start state of a scene with contact. Also returns a note for the user, if there was something
/// to untangle.
pub fn untangle(engine: &mut dyn Engine, audit: bool, pool: &Pool) -> (Start, Option<String>) {
    let audited = audit.then(|| engine.crossings(pool) as u64);
    let Some(found) = engine.untangle(&Stopwatch::new(pool)) else {
        return (Start { crossings: audited, untangled: None }, None);
    };
    let note = (found.before > 0 || found.inside[0] > 0).then(|| words(&found));
    let crossings = audited.unwrap_or(found.before as u64);
    (Start { crossings: Some(crossings), untangled: Some((found.before - found.after) as u64) }, note)
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

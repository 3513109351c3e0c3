//! The words for the warnings of a scene and its run.

use muslin_core::integrate::Method;
use muslin_core::scene::{SceneDesc, StretchModel};
use muslin_core::warning::{self, Code};

use super::remedy;
use crate::engine::Untangled;
use crate::summary::percent;
use crate::units::{length, time, without_noise};
use crate::warning::Warning;

/// Part of the longest stable step at the start that is recommended as safe: stretched cloth is stiffer.
const MARGIN: f64 = 0.8;

/// Displacement by untangling beyond which the note asks the user to look at the start state, m.
const FAR: f64 = 0.05;

/// What else is known of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known {
    /// Whether it ended at rest.
    pub is_at_rest: bool,
    /// Whether energy appeared from nowhere.
    pub has_appeared: bool,
}

/// A warning in words.
pub fn of(warning: &warning::Warning, scene: &SceneDesc, known: Known) -> Warning {
    let warning::Warning { code, value, beside, is_doubtful } = *warning;
    let percent_of_moved = 1e2 * value / beside;
    let text = match code {
        Code::Step => step(scene, value, beside),
        Code::Duration => {
            let frames = scene.timing().frames;
            let value = without_noise(value);
            let noun = if frames == 1 { "frame" } else { "frames" };
            format!("duration {value} s is not a whole number of frames: taking {frames} {noun}, {beside:.4} s")
        }
        Code::Thickness => thickness(value, beside),
        Code::Rigidity => format!(
            "hinges bend the cloth up to {value:.1} times as stiffly as asked for, by direction, because its triangles \
             are far from equilateral: give a grid 1.155 x cells[0] x size[1] / size[0] rows in cells[1] and the pattern \
             \"equilateral\", or take a mesh of such triangles"
        ),
        Code::Motion => format!(
            "within a step, a pin or collider is up to {} from the straight and even way that the step takes it, and \
             the cloth does not feel that: take a shorter integrator.step, or an implicit method with integrator.error",
            length(value)
        ),
        Code::Error => format!(
            "integrator.error = {} lets errors of more than 1 % of the smallest cloth's size pass: take {} or less",
            length(value),
            length(beside)
        ),
        Code::Masses => format!(
            "step x (step x stiffness + damping) is {value:.0e} times the mass of a vertex: single precision rounds \
             such masses away, and the cloth may lag by some per cent of its size; compare with --precision f64, or take \
             a shorter step or a softer cloth"
        ),
        Code::Unstable => limit(scene.integrator.method, value, beside),
        Code::Energy => format!(
            "{value:.2e} J of energy appeared from nowhere, {percent_of_moved:.0} % of the largest energy that moved \
             ({beside:.2e} J): {}{}",
            remedy::of_steps(scene),
            rest(scene, known.is_at_rest)
        ),
        Code::Stretch => stretched(scene, value, known.has_appeared),
        Code::Unconverged => {
            let solves = if value == 1.0 { "solve" } else { "solves" };
            format!("{value} {solves} ended above the tolerance: {}", remedy::of_solves(scene))
        }
        Code::Rounding => format!(
            "the cloth moved so far away that its positions are rounded to {:.1} % of an edge: use --precision f64, or \
             begin nearer to where it goes",
            1e2 * value
        ),
        Code::Overlap => format!(
            "moving overlapping surfaces apart gave {value:.2e} J, {percent_of_moved:.0} % of the largest energy that \
             moved: where surfaces overlap again and again, friction acts as by chance; take a shorter \
             integrator.step or a smaller integrator.error, or let surfaces start farther apart than contact.thickness"
        ),
        Code::Method => format!(
            "{} itself took {value:.2e} J, {percent_of_moved:.0} % of the largest energy that moved, beside damping and \
             air: take {} with integrator.error = 0 and a short integrator.step",
            scene.integrator.method.name(),
            if scene.integrator.method == Method::Bdf2 { "bdf2" } else { "bdf2 or implicit-midpoint" }
        ),
        Code::Exceeding => format!(
            "{value} of {beside} substeps exceed integrator.error ({} mm): a substep is at least 1/64 of a step; take a \
             shorter integrator.step, or a larger integrator.error",
            (1e3 * scene.integrator.error().unwrap_or(0.0)) as f32
        ),
        Code::Newton => format!(
            "with integrator.newton = {value} contacts are not solved together with the forces, and friction may be half \
             as strong as it should be: take integrator.newton = 1"
        ),
    };
    Warning { is_doubtful, ..Warning::new(code.name(), text) }
}

/// A step that was changed to divide a frame.
fn step(scene: &SceneDesc, asked: f64, taken: f64) -> String {
    let (n, taken) = (scene.timing().steps_per_frame, 1e3 * taken);
    match asked * scene.frame_rate > 1.0 {
        true => format!("step {} is longer than a frame: taking one step of {taken:.4} ms per frame", time(asked)),
        false => format!("step {} does not divide a frame: taking {n} steps of {taken:.4} ms per frame", time(asked)),
    }
}

/// A thickness that does not suit the mesh: often the reason is a length that is not in metres.
fn thickness(thickness: f64, edge: f64) -> String {
    let beside = format!("contact.thickness = {thickness:?} m with edges of {edge:.1e} m (harmonic mean)");
    match thickness > edge {
        true => format!(
            "{beside}: each vertex has many neighbours within the thickness, so steps are slow or fail; take a \
             thickness well below the edges"
        ),
        false => format!("{beside}: such a thin layer is hard to keep apart, so steps are rejected"),
    }
}

/// A step longer than the longest stable step of an explicit method.
fn limit(method: Method, step: f64, longest: f64) -> String {
    let name = method.name();
    if longest == 0.0 {
        return format!(
            "{name} gains energy in every step without damping; use --set integrator.method=symplectic-euler, or \
             give the cloth damping"
        );
    }
    // Rounded down to two digits.
    let safe = MARGIN * longest;
    let digit = 10f64.powf(safe.log10().floor() - 1.0);
    let safe = (safe / digit).floor() * digit;
    format!(
        "step {} is longer than the limit of {name} at the start of this scene, {}, and stretched cloth lowers the \
         limit: the cloth will fly apart; use --set integrator.step={safe:.1e}, or --set \
         integrator.method=backward-euler",
        time(step),
        time(longest)
    )
}

/// A sentence on the equilibrium of a run that ended at rest. With friction it depends on the motion before it.
fn rest(scene: &SceneDesc, is_at_rest: bool) -> &'static str {
    match (is_at_rest, &scene.contact) {
        (true, None) => {
            ". The run ended at rest, where the forces balance: the motion before it is doubtful, and this state is \
             an equilibrium"
        }
        _ => "",
    }
}

/// Cloth that is stretched too far.
fn stretched(scene: &SceneDesc, most: f64, has_appeared: bool) -> String {
    let shearless = scene.cloth.iter().position(|cloth| {
        cloth.shear.is_none() && cloth.stretch.as_ref().is_some_and(|s| s.model == StretchModel::Membrane)
    });
    let cause = match shearless {
        _ if has_appeared => "energy appeared, so errors of the steps did it".into(),
        Some(cloth) => format!("nothing resists the shear of cloth {cloth}: add [cloth.shear]"),
        None => format!(
            "check density (kg/m^2), stiffness (N/m), the mesh's size (m), the loads and how far pins and colliders \
             pull it; if all are right, {}",
            remedy::of_steps(scene)
        ),
    };
    format!("an edge became {} longer than at rest, more than cloth does: {cause}", percent(most))
}

/// The result of untangling a start state.
pub fn untangled(found: &Untangled) -> String {
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

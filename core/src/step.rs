//! One step in phases, the only place that knows their order:
//!
//! [`predict`] (forces, integrate) -> [`sweep`] (boxes around the motion) -> [`detect`] (candidates
//! and their distances) -> [`respond`] (contacts, impacts), and [`new_crossing`] where surfaces
//! [touch](crate::response::Outcome::Touches) -> [`settle`] -> [`commit`], or nothing at all: a candidate
//! state that is not committed leaves the state as it was. Without contact the phases between the first
//! and the last are left out.

use crate::audit;
use crate::broad_phase::{self, Candidates, Counts};
use crate::contact::{ContactModel, ContactScratch};
use crate::diagnostics;
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;
use crate::integrate::coupling::{self, Hold};
use crate::integrate::{self, IntegratorStatistics, StepInput};
use crate::narrow_phase::{EdgeEdge, VertexTriangle, proximity};
use crate::particles::Particles;
use crate::real::{Real, Sum, Vec3};
use crate::response::coupled;
use crate::response::repulsion::REACH;
use crate::scratch::Scratch;
use crate::stage::Stage;

pub use crate::response::{press, respond};

/// What became of a prediction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prediction {
    /// All candidates are finite.
    Fine,
    /// The first particle whose candidate is NaN or infinite.
    NotFinite {
        /// Its index.
        particle: u32,
    },
}

/// Writes the candidate state to `scratch`. Before the first step [`Pins::set_out`] gives pins the
/// velocities that they start with.
///
/// [`Pins::set_out`]: crate::integrate::pins::Pins::set_out
pub fn predict<D: Dispatch>(
    context: &StepInput<'_, D>,
    particles: &Particles<'_>,
    scratch: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) -> Prediction {
    integrate::advance(context, particles.positions, particles.velocities, scratch, statistics);
    match diagnostics::first_non_finite(scratch.next_positions, scratch.next_velocities) {
        Some(particle) => Prediction::NotFinite { particle },
        None => Prediction::Fine,
    }
}

/// When and how wide to sweep.
#[derive(Clone, Copy, Debug)]
pub struct Sweep {
    /// Start of the step, s.
    pub time: Sum,
    /// Length of the step, s.
    pub step: Real,
    /// m around the motion that the response may use.
    pub margin: Real,
    /// Whether to keep the boxes there are, and only widen them.
    pub widen: bool,
}

/// Writes where everything is at both ends of the step, and the boxes around: half the thickness,
/// the radius and the margin wider than the motion.
pub fn sweep(
    model: &ContactModel<'_>,
    sweep: Sweep,
    positions: &[Vec3],
    next_positions: &[Vec3],
    contact: &mut ContactScratch<'_>,
) {
    let cloth = model.cloth();
    if !sweep.widen {
        contact.start[..cloth].copy_from_slice(positions);
        model.colliders.place(sweep.time, &mut contact.start[cloth..]);
        contact.predicted[..cloth].copy_from_slice(next_positions);
        model.colliders.place(sweep.time + Sum::from(sweep.step), &mut contact.predicted[cloth..]);
        contact.end.copy_from_slice(contact.predicted);
        contact.boxes.fill(Aabb::EMPTY);
        *contact.pressed = [0; 2];
    }
    for (v, around) in contact.boxes.iter_mut().enumerate() {
        let (start, end) = (contact.start[v], contact.end[v]);
        // A hair wider, so that its own rounding loses nothing; that of the corners keeps their order, however far off.
        let wide = (0.5 * model.thickness + model.radii[v] + sweep.margin) * (1.0 + 4.0 * Real::EPSILON);
        let swept = Aabb { min: start.min(end) - wide, max: start.max(end) + wide };
        *around = around.union(&swept);
    }
}

/// [`detect`], or where the host has another place for it, awaited there.
pub async fn await_candidates<D: Dispatch>(
    model: &ContactModel<'_>,
    contact: &mut ContactScratch<'_>,
    dispatch: &D,
) -> Counts {
    dispatch.enter(Stage::BroadPhase);
    let Some(counts) = dispatch.detect(model, contact).await else { return detect(model, contact, dispatch) };
    *contact.counts = counts;
    counts
}

/// Finds the candidates and their distances. Counts above the room there is: nothing was found,
/// come again with more.
pub fn detect(model: &ContactModel<'_>, contact: &mut ContactScratch<'_>, dispatch: &impl Dispatch) -> Counts {
    dispatch.enter(Stage::BroadPhase);
    let mut out =
        Candidates { vertex_triangle: contact.vertex_triangle.candidates, edge_edge: contact.edge_edge.candidates };
    let counts = broad_phase::candidates(contact.boxes, &model.surface, &mut contact.grid, &mut out, dispatch);
    *contact.counts = counts;
    let room = [contact.vertex_triangle.distances.len(), contact.edge_edge.distances.len()];
    if counts.vertex_triangle > room[0] || counts.edge_edge > room[1] {
        return counts;
    }
    dispatch.enter(Stage::NarrowPhase);
    let (reach, surface, x) = (REACH * model.thickness, &model.surface, &*contact.start);
    let pairs = &mut contact.vertex_triangle;
    let (candidates, distances) =
        (&pairs.candidates[..counts.vertex_triangle], &mut pairs.distances[..counts.vertex_triangle]);
    proximity::distances::<VertexTriangle>(candidates, surface, x, model.radii, reach, distances, dispatch);
    let pairs = &mut contact.edge_edge;
    let (candidates, distances) = (&pairs.candidates[..counts.edge_edge], &mut pairs.distances[..counts.edge_edge]);
    proximity::distances::<EdgeEdge>(candidates, surface, x, model.radii, reach, distances, dispatch);
    counts
}

/// Solves the contacts that push together with the cloth; for implicit methods only, and before the
/// response.
pub fn couple<D: Dispatch>(
    context: &StepInput<'_, D>,
    model: &ContactModel<'_>,
    contact: &mut ContactScratch<'_>,
    holds: usize,
    scratch: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let ContactScratch { holds: all, constraints, .. } = contact;
    let release = |holds: &mut [Hold]| coupled::release(model, constraints, holds, context.step);
    coupling::correct(context, &mut all[..holds], scratch, statistics, release);
    contact.predicted[..scratch.next_positions.len()].copy_from_slice(scratch.next_positions);
}

/// An edge and a triangle that pass through one another at the end of the step and did not at its start:
/// then the step must not be taken.
pub fn new_crossing(model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) -> Option<[u32; 2]> {
    audit::new_crossing(&model.surface, contact.start, contact.end, &mut contact.room)
}

/// Takes over what the response corrected: positions, and the velocities by as much, less what only
/// parted surfaces or rounded. Returns whether anything was.
pub fn settle(step: Real, contact: &ContactScratch<'_>, scratch: &mut Scratch<'_>) -> bool {
    let mut any = false;
    for (v, next) in scratch.next_positions.iter_mut().enumerate() {
        if contact.rounds[v] > 0 {
            scratch.next_velocities[v] += (contact.end[v] - *next - contact.parting[v]) / step;
            *next = contact.end[v];
            any = true;
        }
    }
    any
}

/// Makes the candidate the state by exchanging columns; where a history is kept (BDF2), the old
/// state becomes it.
pub fn commit<'a>(particles: &mut Particles<'a>, scratch: &mut Scratch<'a>) {
    core::mem::swap(&mut particles.positions, &mut scratch.next_positions);
    core::mem::swap(&mut particles.velocities, &mut scratch.next_velocities);
    if !scratch.previous_positions.is_empty() {
        core::mem::swap(&mut scratch.previous_positions, &mut scratch.next_positions);
        core::mem::swap(&mut scratch.previous_velocities, &mut scratch.next_velocities);
        scratch.has_history = true;
    }
}

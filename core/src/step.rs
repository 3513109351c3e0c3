//! The phases of one step, in order:
//!
//! [`predict`] (forces, integration) -> [`sweep`] (boxes around the motion) -> [`detect`] (candidates
//! and their distances) -> [`find_contacts`] and [`couple`] (contacts and elasticity, implicit methods
//! only) -> [`find_impacts`] and [`couple_again`] (impacts and elasticity) -> [`respond`] (contacts, impacts) -> [`settle`] -> [`new_crossing`], if surfaces
//! [touch](crate::response::Outcome::Touches) -> [`keep_forces`] and [`commit`].
//!
//! Backward Euler without Newton's method predicts the motion without any force and leaves its one
//! linear solve to [`couple`].
//!
//! A candidate state that is not committed does not change the state. Without contact a step consists
//! of the first and the last phase.

use crate::audit;
use crate::broad_phase::{self, Candidates, Counts};
use crate::contact::{ContactModel, ContactScratch};
use crate::diagnostics;
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;
use crate::integrate::{self, IntegratorStatistics, StepInput, contact_solve};
use crate::narrow_phase::{EdgeEdge, VertexTriangle, proximity};
use crate::particles::Particles;
use crate::real::{Real, Sum, Vec3};
use crate::response::multiplier;
use crate::response::repulsion::REACH;
use crate::scratch::Scratch;
use crate::stage::Stage;

pub use crate::response::{find_contacts, find_impacts, respond};

/// Result of [`predict`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prediction {
    /// The candidate state is finite.
    Fine,
    /// The candidate state of a particle is NaN or infinite.
    NotFinite {
        /// Index of the first particle that is not finite.
        particle: u32,
    },
}

/// Writes the candidate state to `scratch`. Call [`Pins::set_out`] before the first step, to set the
/// initial velocities of pins.
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

/// Parameters of [`sweep`].
#[derive(Clone, Copy, Debug)]
pub struct Sweep {
    /// Start of the step, s.
    pub time: Sum,
    /// Length of the step, s.
    pub step: Real,
    /// Width around the motion within which the response may move vertices, m.
    pub margin: Real,
    /// Whether to keep the stored positions and boxes, and only widen the boxes.
    pub widen: bool,
}

/// Writes the positions of all vertices at both ends of the step, and boxes around their motion, wider
/// on each side by half the thickness, the radius and the margin.
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
        (contact.lengths.constraints, contact.lengths.contacts) = (0, 0);
    }
    for (v, around) in contact.boxes.iter_mut().enumerate() {
        let (start, end) = (contact.start[v], contact.end[v]);
        // The factor makes up for the rounding of the width. The corners are rounded monotonically, so boxes that
        // overlap before rounding also overlap after it, at any distance from the origin.
        let wide = (0.5 * model.thickness + model.radii[v] + sweep.margin) * (1.0 + 4.0 * Real::EPSILON);
        let swept = Aabb { min: start.min(end) - wide, max: start.max(end) + wide };
        *around = around.union(&swept);
    }
}

/// Finds the candidates and their distances: awaits [`Dispatch::detect`], or calls [`detect`] if the host
/// does not provide it.
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

/// Finds the candidates and their distances. If the returned counts exceed the capacity, the result is
/// incomplete: the caller must grow the columns and call again.
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

/// Solves the step together with its contacts. Only for implicit methods, between [`find_contacts`] and [`respond`];
/// required by [`StepInput::defers_solve`]. Returns where the solve stopped, for [`couple_again`].
pub fn couple<D: Dispatch>(
    context: &StepInput<'_, D>,
    particles: &Particles<'_>,
    contact: &mut ContactScratch<'_>,
    scratch: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) -> Option<Sum> {
    let contacts = &mut contact.contacts[..contact.lengths.contacts];
    let state = [&*particles.positions, &*particles.velocities];
    let target = contact_solve::correct(context, state, (contacts, contact.lines), scratch, statistics);
    contact.predicted[..scratch.next_positions.len()].copy_from_slice(scratch.next_positions);
    target
}

/// Goes on with the solve of [`couple`], which returned `target`, after [`find_impacts`] has added contacts to the first
/// `known` ones.
pub fn couple_again<D: Dispatch>(
    context: &StepInput<'_, D>,
    (known, target): (usize, Option<Sum>),
    contact: &mut ContactScratch<'_>,
    scratch: &mut Scratch<'_>,
    statistics: &mut IntegratorStatistics,
) {
    let contacts = &mut contact.contacts[..contact.lengths.contacts];
    contact_solve::resume(context, (contacts, contact.lines), known, target, scratch, statistics);
    contact.predicted[..scratch.next_positions.len()].copy_from_slice(scratch.next_positions);
}

/// Keeps the forces of the contacts of an accepted step, from which the next one starts. `step` is its length, s.
pub fn keep_forces(step: Real, contact: &mut ContactScratch<'_>) {
    let constraints = &contact.constraints[..contact.lengths.constraints];
    contact.lengths.multipliers = multiplier::write(constraints, step, contact.order, contact.multipliers);
}

/// Returns an edge and a triangle that cross at the end of the step but not at its start. If there is a
/// pair like this, the step must be rejected.
pub fn new_crossing(model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) -> Option<[u32; 2]> {
    audit::new_crossing(&model.surface, contact.start, contact.end, &mut contact.room)
}

/// Copies the positions that the response corrected. The velocities change by the correction over `step`,
/// without the part that only separates surfaces or rounds. Returns whether any vertex was corrected.
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

/// Makes the candidate the state by exchanging columns. For a method with history (BDF2) the old state
/// becomes the history.
pub fn commit<'a>(particles: &mut Particles<'a>, scratch: &mut Scratch<'a>) {
    core::mem::swap(&mut particles.positions, &mut scratch.next_positions);
    core::mem::swap(&mut particles.velocities, &mut scratch.next_velocities);
    if !scratch.previous_positions.is_empty() {
        core::mem::swap(&mut scratch.previous_positions, &mut scratch.next_positions);
        core::mem::swap(&mut scratch.previous_velocities, &mut scratch.next_velocities);
        scratch.has_history = true;
    }
}

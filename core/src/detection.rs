//! Finds the pairs of features that may touch in a step: boxes around the motion, [candidates](crate::broad_phase), and
//! their [distances](crate::narrow_phase::proximity) at the start of the step.
//!
//! In a [quiet](is_quiet) step the boxes surround the start, and most of the pairs found
//! [last](crate::broad_phase::kept_pairs) from step to step.

use crate::broad_phase::{self, Candidates, Counts};
use crate::contact::{ContactModel, ContactRoom, ContactScratch};
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;
use crate::narrow_phase::advance::ROUNDING;
use crate::narrow_phase::{EdgeEdge, VertexTriangle, proximity};
use crate::real::{Real, Sum, Vec3, sqrt};
use crate::refusal::Cause;
use crate::response::repulsion::REACH;
use crate::stage::Stage;

/// In a [quiet](is_quiet) step no vertex moves farther than this along an axis, relative to the thickness. It leaves
/// as much for the response.
const QUIET: Real = 0.25;

/// Skin of the boxes for which pairs are kept, relative to the thickness.
const SKIN: Real = 0.05;

/// How much wider than needed the boxes of a quiet step are, relative to the thickness.
const WIDER: Real = 0.01;

/// Largest error of a distance in a quiet step, relative to the thickness.
const MOST_ROUNDED: Real = 0.1;

/// Limit of candidates of each kind in a small scene.
const MOST_PAIRS: usize = 1 << 17;

/// Limit of candidates of each kind per vertex in a larger scene. Sheets that lie flat on themselves have a tenth of it.
const MOST_PAIRS_PER_VERTEX: usize = 1 << 10;

/// Limit in the search of a quiet step, which finds more pairs than it keeps, relative to the limit otherwise.
const QUIET_ROOM: usize = 4;

/// Limit of candidates of each kind.
pub fn most_pairs(model: &ContactModel<'_>) -> usize {
    MOST_PAIRS.max(MOST_PAIRS_PER_VERTEX * model.radii.len())
}

/// Writes the boxes around the motion, the wider the more often the step was `widened`, and finds the candidates and their
/// distances. Asks `columns` for room where there is too little.
pub async fn search<D: Dispatch>(
    model: &ContactModel<'_>,
    widened: u32,
    columns: &mut impl ContactRoom,
    dispatch: &D,
) -> Result<Counts, Cause> {
    let contact = &mut columns.columns();
    if widened == 0 && is_quiet(model, contact) {
        surround_start(model, contact);
    } else {
        sweep(model, 0.5 * model.thickness * (1 << widened) as Real, contact);
    }
    let counts = await_candidates(model, contact, dispatch).await;
    let limit = if contact.lengths.is_quiet { QUIET_ROOM } else { 1 } * most_pairs(model);
    let (has_room, pairs) = (contact.has_room(counts), counts.vertex_triangle.max(counts.edge_edge));
    if pairs > limit {
        return Err(Cause::TooMuch);
    }
    columns.grow_kept();
    if has_room {
        return Ok(counts);
    }
    if !columns.grow_pairs(counts) {
        return Err(Cause::Short { pairs, constraints: 0 });
    }
    Ok(await_candidates(model, &mut columns.columns(), dispatch).await)
}

/// Writes the positions of all vertices at both ends of a step that starts at `time` and takes `step`, s.
pub fn place(
    model: &ContactModel<'_>,
    [time, step]: [Sum; 2],
    positions: &[Vec3],
    next_positions: &[Vec3],
    contact: &mut ContactScratch<'_>,
) {
    let cloth = model.cloth();
    contact.start[..cloth].copy_from_slice(positions);
    model.colliders.place(time, &mut contact.start[cloth..]);
    contact.predicted[..cloth].copy_from_slice(next_positions);
    model.colliders.place(time + step, &mut contact.predicted[cloth..]);
    contact.end.copy_from_slice(contact.predicted);
    contact.boxes.fill(Aabb::EMPTY);
    contact.lengths.is_quiet = false;
    (contact.lengths.constraints, contact.lengths.contacts) = (0, 0);
}

/// Whether no vertex moves far in the step, and none is so far from the origin, or so large, that rounding could matter.
/// Then the candidates can be limited to the pairs within [`REACH`] at its start, most of which
/// [last](broad_phase::kept_pairs) from step to step.
pub fn is_quiet(model: &ContactModel<'_>, contact: &ContactScratch<'_>) -> bool {
    let mut motion = contact.start.iter().zip(&*contact.predicted);
    motion.all(|(&start, &end)| (end - start).abs().max_element() <= QUIET * model.thickness)
        && rounding(model, contact.start) <= MOST_ROUNDED * model.thickness
}

/// Bound of the errors of distances and of the corners of boxes, m.
fn rounding(model: &ContactModel<'_>, positions: &[Vec3]) -> Real {
    let vertices = positions.iter().zip(model.radii);
    let largest = vertices.fold(0.0, |largest: Real, (x, radius)| largest.max(x.abs().max_element() + radius));
    // Coordinates relative to another vertex are at most twice as large.
    2.0 * ROUNDING * largest
}

/// Writes the boxes of a quiet step: around the start, wider on each side by half of [`REACH`] and the radius. Pairs
/// beyond reach cannot collide as long as no vertex leaves its box. Each of the two features moves by at most 0.51
/// thicknesses along each axis. That brings them nearer by 2 sqrt(3) 0.51 < 1.77 thicknesses, less than reach without the
/// distance at which they collide and the reserve for rounding.
pub fn surround_start(model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) {
    contact.lengths.is_quiet = true;
    for ((around, &start), &radius) in contact.boxes.iter_mut().zip(&*contact.start).zip(model.radii) {
        let wide = 0.5 * REACH * model.thickness * (1.0 + WIDER) + radius * (1.0 + 4.0 * Real::EPSILON);
        *around = Aabb { min: start - wide, max: start + wide };
    }
}

/// Widens the boxes by boxes around the motion of all vertices, wider on each side by half the thickness, the radius and
/// the `margin` within which the response may move vertices, m.
pub fn sweep(model: &ContactModel<'_>, margin: Real, contact: &mut ContactScratch<'_>) {
    contact.lengths.is_quiet = false;
    for (v, around) in contact.boxes.iter_mut().enumerate() {
        let (start, end) = (contact.start[v], contact.end[v]);
        // The factor makes up for the rounding of the width. The corners are rounded monotonically, so boxes that
        // overlap before rounding also overlap after it, at any distance from the origin.
        let wide = (0.5 * model.thickness + model.radii[v] + margin) * (1.0 + 4.0 * Real::EPSILON);
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
    if contact.lengths.is_quiet && contact.has_room(counts) {
        drop_far(REACH * model.thickness, contact);
    }
    *contact.counts
}

/// Finds the candidates and their distances. If the returned counts exceed the capacity, the result is
/// incomplete: the caller must grow the columns and call again.
pub fn detect(model: &ContactModel<'_>, contact: &mut ContactScratch<'_>, dispatch: &impl Dispatch) -> Counts {
    dispatch.enter(Stage::BroadPhase);
    if contact.lengths.is_quiet {
        return detect_quiet(model, contact, dispatch);
    }
    let mut out =
        Candidates { vertex_triangle: contact.vertex_triangle.candidates, edge_edge: contact.edge_edge.candidates };
    let counts = broad_phase::candidates(contact.boxes, &model.surface, &mut contact.grid, &mut out, dispatch);
    *contact.counts = counts;
    if contact.has_room(counts) {
        measure(model, REACH * model.thickness, contact, dispatch);
    }
    counts
}

/// [`detect`] for a quiet step: the candidates are all pairs within [`REACH`] at its start.
fn detect_quiet(model: &ContactModel<'_>, contact: &mut ContactScratch<'_>, dispatch: &impl Dispatch) -> Counts {
    let (reach, skin) = (REACH * model.thickness, SKIN * model.thickness);
    // Each of two features moves by at most the diagonal of the skin before a wide box is left. Distances up to here are
    // measured, not bounded: whether a pair is within reach must not depend on the pairs that were kept.
    let far = reach + 2.0 * (sqrt(3.0) * skin + rounding(model, contact.start));
    let ContactScratch { vertex_triangle, edge_edge, kept, .. } = contact;
    let mut out = Candidates { vertex_triangle: vertex_triangle.candidates, edge_edge: edge_edge.candidates };
    if kept.cover(contact.boxes) {
        *contact.counts = kept.take(&mut out);
        if !contact.has_room(*contact.counts) {
            return *contact.counts;
        }
        measure(model, far, contact, dispatch);
    } else {
        kept.widen(contact.boxes, skin);
        let counts = broad_phase::candidates(kept.boxes, &model.surface, &mut contact.grid, &mut out, dispatch);
        *contact.counts = counts;
        if !contact.has_room(counts) {
            return counts;
        }
        measure(model, far, contact, dispatch);
        drop_far(far, contact);
        let Counts { vertex_triangle, edge_edge } = *contact.counts;
        let pairs =
            [&contact.vertex_triangle.candidates[..vertex_triangle], &contact.edge_edge.candidates[..edge_edge]];
        contact.kept.put(pairs);
    }
    drop_far(reach, contact);
    *contact.counts
}

/// Writes the distances of the candidates at the start of the step; beyond `reach`, a lower bound.
fn measure(model: &ContactModel<'_>, reach: Real, contact: &mut ContactScratch<'_>, dispatch: &impl Dispatch) {
    dispatch.enter(Stage::NarrowPhase);
    let (counts, surface, x) = (*contact.counts, &model.surface, &*contact.start);
    let pairs = &mut contact.vertex_triangle;
    let (candidates, distances) =
        (&pairs.candidates[..counts.vertex_triangle], &mut pairs.distances[..counts.vertex_triangle]);
    proximity::distances::<VertexTriangle>(candidates, surface, x, model.radii, reach, distances, dispatch);
    let pairs = &mut contact.edge_edge;
    let (candidates, distances) = (&pairs.candidates[..counts.edge_edge], &mut pairs.distances[..counts.edge_edge]);
    proximity::distances::<EdgeEdge>(candidates, surface, x, model.radii, reach, distances, dispatch);
}

/// Drops the candidates that are farther apart than `reach`, m.
fn drop_far(reach: Real, contact: &mut ContactScratch<'_>) {
    let Counts { vertex_triangle, edge_edge } = &mut *contact.counts;
    *vertex_triangle = proximity::drop_far(&mut contact.vertex_triangle, *vertex_triangle, reach);
    *edge_edge = proximity::drop_far(&mut contact.edge_edge, *edge_edge, reach);
}

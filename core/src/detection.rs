//! Finds the pairs of features that may touch in a step: boxes, [candidates](crate::broad_phase), and their
//! [distances](crate::narrow_phase::proximity) at the start of the step.
//!
//! [`search`] finds the pairs that may touch in a motion. If the cloth is slow, the motion may end anywhere in the
//! boxes around it: what stops on the way needs no second search. If it is fast, these boxes would overlap many others.
//! Then the motion must end near its predicted end, so that [neighbours that move
//! together](crate::broad_phase::comoving) do not overlap.
//!
//! An implicit step needs only the pairs that are near at its start before it is solved, and the others afterwards,
//! around the motion of the solve. Near pairs are often among those that the last search
//! [kept](crate::broad_phase::kept_pairs). In a [quiet](is_quiet) step no other pairs can touch.

use crate::broad_phase::comoving::Motion;
use crate::broad_phase::{self, Candidates, Counts};
use crate::column::Column;
use crate::contact::{ContactModel, ContactRoom, ContactScratch, Searched};
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;
use crate::narrow_phase::advance::ROUNDING;
use crate::narrow_phase::{EdgeEdge, VertexTriangle, proximity, slab};
use crate::real::{Real, Sum, Vec3, sqrt};
use crate::refusal::Cause;
use crate::response::repulsion::REACH;
use crate::scratch::MAY_BE_LEAN;
use crate::stage::Stage;

/// In a [quiet](is_quiet) step no vertex moves farther than this along an axis, relative to the thickness. It leaves
/// as much for the response.
const QUIET: Real = 0.25;

/// Skin of the boxes for which pairs are kept, relative to the thickness.
const SKIN: Real = 0.05;

/// How much wider than needed the boxes around the start are, relative to the thickness.
const WIDER: Real = 0.01;

/// Skin of the boxes in which a motion may end, relative to the thickness: how far the response may move vertices
/// before the near pairs of the next step must be searched anew.
const END_SKIN: Real = 0.15;

/// The cloth is fast if its vertices move farther than this on average, relative to the mean edge.
const FAST: Real = 0.25;

/// Half width of the boxes around the start, relative to the thickness. Boxes of near pairs overlap.
const START: Real = 0.5 * REACH + WIDER;

/// Largest error of a distance in a quiet step, and of a box in a comoving search, relative to the thickness.
const MOST_ROUNDED: Real = 0.1;

/// Limit of candidates of each kind in a small scene.
const MOST_PAIRS: usize = 1 << 17;

/// Limit of candidates of each kind per vertex in a larger scene. Sheets that lie flat on themselves have a tenth of
/// it.
const MOST_PAIRS_PER_VERTEX: usize = 1 << 10;

/// Limit in the search for near pairs, which finds more pairs than it keeps, relative to the limit otherwise.
const NEAR_ROOM: usize = 4;

/// Limit of candidates of each kind.
pub fn most_pairs(model: &ContactModel<'_>) -> usize {
    MOST_PAIRS.max(MOST_PAIRS_PER_VERTEX * model.radii.len())
}

/// The purpose of a search.
#[derive(Clone, Copy, Debug)]
pub enum Purpose {
    /// The solve of an implicit step, which needs the pairs that are near at its start. Where the cloth is slow, all
    /// pairs that may touch in the predicted motion are found, because that of the solve will hardly differ.
    Solve,
    /// The response, which needs all pairs that may touch in the motion. The more often the step was widened, the wider
    /// are the boxes.
    Response {
        /// How often.
        widened: u32,
    },
}

/// Finds the pairs that may touch in the motion from start to end, and their distances, if they are not the candidates
/// already. Asks `columns` for room where there is too little.
pub fn search(
    model: &ContactModel<'_>,
    purpose: Purpose,
    columns: &mut impl ContactRoom,
    dispatch: &impl Dispatch,
) -> Result<Counts, Cause> {
    dispatch.enter(Stage::BroadPhase);
    if !surround(model, purpose, &mut columns.columns()) {
        return Ok(*columns.columns().counts);
    }
    loop {
        let counts = detect(model, &mut columns.columns(), dispatch).ok_or(Cause::Stopped)?;
        if had_room(model, counts, columns)? {
            return Ok(counts);
        }
    }
}

/// [`search`], but awaits candidates that are found elsewhere ([`Dispatch::detect`]).
pub async fn await_search<D: Dispatch>(
    model: &ContactModel<'_>,
    purpose: Purpose,
    columns: &mut impl ContactRoom,
    dispatch: &D,
) -> Result<Counts, Cause> {
    dispatch.enter(Stage::BroadPhase);
    if !surround(model, purpose, &mut columns.columns()) {
        return Ok(*columns.columns().counts);
    }
    loop {
        let counts = await_candidates(model, &mut columns.columns(), dispatch).await.ok_or(Cause::Stopped)?;
        if had_room(model, counts, columns)? {
            return Ok(counts);
        }
    }
}

/// Whether there was room for all candidates. If not, there is now.
fn had_room(model: &ContactModel<'_>, counts: Counts, columns: &mut impl ContactRoom) -> Result<bool, Cause> {
    let contact = &columns.columns();
    let (has_room, pairs) = (contact.has_room(counts), counts.vertex_triangle.max(counts.edge_edge));
    if pairs > if *contact.searched == Searched::Near { NEAR_ROOM } else { 1 } * most_pairs(model) {
        return Err(Cause::TooMuch);
    }
    columns.grow_kept();
    if !has_room && !columns.grow_pairs(counts) {
        return Err(Cause::Short { pairs, constraints: 0 });
    }
    Ok(has_room)
}

/// Writes the boxes of a search. Returns false if the candidates already suffice.
#[inline(never)]
#[cfg_attr(small, optimize(size))]
fn surround(model: &ContactModel<'_>, purpose: Purpose, contact: &mut ContactScratch<'_>) -> bool {
    let searched = *contact.searched;
    let (widened, for_solve) = match purpose {
        Purpose::Solve => (0, true),
        Purpose::Response { widened } => (widened, false),
    };
    if widened == 0
        && matches!(searched, Searched::Swept | Searched::Comoving)
        && (contact.end.iter().enumerate()).all(|(v, &end)| may_end(model, contact.ends, v, end))
    {
        return false;
    }
    let is_fast = is_fast(model, contact);
    if widened == 0 {
        if is_quiet(model, contact) || for_solve && is_fast {
            surround_start(model, contact);
            return searched != Searched::Near;
        }
        contact.ends.fill(Aabb::EMPTY);
    }
    let ends_anywhere = searched == Searched::Nothing && !is_fast;
    let margin = if ends_anywhere { 0.5 } else { START - 0.5 + END_SKIN };
    sweep(model, margin * model.thickness * (1 << widened) as Real, contact);
    if ends_anywhere {
        contact.ends.copy_from(contact.boxes);
        *contact.searched = Searched::Swept;
    }
    leave_out(model, contact.boxes);
    true
}

/// Writes the positions of all vertices at both ends of a step that starts at `time` and takes `step`, s, and how
/// colliders turn in it.
pub fn place(
    model: &ContactModel<'_>,
    [time, step]: [Sum; 2],
    positions: &[Vec3],
    next_positions: &[Vec3],
    contact: &mut ContactScratch<'_>,
) {
    let cloth = model.cloth();
    contact.start.part_mut(..cloth).copy_from(positions);
    model.colliders.place(time, contact.start.part_mut(cloth..));
    contact.end.part_mut(..cloth).copy_from(next_positions);
    model.colliders.place(time + step, contact.end.part_mut(cloth..));
    for (turn, body) in contact.turns.iter_mut().zip(model.colliders.bodies) {
        *turn = body.turns([time, step]);
    }
    let ends = contact.start.iter().zip(&*contact.end);
    for (displacement, (&start, &end)) in contact.displacements.iter_mut().zip(ends) {
        *displacement = end - start;
    }
    contact.ends.fill(Aabb::EMPTY);
    *contact.searched = Searched::Nothing;
    (contact.lengths.constraints, contact.lengths.contacts) = (0, 0);
}

/// Takes the boxes of colliders that are switched off away. A box that is empty overlaps nothing.
fn leave_out(model: &ContactModel<'_>, boxes: &mut [Aabb]) {
    let cloth = model.cloth();
    for body in model.colliders.bodies.iter().filter(|body| body.is_off()) {
        boxes.part_mut(cloth..).part_mut(body.range()).fill(Aabb::EMPTY);
    }
}

/// Whether no vertex moves far in the step, and none is so far from the origin, or so large, that rounding could
/// matter. Then the candidates can be limited to the pairs within [`REACH`] at its start, most of which
/// [last](broad_phase::kept_pairs) from step to step.
pub fn is_quiet(model: &ContactModel<'_>, contact: &ContactScratch<'_>) -> bool {
    let mut motion = contact.start.iter().zip(&*contact.end);
    motion.all(|(&start, &end)| (end - start).abs().max_element() <= QUIET * model.thickness)
        && rounding(model, contact.start) <= MOST_ROUNDED * model.thickness
}

/// Whether the vertices of the cloth move so far that boxes around their motion would overlap many others.
fn is_fast(model: &ContactModel<'_>, contact: &ContactScratch<'_>) -> bool {
    let cloth = model.cloth();
    let (start, end) = (contact.start.part(..cloth), contact.end.part(..cloth));
    let moved: Real = (start.iter().zip(end)).map(|(&start, &end)| (end - start).abs().max_element()).sum();
    let edges = model.surface.edges.iter().filter(|edge| edge[0].max(edge[1]) < cloth as u32);
    let (long, count) = edges.fold((0.0, 0), |(long, count), edge| {
        let [a, b] = start.gather(edge);
        (long + (b - a).abs().max_element(), count + 1)
    });
    moved * count as Real > FAST * long * cloth as Real
}

/// Whether a vertex that ends at `end` stays in its end box.
pub fn may_end(model: &ContactModel<'_>, ends: &[Aabb], v: usize, end: Vec3) -> bool {
    let wide = 0.5 * model.thickness + model.radii.at(v);
    ends.at(v).contains(&Aabb { min: end - wide, max: end + wide })
}

/// Bound of the errors of distances and of the corners of boxes, m.
fn rounding(model: &ContactModel<'_>, positions: &[Vec3]) -> Real {
    let vertices = positions.iter().zip(model.radii);
    let largest = vertices.fold(0.0, |largest: Real, (x, radius)| largest.max(x.abs().max_element() + radius));
    // Coordinates relative to another vertex are at most twice as large.
    2.0 * ROUNDING * largest
}

/// Writes the boxes of a search for near pairs: around the start, wider on each side by half of [`REACH`] and the
/// radius.
///
/// In a quiet step, pairs beyond reach cannot collide as long as no vertex leaves its box. Each of the two features
/// moves by at most 0.51 thicknesses along each axis. That brings them nearer by 2 sqrt(3) 0.51 < 1.77 thicknesses,
/// less than reach without the distance at which they collide and the reserve for rounding.
#[cfg_attr(small, optimize(size))]
pub fn surround_start(model: &ContactModel<'_>, contact: &mut ContactScratch<'_>) {
    *contact.searched = Searched::Near;
    for ((around, &start), radius) in contact.boxes.iter_mut().zip(&*contact.start).zip(model.radii) {
        let wide = START * model.thickness + radius * (1.0 + 4.0 * Real::EPSILON);
        *around = Aabb { min: start - wide, max: start + wide };
    }
    contact.ends.copy_from(contact.boxes);
    leave_out(model, contact.boxes);
}

/// Writes the boxes around the motion. It may end within boxes that are wider on each side by half the thickness, the
/// radius and the `margin` within which the response may move vertices, m. Those of an earlier motion in the same step
/// are kept.
#[cfg_attr(small, optimize(size))]
pub fn sweep(model: &ContactModel<'_>, margin: Real, contact: &mut ContactScratch<'_>) {
    let rounding = motion(model, contact.start, contact.end, contact.ends).rounding;
    let is_rounded_little = rounding <= MOST_ROUNDED * model.thickness;
    *contact.searched = if is_rounded_little { Searched::Comoving } else { Searched::Swept };
    let motion = contact.start.iter().zip(&*contact.end).zip(model.radii);
    let boxes = contact.boxes.iter_mut().zip(&mut *contact.ends);
    for ((around, ends), ((&start, &end), radius)) in boxes.zip(motion) {
        // The factor makes up for the rounding of the width. The corners are rounded monotonically, so boxes that
        // overlap before rounding also overlap after it, at any distance from the origin.
        let wide = |margin: Real| (margin + radius) * (1.0 + 4.0 * Real::EPSILON);
        let (before, after) = (wide(START * model.thickness), wide(0.5 * model.thickness + margin));
        *ends = ends.union(&Aabb { min: end - after, max: end + after });
        *around = ends.union(&Aabb { min: start - before, max: start + before });
    }
}

/// Finds the candidates and their distances: awaits [`Dispatch::detect`], or calls [`detect`] if the host
/// does not provide it. `None` if the host stopped the search.
pub async fn await_candidates<D: Dispatch>(
    model: &ContactModel<'_>,
    contact: &mut ContactScratch<'_>,
    dispatch: &D,
) -> Option<Counts> {
    dispatch.enter(Stage::BroadPhase);
    let lasts = lasts(contact);
    if !lasts && let Some(counts) = dispatch.detect(model, contact).await {
        contact.kept.widen(contact.ends, 0.0);
        *contact.counts = counts;
        return Some(narrow(model, contact, true, dispatch));
    }
    detect(model, contact, dispatch)
}

/// Finds the candidates and their distances. If the returned counts exceed the capacity, the result is
/// incomplete: the caller must grow the columns and call again. `None` if the host stopped the search.
pub fn detect(model: &ContactModel<'_>, contact: &mut ContactScratch<'_>, dispatch: &impl Dispatch) -> Option<Counts> {
    dispatch.enter(Stage::BroadPhase);
    let lasts = lasts(contact);
    let ContactScratch { start, end, ends, boxes, searched, vertex_triangle, edge_edge, grid, kept, .. } = contact;
    let motion = motion(model, start, end, ends);
    let motion = (**searched == Searched::Comoving).then_some(&motion);
    let mut out = Candidates { vertex_triangle: vertex_triangle.candidates, edge_edge: edge_edge.candidates };
    *contact.counts = if lasts {
        kept.take(&mut out)
    } else if **searched == Searched::Near {
        kept.widen(boxes, SKIN * model.thickness);
        let wide: &[Aabb] = if MAY_BE_LEAN && kept.boxes.is_empty() { boxes } else { kept.boxes };
        broad_phase::candidates(wide, &model.surface, grid, None, &mut out, dispatch)?
    } else {
        kept.widen(ends, 0.0);
        broad_phase::candidates(boxes, &model.surface, grid, motion, &mut out, dispatch)?
    };
    Some(narrow(model, contact, !lasts, dispatch))
}

/// Measures the candidates, if there is room for all. Of `new` ones, drops those that stay apart, and keeps the others
/// for the next step. Slow cloth searches around its prediction in the next step, or finds less if that is quiet: it
/// keeps none.
fn narrow(model: &ContactModel<'_>, contact: &mut ContactScratch<'_>, new: bool, dispatch: &impl Dispatch) -> Counts {
    if !contact.has_room(*contact.counts) {
        return *contact.counts;
    }
    dispatch.enter(Stage::NarrowPhase);
    let (reach, is_near) = (REACH * model.thickness, *contact.searched == Searched::Near);
    // Each of two features moves by at most the diagonal of the skin before a wide box is left. Distances up to here
    // are measured, not bounded: whether a pair is within reach must not depend on the pairs that were kept.
    let skin = if is_near { SKIN * model.thickness } else { 0.0 };
    let far = 2.0 * (START * model.thickness + sqrt(3.0) * skin);
    if new {
        drop_apart(model, far, contact, dispatch);
    }
    measure(model, if is_near { far } else { reach }, contact, dispatch);
    if is_near {
        drop_far(far, contact);
    }
    if new && *contact.searched != Searched::Swept {
        let Counts { vertex_triangle, edge_edge } = *contact.counts;
        let pairs = [
            contact.vertex_triangle.candidates.part(..vertex_triangle),
            contact.edge_edge.candidates.part(..edge_edge),
        ];
        contact.kept.put(pairs);
    }
    if is_near {
        drop_far(reach, contact);
    }
    *contact.open = *contact.counts;
    *contact.counts
}

/// The motion between the boxes around the start and those in which it may end.
fn motion<'a>(model: &ContactModel<'a>, start: &'a [Vec3], end: &[Vec3], ends: &'a [Aabb]) -> Motion<'a> {
    let rounding = rounding(model, start) + rounding(model, end);
    Motion { start, radii: model.radii, margin: START * model.thickness, ends, rounding }
}

/// Whether the near pairs are among those that were kept.
fn lasts(contact: &ContactScratch<'_>) -> bool {
    *contact.searched == Searched::Near && contact.kept.cover(contact.boxes)
}

/// Drops the candidates that stay farther apart than `far` while each vertex moves to its end box, m. If `far` is twice
/// the half width of the boxes around the start, they are not near at either end. They do not collide either. The bound
/// assumes that 1.01 thicknesses of the end box lie around a vertex, but the response leaves only 0.5. So a vertex may
/// end farther from the middle of its box, by 0.51 thicknesses along each axis. That brings two features nearer by 2
/// sqrt(3) 0.51 < 1.77 thicknesses, and `far` is 2.02.
fn drop_apart(model: &ContactModel<'_>, far: Real, contact: &mut ContactScratch<'_>, dispatch: &impl Dispatch) {
    let motion = motion(model, contact.start, contact.end, contact.ends);
    let counts = *contact.counts;
    let pairs = &mut contact.vertex_triangle;
    let (candidates, bounds) =
        (pairs.candidates.part(..counts.vertex_triangle), pairs.distances.part_mut(..counts.vertex_triangle));
    slab::bounds::<VertexTriangle>(candidates, &model.surface, &motion, bounds, dispatch);
    let pairs = &mut contact.edge_edge;
    let (candidates, bounds) =
        (pairs.candidates.part(..counts.edge_edge), pairs.distances.part_mut(..counts.edge_edge));
    slab::bounds::<EdgeEdge>(candidates, &model.surface, &motion, bounds, dispatch);
    let rounding = motion.rounding;
    drop_far(far + rounding, contact);
}

/// Writes the distances of the candidates at the start of the step; beyond `reach`, a lower bound.
fn measure(model: &ContactModel<'_>, reach: Real, contact: &mut ContactScratch<'_>, dispatch: &impl Dispatch) {
    let (counts, surface, x) = (*contact.counts, &model.surface, &*contact.start);
    let pairs = &mut contact.vertex_triangle;
    let (candidates, distances) =
        (pairs.candidates.part(..counts.vertex_triangle), pairs.distances.part_mut(..counts.vertex_triangle));
    proximity::distances::<VertexTriangle>(candidates, surface, x, model.radii, reach, distances, dispatch);
    let pairs = &mut contact.edge_edge;
    let (candidates, distances) =
        (pairs.candidates.part(..counts.edge_edge), pairs.distances.part_mut(..counts.edge_edge));
    proximity::distances::<EdgeEdge>(candidates, surface, x, model.radii, reach, distances, dispatch);
}

/// Drops the candidates that are farther apart than `reach`, m.
fn drop_far(reach: Real, contact: &mut ContactScratch<'_>) {
    let Counts { vertex_triangle, edge_edge } = &mut *contact.counts;
    *vertex_triangle = proximity::drop_far(&mut contact.vertex_triangle, *vertex_triangle, reach);
    *edge_edge = proximity::drop_far(&mut contact.edge_edge, *edge_edge, reach);
}

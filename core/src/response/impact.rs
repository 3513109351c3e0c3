//! Impacts: pairs that collide during a step. Each gives a constraint at the place and along the direction of the
//! impact: the pair must end no nearer than it began, or no nearer than the thickness. Inelastic [Bridson 2002].

use super::constraint;
use super::repulsion::{self, least_at_rest};
use super::work::{List, Motion, Work, relax};
use crate::broad_phase::Counts;
use crate::column::Column;
use crate::contact::{ContactModel, Pairs};
use crate::dispatch::Dispatch;
use crate::narrow_phase::time_of_impact::TimeOfImpact;
use crate::narrow_phase::{Kind, Pairing, contact, continuous, gather, with_pairing};
use crate::real::{Real, Vec3};
use crate::stage::Stage;

/// Sweeps in a round.
const SWEEPS: u32 = 5;

/// Largest displacement of a vertex relative to that of the contact. It is large, because nothing may pass through.
pub const MOST_LEVER_RATIO: Real = 100.0;

/// Distance at which two features collide, relative to the thickness.
pub const SEPARATION: Real = 0.1;

/// Adds a constraint for each pair that collides, and for each vertex that collides with a plane. Only pairs with a
/// vertex of the [tested](Motion::tested) round count. Returns the number of constraints; if there is no room for them,
/// as an error.
pub(crate) fn find<D: Dispatch>(
    model: &ContactModel<'_>,
    [vertex_triangle, edge_edge]: &mut [&mut Pairs<'_>; 2],
    counts: &Counts,
    motion: &Motion<'_>,
    list: &mut List<'_>,
    dispatch: &D,
) -> Result<usize, usize> {
    if model.continuous {
        find_pairs(Kind::VertexTriangle, model, vertex_triangle, counts.vertex_triangle, motion, list, dispatch);
        find_pairs(Kind::EdgeEdge, model, edge_edge, counts.edge_edge, motion, list, dispatch);
    }
    let least = |gap| repulsion::least_gap(gap, model.thickness);
    repulsion::find_planes(model, motion, least, &repulsion::Known::nothing(), list);
    list.count()
}

#[cfg_attr(small, inline(never))]
fn find_pairs<D: Dispatch>(
    kind: Kind,
    model: &ContactModel<'_>,
    pairs: &mut Pairs<'_>,
    count: usize,
    motion: &Motion<'_>,
    list: &mut List<'_>,
    dispatch: &D,
) {
    let (candidates, times) = (pairs.candidates.part(..count), pairs.times.part_mut(..count));
    let Motion { start, end, rounds, .. } = motion;
    let swept = continuous::LinearMotion { start, end, radii: model.radii, rounds, round: motion.tested() };
    let separation = SEPARATION * model.thickness;
    dispatch.enter(Stage::NarrowPhase);
    with_pairing!(kind, P => {
        continuous::times::<P>(candidates, pairs.distances, &model.surface, swept, separation, times, dispatch);
    });
    dispatch.enter(Stage::Response);
    let first = list.count;
    for (&candidate, &time) in candidates.iter().zip(&*times) {
        // Features that touch collide where they start.
        let (touch, time) = match time.into() {
            TimeOfImpact::Never => continue,
            TimeOfImpact::At(time) => (false, Some(time)),
            TimeOfImpact::Touching => (true, None),
        };
        let vertices = with_pairing!(kind, P => P::vertices(&model.surface, candidate));
        let (x, ends) = (gather(vertices, start), gather(vertices, end));
        let radius = with_pairing!(kind, P => P::radius(gather(vertices, model.radii)));
        let at = time.map_or(x, |time| between(x, &ends, time));
        let (Some(impact), Some(before)) =
            (contact(kind, vertices, &at, &x, radius), contact(kind, vertices, &x, &x, radius))
        else {
            list.touching += 1;
            continue;
        };
        list.touching += u64::from(touch);
        let ends = before.gap + constraint::weighted(&before, motion.displacements).dot(before.normal);
        // Rounding errors alone are no impact.
        if touch && ends >= repulsion::least_gap(before.gap, model.thickness) - continuous::TOUCH * separation {
            continue;
        }
        let target = least_at_rest(kind, model, vertices, model.thickness).min(before.gap);
        list.push(repulsion::constraint(model, impact, target, motion, MOST_LEVER_RATIO));
    }
    list.sort_from(first);
}

/// Where four points are in the course of their motion: at its start for 0, at its end for 1.
#[inline(always)]
fn between(mut start: [Vec3; 4], end: &[Vec3; 4], part: Real) -> [Vec3; 4] {
    for (start, &end) in start.iter_mut().zip(end) {
        *start += (end - *start) * part;
    }
    start
}

/// Solves all impacts so far.
pub(crate) fn resolve(work: &mut Work<'_>) {
    let Work { model, list, near, motion, .. } = work;
    relax(model, list.all.part_mut(*near..list.count), None, motion, SWEEPS, 0.0);
}

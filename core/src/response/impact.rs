//! What meets on the way: a constraint at the place and along the direction of the meeting, so that
//! the pair ends no nearer than it began, or as near as the thickness. Inelastic [Bridson 2002].

use super::constraint::{self, Constraint};
use super::repulsion::{self, grip, thickness};
use super::{Context, List, Motion, relax};
use crate::contact::{ContactModel, Pairs};
use crate::dispatch::Dispatch;
use crate::narrow_phase::{EdgeEdge, Pairing, VertexTriangle, contact, continuous, gather};
use crate::real::{Real, Vec3};
use crate::stage::Stage;

/// Sweeps in a round.
const SWEEPS: u32 = 5;

/// How much farther than a contact its vertices may have to move so that nothing passes through.
pub const MOST_LEVER: Real = 100.0;

/// How near two features count as met, of the thickness.
pub const SEPARATION: Real = 0.1;

/// Adds a constraint for each pair that meets. Only pairs with a vertex moved in `round` are
/// tested; 0: all.
pub(crate) fn find<D: Dispatch>(
    model: &ContactModel<'_>,
    vertex_triangle: &mut Pairs<'_>,
    edge_edge: &mut Pairs<'_>,
    counts: [usize; 2],
    motion: &Motion<'_>,
    round: u32,
    list: &mut List<'_>,
    dispatch: &D,
) {
    find_pairs::<VertexTriangle, D>(model, vertex_triangle, counts[0], motion, round, list, dispatch);
    find_pairs::<EdgeEdge, D>(model, edge_edge, counts[1], motion, round, list, dispatch);
}

fn find_pairs<P: Pairing, D: Dispatch>(
    model: &ContactModel<'_>,
    pairs: &mut Pairs<'_>,
    count: usize,
    motion: &Motion<'_>,
    round: u32,
    list: &mut List<'_>,
    dispatch: &D,
) {
    let (candidates, times) = (&pairs.candidates[..count], &mut pairs.times[..count]);
    let Motion { start, end, moves, rounds, .. } = motion;
    let swept = continuous::LinearMotion { start, end, displacements: moves, radii: model.radii, rounds, round };
    let separation = SEPARATION * model.thickness;
    dispatch.enter(Stage::NarrowPhase);
    continuous::times::<P>(candidates, pairs.distances, &model.surface, swept, separation, times, dispatch);
    dispatch.enter(Stage::Response);
    let first = list.count;
    for (&candidate, &time) in candidates.iter().zip(&*times) {
        let touch = time == continuous::TOUCHING;
        if time > 1.0 && !touch {
            continue;
        }
        let vertices = P::vertices(&model.surface, candidate);
        let (x, moves) = (gather(vertices, start), gather(vertices, moves));
        let radius = P::radius(gather(vertices, model.radii));
        let at: [Vec3; 4] = if touch { x } else { core::array::from_fn(|k| x[k] + moves[k] * time) };
        let (Some(met), Some(before)) =
            (contact::<P>(vertices, &at, &x, radius), contact::<P>(vertices, &x, &x, radius))
        else {
            list.touching += 1;
            continue;
        };
        list.touching += u64::from(touch);
        let ends = before.gap + constraint::weighted(&before, motion.moves).dot(before.normal);
        // Rounding alone does not count.
        if touch && ends >= repulsion::met(before.gap, model.thickness) - continuous::TOUCH * separation {
            continue;
        }
        let target = thickness::<P>(model, vertices).min(before.gap);
        list.push(Constraint::new(met, target, grip(model, &met, motion), model.mobility, MOST_LEVER));
    }
    list.sort_from(first);
}

/// Adds a constraint for each vertex that meets a plane, of those moved in `round`; 0: of all.
pub(crate) fn find_planes(model: &ContactModel<'_>, motion: &Motion<'_>, round: u32, list: &mut List<'_>) {
    let least = |gap| repulsion::met(gap, model.thickness);
    repulsion::find_planes(model, motion, round, least, &repulsion::Known::nothing(), list);
}

/// Solves what met.
pub(crate) fn resolve(context: &Context<'_>, met: &mut [Constraint], motion: &mut Motion<'_>) {
    relax(context, met, None, motion, SWEEPS, 0.0);
}

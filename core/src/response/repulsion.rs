//! Pairs that are near at the start of a step. A pair may come as near as the thickness; a pair that is nearer may come
//! no nearer. A tenth of an overlap is removed in each step [Bridson 2002]. This changes positions and not velocities,
//! so it adds no kinetic energy. The work that it does against the forces is [measured](crate::work_done).

use super::constraint::{self, Constraint};
use super::roll::roll;
use super::work::{List, Motion, Work, relax};
use crate::broad_phase::Counts;
use crate::colliders::Form;
use crate::column::Column;
use crate::contact::{ContactModel, Pairs};
use crate::narrow_phase::advance::{fastest, slab};
use crate::narrow_phase::local_minimum::is_local_minimum;
use crate::narrow_phase::{Contact, Kind, Pairing, contact, gather, nearest, with_pairing};
use crate::real::{Real, sqrt};

/// Sweeps over all contacts.
const SWEEPS: u32 = 20;
/// Sweeps that remove overlaps.
const SEPARATION_SWEEPS: u32 = 4;
/// Part of an overlap that is removed in a step.
const REMOVED: Real = 0.1;
/// Violation that is left, relative to the thickness.
const LEFT: Real = 1e-3;

/// Largest displacement of a vertex relative to that of the contact. Beside a pin, a larger one would throw the
/// neighbouring vertices away. [Impacts](super::impact) ensure that nothing passes through.
pub const MOST_LEVER_RATIO: Real = 4.0;

/// Largest distance of a near pair, relative to the thickness. Farther pairs may collide, but not along their present
/// direction.
pub const REACH: Real = 2.0;

/// Adds a constraint for each near pair that overlaps or comes nearer than the thickness plus `margin`, m, if the
/// surfaces are nearest there, or if the pair sinks deeper into the thickness of a round collider. Only the first
/// candidates are `open`. Those that cannot be a contact from this start of the step, whatever the motion, move behind
/// them.
pub(crate) fn find(
    model: &ContactModel<'_>,
    [vertex_triangle, edge_edge]: [&mut Pairs<'_>; 2],
    open: &mut Counts,
    motion: &Motion<'_>,
    known: &Known<'_>,
    margin: Real,
    list: &mut List<'_>,
) {
    let Counts { vertex_triangle: of_triangles, edge_edge: of_edges } = open;
    find_pairs(Kind::VertexTriangle, model, vertex_triangle, of_triangles, motion, known, margin, list);
    find_pairs(Kind::EdgeEdge, model, edge_edge, of_edges, motion, known, margin, list);
    find_planes(model, motion, |_| model.thickness + margin, known, list);
}

/// The pairs that already have a constraint.
pub(crate) struct Known<'a> {
    order: &'a [u32],
}

impl<'a> Known<'a> {
    /// Without any.
    pub fn nothing() -> Self {
        Self { order: &[] }
    }

    /// The pairs of some constraints. Sorts their indices into `order`.
    pub fn sort(constraints: &[Constraint], order: &'a mut [u32]) -> Self {
        let order = order.part_mut(..constraints.len());
        for (k, slot) in (0..).zip(&mut *order) {
            *slot = k;
        }
        constraint::sort_by_vertices(constraints, order);
        Self { order }
    }

    /// The index of the first constraint of a pair. Constraints were only added behind the known ones.
    pub fn first(&self, constraints: &[Constraint], vertices: [u32; 4]) -> Option<u32> {
        let of = |k: u32| constraint::vertices(constraints, k);
        let at = self.order.partition_point(|&k| of(k) < vertices);
        self.order.get(at).copied().filter(|&k| of(k) == vertices)
    }
}

#[cfg_attr(small, inline(never))]
fn find_pairs(
    kind: Kind,
    model: &ContactModel<'_>,
    pairs: &mut Pairs<'_>,
    open: &mut usize,
    motion: &Motion<'_>,
    known: &Known<'_>,
    margin: Real,
    list: &mut List<'_>,
) {
    let (first, mut k) = (list.count, 0);
    while k < *open {
        let (candidate, distance) = (pairs.candidates.at(k), pairs.distances.at(k));
        if may_be_contact(kind, model, candidate, distance, motion, known, margin, list) {
            k += 1;
        } else {
            *open -= 1;
            pairs.swap(k, *open);
        }
    }
    list.sort_from(first);
}

/// Adds the constraint of a pair if it needs one. Returns false if the pair cannot be a contact from this start of the
/// step.
#[inline(always)]
fn may_be_contact(
    kind: Kind,
    model: &ContactModel<'_>,
    candidate: [u32; 2],
    distance: Real,
    motion: &Motion<'_>,
    known: &Known<'_>,
    margin: Real,
    list: &mut List<'_>,
) -> bool {
    if distance > REACH * model.thickness {
        return false;
    }
    let vertices = with_pairing!(kind, P => P::vertices(&model.surface, candidate));
    let may_push = |end| distance < model.thickness || end < model.thickness + margin;
    let first = with_pairing!(kind, P => P::FIRST);
    let nearest_end = distance - fastest(first, &gather(vertices, motion.displacements));
    if !may_push(nearest_end) || known.first(list.all, vertices).is_some() {
        return true;
    }
    let x = gather(vertices, motion.start);
    let radius = with_pairing!(kind, P => P::radius(gather(vertices, model.radii)));
    let Some(contact) = contact(kind, vertices, &x, &x, radius) else { return false };
    let ends = contact.gap + constraint::weighted(&contact, motion.displacements).dot(contact.normal);
    if !may_push(ends) {
        return true;
    }
    // Only round colliders have a radius. Inside their thickness all pairs that come nearer are contacts: otherwise
    // only the deepest vertices would be moved out, and their neighbours would sink meanwhile. On other surfaces
    // such pairs would hinder sliding, because their normals are tilted.
    let may_sink = radius > 0.0 && distance < model.thickness;
    let sinks = may_sink && ends < contact.gap;
    // Few pairs are a local minimum. To find the part that they can keep takes longer.
    if !sinks && !is_local_minimum(kind, &model.surface, motion.start, &contact) {
        return may_sink;
    }
    let reach = least_at_rest(kind, model, vertices, model.thickness + margin);
    let least = reach.min(model.thickness);
    if distance < least || ends < reach {
        list.push(constraint(model, contact, least.min(contact.gap), motion, MOST_LEVER_RATIO));
    }
    true
}

/// Adds a constraint for each vertex that ends nearer to a plane than `least`, which depends on the gap at its start.
/// Only the vertices of the [tested](Motion::tested) round count.
pub(crate) fn find_planes(
    model: &ContactModel<'_>,
    motion: &Motion<'_>,
    least: impl Fn(Real) -> Real,
    known: &Known<'_>,
    list: &mut List<'_>,
) {
    let round = motion.tested();
    for body in model.colliders.bodies.iter().filter(|body| !body.is_off()) {
        let Form::Plane(normal) = body.form() else { continue };
        let plane = model.cloth() as u32 + body.vertices[0];
        for v in 0..model.cloth() as u32 {
            if round > 0 && motion.rounds.at(v as usize) != round {
                continue;
            }
            let contact = Contact {
                vertices: [v, plane, plane, plane],
                weights: [1.0, -1.0, 0.0, 0.0],
                normal,
                gap: normal.dot(motion.start.at(v as usize) - motion.start.at(plane as usize)),
            };
            let ends = contact.gap + constraint::weighted(&contact, motion.displacements).dot(normal);
            if ends < least(contact.gap) && known.first(list.all, contact.vertices).is_none() {
                let target = model.thickness.min(contact.gap);
                list.push(constraint(model, contact, target, motion, MOST_LEVER_RATIO));
            }
        }
    }
}

/// The gap at the end of a step below which features collide, m. A vertex that begins behind a plane may stay there.
pub(crate) fn least_gap(gap: Real, thickness: Real) -> Real {
    if gap > 0.0 { 0.1 * gap.min(thickness) } else { 1.1 * gap }
}

/// The constraint of a contact. Its coefficients of friction are those of its sliding in the predicted motion; the
/// larger law of its vertices counts.
#[cfg_attr(small, inline(never))]
pub(crate) fn constraint(
    model: &ContactModel<'_>,
    contact: Contact,
    target: Real,
    motion: &Motion<'_>,
    lever_ratio: Real,
) -> Constraint {
    let law = gather(contact.vertices, model.law_of).into_iter().fold(0, u32::max);
    let roll = roll(model, &contact, motion.turns);
    let relative = constraint::weighted(&contact, motion.displacements) + roll;
    let sliding = relative - contact.normal * contact.normal.dot(relative);
    let coefficients = model.laws.at(law as usize).coefficients(sqrt(sliding.length_squared()) / motion.step);
    Constraint { roll, ..Constraint::new(contact, target, coefficients, &model.inverse_masses, lever_ratio) }
}

/// The part of a `distance` that a pair can keep, m. Neighbours on one sheet may be nearer in its material.
#[cfg_attr(small, inline(never))]
pub(crate) fn least_at_rest(kind: Kind, model: &ContactModel<'_>, vertices: [u32; 4], distance: Real) -> Real {
    let sheet = model.firsts.partition_point(|&first| first <= vertices[0]);
    // The vertices of the colliders come last and are no sheet.
    let sheet = sheet.checked_sub(1).and_then(|first| model.firsts.get(first..first + 2));
    let Some(&[first, end]) = sheet else { return distance };
    if vertices.iter().any(|&v| v < first || v >= end) {
        return distance;
    }
    let material = gather(vertices, model.material);
    // Twice the distance: far from every rounding error.
    let direction = material[0] - material[3];
    let gap = slab(with_pairing!(kind, P => P::FIRST), direction, &material);
    if gap > 2.0 * distance * sqrt(direction.length_squared()) {
        return distance;
    }
    let rest = sqrt(nearest(kind, &material).between.length_squared());
    distance.min(0.9 * rest)
}

/// Solves the contacts.
pub(crate) fn repel(work: &mut Work<'_>) {
    let Work { model, list, near, motion, .. } = work;
    relax(model, list.all.part_mut(..*near), None, motion, SWEEPS, LEFT * model.thickness);
}

/// Removes a part of each overlap.
pub(crate) fn separate(work: &mut Work<'_>) {
    let Work { model, list, near, motion, corrections, .. } = work;
    let ContactModel { thickness, ref inverse_masses, .. } = **model;
    for _ in 0..SEPARATION_SWEEPS {
        for constraint in list.all.part(..*near) {
            let (contact, along) = (constraint.contact, constraint.inverse_mass);
            let overlap = thickness - contact.gap;
            if overlap <= LEFT * thickness || along <= 0.0 || constraint.target < contact.gap {
                continue;
            }
            let ends = contact.gap + constraint::weighted(&contact, motion.displacements).dot(contact.normal);
            let violation = contact.gap + REMOVED * overlap - ends;
            if violation > 0.0 {
                let impulse = contact.normal * (violation / along);
                constraint::apply_impulse(&contact, impulse, inverse_masses, motion.displacements);
                constraint::apply_impulse(&contact, impulse, inverse_masses, corrections);
                motion.mark(constraint);
            }
        }
    }
}

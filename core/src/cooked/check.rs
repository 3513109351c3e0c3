//! Checks of an opened scene: every index names an entry that exists, and columns that belong together have the same
//! length. Kernels rely on it.

use super::CookedError;
use super::stored::{Kept, NO_FRAMES, Stored, StoredContact};
use crate::audit::tree;
use crate::broad_phase::{Grid, Surface};
use crate::colliders::{Body, Drive, Form};
use crate::column::Column;
use crate::contact::{ContactScratch, Pairs, Solids};
use crate::forces::matrix::{BlockMatrix, NOT_STORED};
use crate::forces::model::for_each_term;
use crate::forces::term::ForceTerm as _;
use crate::forces::{Model, Term};
use crate::integrate::coarse::{MODES, Patches};
use crate::integrate::columns::PART;
use crate::integrate::pins::{AT_REST, Hold, NO_CARRIER, PinSlots};
use crate::integrate::{Method, Preconditioner, Scheme};
use crate::keys::Key;
use crate::mesh::{Incidence, NONE};
use crate::motion::Motion;
use crate::scratch::{MAY_BE_LEAN, Scratch};

/// Steps beyond this could not be counted in doubles.
pub(super) const MOST_STEPS: u64 = 1 << 53;

/// Whether all of some conditions hold.
type Checked = Result<(), CookedError>;

fn ensure(holds: bool) -> Checked {
    if holds { Ok(()) } else { Err(CookedError::Malformed) }
}

/// Whether every index is below a number.
fn below<const K: usize>(indices: &[[u32; K]], end: usize) -> bool {
    indices.as_flattened().iter().all(|&index| (index as usize) < end)
}

fn all_below(indices: &[u32], end: usize) -> bool {
    indices.iter().all(|&index| (index as usize) < end)
}

/// Whether offsets divide a column of a length into so many rows.
fn divides(offsets: &[u32], rows: usize, length: usize) -> bool {
    offsets.len() == rows + 1
        && offsets.first() == Some(&0)
        && offsets.iter().is_sorted()
        && offsets.last().is_some_and(|&last| last as usize == length)
}

/// Whether a range lies in a column of a length.
fn lies_in([first, count]: [u32; 2], length: usize) -> bool {
    (first as usize).checked_add(count as usize).is_some_and(|end| end <= length)
}

fn are(lengths: &[usize], expected: usize) -> bool {
    lengths.iter().all(|&length| length == expected)
}

/// Checks all columns.
pub(super) fn all(stored: &Stored<'_>, scheme: &Scheme) -> Checked {
    let Stored { triangles, particles: p, model, pins, scratch, held, contact, kept, .. } = stored;
    let n = p.positions.len();
    let lengths =
        [p.velocities.len(), p.low_positions.len(), p.low_velocities.len(), p.masses.len(), p.inverse_masses.len()];
    ensure(stored.settings.steps < MOST_STEPS)?;
    ensure(n > 0 && are(&lengths, n) && below(triangles, n))?;
    check_model(model, n)?;
    let bodies = contact.as_ref().map_or(0, |contact| contact.model.bodies.len());
    check_pins(pins, n, bodies)?;
    let measures = stored.reactions.is_some();
    check_scratch(scratch, model, scheme, n, measures.then_some(pins.vertices.len()))?;
    ensure(stored.forces.iter().all(|it| (it.vertex as usize) < n))?;
    let impulses = if measures { bodies } else { 0 };
    if let Some(reactions) = &stored.reactions {
        ensure(reactions.pins.is_empty() && reactions.colliders.len() == impulses)?;
    }
    ensure(held.len() == if scratch.patches.labels.is_empty() { 0 } else { n })?;
    if let Some(contact) = contact {
        check_solids(&contact.model, n)?;
        check_columns(&contact.columns, &contact.model, scheme.method.is_implicit())?;
        check_own_frames(contact)?;
    }
    let multipliers = contact.as_ref().map_or(0, |contact| contact.columns.multipliers.len());
    ensure(kept.is_some() || scheme.error.is_none())?;
    let Some(kept) = kept else { return Ok(()) };
    ensure(kept.reactions.len() == impulses)?;
    check_kept(kept, n, scratch.previous_displacements.len(), multipliers)
}

fn check_kept(kept: &Kept<'_>, n: usize, previous: usize, multipliers: usize) -> Checked {
    let state = [kept.positions.len(), kept.velocities.len(), kept.low_positions.len(), kept.low_velocities.len()];
    let before = [kept.previous_displacements.len(), kept.previous_velocity_changes.len()];
    ensure(are(&state, n) && are(&before, previous) && kept.multipliers.len() == multipliers)
}

fn check_incidence<const K: usize>(incidence: &Incidence<'_>, elements: &[[u32; K]], n: usize) -> Checked {
    let corners = K * elements.len();
    let is_corner = |row: usize, slot: u32| {
        elements.as_flattened().get(slot as usize).is_some_and(|&vertex| vertex as usize == row)
    };
    ensure(divides(incidence.offsets, n, incidence.slots.len()) && incidence.slots.len() <= corners)?;
    ensure((0..n).all(|row| incidence.at(row).iter().all(|&slot| is_corner(row, slot))))
}

fn check_model(model: &Model<'_>, n: usize) -> Checked {
    for springs in [&model.stretch_springs, &model.bend_springs].into_iter().flatten() {
        let count = springs.others.len();
        ensure(divides(springs.offsets, n, count) && all_below(springs.others, n))?;
        ensure(
            are(&[springs.rest.len(), springs.stiffness.len()], count) && [0, count].contains(&springs.damping.len()),
        )?;
    }
    if let Some(drag) = &model.drag {
        ensure(drag.coefficients.len() == n)?;
    }
    if let Some(membrane) = &model.membrane {
        let count = membrane.vertices.len();
        ensure(are(&[membrane.weights.len(), membrane.areas.len(), membrane.materials.len()], count))?;
        ensure(membrane.materials.iter().all(|&material| (material as usize) < membrane.table.len()))?;
        ensure(below(membrane.vertices, n))?;
        check_incidence(&membrane.incidence, membrane.vertices, n)?;
    }
    if let Some(hinges) = &model.hinges {
        let count = hinges.vertices.len();
        ensure(are(&[hinges.stiffness.len(), hinges.rest_angles.len(), hinges.least_heights.len()], count))?;
        ensure([0, count].contains(&hinges.damping.len()) && below(hinges.vertices, n))?;
        check_incidence(&hinges.incidence, hinges.vertices, n)?;
    }
    if let Some(seams) = &model.seams {
        let count = seams.vertices.len();
        ensure(
            are(&[seams.weights.len(), seams.stiffness.len(), seams.damping.len()], count) && below(seams.vertices, n),
        )?;
        check_incidence(&seams.incidence, seams.vertices, n)?;
    }
    if let Some(wind) = &model.wind {
        ensure(below(wind.vertices, n))?;
        check_incidence(&wind.incidence, wind.vertices, n)?;
    }
    if let Some(loads) = &model.loads {
        let is_valid = |group: &crate::forces::load::LoadGroup| {
            lies_in(group.vertices, loads.vertices.len()) && lies_in(group.keys, loads.keys.len()) && group.keys[1] > 0
        };
        ensure(loads.parts.len() == loads.vertices.len() && all_below(loads.vertices, n))?;
        ensure(loads.groups.iter().all(is_valid))?;
    }
    Ok(())
}

pub(super) fn has_keys(motion: &Motion, keys: &[Key]) -> bool {
    lies_in(motion.keys, keys.len())
}

fn check_pins(pins: &PinSlots<'_>, n: usize, bodies: usize) -> Checked {
    let count = pins.vertices.len();
    ensure(are(&[pins.axes.len(), pins.anchors.len(), pins.motions.len()], count) && all_below(pins.vertices, n))?;
    ensure(pins.holds.len() <= count && pins.of_scene as usize <= count)?;
    ensure(pins.axes.iter().all(|&axes| axes < 8) && pins.holds.iter().all(Hold::is_valid))?;
    ensure(pins.table.iter().all(|motion| has_keys(motion, pins.keys)))?;
    let is_motion = |&motion: &u32| motion == AT_REST || (motion as usize) < pins.table.len();
    ensure(pins.motions.iter().all(is_motion))?;
    let is_slot = |&motion: &u32| pins.table.get(motion as usize).is_some_and(|motion| motion.keys[1] == 3);
    ensure(pins.motions.iter().skip(pins.of_scene as usize).all(is_slot))?;
    let is_carrier = |&carrier: &u32| carrier == NO_CARRIER || (carrier as usize) < bodies;
    ensure([0, count].contains(&pins.carriers.len()) && pins.carriers.iter().all(is_carrier))
}

/// `pins` is the number of pins if work is measured.
fn check_scratch(s: &Scratch<'_>, model: &Model<'_>, scheme: &Scheme, n: usize, pins: Option<usize>) -> Checked {
    let when = |is_used: bool| if is_used { n } else { 0 };
    let implicit = scheme.method.is_implicit();
    let (rk4, bdf2) = (scheme.method == Method::Rk4, scheme.method == Method::Bdf2);
    let history = bdf2 || scheme.method == Method::ImplicitMidpoint && scheme.error.is_some();
    let always = [s.next_positions.len(), s.displacements.len(), s.velocity_changes.len()];
    let solve = [
        s.solution.len(),
        s.residual.len(),
        s.gradient.len(),
        s.direction.len(),
        s.products.len(),
        s.preconditioned.len(),
        s.inverse_diagonal.len(),
    ];
    ensure(are(&always, n) && are(&solve, when(implicit)))?;
    ensure(s.elements.len() == model.force_scratch() || MAY_BE_LEAN && s.elements.is_empty())?;
    ensure(s.pin_forces.len() == if implicit { pins.unwrap_or(0) } else { 0 })?;
    let measures = pins.is_some();
    ensure(s.stage_positions.low.len() == when(implicit || measures))?;
    ensure(s.stage_positions.rounded.len() == when(rk4 || implicit || measures))?;
    let has_more = scheme.method.has_more_columns();
    ensure(are(&[s.forces.len(), s.stage_velocities.len()], when(has_more || measures)))?;
    ensure(are(&[s.previous_displacements.len(), s.previous_velocity_changes.len()], when(history)))?;
    ensure(are(&[s.base_offsets.len(), s.base_velocities.len()], when(bdf2)))?;
    ensure(s.base_residual.len() == when(implicit && scheme.newton > 1))?;
    ensure(s.partials.len() == when(implicit).div_ceil(PART))?;
    ensure(s.tangents.len() == if implicit { model.tangent_scratch() } else { 0 })?;
    let ends = || s.cloths.iter().map(|cloth| cloth.end() as usize);
    ensure(ends().is_sorted() && ends().next_back().unwrap_or(0) == when(implicit))?;
    check_matrix(s, model, if implicit { n } else { 0 })?;
    let two_level = implicit && scheme.preconditioner == Preconditioner::TwoLevel;
    check_patches(s, two_level, n)
}

fn check_matrix(s: &Scratch<'_>, model: &Model<'_>, rows: usize) -> Checked {
    let BlockMatrix { offsets, columns, mirrored_offsets, mirrored, blocks } = &s.matrix;
    if rows == 0 {
        return ensure(offsets.is_empty() && blocks.is_empty());
    }
    ensure(divides(offsets, rows, columns.len()) && blocks.len() == columns.len() && all_below(columns, rows))?;
    ensure(divides(mirrored_offsets, rows, mirrored.len()))?;
    let is_mirrored =
        |it: &crate::forces::matrix::Mirrored| (it.column as usize) < rows && (it.block as usize) < blocks.len();
    ensure(mirrored.iter().all(is_mirrored))?;
    let row = |row: usize| columns.part(offsets.at(row) as usize..offsets.at(row + 1) as usize);
    // The diagonal comes first.
    ensure((0..rows).all(|index| row(index).first() == Some(&(index as u32))))?;
    let mut used = [0; Term::ALL.len()];
    let mut is_valid = true;
    for_each_term!(model, |name, term| {
        let slots = s.assembly_map.at(name as usize);
        for (at, (block_row, column)) in term.blocks().enumerate() {
            let slot = slots.get(at).copied().unwrap_or(0);
            is_valid &=
                at < slots.len() && (slot == NOT_STORED || row(block_row as usize).get(slot as usize) == Some(&column));
            used.add(name as usize, 1);
        }
    });
    ensure(is_valid && s.assembly_map.iter().zip(used).all(|(slots, used)| slots.len() == used))
}

fn check_patches(s: &Scratch<'_>, two_level: bool, n: usize) -> Checked {
    let Patches { labels, coordinates, first_columns, offsets, .. } = s.patches;
    let (rows, values) = (first_columns.len(), s.coarse.values.len());
    let patches = rows / MODES;
    let sizes = [s.coarse.inverse_diagonal.len(), s.coarse.vector.len()];
    ensure(are(&sizes, rows) && s.coarse.rounded.len() == values && rows.is_multiple_of(MODES))?;
    ensure(are(&[s.coarse.own.len(), s.coarse.motions.len()], patches))?;
    let elastic = [s.coarse.elastic_values.len(), s.coarse.elastic_own.len()];
    ensure(elastic == [0; 2] || elastic == [values, patches])?;
    if !two_level {
        return ensure(labels.is_empty() && rows == 0);
    }
    ensure(labels.len() == coordinates.len() && labels.len().is_multiple_of(n) && all_below(labels, patches))?;
    ensure(divides(offsets, rows, values))?;
    let is_envelope = |row: usize| {
        let first = first_columns.at(row / MODES * MODES);
        let length = offsets.at(row + 1) - offsets.at(row);
        first_columns.at(row) == first
            && first as usize <= row / MODES * MODES
            && length as usize == row - first as usize + 1
    };
    ensure((0..rows).all(is_envelope))
}

fn check_surface(surface: &Surface<'_>, vertices: usize) -> Checked {
    let (triangles, edges) = (surface.triangles.len(), surface.edges.len());
    let is_edge = |&edge: &u32| edge == NONE || (edge as usize) < edges;
    ensure(are(&[surface.triangle_edges.len(), surface.owned.len()], triangles) && below(surface.triangles, vertices))?;
    ensure(surface.triangle_edges.as_flattened().iter().all(is_edge) && below(surface.edges, vertices))?;
    ensure(surface.first_passive as usize <= triangles)?;
    // A face has three edges, and owns only edges that it has.
    let owns = |(&owned, edges): (&u8, &[u32; 3])| {
        let missing = (0u8..).zip(edges).filter(|&(_, &edge)| edge == NONE);
        let mut needed =
            missing.map(|(k, _)| owned & (crate::broad_phase::OWNS_EDGE << k | crate::broad_phase::IS_FACE));
        needed.all(|bits| bits == 0)
    };
    ensure(surface.owned.iter().zip(surface.triangle_edges).all(owns))?;
    check_incidence(&surface.incidence, surface.triangles, vertices)?;
    let sewn = &surface.sewn;
    ensure(
        sewn.offsets.is_empty() && sewn.others.is_empty()
            || divides(sewn.offsets, vertices, sewn.others.len()) && all_below(sewn.others, vertices),
    )
}

fn check_solids(solids: &Solids<'_>, n: usize) -> Checked {
    let vertices = n + solids.anchors.len();
    let lengths = [solids.radii.len(), solids.inverse_masses.len(), solids.held.len(), solids.law_of.len()];
    ensure(are(&lengths, vertices) && solids.material.len() == n && all_below(solids.law_of, solids.laws.len()))?;
    let firsts = solids.firsts;
    ensure(
        firsts.iter().is_sorted()
            && firsts.first() == Some(&0)
            && firsts.last().is_some_and(|&last| last as usize == n),
    )?;
    ensure(solids.thickness > 0.0 && solids.thickness.is_finite())?;
    let mut next = 0;
    for body in &*solids.bodies {
        let count = body.vertices[1] as usize;
        let fits = match body.form() {
            Form::Plane(_) | Form::Sphere => count == 1,
            Form::Capsule => count == 2,
            Form::Box => count == 8,
            Form::Mesh => count > 0,
        };
        let moves = match body.drive() {
            Drive::Rest => true,
            Drive::Host(kinematic) => kinematic.is_valid(),
            Drive::Motion(motion) => has_keys(&motion, solids.keys),
            Drive::Cache(cache) => cache.fits(count, solids.frames.len()),
        };
        ensure(body.vertices[0] as usize == next && fits && moves)?;
        next += count;
    }
    ensure(next == solids.anchors.len())?;
    check_surface(&solids.surface, vertices)
}

fn check_own_frames(StoredContact { model, own_frames, .. }: &StoredContact<'_>) -> Checked {
    ensure([0, model.bodies.len()].contains(&own_frames.len()))?;
    let fits = |(&first, body): (&u32, &Body)| {
        let length = 2 * body.range().len();
        first == NO_FRAMES || (first as usize).checked_add(length).is_some_and(|end| end <= model.frames.len())
    };
    ensure(own_frames.iter().zip(&*model.bodies).all(fits))
}

fn check_columns(c: &ContactScratch<'_>, solids: &Solids<'_>, is_implicit: bool) -> Checked {
    let (vertices, triangles, edges) = (solids.radii.len(), solids.surface.triangles.len(), solids.surface.edges.len());
    let of_vertices = [c.start.len(), c.end.len(), c.displacements.len(), c.boxes.len(), c.ends.len()];
    ensure(are(&of_vertices, vertices) && c.turns.len() == solids.bodies.len())?;
    let are_pairs = |pairs: &Pairs<'_>| are(&[pairs.distances.len(), pairs.times.len()], pairs.candidates.len());
    ensure(are_pairs(&c.vertex_triangle) && are_pairs(&c.edge_edge))?;
    let room = c.constraints.len();
    let solved = if is_implicit { room } else { 0 };
    ensure(are(&[c.contacts.len(), c.multipliers.len()], solved) && c.lines.len() == solved.div_ceil(4))?;
    // A lean search has no columns.
    let is_lean = MAY_BE_LEAN && c.grid.entries.is_empty();
    let when = |count: usize| if is_lean { 0 } else { count };
    ensure(are(&[c.kept.boxes.len(), c.grid.quantized_boxes.len()], when(vertices)))?;
    ensure(c.order.len() == room)?;
    let Grid { triangle_boxes, moving_boxes, owned, levels, spheres, byte_boxes, homes, entries, spare, .. } = &c.grid;
    let of_triangles = [triangle_boxes.len(), moving_boxes.len(), spheres.len(), byte_boxes.len(), homes.len()];
    let bytes = [owned.len(), levels.len(), c.room.boxes.len()];
    ensure(
        are(&of_triangles, when(triangles))
            && are(&bytes, when(triangles))
            && are(&[entries.len(), spare.len()], when(8 * triangles)),
    )?;
    ensure(c.room.bounds.len() == when(2 * tree::nodes(triangles)))?;
    ensure(are(&[c.room.edges.len(), c.room.taken.len()], when(edges)))
}

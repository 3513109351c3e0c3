//! Whether anything passes through anything: an exact answer that shares no code with collision
//! detection beyond the [`Surface`] that both are asked about.
//!
//! A *crossing* is an edge and a triangle that are no neighbours and [meet](edge_meets_triangle).
//! Neighbours have a vertex in common or two that are sewn together. Wherever two triangles pass
//! through one another, the line that they share ends on an edge of one or the other, so crossings
//! find all of it but what the two sides of a seam do to one another and a fold laid flat onto its
//! own hinge. Only faces and their edges count, and none passive against passive; without
//! [`Surface::own_contact`] none of the cloth against itself. Positions must be finite.
//!
//! Boxes are sorted along the axis on which the vertices are furthest spread. Where all of n
//! triangles overlap it takes n^2 exact tests.

use alloc::vec;
use alloc::vec::Vec;

use crate::broad_phase::{IS_FACE, Surface};
use crate::geometry::aabb::Aabb;
use crate::geometry::intersect::edge_meets_triangle;
use crate::real::Vec3;

/// Number of crossings; needs no room for them.
pub fn count(surface: &Surface<'_>, positions: &[Vec3]) -> usize {
    let mut count = 0;
    visit(surface, positions, |_, _| count += 1);
    count
}

/// The crossings, `[edge, triangle]` in rising order.
pub fn crossings(surface: &Surface<'_>, positions: &[Vec3]) -> Vec<[u32; 2]> {
    let mut found = Vec::new();
    visit(surface, positions, |edge, triangle| found.push([edge, triangle]));
    found.sort_unstable();
    found
}

/// The pairs of triangles that some crossings make, the lesser first, in rising order: each
/// triangle that a crossing edge is of, with the one that the edge crosses.
pub fn triangle_pairs(surface: &Surface<'_>, crossings: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let mut sides: Vec<[u32; 2]> = faces(surface)
        .flat_map(|triangle| surface.triangle_edges[triangle as usize].map(|edge| [edge, triangle]))
        .collect();
    sides.sort_unstable();
    let mut pairs = Vec::new();
    for &[edge, crossed] in crossings {
        let first = sides.partition_point(|side| side[0] < edge);
        let owners = sides[first..].iter().take_while(|side| side[0] == edge);
        pairs.extend(owners.map(|&[_, owner]| [owner.min(crossed), owner.max(crossed)]));
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Calls `found` with the edge and the triangle of every crossing, once, in no particular order.
pub fn visit(surface: &Surface<'_>, positions: &[Vec3], mut found: impl FnMut(u32, u32)) {
    let corners = |triangle: u32| surface.triangles[triangle as usize];
    let ends = |edge: u32| surface.edges[edge as usize];
    let axis = widest_axis(positions);
    let triangles = sorted(faces(surface).map(|t| (t, boxed(positions, &corners(t)))), axis);
    let (moving, passive) = edges_of_faces(surface);
    let near = |edge: u32, triangle: u32| {
        let sewn = |a: u32| corners(triangle).iter().any(|&b| a == b || surface.sewn.joins(a, b));
        ends(edge).into_iter().any(sewn)
    };
    let mut test = |edge: u32, triangle: u32| {
        let place = |vertex: u32| positions[vertex as usize];
        if !near(edge, triangle) && edge_meets_triangle(ends(edge).map(place), corners(triangle).map(place)) {
            found(edge, triangle);
        }
    };
    let boxes = |edges: Vec<u32>| sorted(edges.into_iter().map(|e| (e, boxed(positions, &ends(e)))), axis);
    let (cloth, others): (Vec<_>, Vec<_>) = triangles.iter().partition(|(t, _)| *t < surface.first_passive);
    let against = if surface.own_contact { &triangles } else { &others };
    sweep(&boxes(moving), against, axis, &mut test);
    sweep(&boxes(passive), &cloth, axis, &mut test);
}

/// A feature and its box.
type Boxed = (u32, Aabb);

/// The triangles that are faces.
fn faces(surface: &Surface<'_>) -> impl Iterator<Item = u32> {
    (0..surface.triangles.len() as u32).filter(|&triangle| surface.owned[triangle as usize] & IS_FACE != 0)
}

/// The edges of faces: those of at least one that is not passive, and the others.
fn edges_of_faces(surface: &Surface<'_>) -> (Vec<u32>, Vec<u32>) {
    let mut least = vec![u32::MAX; surface.edges.len()];
    for triangle in faces(surface) {
        for edge in surface.triangle_edges[triangle as usize] {
            least[edge as usize] = least[edge as usize].min(triangle);
        }
    }
    let edges = (0..surface.edges.len() as u32).filter(|&edge| least[edge as usize] != u32::MAX);
    edges.partition(|&edge| least[edge as usize] < surface.first_passive)
}

/// Calls `test` with every pair of an edge and a triangle whose boxes overlap. Of two boxes that
/// do, the one that begins first along the axis ends after the other's beginning.
fn sweep(edges: &[Boxed], triangles: &[Boxed], axis: usize, test: &mut impl FnMut(u32, u32)) {
    let (mut edges, mut triangles) = (edges, triangles);
    let begun = |of: &Boxed, by: &Boxed| of.1.min[axis] <= by.1.max[axis];
    while let ([edge, later_edges @ ..], [triangle, later_triangles @ ..]) = (edges, triangles) {
        if edge.1.min[axis] <= triangle.1.min[axis] {
            let reached = triangles.iter().take_while(|triangle| begun(triangle, edge));
            reached.filter(|triangle| triangle.1.overlaps(&edge.1)).for_each(|triangle| test(edge.0, triangle.0));
            edges = later_edges;
        } else {
            let reached = edges.iter().take_while(|edge| begun(edge, triangle));
            reached.filter(|edge| edge.1.overlaps(&triangle.1)).for_each(|edge| test(edge.0, triangle.0));
            triangles = later_triangles;
        }
    }
}

fn sorted(features: impl Iterator<Item = Boxed>, axis: usize) -> Vec<Boxed> {
    let mut features: Vec<Boxed> = features.collect();
    features.sort_unstable_by(|a, b| a.1.min[axis].total_cmp(&b.1.min[axis]).then(a.0.cmp(&b.0)));
    features
}

fn boxed(positions: &[Vec3], vertices: &[u32]) -> Aabb {
    let points = vertices.iter().map(|&vertex| positions[vertex as usize]);
    points.fold(Aabb::EMPTY, |all, point| all.union(&Aabb { min: point, max: point }))
}

fn widest_axis(positions: &[Vec3]) -> usize {
    let all = positions.iter().fold(Aabb::EMPTY, |all, &point| all.union(&Aabb { min: point, max: point }));
    (all.max - all.min).max_position()
}

//! The contour in which surfaces pass through one another, and how its length changes: G, from
//! each edge that passes through a triangle [Volino 2006].
//!
//! With E the direction of the edge, N the normal of the triangle, and R_i, for each triangle i on
//! the edge, the direction in which the contour runs from the edge into triangle i,
//! ```text
//! G = sum_i R_i - 2 (E . R_i) / (E . N) N
//! ```
//! Where the edge moves by d against the triangle, the crossing moves along both planes, and the
//! contour becomes longer by -1/2 sum G . d over the crossings, to first order and where surfaces
//! move as wholes. So edges move along G, and triangles against it.

use alloc::vec;
use alloc::vec::Vec;

use super::topology::{NONE, Pieces, Topology};
use crate::real::{Real, Vec3};

/// Least |E . N|: below it the edge lies in the triangle's plane and says little of where to go.
const FLAT: Real = 1e-3;

/// An edge that passes through a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// The edge and the triangle.
    pub features: [u32; 2],
    /// Ends of the edge, corners of the triangle.
    pub vertices: [u32; 5],
    /// Of the place of the crossing: on the edge, and on the triangle.
    pub weights: [Real; 5],
    /// Where, m.
    pub place: Vec3,
    /// Unit normal of the triangle; 0 where it has no area.
    pub normal: Vec3,
}

impl Crossing {
    /// From an edge and a triangle that meet. Where they lie in one plane, it is in their middle.
    pub fn new(features: [u32; 2], edge: [u32; 2], triangle: [u32; 3], places: &[Vec3]) -> Self {
        let [p, q] = edge.map(|v| places[v as usize]);
        let [a, b, c] = triangle.map(|v| places[v as usize]);
        let across = (b - a).cross(c - a);
        let normal = across.try_normalize().unwrap_or(Vec3::ZERO);
        let [above, below] = [(p - a).dot(normal), (q - a).dot(normal)];
        let span = above - below;
        let along = if span == 0.0 { 0.5 } else { (above / span).clamp(0.0, 1.0) };
        let place = p + (q - p) * along;
        let area = |b: Vec3, c: Vec3| (b - place).cross(c - place).dot(normal).max(0.0);
        let areas = [area(b, c), area(c, a), area(a, b)];
        let sum = areas[0] + areas[1] + areas[2];
        let [u, v, w] = if sum > 0.0 { areas.map(|area| area / sum) } else { [1.0 / 3.0; 3] };
        let vertices = [edge[0], edge[1], triangle[0], triangle[1], triangle[2]];
        Self { features, vertices, weights: [1.0 - along, along, u, v, w], place, normal }
    }
}

/// G of an edge and a triangle; `opposite` are the third corners of the triangles on the edge. 0
/// where they lie in one plane.
pub fn gradient(edge: [Vec3; 2], normal: Vec3, opposite: &[Vec3]) -> Vec3 {
    let Some(along) = (edge[1] - edge[0]).try_normalize() else { return Vec3::ZERO };
    let slope = along.dot(normal);
    if slope.abs() < FLAT {
        return Vec3::ZERO;
    }
    let runs = opposite.iter().filter_map(|&third| into(along, third - edge[0], normal));
    runs.map(|run| run - normal * (2.0 * along.dot(run) / slope)).sum()
}

/// The direction of the line in which a triangle with this edge and side meets a plane, from the
/// edge into the triangle.
fn into(along: Vec3, side: Vec3, normal: Vec3) -> Option<Vec3> {
    let line = along.cross(side).cross(normal).try_normalize()?;
    let inward = side - along * side.dot(along);
    Some(if line.dot(inward) < 0.0 { -line } else { line })
}

/// The contours, their crossings with the strand that each one's edge is of. A contour lies in two
/// strands of triangles that pass through one another; it goes on from one pair of them to the next
/// through the crossing that is of both.
pub fn trace(topology: &Topology, crossings: &[Crossing]) -> Vec<Vec<(u32, u32)>> {
    // Pair of triangles, crossing, and whether the edge's triangle is the greater of the pair.
    let mut ends: Vec<([u32; 2], u32, u32)> = Vec::new();
    for (k, crossing) in (0..).zip(crossings) {
        let [edge, crossed] = crossing.features;
        let sides = topology.sides[edge as usize].into_iter().filter(|&side| side != NONE);
        ends.extend(sides.map(|side| ([side.min(crossed), side.max(crossed)], k, u32::from(side > crossed))));
    }
    ends.sort_unstable();
    let mut strands = Pieces::new(2 * ends.len());
    let mut known: Vec<[u32; 2]> = vec![[NONE; 2]; crossings.len()];
    for (pair, same) in (0..).zip(ends.chunk_by(|a, b| a.0 == b.0)) {
        for &(_, k, own) in same {
            let (mine, other) = (2 * pair + own, 2 * pair + 1 - own);
            match &mut known[k as usize] {
                [NONE, NONE] => known[k as usize] = [mine, other],
                [own, crossed] => {
                    strands.join(*own, mine);
                    strands.join(*crossed, other);
                }
            }
        }
    }
    let mut members: Vec<([u32; 2], u32)> = Vec::with_capacity(crossings.len());
    for (k, strand) in (0..).zip(known) {
        let [own, crossed] = strand.map(|strand| strands.root(strand));
        members.push(([own.min(crossed), own], k));
    }
    members.sort_unstable();
    let contours = members.chunk_by(|a, b| a.0[0] == b.0[0]);
    contours.map(|contour| contour.iter().map(|&([_, strand], k)| (strand, k)).collect()).collect()
}

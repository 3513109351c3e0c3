//! Contours, the lines in which surfaces pass through one another, and the change of their length. The gradient G
//! of the length is computed for each edge that passes through a triangle [Volino 2006].
//!
//! Let E be the direction of the edge, N the normal of the triangle, and R_i, for each triangle i on the edge, the
//! direction in which the contour runs from the edge into triangle i. Then
//! ```text
//! G = sum_i R_i - 2 (E . R_i) / (E . N) N
//! ```
//! If the edge moves by d relative to the triangle, the crossing moves along both planes, and the contour becomes
//! longer by -1/2 sum G . d over the crossings, to first order and for surfaces that move as wholes. So edges move
//! along G, and triangles against it.

use alloc::vec;
use alloc::vec::Vec;

use super::topology::{NONE, Pieces, Topology};
use crate::real::{Real, Vec3};

/// Smallest |E . N|. Below it, the edge lies in the plane of the triangle and gives no direction.
const FLAT: Real = 1e-3;

/// An edge that passes through a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// The edge and the triangle.
    pub features: [u32; 2],
    /// The ends of the edge, then the corners of the triangle.
    pub vertices: [u32; 5],
    /// Weights of these vertices in the place of the crossing: on the edge, and on the triangle.
    pub weights: [Real; 5],
    /// Position of the crossing, m.
    pub place: Vec3,
    /// Unit normal of the triangle; 0 if it has no area.
    pub normal: Vec3,
}

impl Crossing {
    /// The crossing of an edge and a triangle that meet. If they are coplanar, its place is the midpoint of
    /// the edge.
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

/// G of an edge and a triangle; `opposite` has the third corners of the triangles on the edge. G is 0 if the edge
/// lies in the plane of the triangle.
pub fn gradient(edge: [Vec3; 2], normal: Vec3, opposite: &[Vec3]) -> Vec3 {
    let Some(along) = (edge[1] - edge[0]).try_normalize() else { return Vec3::ZERO };
    let slope = along.dot(normal);
    if slope.abs() < FLAT {
        return Vec3::ZERO;
    }
    let runs = opposite.iter().filter_map(|&third| into(along, third - edge[0], normal));
    runs.map(|run| run - normal * (2.0 * along.dot(run) / slope)).sum()
}

/// The direction of the line in which a triangle intersects a plane, from its edge into the triangle. `along` is
/// the direction of the edge and `side` another side of the triangle.
fn into(along: Vec3, side: Vec3, normal: Vec3) -> Option<Vec3> {
    let line = along.cross(side).cross(normal).try_normalize()?;
    let inward = side - along * side.dot(along);
    Some(if line.dot(inward) < 0.0 { -line } else { line })
}

/// The contours. Each is a list of its crossings, as pairs of the strand that contains the crossing's edge and the
/// index of the crossing. A contour lies in two strands of triangles that pass through each other. It continues
/// from one pair of triangles to the next through the crossing that both pairs share.
pub fn trace(topology: &Topology, crossings: &[Crossing]) -> Vec<Vec<(u32, u32)>> {
    // Pair of triangles, crossing, and whether the triangle of the edge has the greater index of the pair.
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

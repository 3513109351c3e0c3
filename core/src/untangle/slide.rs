//! Shortens contours: edges slide along the gradient [G](super::contour), triangles against it. G is summed over a
//! contour and its direction applied to all crossings, so that the contour moves as a whole. If the sum has no
//! clear direction, as when two sheets pass squarely through each other, each crossing follows its own G.

use alloc::vec::Vec;

use super::contour::{Crossing, gradient};
use super::topology::{NONE, Topology};
use super::{Displacements, Scene};
use crate::real::{Real, Vec3, sqrt};

/// A crossing slides in a round by this fraction of the shorter of its edge and the first side of its triangle.
const SLIDE: Real = 0.25;
/// Smallest ratio of the size of the summed G to the sum of the sizes of G at which the sum has a clear direction.
const DIRECTED: Real = 0.2;

/// Requests displacements of the edges and triangles of a contour that shorten it.
pub fn slide(
    scene: &Scene<'_>,
    topology: &Topology,
    crossings: &[Crossing],
    contour: &[(u32, u32)],
    places: &[Vec3],
    displacements: &mut Displacements,
) {
    let surface = &scene.model.surface;
    let gradient_of = |crossing: &Crossing| {
        let edge = crossing.features[0] as usize;
        let ends = surface.edges[edge];
        let corners = |side: u32| surface.triangles[side as usize];
        let sides = topology.sides[edge].into_iter().filter(|&side| side != NONE);
        let thirds = sides.filter_map(|side| corners(side).into_iter().find(|v| !ends.contains(v)));
        let opposite: Vec<Vec3> = thirds.map(|v| places[v as usize]).collect();
        gradient(ends.map(|v| places[v as usize]), crossing.normal, &opposite)
    };
    let gradients: Vec<Vec3> = contour.iter().map(|&(_, k)| gradient_of(&crossings[k as usize])).collect();
    // The strands move in opposite directions. Each has the edges of its own crossings, which move along G, and the
    // triangles of the other strand's crossings, which move against G.
    let sign = |strand: u32| if strand == contour[0].0 { 1.0 } else { -1.0 };
    let sum: Vec3 = contour.iter().zip(&gradients).map(|(&(strand, _), &g)| g * sign(strand)).sum();
    let size: Real = gradients.iter().map(|g| sqrt(g.length_squared())).sum();
    let whole = sqrt(sum.length_squared());
    for (&(strand, k), &own) in contour.iter().zip(&gradients) {
        let crossing = &crossings[k as usize];
        let towards = if whole > DIRECTED * size {
            sum * (sign(strand) / whole)
        } else {
            own.try_normalize().unwrap_or(crossing.normal * sign(strand))
        };
        let [p, q, a, b] = [0, 1, 2, 3].map(|k| places[crossing.vertices[k] as usize]);
        let size = sqrt((q - p).length_squared().min((b - a).length_squared()));
        apart(scene, crossing, towards * (SLIDE * size), displacements);
    }
}

/// Requests a motion of an edge relative to a triangle at their crossing, divided in proportion to their
/// mobilities.
fn apart(scene: &Scene<'_>, crossing: &Crossing, by: Vec3, displacements: &mut Displacements) {
    let mobile =
        |k: usize| scene.model.inverse_masses.at(crossing.vertices[k] as usize).max_element() * crossing.weights[k];
    let (edge, triangle) = (mobile(0) + mobile(1), mobile(2) + mobile(3) + mobile(4));
    let all = edge + triangle;
    if all <= 0.0 {
        return;
    }
    for (k, (&v, &weight)) in crossing.vertices.iter().zip(&crossing.weights).enumerate() {
        let share = if k < 2 { edge / all } else { -triangle / all };
        displacements.add(v, by * share, weight);
    }
}

//! Contours get shorter: edges slide along [G](super::contour), triangles against it. Summed over a
//! contour and its direction given to all of it, so that it moves as a whole; where the sum says
//! little, as where two sheets pass squarely through one another, each crossing follows its own.

use alloc::vec::Vec;

use super::contour::{Crossing, gradient};
use super::topology::{NONE, Topology};
use super::{Moves, Scene};
use crate::real::{Real, Vec3, sqrt};

/// Part of the lesser of an edge's and a triangle's size that a crossing slides in a round.
const SLIDE: Real = 0.25;
/// Least part of the sum of sizes of G that its sum over a contour has to have.
const DIRECTED: Real = 0.2;

/// Asks a contour's edges and triangles to move so that it gets shorter.
pub fn slide(
    scene: &Scene<'_>,
    topology: &Topology,
    crossings: &[Crossing],
    contour: &[(u32, u32)],
    places: &[Vec3],
    moves: &mut Moves,
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
    // The edges of one strand move as the triangles of the other.
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
        apart(scene, crossing, towards * (SLIDE * size), moves);
    }
}

/// Asks an edge to move against a triangle where they cross, each by its part of the mobility.
fn apart(scene: &Scene<'_>, crossing: &Crossing, by: Vec3, moves: &mut Moves) {
    let mobile = |k: usize| scene.model.mobility[crossing.vertices[k] as usize].max_element() * crossing.weights[k];
    let (edge, triangle) = (mobile(0) + mobile(1), mobile(2) + mobile(3) + mobile(4));
    let all = edge + triangle;
    if all <= 0.0 {
        return;
    }
    for (k, (&v, &weight)) in crossing.vertices.iter().zip(&crossing.weights).enumerate() {
        let share = if k < 2 { edge / all } else { -triangle / all };
        moves.add(v, by * share, weight);
    }
}

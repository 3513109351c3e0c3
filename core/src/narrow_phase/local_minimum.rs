//! Whether two features are where their surfaces come nearest to one another. Within the thickness
//! there are others beside them, and the line between those leans: a contact along it would hold
//! back what slides, by an edge across a flat face as by a step [Johnson 2003].

use super::{Contact, Pairing};
use crate::broad_phase::Surface;
use crate::real::{Real, Vec3, sqrt};

/// Sine of the angle by which a neighbour may rise above a feature: more than rounding, and too
/// little to be felt.
const RISE: Real = 1e-2;

/// Whether no neighbour of the features that meet is nearer to the other surface. Before a face
/// any vertex will do: the line between is the face's own normal.
pub fn is_local_minimum<P: Pairing>(surface: &Surface<'_>, x: &[Vec3], contact: &Contact) -> bool {
    let Contact { vertices, weights, normal, .. } = contact;
    let [first, second] = [0..P::FIRST, P::FIRST..4].map(|k| (&vertices[k.clone()], &weights[k]));
    let on_face = second.1.iter().filter(|&&weight| weight != 0.0).count() == 3;
    on_face || is_lowest(surface, x, first, -*normal) && is_lowest(surface, x, second, *normal)
}

/// Whether none of the triangles around what touches of a feature, an edge or a vertex, rises
/// along `out`.
fn is_lowest(surface: &Surface<'_>, x: &[Vec3], (vertices, weights): (&[u32], &[Real]), out: Vec3) -> bool {
    let touches = |v: u32| vertices.iter().zip(weights).any(|(&of, &weight)| of == v && weight != 0.0);
    let count = weights.iter().filter(|&&weight| weight != 0.0).count();
    let Some(foot) = vertices.iter().copied().find(|&v| touches(v)) else { return true };
    let rises = |&v: &u32| {
        let arm = x[v as usize] - x[foot as usize];
        !touches(v) && out.dot(arm) > RISE * sqrt(arm.length_squared())
    };
    let around = surface.fans.at(foot as usize).iter().map(|&slot| surface.triangles[slot as usize / 3]);
    let mut around = around.filter(|corners| corners.iter().filter(|&&v| touches(v)).count() >= count);
    !around.any(|corners| corners.iter().any(rises))
}

//! Tests whether a contact is at a local minimum of the distance between its two surfaces. Within the thickness
//! there are also pairs of features beside the nearest pair, and their normals are inclined. Contacts along these
//! normals would resist sliding: an edge inside a flat face would act like a step [Johnson 2003].

use super::{Contact, Kind, Pairing, with_pairing};
use crate::broad_phase::Surface;
use crate::column::Column;
use crate::real::{Real, Vec3, sqrt};

/// Sine of the angle by which a neighbour may rise above a feature: larger than rounding errors, but too small to
/// be noticed.
const RISE: Real = 1e-2;

/// Sine of the largest angle between a line and a plane at which the line counts as lying in the plane.
const ALONG: Real = 0.1;

/// Whether no neighbour of the two features of a contact is nearer to the other surface. A contact with the
/// interior of a face always passes, because its normal is the normal of the face.
pub fn is_local_minimum(kind: Kind, surface: &Surface<'_>, x: &[Vec3], contact: &Contact) -> bool {
    let Contact { vertices, weights, normal, .. } = contact;
    let middle = with_pairing!(kind, P => P::FIRST);
    let [first, second] =
        [0..middle, middle..4].map(|k| Feature { vertices: vertices.part(k.clone()), weights: weights.part(k) });
    let on_face = second.touched() == 3;
    on_face || is_lowest(surface, x, first, second, -*normal) && is_lowest(surface, x, second, first, *normal)
}

#[derive(Clone, Copy)]
struct Feature<'a> {
    vertices: &'a [u32],
    weights: &'a [Real],
}

impl Feature<'_> {
    /// Number of vertices that have a nonzero weight in the nearest point.
    fn touched(self) -> usize {
        self.weights.iter().filter(|&&weight| weight != 0.0).count()
    }

    fn touches(self, v: u32) -> bool {
        self.vertices.iter().zip(self.weights).any(|(&of, &weight)| of == v && weight != 0.0)
    }
}

/// Whether no triangle around the touched part of `feature`, an edge or a vertex, rises along `out`. Two kinds of
/// triangles are ignored, because no contact of theirs would replace this one: triangles with a vertex of the
/// `other` feature, which are its neighbours, and triangles that lie along `out`, as in a sheet that is compressed
/// in its own plane.
fn is_lowest(surface: &Surface<'_>, x: &[Vec3], feature: Feature<'_>, other: Feature<'_>, out: Vec3) -> bool {
    let Some(foot) = feature.vertices.iter().copied().find(|&v| feature.touches(v)) else { return true };
    let foot_at = x.at(foot as usize);
    let rises = |&v: &u32| {
        let arm = x.at(v as usize) - foot_at;
        !feature.touches(v) && out.dot(arm) > RISE * sqrt(arm.length_squared())
    };
    let joins = |v: &u32| other.vertices.iter().any(|of| of == v || surface.sewn.joins(*of, *v));
    let lies_along = |[a, b, c]: [Vec3; 3]| {
        let normal = (b - a).cross(c - a);
        out.dot(normal).abs() <= ALONG * sqrt(normal.length_squared())
    };
    surface.incidence.at(foot as usize).iter().all(|&slot| {
        let corners = surface.triangles.at(slot as usize / 3);
        let is_around = corners.iter().filter(|&&v| feature.touches(v)).count() >= feature.touched();
        !(is_around && corners.iter().any(rises)) || corners.iter().any(joins) || lies_along(x.gather(&corners))
    })
}

//! The narrow phase computes contacts from candidates: the nearest points of two features, their distance, and the
//! time of impact.

pub mod advance;
pub mod contacts;
pub mod continuous;
pub mod edge_edge;
pub mod edge_edge_ccd;
pub mod local_minimum;
pub mod proximity;
pub mod slab;
pub mod time_of_impact;
pub mod vertex_triangle;
pub mod vertex_triangle_ccd;

use bytemuck::{Pod, Zeroable};

use crate::broad_phase::Surface;
use crate::column::Column;
use crate::lanes::{Vec3x4, first, max};
use crate::real::{Lanes, Real, Vec3};

/// A contact: the nearest points of two features, with their weights, normal and gap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Contact {
    /// The vertices of both features: vertex and triangle, or two edges.
    pub vertices: [u32; 4],
    /// Weights of the vertices in the nearest points: positive on the first feature, negative on the second, with
    /// sum 0.
    pub weights: [Real; 4],
    /// Unit vector from the second feature to the first.
    pub normal: Vec3,
    /// `n . sum W x` at the start of the step, minus the radii of the features, m.
    pub gap: Real,
}

/// The nearest points of two features: signed weights, and the vector from the second to the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Positive on the first feature, negative on the second.
    pub weights: [Real; 4],
    /// The vector from the point on the second feature to the point on the first, m.
    pub between: Vec3,
}

/// The operations that differ between vertex-triangle pairs and edge-edge pairs.
pub trait Pairing: Sync {
    /// Number of vertices of the first feature.
    const FIRST: usize;
    /// The vertices of a candidate, first feature first.
    fn vertices(surface: &Surface<'_>, candidate: [u32; 2]) -> [u32; 4];
    /// The nearest points of the two features.
    fn nearest(x: &[Vec3; 4]) -> Nearest;
    /// A unit normal for features at distance zero, or `None` if the features are degenerate.
    fn direction(x: &[Vec3; 4]) -> Option<Vec3>;
    /// The time in [0, 1] at which the features first come within `separation` while they move linearly from
    /// `start` to `end`. It is never late.
    fn time_of_impact(start: &[Vec3; 4], end: &[Vec3; 4], separation: Real, tolerance: Real) -> Option<Real>;
    /// The squared distances of four pairs of features, m^2.
    fn squared_distances(x: &[Vec3x4; 4]) -> Lanes;
    /// The sums of the radii of both features, of four pairs, m.
    fn radius_sums(radii: [Lanes; 4]) -> Lanes;
    /// Lower bounds of the distances of four pairs of features, from their bounding boxes, m.
    fn box_distances(x: &[Vec3x4; 4]) -> Lanes;
    /// The sum of the radii of both features, m.
    #[inline]
    fn radius([a, b, c, d]: [Real; 4]) -> Real {
        let splat = Lanes::splat;
        first(Self::radius_sums([splat(a), splat(b), splat(c), splat(d)]))
    }
}

/// A vertex and a triangle.
pub struct VertexTriangle;

/// Two edges.
pub struct EdgeEdge;

impl Pairing for VertexTriangle {
    const FIRST: usize = 1;

    #[inline]
    fn vertices(surface: &Surface<'_>, [vertex, triangle]: [u32; 2]) -> [u32; 4] {
        let [a, b, c] = surface.triangles.at(triangle as usize);
        [vertex, a, b, c]
    }
    #[inline]
    fn nearest(x: &[Vec3; 4]) -> Nearest {
        vertex_triangle::nearest(x)
    }
    fn direction(x: &[Vec3; 4]) -> Option<Vec3> {
        vertex_triangle::direction(x)
    }
    fn time_of_impact(start: &[Vec3; 4], end: &[Vec3; 4], separation: Real, tolerance: Real) -> Option<Real> {
        vertex_triangle_ccd::time_of_impact(start, end, separation, tolerance)
    }
    #[cfg_attr(small, inline(never))]
    #[cfg_attr(not(small), inline(always))]
    fn squared_distances(x: &[Vec3x4; 4]) -> Lanes {
        vertex_triangle::squared_distances(x)
    }
    #[inline(always)]
    fn radius_sums([a, b, c, d]: [Lanes; 4]) -> Lanes {
        a + max(max(b, c), d)
    }
    #[cfg_attr(small, inline(never))]
    #[cfg_attr(not(small), inline(always))]
    fn box_distances(x: &[Vec3x4; 4]) -> Lanes {
        let (low, high) = (x[1].min(x[2]).min(x[3]), x[1].max(x[2]).max(x[3]));
        (low - x[0]).max(x[0] - high).max_element()
    }
}

impl Pairing for EdgeEdge {
    const FIRST: usize = 2;

    #[inline]
    fn vertices(surface: &Surface<'_>, [first, second]: [u32; 2]) -> [u32; 4] {
        let ([a, b], [c, d]) = (surface.edges.at(first as usize), surface.edges.at(second as usize));
        [a, b, c, d]
    }
    #[inline]
    fn nearest(x: &[Vec3; 4]) -> Nearest {
        edge_edge::nearest(x)
    }
    fn direction(x: &[Vec3; 4]) -> Option<Vec3> {
        edge_edge::direction(x)
    }
    fn time_of_impact(start: &[Vec3; 4], end: &[Vec3; 4], separation: Real, tolerance: Real) -> Option<Real> {
        edge_edge_ccd::time_of_impact(start, end, separation, tolerance)
    }
    #[cfg_attr(small, inline(never))]
    #[cfg_attr(not(small), inline(always))]
    fn squared_distances(x: &[Vec3x4; 4]) -> Lanes {
        edge_edge::squared_distances(x)
    }
    #[inline(always)]
    fn radius_sums([a, b, c, d]: [Lanes; 4]) -> Lanes {
        max(a, b) + max(c, d)
    }
    #[cfg_attr(small, inline(never))]
    #[cfg_attr(not(small), inline(always))]
    fn box_distances(x: &[Vec3x4; 4]) -> Lanes {
        let gaps = (x[0].min(x[1]) - x[2].max(x[3])).max(x[2].min(x[3]) - x[0].max(x[1]));
        gaps.max_element()
    }
}

/// The kind of a pair of features. Code that runs for few pairs takes it as a value; kernels take a [`Pairing`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// [`VertexTriangle`].
    VertexTriangle,
    /// [`EdgeEdge`].
    EdgeEdge,
}

/// Evaluates an expression with the [`Pairing`] of a kind as the type `$P`.
macro_rules! with_pairing {
    ($kind:expr, $P:ident => $result:expr) => {
        match $kind {
            $crate::narrow_phase::Kind::VertexTriangle => {
                type $P = $crate::narrow_phase::VertexTriangle;
                $result
            }
            $crate::narrow_phase::Kind::EdgeEdge => {
                type $P = $crate::narrow_phase::EdgeEdge;
                $result
            }
        }
    };
}
pub(crate) use with_pairing;

/// Four entries of a column, one for each vertex.
#[inline]
pub fn gather<T: Copy + Default>([a, b, c, d]: [u32; 4], column: &[T]) -> [T; 4] {
    // The compiler keeps these in registers, but not the result of `map`.
    [column.at(a as usize), column.at(b as usize), column.at(c as usize), column.at(d as usize)]
}

/// The vertices of four candidates, by their place in a candidate. If there are fewer than four, the last one is
/// repeated.
#[cfg_attr(small, inline(never))]
#[cfg_attr(not(small), inline(always))]
fn vertices_x4<P: Pairing>(surface: &Surface<'_>, candidates: &[[u32; 2]]) -> [[u32; 4]; 4] {
    let of = |candidate| P::vertices(surface, candidate);
    let [a, b, c, d] = first_four(candidates);
    let (a, b, c, d) = (of(a), of(b), of(c), of(d));
    let vertices = |k: usize| [a.at(k), b.at(k), c.at(k), d.at(k)];
    [vertices(0), vertices(1), vertices(2), vertices(3)]
}

/// The first four elements. If there are fewer than four, the last one is repeated.
#[inline(always)]
fn first_four<T: Copy + Default>(elements: &[T]) -> [T; 4] {
    match *elements {
        [a, b, c, d, ..] => [a, b, c, d],
        [a, b, c] => [a, b, c, c],
        [a, b] => [a, b, b, b],
        [a] => [a; 4],
        [] => Default::default(),
    }
}

/// Vectors of the vertices of four candidates.
#[cfg_attr(small, inline(never))]
#[cfg_attr(not(small), inline(always))]
fn gather_x4(&[a, b, c, d]: &[[u32; 4]; 4], column: &[Vec3]) -> [Vec3x4; 4] {
    let of = |vertices| Vec3x4::new(gather(vertices, column));
    [of(a), of(b), of(c), of(d)]
}

/// The nearest points of two features of a kind.
#[cfg_attr(small, inline(never))]
pub fn nearest(kind: Kind, x: &[Vec3; 4]) -> Nearest {
    with_pairing!(kind, P => P::nearest(x))
}

/// The contact of two features with nearest points at the positions `x` and a gap measured at the positions
/// `start`. `None` if the distance is zero and the features are too degenerate to have a normal.
#[cfg_attr(small, inline(never))]
pub fn contact(kind: Kind, vertices: [u32; 4], x: &[Vec3; 4], start: &[Vec3; 4], radius: Real) -> Option<Contact> {
    let Nearest { weights, between } = nearest(kind, x);
    let normal = match between.try_normalize() {
        Some(normal) => normal,
        None => with_pairing!(kind, P => P::direction(x))?,
    };
    let apart = |k: usize| (start.at(k) - start[3]) * weights.at(k);
    // The weights have sum 0, so relative positions give the same sum with less cancellation.
    let gap = normal.dot(apart(0) + apart(1) + apart(2)) - radius;
    Some(Contact { vertices, weights, normal, gap })
}

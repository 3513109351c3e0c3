//! Elements with `K` corners. The model computes their forces, their energy and their Jacobian.
//! Kernels gather: every element writes its own slots, then every vertex sums its slots in the
//! fixed order of its [`Incidence`].

use bytemuck::Pod;

use super::{Energy, Jacobian, TangentScale};
use crate::dispatch::Dispatch;
use crate::forces::matrix::{BlockMatrix, NOT_STORED, add};
use crate::mesh::Incidence;
use crate::real::{Mat3, Real, Vec3};

/// A force term over elements with `K` corners. `x` and `v` are the positions and velocities of the
/// corners. Every force is affine in `v`.
pub trait Element<const K: usize>: Sync {
    /// The packed form of one element's projected Jacobian.
    type Tangent: Pod + Send + Sync;

    /// The corners of every element.
    fn vertices(&self) -> &[[u32; K]];
    /// The element corners at each vertex.
    fn incidence(&self) -> Incidence<'_>;
    /// Forces on the corners, N.
    fn force(&self, element: usize, x: &[Vec3; K], v: &[Vec3; K]) -> [Vec3; K];
    /// Stored energy, J.
    fn energy(&self, element: usize, x: &[Vec3; K]) -> Energy;
    /// The projected Jacobian `-(position Kx + velocity Kv)`, positive semidefinite and packed.
    fn tangent(&self, element: usize, x: &[Vec3; K], scale: TangentScale) -> Self::Tangent;
    /// The 3x3 block of a packed Jacobian for the corners `a` (row) and `b` (column).
    fn block(&self, element: usize, tangent: &Self::Tangent, a: usize, b: usize) -> Mat3;
    /// `-(position df/dx + velocity df/dv)` without projection, by corners `[a][b]`. If `v` is not zero,
    /// the damping force makes it unsymmetric.
    fn exact(&self, element: usize, x: &[Vec3; K], v: &[Vec3; K], scale: TangentScale) -> [[Mat3; K]; K];
}

#[inline]
fn corners<const K: usize>(ids: &[u32; K], column: &[Vec3]) -> [Vec3; K] {
    ids.map(|i| column[i as usize])
}

/// Adds the term's forces to `f`, N. `scratch` has room for `K` vectors per element.
pub fn add_forces<const K: usize, E: Element<K>>(
    term: &E,
    x: &[Vec3],
    v: &[Vec3],
    scratch: &mut [Vec3],
    f: &mut [Vec3],
    dispatch: &impl Dispatch,
) {
    let vertices = term.vertices();
    let (slots, _) = scratch[..vertices.len() * K].as_chunks_mut::<K>();
    dispatch.run(slots, |start, part| {
        for (slot, (element, ids)) in part.iter_mut().zip(vertices.iter().enumerate().skip(start)) {
            *slot = term.force(element, &corners(ids, x), &corners(ids, v));
        }
    });
    let (forces, incidence) = (&*scratch, term.incidence());
    dispatch.run(f, |start, part| {
        for (vertex, f) in part.iter_mut().enumerate() {
            for &slot in incidence.at(start + vertex) {
                *f += forces[slot as usize];
            }
        }
    });
}

/// The energy that the term stores, J.
pub fn energy<const K: usize, E: Element<K>>(term: &E, x: &[Vec3]) -> Energy {
    let each = term.vertices().iter().enumerate();
    each.fold(Energy::default(), |sum, (element, ids)| sum + term.energy(element, &corners(ids, x)))
}

/// Adds `-(position Kx + velocity Kv)` to `matrix`. `assembly_map` is the place of each block in its
/// row. `scratch` has room for the packed Jacobians.
pub fn add_tangents<const K: usize, E: Element<K>>(
    term: &E,
    x: &[Vec3],
    scale: TangentScale,
    jacobian: Jacobian,
    assembly_map: &[u16],
    scratch: &mut [Real],
    matrix: &mut BlockMatrix<'_>,
    dispatch: &impl Dispatch,
) {
    let (vertices, incidence) = (term.vertices(), term.incidence());
    let packed = size_of::<E::Tangent>() / size_of::<Real>() * vertices.len();
    let tangents: &mut [E::Tangent] = bytemuck::cast_slice_mut(&mut scratch[..packed]);
    if jacobian == Jacobian::Projected {
        dispatch.run(&mut *tangents, |start, part| {
            for (slot, (element, ids)) in part.iter_mut().zip(vertices.iter().enumerate().skip(start)) {
                *slot = term.tangent(element, &corners(ids, x), scale);
            }
        });
    }
    let tangents = &*tangents;
    dispatch.run(matrix.rows_mut(), |start, mut rows| {
        for i in 0..rows.count() {
            let row = rows.row(i);
            for at in incidence.range(start + i) {
                let slot = incidence.slots[at] as usize;
                let (element, a) = (slot / K, slot % K);
                let assembly_map = &assembly_map[at * K..at * K + K];
                match jacobian {
                    Jacobian::Projected => {
                        for b in (0..K).filter(|&b| assembly_map[b] != NOT_STORED) {
                            add(&mut row[assembly_map[b] as usize], &term.block(element, &tangents[element], a, b));
                        }
                    }
                    // For studies only, so the blocks are recomputed for each corner and not stored.
                    // With v = 0 damping does not contribute to df/dx, and the matrix stays symmetric.
                    Jacobian::Exact => {
                        let x = corners(&vertices[element], x);
                        let blocks = term.exact(element, &x, &[Vec3::ZERO; K], scale);
                        for b in (0..K).filter(|&b| assembly_map[b] != NOT_STORED) {
                            add(&mut row[assembly_map[b] as usize], &blocks[a][b]);
                        }
                    }
                }
            }
        }
    });
}

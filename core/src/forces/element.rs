//! Elements with `K` corners. The model computes their forces, their energy and their Jacobian.
//! Kernels gather: every element writes its own slots, then every vertex sums its slots in the
//! fixed order of its [`Incidence`].

use bytemuck::Pod;

use super::matrix::{BlockMatrix, NOT_STORED, add};
use super::term::ForceTerm;
use super::{Energy, Jacobian, TangentScale, Term};
use crate::column::{Column, fault};
use crate::dispatch::Dispatch;
use crate::mesh::Incidence;
use crate::particles::Positions;
use crate::real::{Mat3, Real, Vec3};
use crate::scratch::MAY_BE_LEAN;
use crate::traffic::{SCALAR, TrafficSizes, VECTOR};

/// A force term over elements with `K` corners. `x` and `v` are the positions and velocities of the
/// corners, and only differences of positions count. Every force is affine in `v`.
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

/// A term whose kernels are those of an [`Element`]. It adds these facts about all its elements together.
pub trait ElementTerm {
    /// The corners of an element, `[u32; K]`.
    type Corners;

    /// Whether the forces at zero velocity are minus the slope of the energy. Otherwise the exact Jacobian is not
    /// symmetric, and the matrix has the projected one.
    const CONSERVATIVE: bool = true;

    /// Whether any force depends on velocities.
    fn dissipates(&self) -> bool;

    /// The largest strain rate at the velocities `v`, 1/s.
    fn strain_rate(&self, _v: &[Vec3]) -> Real {
        0.0
    }

    /// The largest rate at which edges stretch, 1/s.
    fn stretch_rate(&self, _x: &[Vec3], _v: &[Vec3]) -> Real {
        0.0
    }

    /// Bytes of the columns that only this term has: all but corners and incidence.
    fn material_bytes(&self) -> usize;
}

/// Adds the forces without scratch: computes those of an element for each of its corners.
fn add_recomputed<E: Element<K>, const K: usize>(
    term: &E,
    x: Positions<'_>,
    v: &[Vec3],
    f: &mut [Vec3],
    dispatch: &impl Dispatch,
) {
    let (vertices, incidence) = (term.vertices(), term.incidence());
    dispatch.run(f, |start, part| {
        for (vertex, f) in part.iter_mut().enumerate() {
            for &slot in incidence.at(start + vertex) {
                let (element, corner) = (slot as usize / K, slot as usize % K);
                let Some(ids) = vertices.element(element) else { return };
                *f += force_at(term, element, ids, x, v).at(corner);
            }
        }
    });
}

/// Not inlined: [`Element::force`] is inlined where scratch is there, which is the usual way.
#[inline(never)]
fn force_at<E: Element<K>, const K: usize>(
    term: &E,
    element: usize,
    ids: &[u32; K],
    x: Positions<'_>,
    v: &[Vec3],
) -> [Vec3; K] {
    term.force(element, &x.relative(ids), &v.gather(ids))
}

/// Not inlined for size: it would be there twice, for positions with and without rounding errors.
#[cfg_attr(small, inline(never))]
fn energy_at<E: Element<K>, const K: usize>(term: &E, element: usize, ids: &[u32; K], x: Positions<'_>) -> Energy {
    term.energy(element, &x.relative(ids))
}

impl<E: ElementTerm<Corners = [u32; K]> + Element<K>, const K: usize> ForceTerm for E {
    fn add_forces(
        &self,
        _: &[Real],
        x: Positions<'_>,
        v: &[Vec3],
        scratch: &mut [Vec3],
        f: &mut [Vec3],
        dispatch: &impl Dispatch,
    ) {
        let vertices = self.vertices();
        if MAY_BE_LEAN && scratch.len() < vertices.len() * K {
            return add_recomputed(self, x, v, f, dispatch);
        }
        let (slots, _) = scratch.part_mut(..vertices.len() * K).as_chunks_mut::<K>();
        dispatch.run(slots, |start, part| {
            for (slot, (element, ids)) in part.iter_mut().zip(vertices.iter().enumerate().skip(start)) {
                *slot = self.force(element, &x.relative(ids), &v.gather(ids));
            }
        });
        let (forces, incidence) = (&*scratch, self.incidence());
        dispatch.run(f, |start, part| {
            for (vertex, f) in part.iter_mut().enumerate() {
                for &slot in incidence.at(start + vertex) {
                    let Some(&force) = forces.element(slot as usize) else { return };
                    *f += force;
                }
            }
        });
    }

    fn energy(&self, _: Term, _: &[Real], x: Positions<'_>) -> Energy {
        if !E::CONSERVATIVE {
            return Energy::default();
        }
        let each = self.vertices().iter().enumerate();
        each.fold(Energy::default(), |sum, (element, ids)| sum + energy_at(self, element, ids, x))
    }

    /// A Jacobian that is not symmetric is always projected.
    fn add_tangents(
        &self,
        x: &[Vec3],
        scale: TangentScale,
        jacobian: Jacobian,
        slots: &[u16],
        scratch: &mut [Real],
        matrix: &mut BlockMatrix<'_>,
        dispatch: &impl Dispatch,
    ) {
        let jacobian = if E::CONSERVATIVE { jacobian } else { Jacobian::Projected };
        let (vertices, incidence) = (self.vertices(), self.incidence());
        let scratch = scratch.part_mut(..self.tangent_scratch());
        let Ok(tangents) = bytemuck::try_cast_slice_mut::<_, E::Tangent>(scratch) else { return fault() };
        if jacobian == Jacobian::Projected {
            dispatch.run(&mut *tangents, |start, part| {
                for (slot, (element, ids)) in part.iter_mut().zip(vertices.iter().enumerate().skip(start)) {
                    *slot = self.tangent(element, &x.gather(ids), scale);
                }
            });
        }
        let tangents = &*tangents;
        dispatch.run(matrix.rows_mut(), |start, mut rows| {
            for i in 0..rows.count() {
                let row = rows.row(i);
                let range = incidence.range(start + i);
                let (places, _) = slots.part(range.start * K..range.end * K).as_chunks::<K>();
                for (&slot, places) in incidence.slots.part(range).iter().zip(places) {
                    let (element, a) = (slot as usize / K, slot as usize % K);
                    match jacobian {
                        Jacobian::Projected => {
                            let Some(tangent) = tangents.element(element) else { return };
                            for b in (0..K).filter(|&b| places.at(b) != NOT_STORED) {
                                let Some(block) = row.element_mut(places.at(b) as usize) else { return };
                                add(block, &self.block(element, tangent, a, b));
                            }
                        }
                        // For studies only, so the blocks are recomputed for each corner and not stored.
                        // With v = 0 damping does not contribute to df/dx, and the matrix stays symmetric.
                        Jacobian::Exact => {
                            let Some(ids) = vertices.element(element) else { return };
                            let blocks = self.exact(element, &x.gather(ids), &[Vec3::ZERO; K], scale);
                            let Some(blocks) = blocks.element(a) else { return };
                            for (&place, block) in places.iter().zip(blocks).filter(|&(&place, _)| place != NOT_STORED)
                            {
                                let Some(sum) = row.element_mut(place as usize) else { return };
                                add(sum, block);
                            }
                        }
                    }
                }
            }
        });
    }

    fn blocks(&self) -> impl Iterator<Item = (u32, u32)> {
        self.incidence().slots.iter().flat_map(|&slot| {
            let Some(ids) = self.vertices().element(slot as usize / K) else { return [(0, 0); K] };
            ids.map(|column| (ids.at(slot as usize % K), column))
        })
    }

    fn is_conservative(&self) -> bool {
        E::CONSERVATIVE
    }

    fn has_jacobian(&self) -> bool {
        true
    }

    fn dissipates(&self) -> bool {
        ElementTerm::dissipates(self)
    }

    fn strain_rate(&self, v: &[Vec3]) -> Real {
        ElementTerm::strain_rate(self, v)
    }

    fn stretch_rate(&self, x: &[Vec3], v: &[Vec3]) -> Real {
        ElementTerm::stretch_rate(self, x, v)
    }

    /// The forces on the corners.
    fn force_scratch(&self) -> usize {
        K * self.vertices().len()
    }

    /// The packed Jacobians.
    fn tangent_scratch(&self) -> usize {
        size_of::<E::Tangent>() / size_of::<Real>() * self.vertices().len()
    }

    fn bytes(&self) -> usize {
        size_of_val(self.vertices()) + self.incidence().bytes() + self.material_bytes()
    }

    /// The element pass writes the scratch, the gather reads it. Per vertex, the positions and velocities are read,
    /// the forces read and written.
    fn force_traffic(&self, vertices: usize) -> usize {
        self.bytes() + 2 * self.force_scratch() * VECTOR + 4 * vertices * VECTOR
    }

    /// The packed Jacobians are written and read, the slots and the matrix as well.
    fn tangent_traffic(&self, sizes: TrafficSizes) -> usize {
        let slots = 2 * K * K * self.vertices().len();
        self.bytes() + 2 * self.tangent_scratch() * SCALAR + slots + sizes.assembly()
    }
}

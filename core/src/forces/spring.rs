//! Linear springs, f = k (r - l) u, with damping along the spring, f = kd (w . u) u
//! [Provot 1996; eqs. 3.1, 3.2].
//!
//! Every spring is stored at both of its ends, so that a vertex sums its springs in one pass.
//! Computing each spring twice costs less than storing and gathering its force.

use super::matrix::{BlockMatrix, NOT_STORED, add};
use super::term::ForceTerm;
use super::{Energy, Jacobian, TangentScale, Term};
use crate::column::{Column, fault};
use crate::dispatch::Dispatch;
use crate::particles::Positions;
use crate::real::{DEGENERATE, Lanes, Mat3, Real, SEES_ROUNDING, Sum, Vec3, outer, scaled_identity, sqrt};
use crate::traffic::{TrafficSizes, VECTOR};

/// Springs as seen from each vertex (CSR).
#[derive(Clone, Copy, Debug)]
pub struct Springs<'a> {
    /// Start of each vertex's springs; one entry more than vertices.
    pub offsets: &'a [u32],
    /// The vertex at the other end of each spring.
    pub others: &'a [u32],
    /// Rest length, m.
    pub rest: &'a [Real],
    /// k, N/m.
    pub stiffness: &'a [Real],
    /// kd, N s/m; empty if no spring is damped.
    pub damping: &'a [Real],
}

/// One spring.
#[derive(Clone, Copy, Debug)]
pub struct Spring {
    /// Rest length, m.
    pub rest: Real,
    /// k, N/m.
    pub stiffness: Real,
    /// kd, N s/m.
    pub damping: Real,
}

impl Springs<'_> {
    /// Number of springs. Each is counted once, although both of its ends store it.
    pub fn count(&self) -> usize {
        self.others.len() / 2
    }

    #[inline]
    fn range(&self, vertex: usize) -> core::ops::Range<usize> {
        let &[first, end] = self.offsets.part(vertex..vertex + 2) else { return 0..0 };
        first as usize..end as usize
    }

    /// The springs of a vertex, each with the vertex at its other end.
    #[inline]
    fn of(&self, vertex: usize) -> impl Iterator<Item = (u32, Spring)> {
        let range = self.range(vertex);
        let (others, rest) = (self.others.part(range.clone()), self.rest.part(range.clone()));
        let damping = self.damping.get(range.clone()).unwrap_or_default();
        let columns = others.iter().zip(rest).zip(self.stiffness.part(range));
        columns.enumerate().map(|(i, ((&other, &rest), &stiffness))| {
            (other, Spring { rest, stiffness, damping: damping.get(i).copied().unwrap_or(0.0) })
        })
    }
}

/// Elastic force on the near end, N. `d` is the vector to the far end. Zero if the ends coincide.
#[inline]
pub fn elastic_force(d: Vec3, rest: Real, stiffness: Real) -> Vec3 {
    let r = sqrt(d.length_squared());
    if r <= DEGENERATE * rest { Vec3::ZERO } else { d * (stiffness * (1.0 - rest / r)) }
}

/// Damping force on the near end, N. `w` is the velocity of the far end minus the velocity of the near
/// end.
#[inline]
pub fn damping_force(d: Vec3, w: Vec3, spring: &Spring) -> Vec3 {
    let square = d.length_squared();
    let least = DEGENERATE * spring.rest;
    if square <= least * least { Vec3::ZERO } else { d * (spring.damping * w.dot(d) / square) }
}

/// Stored energy, J.
#[inline]
pub fn energy(d: Vec3, spring: &Spring) -> Sum {
    let stretched = Sum::from(sqrt(d.length_squared()) - spring.rest);
    0.5 * Sum::from(spring.stiffness) * stretched * stretched
}

/// `position df_near/dx_far + velocity df_near/dv_far`, positive semidefinite. The transverse part
/// would be negative under compression and is left out there [Choi 2002].
#[inline]
pub fn tangent(d: Vec3, spring: &Spring, scale: TangentScale) -> Mat3 {
    let k = scale.position * spring.stiffness;
    let Some((u, r)) = direction(d, spring.rest) else { return scaled_identity(k) };
    let across = k * (1.0 - spring.rest / r).max(0.0);
    scaled_identity(across) + outer(u * (k - across + scale.velocity * spring.damping), u)
}

/// `position df_near/dx_far + velocity df_near/dv_far` without projection. With damping it is not
/// symmetric if `w` is not zero.
pub fn exact(d: Vec3, w: Vec3, spring: &Spring, scale: TangentScale) -> Mat3 {
    let k = scale.position * spring.stiffness;
    let Some((u, r)) = direction(d, spring.rest) else { return scaled_identity(k) };
    let across = k * (1.0 - spring.rest / r);
    let elastic = scaled_identity(across) + outer(u * (k - across), u);
    let project = Mat3::IDENTITY - outer(u, u);
    let turned = project * w.dot(u) + outer(u, project * w);
    elastic + turned * (scale.position * spring.damping / r) + outer(u * (scale.velocity * spring.damping), u)
}

#[inline]
fn direction(d: Vec3, rest: Real) -> Option<(Vec3, Real)> {
    let r = sqrt(d.length_squared());
    (r > DEGENERATE * rest).then(|| (d / r, r))
}

/// The elastic force of all springs on a vertex, N: [`elastic_force`] for four springs at a time.
/// `None` if an index is out of range, so that the loop has one way out.
#[inline(always)]
fn elastic_sum(springs: &Springs<'_>, x: Positions<'_>, vertex: usize) -> Option<Vec3> {
    let range = springs.range(vertex);
    let (others, last_others) = springs.others.get(range.clone())?.as_chunks::<4>();
    let (rest, last_rest) = springs.rest.get(range.clone())?.as_chunks::<4>();
    let (stiffness, last_stiffness) = springs.stiffness.get(range)?.as_chunks::<4>();
    let mut sum = [Lanes::ZERO; 3];
    for ((others, rest), stiffness) in others.iter().zip(rest).zip(stiffness) {
        add_four(&mut sum, towards_four(x, vertex, *others)?, Lanes::new(*rest), Lanes::new(*stiffness));
    }
    let [sum_x, sum_y, sum_z] = sum.map(|lanes| lanes.to_array().iter().sum());
    let mut sum = Vec3::new(sum_x, sum_y, sum_z);
    for ((&other, &rest), &stiffness) in last_others.iter().zip(last_rest).zip(last_stiffness) {
        sum += elastic_force(x.between(vertex as u32, other), rest, stiffness);
    }
    Some(sum)
}

/// [`Positions::between`] a vertex and four others.
#[inline(always)]
fn towards_four(x: Positions<'_>, vertex: usize, others: [u32; 4]) -> Option<[Lanes; 3]> {
    let mut d = lanes_towards(x.rounded, others, x.rounded.get(vertex)?)?;
    if SEES_ROUNDING && !x.low.is_empty() {
        let low = lanes_towards(x.low, others, x.low.get(vertex)?)?;
        for (d, low) in d.iter_mut().zip(low) {
            *d += low;
        }
    }
    Some(d)
}

/// The vectors to four vertices by axis, one vertex in each lane. Written out: arrays of vectors would go through
/// memory.
#[inline(always)]
fn lanes_towards(x: &[Vec3], [a, b, c, d]: [u32; 4], near: &Vec3) -> Option<[Lanes; 3]> {
    let (a, b) = (x.get(a as usize)?, x.get(b as usize)?);
    let (c, d) = (x.get(c as usize)?, x.get(d as usize)?);
    Some([
        Lanes::new([a.x, b.x, c.x, d.x]) - Lanes::splat(near.x),
        Lanes::new([a.y, b.y, c.y, d.y]) - Lanes::splat(near.y),
        Lanes::new([a.z, b.z, c.z, d.z]) - Lanes::splat(near.z),
    ])
}

#[inline(always)]
fn add_four(sum: &mut [Lanes; 3], d: [Lanes; 3], rest: Lanes, stiffness: Lanes) {
    let r = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    let apart = r.simd_gt(rest * Lanes::splat(DEGENERATE));
    let factor = apart & (stiffness * (Lanes::splat(1.0) - rest / r));
    for (sum, d) in sum.iter_mut().zip(d) {
        *sum += d * factor;
    }
}

impl ForceTerm for Springs<'_> {
    fn add_forces(
        &self,
        _: &[Real],
        x: Positions<'_>,
        v: &[Vec3],
        _: &mut [Vec3],
        f: &mut [Vec3],
        dispatch: &impl Dispatch,
    ) {
        dispatch.run(f, |start, part| {
            for (vertex, f) in (start..).zip(part.iter_mut()) {
                let Some(sum) = elastic_sum(self, x, vertex) else { return fault() };
                *f += sum;
            }
            if !self.damping.is_empty() {
                for (vertex, f) in (start..).zip(part) {
                    let near = v.at(vertex);
                    for (other, spring) in self.of(vertex) {
                        let Some(&far) = v.element(other as usize) else { return };
                        let d = x.between(vertex as u32, other);
                        *f += damping_force(d, far - near, &spring);
                    }
                }
            }
        });
    }

    fn energy(&self, name: Term, _: &[Real], x: Positions<'_>) -> Energy {
        let at_vertex = |vertex: usize| -> Sum {
            self.of(vertex).map(|(other, spring)| energy(x.between(vertex as u32, other), &spring)).sum()
        };
        // The sum has every spring twice, once per end.
        let stored = 0.5 * (0..x.rounded.len()).map(at_vertex).sum::<Sum>();
        if name == Term::BendSpring {
            Energy { bend: stored, ..Energy::default() }
        } else {
            Energy { stretch: stored, ..Energy::default() }
        }
    }

    fn add_tangents(
        &self,
        x: &[Vec3],
        scale: TangentScale,
        jacobian: Jacobian,
        slots: &[u16],
        _: &mut [Real],
        matrix: &mut BlockMatrix<'_>,
        dispatch: &impl Dispatch,
    ) {
        dispatch.run(matrix.rows_mut(), |start, mut rows| {
            for i in 0..rows.count() {
                let row = rows.row(i);
                let (near, places) = (x.at(start + i), slots.part(self.range(start + i)));
                for ((other, spring), &place) in self.of(start + i).zip(places) {
                    let Some(&far) = x.element(other as usize) else { return };
                    let d = far - near;
                    let block = match jacobian {
                        Jacobian::Projected => tangent(d, &spring, scale),
                        Jacobian::Exact => exact(d, Vec3::ZERO, &spring, scale),
                    };
                    let Some(diagonal) = row.element_mut(0) else { return };
                    add(diagonal, &block);
                    if place != NOT_STORED {
                        let Some(stored) = row.element_mut(place as usize) else { return };
                        add(stored, &-block);
                    }
                }
            }
        });
    }

    fn blocks(&self) -> impl Iterator<Item = (u32, u32)> {
        let row =
            move |vertex: usize| self.others.part(self.range(vertex)).iter().map(move |&other| (vertex as u32, other));
        (0..self.offsets.len().saturating_sub(1)).flat_map(row)
    }

    fn has_jacobian(&self) -> bool {
        true
    }

    fn dissipates(&self) -> bool {
        !self.damping.is_empty()
    }

    /// The largest relative velocity of two ends over the rest length, 1/s.
    fn strain_rate(&self, v: &[Vec3]) -> Real {
        let squares = (0..self.offsets.len().saturating_sub(1)).flat_map(|vertex| {
            self.of(vertex).map(move |(other, spring)| {
                let apart = v.at(other as usize) - v.at(vertex);
                apart.length_squared() / (spring.rest * spring.rest)
            })
        });
        sqrt(squares.fold(0.0, Real::max))
    }

    /// The largest rate of change of the length of a spring over its rest length, 1/s.
    fn stretch_rate(&self, x: &[Vec3], v: &[Vec3]) -> Real {
        let rates = (0..self.offsets.len().saturating_sub(1)).flat_map(|vertex| {
            self.of(vertex).map(move |(other, spring)| {
                let towards = |column: &[Vec3]| column.at(other as usize) - column.at(vertex);
                towards(v).dot(towards(x)).abs() / (spring.rest * spring.rest)
            })
        });
        rates.fold(0.0, Real::max)
    }

    fn bytes(&self) -> usize {
        let scalars = [self.rest, self.stiffness, self.damping];
        size_of_val(self.offsets) + size_of_val(self.others) + scalars.map(size_of_val).iter().sum::<usize>()
    }

    /// Reads the positions, reads and writes the forces.
    fn force_traffic(&self, vertices: usize) -> usize {
        self.bytes() + 3 * vertices * VECTOR
    }

    fn tangent_traffic(&self, sizes: TrafficSizes) -> usize {
        self.bytes() + 2 * self.others.len() + sizes.assembly()
    }
}

/// The owned columns of [`Springs`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct SpringColumns {
    offsets: alloc::vec::Vec<u32>,
    others: alloc::vec::Vec<u32>,
    rest: alloc::vec::Vec<Real>,
    stiffness: alloc::vec::Vec<Real>,
    damping: alloc::vec::Vec<Real>,
}

#[cfg(feature = "alloc")]
impl SpringColumns {
    /// The columns of springs that are given by pairs of vertices.
    #[cfg_attr(small, optimize(size))]
    pub fn build(vertices: usize, springs: &[([u32; 2], Spring)]) -> Self {
        let ends: alloc::vec::Vec<[u32; 2]> = springs.iter().map(|(ends, _)| *ends).collect();
        let incidence = crate::mesh::IncidenceColumns::build(vertices, &ends);
        let incidence = incidence.view();
        let stored = || incidence.slots.iter().map(|&slot| (slot as usize / 2, slot as usize % 2));
        let damped = springs.iter().any(|(_, s)| s.damping > 0.0);
        Self {
            offsets: incidence.offsets.into(),
            others: stored().map(|(spring, end)| ends[spring][1 - end]).collect(),
            rest: stored().map(|(spring, _)| springs[spring].1.rest).collect(),
            stiffness: stored().map(|(spring, _)| springs[spring].1.stiffness).collect(),
            damping: stored().filter(|_| damped).map(|(spring, _)| springs[spring].1.damping).collect(),
        }
    }

    /// The borrowed view that kernels take.
    pub fn view(&self) -> Springs<'_> {
        Springs {
            offsets: &self.offsets,
            others: &self.others,
            rest: &self.rest,
            stiffness: &self.stiffness,
            damping: &self.damping,
        }
    }
}

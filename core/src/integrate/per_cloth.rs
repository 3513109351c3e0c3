//! The cloths of a solve: the residual at which each is solved, and its motion as a whole. In one sum the residual of a
//! light cloth would not count beside that of a heavy one.

use core::ops::Range;

use glam::DVec3;

use super::columns::{PART, dot};
use super::convex_term::ConvexTerm;
use super::pins::Pins;
use crate::column::Column;
use crate::real::{Mat3, Real, Sum, Vec3, cross, scaled_identity, sqrt, to_f64, vec3};
use crate::rigid_body::RigidBody;

/// Squared velocity that a cloth changes by at least, relative to the mean of all cloths: one that only contact moves has
/// no residual at the start.
const QUIET: Sum = 1e-4;

/// A cloth in a solve.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ClothSolve {
    /// The number after its last vertex.
    end: u32,
    /// Whether no pin holds an axis of it: 1, else 0.
    free: u32,
    /// The cloth as if it were rigid.
    pub(super) body: RigidBody,
    /// The square of the preconditioned residual at which it is solved; before the solve the reference for it.
    pub(super) target: Sum,
    /// The root of the mean square of its distance from the axes of rotation, m.
    pub(super) radius: Sum,
    /// The second derivatives for its translation and its rotation as a whole, without elasticity, kg. The velocity of a
    /// rotation is that at its radius.
    pub(super) blocks: [Mat3; 2],
}

impl ClothSolve {
    /// The number after its last vertex.
    pub(crate) fn end(&self) -> u32 {
        self.end
    }

    /// A cloth of the vertices up to `end`, from the end of the cloth before.
    pub fn up_to(end: u32) -> Self {
        Self { end, ..Self::default() }
    }

    /// Whether no pin holds an axis of it.
    pub(super) fn is_free(&self) -> bool {
        self.free != 0
    }

    /// The place of a vertex relative to the centre, in radii.
    pub(super) fn arm(&self, x: Vec3) -> Vec3 {
        vec3(((DVec3::from(to_f64(x)) - self.body.centre) / self.radius).into())
    }

    /// The impulse and, over the radius, the moment of a column of impulses at these positions, kg m/s.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub(super) fn wrench(&self, x: &[Vec3], column: &[Vec3]) -> [DVec3; 2] {
        let values = || column.iter().map(|&r| DVec3::from(to_f64(r)));
        [values().sum(), self.body.moment(x, values()) / self.radius]
    }
}

/// The vertices of a cloth.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn range(cloths: &[ClothSolve], index: usize) -> Range<usize> {
    let end = |index: usize| cloths.element(index).map_or(0, |cloth| cloth.end as usize);
    index.checked_sub(1).map_or(0, end)..end(index)
}

/// Writes the masses and inertias at these positions, m, and which cloths are free.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn start(cloths: &mut [ClothSolve], masses: &[Real], x: &[Vec3], pins: &Pins<'_>) {
    let mut first = 0;
    for cloth in &mut *cloths {
        let own = first..cloth.end as usize;
        first = own.end;
        let body = RigidBody::of(masses.part(own.clone()), x.part(own));
        let [a, b, c] = body.inertia;
        // Of cloth that lies in a point, all moments are zero.
        let radius = libm::sqrt((a.x + b.y + c.z) / (3.0 * body.mass)).max(Sum::MIN_POSITIVE);
        *cloth = ClothSolve { free: 1, body, radius, ..ClothSolve::up_to(cloth.end) };
    }
    for (&vertex, _) in pins.vertices.iter().zip(pins.axes).filter(|&(_, &axes)| axes != 0) {
        let index = cloth_of(cloths, vertex);
        if let Some(cloth) = cloths.get_mut(index) {
            cloth.free = 0;
        }
    }
}

/// The cloth of a vertex; their number for that of a collider.
fn cloth_of(cloths: &[ClothSolve], vertex: u32) -> usize {
    cloths.partition_point(|cloth| cloth.end <= vertex)
}

/// Writes the second derivatives for motions of the cloths as a whole from these positions, m.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn write_blocks(cloths: &mut [ClothSolve], x: &[Vec3], term: &dyn ConvexTerm) {
    for cloth in &mut *cloths {
        let [a, b, c] = cloth.body.inertia.map(|column| vec3((column / (cloth.radius * cloth.radius)).into()));
        cloth.blocks = [scaled_identity(cloth.body.mass as Real), Mat3::from_cols(a, b, c)];
    }
    term.visit_curvature(&mut |part| {
        let owners = part.vertices.map(|vertex| cloth_of(cloths, vertex));
        for ((&owner, weight), vertex) in owners.iter().zip(part.weights).zip(part.vertices) {
            if let Some(cloth) = cloths.get_mut(owner) {
                let lever = |vertex: u32, weight: Real| cloth.arm(x.at(vertex as usize)) * weight;
                let own =
                    owners.iter().zip(part.vertices.iter().zip(part.weights)).filter(|&(&other, _)| other == owner);
                let sum = |(sum, levers): (Real, Vec3), (_, (&vertex, weight))| {
                    (sum + weight, levers + lever(vertex, weight))
                };
                let (sum, levers) = own.fold((0.0, Vec3::ZERO), sum);
                let lever = cross(lever(vertex, weight));
                cloth.blocks[0] += part.matrix * (weight * sum);
                cloth.blocks[1] += lever.transpose() * part.matrix * cross(levers);
            }
        }
    });
}

/// Raises the references of cloths that hardly move to that of a slight motion.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn raise_quiet(cloths: &mut [ClothSolve]) {
    let [reference, mass] = cloths.iter().fold([0.0; 2], |[a, b], cloth| [a + cloth.target, b + cloth.body.mass]);
    for cloth in cloths {
        cloth.target = cloth.target.max(QUIET * reference * cloth.body.mass / mass);
    }
}

/// The inner product of two columns, in parts: one sum in the crate's precision would lose digits.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn product(a: &[Vec3], b: &[Vec3]) -> Sum {
    a.chunks(PART).zip(b.chunks(PART)).map(|(a, b)| dot(a, b)).sum()
}

/// The largest root mean square of a column over the vertices of a cloth; NaN if any is.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn largest_root_mean_square(cloths: &[ClothSolve], column: &[Vec3]) -> Real {
    let of = |index: usize| {
        let own = column.part(range(cloths, index));
        sqrt((product(own, own) / own.len() as Sum) as Real)
    };
    (0..cloths.len()).map(of).fold(0.0, |most, own| if own > most || own.is_nan() { own } else { most })
}

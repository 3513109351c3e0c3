//! The cloths of a solve: the residual at which each is solved, and its motion as a whole. In one sum the residual of a
//! light cloth would not count beside that of a heavy one.

use core::ops::Range;

use glam::DVec3;

use super::columns::{PART, dot};
use super::convex_term::ConvexTerm;
use super::pins::Pins;
use crate::real::{Mat3, Real, Sum, Vec3, scaled_identity, sqrt, to_f64};

/// Squared velocity that a cloth changes by at least, relative to the mean of all cloths: one that only contact moves has
/// no residual at the start.
const QUIET: Sum = 1e-4;

/// A cloth in a solve.
#[derive(Clone, Copy, Debug, Default)]
pub struct ClothSolve {
    /// The number after its last vertex.
    end: u32,
    /// Whether no pin holds an axis of it.
    pub(super) is_free: bool,
    /// Its mass, kg.
    pub(super) mass: Sum,
    /// The square of the preconditioned residual at which it is solved; before the solve the reference for it.
    pub(super) target: Sum,
    /// The second derivative for its motion as a whole, without elasticity, kg.
    pub(super) block: Mat3,
}

impl ClothSolve {
    /// A cloth of the vertices up to `end`, from the end of the cloth before.
    pub fn up_to(end: u32) -> Self {
        Self { end, ..Self::default() }
    }
}

/// The vertices of a cloth.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn range(cloths: &[ClothSolve], index: usize) -> Range<usize> {
    let start = index.checked_sub(1).map_or(0, |before| cloths[before].end);
    start as usize..cloths[index].end as usize
}

/// Writes the masses, and which cloths are free.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn start(cloths: &mut [ClothSolve], masses: &[Real], pins: &Pins<'_>) {
    for index in 0..cloths.len() {
        let mass = masses[range(cloths, index)].iter().map(|&m| Sum::from(m)).sum();
        cloths[index] = ClothSolve { is_free: true, mass, ..ClothSolve::up_to(cloths[index].end) };
    }
    for (&vertex, _) in pins.vertices.iter().zip(pins.axes).filter(|&(_, &axes)| axes != 0) {
        let index = cloth_of(cloths, vertex);
        if let Some(cloth) = cloths.get_mut(index) {
            cloth.is_free = false;
        }
    }
}

/// The cloth of a vertex; their number for that of a collider.
fn cloth_of(cloths: &[ClothSolve], vertex: u32) -> usize {
    cloths.partition_point(|cloth| cloth.end <= vertex)
}

/// Writes the second derivatives for motions of the cloths as a whole.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn write_blocks(cloths: &mut [ClothSolve], term: &dyn ConvexTerm) {
    for cloth in &mut *cloths {
        cloth.block = scaled_identity(cloth.mass as Real);
    }
    term.visit_curvature(&mut |part| {
        let owners = part.vertices.map(|vertex| cloth_of(cloths, vertex));
        for (&owner, weight) in owners.iter().zip(part.weights) {
            if let Some(cloth) = cloths.get_mut(owner) {
                let own = owners.iter().zip(part.weights).filter(|&(&other, _)| other == owner);
                cloth.block += part.matrix * (weight * own.map(|(_, weight)| weight).sum::<Real>());
            }
        }
    });
}

/// Raises the references of cloths that hardly move to that of a slight motion.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn raise_quiet(cloths: &mut [ClothSolve]) {
    let [reference, mass] = cloths.iter().fold([0.0; 2], |[a, b], cloth| [a + cloth.target, b + cloth.mass]);
    for cloth in cloths {
        cloth.target = cloth.target.max(QUIET * reference * cloth.mass / mass);
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
        let own = &column[range(cloths, index)];
        sqrt((product(own, own) / own.len() as Sum) as Real)
    };
    (0..cloths.len()).map(of).fold(0.0, |most, own| if own > most || own.is_nan() { own } else { most })
}

/// The sum of a column.
#[cfg_attr(small, optimize(size), inline(never))]
pub fn sum(column: &[Vec3]) -> DVec3 {
    column.iter().map(|&r| DVec3::from(to_f64(r))).sum()
}

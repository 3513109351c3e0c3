//! Boxes rounded outward to integers, and the spheres around those.
//!
//! Rounding is monotone: boxes that overlap still do in integers, and then so do the spheres. The
//! scale is a power of two, so that an integer does not depend on how a compiler orders
//! `(x - origin) scale`.

use bytemuck::{Pod, Zeroable};

use super::levels::NO_LEVEL;
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;
use crate::real::{Real, Vec3, to_f32};

/// Units across the largest box of a level: 2^9 to 2^10.
const FINE: i32 = 9;

/// Coordinates stay below 2^27, so that sums and small multiples are an i32.
const RANGE: i32 = 26;

/// From metres to units.
#[derive(Clone, Copy, Debug)]
pub struct Quantum {
    /// The corner that becomes zero, m.
    pub origin: Vec3,
    /// Units a metre, a power of two.
    pub scale: Real,
}

/// The sphere around a box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Sphere {
    /// Twice the centre, units.
    pub center: [i32; 3],
    /// Square of twice the radius: of the box's diagonal, units^2.
    pub diagonal_squared: u32,
}

impl Sphere {
    /// Of a triangle that does not take part.
    pub const ABSENT: Self = Self { center: [-1; 3], diagonal_squared: 0 };
}

impl Quantum {
    /// For boxes of up to `extent` in a scene; both at most the greatest f32.
    pub fn new(scene: &Aabb, extent: f32) -> Self {
        let size = scene.max - scene.min;
        let whole = to_f32(size.x.max(size.y).max(size.z));
        let shift = (FINE - exponent(extent)).min(RANGE - exponent(whole)).clamp(-126, 127);
        Self { origin: scene.min, scale: f32::from_bits(((shift + 127) as u32) << 23) as Real }
    }

    /// A corner in units, from 0 to 2^27.
    #[inline(always)]
    pub fn apply(&self, corner: Vec3) -> [i32; 3] {
        const MOST: Real = (1 << (RANGE + 1)) as Real;
        let v = (corner - self.origin) * self.scale;
        [v.x, v.y, v.z].map(|v| v.clamp(0.0, MOST) as i32)
    }
}

/// Of the power of two at or below a positive number; low for zero.
fn exponent(x: f32) -> i32 {
    (x.to_bits() >> 23) as i32 - 127
}

/// Writes the sphere of every triangle up to a level.
pub fn write_spheres(
    triangle_boxes: &[Aabb],
    levels: &[u8],
    level: u8,
    quantum: &Quantum,
    spheres: &mut [Sphere],
    dispatch: &impl Dispatch,
) {
    debug_assert!(level != NO_LEVEL);
    dispatch.run(spheres, |start, part| {
        for ((b, &own), out) in triangle_boxes[start..].iter().zip(&levels[start..]).zip(part) {
            if own > level {
                *out = Sphere::ABSENT;
                continue;
            }
            let (min, max) = (quantum.apply(b.min), quantum.apply(b.max));
            let square = |k: usize| ((max[k] - min[k]) * (max[k] - min[k])) as u32;
            *out = Sphere {
                center: [min[0] + max[0], min[1] + max[1], min[2] + max[2]],
                diagonal_squared: square(0) + square(1) + square(2),
            };
        }
    });
}

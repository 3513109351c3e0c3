//! Spheres around the quantized boxes of triangles, in units. If two boxes overlap, their spheres overlap too.

use bytemuck::{Pod, Zeroable};

use super::quantized_boxes::QuantizedBox;
use crate::column::Column;
use crate::dispatch::Dispatch;

/// The sphere around a box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Sphere {
    /// Twice the centre, units.
    pub center: [i32; 3],
    /// Square of twice the radius, which is the diagonal of the box, units^2.
    pub diagonal_squared: u32,
}

impl Sphere {
    /// Marks a triangle that does not take part in this level.
    pub const ABSENT: Self = Self { center: [-1; 3], diagonal_squared: 0 };
}

/// Writes the spheres of all triangles on levels up to `level`, and [`Sphere::ABSENT`] for the others.
pub fn write_spheres(
    quantized_boxes: &[QuantizedBox],
    triangles: &[[u32; 3]],
    levels: &[u8],
    level: u8,
    spheres: &mut [Sphere],
    dispatch: &impl Dispatch,
) {
    dispatch.run(spheres, |start, part| {
        for ((triangle, &own), out) in triangles.part(start..).iter().zip(levels.part(start..)).zip(part) {
            *out = if own <= level {
                let [a, b, c] = quantized_boxes.gather(triangle);
                around(&a.union(&b).union(&c))
            } else {
                Sphere::ABSENT
            };
        }
    });
}

#[inline(always)]
fn around(&QuantizedBox([x, y, z, u, v, w]): &QuantizedBox) -> Sphere {
    let square = |size: i32| (size * size) as u32;
    Sphere { center: [x + u, y + v, z + w], diagonal_squared: square(u - x) + square(v - y) + square(w - z) }
}

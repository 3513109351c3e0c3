//! The boxes of vertices, quantized: both corners are rounded down to integers.
//!
//! Rounding is monotone, so boxes that overlap still overlap afterwards. The scale is a power of two, so that the
//! integers do not depend on how a compiler orders `(x - origin) scale`.

use bytemuck::{Pod, Zeroable};

use super::bounds::is_valid;
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;
use crate::real::{Real, Vec3, to_f32};

/// The largest box of a level measures from 2^9 to 2^10 units, or less if the scene is too large for that.
const FINE: i32 = 9;

/// Coordinates stay below 2^27, so that their sums and small multiples fit an i32.
const RANGE: i32 = 26;

/// The map from metres to integer units.
#[derive(Clone, Copy, Debug)]
pub struct Quantization {
    /// The corner that becomes zero, m.
    pub origin: Vec3,
    /// Units per metre, a power of two.
    pub scale: Real,
}

/// A box in units: the three minima, then the three maxima.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct QuantizedBox(pub [i32; 6]);

impl QuantizedBox {
    /// The box that contains nothing. Its coordinates are small enough to be multiplied.
    pub const EMPTY: Self = Self([1 << (RANGE + 1), 1 << (RANGE + 1), 1 << (RANGE + 1), 0, 0, 0]);

    /// The smallest box around both boxes.
    #[inline(always)]
    pub fn union(&self, other: &Self) -> Self {
        let outer = |k: usize| {
            let (own, other) = (self.0.at(k), other.0.at(k));
            if k < 3 { own.min(other) } else { own.max(other) }
        };
        Self(core::array::from_fn(outer))
    }
}

impl Quantization {
    /// The map for boxes with extents up to `extent` in a scene. Both sizes must not exceed the greatest f32.
    pub fn new(scene: &Aabb, extent: f32) -> Self {
        let size = scene.max - scene.min;
        let whole = to_f32(size.x.max(size.y).max(size.z));
        let shift = (FINE - exponent(extent)).min(RANGE - exponent(whole)).clamp(-126, 127);
        Self { origin: scene.min, scale: f32::from_bits(((shift + 127) as u32) << 23) as Real }
    }

    #[inline(always)]
    fn apply(&self, corner: Vec3) -> [i32; 3] {
        const MOST: Real = (1 << (RANGE + 1)) as Real;
        let v = (corner - self.origin) * self.scale;
        [v.x, v.y, v.z].map(|v| v.clamp(0.0, MOST) as i32)
    }
}

/// The exponent of the greatest power of two that does not exceed `x >= 0`; -127 for zero.
fn exponent(x: f32) -> i32 {
    (x.to_bits() >> 23) as i32 - 127
}

/// Writes the quantized box of every vertex, or [`QuantizedBox::EMPTY`] if the box is not valid.
pub fn write_quantized_boxes(
    boxes: &[Aabb],
    quantization: &Quantization,
    quantized_boxes: &mut [QuantizedBox],
    dispatch: &impl Dispatch,
) {
    dispatch.run(quantized_boxes, |start, part| {
        for (b, out) in boxes.part(start..).iter().zip(part) {
            let ([x, y, z], [u, v, w]) = (quantization.apply(b.min), quantization.apply(b.max));
            *out = if is_valid(b) { QuantizedBox([x, y, z, u, v, w]) } else { QuantizedBox::EMPTY };
        }
    });
}

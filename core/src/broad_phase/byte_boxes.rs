//! The boxes of a triangle and its features in bytes, so that sixteen pairs of boxes are compared at once.
//!
//! Both corners are rounded down to coarser units, at most 60 across a triangle, and are taken modulo 256. Two
//! overlapping boxes span less than 128 of these units in total, so their differences `max - min` are not negative
//! modulo 256 either. Boxes that do not overlap may also pass this test, so the pairs that pass must be compared
//! exactly.

use bytemuck::{Pod, Zeroable};
use wide::i8x16;

use super::quantized_boxes::QuantizedBox;
use crate::column::Column;
use crate::dispatch::Dispatch;

/// The boxes by coordinate: the three minima, then the three maxima. Each has one byte for each of the edges 0, 1,
/// 2 and the triangle, then for each of the vertices 0, 1, 2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct ByteBoxes(pub [[u32; 2]; 6]);

/// Sixteen values of each of the six coordinates.
pub type ByteLanes = [i8x16; 6];

/// Bit at which the byte of the triangle starts in the first word.
const WHOLE: u32 = 24;

impl ByteBoxes {
    /// Coordinate `k` of the box of the triangle.
    #[inline(always)]
    pub fn whole(&self, k: usize) -> i8 {
        (self.0.at(k)[0] >> WHOLE) as i8
    }

    /// The boxes as the first operand of [`may_overlap`]. For r < 3, lane `4 r + c` compares edge `r` with edge
    /// `c`, and lane `4 r + 3` compares vertex `r` with the triangle. Lane `12 + c` compares the triangle with
    /// vertex `c`.
    #[inline(always)]
    pub fn rows(&self) -> ByteLanes {
        let lane = |[edges, vertices]: [u32; 2]| {
            let byte = |word: u32, r: u32| (word >> (8 * r)) & 0xff;
            let row = |r: u32| (byte(edges, r) * 0x01_01_01) | (byte(vertices, r) << 24);
            bytemuck::cast([row(0), row(1), row(2), (edges >> WHOLE) * 0x01_01_01])
        };
        // The compiler keeps these in registers, but not the result of `map`.
        let [a, b, c, d, e, f] = self.0;
        [lane(a), lane(b), lane(c), lane(d), lane(e), lane(f)]
    }

    /// The boxes as the second operand of [`may_overlap`], in the lanes of [`rows`](Self::rows).
    #[inline(always)]
    pub fn columns(&self) -> ByteLanes {
        let lane = |[edges, vertices]: [u32; 2]| bytemuck::cast([edges, edges, edges, vertices]);
        let [a, b, c, d, e, f] = self.0;
        [lane(a), lane(b), lane(c), lane(d), lane(e), lane(f)]
    }
}

/// Returns one bit per lane, set if its two boxes may overlap.
#[inline(always)]
pub fn may_overlap(a: &ByteLanes, b: &ByteLanes) -> u32 {
    let below = (a[3] - b[0]) | (a[4] - b[1]) | (a[5] - b[2]);
    let above = (b[3] - a[0]) | (b[4] - a[1]) | (b[5] - a[2]);
    !(below | above).to_bitmask() & 0xffff
}

/// Writes the boxes of every triangle on levels up to `level`. The boxes of features with an empty vertex are
/// meaningless.
pub fn write_byte_boxes(
    quantized_boxes: &[QuantizedBox],
    triangles: &[[u32; 3]],
    levels: &[u8],
    level: u8,
    byte_boxes: &mut [ByteBoxes],
    dispatch: &impl Dispatch,
) {
    dispatch.run(byte_boxes, |start, part| {
        let present = triangles.part(start..).iter().zip(levels.part(start..)).zip(part);
        for ((triangle, _), out) in present.filter(|&((_, &own), _)| own <= level) {
            let [a, b, c] = quantized_boxes.gather(triangle);
            let edges = [a.union(&b), b.union(&c), c.union(&a)];
            let whole = edges[0].union(&c);
            for (k, out) in out.0.iter_mut().enumerate() {
                let of = |b: &QuantizedBox| b.0.at(k);
                let first = [of(&edges[0]), of(&edges[1]), of(&edges[2]), of(&whole)];
                *out = [word(first), word([of(&a), of(&b), of(&c), 0])];
            }
        }
    });
}

/// Converts quantized units, up to 2^10 across a triangle, to byte units, up to 60 across a triangle.
#[inline(always)]
fn word(units: [i32; 4]) -> u32 {
    u32::from_le_bytes(units.map(|x| ((x * 15) >> 8) as u8))
}

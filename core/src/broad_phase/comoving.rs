//! Boxes around the motion of two triangles in a frame that moves with them. Cloth that falls, swings or spins has long
//! motions that neighbours share. In this frame only the rest of the motion widens the boxes.
//!
//! Two features collide in this frame exactly if they collide in that of the scene.

use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;
use crate::real::{Real, Vec3};

/// The motion of all vertices in a step.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Positions at its start, m.
    pub start: &'a [Vec3],
    /// Radius of each vertex, m.
    pub radii: &'a [Real],
    /// How much wider on each side than the radius the boxes around the start are, m.
    pub margin: Real,
    /// Boxes in which the vertices end.
    pub ends: &'a [Aabb],
    /// Bound of the rounding errors of the boxes, m.
    pub rounding: Real,
}

/// The boxes of a triangle at both ends of its motion, and the mean displacement of its vertices.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MovingBox {
    start: Aabb,
    end: Aabb,
    displacement: Vec3,
}

impl MovingBox {
    /// The box that surrounds nothing.
    pub const EMPTY: Self = Self { start: Aabb::EMPTY, end: Aabb::EMPTY, displacement: Vec3::ZERO };

    /// Whether two triangles may touch: whether their boxes around the motion overlap in the frame that moves by the
    /// mean of their displacements.
    #[inline]
    pub fn overlaps(&self, other: &Self) -> bool {
        let frame = (self.displacement + other.displacement) * 0.5;
        self.swept(frame).overlaps(&other.swept(frame))
    }

    /// The box around the motion in a frame that moves by `frame`, m.
    #[inline]
    fn swept(&self, frame: Vec3) -> Aabb {
        self.start.union(&Aabb { min: self.end.min - frame, max: self.end.max - frame })
    }
}

/// Writes the box of every triangle.
pub fn write_moving_boxes(
    motion: &Motion<'_>,
    triangles: &[[u32; 3]],
    moving_boxes: &mut [MovingBox],
    dispatch: &impl Dispatch,
) {
    dispatch.run(moving_boxes, |start, part| {
        for (triangle, moving) in triangles.part(start..).iter().zip(part) {
            *moving = MovingBox::EMPTY;
            for v in triangle.map(|v| v as usize) {
                let (x, end) = (motion.start.at(v), motion.ends.at(v));
                let wide = motion.margin + motion.radii.at(v) + motion.rounding;
                moving.start = moving.start.union(&Aabb { min: x - wide, max: x + wide });
                moving.end = moving.end.union(&end);
                moving.displacement += ((end.min + end.max) * 0.5 - x) * (1.0 / 3.0);
            }
        }
    });
}

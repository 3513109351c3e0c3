//! The broad phase: computes bounds, then spheres, cells, entries, their sort and pairs for each level of sizes.

use super::bounds::{leave_out_far, write_bounds};
use super::brute_force_level::for_each_brute_force_pair;
use super::byte_boxes::{ByteBoxes, write_byte_boxes};
use super::cells::{CellGrid, Home, write_cells};
use super::comoving::{Motion, MovingBox, write_moving_boxes};
use super::entries::{Entry, write_entries};
use super::features::add_features;
use super::lean;
use super::levels;
use super::pairs::for_each_pair;
use super::quantized_boxes::{Quantization, QuantizedBox, write_quantized_boxes};
use super::sort::sort;
use super::spheres::{Sphere, write_spheres};
use super::{Candidates, Counts, Surface};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;
use crate::scratch::MAY_BE_LEAN;

/// Borrowed work columns, with one slot per triangle unless stated otherwise. If [`entries`](Self::entries) and the columns
/// of cells are empty, all triangles are compared with all, without a motion: less memory, and a few candidates more.
#[derive(Debug)]
pub struct Grid<'a> {
    /// Boxes of the triangles.
    pub triangle_boxes: &'a mut [Aabb],
    /// Boxes of the triangles at both ends of a motion.
    pub moving_boxes: &'a mut [MovingBox],
    /// Features that each triangle owns.
    pub owned: &'a mut [u8],
    /// Level of each triangle.
    pub levels: &'a mut [u8],
    /// Quantized boxes in units of the current level, one per vertex.
    pub quantized_boxes: &'a mut [QuantizedBox],
    /// Spheres around the boxes, in units of the current level.
    pub spheres: &'a mut [Sphere],
    /// Boxes of the triangles and their features in bytes, in units of the current level.
    pub byte_boxes: &'a mut [ByteBoxes],
    /// Home cells and control bits in the grid of the current level.
    pub homes: &'a mut [Home],
    /// Entries, eight slots per triangle.
    pub entries: &'a mut [Entry],
    /// Second buffer for the sort, eight slots per triangle.
    pub spare: &'a mut [Entry],
}

impl Grid<'_> {
    /// The same columns for a shorter time.
    pub fn reborrow(&mut self) -> Grid<'_> {
        Grid {
            triangle_boxes: self.triangle_boxes,
            moving_boxes: self.moving_boxes,
            owned: self.owned,
            levels: self.levels,
            quantized_boxes: self.quantized_boxes,
            spheres: self.spheres,
            byte_boxes: self.byte_boxes,
            homes: self.homes,
            entries: self.entries,
            spare: self.spare,
        }
    }
}

/// Writes the candidates of a surface and returns their numbers. `boxes` has one box per vertex, which the caller has
/// swept and inflated as needed. Given a `motion`, pairs of triangles that share it and stay [apart](super::comoving)
/// are left out. Nothing is reallocated: a count above its capacity is the capacity that was needed. `None` if
/// `dispatch` [stopped](Dispatch::stopped) the search.
pub fn candidates(
    boxes: &[Aabb],
    surface: &Surface<'_>,
    work: &mut Grid<'_>,
    motion: Option<&Motion<'_>>,
    out: &mut Candidates<'_>,
    dispatch: &impl Dispatch,
) -> Option<Counts> {
    if MAY_BE_LEAN && work.entries.is_empty() {
        return lean::candidates(boxes, surface, out, dispatch);
    }
    by_cells(boxes, surface, work, motion, out, dispatch)
}

/// Finds them with the grid. Not inlined: its sort needs 8 kB of stack, which a lean search does not.
#[inline(never)]
fn by_cells(
    boxes: &[Aabb],
    surface: &Surface<'_>,
    work: &mut Grid<'_>,
    motion: Option<&Motion<'_>>,
    out: &mut Candidates<'_>,
    dispatch: &impl Dispatch,
) -> Option<Counts> {
    let Grid {
        triangle_boxes,
        moving_boxes,
        owned,
        levels,
        quantized_boxes,
        spheres,
        byte_boxes,
        homes,
        entries,
        spare,
    } = work;
    write_bounds(boxes, surface, triangle_boxes, owned, dispatch);
    leave_out_far(triangle_boxes, surface.first_passive as usize);
    let moving_boxes = motion.map(|motion| {
        write_moving_boxes(motion, surface.triangles, moving_boxes, dispatch);
        &**moving_boxes
    });
    let sizes = levels::assign(triangle_boxes, levels);
    let mut counts = Counts::default();
    for level in 0..sizes.graded {
        let quantization = Quantization::new(&sizes.scene, sizes.extents.at(level as usize));
        write_quantized_boxes(boxes, &quantization, quantized_boxes, dispatch);
        write_spheres(quantized_boxes, surface.triangles, levels, level, spheres, dispatch);
        write_byte_boxes(quantized_boxes, surface.triangles, levels, level, byte_boxes, dispatch);
        let grid = CellGrid::new(spheres);
        write_cells(spheres, &grid, homes, dispatch);
        let count = write_entries(homes, levels, level, &grid, entries);
        let (entries, spare) = (entries.part_mut(..count), spare.part_mut(..count));
        let sorted = if sort(entries, spare, grid.key_bits()) { spare } else { entries };
        let is_complete = for_each_pair(sorted, homes, byte_boxes, &grid, surface, |pairs| {
            add_features(
                boxes,
                surface,
                triangle_boxes,
                owned,
                Some(byte_boxes),
                pairs,
                moving_boxes,
                out,
                &mut counts,
            );
            !dispatch.stopped()
        });
        if !is_complete {
            return None;
        }
    }
    if sizes.single > 0 {
        let is_complete = for_each_brute_force_pair(triangle_boxes, levels, sizes.graded, surface, |pairs| {
            add_features(boxes, surface, triangle_boxes, owned, None, pairs, moving_boxes, out, &mut counts);
            !dispatch.stopped()
        });
        if !is_complete {
            return None;
        }
    }
    Some(counts)
}

/// The owned columns of a [`Grid`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct GridColumns {
    triangle_boxes: alloc::vec::Vec<Aabb>,
    moving_boxes: alloc::vec::Vec<MovingBox>,
    owned: alloc::vec::Vec<u8>,
    byte_boxes: alloc::vec::Vec<ByteBoxes>,
    levels: alloc::vec::Vec<u8>,
    quantized_boxes: alloc::vec::Vec<QuantizedBox>,
    spheres: alloc::vec::Vec<Sphere>,
    homes: alloc::vec::Vec<Home>,
    entries: alloc::vec::Vec<Entry>,
    spare: alloc::vec::Vec<Entry>,
}

#[cfg(feature = "alloc")]
impl GridColumns {
    /// Allocates columns that suffice for every surface with `vertices` vertices and `triangles` triangles.
    #[cfg_attr(small, optimize(size))]
    pub fn build(vertices: usize, triangles: usize) -> Self {
        use alloc::vec;
        Self {
            triangle_boxes: vec![Aabb::EMPTY; triangles],
            moving_boxes: vec![MovingBox::EMPTY; triangles],
            owned: vec![0; triangles],
            byte_boxes: vec![ByteBoxes::default(); triangles],
            levels: vec![0; triangles],
            quantized_boxes: vec![QuantizedBox::EMPTY; vertices],
            spheres: vec![Sphere::default(); triangles],
            homes: vec![Home::default(); triangles],
            entries: vec![Entry::default(); 8 * triangles],
            spare: vec![Entry::default(); 8 * triangles],
        }
    }

    /// Borrows the columns for [`candidates`].
    pub fn view(&mut self) -> Grid<'_> {
        Grid {
            triangle_boxes: &mut self.triangle_boxes,
            moving_boxes: &mut self.moving_boxes,
            owned: &mut self.owned,
            byte_boxes: &mut self.byte_boxes,
            levels: &mut self.levels,
            quantized_boxes: &mut self.quantized_boxes,
            spheres: &mut self.spheres,
            homes: &mut self.homes,
            entries: &mut self.entries,
            spare: &mut self.spare,
        }
    }

    /// Size of the columns in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.triangle_boxes[..])
            + size_of_val(&self.moving_boxes[..])
            + size_of_val(&self.owned[..])
            + size_of_val(&self.byte_boxes[..])
            + size_of_val(&self.quantized_boxes[..])
            + size_of_val(&self.levels[..])
            + size_of_val(&self.spheres[..])
            + size_of_val(&self.homes[..])
            + size_of_val(&self.entries[..])
            + size_of_val(&self.spare[..])
    }
}

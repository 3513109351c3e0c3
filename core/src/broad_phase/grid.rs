//! The broad phase: bounds, then for each level of sizes spheres, cells, entries, sort and pairs.

use super::bounds::write_bounds;
use super::cells::{Home, Lattice, write_cells};
use super::entries::{Entry, IS_HOME, IS_OWN, write_entries};
use super::features::{FeatureBoxes, add_features};
use super::levels::{self, NO_LEVEL};
use super::pairs::for_each_pair;
use super::sort::sort;
use super::spheres::{Quantum, Sphere, write_spheres};
use super::{Candidates, Counts, Surface};
use crate::dispatch::Dispatch;
use crate::geometry::aabb::Aabb;

/// Work columns, borrowed: one slot a triangle where not said otherwise.
#[derive(Debug)]
pub struct Grid<'a> {
    /// Boxes.
    pub triangle_boxes: &'a mut [Aabb],
    /// Boxes, one an edge.
    pub edge_boxes: &'a mut [Aabb],
    /// Features that each stands for.
    pub owned: &'a mut [u8],
    /// Levels of sizes.
    pub levels: &'a mut [u8],
    /// Spheres around the boxes in a level's units.
    pub spheres: &'a mut [Sphere],
    /// Home cells and control bits in a level's cells.
    pub homes: &'a mut [Home],
    /// Eight a triangle.
    pub entries: &'a mut [Entry],
    /// Eight a triangle, to sort into.
    pub spare: &'a mut [Entry],
}

/// Writes the candidates of a surface from one box a vertex, swept and inflated as the caller
/// needs. Grows nothing: a count above its capacity says how much room was needed.
pub fn candidates(
    boxes: &[Aabb],
    surface: &Surface<'_>,
    work: &mut Grid<'_>,
    out: &mut Candidates<'_>,
    dispatch: &impl Dispatch,
) -> Counts {
    write_bounds(boxes, surface, work.edge_boxes, work.triangle_boxes, work.owned, dispatch);
    let levels = levels::assign(work.triangle_boxes, work.levels);
    let feature_boxes =
        FeatureBoxes { vertices: boxes, triangles: work.triangle_boxes, edges: work.edge_boxes, owned: work.owned };
    let mut counts = Counts::default();
    let mut add = |a, b| add_features(&feature_boxes, surface, [a, b], out, &mut counts);
    for level in 0..levels.graded {
        let quantum = Quantum::new(&levels.scene, levels.extents[level as usize]);
        write_spheres(work.triangle_boxes, work.levels, level, &quantum, work.spheres, dispatch);
        let lattice = Lattice::new(work.spheres);
        write_cells(work.spheres, &lattice, work.homes, dispatch);
        let count = write_entries(work.homes, work.levels, level, &lattice, work.entries);
        let (entries, spare) = (&mut work.entries[..count], &mut work.spare[..count]);
        let sorted = if sort(entries, spare, lattice.key_bits()) { spare } else { entries };
        for_each_pair(sorted, work.homes, work.triangle_boxes, &lattice, &mut add);
    }
    if levels.single > 0 {
        let count = one_cell(work.levels, levels.graded, work.entries);
        let lattice = Lattice { size: 1, bits: [0; 3] };
        work.homes.fill(Home { key: 0, control: 1 });
        for_each_pair(&work.entries[..count], work.homes, work.triangle_boxes, &lattice, &mut add);
    }
    counts
}

/// Entries with all homes in one cell.
fn one_cell(levels: &[u8], level: u8, entries: &mut [Entry]) -> usize {
    let mut count = 0;
    for own in [IS_OWN, 0] {
        for (id, &other) in (0..).zip(levels) {
            if other != NO_LEVEL && (other == level) == (own != 0) {
                entries[count] = Entry { key: 0, object: id | IS_HOME | own };
                count += 1;
            }
        }
    }
    count
}

/// The owned columns of a [`Grid`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct GridColumns {
    triangle_boxes: alloc::vec::Vec<Aabb>,
    edge_boxes: alloc::vec::Vec<Aabb>,
    owned: alloc::vec::Vec<u8>,
    levels: alloc::vec::Vec<u8>,
    spheres: alloc::vec::Vec<Sphere>,
    homes: alloc::vec::Vec<Home>,
    entries: alloc::vec::Vec<Entry>,
    spare: alloc::vec::Vec<Entry>,
}

#[cfg(feature = "alloc")]
impl GridColumns {
    /// Columns for a surface of so many triangles and edges, whatever its shape.
    pub fn build(triangles: usize, edges: usize) -> Self {
        use alloc::vec;
        Self {
            triangle_boxes: vec![Aabb::EMPTY; triangles],
            edge_boxes: vec![Aabb::EMPTY; edges],
            owned: vec![0; triangles],
            levels: vec![0; triangles],
            spheres: vec![Sphere::default(); triangles],
            homes: vec![Home::default(); triangles],
            entries: vec![Entry::default(); 8 * triangles],
            spare: vec![Entry::default(); 8 * triangles],
        }
    }

    /// The borrowed view that [`candidates`] works in.
    pub fn view(&mut self) -> Grid<'_> {
        Grid {
            triangle_boxes: &mut self.triangle_boxes,
            edge_boxes: &mut self.edge_boxes,
            owned: &mut self.owned,
            levels: &mut self.levels,
            spheres: &mut self.spheres,
            homes: &mut self.homes,
            entries: &mut self.entries,
            spare: &mut self.spare,
        }
    }
}

#[cfg(feature = "alloc")]
impl GridColumns {
    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.triangle_boxes[..])
            + size_of_val(&self.edge_boxes[..])
            + size_of_val(&self.levels[..])
            + size_of_val(&self.spheres[..])
            + size_of_val(&self.homes[..])
            + size_of_val(&self.entries[..])
            + size_of_val(&self.spare[..])
    }
}

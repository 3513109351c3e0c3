//! Cuts a sheet into patches of at most `PATCH` vertices. The material is halved repeatedly across
//! its longest side. The patches are then numbered outward from one end, so that the small matrix
//! has a narrow envelope.
//!
//! A large sheet is cut twice: into as many patches as the small matrix allows, and each of these again. Small patches
//! are coupled within their large patch only, so that their part of the matrix stays cheap.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

use glam::DVec3;

use super::coarse::{MODES, Patches};
use crate::forces::sparsity::SparsityPattern;
use crate::integrate::pins::Pins;
use crate::real::Real;

/// Vertices per patch at most. Smaller patches need fewer solver iterations but make the small system larger.
const PATCH: usize = 128;

/// Largest number of patches in a scene. With more, the small system costs more than it saves. If patches must
/// be as large as [`PATCH`] for this, or larger, they are cut into [small](SMALL_PATCH) ones.
const MOST_PATCHES: usize = 128;

/// Vertices per small patch at most.
const SMALL_PATCH: usize = 64;

/// The owned columns of [`Patches`].
#[derive(Clone, Debug, Default)]
pub struct PatchColumns {
    labels: Vec<u32>,
    coordinates: Vec<[Real; 2]>,
    held: Vec<u8>,
    first_columns: Vec<u32>,
    offsets: Vec<u32>,
}

impl PatchColumns {
    /// Builds the patches from material coordinates. Each cloth (a range of vertices) is cut separately.
    #[cfg_attr(small, optimize(size))]
    pub fn build(material: &[DVec3], cloths: &[Range<u32>], pattern: &SparsityPattern, pins: &Pins<'_>) -> Self {
        let count = material.len();
        let size = PATCH.max(count.div_ceil(MOST_PATCHES));
        let mut built = Self { held: vec![0; count], ..Self::default() };
        built.offsets.push(0);
        pins.write_held(&mut built.held);
        let whole = cloths.iter().map(|cloth| cloth.clone().collect()).collect();
        let large = built.add_level(material, whole, size, pattern, &[]);
        if count >= PATCH * MOST_PATCHES {
            let labels = built.labels.clone();
            built.add_level(material, large, SMALL_PATCH, pattern, &labels);
        }
        built
    }

    /// Cuts parts of the vertices into patches of at most `size`, and returns them. Given labels, only patches of
    /// vertices with the same label are coupled.
    #[cfg_attr(small, optimize(size))]
    fn add_level(
        &mut self,
        material: &[DVec3],
        parts: Vec<Vec<u32>>,
        size: usize,
        pattern: &SparsityPattern,
        within: &[u32],
    ) -> Vec<Vec<u32>> {
        let mut patches = Vec::new();
        for part in parts {
            halve(material, part, size, &mut patches);
        }
        let is_coupled = |&(a, b): &(u32, u32)| within.get(a as usize) == within.get(b as usize);
        let pairs: Vec<_> = pattern.pairs().filter(is_coupled).collect();
        let patches = outward(patches, &pairs);
        let (vertices, before) = (self.labels.len(), self.first_columns.len() / MODES);
        self.coordinates.resize(vertices + material.len(), [0.0; 2]);
        for patch in &patches {
            self.set_coordinates(material, patch, vertices);
        }
        self.labels.extend(labels(&patches, material.len()).iter().map(|label| label + before as u32));
        self.add_envelope(before..before + patches.len(), vertices, &pairs);
        patches
    }

    /// The held axes of each vertex, to change them; empty without patches.
    pub fn held_mut(&mut self) -> &mut [u8] {
        &mut self.held
    }

    /// The borrowed view.
    pub fn view(&self) -> Patches<'_> {
        Patches {
            labels: &self.labels,
            coordinates: &self.coordinates,
            held: &self.held,
            first_columns: &self.first_columns,
            offsets: &self.offsets,
        }
    }

    /// Number of rows of the small matrix, and of values in its envelope.
    pub fn sizes(&self) -> [usize; 2] {
        [self.first_columns.len(), self.offsets.last().map_or(0, |&end| end as usize)]
    }

    /// Size of the columns, bytes.
    pub fn bytes(&self) -> usize {
        self.held.len() + size_of_val(&self.labels[..]) + size_of_val(&self.coordinates[..]) + 8 * self.offsets.len()
    }

    /// Writes coordinates along the patch's longest direction and across it, scaled to about -1 to 1. Those of the
    /// level begin at `start`.
    fn set_coordinates(&mut self, material: &[DVec3], patch: &[u32], start: usize) {
        let centre = patch.iter().map(|&v| material[v as usize]).sum::<DVec3>() / patch.len() as f64;
        let farthest = |project: &dyn Fn(DVec3) -> DVec3| {
            let arms = patch.iter().map(|&v| project(material[v as usize] - centre));
            arms.fold(DVec3::ZERO, |far, arm| if arm.length_squared() > far.length_squared() { arm } else { far })
        };
        // A vector divided by its squared length: its dot product with an arm is a scaled coordinate.
        let scaled = |far: DVec3| far * (1.0 / far.length_squared().max(f64::MIN_POSITIVE));
        let along = scaled(farthest(&|arm| arm));
        let unit = along.normalize_or_zero();
        let across = scaled(farthest(&|arm| arm - unit * arm.dot(unit)));
        for &v in patch {
            let arm = material[v as usize] - centre;
            self.coordinates[start + v as usize] = [arm.dot(along) as Real, arm.dot(across) as Real];
        }
    }

    /// Adds the rows of patches. The labels of their level begin at `start`.
    fn add_envelope(&mut self, patches: Range<usize>, start: usize, pairs: &[(u32, u32)]) {
        let mut first: Vec<u32> = (0..patches.end as u32).collect();
        for &(a, b) in pairs {
            let (a, b) = (self.labels[start + a as usize], self.labels[start + b as usize]);
            let (low, high) = (a.min(b), a.max(b));
            first[high as usize] = first[high as usize].min(low);
        }
        let mut end = *self.offsets.last().unwrap_or(&0);
        for row in patches.start * MODES..patches.end * MODES {
            let column = first[row / MODES] * MODES as u32;
            end += row as u32 + 1 - column;
            self.first_columns.push(column);
            self.offsets.push(end);
        }
    }
}

/// Splits vertices at the median along their longest side until each part has at most `size`.
fn halve(material: &[DVec3], mut part: Vec<u32>, size: usize, patches: &mut Vec<Vec<u32>>) {
    if part.len() <= size {
        if !part.is_empty() {
            patches.push(part);
        }
        return;
    }
    let corners = part.iter().map(|&v| material[v as usize]);
    let (low, high) = corners.fold((DVec3::MAX, DVec3::MIN), |(l, h), p| (l.min(p), h.max(p)));
    let axis = (high - low).max_position();
    part.sort_unstable_by(|&a, &b| {
        let along = |v: u32| material[v as usize][axis];
        along(a).total_cmp(&along(b)).then(a.cmp(&b))
    });
    let upper = part.split_off(part.len() / 2);
    halve(material, part, size, patches);
    halve(material, upper, size, patches);
}

/// Orders patches breadth first, starting at a patch far from the others [Cuthill 1969].
fn outward(patches: Vec<Vec<u32>>, pairs: &[(u32, u32)]) -> Vec<Vec<u32>> {
    let label = labels(&patches, patches.iter().map(Vec::len).sum());
    let mut neighbours = vec![Vec::new(); patches.len()];
    for &(a, b) in pairs {
        let (a, b) = (label[a as usize], label[b as usize]);
        if a != b {
            neighbours[a as usize].push(b);
            neighbours[b as usize].push(a);
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    let mut order: Vec<u32> = Vec::new();
    let mut reached = vec![false; patches.len()];
    for start in 0..patches.len() as u32 {
        if !reached[start as usize] {
            // The patch that a walk reaches last is far from its start.
            let far = walk(start, &neighbours, &mut reached.clone()).last().copied().unwrap_or(start);
            order.extend(walk(far, &neighbours, &mut reached));
        }
    }
    let mut slots: Vec<_> = patches.into_iter().map(Some).collect();
    order.iter().filter_map(|&patch| slots[patch as usize].take()).collect()
}

/// Visits the patches that are not reached yet breadth first and returns them in that order.
fn walk(start: u32, neighbours: &[Vec<u32>], reached: &mut [bool]) -> Vec<u32> {
    let mut order = vec![start];
    reached[start as usize] = true;
    let mut next = 0;
    while next < order.len() {
        for &neighbour in &neighbours[order[next] as usize] {
            if !core::mem::replace(&mut reached[neighbour as usize], true) {
                order.push(neighbour);
            }
        }
        next += 1;
    }
    order
}

fn labels(patches: &[Vec<u32>], vertices: usize) -> Vec<u32> {
    let mut labels = vec![0; vertices];
    for (label, patch) in patches.iter().enumerate() {
        for &vertex in patch {
            labels[vertex as usize] = label as u32;
        }
    }
    labels
}

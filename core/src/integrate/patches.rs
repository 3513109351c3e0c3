//! Cuts a sheet into patches of about `PATCH` vertices. The material is halved repeatedly across
//! its longest side. The patches are then numbered outward from one end, so that the small matrix
//! has a narrow envelope.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

use glam::DVec3;

use super::coarse::{MODES, Patches};
use crate::forces::sparsity::SparsityPattern;
use crate::integrate::pins::Pins;
use crate::real::Real;

/// Vertices per patch. Smaller patches need fewer solver iterations but make the small system larger.
const PATCH: usize = 64;

/// Largest number of patches in a scene. With more, the small system costs more than it saves.
const MOST_PATCHES: usize = 128;

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
        let size = PATCH.max(material.len().div_ceil(MOST_PATCHES));
        let mut patches = Vec::new();
        for cloth in cloths {
            halve(material, cloth.clone().collect(), size, &mut patches);
        }
        let patches = outward(patches, pattern);
        let mut built = Self {
            labels: labels(&patches, material.len()),
            coordinates: vec![[0.0; 2]; material.len()],
            held: vec![0; material.len()],
            ..Self::default()
        };
        for patch in &patches {
            built.set_coordinates(material, patch);
        }
        built.set_pins(pins);
        built.set_envelope(patches.len(), pattern);
        built
    }

    /// Copies the held axes of all pins.
    pub fn set_pins(&mut self, pins: &Pins<'_>) {
        self.held.fill(0);
        for (&vertex, &axes) in pins.vertices.iter().zip(pins.axes) {
            // Without patches the column is empty.
            if let Some(held) = self.held.get_mut(vertex as usize) {
                *held |= axes;
            }
        }
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

    /// Writes coordinates along the patch's longest direction and across it, scaled to about -1 to 1.
    fn set_coordinates(&mut self, material: &[DVec3], patch: &[u32]) {
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
            self.coordinates[v as usize] = [arm.dot(along) as Real, arm.dot(across) as Real];
        }
    }

    fn set_envelope(&mut self, count: usize, pattern: &SparsityPattern) {
        let mut first: Vec<u32> = (0..count as u32).collect();
        for (a, b) in pattern.pairs() {
            let (a, b) = (self.labels[a as usize], self.labels[b as usize]);
            let (low, high) = (a.min(b), a.max(b));
            first[high as usize] = first[high as usize].min(low);
        }
        self.offsets.push(0);
        let mut end = 0;
        for row in 0..count * MODES {
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
fn outward(patches: Vec<Vec<u32>>, pattern: &SparsityPattern) -> Vec<Vec<u32>> {
    let label = labels(&patches, patches.iter().map(Vec::len).sum());
    let mut neighbours = vec![Vec::new(); patches.len()];
    for (a, b) in pattern.pairs() {
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

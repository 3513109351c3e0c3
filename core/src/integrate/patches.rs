//! Cuts a sheet into patches of about `PATCH` vertices. The material is halved repeatedly across
//! its longest side. The patches are then numbered outward from one end, so that the small matrix
//! has a narrow envelope.
//!
//! A large sheet is cut twice: into as many patches as the small matrix allows, and each of these again. Small patches are
//! coupled within their large patch only, so that their matrix stays cheap.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

use glam::DVec3;

use super::coarse::{CoarseFactor, Dense, Level, MODES, Patches};
use crate::forces::sparsity::SparsityPattern;
use crate::integrate::pins::Pins;
use crate::real::{Lanes, Real, Sum};

/// Vertices per patch. Smaller patches need fewer solver iterations but make the small system larger.
const PATCH: usize = 64;

/// Largest number of patches in a scene. With more, the small system costs more than it saves.
const MOST_PATCHES: usize = 128;

/// Patches that have at least so many times [`PATCH`] vertices on average are cut into small ones.
const LEAST_REFINED: usize = 2;

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
        let cloths = cloths.iter().map(|cloth| cloth.clone().collect());
        Self::cut(material, cloths, size, pattern, pins, &|_, _| true)
    }

    /// Cuts each patch into small ones; into none if they are small already.
    #[cfg_attr(small, optimize(size))]
    pub fn refine(&self, material: &[DVec3], pattern: &SparsityPattern, pins: &Pins<'_>) -> Self {
        let mut large = vec![Vec::new(); self.first_columns.len() / MODES];
        if self.labels.len() < LEAST_REFINED * PATCH * large.len() {
            return Self::default();
        }
        for (vertex, &label) in (0..).zip(&self.labels) {
            large[label as usize].push(vertex);
        }
        let together = |a: u32, b: u32| self.labels[a as usize] == self.labels[b as usize];
        Self::cut(material, large.into_iter(), PATCH, pattern, pins, &together)
    }

    /// Cuts parts of the vertices into patches of at most `size`. Patches are coupled where a pair of vertices is.
    fn cut(
        material: &[DVec3],
        parts: impl Iterator<Item = Vec<u32>>,
        size: usize,
        pattern: &SparsityPattern,
        pins: &Pins<'_>,
        coupled: &dyn Fn(u32, u32) -> bool,
    ) -> Self {
        let mut patches = Vec::new();
        for part in parts {
            halve(material, part, size, &mut patches);
        }
        let patches = outward(patches, pattern, coupled);
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
        built.set_envelope(patches.len(), pattern, coupled);
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

    fn set_envelope(&mut self, count: usize, pattern: &SparsityPattern, coupled: &dyn Fn(u32, u32) -> bool) {
        let mut first: Vec<u32> = (0..count as u32).collect();
        for (a, b) in pattern.pairs().filter(|&(a, b)| coupled(a, b)) {
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

/// The owned columns of a [`Level`].
#[derive(Clone, Debug, Default)]
pub struct LevelColumns {
    pub(crate) patches: PatchColumns,
    values: Vec<Sum>,
    own: Vec<Dense>,
    inverse_diagonal: Vec<Sum>,
    rounded: Vec<Real>,
    vector: Vec<Real>,
    motions: Vec<[Lanes; 3]>,
}

impl LevelColumns {
    /// Allocates the factor of the patches.
    pub fn new(patches: PatchColumns) -> Self {
        let [rows, values] = patches.sizes();
        Self {
            values: vec![0.0; values],
            own: vec![[[0.0; MODES]; MODES]; rows / MODES],
            inverse_diagonal: vec![0.0; rows],
            rounded: vec![0.0; values],
            vector: vec![0.0; rows],
            motions: vec![[Lanes::ZERO; 3]; rows / MODES],
            patches,
        }
    }

    /// Number of values of the factor.
    pub fn values(&self) -> usize {
        self.values.len()
    }

    /// The borrowed view.
    pub fn view(&mut self) -> Level<'_> {
        Level {
            patches: self.patches.view(),
            factor: CoarseFactor {
                values: &mut self.values,
                own: &mut self.own,
                inverse_diagonal: &mut self.inverse_diagonal,
                rounded: &mut self.rounded,
                vector: &mut self.vector,
                motions: &mut self.motions,
            },
        }
    }

    /// Size of the columns, bytes.
    pub fn bytes(&self) -> usize {
        self.patches.bytes()
            + size_of_val(&self.values[..])
            + size_of_val(&self.own[..])
            + size_of_val(&self.inverse_diagonal[..])
            + size_of_val(&self.rounded[..])
            + size_of_val(&self.vector[..])
            + size_of_val(&self.motions[..])
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
fn outward(patches: Vec<Vec<u32>>, pattern: &SparsityPattern, coupled: &dyn Fn(u32, u32) -> bool) -> Vec<Vec<u32>> {
    let label = labels(&patches, patches.iter().map(Vec::len).sum());
    let mut neighbours = vec![Vec::new(); patches.len()];
    for (a, b) in pattern.pairs().filter(|&(a, b)| coupled(a, b)) {
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

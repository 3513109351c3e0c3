//! Loads, forces that do not depend on the motion. They may change with time.

use glam::DVec3;

use super::term::ForceTerm;
use super::{Energy, Term};
use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::keys::{Key, Moment};
use crate::particles::Positions;
use crate::real::{Real, Sum, Vec3, vec3};
use crate::traffic::VECTOR;

/// Loads on some vertices.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loads<'a> {
    /// The loaded vertices. A vertex may carry several loads.
    pub vertices: &'a [u32],
    /// The part of each in the force of its group.
    pub parts: &'a [Sum],
    /// The groups, in the order of the vertices.
    pub groups: &'a [LoadGroup],
    /// The forces of all groups over time, N.
    pub keys: &'a [Key],
    /// When they act.
    pub moment: Moment,
    /// Constant forces of the host.
    pub of_host: &'a [VertexForce],
}

/// A force that some vertices share.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LoadGroup {
    /// Index of its first vertex among the loaded ones, and number of vertices.
    pub vertices: [u32; 2],
    /// Index of its first key, and number of keys. A constant force has one.
    pub keys: [u32; 2],
    /// The sum of its parts times the positions at the start, m.
    pub start: DVec3,
}

/// A force of the host on a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct VertexForce {
    /// The vertex.
    pub vertex: u32,
    unused: u32,
    /// The force, N. A slot without a force is free.
    pub force: DVec3,
    /// Where the vertex was when the force began to act, m.
    pub start: DVec3,
}

impl VertexForce {
    /// A force on a vertex that is at `start`.
    pub fn new(vertex: u32, force: DVec3, start: DVec3) -> Self {
        Self { vertex, unused: 0, force, start }
    }

    /// Index of the slot for a vertex: its own, or a free one.
    pub fn slot(all: &[Self], vertex: u32) -> Option<usize> {
        let own = all.iter().position(|it| it.vertex == vertex && it.force != DVec3::ZERO);
        own.or_else(|| all.iter().position(|it| it.force == DVec3::ZERO))
    }
}

impl<'a> Loads<'a> {
    /// At a moment.
    pub fn at(self, moment: Moment) -> Self {
        Self { moment, ..self }
    }

    /// Whether a force changes with time.
    pub fn vary(&self) -> bool {
        self.groups.iter().any(|group| group.keys[1] > 1)
    }

    /// The loaded vertices with their forces, N.
    pub fn forces(&self) -> impl Iterator<Item = (usize, Vec3)> + use<'a> {
        let loads = *self;
        let of_scene = loads.groups.iter().flat_map(move |group| {
            let force = loads.force(group);
            loads.of(group).map(move |(vertex, part)| (vertex, vec3((force * part).into())))
        });
        of_scene.chain(loads.acting().map(|it| (it.vertex as usize, vec3(it.force.into()))))
    }

    /// The forces of the host that are not zero.
    fn acting(&self) -> impl Iterator<Item = &'a VertexForce> + use<'a> {
        self.of_host.iter().filter(|it| it.force != DVec3::ZERO)
    }

    /// The force of a group, N.
    fn force(&self, group: &LoadGroup) -> DVec3 {
        let [first, count] = group.keys;
        self.moment.value(self.keys.part(first as usize..(first + count) as usize))
    }

    /// The vertices of a group and their parts.
    fn of(&self, group: &LoadGroup) -> impl Iterator<Item = (usize, Sum)> + use<'a> {
        let [first, count] = group.vertices;
        let range = first as usize..(first + count) as usize;
        let vertices = self.vertices.part(range.clone()).iter().map(|&vertex| vertex as usize);
        vertices.zip(self.parts.part(range).iter().copied())
    }
}

impl ForceTerm for Loads<'_> {
    fn add_forces(&self, _: &[Real], _: Positions<'_>, _: &[Vec3], _: &mut [Vec3], f: &mut [Vec3], _: &impl Dispatch) {
        for (vertex, force) in self.forces() {
            f.add(vertex, force);
        }
    }

    /// The potential energy, zero at the start. It counts as that of gravity.
    fn energy(&self, _: Term, _: &[Real], x: Positions<'_>) -> Energy {
        let of_group = |group: &LoadGroup| {
            let now: DVec3 = self.of(group).map(|(vertex, part)| x.place(vertex) * part).sum();
            self.force(group).dot(group.start - now)
        };
        let of_host: Sum = self.acting().map(|it| it.force.dot(it.start - x.place(it.vertex as usize))).sum();
        Energy { gravity: self.groups.iter().map(of_group).sum::<Sum>() + of_host, ..Energy::default() }
    }

    fn bytes(&self) -> usize {
        size_of_val(self.vertices) + size_of_val(self.parts) + size_of_val(self.of_host)
    }

    /// Reads the loads, reads and writes the forces of their vertices.
    fn force_traffic(&self, _: usize) -> usize {
        self.bytes() + 2 * (self.vertices.len() + self.of_host.len()) * VECTOR
    }
}

/// The owned columns of [`Loads`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct LoadColumns {
    /// The loaded vertices.
    pub vertices: alloc::vec::Vec<u32>,
    /// The part of each in the force of its group.
    pub parts: alloc::vec::Vec<Sum>,
    /// The groups, in the order of the vertices.
    pub groups: alloc::vec::Vec<LoadGroup>,
    /// The forces of all groups over time, N.
    pub keys: alloc::vec::Vec<Key>,
}

#[cfg(feature = "alloc")]
impl LoadColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Loads<'_> {
        Loads {
            vertices: &self.vertices,
            parts: &self.parts,
            groups: &self.groups,
            keys: &self.keys,
            moment: Moment::default(),
            of_host: &[],
        }
    }
}

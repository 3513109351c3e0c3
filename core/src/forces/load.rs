//! Loads, forces that do not depend on the motion. They may change with time.

use glam::DVec3;

use super::term::ForceTerm;
use super::{Energy, Term};
use crate::dispatch::Dispatch;
use crate::keys::{Key, Moment};
use crate::particles::Positions;
use crate::real::{Real, Sum, Vec3, vec3};
use crate::traffic::VECTOR;

/// Loads on some vertices.
#[derive(Clone, Copy, Debug)]
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
        loads.groups.iter().flat_map(move |group| {
            let force = loads.force(group);
            loads.of(group).map(move |(vertex, part)| (vertex, vec3((force * part).into())))
        })
    }

    /// The force of a group, N.
    fn force(&self, group: &LoadGroup) -> DVec3 {
        let [first, count] = group.keys;
        self.moment.value(&self.keys[first as usize..(first + count) as usize])
    }

    /// The vertices of a group and their parts.
    fn of(&self, group: &LoadGroup) -> impl Iterator<Item = (usize, Sum)> + use<'a> {
        let [first, count] = group.vertices;
        let range = first as usize..(first + count) as usize;
        let vertices = self.vertices[range.clone()].iter().map(|&vertex| vertex as usize);
        vertices.zip(self.parts[range].iter().copied())
    }
}

impl ForceTerm for Loads<'_> {
    fn add_forces(&self, _: &[Real], _: Positions<'_>, _: &[Vec3], _: &mut [Vec3], f: &mut [Vec3], _: &impl Dispatch) {
        for (vertex, force) in self.forces() {
            f[vertex] += force;
        }
    }

    /// The potential energy, zero at the start. It counts as that of gravity.
    fn energy(&self, _: Term, _: &[Real], x: Positions<'_>) -> Energy {
        let of_group = |group: &LoadGroup| {
            let now: DVec3 = self.of(group).map(|(vertex, part)| x.place(vertex) * part).sum();
            self.force(group).dot(group.start - now)
        };
        Energy { gravity: self.groups.iter().map(of_group).sum(), ..Energy::default() }
    }

    fn bytes(&self) -> usize {
        size_of_val(self.vertices) + size_of_val(self.parts)
    }

    /// Reads the loads, reads and writes the forces of their vertices.
    fn force_traffic(&self, _: usize) -> usize {
        self.bytes() + 2 * self.vertices.len() * VECTOR
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
    /// Number of groups of the scene. Those after them are of the host: each is a constant force on one vertex.
    pub of_scene: usize,
}

#[cfg(feature = "alloc")]
impl LoadColumns {
    /// Replaces the force of the host on a vertex, N, which is now at `place`, m. Returns where the vertex was when the
    /// force before was set, and that force.
    pub fn set(&mut self, vertex: u32, place: DVec3, force: DVec3) -> (DVec3, DVec3) {
        let own = &mut self.groups[self.of_scene..];
        let known = own.iter_mut().find(|group| self.vertices[group.vertices[0] as usize] == vertex);
        let key = Key { time: 0.0, value: force };
        if let Some(group) = known {
            let before = core::mem::replace(&mut self.keys[group.keys[0] as usize], key);
            return (core::mem::replace(&mut group.start, place), before.value);
        }
        let [vertices, keys] = [self.vertices.len(), self.keys.len()].map(|first| [first as u32, 1]);
        self.groups.push(LoadGroup { vertices, keys, start: place });
        self.vertices.push(vertex);
        self.parts.push(1.0);
        self.keys.push(key);
        (place, DVec3::ZERO)
    }

    /// The borrowed view that kernels take.
    pub fn view(&self) -> Loads<'_> {
        Loads {
            vertices: &self.vertices,
            parts: &self.parts,
            groups: &self.groups,
            keys: &self.keys,
            moment: Moment::default(),
        }
    }
}

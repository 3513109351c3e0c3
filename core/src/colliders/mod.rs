//! What the cloth can touch besides itself: vertices that nothing pushes back.
//!
//! Every collider but the plane is made of the features that cloth is made of, so that detection
//! and response need no second way: a mesh and a box are triangles, a sphere is a vertex and a
//! capsule an edge, each with a radius. A plane is a vertex with a normal.

pub mod cuboid;
pub mod plane;
pub mod round;

use crate::motion::{JumpSide, Key, Motion};
use crate::real::{Real, Sum, Vec3};

/// What a collider is, and its first vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// The half space below a vertex, seen along a normal.
    Plane(Vec3),
    /// All within a radius of a vertex.
    Sphere,
    /// All within a radius of the edge from the first vertex to the next.
    Capsule,
    /// Eight corners; corner k lies beyond the centre along those axes whose bit k has.
    Box,
    /// A surface.
    Mesh,
}

/// How a collider's vertices move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Not at all.
    Rest,
    /// Along keys and about an axis.
    Motion(Motion),
    /// Through the frames of a cache, linearly between them, resting outside.
    Cache {
        /// Index of its first frame's first vertex in [`Colliders::frames`].
        first: usize,
        /// How many frames.
        frames: usize,
        /// Frames per second.
        rate: Sum,
    },
}

/// One collider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// What it is.
    pub form: Form,
    /// Its first vertex, and how many it has.
    pub vertices: [usize; 2],
    /// How they move.
    pub drive: Drive,
    /// m around its vertices and edges.
    pub radius: Real,
    /// Its law of friction.
    pub law: u32,
}

impl Body {
    /// Indices of its vertices.
    pub fn range(&self) -> core::ops::Range<usize> {
        self.vertices[0]..self.vertices[0] + self.vertices[1]
    }
}

/// All colliders, borrowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Colliders<'a> {
    /// The colliders in the order of their vertices.
    pub bodies: &'a [Body],
    /// Where each vertex is before any motion, m.
    pub anchors: &'a [Vec3],
    /// The keys of all motions.
    pub keys: &'a [Key],
    /// Vertices of all caches, frame after frame, m.
    pub frames: &'a [Vec3],
}

impl Colliders<'_> {
    /// Writes where the vertices are at a time.
    pub fn place(&self, time: Sum, out: &mut [Vec3]) {
        for body in self.bodies {
            let (anchors, out) = (&self.anchors[body.range()], &mut out[body.range()]);
            match body.drive {
                Drive::Rest => out.copy_from_slice(anchors),
                Drive::Motion(motion) => {
                    for (out, &anchor) in out.iter_mut().zip(anchors) {
                        *out = motion.at(self.keys, anchor, time, JumpSide::After).0;
                    }
                }
                Drive::Cache { first, frames, rate } => {
                    let at = (time * rate).clamp(0.0, (frames - 1) as Sum);
                    let (frame, count) = (at as usize, out.len());
                    let next = (frame + 1).min(frames - 1);
                    let part = (at - frame as Sum) as Real;
                    let of = |frame: usize| &self.frames[first + frame * count..][..count];
                    for ((out, &a), &b) in out.iter_mut().zip(of(frame)).zip(of(next)) {
                        *out = a + (b - a) * part;
                    }
                }
            }
        }
    }

    /// How deep a point lies in any collider that has an inside, m; 0 outside of all. `places` is
    /// where the vertices are. Meshes may be open and count as surfaces.
    pub fn depth(&self, places: &[Vec3], point: Vec3) -> Real {
        let depths = self.bodies.iter().map(|body| {
            let vertices = &places[body.range()];
            match body.form {
                Form::Plane(normal) => plane::depth(vertices[0], normal, point),
                Form::Sphere => round::depth(vertices[0], vertices[0], body.radius, point),
                Form::Capsule => round::depth(vertices[0], vertices[1], body.radius, point),
                Form::Box => cuboid::depth(vertices, point),
                Form::Mesh => 0.0,
            }
        });
        depths.fold(0.0, Real::max)
    }
}

/// The owned columns of [`Colliders`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct ColliderColumns {
    /// The colliders.
    pub bodies: alloc::vec::Vec<Body>,
    /// Where each vertex is before any motion, m.
    pub anchors: alloc::vec::Vec<Vec3>,
    /// The keys of all motions.
    pub keys: alloc::vec::Vec<Key>,
    /// Vertices of all caches.
    pub frames: alloc::vec::Vec<Vec3>,
    /// Triangles over the vertices; lone points and edges repeat a vertex.
    pub triangles: alloc::vec::Vec<[u32; 3]>,
}

#[cfg(feature = "alloc")]
impl ColliderColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Colliders<'_> {
        Colliders { bodies: &self.bodies, anchors: &self.anchors, keys: &self.keys, frames: &self.frames }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.bodies[..])
            + size_of_val(&self.anchors[..])
            + size_of_val(&self.keys[..])
            + size_of_val(&self.frames[..])
            + size_of_val(&self.triangles[..])
    }

    /// Adds a collider with its triangles over its own vertices.
    pub fn add(&mut self, body: Body, anchors: &[Vec3], triangles: &[[u32; 3]]) {
        let first = self.anchors.len() as u32;
        self.bodies.push(Body { vertices: [self.anchors.len(), anchors.len()], ..body });
        self.anchors.extend_from_slice(anchors);
        self.triangles.extend(triangles.iter().map(|t| t.map(|v| first + v)));
    }
}

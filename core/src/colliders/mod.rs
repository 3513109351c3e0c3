//! Colliders: objects that the cloth collides with. Contact does not move their vertices.
//!
//! All colliders except planes consist of the same features as cloth, so that detection and response
//! treat both alike: a mesh and a box are triangles, a sphere is a vertex with a radius, and a capsule
//! is an edge with a radius. A plane is a vertex with a normal.

pub mod cuboid;
pub mod plane;
pub mod round;

use glam::DVec3;

use crate::motion::{JumpSide, Key, Motion};
use crate::real::{Real, Sum, Vec3, sqrt, vec3};

/// The shape of a collider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// The half space below a vertex. The normal points to the free side.
    Plane(Vec3),
    /// All points within a radius of a vertex.
    Sphere,
    /// All points within a radius of the edge between its two vertices.
    Capsule,
    /// Eight corners, in the order of [`cuboid::corners`].
    Box,
    /// A surface of triangles.
    Mesh,
}

/// The motion of a collider's vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// The vertices rest.
    Rest,
    /// An offset by keys, and a rotation about an axis.
    Motion(Motion),
    /// The frames of a point cache.
    Cache(Cache),
}

/// The frames of a point cache: linear between frames, constant before the first and after the last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cache {
    /// Index of the first vertex of the first frame in [`Colliders::frames`].
    pub first: usize,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub rate: Sum,
}

impl Cache {
    /// The position of a vertex at `time`, m. `frames` are the vertex positions of all caches, and `count` is the number
    /// of its vertices.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn place(&self, frames: &[Vec3], [vertex, count]: [usize; 2], time: Sum) -> Vec3 {
        let last = self.frames - 1;
        let at = (time * self.rate).clamp(0.0, last as Sum);
        let frame = at as usize;
        let part = (at - frame as Sum) as Real;
        let [now, next] = [frame, (frame + 1).min(last)].map(|frame| frames[self.first + frame * count + vertex]);
        now + (next - now) * part
    }

    /// How far a vertex would be at the end of a time from its place there if it went on as before a frame within, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn deviation(&self, frames: &[Vec3], count: usize, [start, end]: [Sum; 2]) -> Sum {
        let [first, last] = [start, end].map(|time| (time * self.rate).clamp(0.0, self.frames as Sum));
        let mut farthest: Real = 0.0;
        for frame in (first as usize).max(1)..libm::ceil(last) as usize {
            let time = frame as Sum / self.rate;
            let rest = ((end - time) * self.rate) as Real;
            if time <= start || rest <= 0.0 {
                continue;
            }
            for vertex in 0..count {
                let place = |time: Sum| self.place(frames, [vertex, count], time);
                let [before, at, at_end] = [place(time - 1.0 / self.rate), place(time), place(end)];
                farthest = farthest.max((at + (at - before) * rest - at_end).length_squared());
            }
        }
        sqrt(farthest).into()
    }

    /// Time of the last frame, s.
    pub fn end(&self) -> Sum {
        (self.frames - 1) as Sum / self.rate
    }
}

/// One collider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Its shape.
    pub form: Form,
    /// Index of its first vertex, and number of vertices.
    pub vertices: [usize; 2],
    /// Motion of its vertices.
    pub drive: Drive,
    /// Radius around its vertices and edges, m.
    pub radius: Real,
    /// Index of its law of friction.
    pub law: u32,
}

impl Body {
    /// Indices of its vertices.
    pub fn range(&self) -> core::ops::Range<usize> {
        self.vertices[0]..self.vertices[0] + self.vertices[1]
    }

    /// Its rotation in a step that starts at `time` and takes `step`, s, rad. That of a point cache is not known.
    pub fn turns(&self, [time, step]: [Sum; 2]) -> Vec3 {
        let Drive::Motion(Motion { turn: Some(turn), .. }) = self.drive else { return Vec3::ZERO };
        vec3((turn.axis * (turn.angle(time + step) - turn.angle(time))).into())
    }
}

/// All colliders, borrowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Colliders<'a> {
    /// The colliders in the order of their vertices.
    pub bodies: &'a [Body],
    /// Position of each vertex before any motion, m.
    pub anchors: &'a [Vec3],
    /// The keys of all motions.
    pub keys: &'a [Key],
    /// Vertex positions of all caches, frame after frame, m.
    pub frames: &'a [Vec3],
}

impl Colliders<'_> {
    /// Index of the collider that a vertex belongs to.
    pub fn body_of(&self, vertex: usize) -> usize {
        self.bodies.partition_point(|body| body.range().end <= vertex)
    }

    /// Writes the positions of all vertices at `time`, s.
    pub fn place(&self, time: Sum, out: &mut [Vec3]) {
        for body in self.bodies {
            let (anchors, out) = (&self.anchors[body.range()], &mut out[body.range()]);
            match body.drive {
                Drive::Rest => out.copy_from_slice(anchors),
                Drive::Motion(motion) => {
                    for (out, &anchor) in out.iter_mut().zip(anchors) {
                        *out = vec3(motion.at(self.keys, anchor, time, JumpSide::After).0.into());
                    }
                }
                Drive::Cache(cache) => {
                    let count = out.len();
                    for (vertex, out) in out.iter_mut().enumerate() {
                        *out = cache.place(self.frames, [vertex, count], time);
                    }
                }
            }
        }
    }

    /// How far the surface of a collider moves near the cloth, between two times, from the straight and even way, m.
    /// `cloth` are the positions of the cloth, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn deviation(&self, cloth: &[Vec3], times: [Sum; 2]) -> Sum {
        let of = |body: &Body| match body.drive {
            Drive::Rest => 0.0,
            Drive::Motion(motion) => {
                let (offset, _) = motion.offset(self.keys, times[0], JumpSide::After);
                let own = motion.reach(&self.anchors[body.range()], DVec3::ZERO) + Sum::from(body.radius);
                // Cloth does not feel the parts that turn farther out.
                motion.deviation(self.keys, own.min(motion.reach(cloth, offset)), DVec3::ONE, times)
            }
            Drive::Cache(cache) => cache.deviation(self.frames, body.vertices[1], times),
        };
        self.bodies.iter().map(of).fold(0.0, Sum::max)
    }

    /// Greatest depth of a point inside the colliders, m; 0 if it is outside all of them. `places` are
    /// the vertex positions. Meshes may be open, so they count as surfaces without an inside.
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
    /// Position of each vertex before any motion, m.
    pub anchors: alloc::vec::Vec<Vec3>,
    /// The keys of all motions.
    pub keys: alloc::vec::Vec<Key>,
    /// Vertex positions of all caches, frame after frame, m.
    pub frames: alloc::vec::Vec<Vec3>,
    /// Vertices of each triangle. Lone points and edges are triangles that repeat a vertex.
    pub triangles: alloc::vec::Vec<[u32; 3]>,
}

#[cfg(feature = "alloc")]
impl ColliderColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Colliders<'_> {
        Colliders { bodies: &self.bodies, anchors: &self.anchors, keys: &self.keys, frames: &self.frames }
    }

    /// Bytes of the columns.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.bodies[..])
            + size_of_val(&self.anchors[..])
            + size_of_val(&self.keys[..])
            + size_of_val(&self.frames[..])
            + size_of_val(&self.triangles[..])
    }

    /// Adds a collider. `triangles` index into `anchors`.
    pub fn add(&mut self, body: Body, anchors: &[Vec3], triangles: &[[u32; 3]]) {
        let first = self.anchors.len() as u32;
        self.bodies.push(Body { vertices: [self.anchors.len(), anchors.len()], ..body });
        self.anchors.extend_from_slice(anchors);
        self.triangles.extend(triangles.iter().map(|t| t.map(|v| first + v)));
    }
}

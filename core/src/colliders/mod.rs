//! Colliders: objects that the cloth collides with. Contact does not move their vertices.
//!
//! All colliders except planes consist of the same features as cloth, so that detection and response
//! treat both alike: a mesh and a box are triangles, a sphere is a vertex with a radius, and a capsule
//! is an edge with a radius. A plane is a vertex with a normal.

pub mod cuboid;
pub mod plane;
pub mod round;

use bytemuck::Zeroable;
use glam::DVec3;

use crate::column::Column;
use crate::kinematic::{Kinematic, Pose, Twist};
use crate::motion::{JumpSide, Key, Motion};
use crate::real::{Real, Sum, Vec3, sqrt, to_f64, vec3};

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
    /// From pose to pose, as the host says.
    Host(Kinematic),
}

impl Drive {
    /// Position of a point at `time`, m, and its velocity on the given side of that time, m/s. `point` is its position
    /// before any motion, and `keys` are the keys of all motions. The points of a cache have no common motion: they
    /// count as at rest.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn at(&self, keys: &[Key], point: Vec3, time: Sum, side: JumpSide) -> (DVec3, Vec3) {
        match self {
            Self::Rest | Self::Cache(_) => (to_f64(point).into(), Vec3::ZERO),
            Self::Motion(motion) => motion.at(keys, point, time, side),
            Self::Host(kinematic) => kinematic.at(to_f64(point).into(), time, side),
        }
    }

    /// The point before any motion that is at `place` at `time`, m. A cache has no inverse.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn undo(&self, keys: &[Key], place: DVec3, time: Sum) -> DVec3 {
        match self {
            Self::Rest | Self::Cache(_) => place,
            Self::Motion(motion) => motion.undo(keys, place, time),
            Self::Host(kinematic) => kinematic.undo(place, time),
        }
    }

    /// How far points move, between two times, from the straight and even way, m. They are within `radius` of `points`, m.
    /// Those farther from the centre of a rotation than `cloth` do not count: it does not feel them.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn deviation(
        &self,
        keys: &[Key],
        points: &[Vec3],
        radius: Sum,
        cloth: Option<&[Vec3]>,
        times: [Sum; 2],
    ) -> Sum {
        let least = |own: Sum, of_cloth: &dyn Fn(&[Vec3]) -> Sum| cloth.map_or(own, |cloth| own.min(of_cloth(cloth)));
        match self {
            Self::Rest | Self::Cache(_) => 0.0,
            Self::Motion(motion) => {
                let (offset, _) = motion.offset(keys, times[0], JumpSide::After);
                let own = motion.reach(points, DVec3::ZERO) + radius;
                motion.deviation(keys, least(own, &|cloth| motion.reach(cloth, offset)), DVec3::ONE, times)
            }
            Self::Host(kinematic) => {
                let now = kinematic.pose(times[0]).position;
                let own = reach(points, kinematic.centre) + radius;
                kinematic.deviation(least(own, &|cloth| reach(cloth, now)), times)
            }
        }
    }

    /// The pose at `time` of a collider whose centre was at `centre` before any motion, m, and its velocity on the given
    /// side of that time.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn pose(&self, keys: &[Key], centre: DVec3, time: Sum, side: JumpSide) -> (Pose, Twist) {
        match self {
            Self::Rest | Self::Cache(_) => (Pose::at(centre), Twist::default()),
            Self::Motion(motion) => motion.pose(keys, centre, time, side),
            Self::Host(kinematic) => (kinematic.pose(time), kinematic.twist(time, side)),
        }
    }
}

/// The frames of a point cache: linear between frames, constant before the first and after the last.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Cache {
    /// Index of the first vertex of the first frame in [`Colliders::frames`].
    pub first: u32,
    /// Number of frames.
    pub frames: u32,
    /// Frames per second.
    pub rate: Sum,
    /// Time of the first frame, s.
    pub start: Sum,
}

impl Cache {
    /// The position of a vertex at `time`, m. `frames` are the vertex positions of all caches, and `count` is the number
    /// of its vertices.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn place(&self, frames: &[Vec3], [vertex, count]: [usize; 2], time: Sum) -> Vec3 {
        let (first, last) = (self.first as usize, self.frames as usize - 1);
        let at = ((time - self.start) * self.rate).clamp(0.0, last as Sum);
        let frame = at as usize;
        let part = (at - frame as Sum) as Real;
        let [now, next] = [frame, (frame + 1).min(last)].map(|frame| frames.at(first + frame * count + vertex));
        now + (next - now) * part
    }

    /// How far a vertex would be at the end of a time from its place there if it went on as before a frame within, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn deviation(&self, frames: &[Vec3], count: usize, [start, end]: [Sum; 2]) -> Sum {
        let [first, last] = [start, end].map(|time| ((time - self.start) * self.rate).clamp(0.0, self.frames as Sum));
        let mut farthest: Real = 0.0;
        for frame in (first as usize).max(1)..libm::ceil(last) as usize {
            let time = self.start + frame as Sum / self.rate;
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

    /// Whether its frames, of a collider with `count` vertices, lie in a column of a length.
    pub fn fits(&self, count: usize, length: usize) -> bool {
        let own = (self.frames as usize).saturating_mul(count);
        let is_timed = self.rate > 0.0 && self.rate.is_finite() && self.start.is_finite();
        is_timed && self.frames > 0 && (self.first as usize).saturating_add(own) <= length
    }

    /// Time of the last frame, s.
    pub fn end(&self) -> Sum {
        self.start + (self.frames - 1) as Sum / self.rate
    }
}

/// One collider. It has no padding and no invalid bits, so that it can lie in a [cooked](crate::cooked) scene.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Body {
    drive: StoredDrive,
    /// Normal of a plane.
    normal: Vec3,
    /// Radius around its vertices and edges, m.
    pub radius: Real,
    /// Index of its first vertex, and number of vertices.
    pub vertices: [u32; 2],
    form: u32,
    /// Index of its law of friction.
    pub law: u32,
    off: u32,
    reserved: u32,
}

/// A [`Drive`] in plain bits: the number of its kind, and its bytes.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct StoredDrive {
    kind: u64,
    words: [u64; size_of::<Kinematic>() / size_of::<u64>()],
}

impl From<Drive> for StoredDrive {
    #[cfg_attr(small, optimize(size), inline(never))]
    fn from(drive: Drive) -> Self {
        let mut stored = Self::zeroed();
        let room = bytemuck::bytes_of_mut(&mut stored.words);
        let (kind, bytes): (u64, &[u8]) = match &drive {
            Drive::Rest => (0, &[]),
            Drive::Motion(motion) => (1, bytemuck::bytes_of(motion)),
            Drive::Cache(cache) => (2, bytemuck::bytes_of(cache)),
            Drive::Host(kinematic) => (3, bytemuck::bytes_of(kinematic)),
        };
        room.part_mut(..bytes.len()).copy_from(bytes);
        Self { kind, ..stored }
    }
}

impl From<&StoredDrive> for Drive {
    #[cfg_attr(small, optimize(size), inline(never))]
    fn from(stored: &StoredDrive) -> Self {
        fn read<T: bytemuck::Pod>(stored: &StoredDrive) -> T {
            let mut drive = T::zeroed();
            let bytes = bytemuck::bytes_of(&stored.words).part(..size_of::<T>());
            bytemuck::bytes_of_mut(&mut drive).copy_from(bytes);
            drive
        }
        match stored.kind {
            1 => Self::Motion(read(stored)),
            2 => Self::Cache(read(stored)),
            3 => Self::Host(read(stored)),
            _ => Self::Rest,
        }
    }
}

impl Body {
    /// A collider without vertices.
    pub fn new(form: Form, drive: Drive, radius: Real, law: u32) -> Self {
        let (form, normal) = match form {
            Form::Plane(normal) => (0, normal),
            Form::Sphere => (1, Vec3::ZERO),
            Form::Capsule => (2, Vec3::ZERO),
            Form::Box => (3, Vec3::ZERO),
            Form::Mesh => (4, Vec3::ZERO),
        };
        Self { drive: drive.into(), normal, radius, vertices: [0; 2], form, law, off: 0, reserved: 0 }
    }

    /// Its shape.
    pub fn form(&self) -> Form {
        match self.form {
            0 => Form::Plane(self.normal),
            1 => Form::Sphere,
            2 => Form::Capsule,
            3 => Form::Box,
            _ => Form::Mesh,
        }
    }

    /// Motion of its vertices.
    pub fn drive(&self) -> Drive {
        (&self.drive).into()
    }

    /// Replaces the motion.
    pub fn set_drive(&mut self, drive: Drive) {
        self.drive = drive.into();
    }

    /// Whether it is switched off: nothing touches it.
    pub fn is_off(&self) -> bool {
        self.off != 0
    }

    /// Switches it off or on.
    pub fn set_off(&mut self, is_off: bool) {
        self.off = is_off.into();
    }

    /// Indices of its vertices.
    pub fn range(&self) -> core::ops::Range<usize> {
        let [first, count] = self.vertices.map(|number| number as usize);
        first..first + count
    }

    /// Its rotation in a step that starts at `time` and takes `step`, s, rad. That of a point cache is not known.
    pub fn turns(&self, [time, step]: [Sum; 2]) -> Vec3 {
        let turned = match self.drive() {
            Drive::Motion(motion) => {
                motion.turn().map_or(DVec3::ZERO, |turn| turn.axis * (turn.angle(time + step) - turn.angle(time)))
            }
            Drive::Host(kinematic) => kinematic.turned([time, time + step]),
            Drive::Rest | Drive::Cache(_) => DVec3::ZERO,
        };
        vec3(turned.into())
    }

    /// The mean of its vertices before any motion, m, which moves straight when a host moves it.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn middle(&self, anchors: &[Vec3]) -> DVec3 {
        let own = anchors.part(self.range());
        own.iter().map(|&x| DVec3::from(to_f64(x))).sum::<DVec3>() / own.len() as Sum
    }

    /// From its centre to its middle, m. The centre of a mesh is the zero of its coordinates, which lies at `zero`.
    pub fn arm(&self, anchors: &[Vec3], zero: DVec3) -> DVec3 {
        if self.form() == Form::Mesh { self.middle(anchors) - zero } else { DVec3::ZERO }
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

    /// Writes the positions of all vertices at `time`, s. All vertices of a collider that is switched off are at the
    /// place of its first, so that nothing crosses it.
    pub fn place(&self, time: Sum, out: &mut [Vec3]) {
        for body in self.bodies {
            let out = out.part_mut(body.range());
            if body.is_off() {
                out.fill(self.anchors.at(body.range().start));
            } else {
                self.place_body(body, time, out);
            }
        }
    }

    /// Writes the positions of the vertices of a collider at `time`, s, whether or not it is switched off.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn place_body(&self, body: &Body, time: Sum, out: &mut [Vec3]) {
        let anchors = self.anchors.part(body.range());
        let drive = body.drive();
        match drive {
            Drive::Rest => out.copy_from(anchors),
            Drive::Motion(_) | Drive::Host(_) => {
                for (out, &anchor) in out.iter_mut().zip(anchors) {
                    *out = vec3(drive.at(self.keys, anchor, time, JumpSide::After).0.into());
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

    /// How far the surface of a collider moves near the cloth, between two times, from the straight and even way, m.
    /// `cloth` are the positions of the cloth, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn deviation(&self, cloth: &[Vec3], times: [Sum; 2]) -> Sum {
        let of = |body: &Body| match body.drive() {
            _ if body.is_off() => 0.0,
            Drive::Cache(cache) => cache.deviation(self.frames, body.range().len(), times),
            drive => {
                drive.deviation(self.keys, self.anchors.part(body.range()), Sum::from(body.radius), Some(cloth), times)
            }
        };
        self.bodies.iter().map(of).fold(0.0, Sum::max)
    }

    /// Greatest depth of a point inside the colliders, m; 0 if it is outside all of them. `places` are
    /// the vertex positions. Meshes may be open, so they count as surfaces without an inside.
    pub fn depth(&self, places: &[Vec3], point: Vec3) -> Real {
        let depths = self.bodies.iter().filter(|body| !body.is_off()).map(|body| {
            let vertices = places.part(body.range());
            match body.form() {
                Form::Plane(normal) => plane::depth(vertices.at(0), normal, point),
                Form::Sphere => round::depth(vertices.at(0), vertices.at(0), body.radius, point),
                Form::Capsule => round::depth(vertices.at(0), vertices.at(1), body.radius, point),
                Form::Box => cuboid::depth(vertices, point),
                Form::Mesh => 0.0,
            }
        });
        depths.fold(0.0, Real::max)
    }
}

/// The largest distance of points from a centre, m.
fn reach(points: &[Vec3], centre: DVec3) -> Sum {
    points.iter().map(|&point| DVec3::from(to_f64(point)).distance(centre)).fold(0.0, Sum::max)
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
    /// Index in `frames` of the two frames of each collider that the host deforms; empty until it deforms one.
    own_frames: alloc::vec::Vec<Option<usize>>,
}

#[cfg(feature = "alloc")]
impl ColliderColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Colliders<'_> {
        Colliders { bodies: &self.bodies, anchors: &self.anchors, keys: &self.keys, frames: &self.frames }
    }

    /// Whether the colliders have the same shapes and the same places before any motion.
    pub(crate) fn is_alike(&self, other: &Self) -> bool {
        fn shapes(columns: &ColliderColumns) -> impl Iterator<Item = impl PartialEq> {
            columns.bodies.iter().map(|body| (body.form(), body.radius, body.range()))
        }
        shapes(self).eq(shapes(other)) && self.anchors == other.anchors && self.triangles == other.triangles
    }

    /// Bytes of the columns.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.bodies[..])
            + size_of_val(&self.anchors[..])
            + size_of_val(&self.keys[..])
            + size_of_val(&self.frames[..])
            + size_of_val(&self.triangles[..])
    }

    /// Index of the first of two frames for a collider. The first call for a collider adds them. `None`: memory is short.
    pub fn room_for_frames(&mut self, body: usize) -> Option<usize> {
        let count = 2 * self.bodies[body].range().len();
        if self.own_frames.is_empty() {
            self.own_frames.resize(self.bodies.len(), None);
        }
        if self.own_frames[body].is_none() {
            let first = self.frames.len();
            self.frames.try_reserve_exact(count).ok()?;
            self.frames.resize(first + count, Vec3::ZERO);
            self.own_frames[body] = Some(first);
        }
        self.own_frames[body]
    }

    /// Adds a collider. `triangles` index into `anchors`.
    pub fn add(&mut self, body: Body, anchors: &[Vec3], triangles: &[[u32; 3]]) {
        let first = self.anchors.len() as u32;
        self.bodies.push(Body { vertices: [first, anchors.len() as u32], ..body });
        self.anchors.extend_from_slice(anchors);
        self.triangles.extend(triangles.iter().map(|t| t.map(|v| first + v)));
    }
}

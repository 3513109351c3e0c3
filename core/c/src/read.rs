//! Views of the columns, and other readouts.

use core::ptr;
use core::slice;

use muslin_core::diagnostics::StateHash;
use muslin_core::geometry::normals::write_normals;
use muslin_core::live::{Live as _, Side, Touch};

use crate::handle::{MuslinCloth, asked, change, is_place, seen};
use crate::live::{MuslinPose, vector};
use crate::status::MuslinStatus;

/// Writes the length of a column, and returns its start.
///
/// # Safety
/// `count` is null or points to a number.
unsafe fn view<T, U>(column: Option<&[T]>, count: *mut usize) -> *const U {
    if is_place(count) {
        // SAFETY: it is a place, and the caller says that it points to a number.
        unsafe { count.write(column.map_or(0, <[T]>::len)) };
    }
    column.map_or(ptr::null(), |column| column.as_ptr().cast())
}

/// Positions of the vertices, x, y and z of each, from `muslin_origin`. The pointer is valid as long as the handle, and the
/// numbers until the next call that changes it. Writes the number of vertices. Null if the handle is bad.
///
/// # Safety
/// `cloth` is null or a handle; `vertices` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_positions(cloth: *const MuslinCloth, vertices: *mut usize) -> *const f32 {
    // SAFETY: the caller's promises are those of the two calls.
    unsafe { view(seen(cloth).map(|own| own.cloth.positions()), vertices) }
}

/// Velocities of the vertices, m/s, like `muslin_positions`.
///
/// # Safety
/// `cloth` is null or a handle; `vertices` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_velocities(cloth: *const MuslinCloth, vertices: *mut usize) -> *const f32 {
    // SAFETY: the caller's promises are those of the two calls.
    unsafe { view(seen(cloth).map(|own| own.cloth.velocities()), vertices) }
}

/// Computes the unit normals of the vertices and returns them like `muslin_positions`.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `vertices` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_normals(cloth: *mut MuslinCloth, vertices: *mut usize) -> *const f32 {
    // SAFETY: the caller's promise is that of `change`.
    _ = unsafe {
        change(cloth, |own| {
            write_normals(own.cloth.positions(), own.cloth.triangles(), own.normals);
            Ok(())
        })
    };
    // SAFETY: the caller's promises are those of the two calls.
    unsafe { view(seen(cloth).map(|own| &*own.normals), vertices) }
}

/// Triangles of the cloth, three vertices each. Writes their number. Null if the handle is bad.
///
/// # Safety
/// `cloth` is null or a handle; `triangles` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_triangles(cloth: *const MuslinCloth, triangles: *mut usize) -> *const u32 {
    // SAFETY: the caller's promises are those of the two calls.
    unsafe { view(seen(cloth).map(|own| own.cloth.triangles()), triangles) }
}

/// Writes the point in the world from which `muslin_positions` counts, m. It is zero unless the scene is far from the
/// world's origin.
///
/// # Safety
/// `cloth` is null or a handle; `origin` points to three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_origin(cloth: *const MuslinCloth, origin: *mut f64) -> MuslinStatus {
    // SAFETY: the caller's promises are those of the two calls.
    unsafe { answer(cloth, origin.cast(), |own| Ok(own.cloth.origin().to_array())) }
}

/// Simulated time, s; 0 if the handle is bad.
///
/// # Safety
/// `cloth` is null or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_time(cloth: *const MuslinCloth) -> f64 {
    // SAFETY: the caller's promise is that of `seen`.
    unsafe { seen(cloth) }.map_or(0.0, |own| own.cloth.time())
}

/// Length of a step, s; 0 if the handle is bad.
///
/// # Safety
/// `cloth` is null or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_step_length(cloth: *const MuslinCloth) -> f64 {
    // SAFETY: the caller's promise is that of `seen`.
    unsafe { seen(cloth) }.map_or(0.0, |own| own.cloth.step_length().into())
}

/// Number of steps taken; 0 if the handle is bad.
///
/// # Safety
/// `cloth` is null or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_steps(cloth: *const MuslinCloth) -> u64 {
    // SAFETY: the caller's promise is that of `seen`.
    unsafe { seen(cloth) }.map_or(0, |own| own.cloth.steps())
}

/// Hash of positions and velocities: equal states have equal hashes on every machine. 0 if the handle is bad.
///
/// # Safety
/// `cloth` is null or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_hash(cloth: *const MuslinCloth) -> u64 {
    // SAFETY: the caller's promise is that of `seen`.
    let Some(own) = (unsafe { seen(cloth) }) else { return 0 };
    let mut hash = StateHash::default();
    hash.add(own.cloth.positions(), own.cloth.velocities());
    hash.0
}

/// Number of colliders; 0 if the handle is bad.
///
/// # Safety
/// `cloth` is null or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_collider_count(cloth: *const MuslinCloth) -> u32 {
    // SAFETY: the caller's promise is that of `seen`.
    unsafe { seen(cloth) }.map_or(0, |own| own.cloth.colliders().bodies.len() as u32)
}

/// Writes the present pose of a collider in the world.
///
/// # Safety
/// `cloth` is null or a handle; `pose` points to a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_collider_pose(
    cloth: *const MuslinCloth,
    collider: u32,
    pose: *mut MuslinPose,
) -> MuslinStatus {
    // SAFETY: the caller's promises are those of `answer`.
    unsafe { answer(cloth, pose, |own| Ok(own.cloth.collider_pose(collider)?.into())) }
}

/// A surface that something touches.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MuslinSide {
    /// Whether it is a collider; otherwise it is a cloth.
    pub is_collider: bool,
    /// Its number.
    pub index: u32,
}

/// A contact that pushes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuslinTouch {
    /// The two surfaces.
    pub sides: [MuslinSide; 2],
    /// Vertices of both features. Those of colliders come after those of the cloth.
    pub vertices: [u32; 4],
    /// Their weights in the nearest points: positive on the first side, negative on the second.
    pub weights: [f64; 4],
    /// The nearest point of a cloth, in the world, m.
    pub position: [f64; 3],
    /// Unit vector from the second side to the first.
    pub normal: [f64; 3],
    /// Force on the first side, with friction, N.
    pub force: [f64; 3],
}

/// Writes the contacts that push in the last step, as many as there is room for, and the number of all of them.
///
/// # Safety
/// `cloth` is null or a handle; `touches` is null or points to `capacity` structs, and `count` to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_touches(
    cloth: *const MuslinCloth,
    touches: *mut MuslinTouch,
    capacity: usize,
    count: *mut usize,
) -> MuslinStatus {
    let room = if is_place(touches) { capacity } else { 0 };
    let each = |own: &MuslinCloth| {
        let mut found = 0;
        for touch in own.cloth.touches() {
            if found < room {
                // SAFETY: it is a place, and the caller gives this capacity.
                unsafe { touches.add(found).write(touch.into()) };
            }
            found += 1;
        }
        Ok(found)
    };
    // SAFETY: the caller's promises are those of `answer`.
    unsafe { answer(cloth, count, each) }
}

/// A point of a cloth.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuslinPoint {
    /// Position in the world, m.
    pub position: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Unit normal of its triangle; zero if the triangle has no area.
    pub normal: [f64; 3],
}

/// Writes the point of a triangle with these barycentric coordinates.
///
/// # Safety
/// `cloth` is null or a handle; `weights` points to three numbers and `point` to a point.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_point(
    cloth: *const MuslinCloth,
    triangle: u32,
    weights: *const f64,
    point: *mut MuslinPoint,
) -> MuslinStatus {
    // SAFETY: the caller says that it is null or points to three numbers.
    let Some(weights) = (unsafe { vector(weights) }) else { return MuslinStatus::NullPointer };
    // SAFETY: the caller's promises are those of `answer`.
    unsafe {
        answer(cloth, point, |own| {
            let it = own.cloth.point(triangle, weights)?;
            Ok(MuslinPoint { position: it.position, velocity: it.velocity, normal: it.normal })
        })
    }
}

/// Where a ray hits a cloth first.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MuslinHit {
    /// Whether it hits. Otherwise the other fields are zero.
    pub hits: bool,
    /// The triangle.
    pub triangle: u32,
    /// Barycentric coordinates on it.
    pub weights: [f64; 3],
    /// Distance from the origin of the ray, m.
    pub distance: f64,
}

/// Writes where a ray hits a cloth first, from either side. Nothing is written if the call fails.
///
/// # Safety
/// `cloth` is null or a handle; `origin` and `direction` point to three numbers each, and `hit` to a hit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_hit(
    cloth: *const MuslinCloth,
    origin: *const f64,
    direction: *const f64,
    hit: *mut MuslinHit,
) -> MuslinStatus {
    // SAFETY: the caller says that they are null or point to three numbers.
    let (Some(origin), Some(direction)) = (unsafe { (vector(origin), vector(direction)) }) else {
        return MuslinStatus::NullPointer;
    };
    // SAFETY: the caller's promises are those of `answer`.
    unsafe {
        answer(cloth, hit, |own| {
            let first = own.cloth.hit(origin, direction)?;
            Ok(first.map_or(MuslinHit::default(), |first| MuslinHit {
                hits: true,
                triangle: first.triangle,
                weights: first.weights,
                distance: first.distance,
            }))
        })
    }
}

impl From<Side> for MuslinSide {
    fn from(side: Side) -> Self {
        match side {
            Side::Cloth(index) => Self { is_collider: false, index },
            Side::Collider(index) => Self { is_collider: true, index },
        }
    }
}

impl From<Touch> for MuslinTouch {
    fn from(touch: Touch) -> Self {
        let Touch { sides, vertices, weights, position, normal, force } = touch;
        Self { sides: sides.map(Into::into), vertices, weights, position, normal, force }
    }
}

/// Writes what `ask` reads of the handle that a pointer names.
///
/// # Safety
/// `cloth` is null or a handle; `out` is null or points to room for the answer.
unsafe fn answer<T>(
    cloth: *const MuslinCloth,
    out: *mut T,
    ask: impl FnOnce(&MuslinCloth) -> Result<T, muslin_core::error::LiveError>,
) -> MuslinStatus {
    if cloth.is_null() || !is_place(out) {
        return MuslinStatus::NullPointer;
    }
    // SAFETY: the caller's promise is that of `seen`.
    let Some(own) = (unsafe { seen(cloth) }) else { return MuslinStatus::BadHandle };
    match asked(own, ask) {
        Some(Ok(answer)) => {
            // SAFETY: it is a place, and the caller says that there is room.
            unsafe { out.write(answer) };
            MuslinStatus::Ok
        }
        Some(Err(error)) => error.into(),
        None => MuslinStatus::Internal,
    }
}

/// A column of the caller; `None` if the pointer is null or not aligned.
///
/// # Safety
/// `start` is null or points to `count` entries that live as long as the result.
pub(crate) unsafe fn column<'a, T>(start: *const T, count: usize) -> Option<&'a [T]> {
    match (is_place(start), count) {
        (_, 0) => Some(&[]),
        (false, _) => None,
        // SAFETY: it is a place, and the caller gives this length.
        (true, _) => Some(unsafe { slice::from_raw_parts(start, count) }),
    }
}

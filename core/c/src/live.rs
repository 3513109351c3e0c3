//! Changes between steps.

use glam::{DQuat, DVec3};
use muslin_core::error::LiveError;
use muslin_core::kinematic::Pose;
use muslin_core::live::Live as _;
use muslin_core::reactions::Impulse;

use crate::handle::{MuslinCloth, change, given, is_place};
use crate::read::column;
use crate::status::MuslinStatus;

/// Place and orientation of a collider in the world.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuslinPose {
    /// Position of its centre, m: the middle of a sphere, a capsule or a box, the point of a plane, the zero of the
    /// coordinates of a mesh.
    pub position: [f64; 3],
    /// Rotation from the orientation in the scene, a quaternion x, y, z, w.
    pub rotation: [f64; 4],
}

/// The impulse of the cloth on a collider.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuslinImpulse {
    /// The impulse, N s.
    pub linear: [f64; 3],
    /// Its moment about the centre of the collider, N m s.
    pub angular: [f64; 3],
}

impl From<Pose> for MuslinPose {
    fn from(pose: Pose) -> Self {
        Self { position: pose.position.into(), rotation: pose.rotation.into() }
    }
}

impl From<MuslinPose> for Pose {
    fn from(pose: MuslinPose) -> Self {
        Self { position: DVec3::from(pose.position), rotation: DQuat::from_array(pose.rotation) }
    }
}

impl From<Impulse> for MuslinImpulse {
    fn from(impulse: Impulse) -> Self {
        Self { linear: impulse.linear.into(), angular: impulse.angular.into() }
    }
}

/// Three numbers of the caller.
///
/// # Safety
/// `start` is null or points to three numbers.
pub(crate) unsafe fn vector(start: *const f64) -> Option<[f64; 3]> {
    // SAFETY: the caller's promise. The numbers may lie at any address.
    if start.is_null() { None } else { Some(unsafe { start.cast::<[f64; 3]>().read_unaligned() }) }
}

/// Moves a collider evenly from its present pose to another one within `seconds`. Call it before every step with the length
/// of the step. The step detects everything in the way of the collider.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `pose` is null or points to a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_move_collider(
    cloth: *mut MuslinCloth,
    collider: u32,
    pose: *const MuslinPose,
    seconds: f64,
) -> MuslinStatus {
    // SAFETY: the caller says that it is null or points to a pose.
    let Some(pose) = (unsafe { given(pose) }) else { return MuslinStatus::NullPointer };
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.move_collider(collider, pose.into(), seconds)?)) }
}

/// Writes the impulse that the cloth has given a collider since the last call. Its moment is about the present centre of the
/// collider, or about the world's origin for one that deforms. The scene must be cooked with `--impulses`.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `impulse` is null or points to an impulse.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_take_impulse(
    cloth: *mut MuslinCloth,
    collider: u32,
    impulse: *mut MuslinImpulse,
) -> MuslinStatus {
    if !is_place(impulse) {
        return MuslinStatus::NullPointer;
    }
    // SAFETY: the caller's promise is that of `change`. It is a place, and points to an impulse.
    unsafe {
        change(cloth, |own| {
            impulse.write(own.cloth.take_impulse(collider)?.into());
            Ok(())
        })
    }
}

/// Moves every vertex of a mesh evenly to a position in the world within `seconds`. `positions` are x, y and z of each of
/// the `count` vertices. The scene must be cooked with `--deform`.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `positions` is null or points to `3 * count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_deform_collider(
    cloth: *mut MuslinCloth,
    collider: u32,
    positions: *const f64,
    count: usize,
    seconds: f64,
) -> MuslinStatus {
    // SAFETY: the caller says that it is null or points to so many triples.
    let Some(to) = (unsafe { column(positions.cast::<[f64; 3]>(), count) }) else { return MuslinStatus::NullPointer };
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.deform_collider(collider, to, seconds)?)) }
}

/// Switches a collider off: nothing touches it any more. It still moves.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_switch_off(cloth: *mut MuslinCloth, collider: u32) -> MuslinStatus {
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.switch_off(collider)?)) }
}

/// Switches a collider on again. Refuses where cloth intersects it.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_switch_on(cloth: *mut MuslinCloth, collider: u32) -> MuslinStatus {
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.switch_on(collider)?)) }
}

/// Moves a vertex, pinned or free, at constant velocity to a place in the world within `seconds`, or at once for 0. It
/// stays pinned there.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `place` is null or points to three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_move_to(
    cloth: *mut MuslinCloth,
    vertex: u32,
    place: *const f64,
    seconds: f64,
) -> MuslinStatus {
    // SAFETY: the caller says that it is null or points to three numbers.
    let Some(place) = (unsafe { vector(place) }) else { return MuslinStatus::NullPointer };
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.move_to(vertex, place, seconds)?)) }
}

/// Pins a vertex to a collider where it is now: it moves with the collider.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_attach(cloth: *mut MuslinCloth, vertex: u32, collider: u32) -> MuslinStatus {
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.attach(vertex, collider)?)) }
}

/// Removes all pins of a vertex, if it has any. It keeps the velocity with which they moved it until now.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_release(cloth: *mut MuslinCloth, vertex: u32) -> MuslinStatus {
    // SAFETY: the caller's promise is that of `change`.
    unsafe {
        change(cloth, |own| {
            let count = own.cloth.positions().len() as u32;
            if vertex >= count {
                return Err(LiveError::NoVertex { vertex, count }.into());
            }
            own.cloth.release(vertex);
            Ok(())
        })
    }
}

/// Replaces gravity by a constant one, m/s^2.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `acceleration` is null or points to three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_set_gravity(cloth: *mut MuslinCloth, acceleration: *const f64) -> MuslinStatus {
    // SAFETY: the caller says that it is null or points to three numbers.
    let Some(acceleration) = (unsafe { vector(acceleration) }) else { return MuslinStatus::NullPointer };
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.set_gravity(acceleration)?)) }
}

/// Replaces the velocity of the air by a constant one, m/s. The scene must have wind, if only at velocity 0.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `velocity` is null or points to three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_set_wind(cloth: *mut MuslinCloth, velocity: *const f64) -> MuslinStatus {
    // SAFETY: the caller says that it is null or points to three numbers.
    let Some(velocity) = (unsafe { vector(velocity) }) else { return MuslinStatus::NullPointer };
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.set_wind(velocity)?)) }
}

/// Sets a force on a vertex, N, until it is set again. The scene must be cooked with room (`--forces`).
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `force` is null or points to three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_set_force(cloth: *mut MuslinCloth, vertex: u32, force: *const f64) -> MuslinStatus {
    // SAFETY: the caller says that it is null or points to three numbers.
    let Some(force) = (unsafe { vector(force) }) else { return MuslinStatus::NullPointer };
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.set_force(vertex, force)?)) }
}

/// Gives a vertex an impulse, N s: its velocity changes at once, but not along axes that a pin holds.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `impulse` is null or points to three numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_push(cloth: *mut MuslinCloth, vertex: u32, impulse: *const f64) -> MuslinStatus {
    // SAFETY: the caller says that it is null or points to three numbers.
    let Some(impulse) = (unsafe { vector(impulse) }) else { return MuslinStatus::NullPointer };
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.push(vertex, impulse)?)) }
}

/// Moves all cloth, its pins and the given colliders by a rotation about the world's origin and then by a displacement, at
/// once. The cloth feels nothing of it.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `by` is null or points to a pose, and `colliders` to `count`
/// numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_teleport(
    cloth: *mut MuslinCloth,
    by: *const MuslinPose,
    colliders: *const u32,
    count: usize,
) -> MuslinStatus {
    // SAFETY: the caller says that they are null or point to a pose and to so many numbers.
    let (Some(by), Some(colliders)) = (unsafe { (given(by), column(colliders, count)) }) else {
        return MuslinStatus::NullPointer;
    };
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.teleport(by.into(), colliders)?)) }
}

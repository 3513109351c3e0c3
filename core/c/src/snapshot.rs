//! Copies of the state in bytes of the caller.

use core::slice;

use muslin_core::error::LiveError;

use crate::handle::{MuslinCloth, change, seen};
use crate::read::column;
use crate::status::MuslinStatus;

/// Size of a snapshot, bytes; 0 if the handle is bad.
///
/// # Safety
/// `cloth` is null or a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_snapshot_bytes(cloth: *const MuslinCloth) -> usize {
    // SAFETY: the caller's promise is that of `seen`.
    unsafe { seen(cloth) }.map_or(0, |own| own.cloth.snapshot_bytes())
}

/// Writes a copy of all that steps and calls change: `muslin_snapshot_bytes`, which `muslin_go_back` takes. `length` is at
/// least as much; bytes beyond them, and all bytes if the call fails, stay as they were.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `bytes` is null or points to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_snapshot(cloth: *mut MuslinCloth, bytes: *mut u8, length: usize) -> MuslinStatus {
    if bytes.is_null() {
        return MuslinStatus::NullPointer;
    }
    let write = |own: &mut MuslinCloth| {
        let needed = own.cloth.snapshot_bytes();
        if length < needed {
            return Err(LiveError::Memory.into());
        }
        // SAFETY: the pointer is not null, and the caller gives so many bytes. They are written before they are named.
        let out = unsafe {
            bytes.write_bytes(0, needed);
            slice::from_raw_parts_mut(bytes, needed)
        };
        Ok(own.cloth.snapshot(out)?)
    };
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, write) }
}

/// Goes back to a snapshot of this cloth, or of another one with the same triangles, colliders, pins and room, whose
/// materials and rest shapes may differ: to change materials, take a snapshot, open a scene with other materials in the same
/// memory, and go back. `muslin_touches` finds nothing until the next step.
///
/// # Safety
/// `cloth` is null or a handle that nothing else uses meanwhile; `bytes` is null or points to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_go_back(cloth: *mut MuslinCloth, bytes: *const u8, length: usize) -> MuslinStatus {
    // SAFETY: the caller says that it is null or points to so many bytes.
    let Some(from) = (unsafe { column(bytes, length) }) else { return MuslinStatus::NullPointer };
    // SAFETY: the caller's promise is that of `change`.
    unsafe { change(cloth, |own| Ok(own.cloth.go_back(from)?)) }
}

//! The handle of an opened scene, which lies in memory of the caller.

use core::cell::Cell;
use core::ffi::c_char;
use core::fmt::{self, Write as _};
use core::mem::size_of;
use core::slice;

use muslin_core::cooked::{self, ALIGNMENT, Cloth};
use muslin_core::error::LiveError;
use muslin_core::real::Vec3;
use muslin_core::refusal::StepError;

use crate::status::MuslinStatus;

/// The first bytes of a handle.
const MAGIC: u64 = u64::from_le_bytes(*b"MuslinC\x01");

/// A cloth in memory of the caller. Its contents are private.
#[repr(C, align(32))]
pub struct MuslinCloth {
    magic: u64,
    pub(crate) cloth: Cloth<'static>,
    /// Normals of the vertices.
    pub(crate) normals: &'static mut [Vec3],
    last: Cell<Last>,
}

/// The last error of a handle.
#[derive(Clone, Copy)]
enum Last {
    None,
    Step(StepError),
    Live(LiveError),
}

/// Bytes before the memory of the cloth, and those of them before the normals.
fn head(vertices: usize) -> Option<[usize; 2]> {
    let own = size_of::<MuslinCloth>().next_multiple_of(ALIGNMENT);
    let normals = vertices.checked_mul(size_of::<Vec3>())?.checked_next_multiple_of(ALIGNMENT)?;
    Some([own.checked_add(normals)?, own])
}

/// Bytes that a scene needs as memory, by its header.
fn needed(block: &[u8]) -> Result<usize, MuslinStatus> {
    let own = cooked::required_bytes(block)?;
    let [head, _] = head(cooked::vertices(block)?).ok_or(MuslinStatus::Malformed)?;
    head.checked_add(own).ok_or(MuslinStatus::Malformed)
}

/// The version of the library: `0x00MMmmpp`.
#[unsafe(no_mangle)]
pub extern "C" fn muslin_version() -> u32 {
    let part = |text: &str| text.bytes().fold(0, |number, digit| 10 * number + u32::from(digit - b'0'));
    part(env!("CARGO_PKG_VERSION_MAJOR")) << 16
        | part(env!("CARGO_PKG_VERSION_MINOR")) << 8
        | part(env!("CARGO_PKG_VERSION_PATCH"))
}

/// Writes the number of bytes that `muslin_open` needs as memory for a scene. It reads the header alone, so a damaged scene
/// may pass.
///
/// # Safety
/// `block` points to `block_length` bytes, and `bytes` to a `size_t`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_required_bytes(
    block: *const u8,
    block_length: usize,
    bytes: *mut usize,
) -> MuslinStatus {
    if block.is_null() || !is_place(bytes) {
        return MuslinStatus::NullPointer;
    }
    // SAFETY: the pointer is not null, and the caller gives this length.
    let block = unsafe { slice::from_raw_parts(block, block_length) };
    let needed = match needed(block) {
        Ok(needed) => needed,
        Err(status) => return status,
    };
    // SAFETY: it is a place, and the caller says that it points to a number.
    unsafe { bytes.write(needed) };
    MuslinStatus::Ok
}

/// Opens a cooked scene where it lies, and writes a handle. Scene and memory must stay as they are while the handle is
/// used, and both begin at a multiple of 32 bytes. There is nothing to close: the memory belongs to the caller. It stays as
/// it was if the scene is damaged or the memory too small.
///
/// # Safety
/// `block` points to `block_length` bytes, `memory` to `memory_length` bytes that nothing else uses, and `cloth` to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_open(
    block: *const u8,
    block_length: usize,
    memory: *mut u8,
    memory_length: usize,
    cloth: *mut *mut MuslinCloth,
) -> MuslinStatus {
    if !is_place(cloth) {
        return MuslinStatus::NullPointer;
    }
    // SAFETY: it is a place, and the caller says that it points to a pointer.
    unsafe { cloth.write(core::ptr::null_mut()) };
    if block.is_null() || memory.is_null() {
        return MuslinStatus::NullPointer;
    }
    if !(memory as usize).is_multiple_of(ALIGNMENT) {
        return MuslinStatus::Alignment;
    }
    // SAFETY: the pointer is not null, and the caller gives this length and leaves the bytes alone.
    let block: &'static [u8] = unsafe { slice::from_raw_parts(block, block_length) };
    if let Err(status) = fits(block, memory_length) {
        return status;
    }
    // SAFETY: as for the block. The memory is written before it is named, because the caller need not have written it.
    let memory = unsafe {
        memory.write_bytes(0, memory_length);
        slice::from_raw_parts_mut(memory, memory_length)
    };
    let opened = match guarded(|| open(block, memory)) {
        Some(Ok(opened)) => opened,
        Some(Err(status)) => return status,
        None => return MuslinStatus::Internal,
    };
    // SAFETY: as above.
    unsafe { cloth.write(opened) };
    MuslinStatus::Ok
}

/// Whether a block is whole and its work has room in so much memory.
fn fits(block: &[u8], memory_length: usize) -> Result<(), MuslinStatus> {
    cooked::is_whole(block)?;
    if memory_length < needed(block)? { Err(MuslinStatus::Memory) } else { Ok(()) }
}

fn open(block: &'static [u8], memory: &'static mut [u8]) -> Result<*mut MuslinCloth, MuslinStatus> {
    let vertices = cooked::vertices(block)?;
    let [head, own] = head(vertices).ok_or(MuslinStatus::Malformed)?;
    let (head, rest) = memory.split_at_mut_checked(head).ok_or(MuslinStatus::Memory)?;
    let (own, normals) = head.split_at_mut(own);
    let normals = bytemuck::try_cast_slice_mut(normals.get_mut(..vertices * size_of::<Vec3>()).unwrap_or_default());
    let normals = normals.map_err(|_| MuslinStatus::Alignment)?;
    let handle = MuslinCloth { magic: MAGIC, cloth: Cloth::open(block, rest)?, normals, last: Cell::new(Last::None) };
    let place = own.as_mut_ptr().cast::<MuslinCloth>();
    // SAFETY: the bytes are as many as a handle has, aligned, and nothing else names them.
    unsafe { place.write(handle) };
    Ok(place)
}

/// Writes the words of the last call with this handle that was refused or whose step failed, with the numbers in it, and a
/// final zero. Null pointers leave them as they were. Cuts them to `capacity` bytes.
/// Returns the length of all words without the zero.
///
/// # Safety
/// `cloth` is null or a handle; `text` is null or points to `capacity` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn muslin_error(cloth: *const MuslinCloth, text: *mut c_char, capacity: usize) -> usize {
    let out: &mut [u8] = match text.is_null() {
        true => &mut [],
        // SAFETY: the pointer is not null, and the caller gives this length. The bytes are written before they are named.
        false => unsafe {
            text.write_bytes(0, capacity);
            slice::from_raw_parts_mut(text.cast(), capacity)
        },
    };
    // SAFETY: the caller's promise is that of `seen`.
    let Some(own) = (unsafe { seen(cloth) }) else { return 0 };
    let mut text = Text { out, length: 0 };
    let written = match own.last.get() {
        Last::None => Ok(()),
        Last::Step(error) => write!(text, "{error}"),
        Last::Live(error) => write!(text, "{error}"),
    };
    let end = text.length.min(text.out.len().saturating_sub(1));
    if let Some(last) = text.out.get_mut(end) {
        *last = 0;
    }
    written.map_or(0, |()| text.length)
}

/// Bytes that take as much of a text as they have room for.
struct Text<'a> {
    out: &'a mut [u8],
    length: usize,
}

impl fmt::Write for Text<'_> {
    fn write_str(&mut self, more: &str) -> fmt::Result {
        for byte in more.bytes() {
            if let Some(place) = self.out.get_mut(self.length) {
                *place = byte;
            }
            self.length += 1;
        }
        Ok(())
    }
}

/// Whether a pointer is neither null nor misaligned.
pub(crate) fn is_place<T>(pointer: *const T) -> bool {
    !pointer.is_null() && pointer.is_aligned()
}

/// A struct of the caller; `None` if the pointer is null or not aligned.
///
/// # Safety
/// `pointer` is null or points to such a struct.
pub(crate) unsafe fn given<T: Copy>(pointer: *const T) -> Option<T> {
    // SAFETY: it is a place, and the rest is the caller's promise.
    if is_place(pointer) { Some(unsafe { pointer.read() }) } else { None }
}

/// The handle that a pointer names, if it is one.
///
/// # Safety
/// The pointer is null, or a handle that nothing changes meanwhile.
pub(crate) unsafe fn seen<'a>(cloth: *const MuslinCloth) -> Option<&'a MuslinCloth> {
    // SAFETY: the caller's promise is that of `is_handle`, and a handle can be named.
    unsafe { if is_handle(cloth) { cloth.as_ref() } else { None } }
}

/// Whether a pointer names a handle. It reads the mark before it takes the bytes for a handle.
///
/// # Safety
/// The pointer is null, or points to as many bytes as a handle has.
unsafe fn is_handle(cloth: *const MuslinCloth) -> bool {
    // SAFETY: it is a place, and the rest is the caller's promise.
    is_place(cloth) && unsafe { (&raw const (*cloth).magic).read() == MAGIC }
}

/// Asks a handle, and keeps the error. `None` if it panics.
pub(crate) fn asked<T>(
    own: &MuslinCloth,
    ask: impl FnOnce(&MuslinCloth) -> Result<T, LiveError>,
) -> Option<Result<T, LiveError>> {
    let answer = guarded(|| ask(own));
    if let Some(Err(error)) = answer {
        own.last.set(Last::Live(error));
    }
    answer
}

/// Calls `act` with the handle that a pointer names, and keeps the error.
///
/// # Safety
/// The pointer is null, or a handle that nothing else uses meanwhile.
pub(crate) unsafe fn change(
    cloth: *mut MuslinCloth,
    act: impl FnOnce(&mut MuslinCloth) -> Result<(), Failed>,
) -> MuslinStatus {
    if cloth.is_null() {
        return MuslinStatus::NullPointer;
    }
    // SAFETY: the caller's promise is that of `is_handle`.
    if !unsafe { is_handle(cloth) } {
        return MuslinStatus::BadHandle;
    }
    // SAFETY: it is a handle, and the rest is the caller's promise.
    let own = unsafe { &mut *cloth };
    match guarded(|| act(own)) {
        Some(Ok(())) => MuslinStatus::Ok,
        Some(Err(Failed { status, last })) => {
            own.last.set(last);
            status
        }
        None => {
            own.magic = 0;
            MuslinStatus::Internal
        }
    }
}

/// Why a call failed.
pub struct Failed {
    status: MuslinStatus,
    last: Last,
}

impl From<LiveError> for Failed {
    fn from(error: LiveError) -> Self {
        Self { status: error.into(), last: Last::Live(error) }
    }
}

impl From<StepError> for Failed {
    fn from(error: StepError) -> Self {
        Self { status: error.cause.into(), last: Last::Step(error) }
    }
}

/// Calls `act`; `None` if it panics.
#[cfg(feature = "std")]
fn guarded<T>(act: impl FnOnce() -> T) -> Option<T> {
    // A call that changes the handle and panics spoils it, so nothing uses its state again.
    std::panic::catch_unwind(core::panic::AssertUnwindSafe(act)).ok()
}

#[cfg(not(feature = "std"))]
fn guarded<T>(act: impl FnOnce() -> T) -> Option<T> {
    Some(act())
}

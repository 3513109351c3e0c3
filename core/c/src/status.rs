//! The result of every call.

use core::ffi::{CStr, c_char};

use muslin_core::cooked::CookedError;
use muslin_core::error::LiveError;
use muslin_core::refusal::Cause;

/// The result of a call. A call that does not return `MUSLIN_STATUS_OK` has changed nothing (`muslin_step` names its exception).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MuslinStatus {
    /// Success.
    Ok = 0,
    /// A pointer is null or not aligned.
    NullPointer = 1,
    /// The pointer is not a handle from muslin_open, or a call that failed inside has spoiled it.
    BadHandle = 2,
    /// The bytes are not a cooked scene; make one with muslin cook.
    NotCooked = 10,
    /// The scene was cooked by another version of Muslin; cook it again.
    Version = 11,
    /// The scene was cooked in double precision; cook it with --precision f32.
    Precision = 12,
    /// The cooked scene does not have the length that it says.
    Truncated = 13,
    /// The cooked scene is damaged: its checksum is wrong.
    Checksum = 14,
    /// The scene and the memory must begin at a multiple of 32 bytes.
    Alignment = 15,
    /// The memory is too small; muslin_required_bytes and muslin_snapshot_bytes tell the sizes.
    Memory = 16,
    /// The cooked scene has a number that cannot be; cook it again.
    Malformed = 17,
    /// Cooked scenes work on little-endian processors only.
    ByteOrder = 18,
    /// The step diverged: a position or velocity is not finite.
    NotFiniteState = 30,
    /// The step has more contacts than can be resolved.
    TooMuchContact = 31,
    /// Surfaces could not be kept apart in the step.
    SurfacesMeet = 32,
    /// The step has too large an error.
    Inaccurate = 33,
    /// The step lacks room for contacts; the report says how much; cook the scene with more (--margin, or --pairs and --contacts).
    NoRoom = 34,
    /// The step would need more than its budget.
    OverBudget = 35,
    /// The step met a fault of Muslin, please report it; the state has not changed.
    Fault = 36,
    /// There is no such vertex.
    NoVertex = 50,
    /// There is no such triangle.
    NoTriangle = 51,
    /// There is no such collider.
    NoCollider = 52,
    /// A number is not finite.
    NotFinite = 53,
    /// A time must be finite and not negative.
    Seconds = 54,
    /// A collider needs a thousandth of a step at least, or it would jump through the cloth.
    TooFast = 55,
    /// A plane cannot turn; take a box.
    PlaneTurns = 56,
    /// The vertices of the collider move one by one; use muslin_deform_collider.
    Deforms = 57,
    /// A vertex is attached to the collider, so it cannot deform; release the vertex first.
    Carries = 58,
    /// Only a mesh changes its shape.
    NoMesh = 59,
    /// There must be one position for every vertex of the collider.
    Points = 60,
    /// The collider still moves by keys or frames of the scene.
    Scripted = 61,
    /// A vertex is held by a collider that stays, or along single axes that would have to turn.
    Held = 62,
    /// Cloth would intersect a collider.
    Overlaps = 63,
    /// The scene has no wind; give it drag.wind with coefficients, at velocity 0.
    NoWind = 64,
    /// Impulses are not measured; cook the scene with --impulses.
    NotMeasured = 65,
    /// The snapshot is damaged, or of a scene with other meshes, colliders, pins or room.
    OtherScene = 66,
    /// The cooked scene has no free slot for this; cook it with more (--hands, --forces, --deform).
    NoSlot = 67,
    /// A fault of Muslin, please report it; open the scene again.
    Internal = 99,
}

impl MuslinStatus {
    /// All of them.
    ///
    /// cbindgen:ignore
    pub const ALL: [Self; 38] = [
        Self::Ok,
        Self::NullPointer,
        Self::BadHandle,
        Self::NotCooked,
        Self::Version,
        Self::Precision,
        Self::Truncated,
        Self::Checksum,
        Self::Alignment,
        Self::Memory,
        Self::Malformed,
        Self::ByteOrder,
        Self::NotFiniteState,
        Self::TooMuchContact,
        Self::SurfacesMeet,
        Self::Inaccurate,
        Self::NoRoom,
        Self::OverBudget,
        Self::Fault,
        Self::NoVertex,
        Self::NoTriangle,
        Self::NoCollider,
        Self::NotFinite,
        Self::Seconds,
        Self::TooFast,
        Self::PlaneTurns,
        Self::Deforms,
        Self::Carries,
        Self::NoMesh,
        Self::Points,
        Self::Scripted,
        Self::Held,
        Self::Overlaps,
        Self::NoWind,
        Self::NotMeasured,
        Self::OtherScene,
        Self::NoSlot,
        Self::Internal,
    ];

    fn text(self) -> &'static CStr {
        match self {
            Self::Ok => c"success",
            Self::NullPointer => c"a pointer is null or not aligned",
            Self::BadHandle => {
                c"the pointer is not a handle from muslin_open, or a call that failed inside has spoiled it"
            }
            Self::NotCooked => c"the bytes are not a cooked scene; make one with muslin cook",
            Self::Version => c"the scene was cooked by another version of Muslin; cook it again",
            Self::Precision => c"the scene was cooked in double precision; cook it with --precision f32",
            Self::Truncated => c"the cooked scene does not have the length that it says",
            Self::Checksum => c"the cooked scene is damaged: its checksum is wrong",
            Self::Alignment => c"the scene and the memory must begin at a multiple of 32 bytes",
            Self::Memory => c"the memory is too small; muslin_required_bytes and muslin_snapshot_bytes tell the sizes",
            Self::Malformed => c"the cooked scene has a number that cannot be; cook it again",
            Self::ByteOrder => c"cooked scenes work on little-endian processors only",
            Self::NotFiniteState => c"the step diverged: a position or velocity is not finite",
            Self::TooMuchContact => c"the step has more contacts than can be resolved",
            Self::SurfacesMeet => c"surfaces could not be kept apart in the step",
            Self::Inaccurate => c"the step has too large an error",
            Self::NoRoom => c"the step lacks room for contacts; the report says how much; cook the scene with more (--margin, or --pairs and --contacts)",
            Self::OverBudget => c"the step would need more than its budget",
            Self::Fault => c"the step met a fault of Muslin, please report it; the state has not changed",
            Self::NoVertex => c"there is no such vertex",
            Self::NoTriangle => c"there is no such triangle",
            Self::NoCollider => c"there is no such collider",
            Self::NotFinite => c"a number is not finite",
            Self::Seconds => c"a time must be finite and not negative",
            Self::TooFast => c"a collider needs a thousandth of a step at least, or it would jump through the cloth",
            Self::PlaneTurns => c"a plane cannot turn; take a box",
            Self::Deforms => c"the vertices of the collider move one by one; use muslin_deform_collider",
            Self::Carries => c"a vertex is attached to the collider, so it cannot deform; release the vertex first",
            Self::NoMesh => c"only a mesh changes its shape",
            Self::Points => c"there must be one position for every vertex of the collider",
            Self::Scripted => c"the collider still moves by keys or frames of the scene",
            Self::Held => c"a vertex is held by a collider that stays, or along single axes that would have to turn",
            Self::Overlaps => c"cloth would intersect a collider",
            Self::NoWind => c"the scene has no wind; give it drag.wind with coefficients, at velocity 0",
            Self::NotMeasured => c"impulses are not measured; cook the scene with --impulses",
            Self::OtherScene => c"the snapshot is damaged, or of a scene with other meshes, colliders, pins or room",
            Self::NoSlot => {
                c"the cooked scene has no free slot for this; cook it with more (--hands, --forces, --deform)"
            }
            Self::Internal => c"a fault of Muslin, please report it; open the scene again",
        }
    }
}

/// The words of a status. `muslin_error` tells more about the last error of a handle.
#[unsafe(no_mangle)]
pub extern "C" fn muslin_message(status: i32) -> *const c_char {
    let known = MuslinStatus::ALL.iter().find(|&&it| it as i32 == status);
    known.map_or(c"there is no such status", |it| it.text()).as_ptr()
}

impl From<CookedError> for MuslinStatus {
    fn from(error: CookedError) -> Self {
        match error {
            CookedError::NotCooked => Self::NotCooked,
            CookedError::Version(_) => Self::Version,
            CookedError::Precision => Self::Precision,
            CookedError::Truncated => Self::Truncated,
            CookedError::Checksum => Self::Checksum,
            CookedError::Alignment => Self::Alignment,
            CookedError::Memory { .. } => Self::Memory,
            CookedError::Malformed => Self::Malformed,
            CookedError::BigEndian => Self::ByteOrder,
        }
    }
}

impl From<Cause> for MuslinStatus {
    fn from(cause: Cause) -> Self {
        match cause {
            Cause::NotFinite => Self::NotFiniteState,
            Cause::TooMuch => Self::TooMuchContact,
            Cause::Contact { .. } => Self::SurfacesMeet,
            Cause::Inaccurate => Self::Inaccurate,
            Cause::Short { .. } => Self::NoRoom,
            Cause::Stopped => Self::OverBudget,
            Cause::Fault => Self::Fault,
        }
    }
}

impl From<LiveError> for MuslinStatus {
    fn from(error: LiveError) -> Self {
        match error {
            LiveError::NoVertex { .. } => Self::NoVertex,
            LiveError::NoTriangle { .. } => Self::NoTriangle,
            LiveError::NoCollider { .. } => Self::NoCollider,
            LiveError::NotFinite { .. } => Self::NotFinite,
            LiveError::Seconds { .. } => Self::Seconds,
            LiveError::TooFast { .. } => Self::TooFast,
            LiveError::PlaneTurns { .. } => Self::PlaneTurns,
            LiveError::Deforms { .. } => Self::Deforms,
            LiveError::Carries { .. } => Self::Carries,
            LiveError::NoMesh { .. } => Self::NoMesh,
            LiveError::Points { .. } => Self::Points,
            LiveError::Scripted { .. } => Self::Scripted,
            LiveError::Held { .. } => Self::Held,
            LiveError::Overlaps { .. } => Self::Overlaps,
            LiveError::NoWind => Self::NoWind,
            LiveError::NotMeasured => Self::NotMeasured,
            LiveError::OtherScene => Self::OtherScene,
            LiveError::Memory => Self::Memory,
            LiveError::NoSlot => Self::NoSlot,
        }
    }
}

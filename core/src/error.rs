//! The errors of meshes and scenes: small `Copy` enums with one sentence per variant. Only set-up
//! returns errors; kernels return nothing, and steps return a status.

#![expect(missing_docs, reason = "a variant's sentence explains its fields")]

use core::fmt;

/// Reason why a mesh cannot be used. [`TriMesh::check`](crate::mesh::TriMesh::check) and the other
/// functions of set-up find all errors, so that kernels need no checks of indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshError {
    /// The mesh has no triangles.
    Empty,
    /// A triangle names a vertex that does not exist.
    VertexOutOfRange { triangle: u32, vertex: u32, vertices: u32 },
    /// A triangle names a texture coordinate that does not exist.
    TextureOutOfRange { triangle: u32, coordinate: u32, coordinates: u32 },
    /// A position is NaN or infinite.
    NotFinite { vertex: u32 },
    /// A texture coordinate is NaN or infinite.
    TextureNotFinite { coordinate: u32 },
    /// A triangle names one vertex twice.
    RepeatedVertex { triangle: u32, vertex: u32 },
    /// A triangle has no area at rest.
    NoArea { triangle: u32 },
    /// More than two triangles share an edge.
    NonManifoldEdge { a: u32, b: u32 },
    /// `count` vertices belong to no triangle and would have no mass; `vertex` is the first of them.
    LooseVertex { vertex: u32, count: u32 },
    /// A vertex belongs to more triangles than the solver can index.
    Hub { vertex: u32, most: u32 },
    /// The rest shape should come from texture coordinates, but the mesh has none.
    NoTextureCoordinates,
    /// The number of start positions differs from the number of vertices.
    StateLength { expected: u32, found: u32 },
    /// A stitch names a vertex that does not exist, its weight is not in 0..=1, or it sews a vertex to itself.
    BadStitch { stitch: u32 },
}

impl fmt::Display for MeshError {
    #[cfg_attr(small, optimize(size))]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Empty => write!(f, "the mesh has no triangles"),
            Self::VertexOutOfRange { triangle, vertex, vertices } => {
                write!(
                    f,
                    "triangle {triangle} names vertex {vertex}, but there are only {vertices} (indices count from 0)"
                )
            }
            Self::TextureOutOfRange { triangle, coordinate, coordinates } => {
                write!(f, "triangle {triangle} names texture coordinate {coordinate}, but there are only {coordinates}")
            }
            Self::NotFinite { vertex } => {
                write!(f, "the position of vertex {vertex} is not a finite number (indices count from 0)")
            }
            Self::TextureNotFinite { coordinate } => {
                write!(f, "texture coordinate {coordinate} is not a finite number (indices count from 0)")
            }
            Self::RepeatedVertex { triangle, vertex } => {
                write!(f, "triangle {triangle} names vertex {vertex} twice (indices count from 0)")
            }
            Self::NoArea { triangle } => write!(f, "triangle {triangle} has no area at rest (indices count from 0)"),
            Self::NonManifoldEdge { a, b } => {
                write!(
                    f,
                    "the edge between vertices {a} and {b} belongs to more than two triangles; split the mesh there \
                     (indices count from 0)"
                )
            }
            Self::LooseVertex { vertex, count: 1 } => {
                write!(
                    f,
                    "vertex {vertex} belongs to no triangle and would have no mass; remove it (indices count from 0)"
                )
            }
            Self::LooseVertex { vertex, count } => {
                write!(
                    f,
                    "{count} vertices, the first of them {vertex}, belong to no triangle and would have no mass; \
                     remove them (indices count from 0)"
                )
            }
            Self::Hub { vertex, most } => {
                write!(
                    f,
                    "more than {most} triangles meet at vertex {vertex}; split the mesh there (indices count from 0)"
                )
            }
            Self::NoTextureCoordinates => {
                write!(f, "rest = \"uv\" needs texture coordinates (vt), and the mesh has none; use rest = \"shape\"")
            }
            Self::StateLength { expected, found } => {
                write!(f, "the start state has {found} vertices, the mesh has {expected}")
            }
            Self::BadStitch { stitch } => {
                write!(
                    f,
                    "stitch {stitch} names a vertex that does not exist, sews a vertex to itself, or has a weight \
                     that is not between 0 and 1"
                )
            }
        }
    }
}

impl core::error::Error for MeshError {}

/// Reason why a selection of vertices is not usable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SelectError {
    /// It selects no vertex.
    Empty,
    /// No vertex lies in its place. The cloth lies in this box, m.
    Elsewhere { lowest: [f64; 3], highest: [f64; 3] },
    /// It gives no way to select, or more than one.
    OneWay,
    /// It names a corner, a ring or a vertex that does not exist.
    OutOfRange { kind: &'static str, index: u32, last: u32 },
    /// Its only field says that it is not the border.
    NoBorder,
    /// It names a ring, but the cloth is not a disc.
    NoDisc,
    /// A total should be shared by length, but no edge joins two selected vertices.
    NoEdge,
    /// A number is not finite, a distance is negative, or a normal has no direction.
    BadNumbers,
}

impl fmt::Display for SelectError {
    #[cfg_attr(small, optimize(size))]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Empty => write!(f, "selects no vertex"),
            Self::Elsewhere { lowest, highest } => {
                let [low, high] = [lowest, highest].map(|corner| corner.map(|x| x as f32));
                write!(f, "selects no vertex; the cloth lies between {low:?} and {high:?} m")
            }
            Self::OneWay => {
                write!(f, "give exactly one of corners, vertices, box, nearest, edge, ring, border, line or plane")
            }
            Self::NoBorder => {
                write!(f, "border = false selects nothing; write border = true, or another selection")
            }
            Self::OutOfRange { kind, index, last } => {
                write!(f, "there is no {kind} {index}: the last one is {last}")
            }
            Self::NoDisc => write!(f, "only a disc has rings; select by border, line or plane instead"),
            Self::NoEdge => write!(f, "share = \"length\" needs edges between the selected vertices"),
            Self::BadNumbers => {
                write!(
                    f,
                    "the numbers of select must be finite, within must not be negative, and a normal needs a direction"
                )
            }
        }
    }
}

/// Reason why the motion of a collider is not usable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColliderMotionError {
    /// Times of keys do not increase, or a number is not finite.
    Keys,
    /// The axis of a rotation has no direction, or the rotation has a number that is not valid.
    Turn,
    /// A plane cannot turn.
    Plane,
    /// A number of a point cache is not finite.
    Cache,
}

/// Reason why a scene cannot be built. Indices of cloths, pins, seams and colliders count from 0 in the
/// order of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SceneError {
    /// The scene has no cloth.
    NoCloth,
    /// A cloth names no source of its mesh, or more than one.
    OneMeshSource { cloth: u32 },
    /// A mesh file that a cloth names was not passed to the build.
    MissingMesh { cloth: u32 },
    /// The mesh of a cloth is not usable.
    Mesh { cloth: u32, error: MeshError },
    /// A number that must be positive and finite is not.
    NotPositive { key: &'static str, value: f64 },
    /// A number that must be zero or more and finite is not.
    Negative { key: &'static str, value: f64 },
    /// A number that must be finite is not.
    NotFinite { key: &'static str },
    /// A vector over time has no key, its times do not increase, or a number in its keys is not finite.
    VectorKeys { key: &'static str },
    /// A number that must be less than 1 is not.
    NotBelowOne { key: &'static str, value: f64 },
    /// An edge is so far from the first cloth, or from the world's origin, that its ends are rounded to a large part of
    /// its length.
    TooFar { a: u32, b: u32 },
    /// A seam has no stitches.
    EmptySeam { cloth: u32, seam: u32 },
    /// A generated mesh has too few cells.
    TooFewCells { key: &'static str, least: u32 },
    /// The scene would have more vertices than indices can address.
    TooLarge { vertices: u64 },
    /// There is not enough memory for the scene; `bytes` is an estimate.
    Memory { vertices: u64, bytes: u64 },
    /// A key is given that the chosen model does not have.
    KeyNotForModel { key: &'static str, model: &'static str },
    /// A key is missing that the chosen model needs.
    KeyNeeded { key: &'static str, model: &'static str },
    /// The selection of a part of a cloth, such as a pin, is not usable.
    Selection { cloth: u32, part: &'static str, number: u32, error: SelectError },
    /// A mass gives neither a total nor a density, or both.
    OneMass { cloth: u32, number: u32 },
    /// The axis of a cloth's rotation has no direction.
    SpinAxis { cloth: u32 },
    /// The axes of a pin are not a combination of x, y and z.
    PinAxes { cloth: u32, pin: u32 },
    /// The times of a pin's keys do not increase, or a number in the keys is not finite.
    MotionKeys { cloth: u32, pin: u32 },
    /// The axis of a pin's rotation has no direction, or the rotation has a number that is not valid.
    MotionTurn { cloth: u32, pin: u32 },
    /// A pin ends before it begins, or its end is not finite.
    PinEnds { cloth: u32, pin: u32 },
    /// Two pins of a cloth have different motions for a vertex at the same time.
    PinsDisagree { cloth: u32, pins: [u32; 2], vertex: u32 },
    /// The static coefficient of friction is below the kinetic one.
    StaticBelowKinetic { at_rest: f64, kinetic: f64 },
    /// Error control needs to halve steps.
    ErrorWithoutHalving,
    /// The scene has a collider but no contact section.
    ColliderWithoutContact,
    /// A key is missing that the shape of a collider needs.
    ShapeNeeds { collider: u32, key: &'static str, shape: &'static str },
    /// A key is given that the shape of a collider does not have.
    NotOfShape { collider: u32, key: &'static str, shape: &'static str },
    /// The normal of a plane has no direction.
    NoNormal { collider: u32 },
    /// A file that a collider names was not passed to the build.
    MissingColliderFile { collider: u32 },
    /// The mesh of a collider is not usable.
    ColliderMesh { collider: u32, error: MeshError },
    /// A point cache has another number of points than its mesh, or no whole frame.
    CachePoints { collider: u32, expected: u32, found: u32 },
    /// The motion of a collider is not usable.
    ColliderMotion { collider: u32, error: ColliderMotionError },
}

/// Reason why a running simulation refuses what its host asks for. Nothing has changed then. Indices count from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LiveError {
    /// There is no such vertex.
    NoVertex { vertex: u32, count: u32 },
    /// There is no such triangle.
    NoTriangle { triangle: u32, count: u32 },
    /// There is no such collider.
    NoCollider { collider: u32, count: u32 },
    /// A number must be finite; `name` names it.
    NotFinite { name: &'static str },
    /// A time is negative or not finite.
    Seconds { seconds: f64 },
    /// A collider would jump: it needs a thousandth of a step at least.
    TooFast { seconds: f64, least: f64 },
    /// A plane cannot turn.
    PlaneTurns { collider: u32 },
    /// The vertices of the collider move one by one.
    Deforms { collider: u32 },
    /// A vertex is attached to the collider, which would deform.
    Carries { collider: u32, vertex: u32 },
    /// Only meshes change their shape.
    NoMesh { collider: u32 },
    /// A list of positions does not have one for every vertex of the collider.
    Points { collider: u32, expected: u32, found: u32 },
    /// A collider still moves by the keys or the point cache of its scene, which name places in the world.
    Scripted { collider: u32 },
    /// A vertex is held by a collider that stays, or along single axes that would have to turn.
    Held { vertex: u32 },
    /// Cloth would intersect a collider.
    Overlaps { collider: u32 },
    /// The scene has no wind, so there are no coefficients of it.
    NoWind,
    /// Impulses are not measured.
    NotMeasured,
    /// Another scene has other meshes, colliders, force terms or laws of friction.
    OtherScene,
    /// There is not enough memory.
    Memory,
    /// A cooked cloth holds as many vertices as it has slots for.
    NoSlot,
}

impl fmt::Display for LiveError {
    #[cfg_attr(small, optimize(size))]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let missing = |f: &mut fmt::Formatter<'_>, kind: &str, index: u32, count: u32| match count {
            0 => write!(f, "there is no {kind} {index}: the scene has no {kind}"),
            _ => write!(f, "there is no {kind} {index}: the last one is {}", count - 1),
        };
        match *self {
            Self::NoVertex { vertex, count } => missing(f, "vertex", vertex, count),
            Self::NoTriangle { triangle, count } => missing(f, "triangle", triangle, count),
            Self::NoCollider { collider, count } => missing(f, "collider", collider, count),
            Self::NotFinite { name } => write!(f, "{name} must be finite"),
            // Without the numbers: the standard library can panic where it writes one with decimals.
            Self::Seconds { .. } => write!(f, "the time must be finite and not negative"),
            Self::TooFast { .. } => write!(
                f,
                "the time must be finite and at least a thousandth of a step, or the collider would jump \
                 through the cloth; teleport moves it together with the cloth"
            ),
            Self::PlaneTurns { collider } => {
                write!(f, "collider {collider}: a plane cannot turn; take a box whose side is as large as the cloth")
            }
            Self::Deforms { collider } => {
                write!(f, "collider {collider}: its vertices move one by one; give their positions (deform_collider)")
            }
            Self::Carries { collider, vertex } => {
                write!(f, "collider {collider} carries vertex {vertex}, so it cannot deform; release the vertex first")
            }
            Self::NoMesh { collider } => write!(f, "collider {collider}: only a mesh changes its shape"),
            Self::Points { collider, expected, found } => {
                write!(f, "collider {collider}: {found} positions are given, it has {expected} vertices")
            }
            Self::Scripted { collider } => write!(
                f,
                "collider {collider} still moves by keys or frames, which name places in the world; move it from the \
                 program instead"
            ),
            Self::Held { vertex } => write!(
                f,
                "vertex {vertex} is held by a collider that stays, or along single axes that would have to turn; release it, \
                 or move the collider too"
            ),
            Self::Overlaps { collider } => {
                write!(f, "cloth would intersect collider {collider}; move one of them away first")
            }
            Self::NoWind => write!(f, "the scene has no wind; give it [drag.wind] with coefficients, at velocity 0"),
            Self::NotMeasured => write!(
                f,
                "impulses are not measured; measure them from before the steps on: measure_reactions in Rust, measureImpulses in \
                 JavaScript, --impulses for a scene that is cooked"
            ),
            Self::OtherScene => {
                write!(
                    f,
                    "the snapshot is damaged, or the scene has other meshes, colliders, force terms or laws of friction; only numbers may differ"
                )
            }
            Self::Memory => write!(f, "there is not enough memory"),
            Self::NoSlot => {
                write!(f, "the cooked scene has no free slot for this; cook it with more (--hands, --forces, --deform)")
            }
        }
    }
}

impl core::error::Error for LiveError {}

/// A vector that is finite; `name` is for the error.
pub(crate) fn checked_vector(name: &'static str, vector: [f64; 3]) -> Result<glam::DVec3, LiveError> {
    let vector = glam::DVec3::from(vector);
    // Columns may have single precision.
    if crate::real::vec3(vector.into()).is_finite() { Ok(vector) } else { Err(LiveError::NotFinite { name }) }
}

/// Displays a number without an exponent, unless it is so large or so small that it would need many zeros.
struct Number(f64);

impl fmt::Display for Number {
    #[cfg_attr(small, optimize(size))]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        match value.abs() {
            size if size == 0.0 || (1e-6..1e9).contains(&size) || !size.is_finite() => write!(f, "{value}"),
            _ => write!(f, "{value:e}"),
        }
    }
}

impl From<(u32, MeshError)> for SceneError {
    fn from((cloth, error): (u32, MeshError)) -> Self {
        Self::Mesh { cloth, error }
    }
}

impl fmt::Display for SceneError {
    #[cfg_attr(small, optimize(size))]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoCloth => write!(f, "the scene has no [[cloth]]"),
            Self::OneMeshSource { cloth } => write!(f, "cloth {cloth}: give exactly one of grid, tube, disc or mesh"),
            Self::MissingMesh { cloth } => write!(f, "cloth {cloth}: its mesh file was not loaded"),
            Self::Mesh { cloth, error } => write!(f, "cloth {cloth}: {error}"),
            Self::NotPositive { key, value } => {
                write!(f, "{key} = {}: must be greater than zero and finite", Number(value))
            }
            Self::Negative { key, value } => {
                write!(f, "{key} = {}: must not be negative, and must be finite", Number(value))
            }
            Self::NotBelowOne { key, value } => write!(f, "{key} = {}: must be less than 1", Number(value)),
            Self::TooFar { a, b } => {
                write!(
                    f,
                    "vertices {a} and {b} are too far away: {} rounds their positions to more than a hundredth of their \
                     distance; move all cloths together and nearer to the origin, or use coarser cells or double precision",
                    crate::real::NAME
                )
            }
            Self::EmptySeam { cloth, seam } => {
                write!(f, "cloth {cloth}, seam {seam}: joins no vertices; give pairs, or a file with stitch lines")
            }
            Self::NotFinite { key } => write!(f, "{key}: must be a finite number"),
            Self::VectorKeys { key } => {
                write!(
                    f,
                    "{key}: give at least one key [time, x, y, z]; all numbers must be finite, and times must increase"
                )
            }
            Self::TooFewCells { key, least } => write!(f, "{key}: must be at least {least}"),
            Self::TooLarge { vertices } => {
                write!(f, "the scene would have {vertices} vertices; at most 2^28 are possible")
            }
            Self::Memory { vertices, bytes } => {
                write!(
                    f,
                    "the scene has {vertices} vertices and needs about {} MB of memory, more than is left; take a coarser \
                     mesh",
                    bytes.div_ceil(1_000_000)
                )
            }
            Self::KeyNotForModel { key, model } => {
                write!(f, "{key} has no meaning with model = \"{model}\"; remove it")
            }
            Self::KeyNeeded { key, model } => write!(f, "{key} is needed with model = \"{model}\""),
            Self::Selection { cloth, part, number, error } => write!(f, "cloth {cloth}, {part} {number}: {error}"),
            Self::OneMass { cloth, number } => {
                write!(f, "cloth {cloth}, mass {number}: give exactly one of mass and density")
            }
            Self::SpinAxis { cloth } => write!(f, "cloth {cloth}: spin needs an axis with a direction"),
            Self::PinAxes { cloth, pin } => {
                write!(f, "cloth {cloth}, pin {pin}: axes must be a combination of x, y and z, such as \"xz\"")
            }
            Self::MotionKeys { cloth, pin } => {
                write!(f, "cloth {cloth}, pin {pin}: the times of motion.keys must be finite and increase")
            }
            Self::MotionTurn { cloth, pin } => {
                write!(f, "cloth {cloth}, pin {pin}: motion.turn needs an axis with a direction and a finite rate")
            }
            Self::PinEnds { cloth, pin } => {
                write!(f, "cloth {cloth}, pin {pin}: until must be finite and after from")
            }
            Self::PinsDisagree { cloth, pins: [a, b], vertex } => write!(
                f,
                "cloth {cloth}: pins {a} and {b} have different motions for vertex {vertex} at the same time; select it in \
                 one of them, or give them times (from, until) that do not overlap"
            ),
            Self::StaticBelowKinetic { at_rest, kinetic } => {
                write!(f, "friction: static = {} is below kinetic = {}", Number(at_rest), Number(kinetic))
            }
            Self::ErrorWithoutHalving => write!(
                f,
                "contact.halving = false needs steps of fixed length: give an integrator.step, and no integrator.error"
            ),
            Self::ColliderWithoutContact => {
                write!(f, "there is a [[collider]] but no [contact]; add [contact] with a thickness, such as 0.002")
            }
            Self::ShapeNeeds { collider, key, shape } => {
                write!(f, "collider {collider}: {key} is needed with shape = \"{shape}\"")
            }
            Self::NotOfShape { collider, key, shape } => {
                write!(f, "collider {collider}: {key} has no meaning with shape = \"{shape}\"; remove it")
            }
            Self::NoNormal { collider } => write!(f, "collider {collider}: the normal of a plane needs a direction"),
            Self::MissingColliderFile { collider } => write!(f, "collider {collider}: its file was not loaded"),
            Self::ColliderMesh { collider, error } => write!(f, "collider {collider}: {error}"),
            Self::CachePoints { collider, expected, found } => {
                write!(f, "collider {collider}: its point cache has {found} points, its mesh {expected} vertices")
            }
            Self::ColliderMotion { collider, error } => {
                let reason = match error {
                    ColliderMotionError::Keys => "the times of motion.keys must be finite and increase",
                    ColliderMotionError::Turn => "motion.turn needs an axis with a direction and a finite rate",
                    ColliderMotionError::Plane => "a plane cannot turn; take a box whose side is as large as the cloth",
                    ColliderMotionError::Cache => "its point cache has a number that is not finite",
                };
                write!(f, "collider {collider}: {reason}")
            }
        }
    }
}

impl core::error::Error for SceneError {}

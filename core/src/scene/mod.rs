//! Scenes: a description in plain numbers, from a file or a program, and its conversion to columns.
//!
//! All units are SI: metres, kilograms, seconds, newtons; only `rotation` is in degrees. A term
//! that a scene does not name is not modelled: it is neither allocated nor computed.

mod bending;
mod build;
mod builtin;
mod check;
mod collider;
mod contact;
mod disc;
mod grid;
mod groups;
mod memory;
mod motion;
mod pins;
mod place;
mod prescribed;
mod resource;
mod schedule;
#[cfg(feature = "schema")]
mod schema;
mod select;
mod terms;
mod texture;
mod tube;
mod vector;
mod way;

use alloc::string::String;
use alloc::vec::Vec;

pub use build::{BuiltScene, ClothRange, build};
pub use builtin::BUILT_IN;
pub use collider::{ColliderDesc, ColliderMotionDesc, Shape};
pub use contact::{ContactDesc, FrictionDesc};
pub use disc::DiscDesc;
pub use grid::{GridDesc, Pattern};
pub use groups::{LoadDesc, MassDesc, Share, SpinDesc, StartDesc};
pub(crate) use memory::reserve;
pub use memory::{Memory, memory};
pub use resource::{Content, PointCache, Resource};
#[cfg(feature = "schema")]
pub use schema::schema;
pub use select::{LineDesc, PlaneDesc, SelectDesc, SheetSide};
pub use texture::{Texture, texture};
pub use tube::TubeDesc;
pub use vector::VectorDesc;

use crate::integrate::{Jacobian, Method, Preconditioner, Tolerance};
pub use crate::mesh::rest::RestSource;
use crate::real::Real;

/// A whole scene.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(title = "Scene"))]
pub struct SceneDesc {
    /// The name of the scene. For a scene without a name, a host that reads files uses the file's name.
    #[cfg_attr(feature = "serde", serde(default = "defaults::name"))]
    pub name: String,
    /// A description in one line.
    #[cfg_attr(feature = "serde", serde(default))]
    pub description: String,
    /// Simulated time, s.
    pub duration: f64,
    /// The speed, m/s: a run ends after a frame in which no vertex was as fast, once the
    /// scene schedules no further change. Absent: it lasts for the whole duration.
    pub until_rest: Option<f64>,
    /// Output frames per simulated second.
    #[cfg_attr(feature = "serde", serde(default = "defaults::frame_rate"))]
    pub frame_rate: f64,
    /// Gravity, m/s^2; absent: no gravity.
    pub gravity: Option<VectorDesc>,
    /// The sheets.
    pub cloth: Vec<ClothDesc>,
    /// Objects that the cloth collides with.
    #[cfg_attr(feature = "serde", serde(default))]
    pub collider: Vec<ColliderDesc>,
    /// Contact between surfaces; absent: surfaces pass through one another.
    pub contact: Option<ContactDesc>,
    /// The air; absent: no drag and no wind.
    pub drag: Option<DragDesc>,
    /// Time integration.
    #[cfg_attr(feature = "serde", serde(default))]
    pub integrator: IntegratorDesc,
}

/// The defaults of a scene file. Of the keys that a file must give, `duration` is 1 s, which matters only to a host that
/// runs a scene to its end, and there is no cloth.
impl Default for SceneDesc {
    fn default() -> Self {
        Self {
            name: defaults::name(),
            description: String::new(),
            duration: 1.0,
            until_rest: None,
            frame_rate: defaults::frame_rate(),
            gravity: None,
            cloth: Vec::new(),
            collider: Vec::new(),
            contact: None,
            drag: None,
            integrator: IntegratorDesc::default(),
        }
    }
}

/// One sheet: its mesh, its placement and its material.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ClothDesc {
    /// A rectangle. Exactly one of `grid`, `tube`, `disc` and `mesh` must be given.
    pub grid: Option<GridDesc>,
    /// An open cylinder.
    pub tube: Option<TubeDesc>,
    /// A disc, with or without a hole.
    pub disc: Option<DiscDesc>,
    /// The name of a mesh file that the host loads.
    pub mesh: Option<String>,
    /// The name of a file with the start positions, in the vertex order of the mesh.
    pub state: Option<String>,
    /// Source of the rest shape.
    #[cfg_attr(feature = "serde", serde(default = "defaults::rest"))]
    pub rest: RestSource,
    /// Size of one unit of the texture coordinates, m.
    #[cfg_attr(feature = "serde", serde(default = "defaults::one"))]
    pub uv_scale: f64,
    /// Offset, m, applied after scale and rotation.
    #[cfg_attr(feature = "serde", serde(default))]
    pub position: [f64; 3],
    /// Rotation about x, then y, then z, degrees.
    #[cfg_attr(feature = "serde", serde(default))]
    pub rotation: [f64; 3],
    /// Scale factor of the mesh. It does not apply to texture coordinates and start positions.
    #[cfg_attr(feature = "serde", serde(default = "defaults::one"))]
    pub scale: f64,
    /// Mass per rest area, kg/m^2.
    pub density: f64,
    /// Resistance to stretching; absent: not modelled.
    pub stretch: Option<StretchDesc>,
    /// Resistance to shearing, only for the membrane; absent: not modelled.
    pub shear: Option<ShearDesc>,
    /// Resistance to bending; absent: not modelled.
    pub bend: Option<BendDesc>,
    /// Pinned vertices.
    #[cfg_attr(feature = "serde", serde(default))]
    pub pin: Vec<PinDesc>,
    /// Sewn vertices.
    #[cfg_attr(feature = "serde", serde(default))]
    pub seam: Vec<SeamDesc>,
    /// Forces on some vertices.
    #[cfg_attr(feature = "serde", serde(default))]
    pub load: Vec<LoadDesc>,
    /// Masses on some vertices.
    #[cfg_attr(feature = "serde", serde(default))]
    pub mass: Vec<MassDesc>,
    /// Velocity at the start, m/s.
    #[cfg_attr(feature = "serde", serde(default))]
    pub velocity: [f64; 3],
    /// Rotation at the start, which adds to the velocity; absent: no rotation.
    pub spin: Option<SpinDesc>,
    /// Velocities of some vertices at the start.
    #[cfg_attr(feature = "serde", serde(default))]
    pub start: Vec<StartDesc>,
}

/// The defaults of a scene file, without a shape. `density`, which a file must give, is zero, and building such a scene
/// fails.
impl Default for ClothDesc {
    fn default() -> Self {
        Self {
            grid: None,
            tube: None,
            disc: None,
            mesh: None,
            state: None,
            rest: defaults::rest(),
            uv_scale: defaults::one(),
            position: [0.0; 3],
            rotation: [0.0; 3],
            scale: defaults::one(),
            density: 0.0,
            stretch: None,
            shear: None,
            bend: None,
            pin: Vec::new(),
            seam: Vec::new(),
            load: Vec::new(),
            mass: Vec::new(),
            velocity: [0.0; 3],
            spin: None,
            start: Vec::new(),
        }
    }
}

/// The in-plane model that resists stretching.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum StretchModel {
    /// Strain of each triangle along warp and weft [Baraff 1998].
    Membrane,
    /// Linear springs along the edges [Provot 1996].
    Spring,
}

/// Resistance to stretching.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StretchDesc {
    /// The model.
    pub model: StretchModel,
    /// Young's modulus times thickness, N/m.
    pub stiffness: f64,
    /// Stiffness along the weft, N/m, membrane only; absent: the same as along the warp.
    pub weft: Option<f64>,
    /// Stiffness-proportional damping, s.
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping: f64,
    /// Springs only: `stiffness` is the constant of every spring, N/m, whatever its length.
    #[cfg_attr(feature = "serde", serde(default))]
    pub per_spring: bool,
}

/// Resistance to shearing.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShearDesc {
    /// Shear modulus times thickness, N/m.
    pub stiffness: f64,
    /// Stiffness-proportional damping, s.
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping: f64,
}

/// The model that resists bending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum BendModel {
    /// Hinges: the angle between neighbouring triangles.
    Hinge,
    /// A spring between the unshared vertices of neighbouring triangles.
    Spring,
}

/// Resistance to bending.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BendDesc {
    /// The model.
    pub model: BendModel,
    /// Flexural rigidity, N m; hinge only.
    pub rigidity: Option<f64>,
    /// Constant of every spring, N/m; spring only.
    pub stiffness: Option<f64>,
    /// Stiffness-proportional damping, s.
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping: f64,
}

/// Vertices that are fixed in place or follow a prescribed motion.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PinDesc {
    /// The selected vertices.
    pub select: SelectDesc,
    /// The fixed axes: a combination of x, y and z.
    #[cfg_attr(feature = "serde", serde(default = "defaults::axes"))]
    pub axes: String,
    /// Motion; absent: the vertices rest.
    pub motion: Option<MotionDesc>,
    /// Time from which the pin holds its vertices, where they are then, s.
    #[cfg_attr(feature = "serde", serde(default))]
    pub from: f64,
    /// Time until which it holds them, s; absent: until the end.
    pub until: Option<f64>,
}

/// The defaults of a scene file: all axes are fixed all the time. It selects no vertices.
impl Default for PinDesc {
    fn default() -> Self {
        Self { select: SelectDesc::default(), axes: defaults::axes(), motion: None, from: 0.0, until: None }
    }
}

/// The motion of a pin or a collider: an offset by keys, and a rotation about the centre.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MotionDesc {
    /// Time, s, then offset, m. Linear between keys, constant before the first and after the last.
    #[cfg_attr(feature = "serde", serde(default))]
    pub keys: Vec<[f64; 4]>,
    /// Rotation; absent: no rotation.
    pub turn: Option<TurnDesc>,
}

/// A steady rotation about an axis through the centre of a pin's selection or of a collider.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TurnDesc {
    /// Direction of the axis.
    pub axis: [f64; 3],
    /// Angular velocity, rad/s.
    pub rate: f64,
    /// Time at which the rotation stops, s; absent: it never stops.
    pub until: Option<f64>,
}

/// Sewn vertices, joined by springs of zero length.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SeamDesc {
    /// The name of an OBJ file with `stitch` lines that the host loads.
    pub file: Option<String>,
    /// Pairs of vertices that are sewn together.
    #[cfg_attr(feature = "serde", serde(default))]
    pub pairs: Vec<[u32; 2]>,
    /// Stiffness of each stitch, N/m.
    pub stiffness: f64,
    /// Stiffness-proportional damping, s.
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping: f64,
}

/// The air around the cloth.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DragDesc {
    /// Linear drag, N s/m^3: force against the velocity, per velocity and rest area. The area of a sheet counts once:
    /// the coefficient is that of both sides together.
    #[cfg_attr(feature = "serde", serde(default))]
    pub linear: f64,
    /// Wind on the triangles; absent: no wind.
    pub wind: Option<WindDesc>,
}

/// Wind. Its force on a triangle depends on how the triangle faces it.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WindDesc {
    /// Velocity of the air, m/s.
    pub velocity: VectorDesc,
    /// Coefficient along the normal, N s/m^3: force per relative velocity and area, which counts once as that of drag.
    pub normal: f64,
    /// Coefficient in the plane of the triangle, N s/m^3.
    #[cfg_attr(feature = "serde", serde(default))]
    pub tangential: f64,
}

/// Time integration.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IntegratorDesc {
    /// The method.
    pub method: Method,
    /// The longest time step, s. Absent: 1/60 s with a largest error, else 0.005 s.
    pub step: Option<f64>,
    /// The largest error of a step, m, for implicit methods: steps get shorter where their estimated error is larger.
    /// Zero, or absent beside a `step`: every step has the same length. Absent without a `step`: 0.001 m.
    pub error: Option<f64>,
    /// Maximum number of Newton iterations per step, with line search; 1: one linear solve without it.
    pub newton: u32,
    /// Relative residual at which conjugate gradients and Newton's method stop. Absent: 1e-4, or with a largest error
    /// as small as it needs.
    pub tolerance: Option<f64>,
    /// Preconditioner of the conjugate gradients.
    pub preconditioner: Preconditioner,
    /// The Jacobian that implicit methods use.
    pub jacobian: Jacobian,
}

impl Default for IntegratorDesc {
    fn default() -> Self {
        Self {
            method: Method::BackwardEuler,
            step: None,
            error: None,
            newton: 1,
            tolerance: None,
            preconditioner: Preconditioner::TwoLevel,
            jacobian: Jacobian::Projected,
        }
    }
}

/// The largest error of a step where a scene gives neither an error nor a step, m.
const ERROR: f64 = 1e-3;

/// The longest step with a largest error, s.
const LONGEST_STEP: f64 = 1.0 / 60.0;

/// The step of methods without error control, s.
const FIXED_STEP: f64 = 0.005;

/// The relative residual without a largest error.
const RESIDUAL: f64 = 1e-4;

impl IntegratorDesc {
    /// The largest error of a step, m; `None`: all steps have the same length.
    pub fn error(&self) -> Option<f64> {
        let error = self.error.unwrap_or(if self.step.is_none() { ERROR } else { 0.0 });
        Some(error).filter(|&error| error > 0.0 && self.method.is_implicit())
    }

    /// The longest step, s.
    pub fn step(&self) -> f64 {
        self.step.unwrap_or(if self.error().is_some() { LONGEST_STEP } else { FIXED_STEP })
    }

    /// The relative residual at which solves stop without a largest error.
    pub fn residual(&self) -> f64 {
        self.tolerance.unwrap_or(RESIDUAL)
    }

    /// Where solves stop.
    pub fn tolerance(&self) -> Tolerance {
        match (self.tolerance, self.error()) {
            (None, Some(error)) => Tolerance::within(error as Real),
            _ => Tolerance::Residual(self.residual() as Real),
        }
    }
}

mod defaults {
    use super::RestSource;

    pub fn name() -> super::String {
        "untitled".into()
    }
    pub fn frame_rate() -> f64 {
        30.0
    }
    pub fn one() -> f64 {
        1.0
    }
    pub fn rest() -> RestSource {
        RestSource::Shape
    }
    pub fn axes() -> super::String {
        "xyz".into()
    }
}

/// By how much a step may differ from an equal part of a frame that is taken in its place, relative to that part.
const SAME_STEP: f64 = 1e-3;

/// Division of a scene's duration into frames and steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Number of output frames, not counting the first, which shows time 0.
    pub frames: u64,
    /// Number of steps from one frame to the next.
    pub steps_per_frame: u64,
    /// Time step, s; at most 0.1 % longer than the step that the scene gives.
    pub step: f64,
    /// The speed, m/s: the run ends after a frame in which no vertex was as fast.
    pub until_rest: Option<f64>,
}

impl SceneDesc {
    /// Divides the duration into whole frames and each frame into whole steps, rounding up. A step that a scene gives in
    /// rounded digits divides the frame.
    pub fn timing(&self) -> Timing {
        // A small tolerance: 3 s at 30 frames per second give 90 frames, whatever the rounding.
        let whole = |ratio: f64| libm::ceil(ratio - 1e-9);
        let frame = 1.0 / self.frame_rate;
        let steps = frame / self.integrator.step();
        let nearest = libm::round(steps);
        let divides = libm::fabs(steps - nearest) <= SAME_STEP * nearest;
        let steps_per_frame = if divides { nearest } else { libm::ceil(steps) }.max(1.0);
        Timing {
            frames: whole(self.duration * self.frame_rate) as u64,
            steps_per_frame: steps_per_frame as u64,
            step: frame / steps_per_frame,
            until_rest: self.until_rest,
        }
    }
}

//! A scene in plain numbers, as files and programs describe it, and its way into columns.
//!
//! Everything is SI: metres, kilograms, seconds, newtons; only `rotation` is in degrees. A term
//! that a scene does not name is not modelled: not allocated, not computed.

mod build;
mod builtin;
mod check;
mod collider;
mod contact;
mod disc;
mod grid;
mod motion;
mod pins;
mod place;
mod resource;
mod select;
mod terms;
mod tube;

use alloc::string::String;
use alloc::vec::Vec;

pub use build::{BuiltScene, ClothRange, build};
pub use builtin::BUILT_IN;
pub use collider::{ColliderDesc, ColliderMotionDesc, Shape};
pub use contact::{ContactDesc, FrictionDesc};
pub use disc::DiscDesc;
pub use grid::{GridDesc, Pattern};
pub use resource::{Content, PointCache, Resource};
pub use select::{SelectDesc, SheetSide};
pub use tube::TubeDesc;

use crate::integrate::{Jacobian, Method, Preconditioner};
use crate::mesh::rest::RestSource;

/// A whole scene.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct SceneDesc {
    /// The name of the scene. A host that reads files gives a scene without a name that of its file.
    #[cfg_attr(feature = "serde", serde(default = "defaults::name"))]
    pub name: String,
    /// A line about it.
    #[cfg_attr(feature = "serde", serde(default))]
    pub description: String,
    /// Simulated time, s.
    pub duration: f64,
    /// Output frames per simulated second.
    #[cfg_attr(feature = "serde", serde(default = "defaults::frame_rate"))]
    pub frame_rate: f64,
    /// m/s^2; absent: none.
    pub gravity: Option<[f64; 3]>,
    /// The sheets.
    pub cloth: Vec<ClothDesc>,
    /// What the cloth can touch besides itself.
    #[cfg_attr(feature = "serde", serde(default))]
    pub collider: Vec<ColliderDesc>,
    /// How surfaces touch; absent: nothing touches anything.
    pub contact: Option<ContactDesc>,
    /// Air; absent: none.
    pub drag: Option<DragDesc>,
    /// How time is advanced.
    #[cfg_attr(feature = "serde", serde(default))]
    pub integrator: IntegratorDesc,
}

/// One sheet: its mesh, its place and its material.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct ClothDesc {
    /// A rectangle; or one of the next three.
    pub grid: Option<GridDesc>,
    /// An open cylinder.
    pub tube: Option<TubeDesc>,
    /// A disc, with or without a hole.
    pub disc: Option<DiscDesc>,
    /// The name of a mesh file that the host loads.
    pub mesh: Option<String>,
    /// The name of a file with start positions, in the mesh's vertex order.
    pub state: Option<String>,
    /// Where the undeformed shape comes from.
    #[cfg_attr(feature = "serde", serde(default = "defaults::rest", with = "RestName"))]
    pub rest: RestSource,
    /// Metres per unit of the texture coordinates.
    #[cfg_attr(feature = "serde", serde(default = "defaults::one"))]
    pub uv_scale: f64,
    /// Offset, m; after scale and rotation.
    #[cfg_attr(feature = "serde", serde(default))]
    pub position: [f64; 3],
    /// Degrees about x, then y, then z.
    #[cfg_attr(feature = "serde", serde(default))]
    pub rotation: [f64; 3],
    /// Size factor of the mesh as it stands.
    #[cfg_attr(feature = "serde", serde(default = "defaults::one"))]
    pub scale: f64,
    /// kg/m^2.
    pub density: f64,
    /// Resistance to stretching; absent: not modelled.
    pub stretch: Option<StretchDesc>,
    /// Resistance to shearing, of the membrane only; absent: not modelled.
    pub shear: Option<ShearDesc>,
    /// Resistance to bending; absent: not modelled.
    pub bend: Option<BendDesc>,
    /// Held vertices.
    #[cfg_attr(feature = "serde", serde(default))]
    pub pin: Vec<PinDesc>,
    /// Sewn vertices.
    #[cfg_attr(feature = "serde", serde(default))]
    pub seam: Vec<SeamDesc>,
}

/// Which in-plane model resists stretching.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum StretchModel {
    /// Warp and weft of each triangle [Baraff 1998].
    Membrane,
    /// Linear springs along the edges [Provot 1996].
    Spring,
}

/// Resistance to stretching.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct StretchDesc {
    /// The model.
    pub model: StretchModel,
    /// N/m, Young's modulus times thickness.
    pub stiffness: f64,
    /// N/m along the weft, membrane only; absent: as along the warp.
    pub weft: Option<f64>,
    /// s, stiffness-proportional.
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping: f64,
    /// Springs only: `stiffness` is each spring's own constant.
    #[cfg_attr(feature = "serde", serde(default))]
    pub per_spring: bool,
}

/// Resistance to shearing.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct ShearDesc {
    /// N/m, shear modulus times thickness.
    pub stiffness: f64,
    /// s, stiffness-proportional.
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping: f64,
}

/// Which model resists bending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum BendModel {
    /// The angle between neighbouring triangles.
    Hinge,
    /// A spring between their unshared vertices.
    Spring,
}

/// Resistance to bending.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct BendDesc {
    /// The model.
    pub model: BendModel,
    /// N m, flexural rigidity; hinge only.
    pub rigidity: Option<f64>,
    /// N/m, each spring's constant; spring only.
    pub stiffness: Option<f64>,
    /// s, stiffness-proportional.
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping: f64,
}

/// Vertices held in place or led along a motion.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct PinDesc {
    /// Which vertices.
    pub select: SelectDesc,
    /// Which axes are held: a combination of x, y and z.
    #[cfg_attr(feature = "serde", serde(default = "defaults::axes"))]
    pub axes: String,
    /// How they move; absent: not at all.
    pub motion: Option<MotionDesc>,
}

/// The motion of a pin: an offset through keys, and a turn about the selection's centre.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct MotionDesc {
    /// Time s, then offset m; linear between keys, resting before the first and after the last.
    #[cfg_attr(feature = "serde", serde(default))]
    pub keys: Vec<[f64; 4]>,
    /// Absent: no turn.
    pub turn: Option<TurnDesc>,
}

/// A steady turn about an axis through the centre of the selection.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct TurnDesc {
    /// Direction of the axis.
    pub axis: [f64; 3],
    /// rad/s.
    pub rate: f64,
    /// s; the turn stops then. Absent: never.
    pub until: Option<f64>,
}

/// Sewn vertices, held together by zero-length springs.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct SeamDesc {
    /// The name of an OBJ file with `stitch` lines that the host loads.
    pub file: Option<String>,
    /// Sewn vertex pairs.
    #[cfg_attr(feature = "serde", serde(default))]
    pub pairs: Vec<[u32; 2]>,
    /// N/m of each stitch.
    pub stiffness: f64,
    /// s, stiffness-proportional.
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping: f64,
}

/// The air around the cloth.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct DragDesc {
    /// N s/m^3: force per velocity and rest area, against the velocity.
    #[cfg_attr(feature = "serde", serde(default))]
    pub linear: f64,
    /// Wind on the triangles; absent: none.
    pub wind: Option<WindDesc>,
}

/// A steady wind that presses on triangles by how they face it.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct WindDesc {
    /// m/s.
    pub velocity: [f64; 3],
    /// N s/m^3: force per relative velocity and area along the normal.
    pub normal: f64,
    /// N s/m^3: the same in the triangle's plane.
    #[cfg_attr(feature = "serde", serde(default))]
    pub tangential: f64,
}

/// How time is advanced.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct IntegratorDesc {
    /// The method.
    pub method: Method,
    /// The largest time step, s.
    pub step: f64,
    /// Newton iterations per step; 1: one linear solve, with line search when more.
    pub newton: u32,
    /// Relative residual at which conjugate gradients stop, and Newton's iterations.
    pub tolerance: f64,
    /// What conjugate gradients are preconditioned with.
    pub preconditioner: Preconditioner,
    /// Which Jacobian implicit methods use.
    pub jacobian: Jacobian,
}

impl Default for IntegratorDesc {
    fn default() -> Self {
        Self {
            method: Method::BackwardEuler,
            step: 0.005,
            newton: 1,
            tolerance: 1e-4,
            preconditioner: Preconditioner::TwoLevel,
            jacobian: Jacobian::Projected,
        }
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(remote = "RestSource", rename_all = "lowercase")]
enum RestName {
    Shape,
    Uv,
}

#[cfg(feature = "serde")]
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

/// How a scene's time is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Output frames after the first, which shows time 0.
    pub frames: u64,
    /// Steps from frame to frame.
    pub steps_per_frame: u64,
    /// s; not larger than the scene's.
    pub step: f64,
}

impl SceneDesc {
    /// Cuts the duration into whole frames and frames into whole steps, rounding up.
    pub fn timing(&self) -> Timing {
        // A hair of slack: 3 s at 30 frames per second are 90 frames whatever the rounding.
        let whole = |ratio: f64| libm::ceil(ratio - 1e-9);
        let frame = 1.0 / self.frame_rate;
        let steps_per_frame = whole(frame / self.integrator.step).max(1.0);
        Timing {
            frames: whole(self.duration * self.frame_rate) as u64,
            steps_per_frame: steps_per_frame as u64,
            step: frame / steps_per_frame,
        }
    }
}

//! Reads the colliders of a scene.

use alloc::string::String;
use alloc::vec::Vec;

use glam::DVec3;

use super::check::{finite, positive};
use super::motion::read_motion;
use super::place::turn;
use super::{FrictionDesc, MotionDesc, Resource, resource};
use crate::colliders::{Body, Cache, ColliderColumns, Drive, Form, cuboid, round};
use crate::error::{ColliderMotionError, SceneError};
use crate::real::{Real, Vec3, vec3};

/// The shape of a collider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Shape {
    /// The half space below `point`; `normal` points up.
    Plane,
    /// A ball.
    Sphere,
    /// All points within a radius of the segment from `a` to `b`.
    Capsule,
    /// A box.
    Box,
    /// Triangles from a file.
    Mesh,
}

impl Shape {
    /// The name that scene files use.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::Sphere => "sphere",
            Self::Capsule => "capsule",
            Self::Box => "box",
            Self::Mesh => "mesh",
        }
    }
}

/// A collider: its shape, and the keys that the shape needs.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ColliderDesc {
    /// The shape.
    pub shape: Shape,
    /// Plane: a point on it, m.
    pub point: Option<[f64; 3]>,
    /// Plane: a vector that points to the free side.
    pub normal: Option<[f64; 3]>,
    /// Sphere and box: the centre, m.
    pub center: Option<[f64; 3]>,
    /// Sphere and capsule: the radius, m.
    pub radius: Option<f64>,
    /// Capsule: one end of its axis, m.
    pub a: Option<[f64; 3]>,
    /// Capsule: the other end, m.
    pub b: Option<[f64; 3]>,
    /// Box: half of its size along each axis, m.
    pub half: Option<[f64; 3]>,
    /// Box: rotation about x, then y, then z, degrees.
    pub rotation: Option<[f64; 3]>,
    /// Mesh: the name of a file that the host loads.
    pub file: Option<String>,
    /// Motion; absent: the collider rests.
    pub motion: Option<ColliderMotionDesc>,
    /// Mesh that moves by a point cache: frames per second.
    pub motion_rate: Option<f64>,
    /// Friction; absent: the friction of `contact`.
    pub friction: Option<FrictionDesc>,
}

impl ColliderDesc {
    /// A collider that rests. Give it the keys of its shape.
    pub fn of(shape: Shape) -> Self {
        Self {
            shape,
            point: None,
            normal: None,
            center: None,
            radius: None,
            a: None,
            b: None,
            half: None,
            rotation: None,
            file: None,
            motion: None,
            motion_rate: None,
            friction: None,
        }
    }
}

/// The motion of a collider.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(untagged))]
pub enum ColliderMotionDesc {
    /// Mesh: the name of a point cache that the host loads.
    Cache(String),
    /// Keys, and a rotation about the collider's centre.
    Keys(MotionDesc),
}

/// By hand, so that errors name the key that is wrong.
#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for ColliderMotionDesc {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        use serde::de::value::MapAccessDeserializer;

        struct Visitor;

        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = ColliderMotionDesc;

            fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str("the name of a point cache, or { keys = [[time, x, y, z], ..], turn = {..} }")
            }

            fn visit_str<E>(self, name: &str) -> Result<ColliderMotionDesc, E> {
                Ok(ColliderMotionDesc::Cache(name.into()))
            }

            fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<ColliderMotionDesc, A::Error> {
                serde::Deserialize::deserialize(MapAccessDeserializer::new(map)).map(ColliderMotionDesc::Keys)
            }
        }

        deserializer.deserialize_any(Visitor)
    }
}

/// Reads the keys of one collider and checks that they fit its shape.
struct Keys<'a> {
    desc: &'a ColliderDesc,
    index: u32,
    /// The point from which the columns measure positions, m.
    origin: DVec3,
}

impl Keys<'_> {
    fn needed<T: Clone>(&self, key: &'static str, value: &Option<T>) -> Result<T, SceneError> {
        value.clone().ok_or(SceneError::ShapeNeeds { collider: self.index, key, shape: self.desc.shape.name() })
    }

    /// A finite vector.
    fn vector(&self, key: &'static str, value: &Option<[f64; 3]>) -> Result<DVec3, SceneError> {
        let vector = self.needed(key, value)?;
        finite(key, &vector)?;
        Ok(vector.into())
    }

    /// A point, from the origin of the columns.
    fn point(&self, key: &'static str, value: &Option<[f64; 3]>) -> Result<DVec3, SceneError> {
        Ok(self.vector(key, value)? - self.origin)
    }

    /// Error if a key is given that is not in `own`, the keys of the shape.
    fn only(&self, own: &[&str]) -> Result<(), SceneError> {
        let d = self.desc;
        let given = [
            ("point", d.point.is_some()),
            ("normal", d.normal.is_some()),
            ("center", d.center.is_some()),
            ("radius", d.radius.is_some()),
            ("a", d.a.is_some()),
            ("b", d.b.is_some()),
            ("half", d.half.is_some()),
            ("rotation", d.rotation.is_some()),
            ("file", d.file.is_some()),
            ("motion_rate", d.motion_rate.is_some()),
        ];
        match given.iter().find(|(key, given)| *given && !own.contains(key)) {
            Some(&(key, _)) => Err(SceneError::NotOfShape { collider: self.index, key, shape: d.shape.name() }),
            None => Ok(()),
        }
    }
}

/// Adds a collider. `law` is the index of its law of friction, `origin` the point from which the columns measure
/// positions, m.
pub(super) fn add(
    columns: &mut ColliderColumns,
    desc: &ColliderDesc,
    index: u32,
    law: u32,
    origin: DVec3,
    resources: &[Resource],
) -> Result<(), SceneError> {
    let keys = Keys { desc, index, origin };
    let rounded = |point: DVec3| vec3(point.into());
    let body = |form| Body::new(form, Drive::Rest, 0.0, law);
    let round = |form, radius| Body::new(form, Drive::Rest, radius, law);
    let radius = || positive("collider.radius", keys.needed("radius", &desc.radius)?).map(|r| r as Real);
    let (body, centre, anchors, triangles): (Body, DVec3, Vec<Vec3>, Vec<[u32; 3]>) = match desc.shape {
        Shape::Plane => {
            keys.only(&["point", "normal"])?;
            let (point, normal) = (keys.point("point", &desc.point)?, keys.vector("normal", &desc.normal)?);
            let normal = normal.try_normalize().ok_or(SceneError::NoNormal { collider: index })?;
            // The point of the plane nearest to a far cloth, because a far one would have few digits.
            let point = if origin == DVec3::ZERO { point } else { normal * normal.dot(point) };
            (body(Form::Plane(rounded(normal))), point, [rounded(point)].into(), Vec::new())
        }
        Shape::Sphere => {
            keys.only(&["center", "radius"])?;
            let centre = keys.point("center", &desc.center)?;
            let body = round(Form::Sphere, radius()?);
            (body, centre, [rounded(centre)].into(), round::SPHERE.into())
        }
        Shape::Capsule => {
            keys.only(&["a", "b", "radius"])?;
            let (a, b) = (keys.point("a", &desc.a)?, keys.point("b", &desc.b)?);
            let body = round(Form::Capsule, radius()?);
            (body, (a + b) / 2.0, [rounded(a), rounded(b)].into(), round::CAPSULE.into())
        }
        Shape::Box => {
            keys.only(&["center", "half", "rotation"])?;
            let (centre, half) = (keys.point("center", &desc.center)?, keys.vector("half", &desc.half)?);
            for half in half.to_array() {
                positive("collider.half", half)?;
            }
            finite("collider.rotation", &desc.rotation.unwrap_or_default())?;
            let axes = turn(desc.rotation.unwrap_or_default());
            let axes = [0, 1, 2].map(|k| rounded(axes.col(k) * half[k]));
            (body(Form::Box), centre, cuboid::corners(rounded(centre), axes).into(), cuboid::TRIANGLES.into())
        }
        Shape::Mesh => {
            keys.only(&["file", "motion_rate"])?;
            let name = keys.needed("file", &desc.file)?;
            let mesh = resource::mesh(&name, resources).ok_or(SceneError::MissingColliderFile { collider: index })?;
            mesh.check_surface().map_err(|error| SceneError::ColliderMesh { collider: index, error })?;
            let anchors: Vec<_> = mesh.positions.iter().map(|&p| rounded(DVec3::from(p) - origin)).collect();
            let centre = mesh.positions.iter().map(|&p| DVec3::from(p)).sum::<DVec3>() / anchors.len() as f64 - origin;
            (body(Form::Mesh), centre, anchors, mesh.triangles.clone())
        }
    };
    let drive = drive(columns, &keys, centre, anchors.len(), resources)?;
    let mut body = body;
    body.set_drive(drive);
    columns.add(body, &anchors, &triangles);
    Ok(())
}

fn drive(
    columns: &mut ColliderColumns,
    keys: &Keys<'_>,
    centre: DVec3,
    vertices: usize,
    resources: &[Resource],
) -> Result<Drive, SceneError> {
    let (desc, index) = (keys.desc, keys.index);
    match &desc.motion {
        None => Ok(Drive::Rest),
        Some(ColliderMotionDesc::Keys(motion)) => {
            let read = match desc.shape == Shape::Plane && motion.turn.is_some() {
                true => Err(ColliderMotionError::Plane),
                false => read_motion(motion, centre, &mut columns.keys).map_err(ColliderMotionError::from),
            };
            read.map(Drive::Motion).map_err(|error| SceneError::ColliderMotion { collider: index, error })
        }
        Some(ColliderMotionDesc::Cache(name)) => {
            if desc.shape != Shape::Mesh {
                return Err(SceneError::NotOfShape { collider: index, key: "motion", shape: desc.shape.name() });
            }
            let rate = positive("collider.motion_rate", keys.needed("motion_rate", &desc.motion_rate)?)?;
            let cache = resource::cache(name, resources).ok_or(SceneError::MissingColliderFile { collider: index })?;
            let (found, expected) = (cache.points, vertices as u32);
            if found != expected || cache.frames() == 0 {
                return Err(SceneError::CachePoints { collider: index, expected, found });
            }
            let first = columns.frames.len() as u32;
            let from_origin = |p: &[f32; 3]| vec3((DVec3::from(p.map(f64::from)) - keys.origin).into());
            columns.frames.extend(cache.positions.iter().map(from_origin));
            if columns.frames[first as usize..].iter().any(|x| !x.is_finite()) {
                return Err(SceneError::ColliderMotion { collider: index, error: ColliderMotionError::Cache });
            }
            Ok(Drive::Cache(Cache { first, frames: cache.frames() as u32, rate, start: 0.0 }))
        }
    }
}

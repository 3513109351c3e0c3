//! Rigid bodies of rapier, and the same shapes as colliders of a scene of Muslin.

use std::fmt::Write as _;

use glam::{DQuat, DVec3};
use muslin_core::kinematic::Pose;
use rapier3d::prelude::{
    Collider, ColliderBuilder, PhysicsWorld, RigidBody, RigidBodyBuilder, RigidBodyHandle, Vector,
};

/// A shape, with sizes in m.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// Radius.
    Ball(f32),
    /// Half of its size along each axis.
    Cuboid([f32; 3]),
    /// Half length of its axis along y, and radius.
    Capsule(f32, f32),
}

/// A body: shape, mass, kg, place, m, and velocity, m/s.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    pub shape: Shape,
    pub mass: f32,
    pub place: [f32; 3],
    pub velocity: [f32; 3],
    /// rad/s.
    pub spin: [f32; 3],
}

impl Body {
    /// Adds the body to a world of rapier.
    pub fn add_to(&self, world: &mut PhysicsWorld) -> RigidBodyHandle {
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::from_array(self.place))
            .linvel(Vector::from_array(self.velocity))
            .angvel(Vector::from_array(self.spin))
            .can_sleep(false);
        let (handle, _) = world.insert(body, self.collider());
        handle
    }

    fn collider(&self) -> Collider {
        let shape = match self.shape {
            Shape::Ball(radius) => ColliderBuilder::ball(radius),
            Shape::Cuboid([x, y, z]) => ColliderBuilder::cuboid(x, y, z),
            Shape::Capsule(half, radius) => ColliderBuilder::capsule_y(half, radius),
        };
        shape.mass(self.mass).friction(0.4).build()
    }

    /// Adds the body to a scene of Muslin, in the pose of the world's body.
    pub fn describe(&self, pose: &Pose, scene: &mut String) {
        let at = |point: [f32; 3]| pose.place(DVec3::from(point.map(f64::from))).to_array();
        let written = match self.shape {
            Shape::Ball(radius) => {
                writeln!(scene, "[[collider]]\nshape = \"sphere\"\ncenter = {:?}\nradius = {radius:?}", at([0.0; 3]))
            }
            Shape::Cuboid(half) => {
                let (z, y, x) = pose.rotation.to_euler(glam::EulerRot::ZYX);
                let degrees = [x, y, z].map(f64::to_degrees);
                let centre = at([0.0; 3]);
                writeln!(
                    scene,
                    "[[collider]]\nshape = \"box\"\ncenter = {centre:?}\nhalf = {half:?}\nrotation = {degrees:?}"
                )
            }
            Shape::Capsule(half, radius) => {
                let [a, b] = [at([0.0, -half, 0.0]), at([0.0, half, 0.0])];
                writeln!(scene, "[[collider]]\nshape = \"capsule\"\na = {a:?}\nb = {b:?}\nradius = {radius:?}")
            }
        };
        written.expect("a string takes all text");
    }
}

/// The pose of a body of rapier.
pub fn pose(body: &RigidBody) -> Pose {
    let (place, rotation) = (body.position().translation, body.position().rotation);
    let [x, y, z, w] = rotation.to_array().map(f64::from);
    Pose { position: DVec3::from(place.to_array().map(f64::from)), rotation: DQuat::from_xyzw(x, y, z, w).normalize() }
}

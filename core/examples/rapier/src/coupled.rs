//! A world of rapier and a cloth of Muslin that take their steps in turn.

use glam::DVec3;
use muslin_core::kinematic::Pose;
use muslin_core::live::Live as _;
use muslin_core::scene::SceneDesc;
use muslin_core::simulation::Simulation;
use rapier3d::prelude::{PhysicsWorld, RigidBodyHandle, Vector};
use rapier3d::utils::AngularInertiaOps;

use crate::bodies::{Body, pose};

/// Steps in a second.
pub const STEPS: u32 = 240;

/// Bodies and cloth.
pub struct Coupled {
    pub world: PhysicsWorld,
    pub bodies: Vec<(Body, RigidBodyHandle)>,
    pub cloth: Simulation,
}

impl Coupled {
    /// A world with these bodies, and the cloth of a scene without their colliders. The scene may have other colliders
    /// of its own, which come first.
    pub fn new(mut world: PhysicsWorld, bodies: &[Body], scene: &str) -> Self {
        world.integration_parameters.dt = 1.0 / STEPS as f32;
        let bodies: Vec<_> = bodies.iter().map(|body| (*body, body.add_to(&mut world))).collect();
        let mut text = scene.to_owned();
        for (body, _) in &bodies {
            body.describe(&Pose::at(body.place.map(f64::from)), &mut text);
        }
        let desc: SceneDesc = toml::from_str(&text).unwrap_or_else(|error| panic!("{error}: in\n{text}"));
        let mut cloth = Simulation::new(&desc, &[]).unwrap_or_else(|error| panic!("{error}: in\n{text}"));
        cloth.measure_reactions();
        Self { world, bodies, cloth }
    }

    /// A step of both: bodies move, the cloth moves around them, and the bodies take the impulses of the cloth.
    pub fn step(&mut self) {
        self.world.step();
        let step = f64::from(self.cloth.step_length());
        let first = self.cloth.colliders().bodies.len() - self.bodies.len();
        for (number, (_, handle)) in self.bodies.iter().enumerate() {
            let to = pose(&self.world.bodies[*handle]);
            self.cloth.move_collider((first + number) as u32, to, step).expect("poses are finite");
        }
        self.cloth.take_step().unwrap_or_else(|failed| panic!("{failed}"));
        for (number, (_, handle)) in self.bodies.iter().enumerate() {
            let impulse = self.cloth.take_impulse((first + number) as u32).expect("it is measured");
            let [linear, angular] = [impulse.linear, impulse.angular].map(vector);
            let body = &mut self.world.bodies[*handle];
            body.apply_impulse(linear, true);
            body.apply_torque_impulse(angular, true);
        }
    }

    /// Linear and angular momentum of bodies and cloth, kg m/s and kg m^2/s.
    pub fn momentum(&self) -> [DVec3; 2] {
        let mut sum = [DVec3::from(self.cloth.momentum()), DVec3::from(self.cloth.angular_momentum())];
        for (_, handle) in &self.bodies {
            let body = &self.world.bodies[*handle];
            let linear = wide(body.linvel()) * f64::from(body.mass());
            let spin = body.mass_properties().effective_world_inv_inertia.inverse() * body.angvel();
            sum[0] += linear;
            sum[1] += wide(body.center_of_mass()).cross(linear) + wide(spin);
        }
        sum
    }
}

fn vector(v: DVec3) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

fn wide(v: Vector) -> DVec3 {
    DVec3::from(v.to_array().map(f64::from))
}

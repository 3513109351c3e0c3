//! The live interface: a page changes and reads colliders, pins, forces, contacts and rays between steps.
//!
//! All of it goes through one call with a list of numbers, because every exported function costs about half a kilobyte of
//! the compressed package. `cloth.ts` checks the numbers and gives the calls their names and types.

use glam::{DQuat, DVec3};
use muslin_core::diagnostics::StateHash;
use muslin_core::error::LiveError;
use muslin_core::kinematic::Pose;
use muslin_core::live::{Live as _, Side, Touch};
use muslin_core::scene::VectorDesc;
use muslin_core::simulation::Snapshot;
use wasm_bindgen::prelude::{JsError, JsValue, wasm_bindgen};

use crate::simulation::{Simulation, error};

/// A call. Its numbers are those that it takes, in this order, and those that it returns.
#[wasm_bindgen]
#[derive(Clone, Copy)]
pub enum Call {
    /// Collider, pose of seven numbers, seconds.
    MoveCollider,
    /// Collider. Returns a pose.
    ColliderPose,
    /// Collider, seconds, coordinates of all vertices.
    DeformCollider,
    /// Collider.
    SwitchOff,
    /// Collider.
    SwitchOn,
    /// No numbers.
    MeasureImpulses,
    /// Collider. Returns the impulse and its moment.
    TakeImpulse,
    /// Vertex, place, seconds.
    MoveTo,
    /// Vertex, collider.
    Attach,
    /// Vertex. Returns 1 if it was held, else 0.
    Release,
    /// Vertex, impulse.
    Push,
    /// Vertex, force.
    SetForce,
    /// Acceleration.
    SetGravity,
    /// Velocity.
    SetWind,
    /// Pose, colliders.
    Teleport,
    /// No numbers. Returns 21 for each contact: the kind (0 cloth, 1 collider) and number of both sides, the vertices, their
    /// weights, the position, the normal and the force.
    Touches,
    /// Triangle, weights. Returns the position, the velocity and the normal.
    Point,
    /// Origin, direction. Returns the triangle, its weights and the distance, or nothing.
    Hit,
}

#[wasm_bindgen]
impl Simulation {
    /// Makes a call.
    #[cfg_attr(small, optimize(size))]
    pub fn call(&mut self, call: Call, given: &[f64]) -> Result<Vec<f64>, JsError> {
        self.answer(call, given).map_err(error)
    }

    /// A copy of all that steps and the host change.
    pub fn snapshot(&self) -> Saved {
        Saved { state: self.own.snapshot(), chain: self.chain }
    }

    /// Goes back to a copy and to the scene of its time. The observation of warnings begins anew.
    #[wasm_bindgen(js_name = goBack)]
    pub fn go_back(&mut self, to: &Saved, scene: JsValue) -> Result<(), JsError> {
        let scene = muslin_wasm_scene::read(scene).map_err(error)?;
        self.own.go_back(&to.state).map_err(error)?;
        (self.scene, self.chain) = (scene, to.chain);
        self.observe();
        Ok(())
    }
}

/// A copy of the state.
#[wasm_bindgen]
pub struct Saved {
    state: Snapshot,
    chain: StateHash,
}

impl Simulation {
    #[cfg_attr(small, optimize(size))]
    fn answer(&mut self, call: Call, given: &[f64]) -> Result<Vec<f64>, LiveError> {
        let own = &mut self.own;
        let whole = |at: usize| index(number(given, at));
        let first = whole(0);
        match call {
            Call::MoveCollider => own.move_collider(first, pose(given, 1), number(given, 8))?,
            Call::ColliderPose => {
                let Pose { position, rotation } = own.collider_pose(first)?;
                return Ok([&position.to_array()[..], &rotation.to_array()].concat());
            }
            Call::DeformCollider => {
                let (places, _) = given.get(2..).unwrap_or_default().as_chunks();
                own.deform_collider(first, places, number(given, 1))?;
            }
            Call::SwitchOff => own.switch_off(first)?,
            Call::SwitchOn => own.switch_on(first)?,
            Call::MeasureImpulses => own.measure_reactions(),
            Call::TakeImpulse => {
                let impulse = own.take_impulse(first)?;
                return Ok([impulse.linear.to_array(), impulse.angular.to_array()].concat());
            }
            Call::MoveTo => own.move_to(first, vector(given, 1), number(given, 4))?,
            Call::Attach => own.attach(first, whole(1))?,
            Call::Release => return Ok(vec![f64::from(u8::from(own.release(first)))]),
            Call::Push => own.push(first, vector(given, 1))?,
            Call::SetForce => own.set_force(first, vector(given, 1))?,
            Call::SetGravity => {
                own.set_gravity(vector(given, 0))?;
                self.scene.gravity = Some(VectorDesc::Constant(vector(given, 0)));
            }
            Call::SetWind => {
                own.set_wind(vector(given, 0))?;
                if let Some(wind) = self.scene.drag.as_mut().and_then(|drag| drag.wind.as_mut()) {
                    wind.velocity = VectorDesc::Constant(vector(given, 0));
                }
            }
            Call::Teleport => {
                let colliders: Vec<_> = given.iter().skip(7).copied().map(index).collect();
                own.teleport(pose(given, 0), &colliders)?;
            }
            Call::Touches => return Ok(own.touches().flat_map(|touch| numbers(&touch)).collect()),
            Call::Point => {
                let point = own.point(first, vector(given, 1))?;
                return Ok([point.position, point.velocity, point.normal].concat());
            }
            Call::Hit => {
                let hit = own.hit(vector(given, 0), vector(given, 3))?;
                let all = hit.map(|hit| [&[f64::from(hit.triangle)][..], &hit.weights, &[hit.distance]].concat());
                return Ok(all.unwrap_or_default());
            }
        }
        Ok(Vec::new())
    }
}

/// A number of the host. One that is missing is refused as one that is not finite.
fn number(given: &[f64], at: usize) -> f64 {
    given.get(at).copied().unwrap_or(f64::NAN)
}

/// The number of a vertex, a triangle or a collider. A number that is not whole names none of them, and is refused.
fn index(number: f64) -> u32 {
    let index = number as u32;
    if f64::from(index) == number { index } else { u32::MAX }
}

fn vector(given: &[f64], at: usize) -> [f64; 3] {
    [0, 1, 2].map(|k| number(given, at + k))
}

/// A pose: x, y, z, and the quaternion x, y, z, w.
fn pose(given: &[f64], at: usize) -> Pose {
    let [x, y, z, w] = [3, 4, 5, 6].map(|k| number(given, at + k));
    Pose { position: DVec3::from(vector(given, at)), rotation: DQuat::from_xyzw(x, y, z, w) }
}

fn numbers(touch: &Touch) -> Vec<f64> {
    let sides = touch.sides.map(|side| match side {
        Side::Cloth(number) => [0.0, number.into()],
        Side::Collider(number) => [1.0, number.into()],
    });
    let [position, normal, force] = [&touch.position, &touch.normal, &touch.force];
    [sides.as_flattened(), &touch.vertices.map(f64::from), &touch.weights, position, normal, force].concat()
}

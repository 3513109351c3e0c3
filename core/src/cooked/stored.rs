//! The top level of a cooked scene, and the views of columns that a running cloth changes.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::CookedError;
use super::columns::columns;
use crate::contact::{ContactScratch, Solids};
use crate::forces::load::VertexForce;
use crate::forces::{Jacobian, Model};
use crate::implicit_contact::multiplier::Multiplier;
use crate::integrate::pins::PinSlots;
use crate::integrate::{Method, Preconditioner, Scheme, Tolerance};
use crate::particles::Particles;
use crate::reactions::{Impulse, Reactions};
use crate::real::{Real, Vec3};
use crate::scratch::Scratch;

/// All columns.
pub(crate) struct Stored<'a> {
    pub settings: Settings,
    /// Triangles of all cloths.
    pub triangles: &'a [[u32; 3]],
    pub particles: Particles<'a>,
    pub model: Model<'a>,
    pub pins: PinSlots<'a>,
    pub scratch: Scratch<'a>,
    /// Held axes of each vertex for the preconditioner; empty without patches.
    pub held: &'a mut [u8],
    /// Absent: surfaces pass through one another.
    pub contact: Option<StoredContact<'a>>,
    /// Slots for forces of the host on vertices.
    pub forces: &'a mut [VertexForce],
    /// Impulses of the colliders; absent: they are not measured.
    pub reactions: Option<Reactions<'a>>,
    /// Columns for a step that is divided; absent: no step is.
    pub kept: Option<Kept<'a>>,
}

/// Value in [`StoredContact::own_frames`] of a collider that the host cannot deform.
pub(crate) const NO_FRAMES: u32 = u32::MAX;

/// Contact: what can touch, and the columns of a step.
pub(crate) struct StoredContact<'a> {
    pub model: Solids<'a>,
    pub columns: ContactScratch<'a>,
    /// Index of the first of two frames of each collider that the host may deform, or [`NO_FRAMES`]; may be empty.
    pub own_frames: &'a [u32],
}

/// A copy of the state before a step that is divided.
pub(crate) struct Kept<'a> {
    pub positions: &'a mut [Vec3],
    pub velocities: &'a mut [Vec3],
    pub low_positions: &'a mut [Vec3],
    pub low_velocities: &'a mut [Vec3],
    pub previous_displacements: &'a mut [Vec3],
    pub previous_velocity_changes: &'a mut [Vec3],
    pub multipliers: &'a mut [Multiplier],
    pub reactions: &'a mut [Impulse],
}

columns! { Stored {
    value settings, constant triangles, part particles, part model, part pins, part scratch, state held, part contact,
    state forces, part reactions, part kept,
} }
columns! { PinSlots {
    state vertices, state axes, state anchors, state motions, state table, state keys, state holds, state carriers,
    value of_scene,
} }
columns! { StoredContact { part model, part columns, constant own_frames } }
columns! { Solids {
    value thickness, flag continuous, part surface, state bodies, constant anchors, constant keys, state frames,
    constant firsts, constant material, constant radii, constant inverse_masses, state held, constant law_of,
    constant laws,
} }
columns! { Kept {
    scratch positions, scratch velocities, scratch low_positions, scratch low_velocities, scratch previous_displacements,
    scratch previous_velocity_changes, scratch multipliers, scratch reactions,
} }

/// The scheme and the start, in plain numbers.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Settings {
    /// The point in the world from which positions are measured, m.
    pub origin: [f64; 3],
    /// Length of a step, s.
    pub step: f64,
    /// Relative residual, or 0.
    residual: f64,
    /// Velocity, m/s, where the residual is 0.
    velocity: f64,
    /// Largest error of a step, m; 0: no limit.
    error: f64,
    /// Number of steps taken.
    pub steps: u64,
    method: u32,
    newton: u32,
    preconditioner: u32,
    jacobian: u32,
}

impl Settings {
    /// Those of a scheme.
    #[cfg(feature = "alloc")]
    pub fn new(scheme: &Scheme, step: Real, origin: DVec3, steps: u64) -> Self {
        let [residual, velocity] = match scheme.tolerance {
            Tolerance::Residual(residual) => [residual, 0.0],
            Tolerance::Velocity(velocity) => [0.0, velocity],
        };
        Self {
            origin: origin.into(),
            step: step.into(),
            residual: residual.into(),
            velocity: velocity.into(),
            error: scheme.error.unwrap_or(0.0).into(),
            steps,
            method: Method::ALL.iter().position(|&method| method == scheme.method).unwrap_or(0) as u32,
            newton: scheme.newton,
            preconditioner: u32::from(scheme.preconditioner == Preconditioner::TwoLevel),
            jacobian: u32::from(scheme.jacobian == Jacobian::Exact),
        }
    }

    /// The scheme.
    pub fn scheme(&self) -> Result<Scheme, CookedError> {
        // As the scheme holds them: a double may be zero or infinite in single precision.
        let numbers = [self.step, self.residual, self.velocity, self.error].map(|number| number as Real);
        let [step, residual, velocity, error] = numbers;
        let are_finite = numbers.iter().all(|number| number.is_finite()) && DVec3::from(self.origin).is_finite();
        if !are_finite || step <= 0.0 || self.newton == 0 {
            return Err(CookedError::Malformed);
        }
        Ok(Scheme {
            method: *Method::ALL.get(self.method as usize).ok_or(CookedError::Malformed)?,
            newton: self.newton,
            tolerance: if residual > 0.0 { Tolerance::Residual(residual) } else { Tolerance::Velocity(velocity) },
            preconditioner: match self.preconditioner {
                0 => Preconditioner::BlockJacobi,
                _ => Preconditioner::TwoLevel,
            },
            jacobian: if self.jacobian == 0 { Jacobian::Projected } else { Jacobian::Exact },
            error: (error > 0.0).then_some(error),
        })
    }
}

//! Forces. The model is the list of terms that a scene names. A term that the scene does not name is
//! neither allocated nor computed.
//!
//! Every force is a function of positions and velocities, affine in the velocities.

pub mod drag;
pub mod element;
pub mod gravity;
pub mod hinge;
pub mod load;
pub mod matrix;
pub mod membrane;
pub(crate) mod model;
pub mod seam;
#[cfg(feature = "alloc")]
pub mod sparsity;
pub mod spring;
pub mod term;
pub mod wind;

#[cfg(feature = "alloc")]
pub use model::ModelColumns;
pub(crate) use model::for_each_term;
pub use model::{Model, Term};

use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::particles::Positions;
use crate::real::{Real, Sum, Vec3};
use crate::stage::Stage;
use matrix::{AssemblyMap, BlockMatrix};
use term::ForceTerm;

/// The Jacobian that implicit methods use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Jacobian {
    /// Positive semidefinite for each element, so that conjugate gradients always descend.
    #[default]
    Projected,
    /// The exact derivative, which is indefinite under compression.
    Exact,
}

/// Factors of the Jacobians. An implicit stage of length g needs `g^2 Kx + g Kv`.
#[derive(Clone, Copy, Debug)]
pub struct TangentScale {
    /// Factor of df/dx, s^2.
    pub position: Real,
    /// Factor of df/dv, s.
    pub velocity: Real,
}

/// Energies by term, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy.
    pub kinetic: Sum,
    /// Stretch, of springs or of the membrane.
    pub stretch: Sum,
    /// Shear of the membrane.
    pub shear: Sum,
    /// Bending, of hinges or of springs.
    pub bend: Sum,
    /// Seams.
    pub seam: Sum,
    /// Potential energy of gravity, zero at the origin, and of loads, zero at the start.
    pub gravity: Sum,
}

impl Energy {
    /// Sum of all energies.
    pub fn total(&self) -> Sum {
        self.kinetic + self.stretch + self.shear + self.bend + self.seam + self.gravity
    }
}

impl core::ops::Add for Energy {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            kinetic: self.kinetic + other.kinetic,
            stretch: self.stretch + other.stretch,
            shear: self.shear + other.shear,
            bend: self.bend + other.bend,
            seam: self.seam + other.seam,
            gravity: self.gravity + other.gravity,
        }
    }
}

/// Writes the sum of the forces of all terms to `f`, N.
pub fn evaluate(
    model: &Model<'_>,
    masses: &[Real],
    x: Positions<'_>,
    v: &[Vec3],
    scratch: &mut [Vec3],
    f: &mut [Vec3],
    dispatch: &impl Dispatch,
) {
    if model.gravity.is_none() {
        dispatch.enter(Stage::Force(Term::Gravity));
        dispatch.run(&mut *f, |_, part| part.fill(Vec3::ZERO));
    }
    for_each_term!(model, |name, term| {
        dispatch.enter(Stage::Force(name));
        term.add_forces(masses, x, v, scratch, f, dispatch);
    });
    dispatch.enter(Stage::Integrate);
}

/// The largest strain rate of springs and triangles at the velocities `v`, 1/s. For a spring it is the
/// relative velocity of the ends over the rest length, for a triangle the rate of wu or wv. Rigid rotation
/// counts too.
pub fn strain_rate(model: &Model<'_>, v: &[Vec3]) -> Real {
    let mut largest: Real = 0.0;
    for_each_term!(model, |_, term| largest = largest.max(term.strain_rate(v)));
    largest
}

/// The largest rate at which springs and triangles stretch or shear at the positions `x` and the velocities `v`, 1/s.
/// Rigid rotation does not count.
pub fn stretch_rate(model: &Model<'_>, x: &[Vec3], v: &[Vec3]) -> Real {
    let mut largest: Real = 0.0;
    for_each_term!(model, |_, term| largest = largest.max(term.stretch_rate(x, v)));
    largest
}

/// The potential energies, J. `kinetic` stays zero.
pub fn energy(model: &Model<'_>, masses: &[Real], x: Positions<'_>) -> Energy {
    let mut sum = Energy::default();
    for_each_term!(model, |name, term| sum = sum + term.energy(name, masses, x));
    sum
}

/// Writes the sum of `-(position Kx + velocity Kv)` over all terms to `matrix`.
pub fn write_tangents(
    model: &Model<'_>,
    x: &[Vec3],
    scale: TangentScale,
    jacobian: Jacobian,
    assembly_map: &AssemblyMap<'_>,
    scratch: &mut [Real],
    matrix: &mut BlockMatrix<'_>,
    dispatch: &impl Dispatch,
) {
    if model.drag.is_none() {
        dispatch.enter(Stage::Jacobian(Term::Drag));
        dispatch.run(matrix.rows_mut(), |_, mut rows| rows.clear());
    }
    for_each_term!(model, |name, term| if term.has_jacobian() {
        dispatch.enter(Stage::Jacobian(name));
        let slots = assembly_map.at(name as usize);
        term.add_tangents(x, scale, jacobian, slots, scratch, matrix, dispatch);
    });
    dispatch.enter(Stage::Integrate);
}

//! Forces. The model is the list of terms that a scene names. A term that the scene does not name is
//! neither allocated nor computed.
//!
//! Every force is a function of positions and velocities, affine in the velocities.

pub mod element;
pub mod hinge;
pub mod matrix;
pub mod membrane;
mod model;
pub mod seam;
#[cfg(feature = "alloc")]
pub mod sparsity;
pub mod spring;
pub mod wind;

#[cfg(feature = "alloc")]
pub use model::ModelColumns;
pub use model::{Drag, Model};

use crate::dispatch::Dispatch;
use crate::real::{Real, Sum, Vec3, dot_sum, scaled_identity};
use crate::stage::Stage;
pub use crate::stage::Term;
use matrix::{AssemblyMap, BlockMatrix, add};

/// The Jacobian that implicit methods use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "kebab-case"))]
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
    /// Potential energy of gravity, zero at the origin.
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
    x: &[Vec3],
    v: &[Vec3],
    scratch: &mut [Vec3],
    f: &mut [Vec3],
    dispatch: &impl Dispatch,
) {
    dispatch.enter(Stage::Force(Term::Gravity));
    let gravity = model.gravity.unwrap_or(Vec3::ZERO);
    dispatch.run(&mut *f, |start, part| {
        for (f, &mass) in part.iter_mut().zip(&masses[start..]) {
            *f = gravity * mass;
        }
    });
    if let Some(drag) = model.drag {
        dispatch.enter(Stage::Force(Term::Drag));
        dispatch.run(&mut *f, |start, part| {
            for (i, f) in (start..).zip(part) {
                *f -= v[i] * drag.coefficients[i];
            }
        });
    }
    let springs = [(Term::StretchSpring, &model.stretch_springs), (Term::BendSpring, &model.bend_springs)];
    for (term, springs) in springs {
        if let Some(springs) = springs {
            dispatch.enter(Stage::Force(term));
            spring::add_forces(springs, x, v, f, dispatch);
        }
    }
    if let Some(membrane) = &model.membrane {
        dispatch.enter(Stage::Force(Term::Membrane));
        element::add_forces(membrane, x, v, scratch, f, dispatch);
    }
    if let Some(hinges) = &model.hinges {
        dispatch.enter(Stage::Force(Term::Hinge));
        element::add_forces(hinges, x, v, scratch, f, dispatch);
    }
    if let Some(seams) = &model.seams {
        dispatch.enter(Stage::Force(Term::Seam));
        element::add_forces(seams, x, v, scratch, f, dispatch);
    }
    if let Some(wind) = &model.wind {
        dispatch.enter(Stage::Force(Term::Wind));
        element::add_forces(wind, x, v, scratch, f, dispatch);
    }
    dispatch.enter(Stage::Integrate);
}

/// The largest strain rate of springs and triangles at the velocities `v`, 1/s. For a spring it is the
/// relative velocity of the ends over the rest length, for a triangle the rate of wu or wv. Rigid rotation
/// counts too.
pub fn strain_rate(model: &Model<'_>, v: &[Vec3]) -> Real {
    let springs = model.stretch_springs.iter().chain(&model.bend_springs).map(|springs| springs.strain_rate(v));
    springs.chain(model.membrane.map(|membrane| membrane.strain_rate(v))).fold(0.0, Real::max)
}

/// The potential energies, J. `kinetic` stays zero.
pub fn energy(model: &Model<'_>, masses: &[Real], x: &[Vec3]) -> Energy {
    let mut sum = Energy::default();
    if let Some(gravity) = model.gravity {
        sum.gravity = -masses.iter().zip(x).map(|(&m, &x)| dot_sum(gravity * m, x)).sum::<Sum>();
    }
    if let Some(springs) = &model.stretch_springs {
        sum.stretch += spring::total_energy(springs, x);
    }
    if let Some(springs) = &model.bend_springs {
        sum.bend += spring::total_energy(springs, x);
    }
    if let Some(membrane) = &model.membrane {
        sum = sum + element::energy(membrane, x);
    }
    if let Some(hinges) = &model.hinges {
        sum = sum + element::energy(hinges, x);
    }
    if let Some(seams) = &model.seams {
        sum = sum + element::energy(seams, x);
    }
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
    dispatch.enter(Stage::Jacobian(Term::Drag));
    dispatch.run(matrix.rows_mut(), |start, mut rows| {
        rows.clear();
        if let Some(drag) = model.drag {
            for i in 0..rows.count() {
                add(&mut rows.row(i)[0], &scaled_identity(scale.velocity * drag.coefficients[start + i]));
            }
        }
    });
    let springs = [
        (Term::StretchSpring, &model.stretch_springs, assembly_map.stretch_springs),
        (Term::BendSpring, &model.bend_springs, assembly_map.bend_springs),
    ];
    for (term, springs, assembly_map) in springs {
        if let Some(springs) = springs {
            dispatch.enter(Stage::Jacobian(term));
            spring::add_tangents(springs, x, scale, jacobian, assembly_map, matrix, dispatch);
        }
    }
    if let Some(membrane) = &model.membrane {
        dispatch.enter(Stage::Jacobian(Term::Membrane));
        element::add_tangents(membrane, x, scale, jacobian, assembly_map.membrane, scratch, matrix, dispatch);
    }
    if let Some(hinges) = &model.hinges {
        dispatch.enter(Stage::Jacobian(Term::Hinge));
        element::add_tangents(hinges, x, scale, jacobian, assembly_map.hinges, scratch, matrix, dispatch);
    }
    if let Some(seams) = &model.seams {
        dispatch.enter(Stage::Jacobian(Term::Seam));
        element::add_tangents(seams, x, scale, jacobian, assembly_map.seams, scratch, matrix, dispatch);
    }
    if let Some(wind) = &model.wind {
        dispatch.enter(Stage::Jacobian(Term::Wind));
        // Always projected: wind has no potential, so its exact Jacobian is not symmetric.
        element::add_tangents(wind, x, scale, Jacobian::Projected, assembly_map.wind, scratch, matrix, dispatch);
    }
    dispatch.enter(Stage::Integrate);
}

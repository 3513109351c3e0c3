//! Forces: the model is the list of terms that a scene names. A term that is not named is not
//! allocated, not computed and not in any loop.
//!
//! Every force is a function of positions and velocities, affine in the velocities.

pub mod element;
pub mod hinge;
pub mod membrane;
pub mod seam;
pub mod spring;
pub mod wind;

use crate::dispatch::Dispatch;
use crate::integrate::Jacobian;
use crate::integrate::matrix::{BlockMatrix, Targets};
use crate::real::{Real, Sum, Vec3, dot_sum, scaled_identity};

/// What a Jacobian is multiplied with: an implicit stage of length g needs `g^2 Kx + g Kv`.
#[derive(Clone, Copy, Debug)]
pub struct TangentScale {
    /// Factor of df/dx, s^2.
    pub position: Real,
    /// Factor of df/dv, s.
    pub velocity: Real,
}

/// Energies, J, by what holds them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Of motion.
    pub kinetic: Sum,
    /// Stretch, by springs or membrane.
    pub stretch: Sum,
    /// Shear of the membrane.
    pub shear: Sum,
    /// Bending, by hinges or springs.
    pub bend: Sum,
    /// Seams.
    pub seam: Sum,
    /// Height; zero at the origin.
    pub gravity: Sum,
}

impl Energy {
    /// All that is stored or moving.
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

/// Linear drag, f = -c v.
#[derive(Clone, Copy, Debug)]
pub struct Drag<'a> {
    /// c of each vertex, N s/m.
    pub coefficients: &'a [Real],
}

/// The listed terms.
#[derive(Clone, Copy, Debug, Default)]
pub struct Model<'a> {
    /// m/s^2.
    pub gravity: Option<Vec3>,
    /// Linear drag.
    pub drag: Option<Drag<'a>>,
    /// Springs along the edges.
    pub stretch_springs: Option<spring::Springs<'a>>,
    /// Springs between unshared vertices of neighbouring triangles.
    pub bend_springs: Option<spring::Springs<'a>>,
    /// Stretch and shear of triangles.
    pub membrane: Option<membrane::Membrane<'a>>,
    /// Angles between neighbouring triangles.
    pub hinges: Option<hinge::Hinges<'a>>,
    /// Sewn vertices.
    pub seams: Option<seam::Seams<'a>>,
    /// Wind on triangles.
    pub wind: Option<wind::Wind<'a>>,
}

/// The names of the terms, for reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// Gravity.
    Gravity,
    /// Linear drag.
    Drag,
    /// Stretch springs.
    StretchSpring,
    /// Bending springs.
    BendSpring,
    /// Stretch and shear of triangles.
    Membrane,
    /// Hinge bending.
    Hinge,
    /// Seams.
    Seam,
    /// Wind.
    Wind,
}

impl Term {
    /// Every term, in the order of evaluation.
    pub const ALL: [Self; 8] = [
        Self::Gravity,
        Self::Drag,
        Self::StretchSpring,
        Self::BendSpring,
        Self::Membrane,
        Self::Hinge,
        Self::Seam,
        Self::Wind,
    ];

    /// As scenes and messages call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gravity => "gravity",
            Self::Drag => "drag",
            Self::StretchSpring => "stretch (springs)",
            Self::BendSpring => "bend (springs)",
            Self::Membrane => "stretch and shear (membrane)",
            Self::Hinge => "bend (hinges)",
            Self::Seam => "seam",
            Self::Wind => "wind",
        }
    }
}

impl<'a> Model<'a> {
    /// The model with one of its terms alone; none where it has no such term.
    pub fn only(&self, term: Term) -> Option<Self> {
        let mut alone = Self::default();
        let present = match term {
            Term::Gravity => take(&mut alone.gravity, self.gravity),
            Term::Drag => take(&mut alone.drag, self.drag),
            Term::StretchSpring => take(&mut alone.stretch_springs, self.stretch_springs),
            Term::BendSpring => take(&mut alone.bend_springs, self.bend_springs),
            Term::Membrane => take(&mut alone.membrane, self.membrane),
            Term::Hinge => take(&mut alone.hinges, self.hinges),
            Term::Seam => take(&mut alone.seams, self.seams),
            Term::Wind => take(&mut alone.wind, self.wind),
        };
        present.then_some(alone)
    }

    /// Whether any force depends on velocities.
    pub fn dissipates(&self) -> bool {
        let springs = [&self.stretch_springs, &self.bend_springs].into_iter().flatten();
        let mut damped = springs.map(|s| !s.damping.is_empty());
        self.drag.is_some()
            || self.wind.is_some()
            || damped.any(|damped| damped)
            || self.membrane.is_some_and(|m| m.table.iter().any(|m| m.stretch_damping > 0.0 || m.shear_damping > 0.0))
            || self.hinges.is_some_and(|h| !h.damping.is_empty())
            || self.seams.is_some_and(|s| s.damping.iter().any(|&d| d > 0.0))
    }

    /// Vectors that [`evaluate`] needs as scratch.
    pub fn force_scratch(&self) -> usize {
        let triangles = self.membrane.map_or(0, |m| m.vertices.len()).max(self.wind.map_or(0, |w| w.vertices.len()));
        let stitches = self.seams.map_or(0, |s| s.vertices.len());
        (3 * triangles.max(stitches)).max(4 * self.hinges.map_or(0, |h| h.vertices.len()))
    }

    /// Scalars that [`write_tangents`] needs as scratch.
    pub fn tangent_scratch(&self) -> usize {
        let sizes = [
            27 * self.membrane.map_or(0, |m| m.vertices.len()),
            12 * self.hinges.map_or(0, |h| h.vertices.len()),
            self.seams.map_or(0, |s| s.vertices.len()),
            9 * self.wind.map_or(0, |w| w.vertices.len()),
        ];
        sizes.into_iter().max().unwrap_or(0)
    }
}

fn take<T: Copy>(slot: &mut Option<T>, value: Option<T>) -> bool {
    *slot = value;
    value.is_some()
}

/// The owned columns of a [`Model`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct ModelColumns {
    /// m/s^2.
    pub gravity: Option<Vec3>,
    /// N s/m of each vertex.
    pub drag: Option<alloc::vec::Vec<Real>>,
    /// Springs along the edges.
    pub stretch_springs: Option<spring::SpringColumns>,
    /// Springs between unshared vertices.
    pub bend_springs: Option<spring::SpringColumns>,
    /// Stretch and shear of triangles.
    pub membrane: Option<membrane::MembraneColumns>,
    /// Hinges.
    pub hinges: Option<hinge::HingeColumns>,
    /// Seams.
    pub seams: Option<seam::SeamColumns>,
    /// Wind.
    pub wind: Option<wind::WindColumns>,
}

#[cfg(feature = "alloc")]
impl ModelColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Model<'_> {
        Model {
            gravity: self.gravity,
            drag: self.drag.as_deref().map(|coefficients| Drag { coefficients }),
            stretch_springs: self.stretch_springs.as_ref().map(spring::SpringColumns::view),
            bend_springs: self.bend_springs.as_ref().map(spring::SpringColumns::view),
            membrane: self.membrane.as_ref().map(membrane::MembraneColumns::view),
            hinges: self.hinges.as_ref().map(hinge::HingeColumns::view),
            seams: self.seams.as_ref().map(seam::SeamColumns::view),
            wind: self.wind.as_ref().map(wind::WindColumns::view),
        }
    }
}

/// Writes the sum of all terms to `f`, N.
pub fn evaluate(
    model: &Model<'_>,
    masses: &[Real],
    x: &[Vec3],
    v: &[Vec3],
    scratch: &mut [Vec3],
    f: &mut [Vec3],
    dispatch: &impl Dispatch,
) {
    let gravity = model.gravity.unwrap_or(Vec3::ZERO);
    dispatch.run(&mut *f, |start, part| {
        for (f, &mass) in part.iter_mut().zip(&masses[start..]) {
            *f = gravity * mass;
        }
        if let Some(drag) = model.drag {
            for (i, f) in (start..).zip(part) {
                *f -= v[i] * drag.coefficients[i];
            }
        }
    });
    for springs in [&model.stretch_springs, &model.bend_springs].into_iter().flatten() {
        spring::add_forces(springs, x, v, f, dispatch);
    }
    if let Some(membrane) = &model.membrane {
        element::add_forces(membrane, x, v, scratch, f, dispatch);
    }
    if let Some(hinges) = &model.hinges {
        element::add_forces(hinges, x, v, scratch, f, dispatch);
    }
    if let Some(seams) = &model.seams {
        element::add_forces(seams, x, v, scratch, f, dispatch);
    }
    if let Some(wind) = &model.wind {
        element::add_forces(wind, x, v, scratch, f, dispatch);
    }
}

/// The stored energies; kinetic is left zero.
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

/// Writes `-(position Kx + velocity Kv)` of all terms to `matrix`.
pub fn write_tangents(
    model: &Model<'_>,
    x: &[Vec3],
    scale: TangentScale,
    jacobian: Jacobian,
    targets: &Targets<'_>,
    scratch: &mut [Real],
    matrix: &mut BlockMatrix<'_>,
    dispatch: &impl Dispatch,
) {
    dispatch.run(matrix.rows_mut(), |start, mut rows| {
        rows.clear();
        if let Some(drag) = model.drag {
            for i in 0..rows.count() {
                rows.row(i)[0] = scaled_identity(scale.velocity * drag.coefficients[start + i]);
            }
        }
    });
    if let Some(springs) = &model.stretch_springs {
        spring::add_tangents(springs, x, scale, jacobian, targets.stretch_springs, matrix, dispatch);
    }
    if let Some(springs) = &model.bend_springs {
        spring::add_tangents(springs, x, scale, jacobian, targets.bend_springs, matrix, dispatch);
    }
    if let Some(membrane) = &model.membrane {
        element::add_tangents(membrane, x, scale, jacobian, targets.membrane, scratch, matrix, dispatch);
    }
    if let Some(hinges) = &model.hinges {
        element::add_tangents(hinges, x, scale, jacobian, targets.hinges, scratch, matrix, dispatch);
    }
    if let Some(seams) = &model.seams {
        element::add_tangents(seams, x, scale, jacobian, targets.seams, scratch, matrix, dispatch);
    }
    if let Some(wind) = &model.wind {
        // Wind has no potential: its exact Jacobian is not symmetric, its projected one is.
        element::add_tangents(wind, x, scale, Jacobian::Projected, targets.wind, scratch, matrix, dispatch);
    }
}

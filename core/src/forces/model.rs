//! The model: the list of terms that a scene names.

use super::{hinge, membrane, seam, spring, wind};
use crate::real::{Real, Vec3};
use crate::stage::Term;

/// Linear drag, f = -c v.
#[derive(Clone, Copy, Debug)]
pub struct Drag<'a> {
    /// c of each vertex, N s/m.
    pub coefficients: &'a [Real],
}

/// The terms, borrowed. A term that the scene does not name is `None`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Model<'a> {
    /// Gravity, m/s^2.
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

impl<'a> Model<'a> {
    /// The model with only one of its terms. `None` if the model does not have the term.
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

    /// Number of vectors that [`evaluate`](super::evaluate) needs as scratch.
    pub fn force_scratch(&self) -> usize {
        let triangles = self.membrane.map_or(0, |m| m.vertices.len()).max(self.wind.map_or(0, |w| w.vertices.len()));
        let stitches = self.seams.map_or(0, |s| s.vertices.len());
        (3 * triangles.max(stitches)).max(4 * self.hinges.map_or(0, |h| h.vertices.len()))
    }

    /// Number of scalars that [`write_tangents`](super::write_tangents) needs as scratch.
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
    /// Gravity, m/s^2.
    pub gravity: Option<Vec3>,
    /// Drag coefficient of each vertex, N s/m.
    pub drag: Option<alloc::vec::Vec<Real>>,
    /// Springs along the edges.
    pub stretch_springs: Option<spring::SpringColumns>,
    /// Springs between unshared vertices of neighbouring triangles.
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
    /// Bytes of the columns.
    pub fn bytes(&self) -> usize {
        let model = self.view();
        let springs = |s: &Option<spring::Springs<'_>>| s.map_or(0, |s| s.bytes());
        self.drag.as_deref().map_or(0, size_of_val)
            + springs(&model.stretch_springs)
            + springs(&model.bend_springs)
            + model.membrane.map_or(0, |m| m.bytes())
            + model.hinges.map_or(0, |h| h.bytes())
            + model.seams.map_or(0, |s| s.bytes())
            + model.wind.map_or(0, |w| size_of_val(w.vertices) + w.incidence.bytes())
    }

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

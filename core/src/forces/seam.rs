//! Seams: E = k/2 |(1 - w) xb + w xc - xa|^2. A spring of zero length sews a vertex to a point on an
//! edge. The force is linear, so the projected Jacobian is exact and constant.

use super::element::{Element, ElementTerm};
use super::{Energy, TangentScale};
use crate::column::Column;
use crate::mesh::Incidence;
use crate::real::{Mat3, Real, Vec3, scaled_identity};

/// Stitches, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Seams<'a> {
    /// The sewn vertex a, then the ends b, c of the edge that it is sewn to.
    pub vertices: &'a [[u32; 3]],
    /// w: position on the edge, 0 at b, 1 at c.
    pub weights: &'a [Real],
    /// k, N/m.
    pub stiffness: &'a [Real],
    /// Damping, N s/m.
    pub damping: &'a [Real],
    /// The stitch corners at each vertex.
    pub incidence: Incidence<'a>,
}

/// Weights of the corners in the gap.
#[inline]
fn corner_weights(w: Real) -> [Real; 3] {
    [-1.0, 1.0 - w, w]
}

#[inline]
fn gap(w: &[Real; 3], x: &[Vec3; 3]) -> Vec3 {
    // Differences first: they are exact for points that are close together.
    (x[1] - x[0]) * w[1] + (x[2] - x[0]) * w[2]
}

impl Element<3> for Seams<'_> {
    /// Scaled stiffness.
    type Tangent = Real;

    fn vertices(&self) -> &[[u32; 3]] {
        self.vertices
    }

    fn incidence(&self) -> Incidence<'_> {
        self.incidence
    }

    #[inline]
    fn force(&self, stitch: usize, x: &[Vec3; 3], v: &[Vec3; 3]) -> [Vec3; 3] {
        let w = corner_weights(self.weights.at(stitch));
        let pull = gap(&w, x) * self.stiffness.at(stitch) + gap(&w, v) * self.damping.at(stitch);
        let (f1, f2) = (pull * -w[1], pull * -w[2]);
        [-(f1 + f2), f1, f2]
    }

    fn energy(&self, stitch: usize, x: &[Vec3; 3]) -> Energy {
        let gap = gap(&corner_weights(self.weights.at(stitch)), x);
        Energy { seam: (0.5 * self.stiffness.at(stitch) * gap.length_squared()).into(), ..Energy::default() }
    }

    #[inline]
    fn tangent(&self, stitch: usize, _: &[Vec3; 3], scale: TangentScale) -> Real {
        scale.position * self.stiffness.at(stitch) + scale.velocity * self.damping.at(stitch)
    }

    #[inline]
    fn block(&self, stitch: usize, stiffness: &Real, a: usize, b: usize) -> Mat3 {
        let w = corner_weights(self.weights.at(stitch));
        scaled_identity(stiffness * w.at(a) * w.at(b))
    }

    fn exact(&self, stitch: usize, x: &[Vec3; 3], _: &[Vec3; 3], scale: TangentScale) -> [[Mat3; 3]; 3] {
        let tangent = self.tangent(stitch, x, scale);
        core::array::from_fn(|a| core::array::from_fn(|b| self.block(stitch, &tangent, a, b)))
    }
}

impl ElementTerm for Seams<'_> {
    type Corners = [u32; 3];

    fn dissipates(&self) -> bool {
        self.damping.iter().any(|&damping| damping > 0.0)
    }

    fn material_bytes(&self) -> usize {
        [self.weights, self.stiffness, self.damping].map(size_of_val).iter().sum()
    }
}

/// The owned columns of [`Seams`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct SeamColumns {
    /// Corners a, b, c.
    pub vertices: alloc::vec::Vec<[u32; 3]>,
    /// w: position on the edge, 0 at b, 1 at c.
    pub weights: alloc::vec::Vec<Real>,
    /// k, N/m.
    pub stiffness: alloc::vec::Vec<Real>,
    /// Damping, N s/m.
    pub damping: alloc::vec::Vec<Real>,
    /// The stitch corners at each vertex.
    pub incidence: crate::mesh::IncidenceColumns,
}

#[cfg(feature = "alloc")]
impl SeamColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Seams<'_> {
        Seams {
            vertices: &self.vertices,
            weights: &self.weights,
            stiffness: &self.stiffness,
            damping: &self.damping,
            incidence: self.incidence.view(),
        }
    }
}

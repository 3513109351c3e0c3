//! Wind on triangles: f = A (cn (w . n) n + ct (w - (w . n) n)), where w is the velocity of the wind relative to the
//! triangle. The force is linear in w. A third of it acts on each corner. A is the area of the triangle, counted once:
//! cn and ct are those of both sides together.

use super::element::{Element, ElementTerm};
use super::{Energy, TangentScale};
use crate::keys::{Key, Moment};
use crate::mesh::Incidence;
use crate::real::{Mat3, Real, Vec3, cross, outer, scaled_identity, sqrt, vec3};

/// Wind on triangles.
#[derive(Clone, Copy, Debug)]
pub struct Wind<'a> {
    /// Corners.
    pub vertices: &'a [[u32; 3]],
    /// Velocity of the air, m/s.
    pub velocity: Vec3,
    /// The velocity over time, m/s; empty: it is constant.
    pub keys: &'a [Key],
    /// cn, N s/m^3.
    pub normal: Real,
    /// ct, N s/m^3.
    pub tangential: Real,
    /// The triangle corners at each vertex.
    pub incidence: Incidence<'a>,
}

impl Wind<'_> {
    /// With the velocity of a moment.
    pub fn at(self, moment: Moment) -> Self {
        if self.keys.is_empty() {
            return self;
        }
        Self { velocity: vec3(moment.value(self.keys).into()), ..self }
    }

    /// The normal with twice the area as length, its length, and the relative wind w.
    #[inline]
    fn facing(&self, x: &[Vec3; 3], v: &[Vec3; 3]) -> (Vec3, Real, Vec3) {
        let n = (x[1] - x[0]).cross(x[2] - x[0]);
        (n, sqrt(n.length_squared()), self.velocity - (v[0] + v[1] + v[2]) / 3.0)
    }

    /// Minus the derivative of the triangle's force by its mean velocity: A (cn n n^T + ct (I - n n^T)).
    #[inline]
    fn resistance(&self, n: Vec3, length: Real) -> Mat3 {
        let along = outer(n * (0.5 * (self.normal - self.tangential) / length), n);
        scaled_identity(0.5 * self.tangential * length) + along
    }
}

impl Element<3> for Wind<'_> {
    /// One block for all pairs of corners. It has only the derivative by velocities: wind has no potential.
    type Tangent = Mat3;

    fn vertices(&self) -> &[[u32; 3]] {
        self.vertices
    }

    fn incidence(&self) -> Incidence<'_> {
        self.incidence
    }

    #[inline]
    fn force(&self, _: usize, x: &[Vec3; 3], v: &[Vec3; 3]) -> [Vec3; 3] {
        let (n, length, w) = self.facing(x, v);
        if length <= Real::MIN_POSITIVE {
            return [Vec3::ZERO; 3];
        }
        [self.resistance(n, length) * w / 3.0; 3]
    }

    fn energy(&self, _: usize, _: &[Vec3; 3]) -> Energy {
        Energy::default()
    }

    #[inline]
    fn tangent(&self, _: usize, x: &[Vec3; 3], scale: TangentScale) -> Mat3 {
        let (n, length, _) = self.facing(x, &[Vec3::ZERO; 3]);
        if length <= Real::MIN_POSITIVE {
            return Mat3::ZERO;
        }
        self.resistance(n, length) * (scale.velocity / 9.0)
    }

    #[inline]
    fn block(&self, _: usize, tangent: &Mat3, _: usize, _: usize) -> Mat3 {
        *tangent
    }

    fn exact(&self, triangle: usize, x: &[Vec3; 3], v: &[Vec3; 3], scale: TangentScale) -> [[Mat3; 3]; 3] {
        let (n, length, w) = self.facing(x, v);
        let velocity = self.tangent(triangle, x, scale);
        if length <= Real::MIN_POSITIVE {
            return [[velocity; 3]; 3];
        }
        // The derivative by N of the force on a corner, (ct |N| w + (cn - ct) N (N . w) / |N|) / 6.
        let h = n / length;
        let along = scaled_identity(h.dot(w)) + outer(h, w) - outer(h * h.dot(w), h);
        let by_normal = (outer(w * self.tangential, h) + along * (self.normal - self.tangential)) * (1.0 / 6.0);
        let opposite = [x[2] - x[1], x[0] - x[2], x[1] - x[0]];
        [opposite.map(|side| velocity - by_normal * cross(side) * scale.position); 3]
    }
}

impl ElementTerm for Wind<'_> {
    type Corners = [u32; 3];

    /// Wind has no potential.
    const CONSERVATIVE: bool = false;

    fn dissipates(&self) -> bool {
        true
    }

    fn material_bytes(&self) -> usize {
        0
    }
}

/// The owned columns of [`Wind`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct WindColumns {
    /// Corners.
    pub vertices: alloc::vec::Vec<[u32; 3]>,
    /// Velocity of the air, m/s.
    pub velocity: Vec3,
    /// The velocity over time, m/s; empty: it is constant.
    pub keys: alloc::vec::Vec<Key>,
    /// cn, N s/m^3.
    pub normal: Real,
    /// ct, N s/m^3.
    pub tangential: Real,
    /// The triangle corners at each vertex.
    pub incidence: crate::mesh::IncidenceColumns,
}

#[cfg(feature = "alloc")]
impl WindColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Wind<'_> {
        Wind {
            vertices: &self.vertices,
            velocity: self.velocity,
            keys: &self.keys,
            normal: self.normal,
            tangential: self.tangential,
            incidence: self.incidence.view(),
        }
    }
}

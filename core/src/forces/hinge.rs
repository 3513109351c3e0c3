//! Hinge bending: E = 1/2 ke (theta - theta0)^2 with ke = D |e|^2 / (A1 + A2). theta is the angle
//! between the normals of the triangles, 0 when flat, and D is the flexural rigidity
//! [Bridson 2003, Grinspun 2003; eq. 3.9, with atan2 for the angle]. Damping is
//! f = -kd dtheta/dt grad theta.
//!
//! Corners: a and b are the ends of the shared edge, c belongs to triangle (a, b, c) and d to triangle
//! (a, d, b). The projected Jacobian is the Gauss-Newton matrix ke grad grad^T.

use core::f64::consts::PI;

use super::element::{Element, ElementTerm};
use super::{Energy, TangentScale};
use crate::column::Column;
use crate::mesh::Incidence;
use crate::real::{DEGENERATE, Mat3, Real, Vec3, atan2, cross, outer, sqrt};

/// Hinges with their rest shape and stiffness.
#[derive(Clone, Copy, Debug)]
pub struct Hinges<'a> {
    /// Corners a, b, c, d.
    pub vertices: &'a [[u32; 4]],
    /// ke, N m per radian.
    pub stiffness: &'a [Real],
    /// theta0, radians.
    pub rest_angles: &'a [Real],
    /// A tenth of the rest length of the edge or of the smaller rest height over it, whichever is
    /// less, m. For shorter edges and lower triangles the gradient, which grows as 1/(length height),
    /// is scaled down, and the force with it.
    pub least_heights: &'a [Real],
    /// kd, N m s; empty if no hinge is damped.
    pub damping: &'a [Real],
    /// The hinge corners at each vertex.
    pub incidence: Incidence<'a>,
}

/// ke of a hinge from the flexural rigidity D of the sheet, the rest length of the edge and the rest
/// areas of its triangles. An equilateral mesh then has rigidity D for bending about any line
/// [Grinspun 2003].
pub fn stiffness(rigidity: f64, length: f64, areas: [f64; 2]) -> f64 {
    rigidity * length * length / (areas[0] + areas[1])
}

/// The current geometry of a hinge.
struct Fold {
    /// Unit vector along the edge, and the length of the edge.
    along: Vec3,
    length: Real,
    /// Normals of the triangles, with twice the area as length, and their squared lengths.
    normals: [Vec3; 2],
    squares: [Real; 2],
    /// `gradient[i] = weights[i][0] P1 + weights[i][1] P2` with P = N / |N|^2.
    weights: [[Real; 2]; 4],
}

/// The geometry of a hinge. `None` if the edge or a triangle has collapsed and the angle is undefined.
#[inline(always)]
fn fold(x: &[Vec3; 4], least_height: Real) -> Option<Fold> {
    let [a, b, c, d] = *x;
    let e = b - a;
    let length = sqrt(e.length_squared());
    let normals = [e.cross(c - a), (d - a).cross(e)];
    let squares = normals.map(Vec3::length_squared);
    let least = length * least_height * DEGENERATE;
    if length <= least_height * DEGENERATE || squares[0].min(squares[1]) <= least * least {
        return None;
    }
    let along = e / length;
    let reach = [(c - a).dot(along), (d - a).dot(along)];
    let weights = [
        // The weight of a is length - reach instead of (b - c) . along, so that the weights of a, b and c
        // sum to zero to the last bit.
        [length - reach[0], length - reach[1]],
        reach,
        [-length, 0.0],
        [0.0, -length],
    ];
    Some(Fold { along, length, normals, squares, weights })
}

impl Fold {
    #[inline]
    fn angle(&self) -> Real {
        let [n1, n2] = self.normals;
        atan2(n1.cross(n2).dot(self.along), n1.dot(n2))
    }

    #[inline]
    fn gradient(&self) -> [Vec3; 4] {
        let (p1, p2) = (self.normals[0] / self.squares[0], self.normals[1] / self.squares[1]);
        self.weights.map(|[s1, s2]| p1 * s1 + p2 * s2)
    }

    /// Factor that scales the gradient down: 1 while the edge and both heights over it are at least
    /// `least_height`, falling to 0 as one of them collapses. One factor for all corners keeps the
    /// total force and torque zero.
    #[inline]
    fn relief(&self, least_height: Real) -> Real {
        let least = self.length * least_height;
        let lowest = self.squares[0].min(self.squares[1]);
        let height = if lowest >= least * least { 1.0 } else { sqrt(lowest) / least };
        if self.length >= least_height { height } else { height * self.length / least_height }
    }

    /// Second derivative of the angle, by corners `[i][k]`.
    fn hessian(&self, x: &[Vec3; 4]) -> [[Mat3; 4]; 4] {
        let [a, b, c, d] = *x;
        let eh = self.along;
        let p = [self.normals[0] / self.squares[0], self.normals[1] / self.squares[1]];
        // d(N/|N|^2) = R dN.
        let turn = |p: Vec3, normal: Vec3, square: Real| (Mat3::IDENTITY - outer(p * 2.0, normal)) * (1.0 / square);
        let turned = [turn(p[0], self.normals[0], self.squares[0]), turn(p[1], self.normals[1], self.squares[1])];
        let normal = [
            [cross(c - b), cross(a - c), cross(b - a), Mat3::ZERO],
            [cross(b - d), cross(d - a), Mat3::ZERO, cross(a - b)],
        ];
        let [h1, h2] = [c, d].map(|far| {
            let to_far = far - a;
            (to_far - eh * to_far.dot(eh)) / self.length
        });
        // Derivatives of the weights: [triangle][corner][corner to derive by].
        let zero = Vec3::ZERO;
        let weight = [
            [[h1, eh - h1, -eh, zero], [-eh - h1, h1, eh, zero], [eh, -eh, zero, zero], [zero; 4]],
            [[h2, eh - h2, zero, -eh], [-eh - h2, h2, zero, eh], [zero; 4], [eh, -eh, zero, zero]],
        ];
        core::array::from_fn(|i| {
            core::array::from_fn(|k| {
                let part = |t: usize| {
                    outer(p.at(t), weight.at(t).at(i).at(k))
                        + turned.at(t) * normal.at(t).at(k) * self.weights.at(i).at(t)
                };
                part(0) + part(1)
            })
        })
    }
}

impl Hinges<'_> {
    /// `theta - theta0`, wrapped to (-pi, pi].
    #[inline]
    fn bent(&self, hinge: usize, angle: Real) -> Real {
        let bent = angle - self.rest_angles.at(hinge);
        let turn = 2.0 * PI as Real;
        if bent > PI as Real {
            bent - turn
        } else if bent <= -PI as Real {
            bent + turn
        } else {
            bent
        }
    }

    #[inline]
    fn damping(&self, hinge: usize) -> Real {
        self.damping.get(hinge).copied().unwrap_or(0.0)
    }

    /// The angle of one hinge, radians; 0 if the hinge has collapsed.
    pub fn angle(&self, hinge: usize, x: &[Vec3; 4]) -> Real {
        fold(x, self.least_heights.at(hinge)).map_or(0.0, |fold| fold.angle())
    }
}

impl Element<4> for Hinges<'_> {
    /// The scaled-down gradient times the square root of the scaled stiffness.
    type Tangent = [Vec3; 4];

    fn vertices(&self) -> &[[u32; 4]] {
        self.vertices
    }

    fn incidence(&self) -> Incidence<'_> {
        self.incidence
    }

    #[cfg_attr(small, inline)]
    #[cfg_attr(not(small), inline(always))]
    fn force(&self, hinge: usize, x: &[Vec3; 4], v: &[Vec3; 4]) -> [Vec3; 4] {
        let Some(fold) = fold(x, self.least_heights.at(hinge)) else { return [Vec3::ZERO; 4] };
        let gradient = fold.gradient();
        let relief = fold.relief(self.least_heights.at(hinge));
        let mut moment = self.stiffness.at(hinge) * self.bent(hinge, fold.angle());
        if !self.damping.is_empty() {
            let rate: Real = gradient.iter().zip(v).map(|(g, &v)| g.dot(v)).sum();
            moment += self.damping.at(hinge) * relief * rate;
        }
        gradient.map(|g| g * (-moment * relief))
    }

    fn energy(&self, hinge: usize, x: &[Vec3; 4]) -> Energy {
        let bent = self.bent(hinge, self.angle(hinge, x));
        Energy { bend: (0.5 * self.stiffness.at(hinge) * bent * bent).into(), ..Energy::default() }
    }

    #[inline]
    fn tangent(&self, hinge: usize, x: &[Vec3; 4], scale: TangentScale) -> [Vec3; 4] {
        let Some(fold) = fold(x, self.least_heights.at(hinge)) else { return [Vec3::ZERO; 4] };
        let stiffness = scale.position * self.stiffness.at(hinge) + scale.velocity * self.damping(hinge);
        let root = sqrt(stiffness) * fold.relief(self.least_heights.at(hinge));
        fold.gradient().map(|g| g * root)
    }

    #[inline]
    fn block(&self, _: usize, t: &[Vec3; 4], a: usize, b: usize) -> Mat3 {
        outer(t.at(a), t.at(b))
    }

    #[cfg_attr(small, optimize(size))]
    fn exact(&self, hinge: usize, x: &[Vec3; 4], v: &[Vec3; 4], scale: TangentScale) -> [[Mat3; 4]; 4] {
        let Some(fold) = fold(x, self.least_heights.at(hinge)) else { return [[Mat3::ZERO; 4]; 4] };
        let (gradient, hessian) = (fold.gradient(), fold.hessian(x));
        let (stiffness, damping) = (self.stiffness.at(hinge), self.damping(hinge));
        let rate: Real = gradient.iter().zip(v).map(|(g, &v)| g.dot(v)).sum();
        // d rate / dx at fixed velocities.
        let rate_gradient =
            hessian.map(|row| row.iter().zip(v).map(|(h, &v)| *h * v).fold(Vec3::ZERO, |sum, part| sum + part));
        let moment = stiffness * self.bent(hinge, fold.angle()) + damping * rate;
        core::array::from_fn(|i| {
            let (g, row) = (gradient.at(i), hessian.at(i));
            core::array::from_fn(|k| {
                outer(g * (scale.position * stiffness + scale.velocity * damping), gradient.at(k))
                    + outer(g * (scale.position * damping), rate_gradient.at(k))
                    + row.at(k) * (scale.position * moment)
            })
        })
    }
}

impl ElementTerm for Hinges<'_> {
    type Corners = [u32; 4];

    fn dissipates(&self) -> bool {
        !self.damping.is_empty()
    }

    fn material_bytes(&self) -> usize {
        [self.stiffness, self.rest_angles, self.least_heights, self.damping].map(size_of_val).iter().sum()
    }
}

/// The owned columns of [`Hinges`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct HingeColumns {
    /// Corners a, b, c, d.
    pub vertices: alloc::vec::Vec<[u32; 4]>,
    /// ke, N m per radian.
    pub stiffness: alloc::vec::Vec<Real>,
    /// theta0, radians.
    pub rest_angles: alloc::vec::Vec<Real>,
    /// A tenth of the rest length of the edge or of the smaller rest height over it, m.
    pub least_heights: alloc::vec::Vec<Real>,
    /// kd, N m s; empty if no hinge is damped.
    pub damping: alloc::vec::Vec<Real>,
    /// The hinge corners at each vertex.
    pub incidence: crate::mesh::IncidenceColumns,
}

#[cfg(feature = "alloc")]
impl HingeColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Hinges<'_> {
        Hinges {
            vertices: &self.vertices,
            stiffness: &self.stiffness,
            rest_angles: &self.rest_angles,
            least_heights: &self.least_heights,
            damping: &self.damping,
            incidence: self.incidence.view(),
        }
    }
}

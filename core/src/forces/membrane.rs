//! Stretch and shear of triangles: E = a/2 (ku (|wu| - 1)^2 + kv (|wv| - 1)^2 + ks (wu . wv)^2).
//! wu and wv are the derivatives of the position along warp and weft, and a is the rest area
//! [Baraff 1998; eqs. 3.3-3.8, with sqrt(a) in the constraint, so that the stiffness does not depend
//! on the mesh]. The projected Jacobian has a closed form [Kim 2020].

use super::element::{Element, ElementTerm};
use super::{Energy, TangentScale};
use crate::column::Column;
use crate::mesh::Incidence;
use crate::real::{DEGENERATE, Mat3, Real, Vec3, outer, scaled_identity, sqrt};

/// The in-plane material of a sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MembraneMaterial {
    /// Stretch stiffness along the warp, N/m.
    pub warp: Real,
    /// Stretch stiffness along the weft, N/m.
    pub weft: Real,
    /// Shear stiffness, N/m.
    pub shear: Real,
    /// Stiffness-proportional damping of stretch, s.
    pub stretch_damping: Real,
    /// Stiffness-proportional damping of shear, s.
    pub shear_damping: Real,
}

/// Triangles with a material.
#[derive(Clone, Copy, Debug)]
pub struct Membrane<'a> {
    /// Corners i, j, k.
    pub vertices: &'a [[u32; 3]],
    /// (pj, pk, qj, qk), 1/m: wu = pj (xj - xi) + pk (xk - xi) and wv = qj (xj - xi) + qk (xk - xi).
    pub weights: &'a [[Real; 4]],
    /// Rest area, m^2.
    pub areas: &'a [Real],
    /// Index into `table`.
    pub materials: &'a [u16],
    /// The materials.
    pub table: &'a [MembraneMaterial],
    /// The triangle corners at each vertex.
    pub incidence: Incidence<'a>,
}

/// The columns (wu, wv) of the deformation gradient. Applied to velocities, it gives their rates.
#[inline]
fn gradient(w: &[Real; 4], x: &[Vec3; 3]) -> (Vec3, Vec3) {
    let (d1, d2) = (x[1] - x[0], x[2] - x[0]);
    (d1 * w[0] + d2 * w[1], d1 * w[2] + d2 * w[3])
}

/// Length and direction of a column of the deformation gradient. The direction is zero if it has collapsed.
#[inline]
fn direction(w: Vec3) -> (Real, Vec3) {
    let length = sqrt(w.length_squared());
    (length, if length > DEGENERATE { w / length } else { Vec3::ZERO })
}

/// Derivatives of wu and wv by the position of corner `m`.
#[inline]
fn corner(w: &[Real; 4], m: usize) -> (Real, Real) {
    match m {
        0 => (-w[0] - w[1], -w[2] - w[3]),
        1 => (w[0], w[2]),
        _ => (w[1], w[3]),
    }
}

/// Second derivative of the stretch energy by one column of the deformation gradient, plus damping.
/// The transverse eigenvalue k (1 - 1/|w|) is negative under compression unless projected.
#[inline]
fn stretch_block(w: Vec3, k: Real, damping: Real, projected: bool) -> Mat3 {
    let (length, h) = direction(w);
    if h == Vec3::ZERO {
        return scaled_identity(k);
    }
    let across = k * (1.0 - 1.0 / length);
    let across = if projected { across.max(0.0) } else { across };
    scaled_identity(across) + outer(h * (k - across + damping), h)
}

/// Adds the projected second derivative k (I6 S + g g^T) of the shear energy to the blocks uu, uv, vv.
/// Here g = (wv; wu), S swaps the two, and I6 = wu . wv [Kim 2020].
#[inline]
fn add_projected_shear(blocks: &mut [Mat3; 3], wu: Vec3, wv: Vec3, k: Real) {
    let i6 = wu.dot(wv);
    let i2 = wu.length_squared() + wv.length_squared();
    let largest = 0.5 * (i2 + sqrt(i2 * i2 + 12.0 * i6 * i6));
    let sign = if i6 < 0.0 { -1.0 } else { 1.0 };
    // The eigenvector of the largest eigenvalue, not normalised.
    let (qu, qv) = (wu * i6 + wv * largest, wv * i6 + wu * largest);
    let square = qu.length_squared() + qv.length_squared();
    if square <= Real::MIN_POSITIVE {
        return;
    }
    let scale = k * largest / square;
    blocks[0] += outer(qu * scale, qu);
    blocks[1] += outer(qu * scale, qv);
    blocks[2] += outer(qv * scale, qv);
    // |I6| (T - t t^T / |t|^2) with T = (I + sign S)/2 and t = T q.
    let t = (qu + qv * sign) * 0.5;
    let t_square = 2.0 * t.length_squared();
    let weight = k * i6.abs();
    let mut rest = scaled_identity(0.5 * weight);
    if t_square > Real::EPSILON * square {
        rest -= outer(t * (weight / t_square), t);
    }
    blocks[0] += rest;
    blocks[1] += rest * sign;
    blocks[2] += rest;
}

impl Membrane<'_> {
    #[inline]
    fn material(&self, triangle: usize) -> MembraneMaterial {
        self.table.at(self.materials.at(triangle) as usize)
    }

    /// Blocks (uu, uv, vv) of the exact second derivative of the energy by (wu; wv), without damping.
    fn exact_blocks(&self, triangle: usize, wu: Vec3, wv: Vec3) -> [Mat3; 3] {
        let m = self.material(triangle);
        [
            stretch_block(wu, m.warp, 0.0, false) + outer(wv * m.shear, wv),
            scaled_identity(m.shear * wu.dot(wv)) + outer(wv * m.shear, wu),
            stretch_block(wv, m.weft, 0.0, false) + outer(wu * m.shear, wu),
        ]
    }

    /// Blocks (uu, uv, vv) of the second derivative of the dissipation by the rates of (wu; wv).
    fn damping_blocks(&self, triangle: usize, wu: Vec3, wv: Vec3) -> [Mat3; 3] {
        let m = self.material(triangle);
        let (hu, hv) = (direction(wu).1, direction(wv).1);
        let (du, dv, ds) = (m.stretch_damping * m.warp, m.stretch_damping * m.weft, m.shear_damping * m.shear);
        [outer(hu * du, hu) + outer(wv * ds, wv), outer(wv * ds, wu), outer(hv * dv, hv) + outer(wu * ds, wu)]
    }

    /// Derivative of the damping stress by (wu; wv) at fixed rates, by `[row][column]`. It is not
    /// symmetric.
    fn damping_turn(&self, triangle: usize, w: [Vec3; 2], rate: [Vec3; 2]) -> [[Mat3; 2]; 2] {
        let m = self.material(triangle);
        let stretch = |w: Vec3, rate: Vec3, k: Real| {
            // Derivative of k (h . rate) h by w.
            let (length, h) = direction(w);
            if h == Vec3::ZERO {
                return Mat3::ZERO;
            }
            let project = Mat3::IDENTITY - outer(h, h);
            (project * h.dot(rate) + outer(h, project * rate)) * (k / length)
        };
        let ds = m.shear_damping * m.shear;
        let shear_rate = ds * (rate[0].dot(w[1]) + w[0].dot(rate[1]));
        [
            [
                stretch(w[0], rate[0], m.stretch_damping * m.warp) + outer(w[1] * ds, rate[1]),
                scaled_identity(shear_rate) + outer(w[1] * ds, rate[0]),
            ],
            [
                scaled_identity(shear_rate) + outer(w[0] * ds, rate[1]),
                stretch(w[1], rate[1], m.stretch_damping * m.weft) + outer(w[0] * ds, rate[0]),
            ],
        ]
    }
}

impl Element<3> for Membrane<'_> {
    /// The blocks uu, uv, vv of the second derivative by (wu; wv).
    type Tangent = [Mat3; 3];

    fn vertices(&self) -> &[[u32; 3]] {
        self.vertices
    }

    fn incidence(&self) -> Incidence<'_> {
        self.incidence
    }

    #[cfg_attr(small, inline)]
    #[cfg_attr(not(small), inline(always))]
    fn force(&self, triangle: usize, x: &[Vec3; 3], v: &[Vec3; 3]) -> [Vec3; 3] {
        let (m, w, area) = (self.material(triangle), self.weights.at(triangle), self.areas.at(triangle));
        let (wu, wv) = gradient(&w, x);
        let ((lu, hu), (lv, hv)) = (direction(wu), direction(wv));
        let shear = m.shear * wu.dot(wv);
        let mut tu = hu * (m.warp * (lu - 1.0)) + wv * shear;
        let mut tv = hv * (m.weft * (lv - 1.0)) + wu * shear;
        if m.stretch_damping > 0.0 || m.shear_damping > 0.0 {
            let (ru, rv) = gradient(&w, v);
            let shear = m.shear_damping * m.shear * (ru.dot(wv) + wu.dot(rv));
            tu += hu * (m.stretch_damping * m.warp * hu.dot(ru)) + wv * shear;
            tv += hv * (m.stretch_damping * m.weft * hv.dot(rv)) + wu * shear;
        }
        let f1 = (tu * w[0] + tv * w[2]) * -area;
        let f2 = (tu * w[1] + tv * w[3]) * -area;
        [-(f1 + f2), f1, f2]
    }

    fn energy(&self, triangle: usize, x: &[Vec3; 3]) -> Energy {
        let (m, area) = (self.material(triangle), self.areas.at(triangle));
        let (wu, wv) = gradient(&self.weights.at(triangle), x);
        let square = |x: Real| x * x;
        let stretch = m.warp * square(direction(wu).0 - 1.0) + m.weft * square(direction(wv).0 - 1.0);
        let shear = m.shear * square(wu.dot(wv));
        Energy { stretch: (0.5 * area * stretch).into(), shear: (0.5 * area * shear).into(), ..Energy::default() }
    }

    #[inline]
    fn tangent(&self, triangle: usize, x: &[Vec3; 3], scale: TangentScale) -> [Mat3; 3] {
        let (m, area) = (self.material(triangle), self.areas.at(triangle));
        let (wu, wv) = gradient(&self.weights.at(triangle), x);
        let position = scale.position * area;
        let damping = scale.velocity * area * m.stretch_damping;
        let mut blocks = [
            stretch_block(wu, position * m.warp, damping * m.warp, true),
            Mat3::ZERO,
            stretch_block(wv, position * m.weft, damping * m.weft, true),
        ];
        if m.shear > 0.0 {
            add_projected_shear(&mut blocks, wu, wv, position * m.shear);
            let ds = scale.velocity * area * m.shear_damping * m.shear;
            if ds > 0.0 {
                blocks[0] += outer(wv * ds, wv);
                blocks[1] += outer(wv * ds, wu);
                blocks[2] += outer(wu * ds, wu);
            }
        }
        blocks
    }

    #[inline]
    fn block(&self, triangle: usize, t: &[Mat3; 3], a: usize, b: usize) -> Mat3 {
        let Some(w) = self.weights.element(triangle) else { return Mat3::ZERO };
        let ((pa, qa), (pb, qb)) = (corner(w, a), corner(w, b));
        t[0] * (pa * pb) + t[1] * (pa * qb) + t[1].transpose() * (qa * pb) + t[2] * (qa * qb)
    }

    #[cfg_attr(small, optimize(size))]
    fn exact(&self, triangle: usize, x: &[Vec3; 3], v: &[Vec3; 3], scale: TangentScale) -> [[Mat3; 3]; 3] {
        let (w, area) = (self.weights.at(triangle), self.areas.at(triangle));
        let ((wu, wv), (ru, rv)) = (gradient(&w, x), gradient(&w, v));
        let [uu, uv, vv] = self.exact_blocks(triangle, wu, wv);
        let [cuu, cuv, cvv] = self.damping_blocks(triangle, wu, wv);
        let [[tuu, tuv], [tvu, tvv]] = self.damping_turn(triangle, [wu, wv], [ru, rv]);
        let by_gradient = |elastic: Mat3, turn: Mat3, damping: Mat3| {
            ((elastic + turn) * scale.position + damping * scale.velocity) * area
        };
        let (uu, vv) = (by_gradient(uu, tuu, cuu), by_gradient(vv, tvv, cvv));
        let vu = by_gradient(uv.transpose(), tvu, cuv.transpose());
        let uv = by_gradient(uv, tuv, cuv);
        core::array::from_fn(|a| {
            core::array::from_fn(|b| {
                let ((pa, qa), (pb, qb)) = (corner(&w, a), corner(&w, b));
                uu * (pa * pb) + uv * (pa * qb) + vu * (qa * pb) + vv * (qa * qb)
            })
        })
    }
}

impl ElementTerm for Membrane<'_> {
    type Corners = [u32; 3];

    fn dissipates(&self) -> bool {
        self.table.iter().any(|m| m.stretch_damping > 0.0 || m.shear_damping > 0.0)
    }

    /// The largest rate of change of wu or wv, 1/s.
    fn strain_rate(&self, v: &[Vec3]) -> Real {
        let squares = self.vertices.iter().zip(self.weights).map(|(triangle, w)| {
            let (u, v) = gradient(w, &v.gather(triangle));
            u.length_squared().max(v.length_squared())
        });
        sqrt(squares.fold(0.0, Real::max))
    }

    /// The largest rate of change of |wu|, |wv| or wu . wv, 1/s.
    fn stretch_rate(&self, x: &[Vec3], v: &[Vec3]) -> Real {
        let rates = self.vertices.iter().zip(self.weights).map(|(triangle, w)| {
            let (wu, wv) = gradient(w, &x.gather(triangle));
            let (du, dv) = gradient(w, &v.gather(triangle));
            wu.dot(du).abs().max(wv.dot(dv).abs()).max((wu.dot(dv) + wv.dot(du)).abs())
        });
        rates.fold(0.0, Real::max)
    }

    /// The table of materials is not counted.
    fn material_bytes(&self) -> usize {
        size_of_val(self.weights) + size_of_val(self.areas) + size_of_val(self.materials)
    }
}

/// The owned columns of [`Membrane`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct MembraneColumns {
    /// Corners i, j, k.
    pub vertices: alloc::vec::Vec<[u32; 3]>,
    /// (pj, pk, qj, qk), 1/m.
    pub weights: alloc::vec::Vec<[Real; 4]>,
    /// Rest area, m^2.
    pub areas: alloc::vec::Vec<Real>,
    /// Index into `table`.
    pub materials: alloc::vec::Vec<u16>,
    /// The materials.
    pub table: alloc::vec::Vec<MembraneMaterial>,
    /// The triangle corners at each vertex.
    pub incidence: crate::mesh::IncidenceColumns,
}

#[cfg(feature = "alloc")]
impl MembraneColumns {
    /// The borrowed view that kernels take.
    pub fn view(&self) -> Membrane<'_> {
        Membrane {
            vertices: &self.vertices,
            weights: &self.weights,
            areas: &self.areas,
            materials: &self.materials,
            table: &self.table,
            incidence: self.incidence.view(),
        }
    }
}

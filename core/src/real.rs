//! The floating-point precision of the crate. No other file depends on it.
//!
//! `muslin-core` computes in f32; `muslin-core-f64` compiles the same sources for f64. All
//! transcendental functions come from libm, so that every machine gives the same bits.

#[cfg(not(double))]
mod precision {
    /// The scalar of every column.
    pub type Real = f32;
    /// Three scalars: a position, a velocity, a force.
    pub type Vec3 = glam::Vec3;
    /// Nine scalars, stored by columns: one block of a Jacobian.
    pub type Mat3 = glam::Mat3;
    /// Four scalars in one SIMD vector.
    pub type Lanes = wide::f32x4;

    /// An unsigned integer as wide as the scalar.
    pub type Bits = u32;

    pub use libm::{atan2f as atan2, expf as exp};

    pub(super) use libm::sqrtf as libm_sqrt;

    /// Rounds to the nearest f32.
    #[inline]
    pub fn to_f32(x: Real) -> f32 {
        x
    }
}

#[cfg(double)]
mod precision {
    /// The scalar of every column.
    pub type Real = f64;
    /// Three scalars: a position, a velocity, a force.
    pub type Vec3 = glam::DVec3;
    /// Nine scalars, stored by columns: one block of a Jacobian.
    pub type Mat3 = glam::DMat3;
    /// Four scalars in one SIMD vector.
    pub type Lanes = wide::f64x4;

    /// An unsigned integer as wide as the scalar.
    pub type Bits = u64;

    pub use libm::{atan2, exp};

    pub(super) use libm::sqrt as libm_sqrt;

    /// Rounds to the nearest f32.
    #[inline]
    pub fn to_f32(x: Real) -> f32 {
        x as f32
    }
}

pub use precision::*;

/// A truth value as wide as the scalar, for structs without padding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Flag(Bits);

impl From<bool> for Flag {
    fn from(is_set: bool) -> Self {
        Self(is_set.into())
    }
}

impl Flag {
    /// Whether it is set.
    pub fn is_set(self) -> bool {
        self.0 != 0
    }
}

/// Square root, rounded correctly. That of libm is assembly on x86, in which code for AVX stalls.
#[inline]
pub fn sqrt(x: Real) -> Real {
    if cfg!(target_feature = "sse2") { Lanes::splat(x).sqrt().to_array()[0] } else { libm_sqrt(x) }
}

/// The scalar of sums over many elements (energies, inner products between blocks). It is double in
/// both precisions: this costs little, and in single precision these sums would round the most.
pub type Sum = f64;

/// Four sums in one SIMD vector.
pub type SumLanes = wide::f64x4;

/// A length below this fraction of its rest size counts as zero: it has no direction and gives no force.
pub const DEGENERATE: Real = 1e-6;

/// Whether forces see the rounding errors of positions. In double these are too small to strain any cloth.
pub const SEES_ROUNDING: bool = size_of::<Real>() == 4;

/// The name of the precision in scenes and summaries.
pub const NAME: &str = if size_of::<Real>() == 4 { "f32" } else { "f64" };

/// Converts three doubles to a vector, rounded to the crate's precision.
#[inline]
pub fn vec3(v: [f64; 3]) -> Vec3 {
    Vec3::new(v[0] as Real, v[1] as Real, v[2] as Real)
}

/// Converts a vector to three doubles, without rounding.
#[inline]
pub fn to_f64(v: Vec3) -> [f64; 3] {
    [v.x as f64, v.y as f64, v.z as f64]
}

/// The rounding error `a + b - sum` of a sum, exact for every order of their sizes [Knuth 1998, 4.2.2].
#[inline]
pub fn rounding_error(a: Vec3, b: Vec3, sum: Vec3) -> Vec3 {
    let of_b = sum - a;
    (a - (sum - of_b)) + (b - of_b)
}

/// Inner product, computed in double.
#[inline]
pub fn dot_sum(a: Vec3, b: Vec3) -> Sum {
    a.x as Sum * b.x as Sum + a.y as Sum * b.y as Sum + a.z as Sum * b.z as Sum
}

/// The components of a vector, padded with a zero.
#[inline(always)]
pub fn lanes(v: Vec3) -> Lanes {
    Lanes::new([v.x, v.y, v.z, 0.0])
}

/// `a b^T`.
#[inline]
pub fn outer(a: Vec3, b: Vec3) -> Mat3 {
    Mat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// The matrix with `cross(a) b = a x b`.
#[inline]
pub fn cross(a: Vec3) -> Mat3 {
    Mat3::from_cols(Vec3::new(0.0, a.z, -a.y), Vec3::new(-a.z, 0.0, a.x), Vec3::new(a.y, -a.x, 0.0))
}

/// `s I`.
#[inline]
pub fn scaled_identity(s: Real) -> Mat3 {
    Mat3::from_diagonal(Vec3::splat(s))
}

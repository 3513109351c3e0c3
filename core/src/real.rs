//! The precision of the crate: the only file that knows it.
//!
//! `muslin-core` computes in f32, `muslin-core-f64` compiles the same sources in f64. All
//! transcendental functions come from libm, so that every machine gives the same bits.

#[cfg(not(double))]
mod precision {
    /// The scalar of every column.
    pub type Real = f32;
    /// Three scalars: a position, a velocity, a force.
    pub type Vec3 = glam::Vec3;
    /// Nine scalars in columns: one block of a Jacobian.
    pub type Mat3 = glam::Mat3;
    /// Four scalars that are multiplied and added at once.
    pub type Lanes = wide::f32x4;

    pub use libm::{atan2f as atan2, cosf as cos, expf as exp, sinf as sin, sqrtf as sqrt};

    /// The nearest f32.
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
    /// Nine scalars in columns: one block of a Jacobian.
    pub type Mat3 = glam::DMat3;
    /// Four scalars that are multiplied and added at once.
    pub type Lanes = wide::f64x4;

    pub use libm::{atan2, cos, exp, sin, sqrt};

    /// The nearest f32.
    #[inline]
    pub fn to_f32(x: Real) -> f32 {
        x as f32
    }
}

pub use precision::*;

/// Sums over many elements (energies, inner products between blocks) are carried in double in
/// both precisions: they cost little and would otherwise be the first thing to round.
pub type Sum = f64;

/// Four sums that are multiplied and added at once.
pub type SumLanes = wide::f64x4;

/// Below this fraction of its rest size a length counts as zero: direction unknown, no force.
pub const DEGENERATE: Real = 1e-6;

/// The precision's name, as scenes and summaries spell it.
pub const NAME: &str = if size_of::<Real>() == 4 { "f32" } else { "f64" };

/// A vector from three doubles, rounded to the crate's precision.
#[inline]
pub fn vec3(v: [f64; 3]) -> Vec3 {
    Vec3::new(v[0] as Real, v[1] as Real, v[2] as Real)
}

/// A vector as three doubles, exactly.
#[inline]
pub fn to_f64(v: Vec3) -> [f64; 3] {
    [v.x as f64, v.y as f64, v.z as f64]
}

/// Inner product carried in double.
#[inline]
pub fn dot_sum(a: Vec3, b: Vec3) -> Sum {
    a.x as Sum * b.x as Sum + a.y as Sum * b.y as Sum + a.z as Sum * b.z as Sum
}

/// The components of a vector, and a zero.
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

//! Four vectors at a time, one in each lane. Each lane has the bits that `Vec3` would give, also with NaN and with
//! zeros of either sign. The minima and maxima of `wide` are not used for them, because they depend on the machine.

use core::ops::{Add, Mul, Sub};

use crate::real::{Lanes, Real, Vec3, lanes};

/// Four vectors, one in each lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vec3x4 {
    x: Lanes,
    y: Lanes,
    z: Lanes,
}

impl Vec3x4 {
    /// One vector for each lane.
    #[inline(always)]
    pub fn new([a, b, c, d]: [Vec3; 4]) -> Self {
        let [x, y, z, _] = Lanes::transpose([lanes(a), lanes(b), lanes(c), lanes(d)]);
        Self { x, y, z }
    }

    /// The same vector in all lanes.
    #[inline(always)]
    pub fn splat(v: Vec3) -> Self {
        Self { x: Lanes::splat(v.x), y: Lanes::splat(v.y), z: Lanes::splat(v.z) }
    }

    /// Each of four vectors in all lanes.
    #[cfg_attr(small, inline(never))]
    #[cfg_attr(not(small), inline(always))]
    pub fn splats(&[a, b, c, d]: &[Vec3; 4]) -> [Self; 4] {
        [Self::splat(a), Self::splat(b), Self::splat(c), Self::splat(d)]
    }

    /// `self . other`.
    #[inline(always)]
    pub fn dot(self, other: Self) -> Lanes {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// `|self|^2`.
    #[inline(always)]
    pub fn length_squared(self) -> Lanes {
        self.dot(self)
    }

    /// The absolute values of the components.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self { x: self.x.abs(), y: self.y.abs(), z: self.z.abs() }
    }

    /// The [lesser] of each component.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self { x: lesser(self.x, other.x), y: lesser(self.y, other.y), z: lesser(self.z, other.z) }
    }

    /// The [greater] of each component.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self { x: greater(self.x, other.x), y: greater(self.y, other.y), z: greater(self.z, other.z) }
    }

    /// The largest component.
    #[inline(always)]
    pub fn max_element(self) -> Lanes {
        greater(self.x, greater(self.y, self.z))
    }

    /// The sum of the components.
    #[inline(always)]
    pub fn element_sum(self) -> Lanes {
        self.x + self.y + self.z
    }
}

impl Add for Vec3x4 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Vec3x4 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Mul<Lanes> for Vec3x4 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, by: Lanes) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }
}

/// The first lane.
#[inline(always)]
pub fn first(a: Lanes) -> Real {
    a.to_array()[0]
}

/// `f` of each lane of `a` and `b`. The compiler makes one instruction of the choices below.
#[inline(always)]
fn each(a: Lanes, b: Lanes, f: impl Fn(Real, Real) -> Real) -> Lanes {
    let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (a.to_array(), b.to_array());
    Lanes::new([f(a0, b0), f(a1, b1), f(a2, b2), f(a3, b3)])
}

/// The lesser of `a` and `b`; `b` if they are equal or one is NaN, as in the minimum of two [`Vec3`].
#[inline(always)]
pub fn lesser(a: Lanes, b: Lanes) -> Lanes {
    // That of WebAssembly chooses its first operand then, and `each` is long there.
    if cfg!(target_feature = "simd128") { b.fast_min(a) } else { each(a, b, |a, b| if a < b { a } else { b }) }
}

/// The greater of `a` and `b`; `b` if they are equal or one is NaN, as in the maximum of two [`Vec3`].
#[inline(always)]
pub fn greater(a: Lanes, b: Lanes) -> Lanes {
    if cfg!(target_feature = "simd128") { b.fast_max(a) } else { each(a, b, |a, b| if a > b { a } else { b }) }
}

/// The lesser of `a` and `b`; the other one if one is NaN, as in `Real::min`.
#[inline(always)]
pub fn min(a: Lanes, b: Lanes) -> Lanes {
    a.is_nan().bitselect(b, lesser(b, a))
}

/// The greater of `a` and `b`; the other one if one is NaN, as in `Real::max`.
#[inline(always)]
pub fn max(a: Lanes, b: Lanes) -> Lanes {
    a.is_nan().bitselect(b, greater(b, a))
}

/// `Real::clamp` of each lane to [0, 1].
#[inline(always)]
pub fn clamp_to_unit(a: Lanes) -> Lanes {
    lesser(Lanes::ONE, greater(Lanes::ZERO, a))
}

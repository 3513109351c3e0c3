//! Random numbers that are the same on every machine [Steele 2014, SplitMix64].

use glam::{DMat3, DVec3};

/// A generator; equal seeds give equal numbers.
#[derive(Clone, Debug)]
pub struct Rng<'a> {
    state: u64,
    bytes: &'a [u8],
}

impl<'a> Rng<'a> {
    /// Starts a sequence.
    pub const fn new(seed: u64) -> Self {
        Self { state: seed, bytes: &[] }
    }

    /// A sequence in which each number depends on one byte, and then on the place alone.
    pub const fn of(bytes: &'a [u8]) -> Self {
        Self { state: 0, bytes }
    }

    /// Number of bytes that are left.
    pub const fn left(&self) -> usize {
        self.bytes.len()
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        if let Some((&byte, rest)) = self.bytes.split_first() {
            self.bytes = rest;
            return Self::new(byte.into()).bits();
        }
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * unit
    }

    /// Uniform in the logarithm: every magnitude is equally likely.
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// Picks one element of a slice.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[(self.bits() % from.len() as u64) as usize]
    }

    /// Uniform in a cube about the origin.
    pub fn cube(&mut self, half: f64) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| self.between(-half, half)))
    }

    /// A unit vector.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.cube(1.0);
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// A rotation about a random axis.
    pub fn rotation(&mut self) -> DMat3 {
        DMat3::from_axis_angle(self.direction(), self.between(-3.2, 3.2))
    }
}

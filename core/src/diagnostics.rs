//! Diagnostics of a state: energies, momentum, stretch, the first particle that is not finite, the
//! force term that pulls it hardest, and a hash of the bits.

use glam::DVec3;

use crate::column::Column;
use crate::dispatch::Dispatch;
use crate::forces::{self, Energy, Model};
use crate::particles::Positions;
use crate::real::{Real, Sum, Vec3, dot_sum, sqrt, to_f64};
use crate::stage::Term;

/// All energies of a state, J.
pub fn energy(model: &Model<'_>, masses: &[Real], x: Positions<'_>, v: &[Vec3]) -> Energy {
    let kinetic = masses.iter().zip(v).map(|(&m, &v)| 0.5 * Sum::from(m) * dot_sum(v, v)).sum();
    Energy { kinetic, ..forces::energy(model, masses, x) }
}

/// Linear momentum, kg m/s.
pub fn momentum(masses: &[Real], v: &[Vec3]) -> [Sum; 3] {
    let mut sum = [0.0; 3];
    for (&m, &v) in masses.iter().zip(v) {
        for (sum, v) in sum.iter_mut().zip(to_f64(v)) {
            *sum += Sum::from(m) * v;
        }
    }
    sum
}

/// Angular momentum about the origin of the positions, kg m^2/s.
pub fn angular_momentum(masses: &[Real], x: &[Vec3], v: &[Vec3]) -> DVec3 {
    let of_particle =
        |((&m, &x), &v): ((&Real, &Vec3), &Vec3)| DVec3::from(to_f64(x)).cross(to_f64(v).into()) * Sum::from(m);
    masses.iter().zip(x).zip(v).map(of_particle).sum()
}

/// Ratio of length to rest length over all edges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stretch {
    /// The largest ratio.
    pub max: Sum,
    /// The mean ratio.
    pub mean: Sum,
}

/// Size of the box around positions along each axis, m.
pub fn extent(positions: impl Iterator<Item = [Sum; 3]>) -> [Sum; 3] {
    let (mut low, mut high) = ([Sum::INFINITY; 3], [Sum::NEG_INFINITY; 3]);
    for p in positions {
        for ((low, high), p) in low.iter_mut().zip(&mut high).zip(p) {
            *low = low.min(p);
            *high = high.max(p);
        }
    }
    [0, 1, 2].map(|axis| high.at(axis) - low.at(axis))
}

/// Stretch of edges. `rest` are their rest lengths, m.
pub fn stretch(edges: &[[u32; 2]], rest: &[Real], x: &[Vec3]) -> Stretch {
    let mut stretch = Stretch::default();
    for (&[a, b], &rest) in edges.iter().zip(rest) {
        let d = x.at(b as usize) - x.at(a as usize);
        let ratio = Sum::from(sqrt(d.length_squared()) / rest);
        stretch.max = stretch.max.max(ratio);
        stretch.mean += ratio / edges.len() as Sum;
    }
    stretch
}

/// The first particle whose position, or velocity, is NaN or infinite. `v` gives the velocity of a particle.
pub fn first_non_finite(x: &[Vec3], v: impl Fn(usize) -> Vec3) -> Option<u32> {
    // Zero times a finite number is zero, so one sum checks all. Only if it is not zero, search.
    let all = x.iter().enumerate().fold(Vec3::ZERO, |sum, (i, &x)| sum + x * 0.0 + v(i) * 0.0);
    if all == Vec3::ZERO {
        return None;
    }
    x.iter().enumerate().position(|(i, x)| !(x.is_finite() && v(i).is_finite())).map(|i| i as u32)
}

/// The term with the largest force on a particle, for the report of a divergence. Overwrites `scratch`
/// and `f`.
pub fn hardest_term(
    model: &Model<'_>,
    masses: &[Real],
    x: &[Vec3],
    v: &[Vec3],
    particle: u32,
    scratch: &mut [Vec3],
    f: &mut [Vec3],
    dispatch: &impl Dispatch,
) -> Option<Term> {
    let mut hardest: Option<(Term, Real)> = None;
    for term in Term::ALL {
        let Some(alone) = model.only(term) else { continue };
        forces::evaluate(&alone, masses, x.into(), v, scratch, f, dispatch);
        let pull = f.at(particle as usize);
        // Compare components and not squares, because squares overflow first.
        let size = if pull.is_finite() { pull.abs().max_element() } else { Real::INFINITY };
        if hardest.is_none_or(|(_, most)| size > most) {
            hardest = Some((term, size));
        }
    }
    hardest.map(|(term, _)| term)
}

/// FNV-1a hash over the bits of positions and velocities, chained over steps. Two runs with the same
/// hash went through the same states; the first step with different hashes is the first whose states
/// differ.
///
/// It hashes whole scalars in four interleaved streams to keep the cost per step low. Negative zero
/// counts as zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateHash(pub u64);

impl Default for StateHash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl StateHash {
    /// Adds a state to the chain.
    pub fn add(&mut self, x: &[Vec3], v: &[Vec3]) {
        let mut streams = [self.0, !self.0, self.0.rotate_left(21), self.0.rotate_left(42)];
        for column in [x, v] {
            let (fours, rest) = bytemuck::cast_slice::<Vec3, Real>(column).as_chunks::<4>();
            for four in fours {
                for (stream, scalar) in streams.iter_mut().zip(four) {
                    *stream = mix(*stream, scalar_bits(*scalar));
                }
            }
            for scalar in rest {
                streams[0] = mix(streams[0], scalar_bits(*scalar));
            }
        }
        self.0 = streams.into_iter().fold(self.0, mix);
    }
}

/// One round of FNV-1a over a whole word. The shift copies high bits, such as signs, to low positions,
/// from which the next product spreads them.
fn mix(hash: u64, bits: u64) -> u64 {
    let product = (hash ^ bits).wrapping_mul(0x0000_0100_0000_01b3);
    product ^ product >> 32
}

fn scalar_bits(scalar: Real) -> u64 {
    // -0.0 + 0.0 is 0.0.
    (scalar + 0.0).to_bits().into()
}

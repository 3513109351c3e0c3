//! Projected Jacobians of single elements: no state of an element has a direction of negative curvature.

use glam::{DMat3, DVec3};
use muslin_core_f64::forces::TangentScale;
use muslin_core_f64::forces::element::Element;
use muslin_core_f64::forces::spring::{self, Spring};
use muslin_core_f64::scene::BuiltScene;

use super::check::Check;
use super::lab::{self, Miss};

/// Description in the report.
pub const ABOUT: &str = "random states of single elements, stretched, compressed, sheared and folded, with and without \
                         damping: those whose projected block has an eigenvalue below -1e-12 of its largest entry";

/// Number of states of springs and triangles, and of hinges.
const STATES: usize = 400_000;
const FOLDS: usize = 200_000;

/// Tolerated negative eigenvalue, as a part of the largest entry on the diagonal.
const ROUNDING: f64 = 1e-12;

/// All checks.
pub fn checks() -> Vec<Check> {
    let none = |name: &str, count: fn() -> Result<usize, Miss>| {
        Check::absolute(name, 0.0, 0.0, move |_| Ok(count()? as f64)).in_unit("states")
    };
    vec![
        none("springs, of 400,000", springs),
        none("membrane triangles, of 400,000", || {
            let built = sheet(
                "stretch = { model = \"membrane\", stiffness = 50.0, weft = 30.0, damping = 0.1 }\n\
                               shear = { stiffness = 20.0, damping = 0.1 }",
            )?;
            let membrane = built.model.view().membrane.ok_or_else(|| Miss::Why("no membrane".into()))?;
            Ok(indefinite::<3, 9>(&membrane, &built, STATES))
        }),
        none("hinges, of 200,000", || {
            let built = sheet("bend = { model = \"hinge\", rigidity = 0.01, damping = 0.1 }")?;
            let hinges = built.model.view().hinges.ok_or_else(|| Miss::Why("no hinges".into()))?;
            Ok(indefinite::<4, 12>(&hinges, &built, FOLDS))
        }),
    ]
}

fn sheet(material: &str) -> Result<BuiltScene, Miss> {
    let grid = "grid = { size = [3.0, 2.6], cells = [3, 3] }";
    lab::columns(&format!("name = \"states\"\nduration = 0\n[[cloth]]\n{grid}\ndensity = 1.0\n{material}"), &[])
}

/// Pseudo-random numbers in -1..1 [Steele 2014], the same on every machine.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }

    /// A size between a thousandth of `most` and `most`, uniform in its logarithm.
    fn size(&mut self, most: f64) -> f64 {
        most * 10f64.powf(1.5 * (self.next() - 1.0))
    }

    /// The scale of an implicit stage: without or with damping.
    fn scale(&mut self) -> TangentScale {
        let velocity = if self.next() < 0.0 { 0.0 } else { 0.5 * (1.0 + self.next()) };
        TangentScale { position: 1.0, velocity }
    }
}

fn springs() -> Result<usize, Miss> {
    let mut noise = Noise(1);
    let count = (0..STATES).filter(|_| {
        let d = noise.vector().normalize_or(DVec3::X) * noise.size(3.0);
        let spring = Spring { rest: 1.0, stiffness: noise.size(1e4), damping: noise.size(1e4) };
        is_indefinite::<1, 3>(&[[spring::tangent(d, &spring, noise.scale())]])
    });
    Ok(count.count())
}

/// The number of indefinite matrices in `states` random states: elements are scaled and their corners are displaced
/// at random.
fn indefinite<const K: usize, const N: usize>(term: &impl Element<K>, built: &BuiltScene, states: usize) -> usize {
    let (rest, mut noise) = (&built.particles.positions, Noise(2));
    let count = (0..states).filter(|state| {
        let element = state % term.vertices().len();
        let (size, strewn) = (noise.size(3.0), noise.size(2.0));
        let x = term.vertices()[element].map(|corner| rest[corner as usize] * size + noise.vector() * strewn);
        let tangent = term.tangent(element, &x, noise.scale());
        let blocks: [[DMat3; K]; K] =
            std::array::from_fn(|a| std::array::from_fn(|b| term.block(element, &tangent, a, b)));
        is_indefinite::<K, N>(&blocks)
    });
    count.count()
}

/// Whether the matrix, shifted by its rounding, has no Cholesky factors; a matrix with NaN has no factors.
fn is_indefinite<const K: usize, const N: usize>(blocks: &[[DMat3; K]; K]) -> bool {
    let mut l: [[f64; N]; N] = std::array::from_fn(|r| std::array::from_fn(|c| blocks[r / 3][c / 3].col(c % 3)[r % 3]));
    let shift = ROUNDING * (0..N).map(|i| l[i][i]).fold(f64::MIN_POSITIVE, f64::max);
    for j in 0..N {
        let pivot = l[j][j] + shift - l[j][..j].iter().map(|x| x * x).sum::<f64>();
        if pivot.is_nan() || pivot <= 0.0 {
            return true;
        }
        l[j][j] = pivot.sqrt();
        for i in j + 1..N {
            let dot: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            l[i][j] = (l[i][j] - dot) / l[j][j];
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_indefinite_is_seen() {
        let turn = DMat3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7);
        let of = |last: f64| [[turn * DMat3::from_diagonal(DVec3::new(5.0, 1.0, last)) * turn.transpose()]];
        for (last, indefinite) in [(1.0, false), (0.0, false), (-1e-10, true), (-1.0, true), (f64::NAN, true)] {
            assert_eq!(is_indefinite::<1, 3>(&of(last)), indefinite, "{last}");
        }
    }
}

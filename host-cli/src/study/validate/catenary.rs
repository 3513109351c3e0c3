//! Chains between two supports 1 m apart, compared with their exact shape and with the catenary that they approach.

use glam::DVec3;
use muslin_core_f64::integrate::Method;
use muslin_core_f64::simulation::Simulation;

use super::bisect::bisect;
use super::check::Check;
use super::lab::{Lab, Miss, converged};
use super::net::{GRAVITY, Net};

/// Description in the report.
pub const ABOUT: &str = "chains of some length between supports 1 m apart: 16 links against their exact shape, and \
                         the order by which the sag of 16, 32 and 64 links approaches the catenary's";

/// Lengths of the chains, m.
const LENGTHS: [f64; 5] = [1.05, 1.1, 1.2, 1.5, 2.0];

/// Stiffness of a chain over its weight: for the comparison with the exact shape, and for a chain that must not
/// stretch.
const ELASTIC: f64 = 1e3;
const RIGID: f64 = 1e7;

/// Mass of a chain, kg.
const MASS: f64 = 0.3;

/// All checks.
pub fn checks() -> Vec<Check> {
    let each = LENGTHS.into_iter().flat_map(|length| {
        let sags = format!("length {length}, sag led on to no links");
        [
            Check::absolute(format!("length {length}, 16 links, farthest off"), 0.0, 1e-6, move |lab| {
                farthest(lab, length)
            })
            .in_unit("m"),
            Check::absolute(sags, sag(length), 1e-5, move |lab| endless(lab, length)).in_unit("m"),
            Check::absolute(format!("length {length}, order of the sag"), 2.0, 0.05, move |lab| order(lab, length)),
        ]
    });
    each.collect()
}

/// Sag of the catenary: a (cosh(1 / (2 a)) - 1) with 2 a sinh(1 / (2 a)) = length.
fn sag(length: f64) -> f64 {
    // Longer chains have a smaller a.
    let a = bisect([0.05, 10.0], |a| 2.0 * a * (0.5 / a).sinh() < length);
    a * ((0.5 / a).cosh() - 1.0)
}

struct Hanging {
    links: usize,
    rest: f64,
    mass: f64,
    stiffness: f64,
}

impl Hanging {
    fn new(links: usize, length: f64, rigidity: f64) -> Self {
        let (rest, mass) = (length / links as f64, MASS / links as f64);
        Self { links, rest, mass, stiffness: rigidity * MASS * GRAVITY / rest }
    }

    /// Ends of the links where tension balances weight. The horizontal part of the tension is the same everywhere;
    /// the vertical part grows by the weight of one mass from link to link.
    fn shape(&self, horizontal: f64) -> Vec<DVec3> {
        let weight = self.mass * GRAVITY;
        let first = 0.5 * weight * (self.links as f64 - 1.0);
        let mut at = DVec3::ZERO;
        let links = (0..self.links).map(|i| {
            let pull = DVec3::new(horizontal, i as f64 * weight - first, 0.0);
            at += pull.normalize() * (self.rest + pull.length() / self.stiffness);
            at
        });
        [DVec3::ZERO].into_iter().chain(links).collect()
    }

    /// The shape that spans 1 m.
    fn exact(&self) -> Vec<DVec3> {
        self.shape(bisect([0.0, 1e3], |horizontal| self.shape(horizontal)[self.links].x >= 1.0))
    }

    /// The shape in which the core's chain comes to rest, starting from a parabola.
    fn settled(&self, lab: &Lab) -> Result<Vec<DVec3>, Miss> {
        let mut net = Net::chain(self.links + 1, DVec3::X * self.rest, self.mass, self.stiffness);
        (net.held, net.heavy) = (vec![0, self.links as u32], true);
        for (i, x) in net.points.iter_mut().enumerate() {
            let s = i as f64 / self.links as f64;
            *x = DVec3::new(s, -2.0 * s * (1.0 - s) * self.links as f64 * self.rest, 0.0);
        }
        let mut sim = Simulation::from_columns(net.build(), converged(Method::BackwardEuler, 1e-8), 0.5);
        lab.settle(&mut sim, 1e-9, 400)?;
        Ok(sim.positions().to_vec())
    }

    fn sag(&self, lab: &Lab) -> Result<f64, Miss> {
        Ok(self.settled(lab)?.iter().map(|x| -x.y).fold(0.0, f64::max))
    }
}

/// The largest distance of the links' ends from their exact places, m.
fn farthest(lab: &Lab, length: f64) -> Result<f64, Miss> {
    let chain = Hanging::new(16, length, ELASTIC);
    let off = chain.settled(lab)?.into_iter().zip(chain.exact()).map(|(got, want)| got.distance(want));
    Ok(off.fold(0.0, f64::max))
}

/// The sag extrapolated to infinitely many links, m: its error falls as the inverse square of their number.
fn endless(lab: &Lab, length: f64) -> Result<f64, Miss> {
    let sag = |links| Hanging::new(links, length, RIGID).sag(lab);
    let (coarse, fine) = (sag(32)?, sag(64)?);
    Ok(fine + (fine - coarse) / 3.0)
}

/// The orders between 16, 32 and 64 links; returns the one that differs more from 2.
fn order(lab: &Lab, length: f64) -> Result<f64, Miss> {
    let error = |links| Ok::<_, Miss>(Hanging::new(links, length, RIGID).sag(lab)? - sag(length));
    let errors = [error(16)?, error(32)?, error(64)?];
    let [first, second] = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
    Ok(if (first - 2.0).abs() > (second - 2.0).abs() { first } else { second })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_sags_are_met() {
        let published = [0.139304206592, 0.200300790736, 0.292343797601, 0.502633261648, 0.796388355860];
        for (length, want) in LENGTHS.into_iter().zip(published) {
            let got = sag(length);
            assert!((got - want).abs() <= 1e-12, "length {length}: {got:.13}, published {want}");
        }
    }
}

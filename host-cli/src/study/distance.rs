//! The distance between two runs of a scene.

use serde::Serialize;

use crate::engine::Engine;
use muslin_core::diagnostics::extent;

use super::trajectory::Trajectory;

/// Distance between two runs over all samples, m.
#[derive(Clone, Copy, Debug)]
pub struct Distance {
    /// Root mean square; positions are weighted by mass.
    pub rms: f64,
    /// The largest distance.
    pub max: f64,
}

/// The quantity in which two runs are compared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Measure {
    /// The position of each vertex.
    Positions,
    /// How far the cloth reaches in each direction. With contact two methods put each vertex at different places,
    /// but the drape may still be the same.
    Outline,
}

impl Measure {
    /// Name in texts and pictures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Positions => "positions",
            Self::Outline => "outline",
        }
    }

    /// Compares two complete runs; `masses` are the masses of the vertices, kg.
    pub fn between(self, a: &Trajectory, b: &Trajectory, masses: &[f64]) -> Distance {
        self.of_samples(&a.samples, &b.samples, masses)
    }

    /// Compares only the last samples of two runs.
    pub fn at_end(self, a: &Trajectory, b: &Trajectory, masses: &[f64]) -> Distance {
        let last = |run: &Trajectory| run.samples.len().saturating_sub(1)..;
        self.of_samples(&a.samples[last(a)], &b.samples[last(b)], masses)
    }

    fn of_samples(self, a: &[Sample], b: &[Sample], masses: &[f64]) -> Distance {
        match self {
            Self::Positions => positions(a, b, masses),
            Self::Outline => outlines(a, b),
        }
    }
}

/// Positions of all vertices, m.
type Sample = Vec<[f64; 3]>;

fn positions(a: &[Sample], b: &[Sample], masses: &[f64]) -> Distance {
    let (mut sum, mut max) = (0.0, 0.0_f64);
    for (a, b) in a.iter().zip(b) {
        for ((a, b), mass) in a.iter().zip(b).zip(masses) {
            let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
            sum += mass * square;
            max = max.max(square);
        }
    }
    let weight = a.len() as f64 * masses.iter().sum::<f64>();
    Distance { rms: (sum / weight).sqrt(), max: max.sqrt() }
}

/// Number of horizontal directions of an outline; up and down are added to them.
const AROUND: u32 = 16;

fn outlines(a: &[Sample], b: &[Sample]) -> Distance {
    let off = a.iter().zip(b).flat_map(|(a, b)| {
        let (a, b) = (outline(a), outline(b));
        a.into_iter().zip(b).map(|(a, b)| (a - b).abs()).collect::<Vec<_>>()
    });
    let off: Vec<f64> = off.collect();
    let square = off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64;
    Distance { rms: square.sqrt(), max: off.into_iter().fold(0.0, f64::max) }
}

/// How far the positions reach in each direction, m: the support function of their convex hull.
fn outline(positions: &[[f64; 3]]) -> Vec<f64> {
    let around = (0..AROUND).map(|k| {
        let (sine, cosine) = (f64::from(k) * core::f64::consts::TAU / f64::from(AROUND)).sin_cos();
        [cosine, 0.0, sine]
    });
    let directions = around.chain([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]]);
    let reach = |d: [f64; 3]| {
        let along = positions.iter().map(|p| p[0] * d[0] + p[1] * d[1] + p[2] * d[2]);
        along.fold(f64::NEG_INFINITY, f64::max)
    };
    directions.map(reach).collect()
}

/// The diagonal of the bounding box of a scene's cloth at the start, m.
pub fn diagonal(engine: &dyn Engine) -> f64 {
    let mut start = Vec::new();
    engine.write_state(&mut start);
    extent(start.into_iter()).iter().map(|side| side * side).sum::<f64>().sqrt()
}

/// The largest difference of the total energies at a common sample, J.
pub fn energy_drift(a: &Trajectory, b: &Trajectory) -> f64 {
    let samples = 0..a.energies.len().min(b.energies.len());
    samples.map(|sample| (a.energy(sample) - b.energy(sample)).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_is_how_far_the_cloth_reaches() {
        let moved = |by: f64| {
            let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.5, 1.0], [0.0, 0.0, 1.0]];
            outline(&square.map(|[x, y, z]| [x + by, y, z]))
        };
        let reach = moved(0.0);
        assert_eq!([reach[0], reach[16], reach[17]], [1.0, 0.5, 0.0], "along x, up and down");
        let farther = moved(0.25);
        assert!((farther[0] - 1.25).abs() < 1e-15 && (farther[8] + 0.25).abs() < 1e-15, "{farther:?}");
    }
}

//! Nets of masses and springs that a scene cannot describe: chains and lattices.

use glam::DVec3;
use muslin_core_f64::forces::ModelColumns;
use muslin_core_f64::forces::gravity::GravityColumns;
use muslin_core_f64::forces::spring::{Spring, SpringColumns};
use muslin_core_f64::integrate::pins::{AT_REST, PinColumns};
use muslin_core_f64::particles::ParticleColumns;
use muslin_core_f64::scene::BuiltScene;

/// Gravitational acceleration of the checks, m/s^2.
pub const GRAVITY: f64 = 9.81;

/// Mask of a pin for all axes.
const XYZ: u8 = 7;

/// A net at rest.
#[derive(Clone, Debug, Default)]
pub struct Net {
    /// Positions, m.
    pub points: Vec<DVec3>,
    /// Masses, kg.
    pub masses: Vec<f64>,
    /// Ends and material of each spring.
    pub springs: Vec<([u32; 2], Spring)>,
    /// Vertices that are pinned.
    pub held: Vec<u32>,
    /// Whether gravity acts.
    pub heavy: bool,
}

impl Net {
    /// Equal masses in a row from the origin, joined by equal springs at rest. Nothing is pinned.
    pub fn chain(count: usize, step: DVec3, mass: f64, stiffness: f64) -> Self {
        let spring = Spring { rest: step.length(), stiffness, damping: 0.0 };
        Self {
            points: (0..count).map(|i| step * i as f64).collect(),
            masses: vec![mass; count],
            springs: (1..count as u32).map(|i| ([i - 1, i], spring)).collect(),
            ..Self::default()
        }
    }

    /// A square sheet of `side * side` masses of 1 kg, 1 m apart in the xz plane. It has structural springs, shear
    /// springs along both diagonals and bending springs that skip a mass; stiffnesses are in N/m, and 0 omits the
    /// springs. The damping of each spring is `damping`, s, times its stiffness.
    pub fn lattice(side: u32, [structural, shear, bend]: [f64; 3], damping: f64) -> Self {
        let links = [
            ([1, 0], structural),
            ([0, 1], structural),
            ([1, 1], shear),
            ([1, -1], shear),
            ([2, 0], bend),
            ([0, 2], bend),
        ];
        let mut net = Self { masses: vec![1.0; (side * side) as usize], ..Self::default() };
        for (i, k) in (0..side * side).map(|v| (v % side, v / side)) {
            net.points.push(DVec3::new(i.into(), 0.0, k.into()));
            for ([di, dk], stiffness) in links.into_iter().filter(|link| link.1 > 0.0) {
                let end = (i.checked_add_signed(di), k.checked_add_signed(dk));
                if let (Some(ei), Some(ek)) = end
                    && ei < side
                    && ek < side
                {
                    let rest = f64::from(di * di + dk * dk).sqrt();
                    let spring = Spring { rest, stiffness, damping: damping * stiffness };
                    net.springs.push(([k * side + i, ek * side + ei], spring));
                }
            }
        }
        net
    }

    /// The columns of the net.
    pub fn build(&self) -> BuiltScene {
        BuiltScene {
            particles: ParticleColumns::at_rest(
                self.points.clone(),
                self.masses.clone(),
                self.masses.iter().map(|m| 1.0 / m).collect(),
            ),
            model: ModelColumns {
                gravity: self.heavy.then_some(GravityColumns::constant(DVec3::NEG_Y * GRAVITY)),
                stretch_springs: Some(SpringColumns::build(self.points.len(), &self.springs)),
                ..ModelColumns::default()
            },
            pins: PinColumns {
                anchors: self.held.iter().map(|&v| self.points[v as usize]).collect(),
                motions: vec![AT_REST; self.held.len()],
                axes: vec![XYZ; self.held.len()],
                vertices: self.held.clone(),
                ..PinColumns::default()
            },
            edges: self.springs.iter().map(|(ends, _)| *ends).collect(),
            rest_lengths: self.springs.iter().map(|(_, spring)| spring.rest).collect(),
            ..BuiltScene::default()
        }
    }
}

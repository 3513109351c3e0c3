//! Nets of masses and springs in f64 that no scene can describe: single springs, chains, lattices. Held axes
//! are bits: x = 1, y = 2, z = 4.

use glam::DVec3;
use muslin_core_f64::forces::ModelColumns;
use muslin_core_f64::forces::drag::DragColumns;
use muslin_core_f64::forces::gravity::GravityColumns;
use muslin_core_f64::forces::spring::{Spring, SpringColumns};
use muslin_core_f64::integrate::pins::{AT_REST, PinColumns};
use muslin_core_f64::integrate::{Method, Scheme, Tolerance};
use muslin_core_f64::particles::ParticleColumns;
use muslin_core_f64::scene::BuiltScene;
use muslin_core_f64::simulation::Simulation;

/// All axes.
pub const XYZ: u8 = 7;

/// A net at rest at the given points.
#[derive(Clone, Debug, Default)]
pub struct Net {
    /// m.
    pub points: Vec<DVec3>,
    /// kg.
    pub masses: Vec<f64>,
    /// Ends and material.
    pub springs: Vec<([u32; 2], Spring)>,
    /// Held vertices and axes.
    pub held: Vec<(u32, u8)>,
    /// m/s^2.
    pub gravity: Option<DVec3>,
    /// Drag of each vertex, N s/m; 0 turns it off.
    pub drag: f64,
}

impl Net {
    /// Equal masses in a row from the origin, joined by equal springs at rest. Nothing is held.
    pub fn chain(count: usize, step: DVec3, mass: f64, stiffness: f64, damping: f64) -> Self {
        let spring = Spring { rest: step.length(), stiffness, damping };
        Self {
            points: (0..count).map(|i| step * i as f64).collect(),
            masses: vec![mass; count],
            springs: (1..count as u32).map(|i| ([i - 1, i], spring)).collect(),
            ..Self::default()
        }
    }

    /// A square sheet of `side * side` masses of 1 kg, 1 m apart in the xz plane, with structural springs,
    /// shear springs along both diagonals and bending springs that skip a mass, N/m. A stiffness of 0 omits the
    /// springs. Damping is `damping` times the stiffness of each spring, s.
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

    /// Builds the columns.
    pub fn build(&self) -> BuiltScene {
        let (vertices, axes): (Vec<_>, Vec<_>) = self.held.iter().copied().unzip();
        BuiltScene {
            particles: ParticleColumns::at_rest(
                self.points.clone(),
                self.masses.clone(),
                self.masses.iter().map(|m| 1.0 / m).collect(),
            ),
            model: ModelColumns {
                gravity: self.gravity.map(GravityColumns::constant),
                drag: (self.drag > 0.0).then(|| DragColumns { coefficients: vec![self.drag; self.points.len()] }),
                stretch_springs: Some(SpringColumns::build(self.points.len(), &self.springs)),
                ..ModelColumns::default()
            },
            pins: PinColumns {
                anchors: vertices.iter().map(|&v| self.points[v as usize]).collect(),
                motions: vec![AT_REST; vertices.len()],
                vertices,
                axes,
                ..PinColumns::default()
            },
            edges: self.springs.iter().map(|(ends, _)| *ends).collect(),
            rest_lengths: self.springs.iter().map(|(_, spring)| spring.rest).collect(),
            ..BuiltScene::default()
        }
    }
}

/// One linearised step, solved to rounding: exact for linear forces.
pub fn linearised(method: Method) -> Scheme {
    Scheme::fixed(method, 1e-14)
}

/// Newton's method until the residual has fallen to `tolerance` times its initial value.
pub fn converged(method: Method, tolerance: f64) -> Scheme {
    Scheme { newton: 100, tolerance: Tolerance::Residual(tolerance), ..linearised(method) }
}

/// Steps a damped simulation until no vertex is faster than `speed`, m/s. Panics after `most` steps.
pub fn settle(sim: &mut Simulation, speed: f64, most: u32) {
    for _ in 0..most {
        sim.take_step().unwrap_or_else(|error| panic!("while settling: {error}"));
        if sim.velocities().iter().all(|v| v.length() <= speed) {
            return;
        }
    }
    let fastest = sim.velocities().iter().map(|v| v.length()).fold(0.0, f64::max);
    panic!("not at rest after {most} steps: {fastest:e} m/s, {:?}", sim.statistics());
}

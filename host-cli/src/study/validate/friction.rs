//! Coulomb friction on a plane: the slope at which a sheet begins to slide, its acceleration, and where it stops.
//! Gravity is inclined instead of the plane.

use glam::DVec3;
use muslin_core_f64::simulation::Simulation;

use super::bisect::threshold;
use super::check::Check;
use super::lab::{self, Lab, Miss, centre, drift};
use super::net::GRAVITY;

/// Description in the report.
pub const ABOUT: &str = "sheets on a plane with friction 0.5, gravity leans: the slope from which they slide; \
                         g (sin - mu cos) on a slope of 0.8; v^2 / (2 mu g) on the level";

const MU: f64 = 0.5;

/// The slope on which the acceleration is measured.
const STEEP: f64 = 0.8;

/// A sheet slides if it is faster than this, m/s.
const STILL: f64 = 1e-6;

const SPECK: &str = "size = [0.02, 0.02], cells = [1, 1]";
const PATCH: &str = "size = [0.31, 0.31], cells = [31, 31]";

/// Sheets, methods and directions. The patch slides along both families of edges, and along and across the
/// diagonals.
const CASES: [Lying; 6] = [
    Lying { name: "2 triangles", sheet: SPECK, method: "symplectic-euler", step: SHORT, heading: 0 },
    Lying { name: "2 triangles", sheet: SPECK, method: "backward-euler", step: LONG, heading: 0 },
    Lying { name: "32x32 vertices", sheet: PATCH, method: "backward-euler", step: LONG, heading: 0 },
    Lying { name: "32x32 vertices", sheet: PATCH, method: "backward-euler", step: LONG, heading: 45 },
    Lying { name: "32x32 vertices", sheet: PATCH, method: "backward-euler", step: LONG, heading: 90 },
    Lying { name: "32x32 vertices", sheet: PATCH, method: "backward-euler", step: LONG, heading: 135 },
];

/// Steps, s.
const SHORT: f64 = 5e-4;
const LONG: f64 = 2e-3;

/// A sheet that lies on a plane.
#[derive(Clone, Copy)]
struct Lying {
    name: &'static str,
    sheet: &'static str,
    method: &'static str,
    /// Step, s.
    step: f64,
    /// Direction towards which gravity is inclined, degrees.
    heading: u32,
}

/// All checks.
pub fn checks() -> Vec<Check> {
    let acceleration = GRAVITY * (STEEP - MU) / (1.0 + STEEP * STEEP).sqrt();
    let each = CASES.into_iter().flat_map(|lying| {
        let name = |what: &str| format!("{} to {} degrees, {}, {what}", lying.name, lying.heading, lying.method);
        [
            Check::absolute(name("slope"), MU, 1e-3, move |lab| lying.threshold(lab)),
            Check::relative(name("acceleration"), acceleration, 5e-3, move |lab| lying.acceleration(lab))
                .in_unit("m/s^2"),
        ]
    });
    let stops = CASES.into_iter().filter(|lying| lying.heading == 0).flat_map(|lying| {
        let name = |what: &str| format!("{}, {}, {what}", lying.name, lying.method);
        [
            Check::relative(name("way at 1 m/s"), 1.0 / (2.0 * MU * GRAVITY), 5e-3, move |lab| lying.way(lab))
                .in_unit("m"),
            Check::absolute(name("creep at 0.99 of the slope"), 0.0, STILL, move |lab| lying.creep(lab)).in_unit("m/s"),
        ]
    });
    each.chain(stops).collect()
}

impl Lying {
    fn down(&self) -> DVec3 {
        let (sine, cosine) = f64::from(self.heading).to_radians().sin_cos();
        DVec3::new(cosine, 0.0, sine)
    }

    /// The sheet with gravity inclined; `slope` is the tangent of the angle.
    fn on(&self, slope: f64) -> Result<Simulation, Miss> {
        let Self { sheet, method, step, .. } = self;
        let gravity = (self.down() * slope - DVec3::Y) * GRAVITY / (1.0 + slope * slope).sqrt();
        let text = format!(
            r#"
            name = "lying"
            duration = 1.0
            frame_rate = 100
            gravity = {:?}
            [[cloth]]
            grid = {{ {sheet}, pattern = "diagonal" }}
            position = [0.0, 0.001, 0.0]
            density = 0.2
            stretch = {{ model = "membrane", stiffness = 20.0 }}
            shear = {{ stiffness = 8.0 }}
            bend = {{ model = "hinge", rigidity = 1e-7 }}
            [contact]
            thickness = 0.001
            friction = {MU:?}
            [[collider]]
            shape = "plane"
            point = [0, 0, 0]
            normal = [0, 1, 0]
            [integrator]
            method = "{method}"
            step = {step:?}
            "#,
            gravity.to_array()
        );
        lab::simulation(&text, &[])
    }

    fn slides(&self, lab: &Lab, slope: f64) -> Result<bool, Miss> {
        let mut sim = self.on(slope)?;
        lab.run(&mut sim, 0.1)?;
        Ok(drift(&sim).dot(self.down()) > STILL)
    }

    /// The slope at which it begins to slide.
    fn threshold(&self, lab: &Lab) -> Result<f64, Miss> {
        threshold([0.99 * MU, 1.01 * MU], 2e-4, |slope| self.slides(lab, slope))
    }

    /// Mean acceleration from 0.05 s to 0.15 s, m/s^2.
    fn acceleration(&self, lab: &Lab) -> Result<f64, Miss> {
        let mut sim = self.on(STEEP)?;
        lab.run(&mut sim, 0.05)?;
        let early = drift(&sim);
        lab.run(&mut sim, 0.1)?;
        Ok((drift(&sim) - early).dot(self.down()) / 0.1)
    }

    /// The distance until it stops from 1 m/s, m. The result is off by half the way of one step, so the step is
    /// short.
    fn way(&self, lab: &Lab) -> Result<f64, Miss> {
        let mut sim = Self { step: SHORT, ..*self }.on(0.0)?;
        sim.state_mut().1.fill(DVec3::new(0.6, 0.0, 0.8));
        let start = centre(&sim);
        lab.run(&mut sim, 0.25)?;
        Ok(centre(&sim).distance(start))
    }

    /// Speed of the fastest vertex over 0.1 s, m/s, after the elastic deformation has settled.
    fn creep(&self, lab: &Lab) -> Result<f64, Miss> {
        let mut sim = self.on(0.99 * MU)?;
        lab.run(&mut sim, 0.1)?;
        let before = sim.positions().to_vec();
        lab.run(&mut sim, 0.1)?;
        let moved = sim.positions().iter().zip(&before).map(|(a, b)| a.distance(*b));
        Ok(moved.fold(0.0, f64::max) / 0.1)
    }
}

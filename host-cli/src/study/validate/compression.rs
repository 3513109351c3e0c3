//! Compression: the exact matrix of an implicit step becomes indefinite, as theory predicts; the projected matrix
//! does not.

use glam::DVec3;
use muslin_core_f64::integrate::{Jacobian, Method, Scheme, Tolerance};
use muslin_core_f64::simulation::Simulation;

use super::bisect::threshold;
use super::check::Check;
use super::lab::{self, Lab, Miss, linearised, scatter3};
use super::net::Net;

/// Description in the report.
pub const ABOUT: &str = "sheets pressed together by 10, 20 .. 90 %, one step of backward Euler each: solves that met \
                         negative curvature, which the exact matrix must have; a spring pressed together, the step from \
                         which h^2 k (L0 / L - 1) is more than its mass";

const MATERIALS: [(&str, &str); 2] = [
    (
        "membrane and hinges",
        r#"
        stretch = { model = "membrane", stiffness = 100.0 }
        shear = { stiffness = 40.0 }
        bend = { model = "hinge", rigidity = 1e-4 }"#,
    ),
    (
        "springs",
        r#"
        stretch = { model = "spring", stiffness = 100.0 }
        bend = { model = "spring", stiffness = 5.0 }"#,
    ),
];

/// All checks.
pub fn checks() -> Vec<Check> {
    let sheets = MATERIALS.into_iter().flat_map(|(name, material)| {
        let solves = |what: &str, expected: f64, jacobian: Jacobian, newton: u32| {
            Check::absolute(format!("{name}, {what}"), expected, 0.0, move |lab| {
                pressed(lab, material, jacobian, newton)
            })
            .in_unit("solves")
        };
        [
            solves("exact matrix", 9.0, Jacobian::Exact, 1),
            solves("projected matrix", 0.0, Jacobian::Projected, 1),
            solves("projected matrix, 20 Newton iterations", 0.0, Jacobian::Projected, 20),
        ]
    });
    let spring =
        Check::relative("pressed spring, step that turns its matrix indefinite over theory's", 1.0, 1e-3, spring);
    sheets.chain([spring]).collect()
}

/// Number of solves that found negative curvature, over nine sheets.
fn pressed(lab: &Lab, material: &str, jacobian: Jacobian, newton: u32) -> Result<f64, Miss> {
    let text = format!(
        r#"
        name = "pressed"
        duration = 1.0
        [[cloth]]
        grid = {{ size = [0.4, 0.35], cells = [4, 4] }}
        density = 0.2
        {material}"#
    );
    let mut solves = 0;
    for tenths in 1..=9 {
        let mut built = lab::columns(&text, &[])?;
        for (place, x) in built.particles.positions.iter_mut().enumerate() {
            *x = *x * (1.0 - 0.1 * f64::from(tenths)) + scatter3(place) * 1e-4;
        }
        let scheme =
            Scheme { jacobian, newton, tolerance: Tolerance::Residual(1e-8), ..linearised(Method::BackwardEuler) };
        let mut sim = Simulation::from_columns(built, scheme, 0.05);
        lab.steps(&mut sim, 1)?;
        solves += sim.statistics().negative_curvature;
    }
    Ok(solves as f64)
}

/// The step at which m + h^2 k (1 - L0 / L), the stiffness across the spring, becomes 0; over theory.
fn spring(lab: &Lab) -> Result<f64, Miss> {
    let (mass, stiffness, length): (f64, f64, f64) = (0.3, 40.0, 0.8);
    let theory = (mass / (stiffness * (1.0 / length - 1.0))).sqrt();
    threshold([0.9, 1.1], 1e-4, |ratio| {
        let mut net = Net::chain(2, DVec3::X, mass, stiffness);
        net.held = vec![0];
        // Gravity acts across the spring, so that the solve has a part in this direction; the spring's own force is
        // along it.
        net.heavy = true;
        let mut built = net.build();
        built.particles.positions[1] = DVec3::X * length;
        let scheme = Scheme { jacobian: Jacobian::Exact, ..linearised(Method::BackwardEuler) };
        let mut sim = Simulation::from_columns(built, scheme, ratio * theory);
        lab.steps(&mut sim, 1)?;
        Ok(sim.statistics().negative_curvature > 0)
    })
}

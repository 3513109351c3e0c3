//! Forces and Jacobians of every term, compared with central differences on a sheet that is bent, stretched and
//! compressed.

use glam::DVec3;
use muslin_core_f64::dispatch::Serial;
use muslin_core_f64::forces::{self, TangentScale, matrix, write_tangents};
use muslin_core_f64::integrate::{Jacobian, Method};
use muslin_core_f64::scene::BuiltScene;
use muslin_core_f64::scratch::ScratchColumns;

use super::check::Check;
use super::lab::{self, Miss, scatter3};

/// Description in the report.
pub const ABOUT: &str = "forces against -dE/dx and Jacobians against -df/dx by central differences, and asymmetry of \
                         Jacobians; the largest error over the largest entry";

const TERMS: [(&str, &str); 5] = [
    ("membrane", "stretch = { model = \"membrane\", stiffness = 50.0, weft = 30.0 }\nshear = { stiffness = 20.0 }"),
    ("springs", r#"stretch = { model = "spring", stiffness = 50.0 }"#),
    ("hinges", r#"bend = { model = "hinge", rigidity = 0.01 }"#),
    ("bending springs", r#"bend = { model = "spring", stiffness = 5.0 }"#),
    ("seams", "seam = [{ pairs = [[0, 5], [3, 9]], stiffness = 50.0 }]"),
];

/// Displacement of the sheet's vertices, and the step of the differences, m; edges are 0.1 m long.
const ROUGHNESS: f64 = 0.03;
const STEP: f64 = 1e-4;

/// Steps and weights of central differences of sixth order.
const WEIGHTS: [(f64, f64); 3] = [(1.0, 45.0 / 60.0), (2.0, -9.0 / 60.0), (3.0, 1.0 / 60.0)];

/// All checks.
pub fn checks() -> Vec<Check> {
    let each = TERMS.into_iter().flat_map(|(name, term)| {
        [
            Check::absolute(format!("{name}, force"), 0.0, 1e-7, move |_| force(term)),
            Check::absolute(format!("{name}, Jacobian"), 0.0, 1e-7, move |_| jacobian(term)),
            Check::absolute(format!("{name}, asymmetry"), 0.0, 1e-14, move |_| asymmetry(term)),
        ]
    });
    each.collect()
}

fn sheet(term: &str) -> Result<BuiltScene, Miss> {
    let text = format!(
        "name = \"rough\"\nduration = 0\n[[cloth]]\ngrid = {{ size = [0.3, 0.26], cells = [3, 3] }}\n\
         density = 0.2\n{term}"
    );
    let mut built = lab::columns(&text, &[])?;
    for (place, x) in built.particles.positions.iter_mut().enumerate() {
        *x += scatter3(place) * ROUGHNESS;
    }
    Ok(built)
}

/// Derivatives d/dt at t = 0 of several functions at once.
fn slopes(f: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let mut sum = vec![0.0; f(0.0).len()];
    for (steps, weight) in WEIGHTS {
        let (ahead, behind) = (f(steps * STEP), f(-steps * STEP));
        for (sum, (ahead, behind)) in sum.iter_mut().zip(ahead.iter().zip(&behind)) {
            *sum += weight * (ahead - behind) / STEP;
        }
    }
    sum
}

/// The positions with one coordinate displaced.
fn moved(built: &BuiltScene, coordinate: usize, by: f64) -> Vec<DVec3> {
    let mut x = built.particles.positions.clone();
    x[coordinate / 3][coordinate % 3] += by;
    x
}

fn forces_at(built: &BuiltScene, x: &[DVec3]) -> Vec<f64> {
    lab::forces(built, x).iter().flat_map(|f| f.to_array()).collect()
}

/// The largest difference over the largest entry of `want`.
fn off(got: &[f64], want: &[f64]) -> f64 {
    let largest = want.iter().map(|x| x.abs()).fold(0.0, f64::max);
    got.iter().zip(want).map(|(got, want)| (got - want).abs()).fold(0.0, f64::max) / largest
}

fn force(term: &str) -> Result<f64, Miss> {
    let built = sheet(term)?;
    let (model, masses) = (built.model.view(), &built.particles.masses);
    let energy = |x: &[DVec3]| vec![-forces::energy(&model, masses, x.into()).total()];
    let coordinates = 0..3 * masses.len();
    let want: Vec<_> = coordinates.map(|c| slopes(|by| energy(&moved(&built, c, by)))[0]).collect();
    Ok(off(&forces_at(&built, &built.particles.positions), &want))
}

/// The columns of -df/dx, from products with unit vectors.
fn exact(built: &BuiltScene) -> Vec<Vec<f64>> {
    let (x, model) = (&built.particles.positions, built.model.view());
    let mut columns = ScratchColumns::build(built, &lab::linearised(Method::BackwardEuler));
    let s = &mut columns.view();
    let scale = TangentScale { position: 1.0, velocity: 0.0 };
    write_tangents(&model, x, scale, Jacobian::Exact, &s.assembly_map, s.tangents, &mut s.matrix, &Serial);
    let mut product = vec![DVec3::ZERO; x.len()];
    let column = |c: usize| {
        let mut unit = vec![DVec3::ZERO; x.len()];
        unit[c / 3][c % 3] = 1.0;
        matrix::multiply(&s.matrix, &built.particles.masses, 0.0, &unit, &mut product, &Serial);
        product.iter().flat_map(|f| f.to_array()).collect()
    };
    (0..3 * x.len()).map(column).collect()
}

fn jacobian(term: &str) -> Result<f64, Miss> {
    let built = sheet(term)?;
    let column = |c: usize| slopes(|by| forces_at(&built, &moved(&built, c, by)).iter().map(|f| -f).collect());
    let got = exact(&built);
    let want: Vec<_> = (0..got.len()).map(column).collect();
    Ok(off(&got.concat(), &want.concat()))
}

fn asymmetry(term: &str) -> Result<f64, Miss> {
    let by_columns = exact(&sheet(term)?);
    let side = 0..by_columns.len();
    let by_rows: Vec<_> =
        side.clone().flat_map(|row| side.clone().map(|c| by_columns[c][row]).collect::<Vec<_>>()).collect();
    Ok(off(&by_columns.concat(), &by_rows))
}

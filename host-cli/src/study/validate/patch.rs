//! Patch tests. Under an affine map a membrane stores A psi(F) and has no force at any interior vertex, with every
//! pattern; under a rigid motion no force is anywhere.

use glam::{DMat3, DVec3};
use muslin_core_f64::forces;
use muslin_core_f64::mesh::edges::{self, NONE};
use muslin_core_f64::scene::BuiltScene;

use super::check::Check;
use super::lab::{self, Miss, scatter};

/// Description in the report.
pub const ABOUT: &str = "sheets under 20 affine maps: energy against A psi(F), and the largest force where none may be, \
                         over the largest of all; under a rigid motion over stiffness times edge";

/// A sheet for each pattern and generator; sizes in m.
const SHEETS: [(&str, &str); 4] = [
    ("equilateral", r#"grid = { size = [0.625, 0.5], cells = [5, 4] }"#),
    ("diagonal", r#"grid = { size = [0.625, 0.5], cells = [5, 4], pattern = "diagonal" }"#),
    ("alternating", r#"grid = { size = [0.625, 0.5], cells = [5, 4], pattern = "alternating" }"#),
    ("disc", "disc = { radius = 0.4, hole = 0.1, rings = 3 }"),
];

/// Stiffnesses of warp, weft and shear, N/m.
const WARP: f64 = 900.0;
const WEFT: f64 = 600.0;
const SHEAR: f64 = 300.0;

const MATERIALS: [(&str, &str); 3] = [
    ("membrane", MEMBRANE),
    ("springs", r#"stretch = { model = "spring", stiffness = 900.0 }"#),
    ("hinges", r#"bend = { model = "hinge", rigidity = 900.0 }"#),
];
const MEMBRANE: &str =
    "stretch = { model = \"membrane\", stiffness = 900.0, weft = 600.0 }\nshear = { stiffness = 300.0 }";

/// Number of affine maps.
const MAPS: usize = 20;

/// All checks.
pub fn checks() -> Vec<Check> {
    let maps = SHEETS.into_iter().flat_map(|(name, sheet)| {
        [
            Check::absolute(format!("{name}, energy of affine maps"), 0.0, 1e-13, move |_| energy(sheet)),
            Check::absolute(format!("{name}, interior force of affine maps"), 0.0, 1e-13, move |_| interior(sheet)),
        ]
    });
    let rigid = MATERIALS.into_iter().map(|(name, material)| {
        Check::absolute(format!("{name}, force of a rigid motion"), 0.0, 1e-12, move |_| rigid(material))
    });
    maps.chain(rigid).collect()
}

fn scene(sheet: &str, material: &str) -> Result<BuiltScene, Miss> {
    lab::columns(&format!("name = \"patch\"\nduration = 0\n[[cloth]]\n{sheet}\ndensity = 1.0\n{material}"), &[])
}

/// The images of the warp and weft directions under an affine map that stretches, compresses, shears and turns.
fn map(number: usize) -> [DVec3; 2] {
    let [warp, weft, shear, turn] = [0, 1, 2, 3].map(|k| scatter(4 * number + k));
    let turn = DMat3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 3.0 * turn);
    [turn * DVec3::X * 2f64.powf(warp), turn * DVec3::new(0.8 * shear, 0.0, 2f64.powf(weft))]
}

fn mapped(built: &BuiltScene, [warp, weft]: [DVec3; 2]) -> Vec<DVec3> {
    built.particles.positions.iter().map(|x| warp * x.x + weft * x.z).collect()
}

/// The largest relative error of the energy over all maps.
fn energy(sheet: &str) -> Result<f64, Miss> {
    let built = scene(sheet, MEMBRANE)?;
    let masses = &built.particles.masses;
    // At 1 kg/m^2 the mass is the area.
    let area: f64 = masses.iter().sum();
    let off = (0..MAPS).map(map).map(|[warp, weft]| {
        let (along, across) = (warp.length() - 1.0, weft.length() - 1.0);
        let psi = 0.5 * (WARP * along * along + WEFT * across * across + SHEAR * warp.dot(weft).powi(2));
        let stored = forces::energy(&built.model.view(), masses, (&mapped(&built, [warp, weft])).into()).total();
        (stored / (area * psi) - 1.0).abs()
    });
    Ok(off.fold(0.0, f64::max))
}

/// The largest force at an interior vertex over the largest force of all vertices.
fn interior(sheet: &str) -> Result<f64, Miss> {
    let built = scene(sheet, MEMBRANE)?;
    let border = border(&built)?;
    let off = (0..MAPS).map(|number| {
        let lengths: Vec<_> = lab::forces(&built, &mapped(&built, map(number))).iter().map(|f| f.length()).collect();
        let inside = lengths.iter().zip(&border).filter(|(_, border)| !**border).map(|(f, _)| *f);
        inside.fold(0.0, f64::max) / lengths.iter().copied().fold(0.0, f64::max)
    });
    Ok(off.fold(0.0, f64::max))
}

/// The largest force of a sheet after a rigid motion, over its stiffness times its edge.
fn rigid(material: &str) -> Result<f64, Miss> {
    let built = scene(SHEETS[0].1, material)?;
    let turn = DMat3::from_axis_angle(DVec3::new(2.0, -1.0, 3.0).normalize(), 1.3);
    let moved: Vec<_> = built.particles.positions.iter().map(|&x| turn * x + DVec3::new(0.3, -0.7, 0.2)).collect();
    let largest = lab::forces(&built, &moved).iter().map(|f| f.length()).fold(0.0, f64::max);
    Ok(largest / (WARP * 0.125))
}

/// Which vertices lie on the border: on an edge with only one triangle.
fn border(built: &BuiltScene) -> Result<Vec<bool>, Miss> {
    let mut border = vec![false; built.particles.masses.len()];
    let edges = edges::build(&built.triangles)?;
    for end in edges.iter().filter(|edge| edge.triangles[1] == NONE).flat_map(|edge| edge.ends) {
        border[end as usize] = true;
    }
    Ok(border)
}

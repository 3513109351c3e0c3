//! Effective properties of sheets of hinges and of bending springs: rigidity by direction, Poisson's ratio, and
//! known defects of the models.

use glam::{DMat3, DVec3};
use muslin_core_f64::mesh::TriMesh;
use muslin_core_f64::scene::Content;

use super::check::Check;
use super::lab::{self, Miss};
use super::report::Row;
use super::rigidity::{Rigidity, SHEETS, Sheet};

/// Description in the report.
pub const ABOUT: &str = "rigidity of a bent sheet in equilibrium over the one asked for, by the direction along which it \
                         bends: kept a cylinder, or a narrow strip with free sides, and its twist over its curvature; \
                         equilateral triangles alone bend alike in all directions. Bending springs have no rigidity when flat";

/// Rigidity tensor of each of [`SHEETS`], by curvature along x, along z and mixed. The triangles of three of the sheets
/// repeat from vertex to vertex, and bend as imposed. In an alternating sheet every other vertex moves out of the
/// cylinder: without that its first two rows would be 1, 0, 0 and 0, 1, 0.
const TENSORS: [[[f64; 3]; 3]; 4] = [
    [[1.0, -1.0 / 3.0, 0.0], [-1.0 / 3.0, 1.0, 0.0], [0.0, 0.0, 8.0 / 3.0]],
    [[27.0 / 32.0, -0.25, 0.0], [-0.25, 1.0, 0.0], [0.0, 0.0, 25.0 / 8.0]],
    [[5.0 / 6.0, -1.0 / 6.0, 0.0], [-1.0 / 6.0, 5.0 / 6.0, 0.0], [0.0, 0.0, 4.0]],
    [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 6.0]],
];

/// Tolerance: the answers are exact.
const EXACT: f64 = 1e-9;

/// The name of the rigidity of a sheet that stays a cylinder.
const CYLINDER: &str = "cylinder";

fn name(sheet: &str, degrees: u32, what: &str) -> String {
    format!("{sheet}, {degrees} degrees, {what}")
}

/// For each sheet its name, and the directions and rigidities of its cylinders that are measured. A sheet bends along
/// 180 degrees as along 0.
pub fn cylinders(rows: &[Row]) -> Vec<(&'static str, Vec<(f64, f64)>)> {
    let of = |sheet: Sheet| {
        let at = |degrees: u32| rows.iter().find(|row| row.name == name(sheet.name, degrees % 180, CYLINDER))?.measured;
        let points = (0..=12).filter_map(|step| Some((f64::from(15 * step), at(15 * step)?)));
        (sheet.name, points.collect())
    };
    SHEETS.map(of).into()
}

/// All checks.
pub fn checks() -> Vec<Check> {
    let directions = SHEETS.into_iter().zip(TENSORS).flat_map(|(sheet, tensor)| {
        let known = Rigidity(DMat3::from_cols_array_2d(&tensor));
        let check = move |what: &str, step: u32, of: fn(&Rigidity, f64) -> f64| {
            let degrees = 15 * step;
            let (name, angle) = (name(sheet.name, degrees, what), f64::from(degrees));
            Check::absolute(name, of(&known, angle), EXACT, move |_| Ok(of(&Rigidity::of(&sheet)?, angle)))
        };
        let held = (0..12).map(move |step| check(CYLINDER, step, Rigidity::held));
        let free = (0..12).step_by(3).flat_map(move |step| {
            [check("free sides", step, Rigidity::narrow), check("free sides, twist", step, Rigidity::twist)]
        });
        held.chain(free)
    });
    let [equilateral, ..] = SHEETS;
    let poisson = Check::absolute("equilateral, Poisson's ratio", -1.0 / 3.0, EXACT, move |_| {
        let Rigidity(tensor) = Rigidity::of(&equilateral)?;
        Ok(tensor.y_axis.x / tensor.x_axis.x)
    });
    directions.chain([poisson]).chain(springs()).collect()
}

/// Checks of the predicted defect of bending springs: E = k l^2 theta^4 / 32 across two edges of length l.
fn springs() -> [Check; 2] {
    const STIFFNESS: f64 = 50.0;
    const HEIGHT: f64 = 0.4;
    let predicted = |angle: f64| STIFFNESS * HEIGHT * HEIGHT * angle.powi(4) / 32.0;
    let stored = |angle: f64| folded(HEIGHT, angle, &format!("{{ model = \"spring\", stiffness = {STIFFNESS:?} }}"));
    // The next term of the series is theta^2 / 24 of the first one.
    let energy = Check::relative("bending spring folded by 0.1, energy", predicted(0.1), 5e-4, move |_| stored(0.1));
    let power = Check::absolute("bending spring, power of the angle; of a sheet it is 2", 4.0, 2e-3, move |_| {
        Ok((stored(0.1)? / stored(0.05)?).log2())
    });
    [energy.in_unit("J"), power]
}

/// Two triangles with a common edge; the second one is turned about it by an angle.
fn rhombus(height: f64, angle: f64) -> [DVec3; 4] {
    let (sine, cosine) = angle.sin_cos();
    let turned = DVec3::new(0.0, height * sine, -height * cosine);
    [DVec3::X * -0.5, DVec3::X * 0.5, DVec3::Z * height, turned]
}

/// Bending energy of a rhombus that is flat at rest, J.
fn folded(height: f64, angle: f64, bend: &str) -> Result<f64, Miss> {
    let mesh = TriMesh {
        positions: rhombus(height, 0.0).map(|x| x.to_array()).into(),
        triangles: vec![[0, 1, 2], [0, 3, 1]],
        ..TriMesh::default()
    };
    let text = format!("name = \"fold\"\nduration = 0\n[[cloth]]\nmesh = \"fold\"\ndensity = 1.0\nbend = {bend}");
    let mut sim = lab::simulation(&text, &[("fold".into(), Content::Mesh(mesh))])?;
    sim.state_mut().0.copy_from_slice(&rhombus(height, angle));
    Ok(sim.energy().bend)
}
